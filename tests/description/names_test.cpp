#include "zwidth/description/names.h"

#include <gtest/gtest.h>

#include "description/support.h"

#include "zwidth/mechanism/delta.h"
#include "zwidth/mechanism/families.h"
#include "zwidth/mechanism/mechanism.h"

namespace zwidth {
namespace {

TEST(Names, OfADeltaAreThoseOfItsLegs) {
  const Description device = read_description("delta", {}, catalogue());
  const MechanismDescription legs = spelled_out(device).mechanism;
  EXPECT_EQ(active_joint_names(device.mechanism), active_joint_names(legs));
  std::vector<std::string> links = link_names(device.mechanism);
  std::erase_if(links, [](const std::string& link) { return link == "upper_arm" || link == "forearm"; });
  EXPECT_EQ(links, link_names(legs));
}

TEST(Names, AreThoseOfTheMechanism) {
  for (const Description& device : {read_description("delta", {}, catalogue()),
                                    parse_description(legs_text(), "x.toml", {}, catalogue())}) {
    EXPECT_EQ(active_joint_names(device.mechanism), Mechanism(device).active_names());
  }
}

TEST(Names, ThatTwoLegsShareAreSpelledOut) {
  Description device = parse_description(legs_text(), "x.toml", {}, catalogue());
  auto& legs = std::get<LegsDescription>(device.mechanism);
  legs.legs[1].joints[0].name = "turn";
  legs.legs[1].joints[0].active = true;
  EXPECT_EQ(active_joint_names(device.mechanism), (std::vector<std::string>{"crank/turn", "rail/turn"}));
  EXPECT_EQ(active_joint_index(device.mechanism, "rail/turn"), 1);
  EXPECT_EQ(active_joint_index(device.mechanism, "turn"), -1);
  EXPECT_EQ(active_joint_index(device.mechanism, "crank/knee"), -1);
}

TEST(Names, ADriveMovesWhatItNamesOrEverything) {
  const Description device = read_description("delta", {}, catalogue());
  DriveDescription drive = device.drives[0];
  EXPECT_EQ(driven_joints(device.mechanism, drive), (std::vector<int>{0, 1, 2}));
  drive.joints = {"theta3", "leg1/theta1"};
  EXPECT_EQ(driven_joints(device.mechanism, drive), (std::vector<int>{2, 0}));
}

}  // namespace
}  // namespace zwidth
