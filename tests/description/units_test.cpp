#include "zwidth/description/units.h"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <thread>
#include <vector>

namespace zwidth {
namespace {

double si(std::string_view text, Dimension dimension) {
  const ParsedQuantity quantity = parse_quantity(text, dimension);
  EXPECT_TRUE(quantity) << text << ": " << quantity.rule;
  return quantity.value.value_or(std::nan(""));
}

std::string rule(std::string_view text, Dimension dimension) {
  const ParsedQuantity quantity = parse_quantity(text, dimension);
  EXPECT_FALSE(quantity) << text;
  return quantity.rule;
}

TEST(Units, ReadTheQuantitiesOfDataSheets) {
  EXPECT_EQ(si("80 mm", Dimension::length), 0.08);
  EXPECT_EQ(si("160mm", Dimension::length), 0.16);
  EXPECT_EQ(si("0.254 N m", Dimension::torque), 0.254);
  EXPECT_EQ(si("69.4 mN m", Dimension::torque), 0.0694);
  EXPECT_EQ(si("69.4 mNm", Dimension::torque), 0.0694);
  EXPECT_EQ(si("18.3 g cm^2", Dimension::inertia), 1.83e-6);
  EXPECT_EQ(si("7.3 mohm", Dimension::resistance), 0.0073);
  EXPECT_EQ(si("0.118 mH", Dimension::inductance), 0.118e-3);
  EXPECT_EQ(si("200 kHz", Dimension::frequency), 2e5);
  EXPECT_EQ(si("5.5 K/W", Dimension::thermal_resistance), 5.5);
  EXPECT_DOUBLE_EQ(si("-36 deg", Dimension::angle), -36.0 * std::numbers::pi / 180.0);
  EXPECT_DOUBLE_EQ(si("12 rpm", Dimension::angular_speed), 12.0 * 2.0 * std::numbers::pi / 60.0);
  EXPECT_DOUBLE_EQ(si("374 rpm/V", Dimension::speed_constant), 374.0 * std::numbers::pi / 30.0);
  EXPECT_DOUBLE_EQ(si("155 degC", Dimension::temperature), 428.15);
  EXPECT_DOUBLE_EQ(si("97 lbf", Dimension::force), 97.0 * 4.4482216152605);
  EXPECT_DOUBLE_EQ(si("22.5 %", Dimension::number), 0.225);
}

TEST(Units, APlainNumberIsSi) {
  EXPECT_EQ(si("0.08", Dimension::length), 0.08);
  EXPECT_EQ(si(" +1e-3 ", Dimension::angle), 1e-3);
  EXPECT_EQ(si("-.5", Dimension::number), -0.5);
}

TEST(Units, ADecimalFractionOfAUnitIsRoundedOnce) {
  for (int n = 1; n <= 2000; ++n) {
    EXPECT_EQ(si(std::to_string(n) + " mm", Dimension::length), n / 1000.0);
    EXPECT_EQ(si(std::to_string(n) + " g cm^2", Dimension::inertia), n / 1e7);
  }
}

TEST(Units, AnotherDimensionIsNamed) {
  EXPECT_EQ(rule("80 kg", Dimension::length), "has the dimension of a mass, a length was expected");
  EXPECT_EQ(rule("80 mm", Dimension::angle), "has the dimension of a length, an angle was expected");
  EXPECT_EQ(rule("3 m^3/s", Dimension::length), "has the unit 'm^3/s', a length was expected");
}

TEST(Units, AnAngleIsNoPlainNumber) {
  EXPECT_EQ(rule("3 deg", Dimension::number), "has the dimension of an angle, a plain number was expected");
  EXPECT_EQ(rule("10 Hz", Dimension::angular_speed),
            "has the dimension of a frequency, an angular speed was expected");
  EXPECT_EQ(rule("60 rpm", Dimension::frequency),
            "has the dimension of an angular speed, a frequency was expected");
}

TEST(Units, GarbageIsExplained) {
  EXPECT_EQ(rule("80 furlongbananas", Dimension::length), "has an unknown unit 'furlongbananas'");
  EXPECT_EQ(rule("", Dimension::length), "has no number");
  EXPECT_EQ(rule("mm", Dimension::length), "has no number");
  EXPECT_EQ(rule("nan", Dimension::length), "has no number");
  EXPECT_EQ(rule("inf mm", Dimension::length), "has no number");
  EXPECT_EQ(rule("-inf", Dimension::length), "must be finite");
  EXPECT_EQ(rule("1e400", Dimension::length), "is beyond any number");
  EXPECT_EQ(rule("1e308 km", Dimension::length), "is beyond any number");
  EXPECT_EQ(rule("1,5 mm", Dimension::length), "has a comma in its number");
  for (const char* text : {"1 m @ 5", "1 s since 2000-01-01", "1 lg(re 1 mW)", "1 2 m", "1 m^99999",
                           "1 ((((((m", "1 \x01", "1 \xff\xfe", "1 m/0"}) {
    EXPECT_FALSE(parse_quantity(text, Dimension::length)) << text;
    EXPECT_FALSE(parse_quantity(text, Dimension::time)) << text;
  }
  EXPECT_FALSE(parse_quantity("1 " + std::string(100000, 'm'), Dimension::length));
}

TEST(Units, ListsAreReadEntryByEntry) {
  const ParsedQuantities joints = parse_quantity_list("0, 60deg,0,45 deg", Dimension::angle);
  ASSERT_TRUE(joints);
  ASSERT_EQ(joints.values.size(), 4U);
  EXPECT_DOUBLE_EQ(joints.values[1], std::numbers::pi / 3.0);
  EXPECT_EQ(parse_quantity_list("20mm,-0.03,0.12", Dimension::length).values,
            (std::vector<double>{0.02, -0.03, 0.12}));

  const ParsedQuantities wrong = parse_quantity_list("1, 2 kg, 3", Dimension::length);
  EXPECT_TRUE(wrong.values.empty());
  EXPECT_EQ(wrong.rule, "entry 2 ('2 kg') has the dimension of a mass, a length was expected");
  EXPECT_FALSE(parse_quantity_list("", Dimension::length));
  EXPECT_FALSE(parse_quantity_list("1,,2", Dimension::length));

  const std::vector<Dimension> mixed{Dimension::angle, Dimension::length};
  EXPECT_TRUE(parse_quantity_list("10 deg, 10 mm", mixed));
  EXPECT_FALSE(parse_quantity_list("10 mm, 10 deg", mixed));
  EXPECT_EQ(parse_quantity_list("1", mixed).rule, "has 1 entry, 2 are expected");
}

TEST(Units, FormattingReadsBackExactly) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> mantissa(-10.0, 10.0);
  std::uniform_int_distribution<int> exponent(-12, 9);
  for (int d = 0; d <= static_cast<int>(Dimension::thermal_resistance); ++d) {
    const auto dimension = static_cast<Dimension>(d);
    for (int i = 0; i < 300; ++i) {
      const double value = mantissa(random) * std::pow(10.0, exponent(random));
      const double rounded = std::round(mantissa(random) * 100.0) / 1000.0;
      EXPECT_EQ(si(format_quantity(value, dimension), dimension), value);
      EXPECT_EQ(si(format_quantity(rounded, dimension), dimension), rounded);
    }
    for (const double value :
         {0.0, std::numeric_limits<double>::max(), std::numeric_limits<double>::denorm_min()}) {
      EXPECT_EQ(si(format_quantity(value, dimension), dimension), value);
    }
  }
}

TEST(Units, FormattingPrefersCustomaryUnits) {
  EXPECT_EQ(format_quantity(0.08, Dimension::length), "80 mm");
  EXPECT_EQ(format_quantity(0.080386, Dimension::length), "80.386 mm");
  EXPECT_EQ(format_quantity(8e-6, Dimension::length), "8 um");
  EXPECT_EQ(format_quantity(si("84 deg", Dimension::angle), Dimension::angle), "84 deg");
  EXPECT_EQ(format_quantity(1.83e-6, Dimension::inertia), "18.3 g cm^2");
  EXPECT_EQ(format_quantity(9.5, Dimension::force), "9.5 N");
  EXPECT_EQ(format_quantity(0.225, Dimension::number), "0.225");
  EXPECT_EQ(format_quantity(std::numbers::pi, Dimension::length), "3.141592653589793");
}

TEST(Units, EveryDimensionKnowsItsOwnUnit) {
  for (int d = 0; d <= static_cast<int>(Dimension::thermal_resistance); ++d) {
    const auto dimension = static_cast<Dimension>(d);
    if (dimension == Dimension::number) continue;
    EXPECT_EQ(si("2 " + std::string(si_unit(dimension)), dimension), 2.0) << dimension_name(dimension);
  }
}

TEST(Units, ManyThreadsMayReadAtOnce) {
  std::vector<std::thread> threads;
  std::vector<int> wrong(4, 0);
  for (int t = 0; t < 4; ++t) {
    threads.emplace_back([t, &wrong] {
      for (int i = 0; i < 500; ++i) {
        const std::string text = std::to_string(i + 1) + (t % 2 == 0 ? " mm" : " um");
        const double expected = (i + 1) / (t % 2 == 0 ? 1e3 : 1e6);
        wrong[t] += parse_quantity(text, Dimension::length).value != expected ? 1 : 0;
        wrong[t] += parse_quantity(text, Dimension::mass) ? 1 : 0;
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(wrong, std::vector<int>(4, 0));
}

}  // namespace
}  // namespace zwidth
