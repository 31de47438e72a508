#include "zwidth/mechanism/batch_delta.h"

#include <Eigen/LU>
#include <cmath>
#include <gtest/gtest.h>
#include <hwy/targets.h>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "support/deltas.h"
#include "support/storm.h"

#include "zwidth/mechanism/jacobian.h"

namespace zwidth {
namespace {

using test::uniform;

// Runs `body` on every instruction set that this machine has, the portable one included.
template <class Body>
void on_every_target(const Body& body) {
  const auto attainable = hwy::SupportedTargets();
  for (auto rest = attainable; rest != 0; rest &= rest - 1) {
    const auto target = rest & ~(rest - 1);
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    body(std::string(batch_target_name()));
  }
  hwy::SetSupportedTargetsForTest(0);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

struct Points {
  std::vector<double> x, y, z;
  std::size_t size() const { return x.size(); }
  Vector3 operator[](std::size_t p) const { return {x[p], y[p], z[p]}; }
  void add(const Vector3& p) {
    x.push_back(p.x());
    y.push_back(p.y());
    z.push_back(p.z());
  }
};

// Points around a delta, many of them out of reach.
Points random_points(std::mt19937_64& random, const DeltaGeometry& geometry, int count) {
  Points points;
  const double reach = geometry.upper_arm + geometry.forearm;
  for (int n = 0; n < count; ++n) {
    points.add(
        {uniform(random, -reach, reach), uniform(random, -reach, reach), uniform(random, -reach, reach)});
  }
  return points;
}

DriveLimits random_limits(std::mt19937_64& random) {
  DriveLimits limits;
  for (int j = 0; j < 3; ++j) {
    limits.torque[j] = uniform(random, 0.2, 3.0);
    limits.step[j] = uniform(random, 1e-5, 1e-3);
  }
  return limits;
}

// Inside by the one-pose code, with the distance [rad] by which that could be wrong.
struct OnePose {
  bool inside = false;
  double doubt = 0.0;
  DeltaInverse inverse;
};

OnePose one_pose(const DeltaGeometry& geometry, const Vector3& p, const Interval& range) {
  OnePose result;
  result.inverse = delta_inverse(geometry, p, range);
  const SolveStatus status = result.inverse.status;
  result.doubt = 1.0;
  if (status == SolveStatus::unreachable || status == SolveStatus::degenerate) return result;
  for (int j = 0; j < 3; ++j) {
    // Angles are known modulo a turn.
    const double turn = 2.0 * std::numbers::pi;
    for (const double end : {range.min - 1e-9, range.max + 1e-9}) {
      result.doubt = std::min(result.doubt, std::abs(std::remainder(result.inverse.theta[j] - end, turn)));
    }
  }
  const DeltaForward forward = delta_forward(geometry, result.inverse.theta);
  result.inside = status != SolveStatus::joint_limit && (forward.position - p).norm() < 1e-6 * geometry.scale();
  return result;
}

TEST(BatchDelta, InsideAgreesWithOnePoseOnAnyJointRange) {
  std::mt19937_64 random(1);
  const int designs = test::storm_size(60);
  for (int design = 0; design < designs; ++design) {
    const DeltaDescription delta = test::random_delta(random);
    const DeltaGeometry geometry = delta_geometry(delta);
    const double width = uniform(random, 0.01, 2.0 * std::numbers::pi), low = uniform(random, -3.0, 1.0);
    const Interval range = design % 3 == 0 ? delta.joint_range : Interval{low, low + width};
    const DeltaBatch batch(geometry, range);
    const Points points = random_points(random, geometry, 501);
    on_every_target([&](const std::string& target) {
      std::vector<std::uint8_t> inside(points.size());
      batch.inside(points.x, points.y, points.z, inside);
      int disagreements = 0;
      for (std::size_t p = 0; p < points.size(); ++p) {
        const OnePose expected = one_pose(geometry, points[p], range);
        if (expected.doubt > 1e-8) disagreements += expected.inside != (inside[p] != 0);
      }
      EXPECT_EQ(disagreements, 0) << target << " design " << design;
    });
  }
}

TEST(BatchDelta, LimitsHoldToTheToleranceOfTheOnePoseCode) {
  const DeltaGeometry geometry = delta_geometry(test::published_delta());
  for (const double width : {1e-5, 0.5, 3.0, 3.5, 6.0}) {
    const Interval range{-0.6, -0.6 + width};
    const DeltaBatch batch(geometry, range);
    for (const double beyond : {0.2e-9, 5e-9}) {
      // All legs at the lower end, less a little.
      const DeltaForward forward = delta_forward(geometry, Vector3::Constant(range.min - beyond));
      const Vector3& p = forward.position;
      const bool expected = delta_inverse(geometry, p, range).status != SolveStatus::joint_limit;
      EXPECT_EQ(expected, beyond < 1e-9);
      std::uint8_t inside = 2;
      on_every_target([&](const std::string& target) {
        batch.inside({&p.x(), 1}, {&p.y(), 1}, {&p.z(), 1}, {&inside, 1});
        EXPECT_EQ(inside != 0, expected) << target << " width " << width << " beyond " << beyond;
      });
    }
  }
}

TEST(BatchDelta, InverseGivesTheAnglesOfTheOnePoseCode) {
  std::mt19937_64 random(2);
  for (int design = 0; design < 20; ++design) {
    const DeltaDescription delta = test::random_delta(random);
    const DeltaGeometry geometry = delta_geometry(delta);
    const DeltaBatch batch(geometry, delta.joint_range);
    const Points points = random_points(random, geometry, 333);
    const std::size_t n = points.size();
    on_every_target([&](const std::string& target) {
      std::vector<double> cosine(3 * n), sine(3 * n);
      std::vector<std::uint8_t> inside(n);
      batch.inverse(points.x, points.y, points.z, cosine, sine, inside);
      for (std::size_t p = 0; p < n; ++p) {
        const DeltaInverse expected = delta_inverse(geometry, points[p], delta.joint_range);
        if (expected.status == SolveStatus::unreachable) {
          EXPECT_TRUE(std::isnan(cosine[p]) || std::isnan(cosine[n + p]) || std::isnan(cosine[2 * n + p]));
          continue;
        }
        for (std::size_t leg = 0; leg < 3; ++leg) {
          const double theta = expected.theta[static_cast<Eigen::Index>(leg)];
          // The root's own condition: errors grow as the arm stretches, at worst to sqrt(1e-16).
          EXPECT_NEAR(cosine[leg * n + p], std::cos(theta), 1e-7) << target;
          EXPECT_NEAR(sine[leg * n + p], std::sin(theta), 1e-7) << target;
          EXPECT_NEAR(std::hypot(cosine[leg * n + p], sine[leg * n + p]), 1.0, 1e-12);
        }
      }
    });
  }
}

TEST(BatchDelta, FiguresAgreeWithSingularValuesAndPolytopesOfOnePose) {
  std::mt19937_64 random(3);
  const int designs = test::storm_size(40);
  double worst_condition = 0.0, worst_other = 0.0;
  long compared = 0;
  for (int design = 0; design < designs; ++design) {
    const DeltaDescription delta = test::random_delta(random);
    const DeltaGeometry geometry = delta_geometry(delta);
    const DriveLimits limits = random_limits(random);
    const DeltaBatch batch(geometry, delta.joint_range, limits);
    Points points;
    for (int n = 0; n < 251; ++n) {
      const DeltaForward forward = delta_forward(geometry, test::random_angles(random, delta.joint_range));
      if (forward.status == SolveStatus::reached) points.add(forward.position);
    }
    const std::size_t n = points.size();
    on_every_target([&](const std::string&) {
      std::vector<double> values(n * kFigureCount);
      batch.figures(points.x, points.y, points.z, values);
      for (std::size_t p = 0; p < n; ++p) {
        if (std::isnan(values[p])) continue;
        const DeltaInverse pose = delta_inverse(geometry, points[p], delta.joint_range);
        FigureValues expected = jacobian_figures(pose.jacobian, limits);
        const DeltaState state(geometry, pose.theta, points[p]);
        expected[10] = state.inverse_singularity().cwiseAbs().minCoeff();
        expected[11] = std::abs(state.direct_singularity());
        // J is known to rounding over its distances from singularity, and the closed form for singular values
        // loses digits as two of them come together.
        const Eigen::Vector3d sigma = Eigen::JacobiSVD<Matrix3>(pose.jacobian).singularValues();
        const double gap = std::min(sigma[0] - sigma[1], sigma[1] - sigma[2]) / sigma[0];
        if (expected[10] < 0.1 || expected[11] < 0.1 || gap < 0.05) continue;
        ++compared;
        worst_condition = std::max(worst_condition, std::abs(values[p] / expected[0] - 1.0));
        for (std::size_t f = 1; f < kFigureCount; ++f) {
          worst_other = std::max(worst_other, std::abs(values[f * n + p] / expected[f] - 1.0));
        }
      }
    });
  }
  EXPECT_GT(compared, 1000);
  EXPECT_LT(worst_condition, 5e-12);
  EXPECT_LT(worst_other, 2e-12);
}

TEST(BatchDelta, ConditionNumberHoldsWhereSingularValuesCoincide) {
  // On the axis of symmetry two singular values are equal: half of the digits must remain.
  const DeltaGeometry geometry = delta_geometry(test::published_delta());
  const DeltaBatch batch(geometry, test::published_delta().joint_range);
  Points points;
  for (int n = 0; n < 100; ++n) points.add({0.0, 0.0, 0.08 + 0.0015 * n});
  std::vector<double> values(points.size() * kFigureCount);
  batch.figures(points.x, points.y, points.z, values);
  for (std::size_t p = 0; p < points.size(); ++p) {
    if (std::isnan(values[p])) continue;
    const Matrix3 J = delta_inverse(geometry, points[p], test::published_delta().joint_range).jacobian;
    EXPECT_NEAR(values[p] / jacobian_figures(J, {})[0], 1.0, 1e-7);
  }
}

TEST(BatchDelta, ForwardAgreesWithOnePose) {
  std::mt19937_64 random(4);
  for (int design = 0; design < 30; ++design) {
    const DeltaDescription delta = test::random_delta(random);
    const DeltaGeometry geometry = delta_geometry(delta);
    const DeltaBatch batch(geometry, delta.joint_range);
    const std::size_t n = 203;
    std::vector<Vector3> angles;
    std::vector<double> cosine(3 * n), sine(3 * n);
    for (std::size_t p = 0; p < n; ++p) {
      angles.push_back(test::random_angles(random, {-1.5, 1.5}));
      for (std::size_t leg = 0; leg < 3; ++leg) {
        cosine[leg * n + p] = std::cos(angles[p][static_cast<Eigen::Index>(leg)]);
        sine[leg * n + p] = std::sin(angles[p][static_cast<Eigen::Index>(leg)]);
      }
    }
    on_every_target([&](const std::string& target) {
      std::vector<double> x(n), y(n), z(n), det(n);
      batch.forward(cosine, sine, x, y, z, det);
      for (std::size_t p = 0; p < n; ++p) {
        const DeltaForward expected = delta_forward(geometry, angles[p]);
        if (expected.status == SolveStatus::unreachable) {
          EXPECT_TRUE(std::isnan(x[p]));
        } else if (expected.status == SolveStatus::reached) {
          EXPECT_LT((Vector3(x[p], y[p], z[p]) - expected.position).norm(), 1e-9 * geometry.scale()) << target;
          const double determinant = expected.jacobian.determinant();
          EXPECT_NEAR(det[p], determinant, 1e-8 * std::abs(determinant) + 1e-18) << target;
        }
      }
    });
  }
}

TEST(BatchDelta, PlaneSweepCountsWhatPointTestsCount) {
  // The sweep looks only between closed-form ends of every column; counting all points must give the same.
  std::mt19937_64 random(5);
  for (int design = 0; design < 25; ++design) {
    const DeltaDescription delta = test::random_delta(random);
    const DeltaGeometry geometry = delta_geometry(delta);
    const double low = uniform(random, -3.0, 0.0), width = uniform(random, 0.3, 2.0 * std::numbers::pi);
    const Interval range = design % 2 == 0 ? delta.joint_range : Interval{low, low + width};
    const DeltaBatch batch(geometry, range, random_limits(random));
    const auto box = batch.reach_box();
    const double h = box[0].width() / 60.0;
    const auto indices = [h](const Interval& side) {
      return DeltaBatch::IndexRange{static_cast<std::int64_t>(std::ceil(side.min / h)),
                                    static_cast<std::int64_t>(std::floor(side.max / h))};
    };
    const auto i_range = indices(box[0]), j_range = indices(box[1]), k_range = indices(box[2]);
    for (std::int64_t i = i_range.first; i <= i_range.last; i += 7) {
      Points points;
      for (std::int64_t j = j_range.first; j <= j_range.last; ++j) {
        for (std::int64_t k = k_range.first; k <= k_range.last; ++k) {
          points.add(h * Vector3(static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)));
        }
      }
      const std::size_t n = points.size();
      std::vector<double> values(n * kFigureCount);
      batch.figures(points.x, points.y, points.z, values);
      std::int64_t inside = 0;
      FigureValues sum{}, min, max;
      min.fill(1e300);
      max.fill(-1e300);
      for (std::size_t p = 0; p < n; ++p) {
        if (std::isnan(values[p])) continue;
        ++inside;
        for (std::size_t f = 0; f < kFigureCount; ++f) {
          sum[f] += values[f * n + p];
          min[f] = std::min(min[f], values[f * n + p]);
          max[f] = std::max(max[f], values[f * n + p]);
        }
      }
      on_every_target([&](const std::string& target) {
        for (const bool all : {false, true}) {
          const DeltaBatch::PlaneSummary plane = batch.sweep_plane(i, j_range, k_range, h, all);
          ASSERT_EQ(plane.inside, inside) << target << " design " << design << " plane " << i;
          if (inside == 0) continue;
          for (std::size_t f = 0; f < static_cast<std::size_t>(all ? kFigureCount : kCoreFigureCount); ++f) {
            EXPECT_NEAR(plane.sum[f] / sum[f], 1.0, 1e-6) << target << figure_info(static_cast<int>(f)).name;
            EXPECT_NEAR(plane.min[f].value / min[f], 1.0, 1e-6);
            EXPECT_NEAR(plane.max[f].value / max[f], 1.0, 1e-6);
          }
        }
      });
    }
  }
}

}  // namespace
}  // namespace zwidth
