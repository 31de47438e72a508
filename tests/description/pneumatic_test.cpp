#include <gtest/gtest.h>
#include <sstream>

#include "description/support.h"

#include "zwidth/description/names.h"
#include "zwidth/description/validate.h"
#include "zwidth/description/values.h"
#include "zwidth/description/write.h"

// Drives with cylinders, among the others: what files say of them, and what is wrong with them.

namespace zwidth {
namespace {

std::string text() {
  return text_of(catalogue().directory() / "devices" / "pneumatic-3.toml");
}
std::string slide_text() {
  return text_of(catalogue().directory() / "devices" / "pneumatic-1.toml");
}

TEST(PneumaticDescription, IsReadWithItsParts) {
  const Description device = parse_description(text(), "x.toml", {}, catalogue());
  EXPECT_TRUE(device.drives.empty());
  ASSERT_EQ(device.pneumatic_drives.size(), 3U);
  const PneumaticDriveDescription& drive = device.pneumatic_drives[2];
  EXPECT_EQ(drive.joints, std::vector<std::string>{"theta3"});
  EXPECT_EQ(drive.cylinder, *catalogue().find<Cylinder>("airpel-m9d12.5u"));
  EXPECT_EQ(drive.regulator.max_pressure, 500e3);
  ASSERT_TRUE(drive.potentiometer);
  EXPECT_EQ(drive.supply_pressure, 0.7e6);
  const auto& mount = std::get<ArmCylinderDescription>(drive.mount);
  EXPECT_EQ(mount.layout, ArmCylinderLayout::three);
  EXPECT_DOUBLE_EQ(mount.l2, 81.25e-3);
  EXPECT_DOUBLE_EQ(mount.retracted_length, 75e-3);
  const auto& arm = std::get<SerialDescription>(device.mechanism);
  EXPECT_EQ(arm.platform, PlatformFreedom::point);
  EXPECT_TRUE(arm.joints[5].free);
  EXPECT_FALSE(is_sliding_joint(device.mechanism, 0));
  EXPECT_TRUE(is_sliding_joint(parse_description(slide_text(), "x.toml", {}, catalogue()).mechanism, 0));
}

TEST(PneumaticDescription, IsWrittenAsItWasRead) {
  for (const char* name : {"pneumatic-1", "pneumatic-2", "pneumatic-3"}) {
    const Description device = read_description(name, {}, catalogue());
    EXPECT_TRUE(validate(device).empty());
    std::ostringstream out;
    write_description(device, out, catalogue());
    EXPECT_EQ(parse_description(out.str(), "y.toml", {}, catalogue()), device) << out.str();
  }
}

TEST(PneumaticDescription, ValuesHaveTheirSources) {
  int chosen = 0, published = 0;
  for (const DescribedValue& value : described_values(parse_description(text(), "x.toml", {}, catalogue()))) {
    EXPECT_NE(value.source, "") << value.table << "." << value.key;
    (value.chosen() ? chosen : published) += 1;
  }
  EXPECT_GT(chosen, 40);
  EXPECT_EQ(published, 0) << "the thesis publishes no number of the final device's geometry or drives";
}

TEST(PneumaticDescription, BothKindsOfDriveKeepTheirPlaces) {
  // An electric drive before, between and after: problems are told at the table that has them.
  const std::string motor =
      "\n[[drive]]\njoints = [\"theta1\"]\nmotor = \"maxon-ec-4pole-30-100w-48v\"\nencoder = "
      "\"maxon-mr-1000\"\n"
      "amplifier = \"maxon-epos2-50-5\"\nsupply_voltage = \"480 V\"\n";
  const std::string first =
      with(text(), "[[drive]]\njoints = [\"theta1\"]", motor + "[[drive]]\njoints = [\"theta2\"]");
  const std::vector<Problem> problems = problems_of(first);
  ASSERT_EQ(problems.size(), 2U);
  EXPECT_EQ(problems[0].key, "drive[0].supply_voltage");
  EXPECT_EQ(problems[0].line, place_of(first, "supply_voltage = \"480 V\"").first);
  EXPECT_EQ(problems[1].key, "drive[2].joints");  // theta2 twice
  const std::string last = with(text() + motor, "supply_pressure = \"0.7 MPa\"", "supply_pressure = \"7 MPa\"");
  const std::vector<Problem> more = problems_of(last);
  ASSERT_EQ(more.size(), 3U);
  EXPECT_EQ(more[0].key, "drive[0].joints");  // theta1 twice; electric drives are looked at first
  EXPECT_EQ(more[1].key, "drive[0].supply_pressure");
  EXPECT_EQ(more[2].key, "drive[3].supply_voltage");
}

std::string rule_of(const std::string& from, const std::string& to, const std::string& key) {
  const Problem problem = problem_of(with(text(), from, to));
  EXPECT_EQ(problem.key, key) << problem.rule;
  EXPECT_NE(problem.advice, "");
  EXPECT_GT(problem.line, 0);
  return problem.rule;
}

TEST(PneumaticDescription, MistakesHaveTheirRule) {
  EXPECT_EQ(rule_of("airpel-m9d12.5u", "airpel-m9", "drive[0].cylinder"), "is not a known cylinder");
  EXPECT_EQ(rule_of("\"two_mod\"", "\"four\"", "drive[1].mount.layout"), "is not known");
  EXPECT_EQ(rule_of("retracted_length = \"75 mm\", ", "", "drive[0].mount.retracted_length"), "is missing");
  EXPECT_EQ(rule_of("regulator = \"smc-itv0030-3ums\"\n", "", "drive[0].regulator"), "is missing");
}

TEST(PneumaticDescription, ContradictionsHaveTheirRule) {
  EXPECT_EQ(rule_of("\"0.7 MPa\"", "\"1.2 MPa\"", "drive[0].supply_pressure").substr(0, 32),
            "is more than the regulators take");
  EXPECT_EQ(rule_of("\"20 kPa\"", "\"0.6 MPa\"", "drive[0].bias_pressure").substr(0, 17), "must be less than");
  EXPECT_EQ(
      rule_of("sensor_voltage = \"5 V\"", "sensor_voltage = \"24 V\"", "drive[0].sensor_voltage").substr(0, 12),
      "is more than");
  EXPECT_EQ(rule_of("l2 = \"12.5 mm\"", "l2 = \"-12.5 mm\"", "drive[0].mount.l2").substr(0, 12),
            "must be more");
  EXPECT_EQ(rule_of("l1 = \"81.25 mm\"", "l1 = 0", "drive[0].mount.l1"), "must be positive in this layout");
  EXPECT_EQ(rule_of("l0 = 0, l1 = \"12.5 mm\"", "l0 = 0, l1 = 0", "drive[2].mount.l1"),
            "puts the arm pin on the pivot");
  EXPECT_EQ(rule_of("layout = \"two\", l0", "layout = \"two\", h = \"1 mm\", l0", "drive[0].mount.h"),
            "is no length of layout \"two\"");
  EXPECT_EQ(rule_of("joints = [\"theta3\"]", "joints = [\"theta4\"]", "drive[2].joints"),
            "is free: the hand moves it");
  EXPECT_EQ(rule_of("cylinder = \"airpel-m9d12.5u\"\n", "cylinder = \"airpel-m9d12.5u\"\nmotor = \"x\"\n",
                    "drive[0].motor"),
            "stands beside a cylinder");
}

TEST(PneumaticDescription, AMountBelongsToAJointThatTurns) {
  const std::string without =
      with(slide_text(), "joints = [\"z\"]",
           "joints = [\"z\"]\nmount = { layout = \"one\", l1 = 0.2, l2 = 0.1, retracted_length = 0.2 }");
  EXPECT_EQ(problem_of(without).rule, "turns an arm, but \"z\" slides");
  std::string turning = text();
  const std::size_t at = turning.find("mount = {");
  turning.erase(at, turning.find('\n', at) - at);
  EXPECT_EQ(problem_of(turning).rule, "moves \"theta1\", which turns, without an arm");
}

TEST(PneumaticDescription, OverridesReachEveryDrive) {
  const Description device = parse_description(
      text(), "x.toml", {"drive.supply_pressure=\"0.4 MPa\"", "drive.cylinder.stroke=\"13 mm\""}, catalogue());
  for (const PneumaticDriveDescription& drive : device.pneumatic_drives) {
    EXPECT_DOUBLE_EQ(drive.supply_pressure, 0.4e6);
    EXPECT_DOUBLE_EQ(drive.cylinder.stroke, 13e-3);
    EXPECT_EQ(drive.cylinder.info.name, "airpel-m9d12.5u");
  }
}

}  // namespace
}  // namespace zwidth
