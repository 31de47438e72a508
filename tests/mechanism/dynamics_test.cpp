#include "zwidth/mechanism/dynamics.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <array>
#include <cstring>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>
#include <stdexcept>
#include <string>

#include "support/deltas.h"
#include "support/positioning_stage.h"

namespace zwidth {
namespace {

const DeltaDescription kDelta = test::published_delta();

Posture posture_at(const Mechanism& mechanism, const Vector3& theta) {
  return *solve_forward(mechanism, theta).posture;
}

TEST(Dynamics, ParallelogramsAndUniversalJointsMoveTheSameBodiesAlike) {
  // The bars of a parallelogram and a rod on a universal joint point the same way, so every torque must agree.
  std::mt19937_64 random(31);
  const Mechanism rods(test::with_bodies(kDelta)), bars(test::with_parallelograms(kDelta));
  for (int k = 0; k < 100; ++k) {
    const Vector3 theta = test::random_angles(random, kDelta.joint_range),
                  rate = test::random_angles(random, {-3, 3}),
                  acceleration = test::random_angles(random, {-50, 50});
    const Posture a = posture_at(rods, theta), b = posture_at(bars, theta);
    EXPECT_LT((mass_matrix(a) - mass_matrix(b)).norm(), 1e-11);
    EXPECT_LT((gravity_torques(a) - gravity_torques(b)).norm(), 1e-10);
    EXPECT_LT((inverse_dynamics(a, rate, acceleration) - inverse_dynamics(b, rate, acceleration)).norm(), 1e-9);
  }
}

TEST(Dynamics, EqualsThePointMassModelWhenForearmsArePointMassesAtTheirEnds) {
  std::mt19937_64 random(32);
  Description lumped = test::with_bodies(kDelta);
  lumped.bodies.pop_back();
  lumped.bodies[1].mass = 2.0 / 3.0 * 0.03;  // the elbow's share
  lumped.bodies[1].centre.setZero();
  lumped.bodies[1].inertia.setZero();
  lumped.bodies.push_back({.on = "platform", .mass = 0.06 + 3 * 0.01});
  const Mechanism mechanism(lumped);
  DeltaMasses masses = delta_masses(test::with_bodies(kDelta));
  const DeltaPointMassDynamics source(delta_geometry(kDelta), masses);
  for (int k = 0; k < 100; ++k) {
    const Vector3 theta = test::random_angles(random, kDelta.joint_range),
                  rate = test::random_angles(random, {-3, 3}),
                  acceleration = test::random_angles(random, {-50, 50}),
                  push = test::random_angles(random, {-5, 5});
    const Posture posture = posture_at(mechanism, theta);
    const DeltaState state(delta_geometry(kDelta), theta, posture.tool().position);
    EXPECT_LT((mass_matrix(posture) - source.mass_matrix(state)).norm(), 1e-12);
    EXPECT_LT((gravity_torques(posture) + source.gravity_torque(state)).norm(), 1e-12);
    EXPECT_LT(
        (inverse_dynamics(posture, rate, acceleration, push) - source.inverse(state, rate, acceleration, push))
            .norm(),
        1e-10);
  }
}

TEST(Dynamics, MassMatrixIsInverseDynamicsByColumns) {
  std::mt19937_64 random(33);
  Mechanism delta(test::with_bodies(kDelta));
  delta.set_drive_inertia(Vector3(4e-4, 5e-4, 6e-4));
  for (int k = 0; k < 50; ++k) {
    const Posture posture = posture_at(delta, test::random_angles(random, kDelta.joint_range));
    const ActiveMatrix M = mass_matrix(posture);
    const ActiveVector still = ActiveVector::Zero(3), weight = gravity_torques(posture);
    for (int a = 0; a < 3; ++a) {
      const ActiveVector column = inverse_dynamics(posture, still, Vector3(Vector3::Unit(a))) - weight;
      EXPECT_LT((M.col(a) - column).norm(), 1e-13);
    }
    EXPECT_LT((M - M.transpose()).norm(), 1e-16);
    EXPECT_EQ(M.llt().info(), Eigen::Success);
  }
}

TEST(Dynamics, GravityTorquesAreTheSlopeOfPotentialEnergy) {
  std::mt19937_64 random(34);
  const double h = 1e-5;
  for (const Description& device : {test::with_bodies(kDelta), test::with_parallelograms(kDelta)}) {
    const Mechanism mechanism(device);
    for (int k = 0; k < 20; ++k) {
      const Vector3 theta = test::random_angles(random, kDelta.joint_range);
      Vector3 slope;
      for (int a = 0; a < 3; ++a) {
        slope[a] = (potential_energy(posture_at(mechanism, theta + h * Vector3::Unit(a))) -
                    potential_energy(posture_at(mechanism, theta - h * Vector3::Unit(a)))) /
                   (2 * h);
      }
      EXPECT_LT((gravity_torques(posture_at(mechanism, theta)) - slope).norm(), 1e-8);
    }
  }
}

TEST(Dynamics, ForwardUndoesInverseUnderAPush) {
  std::mt19937_64 random(35);
  Mechanism delta(test::with_bodies(kDelta));
  delta.set_drive_inertia(Vector3::Constant(6e-4));
  for (int k = 0; k < 100; ++k) {
    const Posture posture = posture_at(delta, test::random_angles(random, kDelta.joint_range));
    const Vector3 rate = test::random_angles(random, {-5, 5}), wanted = test::random_angles(random, {-90, 90}),
                  push = test::random_angles(random, {-5, 5});
    const ActiveVector torque = inverse_dynamics(posture, rate, wanted, push);
    EXPECT_LT((forward_dynamics(posture, rate, torque, push) - wanted).norm(), 1e-9);
  }
}

TEST(CartesianMass, IsWhatAPushAccelerates) {
  std::mt19937_64 random(36);
  const Mechanism delta(test::with_bodies(kDelta));
  for (int k = 0; k < 50; ++k) {
    const Posture posture = posture_at(delta, test::random_angles(random, kDelta.joint_range));
    const Jacobian J = jacobian(posture);
    const Vector3 push = test::random_angles(random, {-5, 5});
    const ActiveVector still = ActiveVector::Zero(3);
    const ActiveVector acceleration = forward_dynamics(posture, still, gravity_torques(posture), push);
    EXPECT_LT((cartesian_mass(J, mass_matrix(posture)) * (J * acceleration) - push).norm(), 1e-10);
  }
}

struct State {
  Vector3 theta, rate;
};

// One step of classical Runge-Kutta of the free device.
State step(const Mechanism& mechanism, const State& state, double dt) {
  const auto slope = [&](const State& s) {
    return State{s.rate, forward_dynamics(posture_at(mechanism, s.theta), s.rate, ActiveVector::Zero(3))};
  };
  const auto ahead = [](const State& s, const State& k, double t) {
    return State{s.theta + t * k.theta, s.rate + t * k.rate};
  };
  const State k1 = slope(state), k2 = slope(ahead(state, k1, dt / 2)), k3 = slope(ahead(state, k2, dt / 2)),
              k4 = slope(ahead(state, k3, dt));
  return {state.theta + dt / 6 * (k1.theta + 2 * k2.theta + 2 * k3.theta + k4.theta),
          state.rate + dt / 6 * (k1.rate + 2 * k2.rate + 2 * k3.rate + k4.rate)};
}

TEST(Dynamics, FreeSwingKeepsItsEnergy) {
  for (const Description& device : {test::with_bodies(kDelta), test::with_parallelograms(kDelta)}) {
    const Mechanism mechanism(device);
    State state{{0.9, 0.7, 0.5}, {1.0, -2.0, 0.5}};
    const auto energy = [&] {
      const Posture posture = posture_at(mechanism, state.theta);
      return kinetic_energy(posture, state.rate) + potential_energy(posture);
    };
    const double at_start = energy();
    for (int k = 0; k < 200; ++k) state = step(mechanism, state, 5e-4);
    EXPECT_NEAR(energy(), at_start, 1e-8 * std::abs(at_start));  // fourth order: (5e-4 s x 30 rad/s)^4
  }
}

// An arm with a body that hangs on one link and is turned by another, as the bars of a parallelogram are,
// before and behind each other along the chain.
Description arm_with_hung_bodies(std::mt19937_64& random) {
  Description description = test::arm_description(0.22, 0.27);
  const auto anywhere = [&] {
    return Vector3(test::uniform(random, -0.2, 0.2), test::uniform(random, -0.2, 0.2), 0.3);
  };
  for (const auto& [on, turns_with] :
       {std::pair("arm/theta3", "arm/theta4"), std::pair("arm/theta2", "arm/theta6"),
        std::pair("arm/theta5", "arm/theta3"), std::pair("arm/theta4", "")}) {
    BodyDescription body;
    body.on = on;
    body.turns_with = turns_with;
    if (!body.turns_with.empty()) body.pivot = anywhere();
    body.mass = test::uniform(random, 0.1, 0.6);
    body.centre = anywhere();
    const Matrix3 R = Eigen::Quaterniond::UnitRandom().toRotationMatrix();
    body.inertia = R * Vector3(2e-3, 3e-3, 4e-3).asDiagonal() * R.transpose();
    description.bodies.push_back(body);
  }
  return description;
}

TEST(Dynamics, OfHungBodiesIsThatOfTheirEnergies) {
  // Lagrange's equations by differences: d/dt dT/dqdot - dT/dq + dV/dq = tau.
  std::mt19937_64 random(51);
  for (int round = 0; round < 10; ++round) {
    const Mechanism mechanism(arm_with_hung_bodies(random));
    ActiveVector q(7), rate(7), acceleration(7);
    for (int j = 0; j < 7; ++j) {
      q[j] = test::uniform(random, -2, 2);
      rate[j] = test::uniform(random, -2, 2);
      acceleration[j] = test::uniform(random, -5, 5);
    }
    const auto at = [&](const ActiveVector& joints) { return *solve_forward(mechanism, joints).posture; };
    const double h = 1e-5;
    ActiveVector expected(7);
    const auto momentum = [&](double t) {
      return ActiveVector(mass_matrix(at(q + t * rate)) * (rate + t * acceleration));
    };
    expected = (momentum(h) - momentum(-h)) / (2.0 * h);
    for (int j = 0; j < 7; ++j) {
      const ActiveVector step = h * ActiveVector::Unit(7, j);
      const Posture more = at(q + step), less = at(q - step);
      expected[j] -= (kinetic_energy(more, rate) - kinetic_energy(less, rate)) / (2.0 * h);
      expected[j] += (potential_energy(more) - potential_energy(less)) / (2.0 * h);
    }
    EXPECT_LT((inverse_dynamics(at(q), rate, acceleration) - expected).norm(), 1e-7 * (1.0 + expected.norm()));
  }
}

TEST(Dynamics, KineticEnergyOfAHungBodyIsThatOfItsMotion) {
  std::mt19937_64 random(52);
  for (std::size_t which = 0; which < 4; ++which) {
    Description description = arm_with_hung_bodies(random);
    description.bodies = {description.bodies[which]};
    const BodyDescription& body = description.bodies[0];
    const Mechanism mechanism(description);
    ActiveVector q(7), rate(7);
    for (int j = 0; j < 7; ++j) {
      q[j] = test::uniform(random, -2, 2);
      rate[j] = test::uniform(random, -2, 2);
    }
    const double h = 1e-6;
    const Posture more = *solve_forward(mechanism, q + h * rate).posture,
                  less = *solve_forward(mechanism, q - h * rate).posture,
                  now = *solve_forward(mechanism, q).posture;
    const Vector3 velocity = (mass_centre(more) - mass_centre(less)) / (2.0 * h);
    const int turning = mechanism.bodies()[0].turns_with;
    const Matrix3 spin = (more.link_rotation(turning) - less.link_rotation(turning)) / (2.0 * h) *
                         now.link_rotation(turning).transpose();
    const Vector3 omega(spin(2, 1), spin(0, 2), spin(1, 0));
    const Vector3 local = now.link_rotation(turning).transpose() * omega;
    const double expected = 0.5 * body.mass * velocity.squaredNorm() + 0.5 * local.dot(body.inertia * local);
    EXPECT_NEAR(kinetic_energy(now, rate), expected, 1e-8 * (1.0 + expected));
  }
}

// ------------------------------------------------------------------------------------- MuJoCo, an independent
// engine

// The delta in MuJoCo's own terms, drawn at a closed posture: nested bodies with hinges, a platform on three
// slides, and point-to-point equalities. `impedance` near 1 makes the equalities stiff.
std::string mjcf(const Posture& posture, double impedance) {
  const Mechanism& mechanism = posture.mechanism();
  const auto vec = [](const Vector3& v) { return fmt::format("{:.17g} {:.17g} {:.17g}", v.x(), v.y(), v.z()); };
  const auto inertial = [&](int joint, const Matrix3& R) {
    for (const BodyModel& body : mechanism.bodies()) {
      if (body.joint != joint) continue;
      // MuJoCo wants a positive definite inertia: a thin rod gets 1e-12 kg m^2 about its axis.
      const Matrix3 I = R * body.inertia * R.transpose() + 1e-12 * Matrix3::Identity();
      return fmt::format(
          "<inertial pos='{}' mass='{:.17g}' fullinertia='{:.17g} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g}'/>",
          vec(R * body.centre), body.mass, I(0, 0), I(1, 1), I(2, 2), I(0, 1), I(0, 2), I(1, 2));
    }
    return std::string("<inertial pos='0 0 0' mass='1e-10' diaginertia='1e-14 1e-14 1e-14'/>");
  };
  std::string xml =
      "<mujoco><compiler angle='radian' balanceinertia='false'/>"
      "<option timestep='0.00002' gravity='0 0 -9.80665' integrator='RK4' iterations='100' "
      "tolerance='1e-15'/><worldbody>";
  std::string equalities;
  for (int l = 0; l < 3; ++l) {
    const LegModel& leg = mechanism.legs()[l];
    Vector3 inner = Vector3::Zero();
    for (int j = leg.first; j < leg.first + leg.count; ++j) {
      xml += fmt::format("<body name='b{0}' pos='{1}'><joint name='j{0}' type='hinge' axis='{2}'/>{3}", j,
                         vec(posture.joint_point(j) - inner), vec(posture.joint_axis(j)),
                         inertial(j, posture.link_rotation(j)));
      inner = posture.joint_point(j);
    }
    xml += "</body></body></body>";
    equalities += fmt::format(
        "<connect body1='b{}' body2='platform' anchor='{}' solref='0.002 1' solimp='{:.17g} {:.17g} 0.001'/>",
        leg.first + leg.count - 1, vec(posture.leg_tip(l) - inner), impedance, impedance);
  }
  return xml + fmt::format(
                   "<body name='platform' pos='{}'><joint type='slide' axis='1 0 0'/><joint type='slide' "
                   "axis='0 1 0'/>"
                   "<joint type='slide' axis='0 0 1'/>{}</body></worldbody><equality>{}</equality></mujoco>",
                   vec(posture.tool().position), inertial(-1, posture.tool().rotation), equalities);
}

class MujocoDelta {
 public:
  MujocoDelta(const Posture& posture, double impedance) {
    const std::string xml = mjcf(posture, impedance);
    mjVFS files;
    mj_defaultVFS(&files);
    mj_makeEmptyFileVFS(&files, "delta.xml", static_cast<int>(xml.size()));
    std::memcpy(files.filedata[0], xml.data(), xml.size());
    std::array<char, 500> error{};
    model_ = mj_loadXML("delta.xml", &files, error.data(), static_cast<int>(error.size()));
    mj_deleteVFS(&files);
    if (model_ == nullptr) throw std::runtime_error(error.data());
    data_ = mj_makeData(model_);
  }
  ~MujocoDelta() {
    mj_deleteData(data_);
    mj_deleteModel(model_);
  }
  MujocoDelta(const MujocoDelta&) = delete;
  MujocoDelta& operator=(const MujocoDelta&) = delete;

