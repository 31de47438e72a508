#include <gtest/gtest.h>
#include <sstream>

#include "description/support.h"

#include "zwidth/description/write.h"

namespace zwidth {
namespace {

// A planar arm with a slide, two loads, two postures and a body on parallel bars.
std::string arm_text() {
  return R"([device]
name = "arm"

[mechanism]
type = "serial"

[[joint]]
name = "turn"
type = "revolute"
a = "200 mm"
range = ["-90 deg", "90 deg"]

[[joint]]
name = "slide"
type = "prismatic"
range = ["-50 mm", "50 mm"]

[[body]]
on = "arm/turn"
turns_with = "arm/slide"
pivot = [0, 0, "60 mm"]
mass = "160 g"
centre = [0, 0, "-40 mm"]

[[load]]
name = "push"
force = ["10 N", 0, 0]

[[load]]
name = "turn"
moment = [0, 0, "0.5 N m"]
moment_frame = "tool"
kind = "peak"

[[posture]]
name = "stretched"
joints = ["30 deg", "-20 mm"]
)";
}

TEST(Loads, AreReadWithTheirUnitsAndDefaults) {
  const Description device = parse_description(arm_text(), "arm.toml", {}, catalogue());
  ASSERT_EQ(device.loads.size(), 2u);
  EXPECT_EQ(device.loads[0].force, Vector3(10.0, 0.0, 0.0));
  EXPECT_EQ(device.loads[0].kind, LoadKind::continuous);
  EXPECT_EQ(device.loads[0].moment_frame, MomentFrame::base);
  EXPECT_EQ(device.loads[1].moment, Vector3(0.0, 0.0, 0.5));
  EXPECT_EQ(device.loads[1].kind, LoadKind::peak);
  EXPECT_EQ(device.loads[1].moment_frame, MomentFrame::tool);
  ASSERT_EQ(device.postures.size(), 1u);
  EXPECT_NEAR(device.postures[0].joints[0], 0.5235987755982988, 1e-15);
  EXPECT_EQ(device.postures[0].joints[1], -0.02);
  EXPECT_EQ(device.bodies[0].turns_with, "arm/slide");
  EXPECT_EQ(device.bodies[0].pivot, Vector3(0.0, 0.0, 0.06));
}

TEST(Loads, AreWrittenAndReadBackEqual) {
  const Description device = parse_description(arm_text(), "arm.toml", {}, catalogue());
  std::ostringstream text;
  write_description(device, text, catalogue());
  EXPECT_EQ(parse_description(text.str(), "arm.toml", {}, catalogue()), device) << text.str();
}

TEST(Loads, OverridesReachAllOfThem) {
  const Description device =
      parse_description(arm_text(), "arm.toml", {"load.moment_frame=base", "load[0].kind=peak"}, catalogue());
  EXPECT_EQ(device.loads[1].moment_frame, MomentFrame::base);
  EXPECT_EQ(device.loads[0].kind, LoadKind::peak);
}

TEST(Loads, MistakesNamePlaceAndRule) {
  struct Mistake {
    const char *from, *to, *key, *rule;
  };
  const Mistake mistakes[] = {
      {"force = [\"10 N\", 0, 0]", "force = [\"10 m\", 0, 0]", "load[0].force[0]",
       "has the dimension of a length, a force was expected"},
      {"force = [\"10 N\", 0, 0]", "force = [\"10 N\", 0]", "load[0].force", "must be an array of 3, not 2"},
      {"force = [\"10 N\", 0, 0]", "force = [0, 0, 0]", "load[0]", "is no load: force and moment are zero"},
      {"kind = \"peak\"", "kind = \"pike\"", "load[1].kind", "is not known"},
      {"moment_frame = \"tool\"", "moment_frame = \"user\"", "load[1].moment_frame", "is not known"},
      {"name = \"turn\"\nmoment", "name = \"push\"\nmoment", "load[1].name", "is the name of another load"},
      {"joints = [\"30 deg\", \"-20 mm\"]", "joints = [\"30 deg\"]", "posture[0].joints",
       "must be an array of 2, not 1"},
      {"joints = [\"30 deg\", \"-20 mm\"]", "joints = [\"30 deg\", \"5 deg\"]", "posture[0].joints[1]",
       "has the dimension of an angle, a length was expected"},
      {"joints = [\"30 deg\", \"-20 mm\"]", "joints = [\"130 deg\", 0]", "posture[0].joints[0]",
       "must be from -90 deg to 90 deg"},
      {"turns_with = \"arm/slide\"", "turns_with = \"arm/slied\"", "body[0].turns_with",
       "is no link that a joint of this mechanism moves"},
      {"on = \"arm/turn\"", "on = \"platform\"", "body[0].on", "cannot carry a body that another link turns"},
      {"turns_with = \"arm/slide\"\n", "", "body[0].pivot", "means nothing without turns_with"},
      {"pivot = [0, 0, \"60 mm\"]\n", "", "body[0].pivot", "is missing"},
  };
  for (const Mistake& mistake : mistakes) {
    const std::vector<Problem> problems = problems_of(with(arm_text(), mistake.from, mistake.to));
    ASSERT_EQ(problems.size(), 1u) << mistake.to;
    EXPECT_EQ(problems[0].key, mistake.key) << to_string(problems[0]);
    EXPECT_EQ(problems[0].rule, mistake.rule) << to_string(problems[0]);
    EXPECT_GT(problems[0].line, 0) << mistake.to;
  }
}

TEST(Loads, AToolThatDoesNotTurnTakesNoMoment) {
  const std::string text =
      delta_text() + "\n[[load]]\nname = \"m\"\nforce = [0, 0, 1]\nmoment = [0, 0, \"1 N m\"]\n";
  const std::vector<Problem> problems = problems_of(text);
  ASSERT_EQ(problems.size(), 1u);
  EXPECT_EQ(problems[0].key, "load[0].moment");
  EXPECT_EQ(problems[0].rule, "has the wrong dimension: the tool of this mechanism does not turn");
}

}  // namespace
}  // namespace zwidth
