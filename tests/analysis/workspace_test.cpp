#include "zwidth/analysis/workspace.h"

#include <atomic>
#include <cmath>
#include <cstring>
#include <gtest/gtest.h>
#include <numbers>
#include <random>
#include <sstream>

#include "support/deltas.h"

#include "zwidth/analysis/dexterity.h"
#include "zwidth/mechanism/families.h"
#include "zwidth/mechanism/figure.h"
#include "zwidth/mechanism/jacobian.h"
#include "zwidth/mechanism/posture.h"

namespace zwidth {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

Description published(double from_degrees, double to_degrees) {
  DeltaDescription delta = test::published_delta();
  delta.joint_range = {from_degrees * kDegree, to_degrees * kDegree};
  Description description;
  description.name = "delta";
  description.mechanism = delta;
  return description;
}

Description describe(const DeltaDescription& delta) {
  Description description;
  description.name = "delta";
  description.mechanism = delta;
  return description;
}

LatticeOptions with_torque(double torque, double spacing = 1e-3) {
  return {.spacing = spacing, .limits = {.torque = Vector3::Constant(torque)}};
}

// Neal 2015, table 3.2 (first row, to one more digit), and the same for the printed window and the continuous
// torque.
struct ForceRow {
  double from, to, torque;
  double min[3], max[3], mean[3];
};

TEST(Workspace, PublishedLatticeCountsAreExact) {
  const Mechanism printed(published(-36.0, 84.0)), shifted(published(-35.86, 84.14));
  EXPECT_EQ(sweep_workspace(printed, {}).inside, 4182280);
  const LatticeSweep sweep = sweep_workspace(shifted, {});
  EXPECT_EQ(sweep.inside, 4190376);
  EXPECT_DOUBLE_EQ(sweep.volume, 4190376e-9);
  EXPECT_NEAR(sweep.bounds[2].min, 0.068, 1e-12);
  EXPECT_NEAR(sweep.bounds[2].max, 0.236, 1e-12);
  EXPECT_EQ(sweep.lattice_points, 259 * 265 * 169);
}

TEST(Workspace, PublishedForceTableIsReproduced) {
  const ForceRow rows[] = {
      {-35.86, 84.14, 1.359, {9.327, 9.676, 15.639}, {47.620, 47.299, 159.653}, {17.255, 18.692, 25.758}},
      {-36.0, 84.0, 1.359, {9.373, 9.690, 15.647}, {47.620, 47.299, 159.653}, {17.268, 18.707, 25.781}},
      {-36.0, 84.0, 1.045, {7.207, 7.451, 12.032}, {36.617, 36.370, 122.765}, {13.278, 14.385, 19.824}},
  };
  for (const ForceRow& row : rows) {
    const Mechanism mechanism(published(row.from, row.to));
    const LatticeSweep sweep = sweep_workspace(mechanism, with_torque(row.torque));
    for (int axis = 0; axis < 3; ++axis) {
      const Statistic& force = sweep.figures[static_cast<int>(Figure::force_x) + axis];
      EXPECT_NEAR(force.min, row.min[axis], 5.01e-4);
      EXPECT_NEAR(force.max, row.max[axis], 5.01e-4);
      EXPECT_NEAR(force.mean, row.mean[axis], 5.01e-4);
    }
  }
}

TEST(Workspace, ExtremesAreMetWhereTheSweepSays) {
  const Mechanism mechanism(published(-36.0, 84.0));
  const DriveLimits limits{.torque = {1.0, 2.0, 0.5}, .step = {1e-4, 2e-4, 3e-4}};
  const LatticeSweep sweep =
      sweep_workspace(mechanism, {.spacing = 4e-3, .limits = limits, .all_figures = true});
  for (int f = 0; f < static_cast<int>(Figure::leg_singularity); ++f) {
    const Statistic& statistic = sweep.figures[f];
    EXPECT_EQ(statistic.count, sweep.inside);
    EXPECT_LE(statistic.min, statistic.mean);
    EXPECT_LE(statistic.mean, statistic.max);
    for (const bool largest : {false, true}) {
      const Vector3& p = largest ? statistic.max_at : statistic.min_at;
      const DeltaInverse pose = delta_inverse(*mechanism.delta(), p, mechanism.active_range(0));
      ASSERT_EQ(pose.status, SolveStatus::reached);
      const double expected = largest ? statistic.max : statistic.min;
      EXPECT_NEAR(jacobian_figures(pose.jacobian, limits)[f] / expected, 1.0, 1e-6) << figure_info(f).name;
      for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(std::remainder(p[axis], 4e-3), 0.0, 1e-12);
    }
  }
}

TEST(Workspace, SweepIsTheSameToTheLastBitForAnyNumberOfThreads) {
  const Mechanism delta(published(-36.0, 84.0));
  const Mechanism legs(spelled_out(published(-36.0, 84.0)));
  for (const Mechanism* mechanism : {&delta, &legs}) {
    const double spacing = mechanism == &delta ? 2e-3 : 16e-3;
    const LatticeOptions options{.spacing = spacing, .limits = {.step = Vector3::Ones()}, .all_figures = true};
    const LatticeSweep one = sweep_workspace(*mechanism, options, {.threads = 1});
    for (const int threads : {2, 4}) {
      const LatticeSweep many = sweep_workspace(*mechanism, options, {.threads = threads});
      EXPECT_EQ(one.inside, many.inside);
      for (int f = 0; f < kFigureCount; ++f) {
        EXPECT_EQ(one.figures[f].min, many.figures[f].min);
        EXPECT_EQ(one.figures[f].max, many.figures[f].max);
        EXPECT_EQ(one.figures[f].mean, many.figures[f].mean);
        EXPECT_EQ(one.figures[f].min_at, many.figures[f].min_at);
        EXPECT_EQ(one.figures[f].max_at, many.figures[f].max_at);
      }
    }
  }
}

TEST(Workspace, DeltaSpelledOutAsLegsHasTheSameWorkspace) {
  const Description description = published(-36.0, 84.0);
  const Mechanism delta(description), legs(spelled_out(description));
  ASSERT_FALSE(legs.delta());
  const LatticeOptions options{
      .spacing = 11e-3, .limits = {.torque = {1.0, 2.0, 0.5}, .step = {1e-4, 2e-4, 3e-4}}, .all_figures = true};
  const LatticeSweep a = sweep_workspace(delta, options), b = sweep_workspace(legs, options);
  EXPECT_GT(a.inside, 2000);
  EXPECT_EQ(a.inside, b.inside);
  EXPECT_EQ(a.lattice_points, b.lattice_points);
  for (int f = 0; f < static_cast<int>(Figure::leg_singularity); ++f) {
    EXPECT_NEAR(a.figures[f].min / b.figures[f].min, 1.0, 1e-7) << figure_info(f).name;
    EXPECT_NEAR(a.figures[f].max / b.figures[f].max, 1.0, 1e-7);
    EXPECT_NEAR(a.figures[f].mean / b.figures[f].mean, 1.0, 1e-8);
  }
  EXPECT_EQ(b[Figure::leg_singularity].count, 0);
}

TEST(Workspace, RealParallelogramsThatOnlyTranslateAreAccepted) {
  const Mechanism mechanism(test::with_parallelograms(test::published_delta()));
  ASSERT_EQ(mechanism.tool_rows(), 6);
  EXPECT_EQ(workspace_obstacle(mechanism), std::nullopt);
  const Mechanism delta(describe(test::published_delta()));
  EXPECT_EQ(sweep_workspace(mechanism, {.spacing = 24e-3}).inside,
            sweep_workspace(delta, {.spacing = 24e-3}).inside);
}

TEST(Workspace, CancellingStopsAndSaysSo) {
  const Mechanism mechanism(published(-36.0, 84.0));
  std::atomic<bool> cancel{true};
  const LatticeSweep sweep = sweep_workspace(mechanism, {}, {.cancel = &cancel});
  EXPECT_FALSE(sweep.complete);
  EXPECT_EQ(sweep.inside, 0);
}

TEST(Workspace, ProgressEndsAtOne) {
  const Mechanism mechanism(published(-36.0, 84.0));
  double last = 0.0;
  sweep_workspace(mechanism, {.spacing = 5e-3}, {.threads = 1, .progress = [&](double fraction) {
                                                   EXPECT_GT(fraction, last);
                                                   last = fraction;
                                                 }});
  EXPECT_EQ(last, 1.0);
}

TEST(Workspace, TooFineALatticeIsRefused) {
  const Mechanism mechanism(published(-36.0, 84.0));
  EXPECT_THROW(sweep_workspace(mechanism, {.spacing = 1e-6}), std::length_error);
}

TEST(WorkspaceMap, HoldsEveryPointThatTheSweepCounts) {
  const Description description = published(-36.0, 84.0);
  const LatticeOptions options{.spacing = 12e-3, .limits = {.step = Vector3::Ones()}, .all_figures = true};
  for (const Mechanism& mechanism : {Mechanism(description), Mechanism(spelled_out(description))}) {
    const LatticeSweep sweep = sweep_workspace(mechanism, options);
    const WorkspaceMap map = map_workspace(mechanism, options);
    ASSERT_EQ(std::ssize(map.positions), sweep.inside);
    ASSERT_EQ(map.positions.size(), map.figures.size());
    double sum = 0.0;
    for (const FigureValues& values : map.figures) sum += figure(values, Figure::force_z);
    EXPECT_NEAR(sum / static_cast<double>(sweep.inside), sweep[Figure::force_z].mean, 1e-9);
    for (std::size_t p = 1; p < map.positions.size(); ++p) {
      const Vector3 &a = map.positions[p - 1], &b = map.positions[p];
      EXPECT_TRUE(std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3));
    }
  }
}

