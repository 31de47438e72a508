#include "zwidth/analysis/pose_workspace.h"

#include <functional>
#include <gtest/gtest.h>
#include <numbers>
#include <queue>
#include <random>
#include <set>
#include <stdexcept>

#include "support/platforms.h"
#include "support/random_mechanisms.h"

#include "zwidth/mechanism/posture.h"

// The general solver, led over a lattice, against inverses written out for one kind of platform each.

namespace zwidth {
namespace {

using std::numbers::pi;
using test::hexapod;
using test::Hexapod;
using test::ThreeRrr;

constexpr std::array<int, 3> kOrigin{};

Matrix3 turned(const Vector3& axis, double angle) {
  return Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix();
}

// Lattice points of a set that are connected with the one nearest to a place.
std::set<std::array<int, 3>> connected(const std::function<bool(const Vector3&)>& inside, const Vector3& from,
                                       double spacing, int dimension) {
  std::array<int, 3> start = kOrigin;
  for (int k = 0; k < dimension; ++k) start[k] = static_cast<int>(std::lround(from[k] / spacing));
  std::set<std::array<int, 3>> found{start};
  std::queue<std::array<int, 3>> fresh;
  fresh.push(start);
  while (!fresh.empty()) {
    const std::array<int, 3> at = fresh.front();
    fresh.pop();
    for (int k = 0; k < 2 * dimension; ++k) {
      std::array<int, 3> next = at;
      next[k / 2] += k % 2 == 0 ? -1 : 1;
      if (found.contains(next) || !inside(spacing * Vector3(next[0], next[1], next[2]))) continue;
      found.insert(next);
      fresh.push(next);
    }
  }
  return found;
}

// How many of a workspace's places the other route does not find, and how many it finds besides.
int differences(const PoseWorkspace& workspace, const std::set<std::array<int, 3>>& expected) {
  int count = 0;
  std::set<std::array<int, 3>> rest = expected;
  for (const Vector3& place : workspace.places) {
    std::array<int, 3> at{};
    for (int k = 0; k < 3; ++k) at[k] = static_cast<int>(std::lround(place[k] / workspace.spacing));
    count += rest.erase(at) == 0 ? 1 : 0;
  }
  return count + static_cast<int>(rest.size());
}

// Largest way from a point in a direction while a set goes on.
double way(const std::function<bool(const Vector3&)>& inside, const Vector3& from, const Vector3& direction) {
  double in = 0.0, out = 0.0;
  for (out = 1e-3; inside(from + out * direction); out += 1e-3) in = out;
  for (int step = 0; step < 50; ++step) {
    const double middle = 0.5 * (in + out);
    (inside(from + middle * direction) ? in : out) = middle;
  }
  return in;
}

TEST(PoseWorkspace, OfAHexapodIsWhereEveryStrutIsLongEnough) {
  for (const Hexapod& design : {hexapod(), hexapod(0.11, 0.07, 0.16, 0.025)}) {
    const Mechanism mechanism(design.description());
    ASSERT_FALSE(pose_workspace_obstacle(mechanism));
    const PoseWorkspace workspace =
        pose_workspace(mechanism, {.spacing = 0.008, .shapes = false, .turning = false, .slice_points = 0});
    ASSERT_TRUE(workspace.reached && workspace.complete);
    EXPECT_EQ(workspace.axes, (std::vector<int>{0, 1, 2}));
    const auto inside = [&](const Vector3& p) { return design.reaches({.position = p}); };
    EXPECT_EQ(differences(workspace, connected(inside, design.home(), workspace.spacing, 3)), 0);
  }
}

TEST(PoseWorkspace, OfAHexapodHasItsVolumeWithinTheErrorEstimate) {
  const Hexapod design = hexapod();
  const auto inside = [&](const Vector3& p) { return design.reaches({.position = p}); };
  // By columns, whose ends are found by bisection: 2 mm apart, of second order in that.
  double volume = 0.0;
  constexpr double h = 2e-3;
  std::array<Interval, 3> range;
  range.fill({1e9, -1e9});
  for (int i = -65; i <= 65; ++i) {
    for (int j = -65; j <= 65; ++j) {
      double bottom = 0.0;
      for (bottom = 0.1; bottom < 0.3 && !inside({i * h, j * h, bottom}); bottom += 1e-3) {
      }
      if (bottom >= 0.3) continue;
      const Vector3 start(i * h, j * h, bottom);
      const double low = bottom - way(inside, start, -Vector3::UnitZ());
      const double high = bottom + way(inside, start, Vector3::UnitZ());
      volume += h * h * (high - low);
      range[0] = {std::min(range[0].min, i * h), std::max(range[0].max, i * h)};
      range[1] = {std::min(range[1].min, j * h), std::max(range[1].max, j * h)};
      range[2] = {std::min(range[2].min, low), std::max(range[2].max, high)};
    }
  }
  for (const double spacing : {0.006, 0.01}) {
    const bool closely = spacing > 0.008;
    const PoseWorkspace workspace =
        pose_workspace(Mechanism(design.description()),
                       {.spacing = spacing, .shapes = closely, .turning = false, .slice_points = 0});
    EXPECT_NEAR(workspace.measure, volume, 3.0 * workspace.error_estimate) << spacing;
    EXPECT_LT(workspace.error_estimate, 0.02 * volume);
    for (int k = 0; k < 3 && closely; ++k) {
      // The columns may miss the last millimetres.
      EXPECT_GE(workspace.range[k].max, range[k].max - 1e-5);
      EXPECT_LE(workspace.range[k].max, range[k].max + 2.0 * h);
      EXPECT_LE(workspace.range[k].min, range[k].min + 1e-5);
      EXPECT_GE(workspace.range[k].min, range[k].min - 2.0 * h);
    }
  }
}

TEST(PoseWorkspace, OfAHexapodHoldsItsLargestSphere) {
  // From home every strut can change by its stroke, and no place nearer than the stroke asks for more: the
  // sphere of that radius round home touches all twelve ends at once, and every way of leaving it is worse.
  const Hexapod design = hexapod();
  const PoseWorkspace workspace =
      pose_workspace(Mechanism(design.description()), {.spacing = 0.02, .turning = false, .slice_points = 0});
  const InscribedShape& sphere = workspace.inscribed.sphere;
  EXPECT_NEAR(sphere.size, design.stroke, 1e-5 * design.stroke);
  const InscribedShape& cube = workspace.inscribed.cube;
  const auto inside = [&](const Vector3& p) { return design.reaches({.position = p}); };
  double spare = 1.0;
  for (int i = -10; i <= 10; ++i) {
    for (int j = -10; j <= 10; ++j) {
      for (const double side : {-1.0, 1.0}) {
        for (int axis = 0; axis < 3; ++axis) {
          Vector3 u;
          u[axis] = side;
          u[(axis + 1) % 3] = 0.1 * i;
          u[(axis + 2) % 3] = 0.1 * j;
          EXPECT_TRUE(inside(cube.centre + 0.5 * cube.size * u * (1.0 - 1e-6)));
          spare = std::min(spare, way(inside, cube.centre + 0.5 * cube.size * u * (1.0 - 1e-6), u));
        }
      }
    }
  }
  EXPECT_LT(spare, 1e-4);  // it touches
}

TEST(PoseWorkspace, OfAPlanarPlatformIsWhereTheCirclesMeet) {
  for (const ThreeRrr& design :
       {ThreeRrr{},
        ThreeRrr{
            .base_radius = 0.1, .crank = 0.07, .coupler = 0.09, .plate_radius = 0.03, .half_range = 0.7}}) {
    for (const double yaw : {0.0, 0.3, -0.4}) {
      const Mechanism mechanism(design.description());
      ASSERT_FALSE(pose_workspace_obstacle(mechanism));
      const Matrix3 rotation = turned(Vector3::UnitZ(), yaw);
      const PoseWorkspace workspace = pose_workspace(
          mechanism,
          {.spacing = 0.002, .orientation = rotation, .shapes = false, .turning = false, .slice_points = 0});
      ASSERT_TRUE(workspace.reached);
      EXPECT_EQ(workspace.axes, (std::vector<int>{0, 1}));
      const auto inside = [&](const Vector3& p) { return design.reaches({p, rotation}); };
      const auto expected = connected(inside, workspace.from, workspace.spacing, 2);
      // A place within rounding of the boundary may go either way.
      EXPECT_LE(differences(workspace, expected), 1) << yaw;
      const auto fine = connected(inside, workspace.from, 0.001, 2);
      EXPECT_NEAR(workspace.measure, static_cast<double>(fine.size()) * 1e-6,
                  3.0 * workspace.error_estimate + 1e-5);
    }
  }
}

TEST(PoseWorkspace, TellsHowFarThePlatformTurns) {
  const Hexapod design = hexapod();
  const PoseWorkspace workspace =
      pose_workspace(Mechanism(design.description()), {.spacing = 0.02, .shapes = false, .slice_points = 0});
  const TurningRange& turning = workspace.turning;
  ASSERT_TRUE(turning.reached);
  for (int axis = 0; axis < 3; ++axis) {
    const auto inside = [&](const Vector3& angle) {
      return design.reaches({design.home(), turned(Vector3::Unit(axis), angle.x())});
    };
    ASSERT_TRUE(turning.about[axis]);
    EXPECT_NEAR(turning.about[axis]->max, way(inside, Vector3::Zero(), Vector3::UnitX()), 1e-7);
    EXPECT_NEAR(turning.about[axis]->min, -way(inside, Vector3::Zero(), -Vector3::UnitX()), 1e-7);
  }
  // Of orientations drawn evenly, the share that the struts allow within the turns that a way from home allows.
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal;
  int hits = 0;
  constexpr int kDraws = 100'000;
  for (int n = 0; n < kDraws; ++n) {
    const Eigen::Quaterniond q(normal(random), normal(random), normal(random), normal(random));
    const Matrix3 R = q.normalized().toRotationMatrix();
    const Eigen::AngleAxisd turn(R);
    bool all = true;
    for (int k = 1; k <= 12 && all; ++k)
      all = design.reaches({design.home(), turned(turn.axis(), k * turn.angle() / 12)});
    hits += all ? 1 : 0;
  }
  const double share = static_cast<double>(hits) / kDraws, deviation = std::sqrt(share / kDraws);
  ASSERT_TRUE(turning.share);
  EXPECT_NEAR(*turning.share, share, 4.0 * deviation + 3.0 * turning.share_error);

  const ThreeRrr plane;
  const PoseWorkspace flat =
      pose_workspace(Mechanism(plane.description()), {.spacing = 0.01, .shapes = false, .slice_points = 0});
  const auto inside = [&](const Vector3& angle) {
    return plane.reaches({Vector3::Zero(), turned(Vector3::UnitZ(), angle.x())});
  };
  ASSERT_TRUE(flat.turning.about[2]);
  EXPECT_FALSE(flat.turning.about[0] || flat.turning.about[1]);
  EXPECT_NEAR(flat.turning.about[2]->max, way(inside, Vector3::Zero(), Vector3::UnitX()), 1e-7);
  EXPECT_NEAR(flat.turning.about[2]->min, -way(inside, Vector3::Zero(), -Vector3::UnitX()), 1e-7);
  EXPECT_NEAR(*flat.turning.share, flat.turning.about[2]->width() / (2.0 * pi), 1e-9);
}

TEST(PoseWorkspace, CutsThroughHomeFollowTheBoundary) {
  const Hexapod design = hexapod();
  const PoseWorkspace workspace =
      pose_workspace(Mechanism(design.description()),
                     {.spacing = 0.02, .shapes = false, .turning = false, .slice_points = 41});
  const auto inside = [&](const Vector3& p) { return design.reaches({.position = p}); };
  ASSERT_EQ(workspace.slices.size(), 3U);
  for (const ReachSlice& cut : workspace.slices) {
    ASSERT_EQ(cut.slice.outlines.size(), 1U);
    for (const auto& point : cut.slice.outlines.front()) {
      Vector3 p = design.home();
      p[cut.slice.u] = point[0];
      p[cut.slice.v] = point[1];
      const Vector3 inwards = design.home() - p;
      EXPECT_TRUE(inside(p + 1e-3 * inwards));
      EXPECT_FALSE(inside(p - 1e-3 * inwards));
    }
  }
}

// The union over angles of where the circles meet, counted without the general solver.
TEST(PoseWorkspace, InAnyOrientationIsTheUnionOverOrientations) {
  const ThreeRrr design;
  const Mechanism mechanism(design.description());
  const PoseWorkspace workspace = pose_workspace(
      mechanism, {.spacing = 0.004, .shapes = false, .turning = false, .any_places = 8'000, .slice_points = 0});
  ASSERT_TRUE(workspace.any);
  const AnyOrientation& any = *workspace.any;
  std::int64_t count = 0;
  double shares = 0.0;
  const double h = any.spacing;
  const auto span = static_cast<int>(0.3 / h);
  constexpr int kAngles = 720;
  for (int i = -span; i <= span; ++i) {
    for (int j = -span; j <= span; ++j) {
      int angles = 0;
      for (int a = 0; a < kAngles; ++a) {
        const double yaw = pi * (2.0 * a / kAngles - 1.0);
        angles += design.reaches({{i * h, j * h, 0.0}, turned(Vector3::UnitZ(), yaw)}) ? 1 : 0;
      }
      count += angles > 0 ? 1 : 0;
      shares += angles / static_cast<double>(kAngles);
    }
  }
  // What the plate can be led to is at the most what its legs allow; here little is cut off by singular
  // postures.
  EXPECT_LE(static_cast<double>(any.inside), 1.02 * static_cast<double>(count));  // slivers between the angles
  EXPECT_GT(static_cast<double>(any.inside), 0.9 * static_cast<double>(count));
  EXPECT_GT(any.measure, workspace.measure);
  ASSERT_TRUE(any.share);
  EXPECT_GT(any.places, 20);
  EXPECT_LE(any.share->mean, 1.1 * shares / static_cast<double>(count));
  // Turned ever farther every way, ever fewer places are left.
  for (std::size_t k = 1; k < any.turned.size(); ++k)
    EXPECT_LE(any.turned[k].measure, any.turned[k - 1].measure);
}

TEST(PoseWorkspace, EveryPlaceInAnyOrientationIsOneOfTheHexapods) {
  const Hexapod design = hexapod();
  const Mechanism mechanism(design.description());
  const PoseWorkspace workspace = pose_workspace(
      mechanism, {.spacing = 0.02, .shapes = false, .turning = false, .any_places = 600, .slice_points = 0});
  ASSERT_TRUE(workspace.any && workspace.any->share);
  EXPECT_GT(workspace.any->measure, 1.5 * workspace.measure);
  // No strut is longer than its stroke allows, whatever the orientation: the plate's middle stays within the
  // reach of a strut and the plate's radius.
  EXPECT_LT(workspace.any->range[2].max, design.height + design.stroke + 0.06);
  EXPECT_LE(workspace.any->share->most, 1.0);
  EXPECT_GE(workspace.any->share->least, 0.0);
  EXPECT_GT(workspace.any->turned[0].measure, 0.0);
}

// A tool of three freedoms among six components: the others come as they do.
TEST(PoseWorkspace, OfATripodThatHeavesAndTilts) {
  const test::ThreeRps design;
  const Mechanism mechanism(design.description());
  ASSERT_FALSE(pose_workspace_obstacle(mechanism));
  const ActiveVector limit = Vector3::Constant(10.0);
  const PoseWorkspace workspace =
      pose_workspace(mechanism, {.torque = [&](const Posture&) { return TorqueRange::symmetric(limit); }});
  ASSERT_TRUE(workspace.reached);
  EXPECT_EQ(workspace.axes, (std::vector<int>{2}));
  EXPECT_NEAR(workspace.range[2].min, design.height_at(-design.stroke), 1e-5);
  EXPECT_NEAR(workspace.range[2].max, design.height_at(design.stroke), 1e-5);
  EXPECT_NEAR(workspace.measure, workspace.range[2].width(), 1e-4);
  for (const int axis : {0, 1}) {
    ASSERT_TRUE(workspace.turning.about[axis]);
    // The balls sit 80 mm and 69 mm from the axes, and each leg has 30 mm either way.
    EXPECT_GT(workspace.turning.about[axis]->max, 0.3);
    EXPECT_LT(workspace.turning.about[axis]->min, -0.3);
  }
  EXPECT_FALSE(workspace.turning.about[2]);
  ASSERT_TRUE(workspace.turning.share);  // of the directions of its axis
  EXPECT_GT(*workspace.turning.share, 0.01);
  // Upwards the three legs push together.
  EXPECT_EQ(workspace.force[0].count, 0);
  const double slope = design.height / std::hypot(design.base_radius - design.plate_radius, design.height);
  EXPECT_GT(workspace.force[2].max, 30.0 * slope);
  EXPECT_LT(workspace.force[2].min, 30.0 * slope);
}

TEST(PoseWorkspace, ForcesAreThoseOfTheJacobianThere) {
  const Mechanism mechanism(ThreeRrr{}.description());
  const ActiveVector limit = Vector3(0.2, 0.3, 0.4);
  const PoseWorkspace workspace =
      pose_workspace(mechanism, {.spacing = 0.008,
                                 .shapes = false,
                                 .turning = false,
                                 .torque = [&](const Posture&) { return TorqueRange::symmetric(limit); },
                                 .slice_points = 0});
  ASSERT_GT(workspace.force[0].count, 0);
  EXPECT_EQ(workspace.force[2].count, 0);
  EXPECT_EQ(workspace.moment[0].count, 0);
  const auto at = [&](const Vector3& place) {
    return jacobian(*solve_inverse(mechanism, {.position = place}).posture);
  };
  EXPECT_NEAR(axis_force_limits(Jacobian(at(workspace.force[1].min_at).topRows(2)), limit)[1],
              workspace.force[1].min, 1e-9);
  EXPECT_NEAR(axis_force_limits(Jacobian(at(workspace.moment[2].max_at).bottomRows(1)), limit)[0],
              workspace.moment[2].max, 1e-9);
}

TEST(PoseWorkspace, DoesNotDependOnThreads) {
  const Mechanism plane(ThreeRrr{}.description()), space(hexapod().description());
  for (const auto& [mechanism, options] :
       {std::pair(&plane, PoseWorkspaceOptions{.spacing = 0.004, .slice_points = 21}),
        std::pair(&space, PoseWorkspaceOptions{.spacing = 0.015, .shapes = false, .slice_points = 21})}) {
    const PoseWorkspace one = pose_workspace(*mechanism, options, {.threads = 1});
    const PoseWorkspace two = pose_workspace(*mechanism, options, {.threads = 2});
    EXPECT_EQ(one.measure, two.measure);
    EXPECT_EQ(one.homogeneous.of_all.index(), two.homogeneous.of_all.index());
    EXPECT_EQ(one.inscribed.cube.size, two.inscribed.cube.size);
    EXPECT_EQ(one.range, two.range);
    EXPECT_EQ(one.conditioning, two.conditioning);
    EXPECT_EQ(one.turning.share, two.turning.share);
  }
}

TEST(PoseWorkspace, SaysWhenAnOrientationIsOutOfReachAndStopsWhenTold) {
  const Mechanism mechanism(hexapod().description());
  EXPECT_FALSE(pose_workspace(mechanism, {.orientation = turned(Vector3::UnitY(), 1.5)}).reached);
  // Out of reach at home, but not everywhere.
  const Hexapod design = hexapod();
  const Matrix3 tilted = turned(Vector3::UnitX(), 0.8);
  ASSERT_FALSE(design.reaches({design.home(), tilted}));
  const PoseWorkspace elsewhere = pose_workspace(
      mechanism,
      {.spacing = 0.015, .orientation = tilted, .shapes = false, .turning = false, .slice_points = 0});
  ASSERT_TRUE(elsewhere.reached);
  for (const Vector3& place : elsewhere.places) EXPECT_TRUE(design.reaches({place, tilted}));
  EXPECT_THROW(pose_workspace(mechanism, {.spacing = 1e-4}), std::length_error);
  const std::atomic<bool> stop = true;
  EXPECT_FALSE(pose_workspace(mechanism, {}, {.cancel = &stop}).complete);
  // Wider than the workspace.
  EXPECT_EQ(pose_workspace(mechanism, {.spacing = 1.0}).inside, 0);
}

TEST(PoseWorkspace, OfAnyPlatformHoldsPlacesThatItsInverseConfirms) {
  int answered = 0;
  for (int seed = 0; seed < test::random_mechanism_kinds(); ++seed) {
    const test::RandomMechanism random = test::random_mechanism(static_cast<std::uint64_t>(seed));
    const Mechanism mechanism(random.description);
    if (pose_workspace_obstacle(mechanism)) continue;
    const PoseWorkspace workspace =
        pose_workspace(mechanism, {.places = 300, .shapes = false, .turning = false, .slice_points = 0});
    if (!workspace.reached || workspace.unbounded || workspace.inside == 0) continue;
    ++answered;
    SCOPED_TRACE(random.kind + " " + std::to_string(seed));
    EXPECT_GT(workspace.measure, 0.0);
    int confirmed = 0, asked = 0;
    for (std::size_t p = 0; p < workspace.places.size(); p += workspace.places.size() / 5 + 1) {
      ++asked;
      const std::vector<Solution> all =
          solve_inverse_all(mechanism, {workspace.places[p], workspace.orientation});
      confirmed += std::ranges::any_of(all,
                                       [](const Solution& one) {
                                         return one.status == SolveStatus::reached ||
                                                one.status == SolveStatus::degraded;
                                       })
                       ? 1
                       : 0;
      for (const int axis : workspace.axes) {
        EXPECT_GE(workspace.places[p][axis], workspace.range[axis].min - 1e-9);
        EXPECT_LE(workspace.places[p][axis], workspace.range[axis].max + 1e-9);
      }
    }
    // The search for all branches may miss a root of a leg with many joints.
    EXPECT_GE(confirmed, asked - 1);
  }
  EXPECT_GT(answered, 2);
}

}  // namespace
}  // namespace zwidth
