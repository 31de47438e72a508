#include "zwidth/description/write.h"

#include <gtest/gtest.h>
#include <random>
#include <sstream>

#include "description/support.h"

#include "zwidth/description/validate.h"
#include "zwidth/mechanism/delta.h"
#include "zwidth/mechanism/families.h"

namespace zwidth {
namespace {

std::string written(const Description& description) {
  std::ostringstream out;
  write_description(description, out, catalogue());
  return out.str();
}

Description read_again(const Description& description) {
  return parse_description(written(description), "written.toml", {}, catalogue());
}

TEST(Write, EveryBuiltInDeviceReadsBackEqual) {
  ASSERT_FALSE(catalogue().devices().empty());
  for (const BuiltinFile& builtin : catalogue().devices()) {
    const Description device = read_description(builtin.name, {}, catalogue());
    EXPECT_EQ(read_again(device), device) << builtin.name;
    const Description legs = spelled_out(device);
    EXPECT_EQ(read_again(legs), legs) << builtin.name << " as legs";
  }
}

TEST(Write, LegsReadBackEqual) {
  const Description device = parse_description(legs_text(), "x.toml", {}, catalogue());
  EXPECT_EQ(read_again(device), device);
}

TEST(Write, LinksThatAreBeamsReadBackEqual) {
  Description device = read_description("r-cube", {}, catalogue());
  device.bodies[1].beam = BarDescription{.width = 0.01,
                                         .height = 0.013,
                                         .width_along = {0.0, 2.0, 0.1},
                                         .wall = *catalogue().find<Material>("acrylic"),
                                         .source = "mine",
                                         .sources = {{"width", "theirs"}}};
  auto& laminate = std::get<LaminateDescription>(std::get<TubeDescription>(*device.bodies[2].beam).wall);
  laminate.lamina.density = 1700.0;
  laminate.plies.front().angle = 0.3;
  laminate.rule = LaminateRule::lamination;
  EXPECT_EQ(read_again(device), device) << written(device);
  const Description legs = spelled_out(device);
  EXPECT_EQ(read_again(legs), legs) << written(legs);
}

TEST(Write, AnyDigitsReadBackEqual) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> any(0.01, 0.2);
  Description device = read_description("delta", {}, catalogue());
  for (int i = 0; i < 50; ++i) {
    auto& delta = std::get<DeltaDescription>(device.mechanism);
    delta.upper_arm = any(random);
    delta.forearm = 0.3 + any(random);
    delta.joint_range = {-any(random), 5.0 * any(random)};
    device.bodies[0].mass = any(random);
    device.bodies[0].centre = {any(random), -any(random), any(random)};
    const Matrix3 R =
        Eigen::AngleAxisd(any(random), Vector3(any(random), any(random), 1).normalized()).toRotationMatrix();
    device.bodies[0].inertia =
        R * Vector3(3e-5, 4e-5, 5e-5).asDiagonal() * R.transpose();  // symmetric but for rounding
    device.to_user = R;
    device.gravity = 9.81 * R.col(2);
    device.drives[0].peak_factor = 1.0 + any(random);
    std::get<CapstanDescription>(device.drives[0].transmission).mid_angle = i == 0 ? 0.0 : any(random);
    ASSERT_TRUE(validate(device).empty());
    EXPECT_EQ(read_again(device), device) << written(device);
  }
}

TEST(Write, PartsAreNamedIfTheyAreThoseOfTheCatalogue) {
  Description device = read_description("delta", {}, catalogue());
  EXPECT_NE(written(device).find("motor = \"maxon-ec-4pole-30-100w-48v\"\n"), std::string::npos);
  device.drives[0].motor.resistance = 1.0;
  EXPECT_NE(written(device).find("motor = { base = \"maxon-ec-4pole-30-100w-48v\", resistance = \"1 ohm\" }\n"),
            std::string::npos);
  EXPECT_EQ(read_again(device), device);
}

TEST(Write, PartsThatNoCatalogueHasAreSpelledOut) {
  Description device = read_description("delta", {}, catalogue());
  device.drives[0].motor.info.name = "mine";
  device.drives[0].motor.info.title = "My \"own\" motor\n\\";
  EXPECT_EQ(read_again(device), device);
  device = read_description("delta", {}, catalogue());
  device.drives[0].motor.max_axial_load = kNotGiven;  // cannot be said on top of the catalogue's
  EXPECT_EQ(read_again(device), device);
}

TEST(Write, DrivesMayDifferAndMayBeDirect) {
  Description device = read_description("delta", {}, catalogue());
  device.drives.push_back(device.drives[0]);
  device.drives[0].joints = {"theta1"};
  device.drives[0].transmission = DirectDriveDescription{};
  device.drives[0].preloader.reset();
  device.drives[0].output.reset();
  device.drives[1].joints = {"theta2", "theta3"};
  EXPECT_EQ(read_again(device), device);
}

}  // namespace
}  // namespace zwidth