TEST(WorkspaceMap, NpyAndCsvReadBackAsTheSameNumbers) {
  const Mechanism mechanism(published(-36.0, 84.0));
  const WorkspaceMap map = map_workspace(mechanism, {.spacing = 20e-3});
  const std::size_t columns = map.columns().size();
  ASSERT_EQ(columns, 3u + kCoreFigureCount);

  std::ostringstream npy;
  write_npy(map, npy);
  const std::string bytes = npy.str();
  ASSERT_EQ(bytes.substr(0, 8), std::string("\x93NUMPY\x01\x00", 8));
  const std::size_t header = static_cast<unsigned char>(bytes[8]) + 256u * static_cast<unsigned char>(bytes[9]);
  EXPECT_EQ((10 + header) % 64, 0u);
  EXPECT_NE(bytes.find("'shape': (" + std::to_string(map.positions.size()) + ", 8)"), std::string::npos);
  ASSERT_EQ(bytes.size(), 10 + header + 8 * columns * map.positions.size());
  const auto number = [&](std::size_t row, std::size_t column) {
    double value = 0.0;
    std::memcpy(&value, bytes.data() + 10 + header + 8 * (row * columns + column), 8);
    return value;
  };

  std::ostringstream csv;
  write_csv(map, csv);
  std::istringstream lines(csv.str());
  std::string line;
  std::getline(lines, line);
  EXPECT_EQ(line, "x,y,z,condition_number,manipulability,force_x,force_y,force_z");
  for (std::size_t p = 0; p < map.positions.size(); ++p) {
    ASSERT_TRUE(std::getline(lines, line));
    std::istringstream cells(line);
    std::string cell;
    for (std::size_t c = 0; c < columns; ++c) {
      ASSERT_TRUE(std::getline(cells, cell, ','));
      const auto at = static_cast<Eigen::Index>(c);
      const double expected = c < 3 ? map.positions[p][at] : map.figures[p][c - 3];
      EXPECT_EQ(std::stod(cell), expected);
      EXPECT_EQ(number(p, c), expected);
    }
  }
  EXPECT_FALSE(std::getline(lines, line));
}

