#include "zwidth/description/catalogue.h"

#include <cmath>
#include <cstdlib>
#include <gtest/gtest.h>
#include <numbers>

#include "description/support.h"

namespace zwidth {
namespace {

namespace fs = std::filesystem;

template <class Part>
void expect_every_value_has_a_source() {
  EXPECT_FALSE(catalogue().all<Part>().empty()) << part_kind<Part>();
  for (const Part& part : catalogue().all<Part>()) {
    EXPECT_NE(part.info.source, "") << part.info.name;
    EXPECT_NE(part.info.title, part.info.name) << part.info.name;
    EXPECT_EQ(catalogue().find<Part>(part.info.name), &part);
    for (const PartValue& value : part_values(part))
      EXPECT_NE(value.source, "") << part.info.name << "." << value.key;
  }
}

TEST(Catalogue, EveryPartHasASource) {
  expect_every_value_has_a_source<Motor>();
  expect_every_value_has_a_source<Gearhead>();
  expect_every_value_has_a_source<Encoder>();
  expect_every_value_has_a_source<Amplifier>();
  expect_every_value_has_a_source<Cable>();
  expect_every_value_has_a_source<Bearing>();
  expect_every_value_has_a_source<Material>();
  expect_every_value_has_a_source<Cylinder>();
  expect_every_value_has_a_source<Regulator>();
  expect_every_value_has_a_source<Potentiometer>();
  expect_every_value_has_a_source<Lamina>();
}

// Data sheets repeat themselves: a value mistyped disagrees with the others. The tolerances are those of the
// sheets' own consistency (Baser 2006, appendix A: 2 %; the EC-4pole's nominal point is 8 % apart, Neal 2015).
TEST(Catalogue, MotorsAgreeWithThemselves) {
  for (const Motor& motor : catalogue().all<Motor>()) {
    const std::string& name = motor.info.name;
    const double kt = motor.torque_constant, R = motor.resistance, V = motor.supply_voltage;
    EXPECT_NEAR(motor.speed_constant * kt, 1.0, 0.01) << name;
    EXPECT_NEAR(motor.stall_torque / (kt * V / R), 1.0, 0.02) << name;
    EXPECT_NEAR(motor.no_load_speed / (motor.speed_constant * (V - R * motor.no_load_current)), 1.0, 0.02)
        << name;
    EXPECT_NEAR(motor.nominal_torque / (kt * motor.nominal_current), 0.95, 0.13) << name;
    EXPECT_LT(motor.nominal_torque, motor.stall_torque) << name;
    if (given(motor.nominal_speed)) {
      EXPECT_LT(motor.nominal_speed, motor.no_load_speed) << name;
    }
  }
}

TEST(Catalogue, OtherPartsAgreeWithThemselves) {
  for (const Gearhead& gearhead : catalogue().all<Gearhead>()) {
    EXPECT_LE(gearhead.continuous_torque, gearhead.intermittent_torque) << gearhead.info.name;
    // Every stage of these loses a tenth.
    EXPECT_NEAR(gearhead.max_efficiency, std::pow(0.9, gearhead.stages), 1e-9) << gearhead.info.name;
    EXPECT_GE(gearhead.reduction_numerator, gearhead.reduction_denominator) << gearhead.info.name;
  }
  for (const Amplifier& amplifier : catalogue().all<Amplifier>()) {
    EXPECT_LE(amplifier.continuous_current, amplifier.max_current) << amplifier.info.name;
    EXPECT_LT(amplifier.min_supply_voltage, amplifier.max_supply_voltage) << amplifier.info.name;
  }
  for (const Cable& cable : catalogue().all<Cable>()) {
    EXPECT_LE(cable.bare_diameter, cable.coated_diameter) << cable.info.name;
    // No steel rope of this size carries more than 2.2 GPa on its circle's area, nor does a sound one break
    // below 0.5.
    const double stress = cable.breaking_load / (std::numbers::pi / 4.0 * std::pow(cable.bare_diameter, 2));
    EXPECT_GT(stress, 0.5e9) << cable.info.name;
    EXPECT_LT(stress, 2.2e9) << cable.info.name;
  }
  for (const Bearing& bearing : catalogue().all<Bearing>()) {
    EXPECT_LT(bearing.bore, bearing.outer_diameter) << bearing.info.name;
    if (given(bearing.static_load)) {
      EXPECT_LT(bearing.static_load, bearing.dynamic_load) << bearing.info.name;
    }
  }
  for (const Cylinder& cylinder : catalogue().all<Cylinder>()) {
    EXPECT_LT(cylinder.rod_area, cylinder.rear_area) << cylinder.info.name;
    // Areas are printed with three digits of a square inch.
    if (given(cylinder.bore)) {
      EXPECT_NEAR(cylinder.rear_area / (std::numbers::pi / 4.0 * std::pow(cylinder.bore, 2)), 1.0, 0.01)
          << cylinder.info.name;
    }
    EXPECT_LT(cylinder.moving_mass, cylinder.mass) << cylinder.info.name;
  }
  for (const Regulator& regulator : catalogue().all<Regulator>()) {
    EXPECT_LT(regulator.min_pressure, regulator.max_pressure) << regulator.info.name;
    EXPECT_LE(regulator.max_pressure, regulator.max_supply_pressure) << regulator.info.name;
    EXPECT_LT(regulator.min_command, regulator.max_command) << regulator.info.name;
  }
  for (const Material& material : catalogue().all<Material>()) {
    if (given(material.yield_strength)) {
      EXPECT_LT(material.yield_strength, 0.02 * material.elastic_modulus) << material.info.name;
    }
  }
}

TEST(Catalogue, PartsAreListedInTheOrderOfTheirFile) {
  const std::vector<Motor>& motors = catalogue().all<Motor>();
  const std::string text = text_of(catalogue().directory() / "parts" / "motors.toml");
  for (std::size_t i = 1; i < motors.size(); ++i) {
    EXPECT_LT(text.find('[' + motors[i - 1].info.name + ']'), text.find('[' + motors[i].info.name + ']'));
  }
}

TEST(Catalogue, UnknownPartsAreNull) {
  EXPECT_EQ(catalogue().find<Motor>("no-such-motor"), nullptr);
}

TEST(Catalogue, DevicesHaveTitles) {
  ASSERT_FALSE(catalogue().devices().empty());
  EXPECT_EQ(catalogue().devices()[0].name, "delta");
  EXPECT_EQ(catalogue().devices()[0].title, "Delta controller with cable-driven sector actuators");
  EXPECT_EQ(resolve_device("delta", catalogue()), catalogue().devices()[0].path);
  EXPECT_EQ(resolve_device("./delta", catalogue()), "./delta");
  EXPECT_EQ(resolve_device("mine.toml", catalogue()), "mine.toml");
}

TEST(Catalogue, UnknownDevicesGetASuggestion) {
  try {
    resolve_device("dleta", catalogue());
    FAIL();
  } catch (const DescriptionError& error) {
    EXPECT_NE(std::string(error.what()).find("did you mean \"delta\"?"), std::string::npos) << error.what();
  }
}

TEST(Catalogue, TheEnvironmentMayNameTheDirectory) {
  const fs::path before = default_data_directory();
  ASSERT_EQ(setenv("ZWIDTH_DATA", "/some/where", 1), 0);
  EXPECT_EQ(default_data_directory(), "/some/where");
  ASSERT_EQ(unsetenv("ZWIDTH_DATA"), 0);
  EXPECT_EQ(default_data_directory(), before);
  EXPECT_THROW(Catalogue::load("/some/where"), DescriptionError);
}

TEST(Catalogue, MistakesInPartsFilesAllComeAtOnce) {
  const fs::path directory = fs::temp_directory_path() / "zwidth-catalogue-test";
  fs::remove_all(directory);
  fs::create_directories(directory / "parts");
  for (const char* file : {"motors", "gearheads", "encoders", "amplifiers", "bearings"}) {
    fs::copy(catalogue().directory() / "parts" / (std::string(file) + ".toml"), directory / "parts");
  }
  std::ofstream(directory / "parts" / "cables.toml") << "[\"Bad Name\"]\nstrands = 2.5\n\"7x7\" = 1\n";
  std::ofstream(directory / "parts" / "materials.toml")
      << "[x]\nelastic_modulus = \"-1 GPa\"\npoisson_ratio = 0.3\n"
         "density = \"1 kg/m^3\"\ntitle = \"X\"\n";
  try {
    Catalogue::load(directory);
    FAIL();
  } catch (const DescriptionError& error) {
    const std::string all = error.what();
    for (const char* part :
         {"is no name of a part", "must be a whole number", ".7x7 = 1: is not a key", "is missing",
          "x.elastic_modulus = \"-1 GPa\": must be positive", "x.source: is missing", "cables.toml:2:11"}) {
      EXPECT_NE(all.find(part), std::string::npos) << part << " in\n" << all;
    }
  }
  fs::remove_all(directory);
}

}  // namespace
}  // namespace zwidth
