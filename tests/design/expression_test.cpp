#include "zwidth/design/expression.h"

#include <atomic>
#include <cmath>
#include <gtest/gtest.h>
#include <map>
#include <thread>
#include <vector>

namespace zwidth {
namespace {

double value(std::string_view text, std::map<std::string, double> names = {}) {
  const ParsedExpression parsed = parse_expression(text);
  EXPECT_TRUE(parsed) << text << ": " << parsed.rule;
  return Expression(text, [&](const std::string& name) { return &names.at(name); })();
}

TEST(Expression, ComputesWhatItSays) {
  EXPECT_DOUBLE_EQ(value("1 + 2*3^2/4 - -1"), 6.5);
  EXPECT_DOUBLE_EQ(value("2^3^2"), 512.0);
  EXPECT_DOUBLE_EQ(value("-2^2"), -4.0);
  EXPECT_DOUBLE_EQ(value("hypot(3, 4) + min(1, 2, -3) + clamp(7, 0, 2) + sign(-3)"), 3.0);
  EXPECT_DOUBLE_EQ(value("log(exp(2)) + log10(100) + sqrt(9) + abs(-1)"), 8.0);
  EXPECT_DOUBLE_EQ(value("sin(pi/2) + atan2(0, -1) - pi"), 1.0);
  EXPECT_DOUBLE_EQ(value("floor(1.7) + ceil(1.2) + round(2.5)"), 6.0);
  EXPECT_DOUBLE_EQ(value("2 > 1 ? 5 : 6"), 5.0);
}

TEST(Expression, NumbersCarryUnits) {
  EXPECT_DOUBLE_EQ(value("60 mm / sin(30 deg)"), 0.12);
  EXPECT_DOUBLE_EQ(value("60mm"), 0.06);
  EXPECT_DOUBLE_EQ(value("1.5e3 mm + 2E-1 m"), 1.7);
  EXPECT_DOUBLE_EQ(value("0.5 MPa * 2"), 1e6);
  EXPECT_NEAR(value("180 deg"), M_PI, 1e-15);
  EXPECT_DOUBLE_EQ(value("2 * 100 mN m"), 0.2);
  EXPECT_DOUBLE_EQ(value("3 N m + m", {{"m", 1.0}}), 4.0);
  EXPECT_DOUBLE_EQ(value("(10 mm)^2"), 1e-4);
  EXPECT_FALSE(parse_expression("3 mm l2"));
  EXPECT_FALSE(parse_expression("3 kg m"));
  // Ten square millimetres, or the square of ten?
  const ParsedExpression unclear = parse_expression("10 mm^2");
  EXPECT_NE(unclear.rule.find("two ways"), std::string::npos) << unclear.rule;
  EXPECT_NE(unclear.advice.find("(10 mm)^2"), std::string::npos) << unclear.advice;
}

TEST(Expression, NamesMayBeKeys) {
  const ParsedExpression parsed =
      parse_expression("a1 * drive[0].transmission.preload + mechanism.forearm + a1");
  ASSERT_TRUE(parsed) << parsed.rule;
  EXPECT_EQ(parsed.names.size(), 3U);
  EXPECT_DOUBLE_EQ(value("a1 * drive[0].motor.resistance", {{"a1", 2.0}, {"drive[0].motor.resistance", 1.5}}),
                   3.0);
}

TEST(Expression, FollowsTheNumbersBehindItsNames) {
  double x = 1.0;
  const Expression twice("2*x", [&](const std::string&) { return &x; });
  EXPECT_DOUBLE_EQ(twice(), 2.0);
  x = -4.0;
  EXPECT_DOUBLE_EQ(twice(), -8.0);
}

TEST(Expression, HasNoValueWhereThereIsNone) {
  EXPECT_TRUE(std::isnan(value("1/x", {{"x", 0.0}})));
  EXPECT_TRUE(std::isnan(value("sqrt(x)", {{"x", -1.0}})));
  EXPECT_TRUE(std::isnan(value("acos(x)", {{"x", 1.5}})));
  EXPECT_TRUE(std::isnan(value("0*x", {{"x", NAN}})));
}

TEST(Expression, ManyThreadsMayMakeTheirOwn) {
  std::atomic<int> wrong = 0;
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t) {
    threads.emplace_back([&wrong, t] {
      double x = t;
      for (int i = 0; i < 200; ++i) {
        const Expression twice("2*x + 1 mm", [&](const std::string&) { return &x; });
        if (std::abs(twice() - (2.0 * x + 1e-3)) > 1e-12) ++wrong;
      }
    });
  }
  for (std::thread& one : threads) one.join();
  EXPECT_EQ(wrong, 0);
}

TEST(Expression, SaysWhatIsWrong) {
  for (const char* text :
       {"", "1 +", "(1", "sin(1, 2)", "1 2", "3 mn", "foo(1)", "a b", "1 / * 2", "\"text\"", "a = 2"}) {
    const ParsedExpression parsed = parse_expression(text);
    EXPECT_FALSE(parsed) << text;
    EXPECT_FALSE(parsed.advice.empty()) << text;
  }
  EXPECT_NE(parse_expression("3 mn").rule.find("mn"), std::string::npos);
  EXPECT_NE(parse_expression("sine(1)").advice.find("sin"), std::string::npos);
}

}  // namespace
}  // namespace zwidth
