#include <array>
#include <gtest/gtest.h>
#include <numbers>

#include "support/five_bars.h"
#include "support/storm.h"

#include "zwidth/mechanism/families.h"
#include "zwidth/mechanism/jacobian.h"
#include "zwidth/mechanism/posture.h"

// The five-bar in closed form and as legs are each the check of the other.

namespace zwidth {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
const SolveOptions kGeneral{.closed_form = false};
// A window without singularities, as devices/five-bar.toml has it.
const std::array<Interval, 2> kWindow = {Interval{85.0 * kDegree, 210.0 * kDegree},
                                         Interval{-30.0 * kDegree, 95.0 * kDegree}};

Vector2 random_in(std::mt19937_64& random, const std::array<Interval, 2>& ranges) {
  return {test::draw(random, ranges[0].min, ranges[0].max), test::draw(random, ranges[1].min, ranges[1].max)};
}

Vector2 plane(const Posture& posture) {
  return posture.tool().position.head<2>();
}

// Of all joints, passive ones too, modulo a turn.
double joints_apart(const Posture& a, const Posture& b) {
  double most = 0.0;
  for (int j = 0; j < a.joints().size(); ++j) {
    most = std::max(most, std::abs(std::remainder(a.joints()[j] - b.joints()[j], 2.0 * std::numbers::pi)));
  }
  return most;
}

TEST(FiveBarClosedForm, ForwardAgreesWithTheGeneralSolverOverTheWindow) {
  std::mt19937_64 random(41);
  const Mechanism device(test::five_bar_device(test::kPublishedFiveBar, {}, 1, kWindow));
  ASSERT_EQ(device.tool_rows(), 2);
  double worst = 0.0;
  for (int k = 0; k < test::storm_size(100000); ++k) {
    const Vector2 theta = random_in(random, kWindow);
    const Solution closed = solve_forward(device, theta), general = solve_forward(device, theta, kGeneral);
    ASSERT_EQ(closed.status, SolveStatus::reached) << theta.transpose();
    ASSERT_EQ(general.status, SolveStatus::reached) << theta.transpose();
    worst = std::max({worst, (plane(*closed.posture) - plane(*general.posture)).norm(),
                      joints_apart(*closed.posture, *general.posture)});
  }
  EXPECT_LT(worst, 1e-9);
}

TEST(FiveBarClosedForm, InverseAgreesWithTheGeneralSolverOverTheWindow) {
  std::mt19937_64 random(42);
  const Mechanism device(test::five_bar_device(test::kPublishedFiveBar, {}, 1, kWindow));
  double worst = 0.0;
  for (int k = 0; k < test::storm_size(20000); ++k) {
    const Vector2 theta = random_in(random, kWindow);
    const Pose tool = solve_forward(device, theta).posture->tool();
    const Solution closed = solve_inverse(device, tool), general = solve_inverse(device, tool, kGeneral);
    ASSERT_EQ(closed.status, SolveStatus::reached) << theta.transpose();
    ASSERT_EQ(general.status, SolveStatus::reached) << theta.transpose();
    EXPECT_LT((closed.posture->active() - theta).norm(), 1e-11);
    worst = std::max(worst, joints_apart(*closed.posture, *general.posture));
  }
  EXPECT_LT(worst, 1e-9);
}

// Any lengths and modes: the general solver starts at a posture nearby, so that both are on one branch.
TEST(FiveBarClosedForm, AgreesForAnyLengthsAndModes) {
  std::mt19937_64 random(43);
  int compared = 0;
  for (int d = 0; d < test::storm_size(3000); ++d) {
    const FiveBarGeometry g = test::random_five_bar(random);
    const WorkingMode mode = kWorkingModes[static_cast<std::size_t>(d % 4)];
    const Mechanism device(test::five_bar_device(g, mode, d % 8 < 4 ? 1 : -1));
    for (int k = 0; k < 40; ++k) {
      const Vector2 theta = test::random_cranks(random);
      const Solution closed = solve_forward(device, theta);
      if (!closed) continue;
      const FiveBarState state(g, theta, plane(*closed.posture));
      if (state.inverse_singularity().cwiseAbs().minCoeff() < 0.1 ||
          std::abs(state.direct_singularity()) < 0.2) {
        continue;
      }
      const Vector2 beside = theta + 0.005 * random_in(random, {Interval{-1.0, 1.0}, Interval{-1.0, 1.0}});
      const Solution near = solve_forward(device, beside);
      ASSERT_TRUE(near) << d << " " << theta.transpose();
      const SolveOptions from_there{.start = &*near.posture, .closed_form = false};
      const Solution general = solve_forward(device, theta, from_there);
      ASSERT_TRUE(general) << d << " " << theta.transpose();
      EXPECT_LT((plane(*closed.posture) - plane(*general.posture)).norm(), 1e-9 * g.scale());
      EXPECT_LT(joints_apart(*closed.posture, *general.posture), 1e-9);
      const Jacobian J = jacobian(*general.posture);
      EXPECT_LT((Matrix2(J) - *state.jacobian()).norm(), 1e-8 * J.norm());
      if (working_mode(g, theta, plane(*closed.posture)) != mode) continue;
      const Solution back = solve_inverse(device, closed.posture->tool()),
                     general_back = solve_inverse(device, closed.posture->tool(), from_there);
      ASSERT_TRUE(back);
      ASSERT_TRUE(general_back);
      EXPECT_LT(joints_apart(*back.posture, *closed.posture), 1e-9);
      EXPECT_LT(joints_apart(*general_back.posture, *closed.posture), 1e-9);
      ++compared;
    }
  }
  EXPECT_GT(compared, 5000);
}

TEST(FiveBarClosedForm, GeneralSolverFindsTheSameFourSolutions) {
  std::mt19937_64 random(44);
  for (int k = 0; k < 20; ++k) {
    const FiveBarGeometry g = k == 0 ? test::kPublishedFiveBar : test::random_five_bar(random);
    const WorkingMode mode = kWorkingModes[static_cast<std::size_t>(k % 4)];
    const Mechanism device(test::five_bar_device(g, mode));
    Vector2 p(0.04, 0.12);
    for (int tries = 0; k > 0 && tries < 100; ++tries) {
      const double reach = g.crank + g.coupler;
      p = {test::draw(random, -reach, reach), test::draw(random, -reach, reach)};
      const FiveBarInverse inverse = five_bar_inverse(g, p);
      if (inverse.status == SolveStatus::reached &&
          FiveBarState(g, inverse.theta, p).inverse_singularity().cwiseAbs().minCoeff() > 0.1) {
        break;
      }
    }
    const Pose tool{.position = {p.x(), p.y(), 0.0}};
    const std::vector<Solution> closed = solve_inverse_all(device, tool),
                                general = solve_inverse_all(device, tool, kGeneral);
    ASSERT_EQ(closed.size(), 4u);
    ASSERT_EQ(general.size(), 4u) << k << " at " << p.transpose();
    for (const Solution& one : closed) {
      double nearest = 1e9;
      for (const Solution& other : general) {
        nearest = std::min(nearest, joints_apart(*one.posture, *other.posture));
      }
      EXPECT_LT(nearest, 1e-9);
    }
    // Each mode once. Those that the device's assembly mode does not reach come last and say so.
    std::array<int, 4> found{};
    bool others = false;
    for (const Solution& one : closed) {
      const Vector2 theta = one.posture->active();
      const WorkingMode here = working_mode(g, theta, p);
      for (std::size_t m = 0; m < kWorkingModes.size(); ++m) found[m] += kWorkingModes[m] == here;
      EXPECT_EQ(one.other_assembly, assembly_mode(g, theta, p) != 1);
      EXPECT_FALSE(others && !one.other_assembly);
      others = one.other_assembly;
      if (here == mode) {
        EXPECT_EQ(solve_inverse(device, tool).other_assembly, one.other_assembly);
      }
    }
    EXPECT_EQ(found, (std::array<int, 4>{1, 1, 1, 1}));
  }
}

TEST(FiveBarClosedForm, MergedModesAreListedOnce) {
  const Mechanism device(test::five_bar_device(test::kPublishedFiveBar));
  EXPECT_EQ(solve_inverse_all(device, {.position = {0.22, 0.0, 0.0}}).size(), 2u);
  EXPECT_EQ(solve_inverse_all(device, {.position = {0.0, 0.04, 0.0}}).size(), 1u);
  EXPECT_TRUE(solve_inverse_all(device, {.position = {0.0, 0.03, 0.0}}).empty());
  const Solution boundary = solve_inverse(device, {.position = {0.22, 0.0, 0.0}});
  EXPECT_EQ(boundary.status, SolveStatus::degraded);
  const Solution out = solve_inverse(device, {.position = {0.0, 0.3, 0.0}});
  EXPECT_EQ(out.status, SolveStatus::unreachable);
  EXPECT_EQ(out.joint, device.active_joint(0));
}

TEST(FiveBarLegs, StartInTheModesOfTheDevice) {
  std::mt19937_64 random(45);
  int in_mode = 0;
  for (int k = 0; k < 200; ++k) {
    const FiveBarGeometry g = test::random_five_bar(random);
    const WorkingMode mode = kWorkingModes[static_cast<std::size_t>(k % 4)];
    for (const int assembly : {1, -1}) {
      const Mechanism device(test::five_bar_device(g, mode, assembly));
      const JointVector home = device.home_guess();
      const Vector2 theta(home[0], home[2]);
      const Solution posture = solve_forward(device, theta);
      if (!posture) continue;
      EXPECT_LT(joints_apart(*posture.posture, *solve_forward(device, theta, kGeneral).posture), 1e-9);
      in_mode += working_mode(g, theta, plane(*posture.posture)) == mode;
    }
  }
  EXPECT_GT(in_mode, 380);  // of 400; a few lengths have next to no posture in a pair of modes
}

TEST(FiveBarLegs, JacobianIsThatOfTheClosedFormWithTwoRows) {
  const Mechanism device(test::five_bar_device(test::kPublishedFiveBar, {}, 1, kWindow));
  const Vector2 theta(2.4, 0.9);
  const Solution solution = solve_forward(device, theta);
  const Jacobian J = jacobian(*solution.posture);
  ASSERT_EQ(J.rows(), 2);
  ASSERT_EQ(J.cols(), 2);
  EXPECT_LT((Matrix2(J) - five_bar_forward(test::kPublishedFiveBar, theta).jacobian).norm(), 1e-14);
}

}  // namespace
}  // namespace zwidth