TEST(Workspace, LatticeVolumeTendsToTheIntegral) {
  std::mt19937_64 random(11);
  for (int design = 0; design < 6; ++design) {
    const Mechanism mechanism(describe(test::random_delta(random)));
    const WorkspaceVolume volume = workspace_volume(mechanism);
    const double size = workspace_extents(mechanism).size().maxCoeff();
    const double h = size / 160.0;
    const double counted = sweep_workspace(mechanism, {.spacing = h}).volume;
    // Points on the boundary layer, area x h, count with random sign: far less than the layer itself.
    const double layer = 6.0 * size * size * h;
    EXPECT_NEAR(counted, volume.value, 0.02 * layer + volume.error_estimate) << to_string(volume.method);
  }
}

// Two revolute joints about parallel axes, with a slide along them or a third across.
SerialDescription positioning_arm(bool slides) {
  const auto row = [](const char* name, double theta, double d, double a, double alpha, Interval range) {
    return SerialJointDescription{
        .name = name, .theta = theta, .d = d, .a = a, .alpha = alpha, .range = range, .home = range.middle()};
  };
  SerialDescription arm;
  arm.platform = PlatformFreedom::point;
  if (slides) {
    arm.joints.push_back(row("slide", 0.0, 0.0, 0.095, 0.0, {0.0, 0.1}));
    arm.joints.back().type = SerialJointType::prismatic;
  }
  arm.joints.push_back(row("one", 0.0, 0.0, 0.225, 0.0, {-1.0, 1.0}));
  arm.joints.push_back(
      row("two", -1.2, 0.03, slides ? 0.15 : 0.1, slides ? 0.0 : 0.5 * std::numbers::pi, {-0.9, 1.1}));
  if (!slides) arm.joints.push_back(row("three", 0.0, 0.0, 0.2, 0.0, {-0.5, 0.8}));
  return arm;
}

