#include "zwidth/mechanism/singularity.h"

#include <gtest/gtest.h>

#include "support/deltas.h"

#include "zwidth/mechanism/families.h"
#include "zwidth/mechanism/five_bar.h"
#include "zwidth/mechanism/jacobian.h"
#include "zwidth/mechanism/r_cube.h"

namespace zwidth {
namespace {

// A device as its family and spelled out in legs.
struct BothForms {
  explicit BothForms(const MechanismDescription& of)
      : description(make(of)), family(description), legs(spelled_out(description)) {}
  static Description make(const MechanismDescription& of) {
    Description description;
    description.name = "device";
    description.mechanism = of;
    return description;
  }
  Description description;
  Mechanism family, legs;
};

double alignment(const ToolVector& a, const Eigen::VectorXd& b) {
  return std::abs(a.dot(ToolVector(b))) / b.norm();
}

// Both forms answer degraded, and lose and gain the same directions, which they give.
SingularDirections expect_singular(const Solution& family, const Solution& legs, std::size_t lost,
                                   std::size_t gained) {
  EXPECT_EQ(family.status, SolveStatus::degraded);
  EXPECT_EQ(legs.status, SolveStatus::degraded);
  if (!family || !legs) {
    ADD_FAILURE() << "not reached";
    return {};
  }
  EXPECT_LT((family.posture->tool().position - legs.posture->tool().position).norm(), 1e-6);
  // The general solver meets a double root to half the digits.
  SingularDirections a = singular_directions(*family.posture, 1e-5),
                     b = singular_directions(*legs.posture, 1e-5);
  EXPECT_EQ(a.lost.size(), lost);
  EXPECT_EQ(b.lost.size(), lost);
  EXPECT_EQ(a.gained.size(), gained);
  EXPECT_EQ(b.gained.size(), gained);
  const auto same = [](const std::vector<SingularDirection>& x, const std::vector<SingularDirection>& y) {
    if (x.size() != 1 || y.size() != 1) return;
    EXPECT_NEAR(alignment(x[0].direction, y[0].direction), 1.0, 1e-5);
  };
  same(a.lost, b.lost);
  same(a.gained, b.gained);
  return a;
}

constexpr SolveOptions kGeneral{.closed_form = false};

RCubeDescription r_cube_with(double drive_link, double inner_link, double outer_link) {
  return {.drive_link = drive_link,
          .inner_link = inner_link,
          .outer_link = outer_link,
          .base_offset = drive_link,
          .joint_range = {-1.2, 1.2}};
}

// Where the tool is, and with which levers, if the outer links are long enough.
RCubeSolution roomy_r_cube(const Vector3& theta) {
  const RCubeDescription roomy = r_cube_with(0.1, 0.2, 0.2);
  return r_cube_forward(r_cube_geometry(roomy), theta, r_cube_branches(0, roomy.elbow_mode));
}

// An R-CUBE whose leg 1 is stretched at these angles.
RCubeDescription stretched_r_cube(const Vector3& theta) {
  const RCubeSolution there = roomy_r_cube(theta);
  const double x = there.position[r_cube_axis(0, 2)] - there.lever[0], y = there.position[r_cube_axis(0, 1)];
  return r_cube_with(0.1, 0.08, std::hypot(x, y) - 0.08);
}

TEST(Singularity, ARegularPostureLosesAndGainsNothing) {
  const BothForms delta(test::published_delta());
  const Solution solution = solve_forward(delta.family, Vector3(0.1, 0.2, 0.3));
  EXPECT_EQ(solution.status, SolveStatus::reached);
  const SingularDirections ways = singular_directions(*solution.posture);
  EXPECT_TRUE(ways.lost.empty());
  EXPECT_TRUE(ways.gained.empty());
}

TEST(Singularity, AStretchedLegOfTheRCubeBarsTheWayAlongIt) {
  // Leg 1 lies across the axis that it drives, from its universal joint to the tool; the joint itself goes
  // along the axis as the tool does, and by its drive's angle off that.
  const Vector3 theta(0.1, 0.5, 0.3);
  const RCubeDescription roomy = r_cube_with(0.1, 0.2, 0.2);
  const RCubeSolution there =
      r_cube_forward(r_cube_geometry(roomy), theta, r_cube_branches(0, roomy.elbow_mode));
  const double x = there.position[r_cube_axis(0, 2)] - there.lever[0], y = -there.position[r_cube_axis(0, 1)];
  const RCubeDescription stretched = r_cube_with(0.1, 0.08, std::hypot(x, y) - 0.08);
  const BothForms r_cube(stretched);
  Vector3 along = Vector3::Zero();
  along[r_cube_axis(0, 2)] = x;
  along[r_cube_axis(0, 1)] = -y;
  along[0] = x * std::tan(theta[0]);
  for (const bool inverse : {false, true}) {
    const Pose pose{.position = there.position};
    const SingularDirections ways =
        inverse ? expect_singular(solve_inverse(r_cube.family, pose), solve_inverse(r_cube.legs, pose), 1, 0)
                : expect_singular(solve_forward(r_cube.family, theta), solve_forward(r_cube.legs, theta), 1, 0);
    ASSERT_EQ(ways.lost.size(), 1U);
    EXPECT_NEAR(alignment(ways.lost[0].direction, along), 1.0, 1e-5);
    EXPECT_EQ(ways.lost[0].legs, std::vector<int>{0});
  }
}

TEST(Singularity, ADriveLinkOfTheRCubeThatPointsAlongItsAxisLosesTheAxis) {
  const BothForms r_cube(r_cube_with(0.1, 0.12, 0.12));
  const Vector3 theta(1.2, 0.1, 0.0);
  const Solution before = solve_forward(r_cube.family, theta);
  ASSERT_TRUE(before);
  const double quarter = 0.5 * std::numbers::pi;
  const Vector3 there(quarter, 0.1, 0.0);
  const Solution family = solve_forward(r_cube.family, there),
                 legs = solve_forward(r_cube.legs, there, {.start = &*before.posture});
  ASSERT_TRUE(family);
  EXPECT_EQ(family.joint, 0);  // beyond its range, which says more than that it is singular
  ASSERT_TRUE(legs);
  for (const Solution* one : {&family, &legs}) {
    const SingularDirections ways = singular_directions(*one->posture, 1e-6);
    ASSERT_EQ(ways.lost.size(), 1U);
    EXPECT_NEAR(std::abs(ways.lost[0].direction[0]), 1.0, 1e-6);
    EXPECT_LT(one->conditioning, 1e-6);
  }
}

DeltaDescription wide_delta(double base, double upper, double forearm, double platform) {
  return {.base_radius = base,
          .upper_arm = upper,
          .forearm = forearm,
          .platform_radius = platform,
          .joint_range = {-2.6, 2.6}};
}

TEST(Singularity, AStretchedLegOfTheDeltaBarsTheWayAlongIt) {
  // 80 + 160 mm along (0, 0.28, 0.96) from the axis at y = -40 mm.
  const BothForms delta(wide_delta(0.04, 0.08, 0.16, 0.08));
  const Pose pose{.position = {0.0, 0.0272, 0.2304}};
  const Solution family = solve_inverse(delta.family, pose);
  const SingularDirections ways = expect_singular(family, solve_inverse(delta.legs, pose), 1, 0);
  ASSERT_EQ(ways.lost.size(), 1U);
  EXPECT_NEAR(alignment(ways.lost[0].direction, Vector3(0.0, 0.28, 0.96)), 1.0, 1e-6);
  EXPECT_EQ(ways.lost[0].legs, std::vector<int>{0});
}

TEST(Singularity, CoplanarForearmsOfTheDeltaLetTheToolGo) {
  // Elbows at the level of the tool: the forearms lie flat, the arms stand up.
  const BothForms delta(wide_delta(0.15, 0.1, 0.1, 0.02));
  // Base less platform radius 0.13, the elbow 0.1 from the middle: 0.13 - 0.03 with the arm leaning in.
  const double theta = std::numbers::pi - std::acos(0.3);
  const Vector3 q = Vector3::Constant(theta);
  const SingularDirections ways =
      expect_singular(solve_forward(delta.family, q), solve_forward(delta.legs, q), 0, 1);
  ASSERT_EQ(ways.gained.size(), 1U);
  EXPECT_NEAR(std::abs(ways.gained[0].direction[2]), 1.0, 1e-6);
}

TEST(Singularity, ADeltaThatIsFlatGainsOneWayAndLosesTwo) {
  // Arms out, forearms back over them.
  const BothForms delta(wide_delta(0.1, 0.1, 0.16, 0.04));
  const Pose pose{.position = Vector3::Zero()};
  const SingularDirections ways =
      expect_singular(solve_inverse(delta.family, pose), solve_inverse(delta.legs, pose), 2, 1);
  ASSERT_EQ(ways.gained.size(), 1U);
  EXPECT_NEAR(std::abs(ways.gained[0].direction[2]), 1.0, 1e-6);
  for (const SingularDirection& way : ways.lost) EXPECT_LT(std::abs(way.direction[2]), 1e-6);
}

FiveBarDescription five_bar_with(double crank, double coupler, double half_base,
                                 const Interval& left = {-6.0, 6.0}, const Interval& right = {-6.0, 6.0}) {
  return {.crank = crank, .coupler = coupler, .half_base = half_base, .left_range = left, .right_range = right};
}

TEST(Singularity, AStretchedLegOfTheFiveBarBarsTheWayAlongIt) {
  const BothForms bars(five_bar_with(0.1, 0.15, 0.03));
  const Vector2 along(0.6, 0.8);
  Pose pose;
  pose.position.head<2>() = Vector2(-0.03, 0.0) + 0.25 * along;
  const SingularDirections ways =
      expect_singular(solve_inverse(bars.family, pose), solve_inverse(bars.legs, pose), 1, 0);
  ASSERT_EQ(ways.lost.size(), 1U);
  EXPECT_NEAR(alignment(ways.lost[0].direction, along), 1.0, 1e-6);
  EXPECT_EQ(ways.lost[0].legs, std::vector<int>{0});
}

TEST(Singularity, CouplersOfTheFiveBarInLineLetTheToolGo) {
  // Cranks up, elbows 0.3 apart.
  const BothForms bars(five_bar_with(0.1, 0.15, 0.15, {0.6, 2.0}, {1.1, 2.5}));
  const double up = 0.5 * std::numbers::pi;
  const Vector2 q(up, up);
  const SingularDirections ways =
      expect_singular(solve_forward(bars.family, q), solve_forward(bars.legs, q), 0, 1);
  ASSERT_EQ(ways.gained.size(), 1U);
  EXPECT_NEAR(std::abs(ways.gained[0].direction[1]), 1.0, 1e-5);
}

TEST(Singularity, AFiveBarInOneLineLosesAndGains) {
  // Both cranks along the base line, and so the couplers: the left leg stretched, the right one folded.
  const BothForms bars(five_bar_with(0.1, 0.15, 0.15, {-0.3, 1.2}, {-0.8, 0.8}));
  const Solution family = solve_forward(bars.family, Vector2(0.0, 0.0)),
                 legs = solve_forward(bars.legs, Vector2(0.0, 0.0));
  const SingularDirections ways = expect_singular(family, legs, 1, 1);
  ASSERT_EQ(ways.lost.size(), 1U);
  ASSERT_EQ(ways.gained.size(), 1U);
  EXPECT_NEAR(std::abs(ways.lost[0].direction[0]), 1.0, 1e-6);
  EXPECT_NEAR(std::abs(ways.gained[0].direction[1]), 1.0, 1e-6);
}

TEST(Singularity, OfAnArmWithFewJointsIsNotWhatItNeverHas) {
  LegsDescription legs;
  legs.platform = PlatformFreedom::point;
  LegDescription arm{.name = "arm", .tip = {0.5, 0.0, 0.0}, .attachment = Attachment::spherical};
  arm.joints = {{.name = "shoulder", .active = true, .range = {-2.0, 2.0}},
                {.name = "elbow", .active = true, .point = {0.3, 0.0, 0.0}, .range = {-2.0, 2.0}}};
  legs.legs = {arm};
  const Mechanism mechanism(BothForms::make(legs));
  // Bent, it moves in its plane as ever.
  EXPECT_TRUE(singular_directions(*solve_forward(mechanism, Vector2(0.2, 0.7)).posture).lost.empty());
  const SingularDirections straight = singular_directions(*solve_forward(mechanism, Vector2(0.0, 0.0)).posture);
  ASSERT_EQ(straight.lost.size(), 1U);
  EXPECT_NEAR(std::abs(straight.lost[0].direction[0]), 1.0, 1e-3);
}

TEST(Singularity, BothFormsCallPosturesDegradedFromTheSamePlaceOn) {
  // Nearer and nearer to a stretched leg.
  const Vector3 theta(0.1, 0.5, 0.3);
  const BothForms r_cube(stretched_r_cube(theta));
  int degraded = 0, reached = 0;
  for (const double side : {-1.0, 1.0}) {
    std::optional<Posture> last;
    for (double aside = 0.1; aside > 1e-13; aside *= 0.5) {
      const Vector3 q = theta + side * aside * Vector3(0.3, 1.0, -0.2);
      const Solution family = solve_forward(r_cube.family, q),
                     legs = solve_forward(r_cube.legs, q, {.start = last ? &*last : nullptr});
      ASSERT_EQ(family.posture.has_value(), legs.posture.has_value()) << aside;
      if (!family) continue;
      if (std::abs(family.conditioning - 1e-4) > 1e-7) {
        EXPECT_EQ(family.status, legs.status) << aside;
      }
      ++(family.status == SolveStatus::degraded ? degraded : reached);
      last = legs.posture;
    }
  }
  EXPECT_GT(degraded, 5);
  EXPECT_GT(reached, 5);
}

}  // namespace
}  // namespace zwidth