  Vector3 acceleration() {
    mj_forward(model_, data_);
    return driven(data_->qacc);
  }
  Vector3 turned_after(double time) {
    while (data_->time < time - 1e-9) mj_step(model_, data_);
    return driven(data_->qpos);
  }

 private:
  static Vector3 driven(const mjtNum* q) {
    return {q[0], q[3], q[6]};
  }  // three hinges a leg, the first one driven

  mjModel* model_ = nullptr;
  mjData* data_ = nullptr;
};

TEST(Dynamics, FreeFallStartsAsInMujoco) {
  // MuJoCo's equalities give by (1 - impedance): two impedances, extrapolated to 1, leave the square of that.
  std::mt19937_64 random(37);
  const Mechanism delta(test::with_bodies(kDelta));
  for (int k = 0; k < 20; ++k) {
    const Posture posture = posture_at(delta, test::random_angles(random, kDelta.joint_range));
    const Vector3 soft = MujocoDelta(posture, 0.999).acceleration(),
                  stiff = MujocoDelta(posture, 0.9998).acceleration();
    const Vector3 rigid = stiff + (stiff - soft) * (0.0002 / 0.0008);
    const ActiveVector still = ActiveVector::Zero(3);
    const Vector3 ours = forward_dynamics(posture, still, still);
    EXPECT_LT((ours - rigid).norm(), 1e-5 * ours.norm()) << posture.active().transpose();
  }
}

TEST(Dynamics, FreeFallGoesOnAsInMujoco) {
  const Mechanism delta(test::with_bodies(kDelta));
  const Vector3 start(0.9, 0.7, 0.8);
  const double time = 0.06;
  State state{start, Vector3::Zero()};
  for (int k = 0; k < 60; ++k) state = step(delta, state, time / 60);
  MujocoDelta mujoco(posture_at(delta, start), 0.9999);
  const Vector3 fallen = state.theta - start;
  EXPECT_GT(fallen.norm(), 0.1);
  // The equalities give by 1e-4 of the constraint forces.
  EXPECT_LT((mujoco.turned_after(time) - fallen).norm(), 1e-3 * fallen.norm());
}

}  // namespace
}  // namespace zwidth