TEST(Workspace, OfPositioningArmsIsWhereSomePostureIsWithinTheRanges) {
  for (const bool slides : {true, false}) {
    Description description;
    description.name = "arm";
    description.mechanism = positioning_arm(slides);
    const Mechanism mechanism(description);
    const JacobianScale scale = jacobian_scale(mechanism);
    constexpr double h = 0.013;
    const LatticeSweep sweep = sweep_workspace(mechanism, {.spacing = h});
    std::int64_t inside = 0;
    double least = 1e9;
    for (int i = -45; i <= 45; ++i) {
      for (int j = -45; j <= 45; ++j) {
        for (int k = -25; k <= 25; ++k) {
          const Pose goal{.position = h * Vector3(i, j, k)};
          double best = 0.0;
          for (const Solution& solution : solve_inverse_all(mechanism, goal)) {
            if (solution.status == SolveStatus::joint_limit) continue;
            best = 1.0;
            least = std::min(least, scale.condition_number(jacobian(*solution.posture)));
          }
          if (best > 0.0) ++inside;
        }
      }
    }
    EXPECT_GT(inside, 500);
    EXPECT_EQ(sweep.inside, inside) << slides;
    EXPECT_NEAR(sweep[Figure::condition_number].min, least, 1e-9 * least);
  }
}

TEST(Workspace, ConditionNumbersAreThoseOfTheSingularValues) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  for (int n = 0; n < 2000; ++n) {
    Matrix3 J = Matrix3::NullaryExpr([&] { return normal(random); });
    if (n % 3 == 0) J.col(0) = J.col(1) + std::pow(10.0, -0.003 * n) * J.col(0);
    if (n % 3 == 1) J = Matrix3::Identity() + 1e-9 * J;
    const double K = dexterity(Jacobian(J)).condition_number;
    const double found = figure(jacobian_figures(J, {}), Figure::condition_number);
    EXPECT_NEAR(found, K, 1e-11 * K + 1e-15 * K * K) << n;
  }
}

}  // namespace
}  // namespace zwidth
