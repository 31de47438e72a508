#include "zwidth/analysis/contour.h"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <numbers>

namespace zwidth {
namespace {

template <class Function>
PlaneGrid sampled(int n, const Function& function) {
  PlaneGrid grid{.u = {-1.0, 1.0}, .v = {-1.0, 1.0}, .nu = n, .nv = n};
  for (int iv = 0; iv < n; ++iv) {
    for (int iu = 0; iu < n; ++iu) {
      grid.values.push_back(function(-1.0 + 2.0 * iu / (n - 1), -1.0 + 2.0 * iv / (n - 1)));
    }
  }
  return grid;
}

TEST(Contours, OfAConeAreCircles) {
  const PlaneGrid grid = sampled(201, [](double x, double y) { return 1.0 - std::hypot(x, y); });
  const std::vector<Outline> lines = contours(grid, 0.4);
  ASSERT_EQ(lines.size(), 1u);
  // Linear interpolation of a radius r errs by h^2/(8 r), h = 0.01.
  for (const auto& p : lines.front()) EXPECT_NEAR(std::hypot(p[0], p[1]), 0.6, 3e-5);
  EXPECT_NEAR(area_within(lines), std::numbers::pi * 0.36, 2e-4);
}

TEST(Contours, TakeOffHolesAndKeepIslandsApart) {
  const PlaneGrid ring = sampled(201, [](double x, double y) { return -std::abs(std::hypot(x, y) - 0.5); });
  EXPECT_EQ(contours(ring, -0.2).size(), 2u);
  EXPECT_NEAR(area_within(contours(ring, -0.2)), std::numbers::pi * (0.49 - 0.09), 2e-3);
  const PlaneGrid two = sampled(201, [](double x, double y) { return 0.3 - std::hypot(std::abs(x) - 0.5, y); });
  EXPECT_EQ(contours(two, 0.0).size(), 2u);
}

TEST(Contours, CloseAlongTheRimAndWhereThereIsNoValue) {
  const PlaneGrid full = sampled(11, [](double, double) { return 1.0; });
  const std::vector<Outline> lines = contours(full, 0.5);
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_NEAR(area_within(lines), 2.2 * 2.2 - 4 * 0.5 * 0.1 * 0.1, 1e-12);  // half a cell beyond, corners cut
  const PlaneGrid half =
      sampled(11, [](double x, double) { return x < 0.05 ? 1.0 : std::numeric_limits<double>::quiet_NaN(); });
  EXPECT_NEAR(area_within(contours(half, 0.5)), 1.2 * 2.2 - 4 * 0.5 * 0.1 * 0.1, 1e-12);
}

TEST(Contours, OfNothingAreNone) {
  EXPECT_TRUE(contours(sampled(5, [](double, double) { return 0.0; }), 1.0).empty());
}

}  // namespace
}  // namespace zwidth
