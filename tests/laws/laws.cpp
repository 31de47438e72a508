#include "laws/laws.h"

#include <Eigen/Dense>
#include <cmath>
#include <functional>
#include <gtest/gtest.h>

#include "support/allocation_counter.h"

#include "zwidth/analysis/force.h"
#include "zwidth/mechanism/dynamics.h"
#include "zwidth/mechanism/jacobian.h"
#include "zwidth/mechanism/singularity.h"

namespace zwidth::laws {
namespace {

double uniform(std::mt19937_64& random, double low, double high) {
  return std::uniform_real_distribution(low, high)(random);
}

// What a joint moves in a second or so: angles by 1, slides by a part of the size.
ActiveVector random_motion(const Mechanism& mechanism, std::mt19937_64& random) {
  ActiveVector motion(mechanism.active_count());
  for (int i = 0; i < motion.size(); ++i) {
    const bool slides = mechanism.joints()[mechanism.active_joint(i)].type == JointType::prismatic;
    motion[i] = uniform(random, -1.0, 1.0) * (slides ? mechanism.characteristic_length() : 1.0);
  }
  return motion;
}

// Rotation vector that turns `from` into `to` (small), base frame.
Vector3 turn_between(const Matrix3& from, const Matrix3& to) {
  const Eigen::AngleAxisd turn(to * from.transpose());
  return turn.axis() * turn.angle();
}

// The derivative at zero of a function of time, and how wrong it may be.
struct Slope {
  Eigen::VectorXd value;
  double error = 0.0;
  bool defined = false;
};

// Central differences of two steps, extrapolated. Their distance bounds what is cut off of the better one, and
// so of the extrapolated one, which is two orders better; `noise` is what each value may be wrong by.
Slope slope_of(const std::function<std::optional<Eigen::VectorXd>(double)>& function, double step,
               double noise) {
  Slope slope;
  std::array<Eigen::VectorXd, 2> difference;
  for (std::size_t k = 0; k < 2; ++k) {
    const double h = k == 0 ? step : 0.5 * step;
    const auto up = function(h), down = function(-h);
    if (!up || !down) return slope;
    difference[k] = (*up - *down) / (2.0 * h);
  }
  slope.value = (4.0 * difference[1] - difference[0]) / 3.0;
  slope.error = (difference[1] - difference[0]).norm() / 3.0 + 4.0 * noise / step;
  slope.defined = true;
  return slope;
}

constexpr double kStep = 2e-4;  // [s]
// Newton stops at 1e-12 of the size; what that is in joints and tool grows with the closure's condition.
double noise_of(const Situation& situation) {
  return 2e-12 * situation.mechanism().characteristic_length() / situation.conditioning;
}

struct Placed {
  Vector3 centre;
  Matrix3 rotation;
};
Placed placed(const Posture& posture, const BodyModel& body) {
  if (body.joint < 0)
    return {posture.tool().position + posture.tool().rotation * body.centre, posture.tool().rotation};
  const Matrix3& R = posture.link_rotation(body.turns_with);
  return {posture.joint_point(body.joint) + posture.link_rotation(body.joint) * body.pivot + R * body.centre,
          R};
}

// How far apart, in what the mechanism's tool can do.
double gap(const Mechanism& mechanism, const Pose& a, const Pose& b) {
  const double turn = mechanism.tool_turns() ? turn_between(a.rotation, b.rotation).norm() : 0.0;
  return std::max((a.position - b.position).norm(), mechanism.characteristic_length() * turn);
}

// A time in which the motion leaves the posture, but not for the other side of a singularity.
double a_little(const Situation& situation) {
  return std::min(0.02, 0.05 * situation.conditioning);
}

bool redundant(const Mechanism& mechanism) {
  return mechanism.active_count() > mechanism.tool_rows();
}

}  // namespace

Solution Situation::at(double time, bool accelerated) const {
  ActiveVector q = here.active() + time * rate;
  if (accelerated) q += 0.5 * time * time * acceleration;
  return solve_forward(mechanism(), q, {.start = &here, .closed_form = closed_form, .restart = false});
}

Situation any_situation(const Solution& solution, bool closed_form, std::mt19937_64& random) {
  const Mechanism& mechanism = solution.posture->mechanism();
  Situation situation{*solution.posture,
                      solution.conditioning,
                      closed_form,
                      random_motion(mechanism, random),
                      random_motion(mechanism, random),
                      ToolVector(mechanism.tool_rows())};
  for (double& component : situation.wrench) component = uniform(random, -1.0, 1.0);
  return situation;
}

void inverse_undoes_forward(const Situation& situation) {
  const Mechanism& mechanism = situation.mechanism();
  const double length = mechanism.characteristic_length(), tolerance = 1e-10 * length / situation.conditioning;
  const Solution aside = situation.at(a_little(situation));
  if (!aside) return;
  const Solution back = solve_inverse(mechanism, situation.here.tool(),
                                      {.start = &*aside.posture, .closed_form = situation.closed_form});
  ASSERT_TRUE(back);
  EXPECT_LT(gap(mechanism, back.posture->tool(), situation.here.tool()), tolerance);
  if (redundant(mechanism)) return;  // many joints give that pose
  for (int i = 0; i < mechanism.active_count(); ++i) {
    const bool slides = mechanism.joints()[mechanism.active_joint(i)].type == JointType::prismatic;
    const double apart = back.posture->active()[i] - situation.here.active()[i];
    EXPECT_LT(std::abs(slides ? apart : std::remainder(apart, 6.283185307179586) * length), tolerance)
        << "joint " << i;
  }
}

void forward_undoes_inverse(const Situation& situation) {
  const Mechanism& mechanism = situation.mechanism();
  const double length = mechanism.characteristic_length();
  const SolveOptions options{.start = &situation.here, .closed_form = situation.closed_form};
  const Solution aside = situation.at(a_little(situation));
  if (!aside || aside.conditioning < 0.3 * situation.conditioning) return;
  const Pose& wanted = aside.posture->tool();
  const Solution inverse = solve_inverse(mechanism, wanted, options);
  ASSERT_TRUE(inverse);
  const Solution forward = solve_forward(mechanism, inverse.posture->active(), options);
  ASSERT_TRUE(forward);
  EXPECT_LT(gap(mechanism, forward.posture->tool(), wanted), 1e-10 * length / inverse.conditioning);
}

void rates_are_differences(const Situation& situation) {
  const Mechanism& mechanism = situation.mechanism();
  const Rates all = rates(situation.here);
  const Slope tool = slope_of(
      [&](double t) -> std::optional<Eigen::VectorXd> {
        const Solution then = situation.at(t);
        if (!then) return std::nullopt;
        Vector6 way;
        way << then.posture->tool().position - situation.here.tool().position,
            turn_between(situation.here.tool().rotation, then.posture->tool().rotation);
        if (!mechanism.tool_turns()) way.tail<3>().setZero();
        return way;
      },
      kStep, noise_of(situation));
  if (tool.defined) {
    const Vector6 twist = mechanism.six_components(all.tool * situation.rate);
    EXPECT_LT((twist - tool.value).norm(), tool.error + 1e-12) << twist.transpose() << "\n"
                                                               << tool.value.transpose();
  }
  const Slope joints = slope_of(
      [&](double t) -> std::optional<Eigen::VectorXd> {
        const Solution then = situation.at(t);
        if (!then) return std::nullopt;
        Eigen::VectorXd change = then.posture->joints() - situation.here.joints();
        for (Eigen::Index j = 0; j < change.size(); ++j) {  // passive angles come wrapped
          if (mechanism.joints()[static_cast<std::size_t>(j)].type != JointType::prismatic)
            change[j] = std::remainder(change[j], 6.283185307179586);
        }
        return change;
      },
      kStep, noise_of(situation) / mechanism.characteristic_length());
  if (joints.defined) {
    EXPECT_LT((all.joints * situation.rate - joints.value).norm(), joints.error + 1e-12);
  }
}

void bias_acceleration_is_the_difference_of_rates(const Situation& situation) {
  const Rates all = rates(situation.here);
  const BiasAcceleration bias = bias_acceleration(situation.here, all, situation.rate);
  // Rates of a posture that is wrong by the noise are wrong by that over the closure's condition once more.
  const double noise = noise_of(situation) / situation.conditioning;
  const auto expect = [&](const Eigen::VectorXd& ours, const auto& of, double scale) {
    const Slope slope = slope_of(
        [&](double t) -> std::optional<Eigen::VectorXd> {
          const Solution then = situation.at(t);
          if (!then) return std::nullopt;
          return of(rates(*then.posture));
        },
        kStep, noise* scale);
    if (slope.defined) {
      EXPECT_LT((ours - slope.value).norm(), slope.error + 1e-12 * (1.0 + slope.value.norm()));
    }
  };
  const double inverse_length = 1.0 / situation.mechanism().characteristic_length();
  const double rows = situation.mechanism().tool_turns() ? inverse_length : 1.0;
  expect(
      bias.tool, [&](const Rates& r) { return Eigen::VectorXd(r.tool * situation.rate); }, rows);
  expect(
      bias.joints, [&](const Rates& r) { return Eigen::VectorXd(r.joints * situation.rate); }, inverse_length);
}

void power_at_the_joints_is_power_at_the_tool(const Situation& situation) {
  const Mechanism& mechanism = situation.mechanism();
  const ActiveVector torque = torques_for_load(jacobian(situation.here), situation.wrench);
  const Vector6 wrench = mechanism.six_components(situation.wrench);
  // The work of the wrench is taken from where the tool really goes.
  const Slope work = slope_of(
      [&](double t) -> std::optional<Eigen::VectorXd> {
        const Solution then = situation.at(t);
        if (!then) return std::nullopt;
        const Vector3 turn = mechanism.tool_turns()
                                 ? turn_between(situation.here.tool().rotation, then.posture->tool().rotation)
                                 : Vector3(Vector3::Zero());
        return Eigen::VectorXd::Constant(
            1, wrench.head<3>().dot(then.posture->tool().position - situation.here.tool().position) +
                   wrench.tail<3>().dot(turn));
      },
      kStep, noise_of(situation) * wrench.norm() / std::min(1.0, mechanism.characteristic_length()));
  if (work.defined) {
    EXPECT_NEAR(torque.dot(situation.rate), work.value[0], work.error + 1e-12);
  }
}

void mass_is_symmetric_and_positive(const Situation& situation) {
  const ActiveMatrix M = mass_matrix(situation.here);
  EXPECT_LE((M - M.transpose()).norm(), 1e-15 * M.norm());
  if (moving_mass(situation.mechanism()) == 0.0 && situation.mechanism().drive_inertia().isZero(0.0)) return;
  const Eigen::VectorXd values =
      Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(Eigen::MatrixXd(M), Eigen::EigenvaluesOnly).eigenvalues();
  // Joints about which nothing has inertia are not wrong.
  EXPECT_GE(values[0], -1e-13 * values[values.size() - 1]);
}

void mass_gives_the_energy_of_the_bodies(const Situation& situation) {
  const Mechanism& mechanism = situation.mechanism();
  const double ours = kinetic_energy(situation.here, situation.rate);
  EXPECT_NEAR(ours, 0.5 * situation.rate.dot(mass_matrix(situation.here) * situation.rate),
              1e-12 * (1e-6 + ours));
  double energy = 0.0, error = 0.0;
  for (const BodyModel& body : mechanism.bodies()) {
    const Placed now = placed(situation.here, body);
    const Slope velocity = slope_of(
        [&](double t) -> std::optional<Eigen::VectorXd> {
          const Solution then = situation.at(t);
          if (!then) return std::nullopt;
          const Placed one = placed(*then.posture, body);
          Vector6 way;
          way << one.centre - now.centre, turn_between(now.rotation, one.rotation);
          return way;
        },
        kStep, noise_of(situation) / std::min(1.0, mechanism.characteristic_length()));
    if (!velocity.defined) return;
    const Vector3 v = velocity.value.head<3>(), w = now.rotation.transpose() * velocity.value.tail<3>();
    energy += 0.5 * body.mass * v.squaredNorm() + 0.5 * w.dot(body.inertia * w);
    const double heft = body.mass + body.inertia.norm();
    error += heft * velocity.error * (velocity.value.norm() + velocity.error);
  }
  energy += 0.5 * situation.rate.cwiseAbs2().dot(mechanism.drive_inertia());
  EXPECT_NEAR(ours, energy, error + 1e-12 * (1e-6 + energy));
}

void gravity_torques_are_the_slope_of_the_energy(const Situation& situation) {
  const Mechanism& mechanism = situation.mechanism();
  const double heft = moving_mass(mechanism) * mechanism.gravity().norm();
  const Slope energy = slope_of(
      [&](double t) -> std::optional<Eigen::VectorXd> {
        const Solution then = situation.at(t);
        if (!then) return std::nullopt;
        return Eigen::VectorXd::Constant(1, potential_energy(*then.posture) - potential_energy(situation.here));
      },
      kStep, heft* noise_of(situation));
  if (energy.defined) {
    EXPECT_NEAR(gravity_torques(situation.here).dot(situation.rate), energy.value[0],
                energy.error + 1e-12 * heft);
  }
}

void torques_do_the_work_that_energy_gains(const Situation& situation) {
  const Mechanism& mechanism = situation.mechanism();
  const auto energy_of = [](const Posture& posture, const ActiveVector& rate) {
    return kinetic_energy(posture, rate) + potential_energy(posture);
  };
  const double before = energy_of(situation.here, situation.rate);
  const double scale = kinetic_energy(situation.here, situation.rate) +
                       moving_mass(mechanism) * mechanism.gravity().norm() * mechanism.characteristic_length() +
                       1e-9;
  const Slope energy = slope_of(
      [&](double t) -> std::optional<Eigen::VectorXd> {
        const Solution then = situation.at(t, true);
        if (!then) return std::nullopt;
        return Eigen::VectorXd::Constant(
            1, energy_of(*then.posture, situation.rate + t * situation.acceleration) - before);
      },
      kStep, scale* noise_of(situation) / (mechanism.characteristic_length() * situation.conditioning));
  if (!energy.defined) return;
  const ActiveVector torque = inverse_dynamics(situation.here, situation.rate, situation.acceleration);
  EXPECT_NEAR(torque.dot(situation.rate), energy.value[0], energy.error + 1e-11 * scale);
}

void a_cycle_does_not_allocate(const Situation& situation) {
  const Mechanism& mechanism = situation.mechanism();
  const SolveOptions options{.start = &situation.here, .closed_form = situation.closed_form};
  const ActiveVector q = situation.here.active() + 1e-3 * situation.rate;
  const long before = test::allocations();
  const Solution forward = solve_forward(mechanism, q, options);
  double sum = 0.0;
  if (forward) {
    const Solution inverse = solve_inverse(mechanism, forward.posture->tool(), options);
    const Rates all = rates(*forward.posture);
    sum += inverse.residual + bias_acceleration(*forward.posture, all, situation.rate).tool.sum();
    const ActiveVector torque = inverse_dynamics(*forward.posture, situation.rate, situation.acceleration);
    sum += forward_dynamics(*forward.posture, situation.rate, torque, situation.wrench).sum();
    sum += gravity_torques(*forward.posture, all).sum() + torques_for_load(all.tool, situation.wrench).sum();
    sum += cartesian_mass(all.tool, mass_matrix(*forward.posture, all)).trace();
  }
  EXPECT_EQ(test::allocations(), before);
  EXPECT_FALSE(std::isnan(sum));
}

void everything_is_finite(const Solution& solution) {
  const Posture& posture = *solution.posture;
  const Mechanism& mechanism = posture.mechanism();
  EXPECT_TRUE(posture.joints().allFinite());
  EXPECT_TRUE(posture.tool().position.allFinite() && posture.tool().rotation.allFinite());
  EXPECT_TRUE(std::isfinite(solution.conditioning) && solution.conditioning >= 0.0);
  EXPECT_TRUE(std::isfinite(solution.residual));
  const Rates all = rates(posture);
  EXPECT_TRUE(std::isfinite(all.closure));
  EXPECT_TRUE(all.tool.allFinite()) << all.tool;
  EXPECT_TRUE(all.joints.allFinite());
  EXPECT_TRUE(mass_matrix(posture, all).allFinite());
  EXPECT_TRUE(gravity_torques(posture, all).allFinite());
  EXPECT_TRUE(cartesian_mass(all.tool, mass_matrix(posture, all)).allFinite());
  const ActiveVector rate = ActiveVector::Constant(mechanism.active_count(), 0.1);
  EXPECT_TRUE(bias_acceleration(posture, all, rate).tool.allFinite());
  EXPECT_TRUE(inverse_dynamics(posture, rate, rate).allFinite());
  const SingularDirections ways = singular_directions(posture);
  for (const auto& list : {ways.lost, ways.gained}) {
    for (const SingularDirection& way : list) {
      EXPECT_NEAR(way.direction.norm(), 1.0, 1e-9);
      EXPECT_TRUE(std::isfinite(way.measure));
    }
  }
  if (!ways.gained.empty() || !ways.lost.empty()) {
    EXPECT_NE(solution.status, SolveStatus::reached) << solution.conditioning;
  }
}

void all(const Situation& situation) {
  inverse_undoes_forward(situation);
  forward_undoes_inverse(situation);
  rates_are_differences(situation);
  bias_acceleration_is_the_difference_of_rates(situation);
  power_at_the_joints_is_power_at_the_tool(situation);
  mass_is_symmetric_and_positive(situation);
  mass_gives_the_energy_of_the_bodies(situation);
  gravity_torques_are_the_slope_of_the_energy(situation);
  torques_do_the_work_that_energy_gains(situation);
  a_cycle_does_not_allocate(situation);
}

void borders_are_finite(const Mechanism& mechanism, const Solution& start, bool closed_form,
                        std::mt19937_64& random) {
  constexpr int kSteps = 40, kHalvings = 50;
  // `solve` answers for a point of a line from the last answer on.
  const auto follow = [&](const std::function<Solution(double, const Posture&)>& solve, double step) {
    Solution last = start;
    double reached = 0.0, lost = -1.0;
    for (int k = 1; k <= kSteps && lost < 0.0; ++k) {
      const Solution next = solve(k * step, *last.posture);
      if (next) {
        reached = k * step;
        last = next;
      } else {
        lost = k * step;
      }
    }
    for (int k = 0; k < kHalvings && lost > 0.0; ++k) {
      const double middle = 0.5 * (reached + lost);
      const Solution next = solve(middle, *last.posture);
      (next ? reached : lost) = middle;
      if (next) last = next;
    }
    everything_is_finite(last);
  };
  const ActiveVector q = start.posture->active(), motion = random_motion(mechanism, random);
  follow(
      [&](double t, const Posture& last) {
        return solve_forward(mechanism, q + t * motion,
                             {.start = &last, .closed_form = closed_form, .restart = false});
      },
      0.1);
  const Pose& from = start.posture->tool();
  ToolVector way(mechanism.tool_rows());
  for (double& component : way) component = uniform(random, -1.0, 1.0);
  const Vector6 twist = mechanism.six_components(way);
  follow(
      [&](double t, const Posture& last) {
        Pose pose = from;
        pose.position += t * mechanism.characteristic_length() * twist.head<3>();
        if (mechanism.tool_turns() && twist.tail<3>().norm() > 0.0) {
          pose.rotation =
              Eigen::AngleAxisd(t * twist.tail<3>().norm(), twist.tail<3>().normalized()) * pose.rotation;
        }
        return solve_inverse(mechanism, pose, {.start = &last, .closed_form = closed_form, .restart = false});
      },
      0.05);
}

}  // namespace zwidth::laws
