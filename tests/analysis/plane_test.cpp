#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <sstream>

#include "zwidth/analysis/conditioning.h"
#include "zwidth/analysis/data_sheet.h"
#include "zwidth/analysis/workspace.h"
#include "zwidth/mechanism/families.h"
#include "zwidth/mechanism/five_bar.h"

namespace zwidth {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kDegree = kPi / 180.0;

Description describe(MechanismDescription mechanism, const char* name = "plane") {
  Description description;
  description.name = name;
  description.gravity = Vector3::Zero();
  description.mechanism = std::move(mechanism);
  return description;
}

FiveBarDescription five_bar(double crank, double coupler, double half_base, Interval left = {-kPi, kPi},
                            Interval right = {-kPi, kPi}) {
  return {.crank = crank,
          .coupler = coupler,
          .half_base = half_base,
          .left_range = left,
          .right_range = right,
          .source = "test"};
}

// An arm of two links in the plane z = height.
LegsDescription two_link_arm(double l1, double l2, Interval first, Interval second, double height = 0.0) {
  LegDescription leg{.name = "arm"};
  leg.joints = {
      {.name = "q1", .active = true, .point = {0, 0, height}, .range = first, .home = first.middle()},
      {.name = "q2", .active = true, .point = {l1, 0, height}, .range = second, .home = second.middle()}};
  leg.tip = {l1 + l2, 0, height};
  leg.attachment = Attachment::spherical;
  LegsDescription legs{.platform = PlatformFreedom::planar_translation, .source = "test"};
  legs.legs = {leg};
  return legs;
}

// The textbook: crank angles by the cosine rule, J = Jp^-1 Jt, sigma by the eigenvalues of J^T J. Nothing
// outside reach.
struct Textbook {
  bool reached = false;
  bool own_assembly = false;
  Matrix2 J;
  double K = 0.0;
};
Textbook textbook(const FiveBarDescription& d, double x, double y) {
  Textbook t;
  Vector2 B[2], C(x, y);
  for (int i = 0; i < 2; ++i) {
    const double s = i == 0 ? d.left_mode : d.right_mode;
    const Vector2 O(i == 0 ? -d.half_base : d.half_base, 0.0);
    const double D = (C - O).norm();
    const double c = (d.crank * d.crank + D * D - d.coupler * d.coupler) / (2.0 * d.crank * D);
    if (!(std::abs(c) <= 1.0)) return t;
    const double theta = std::atan2(C.y() - O.y(), C.x() - O.x()) + s * std::acos(c);
    B[i] = O + d.crank * Vector2(std::cos(theta), std::sin(theta));
    const Interval range = i == 0 ? d.left_range : d.right_range;
    const double turned = range.middle() + std::remainder(theta - range.middle(), 2.0 * kPi);
    if (turned < range.min || turned > range.max) return t;
  }
  t.reached = true;
  Matrix2 Jp, Jt = Matrix2::Zero();
  for (int i = 0; i < 2; ++i) {
    const Vector2 coupler = C - B[i], crank = B[i] - Vector2(i == 0 ? -d.half_base : d.half_base, 0.0);
    Jp.row(i) = coupler.transpose();
    Jt(i, i) = crank.x() * coupler.y() - crank.y() * coupler.x();
  }
  t.own_assembly = Jp.determinant() * d.assembly_mode >= 0.0;
  t.J = Jp.inverse() * Jt;
  const Eigen::Matrix2d A = t.J.transpose() * t.J;
  const double mean = 0.5 * A.trace(), half = std::hypot(0.5 * (A(0, 0) - A(1, 1)), A(0, 1));
  t.K = std::sqrt((mean + half) / (mean - half));
  return t;
}

const FiveBarDescription kPublished = five_bar(0.10, 0.15, 0.03);
constexpr double kSpacing = 4.0317e-3;  // [m]

TEST(Plane, AreaOfAnArmOfTwoLinksIsTheClosedForm) {
  const double l1 = 0.2, l2 = 0.13;
  const Interval first{-0.7, 1.9}, second{0.3, 2.4};
  const Mechanism mechanism(describe(two_link_arm(l1, l2, first, second, 0.05)));
  ASSERT_EQ(workspace_obstacle(mechanism), std::nullopt);
  // dA = |det J| dq = l1 l2 sin q2 dq1 dq2.
  const double area = first.width() * l1 * l2 * (std::cos(second.min) - std::cos(second.max));
  const WorkspaceVolume integral = workspace_volume(mechanism);
  EXPECT_EQ(integral.method, WorkspaceVolume::Method::integral);
  EXPECT_NEAR(integral.value / area, 1.0, 1e-8);

  const Extents extents = workspace_extents(mechanism);
  EXPECT_EQ(extents.range[2].width(), 0.0);
  const SliceMap map = map_slice(mechanism, extents, 2, 0.0, 201, {});
  EXPECT_NEAR(map.slice.area / area, 1.0, 1e-3);  // a corner is cut by at most a few cells
  // Counting: the error of a lattice is about its spacing times the length of the boundary by a small factor.
  const LatticeSweep sweep = sweep_workspace(mechanism, {.spacing = 2e-3});
  EXPECT_NEAR(sweep.area / area, 1.0, 5e-3);
  EXPECT_EQ(sweep.volume, 0.0);
  EXPECT_NEAR(sweep.figures[1].max, l1 * l2, 1e-3 * l1 * l2);  // |det J| where the links are at a right angle
  EXPECT_EQ(sweep.figures[static_cast<int>(Figure::force_z)].count, 0);
}

TEST(Plane, ExtentsAreThoseOfTheRegionItself) {
  const double l1 = 0.2, l2 = 0.13;
  // The outer rim is an arc of the two links nearly stretched, from -40 to 60 degrees.
  const Interval first{-40 * kDegree, 60 * kDegree}, second{0.3, 2.4};
  const Extents extents = workspace_extents(Mechanism(describe(two_link_arm(l1, l2, first, second))));
  double low[2] = {1e9, 1e9}, high[2] = {-1e9, -1e9};
  const int n = 600;
  for (int i = 0; i <= n; ++i) {
    for (int j = 0; j <= n; ++j) {
      const double a = first.min + first.width() * i / n, b = second.min + second.width() * j / n;
      const double p[2] = {l1 * std::cos(a) + l2 * std::cos(a + b), l1 * std::sin(a) + l2 * std::sin(a + b)};
      for (int k = 0; k < 2; ++k) low[k] = std::min(low[k], p[k]), high[k] = std::max(high[k], p[k]);
    }
  }
  for (int k = 0; k < 2; ++k) {
    // The raster cannot be beyond, and misses by the square of its step.
    EXPECT_LE(extents.range[k].min, low[k] + 1e-12);
    EXPECT_GE(extents.range[k].max, high[k] - 1e-12);
    EXPECT_NEAR(extents.range[k].min, low[k], 2e-6);
    EXPECT_NEAR(extents.range[k].max, high[k], 2e-6);
  }
}

TEST(Plane, FiveBarWithoutDirectSingularitiesHasTheAreaBetweenItsCircles) {
  // r3 > r1: the elbows never meet; r2 > r1 + r3: the couplers never align. The half with y > 0 is one branch.
  const FiveBarDescription d = five_bar(0.05, 0.16, 0.06);
  const Mechanism mechanism(describe(d));
  const double outer = d.crank + d.coupler, inner = d.coupler - d.crank;
  double area = 0.0;
  const int n = 400000;
  const double step = 2.0 * outer / n;
  for (int i = 0; i < n; ++i) {
    const double x = -outer + (i + 0.5) * step;
    double top = 1e9, bottom = 0.0;
    for (const double o : {-d.half_base, d.half_base}) {
      const double to_rim = outer * outer - (x - o) * (x - o), to_core = inner * inner - (x - o) * (x - o);
      top = std::min(top, to_rim > 0.0 ? std::sqrt(to_rim) : 0.0);
      bottom = std::max(bottom, to_core > 0.0 ? std::sqrt(to_core) : 0.0);
    }
    area += step * std::max(0.0, top - bottom);
  }
  const WorkspaceVolume found = workspace_volume(mechanism);
  EXPECT_EQ(found.method, WorkspaceVolume::Method::outline);
  EXPECT_NEAR(found.value, area, 2.0 * found.error_estimate + 1e-6 * area);
  EXPECT_LT(found.error_estimate, 1e-3 * area);
  const Extents extents = workspace_extents(mechanism);
  // Both legs are stretched there, where a joint angle off by e costs the height only some r e^2: to rounding.
  EXPECT_NEAR(extents.range[1].max, std::sqrt(outer * outer - d.half_base * d.half_base), 1e-13);
  EXPECT_GT(extents.range[1].min, 0.0);
}

TEST(Plane, FiveBarWithNarrowRangesHasOneAreaByThreeRoutes) {
  const FiveBarDescription d =
      five_bar(0.10, 0.15, 0.03, {95 * kDegree, 150 * kDegree}, {20 * kDegree, 80 * kDegree});
  const Mechanism mechanism(describe(d));
  const WorkspaceVolume area = workspace_volume(mechanism);
  EXPECT_EQ(area.method, WorkspaceVolume::Method::integral);
  EXPECT_LT(area.error_estimate, 1e-8 * area.value);
  const SliceMap map = map_slice(mechanism, workspace_extents(mechanism), 2, 0.0, 301, {});
  EXPECT_NEAR(map.slice.area / area.value, 1.0, 1e-4);
  const LatticeSweep sweep = sweep_workspace(mechanism, {});
  EXPECT_NEAR(sweep.area / area.value, 1.0, 0.02);
}

TEST(Plane, LargestCircleOfAFiveBarIsThatOfTheSource) {
  for (const auto& [a1, a2, a3] : {std::array{0.10, 0.15, 0.03}, {0.09, 0.14, 0.03}, {0.11, 0.15, 0.03}}) {
    const Mechanism mechanism(describe(five_bar(a1, a2, a3)));
    const InscribedShapes shapes = inscribed_shapes(mechanism);
    // r_MIC = min(a1, a2), y_MIC = sqrt(max(a1, a2)^2 - a3^2).
    EXPECT_NEAR(shapes.circle().size, a1, 2e-7);
    EXPECT_LE(shapes.circle().size, a1 * (1.0 + 1e-12));
    EXPECT_NEAR(std::abs(shapes.circle().centre.y()), std::sqrt(a2 * a2 - a3 * a3), 1e-5);
    EXPECT_NEAR(shapes.circle().centre.x(), 0.0, 1e-5);
    EXPECT_NEAR(shapes.circle().volume, kPi * std::pow(shapes.circle().size, 2), 1e-12);
  }
}

// With a2 < a1 + a3 the couplers align inside the source's circle, lowest at half-base a3 + a1 cos t = a2, and
// the largest one rests on that singularity and on both outer circles.
TEST(Plane, LargestCircleEndsWhereTheCouplersAlign) {
  const double a1 = 0.11, a2 = 0.15, a3 = 0.05;
  const double bottom = std::sqrt(a1 * a1 - (a2 - a3) * (a2 - a3));
  // y - r = bottom and r = a1 + a2 - sqrt(y^2 + a3^2).
  const double s = a1 + a2 + bottom, y = 0.5 * (s - a3 * a3 / s);
  const InscribedShape circle = inscribed_shapes(Mechanism(describe(five_bar(a1, a2, a3)))).circle();
  EXPECT_NEAR(circle.size, y - bottom, 2e-7);
  EXPECT_NEAR(circle.centre.y(), y, 1e-5);
  EXPECT_NEAR(circle.centre.x(), 0.0, 1e-5);
}

TEST(Plane, LargestSquareFitsAndNoLargerOneNearByDoes) {
  const FiveBarDescription d = kPublished;
  const Mechanism mechanism(describe(d));
  const InscribedShape square = inscribed_shapes(mechanism).square();
  const auto fits = [&](double cx, double cy, double edge) {
    const int n = 200;
    for (int i = 0; i <= n; ++i) {
      const double s = edge * (static_cast<double>(i) / n - 0.5), h = 0.5 * edge;
      for (const auto& [x, y] : {std::pair{s, -h}, {s, h}, {-h, s}, {h, s}}) {
        const Textbook t = textbook(d, cx + x, cy + y);
        if (!t.reached || !t.own_assembly) return false;
      }
    }
    return true;
  };
  EXPECT_TRUE(fits(square.centre.x(), square.centre.y(), square.size));
  for (int i = -10; i <= 10; ++i) {
    for (int j = -10; j <= 10; ++j) {
      const double move = 0.004 * square.size;
      EXPECT_FALSE(fits(square.centre.x() + i * move, square.centre.y() + j * move, square.size * 1.0005));
    }
  }
}

TEST(Plane, SweepAgreesWithTheTextbookPointByPoint) {
  const FiveBarDescription d = five_bar(0.10, 0.15, 0.03, {0.0, 200 * kDegree}, {-20 * kDegree, kPi});
  const Mechanism mechanism(describe(d));
  const DriveLimits limits{.torque = {0.7, 0.4, 1.0}, .step = {1e-4, 2e-4, 0.0}};
  // Multiples of 1 mm would meet circles of the boundary exactly, where rounding decides.
  const LatticeOptions options{.spacing = kSpacing, .limits = limits, .all_figures = true};
  const WorkspaceMap map = map_workspace(mechanism, options);
  const LatticeSweep sweep = sweep_workspace(mechanism, options);
  EXPECT_EQ(std::ssize(map.positions), sweep.inside);
  EXPECT_EQ(map.columns().front(), "x");
  EXPECT_EQ(map.columns()[2], "condition_number");
  std::int64_t expected = 0;
  for (int i = -80; i <= 80; ++i) {
    for (int j = -80; j <= 80; ++j) {
      const Textbook t = textbook(d, kSpacing * i, kSpacing * j);
      expected += t.reached && t.own_assembly;
    }
  }
  EXPECT_EQ(sweep.inside, expected);
  for (std::size_t p = 0; p < map.positions.size(); p += 7) {
    const Textbook t = textbook(d, map.positions[p].x(), map.positions[p].y());
    ASSERT_TRUE(t.reached && t.own_assembly);
    const FigureValues& v = map.figures[p];
    EXPECT_NEAR(figure(v, Figure::condition_number) / t.K, 1.0, 1e-6 + 1e-12 * t.K * t.K);
    EXPECT_NEAR(figure(v, Figure::manipulability) / std::abs(t.J.determinant()), 1.0, 1e-6);
    const double fx = std::min(0.7 / std::abs(t.J(0, 0)), 0.4 / std::abs(t.J(0, 1)));
    EXPECT_NEAR(figure(v, Figure::force_x) / fx, 1.0, 1e-6);
    const double step = std::abs(t.J(1, 0)) * 1e-4 + std::abs(t.J(1, 1)) * 2e-4;
    EXPECT_NEAR(figure(v, Figure::step_y) / step, 1.0, 1e-6);
    // Forces in every direction: no direction has less, one has as much; the same for the strongest.
    double least = 1e300, most = 0.0;
    for (int n = 0; n < 2000; ++n) {
      const Vector2 u(std::cos(n * kPi / 2000), std::sin(n * kPi / 2000));
      const Vector2 torque = t.J.transpose() * u;
      const double force = std::min(0.7 / std::abs(torque[0]), 0.4 / std::abs(torque[1]));
      least = std::min(least, force);
      most = std::max(most, force);
    }
    EXPECT_GE(least, figure(v, Figure::weakest_force) * (1.0 - 1e-9));
    EXPECT_NEAR(least / figure(v, Figure::weakest_force), 1.0, 1e-4);
    EXPECT_LE(most, figure(v, Figure::strongest_force) * (1.0 + 1e-9));
  }
}

TEST(Plane, MapsAreTheSameForAnyNumberOfThreads) {
  const Mechanism mechanism(describe(kPublished));
  const LatticeOptions options{.spacing = 5e-3, .all_figures = true};
  const LatticeSweep one = sweep_workspace(mechanism, options, {.threads = 1});
  const LatticeSweep many = sweep_workspace(mechanism, options, {.threads = 4});
  EXPECT_EQ(one.inside, many.inside);
  for (int f = 0; f < kFigureCount; ++f) EXPECT_EQ(one.figures[f].mean, many.figures[f].mean);
  EXPECT_EQ(sweep_conditioning(mechanism, 5e-3, {.threads = 1}).of_all.index(),
            sweep_conditioning(mechanism, 5e-3, {.threads = 4}).of_all.index());
}

TEST(Conditioning, OfAFiveBarIsTheMeanOfTheTextbook) {
  const Mechanism mechanism(describe(kPublished));
  const WorkspaceConditioning found = sweep_conditioning(mechanism, kSpacing);
  double sum = 0.0, count = 0.0, below = 0.0;
  for (int i = -80; i <= 80; ++i) {
    for (int j = -80; j <= 80; ++j) {
      const Textbook t = textbook(kPublished, kSpacing * i, kSpacing * j);
      if (!t.reached || !t.own_assembly) continue;
      sum += std::isfinite(t.K) ? 1.0 / t.K : 0.0;
      below += t.K < 5.0;
      ++count;
    }
  }
  EXPECT_EQ(found.inside, static_cast<std::int64_t>(count));
  EXPECT_NEAR(found.of_all.index(), sum / count, 1e-7);
  EXPECT_NEAR(found.of_all.share(ConditionClass::below_5), below / count, 1e-12);
  double all = 0.0;
  for (const ConditionClass k : kConditionClasses) all += found.of_all.share(k);
  EXPECT_NEAR(all, 1.0, 1e-12);
}

TEST(Conditioning, OfAnRCubeIsThatOfItsLevers) {
  // J is diagonal with entries l1 cos q_i, and r_i = S + l1 sin q_i: K from the tool's position alone.
  const RCubeDescription d{.drive_link = 0.08,
                           .inner_link = 0.12,
                           .outer_link = 0.12,
                           .base_offset = 0.1,
                           .joint_range = {-40 * kDegree, 40 * kDegree},
                           .source = "test"};
  const Mechanism mechanism(describe(d, "r-cube"));
  ASSERT_EQ(workspace_obstacle(mechanism), std::nullopt);
  const double h = 4e-3;
  const WorkspaceConditioning found = sweep_conditioning(mechanism, h);
  const LatticeSweep sweep = sweep_workspace(mechanism, {.spacing = h});
  EXPECT_EQ(found.inside, sweep.inside);
  ASSERT_GT(sweep.inside, 1000);
  const WorkspaceMap map = map_workspace(mechanism, {.spacing = h, .all_figures = true});
  double sum = 0.0;
  for (const Vector3& p : map.positions) {
    double least = 1e9, most = 0.0;
    for (int i = 0; i < 3; ++i) {
      const double s = (p[i] - d.base_offset) / d.drive_link, lever = std::sqrt(1.0 - s * s);
      least = std::min(least, lever);
      most = std::max(most, lever);
    }
    sum += least / most;
  }
  EXPECT_NEAR(found.of_all.index(), sum / static_cast<double>(sweep.inside), 1e-12);
  // Its own closed form and the general solver, which knows nothing of it, agree about what is inside.
  const Mechanism legs([&] {
    Description general = describe(d, "r-cube");
    general.mechanism = legs_of(d);
    return general;
  }());
  EXPECT_EQ(sweep_workspace(legs, {.spacing = 0.02}).inside,
            sweep_workspace(mechanism, {.spacing = 0.02}).inside);
}

TEST(Dexterity, AnnulusOfThePublishedFiveBar) {
  const Mechanism mechanism(describe(kPublished));
  const DexterousRegion region = dexterous_region(mechanism, workspace_extents(mechanism));
  ASSERT_TRUE(region.annulus);
  // Published in steps of 1 mm: K < 5 on every full circle of radius 85 to 216 mm.
  EXPECT_NEAR(region.annulus->min, 0.085, 1e-3);
  EXPECT_NEAR(region.annulus->max, 0.216, 1e-3);
  const auto worst = [&](double r) {
    double K = 0.0;
    for (int n = 0; n < 20000; ++n) {
      const Textbook t = textbook(kPublished, r * std::cos(n * kPi / 1e4), r * std::sin(n * kPi / 1e4));
      K = std::max(K, t.reached && t.own_assembly ? t.K : 1e9);
    }
    return K;
  };
  for (const double r : {region.annulus->min + 1e-6, region.annulus->middle(), region.annulus->max - 1e-6})
    EXPECT_LT(worst(r), 5.0);
  EXPECT_GT(worst(region.annulus->min - 1e-5), 5.0);
  EXPECT_GT(worst(region.annulus->max + 1e-5), 5.0);
  // Its area by counting.
  double count = 0.0;
  for (int i = -130; i <= 130; ++i) {
    for (int j = -130; j <= 130; ++j) {
      const Textbook t = textbook(kPublished, 2e-3 * i, 2e-3 * j);
      count += t.reached && t.own_assembly && t.K < 5.0;
    }
  }
  EXPECT_NEAR(region.area / (count * 4e-6), 1.0, 3e-3);
  EXPECT_GT(region.area, kPi * (std::pow(region.annulus->max, 2) - std::pow(region.annulus->min, 2)));
}

TEST(Dexterity, NoAnnulusWhereTheRegionDoesNotGoRoundTheOrigin) {
  const FiveBarDescription d =
      five_bar(0.10, 0.15, 0.03, {95 * kDegree, 150 * kDegree}, {20 * kDegree, 80 * kDegree});
  const Mechanism mechanism(describe(d));
  const DexterousRegion region = dexterous_region(mechanism, workspace_extents(mechanism));
  EXPECT_GT(region.area, 0.0);
  EXPECT_FALSE(region.annulus);
}

TEST(Plane, DataSheetHasWhatAPlanarDeviceCanDo) {
  const DataSheet sheet = data_sheet(describe(kPublished), {.spacing = 4e-3, .slice_points = 41});
  EXPECT_FALSE(sheet.workspace);
  ASSERT_TRUE(sheet.plane);
  ASSERT_TRUE(sheet.conditioning);
  EXPECT_EQ(sheet.tool_freedoms, 2);
  EXPECT_GT(sheet.plane->area.value, 0.0);
  EXPECT_EQ(sheet.plane->condition_regions.size(), 3u);
  EXPECT_LT(sheet.plane->condition_regions[0].area, sheet.plane->condition_regions[2].area);
  ASSERT_TRUE(sheet.middle);
  EXPECT_EQ(sheet.middle->jacobian.rows(), 2);
}

}  // namespace
}  // namespace zwidth
