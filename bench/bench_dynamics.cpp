#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <kdl/chain.hpp>
#include <kdl/chainidsolver_recursive_newton_euler.hpp>
#include <memory>
#include <mujoco/mujoco.h>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "harness.h"

#include "zwidth/mechanism/delta_dynamics.h"
#include "zwidth/mechanism/dynamics.h"
#include "zwidth/mechanism/export.h"
#include "zwidth/mechanism/serial_dynamics.h"

/// Dynamics: the inverse one of a 7-DOF arm and the time step of a delta with its closed loops, beside MuJoCo
/// and KDL.

namespace {

using namespace zwidth;

constexpr int kStates = 1024;

double uniform(std::mt19937_64& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

void check(bool ok, const char* what) {
  if (ok) return;
  std::fprintf(stderr, "contestants disagree: %s\n", what);
  std::exit(1);
}

class Mujoco {
 public:
  explicit Mujoco(const Posture& home) {
    const std::string xml = export_mjcf(home).text;
    auto files = std::make_unique<mjVFS>();
    mj_defaultVFS(files.get());
    mj_makeEmptyFileVFS(files.get(), "device.xml", static_cast<int>(xml.size()));
    std::copy(xml.begin(), xml.end(), static_cast<char*>(files->filedata[0]));
    char error[256] = "";
    model_ = mj_loadXML("device.xml", files.get(), error, sizeof error);
    mj_deleteVFS(files.get());
    if (model_ == nullptr) {
      std::fprintf(stderr, "MuJoCo: %s\n", error);
      std::abort();
    }
    data_ = mj_makeData(model_);
    for (const int joint : active_of(home.mechanism())) {
      std::string name = home.mechanism().joint_names()[static_cast<std::size_t>(joint)];
      std::replace(name.begin(), name.end(), '/', '_');
      const int id = mj_name2id(model_, mjOBJ_JOINT, name.c_str());
      position_.push_back(model_->jnt_qposadr[id]);
      rate_.push_back(model_->jnt_dofadr[id]);
    }
  }
  ~Mujoco() {
    mj_deleteData(data_);
    mj_deleteModel(model_);
  }
  Mujoco(const Mujoco&) = delete;
  Mujoco& operator=(const Mujoco&) = delete;

  void inverse(const ActiveVector& q, const ActiveVector& rate, const ActiveVector& acceleration) {
    std::copy(q.begin(), q.end(), data_->qpos);
    std::copy(rate.begin(), rate.end(), data_->qvel);
    std::copy(acceleration.begin(), acceleration.end(), data_->qacc);
    mj_inverse(model_, data_);
  }
  double torque(int j) const { return data_->qfrc_inverse[j]; }

  void use(int solver, int integrator, double dt) {
    model_->opt.solver = solver;
    model_->opt.integrator = integrator;
    model_->opt.timestep = dt;
  }
  double position(int i) const { return data_->qpos[position_[static_cast<std::size_t>(i)]]; }
  double rate(int i) const { return data_->qvel[rate_[static_cast<std::size_t>(i)]]; }
  void step(const Vector3& torque) {
    for (int i = 0; i < 3; ++i) data_->qfrc_applied[rate_[static_cast<std::size_t>(i)]] = torque[i];
    mj_step(model_, data_);
  }
  int freedoms() const { return model_->nv; }

 private:
  static std::vector<int> active_of(const Mechanism& mechanism) {
    std::vector<int> joints;
    for (int i = 0; i < mechanism.active_count(); ++i) joints.push_back(mechanism.active_joint(i));
    return joints;
  }
  mjModel* model_ = nullptr;
  mjData* data_ = nullptr;
  std::vector<int> position_, rate_;
};

Posture home_of(const Mechanism& mechanism) {
  ActiveVector joints(mechanism.active_count());
  for (int i = 0; i < joints.size(); ++i) joints[i] = mechanism.home_guess()[mechanism.active_joint(i)];
  return *solve_forward(mechanism, joints).posture;
}

// ---------------------------------------------------------------------------------------------------- the arm

// Baser's arm with a body of any shape on every link.
Description arm_with_bodies() {
  constexpr double kQuarter = 0.5 * std::numbers::pi;
  const double alpha[7] = {-kQuarter, kQuarter, -kQuarter, kQuarter, -kQuarter, kQuarter, 0.0};
  const double d[7] = {0.0, 0.0, 0.25, 0.0, 0.25, 0.0, 0.0};
  SerialDescription arm;
  Description description;
  description.name = "arm";
  std::mt19937_64 random(1);
  for (int i = 0; i < 7; ++i) {
    const std::string name = "theta" + std::to_string(i + 1);
    arm.joints.push_back({.name = name, .d = d[i], .alpha = alpha[i], .range = {-3.1, 3.1}});
    BodyDescription body;
    body.on = "arm/" + name;
    body.mass = uniform(random, 0.1, 0.5);
    body.centre = {uniform(random, -0.05, 0.05), uniform(random, -0.05, 0.05), uniform(random, 0.1, 0.5)};
    const Matrix3 R = Eigen::Quaterniond(0.8, uniform(random, -1, 1), uniform(random, -1, 1), 0.2)
                          .normalized()
                          .toRotationMatrix();
    body.inertia = R * Vector3(2e-3, 3e-3, 4e-3).asDiagonal() * R.transpose();
    description.bodies.push_back(body);
  }
  description.mechanism = arm;
  return description;
}

class Kdl {
 public:
  explicit Kdl(const Description& description)
      : chain_(chain_of(description)),
        solver_(chain_, {description.gravity.x(), description.gravity.y(), description.gravity.z()}) {}
  void inverse(const ActiveVector& q, const ActiveVector& rate, const ActiveVector& acceleration) {
    for (int j = 0; j < 7; ++j) {
      q_(j) = q[j];
      rate_(j) = rate[j];
      acceleration_(j) = acceleration[j];
    }
    solver_.CartToJnt(q_, rate_, acceleration_, none_, torque);
  }
  KDL::JntArray torque{7};

 private:
  static KDL::Chain chain_of(const Description& description) {
    KDL::Chain chain;
    Pose frame;
    std::size_t i = 0;
    for (const SerialJointDescription& row : std::get<SerialDescription>(description.mechanism).joints) {
      const KDL::Frame step = KDL::Frame::DH(row.a, row.alpha, row.d, row.theta);
      Matrix3 R;
      for (int r = 0; r < 3; ++r) {
        for (int c = 0; c < 3; ++c) R(r, c) = step.M(r, c);
      }
      frame.position += frame.rotation * Vector3(step.p.x(), step.p.y(), step.p.z());
      frame.rotation = frame.rotation * R;
      const BodyDescription& body = description.bodies[i++];
      const Vector3 c = frame.rotation.transpose() * (body.centre - frame.position);
      const Matrix3 I = frame.rotation.transpose() * body.inertia * frame.rotation;
      chain.addSegment(KDL::Segment(
          KDL::Joint(KDL::Joint::RotZ), step,
          KDL::RigidBodyInertia(body.mass, {c.x(), c.y(), c.z()},
                                KDL::RotationalInertia(I(0, 0), I(1, 1), I(2, 2), I(0, 1), I(0, 2), I(1, 2)))));
    }
    return chain;
  }
  KDL::Chain chain_;
  KDL::ChainIdSolver_RNE solver_;
  KDL::JntArray q_{7}, rate_{7}, acceleration_{7};
  KDL::Wrenches none_ = KDL::Wrenches(7, KDL::Wrench::Zero());
};

void arm(const bench::Options& options) {
  const Description description = arm_with_bodies();
  const Mechanism mechanism(description);
  const SerialDynamics dynamics = *SerialDynamics::of(mechanism);
  Mujoco mujoco(home_of(mechanism));
  Kdl kdl(description);

  std::mt19937_64 random(2);
  std::vector<ActiveVector> q, rate, acceleration;
  std::vector<Posture> postures;
  for (int s = 0; s < kStates; ++s) {
    ActiveVector one(7), two(7), three(7);
    for (int j = 0; j < 7; ++j) {
      one[j] = uniform(random, -2.5, 2.5);
      two[j] = uniform(random, -3.0, 3.0);
      three[j] = uniform(random, -20.0, 20.0);
    }
    q.push_back(one);
    rate.push_back(two);
    acceleration.push_back(three);
    postures.push_back(*solve_forward(mechanism, one).posture);
    const ActiveVector ours = dynamics.inverse(one, two, three);
    mujoco.inverse(one, two, three);
    kdl.inverse(one, two, three);
    const double size = 1.0 + ours.norm();
    for (int j = 0; j < 7; ++j) {
      check(std::abs(ours[j] - kdl.torque(j)) < 1e-12 * size, "KDL's torques");
      check(std::abs(ours[j] - mujoco.torque(j)) < 1e-6 * size,
            "MuJoCo's torques");  // it diagonalises inertias
    }
    check((ours - inverse_dynamics(postures.back(), two, three)).norm() < 1e-12 * size, "postures' torques");
  }
  const auto over = [](auto&& one) {
    return [one, at = std::size_t{0}](long n) mutable {
      for (long i = 0; i < n; ++i) one(at++ % kStates);
    };
  };
  bench::Suite suite("Inverse dynamics of the 7-DOF arm, a body on every link", options);
  suite.add("MuJoCo 2.2.2 mj_inverse", 1, over([&](std::size_t s) {
              mujoco.inverse(q[s], rate[s], acceleration[s]);
              bench::keep(mujoco);
            }));
  suite.add("KDL 1.5 ChainIdSolver_RNE", 1, over([&](std::size_t s) {
              kdl.inverse(q[s], rate[s], acceleration[s]);
              bench::keep(kdl);
            }));
  ActiveVector torque(7);
  suite.add("zwidth SerialDynamics::inverse", 1, over([&](std::size_t s) {
              dynamics.inverse(q[s], rate[s], acceleration[s], {}, torque);
              bench::keep(torque);
            }));
  suite.goal(350e-9);
  suite.add("zwidth inverse_dynamics of a posture", 1, over([&](std::size_t s) {
              const ActiveVector result = inverse_dynamics(postures[s], rate[s], acceleration[s]);
              bench::keep(result);
            }));
  suite.add("zwidth SerialDynamics::mass_matrix", 1, over([&](std::size_t s) {
              const ActiveMatrix M = dynamics.mass_matrix(q[s]);
              bench::keep(M);
            }));
  suite.add("zwidth SerialDynamics::forward", 1, over([&](std::size_t s) {
              const ActiveVector result = dynamics.forward(q[s], rate[s], acceleration[s]);
              bench::keep(result);
            }));
  suite.run();
}

// -------------------------------------------------------------------------------------------------- the delta

Description delta_with_bodies() {
  Description description;
  description.name = "delta";
  description.mechanism = DeltaDescription{.base_radius = 0.08,
                                           .upper_arm = 0.08,
                                           .forearm = 0.16,
                                           .platform_radius = 0.055,
                                           .joint_range = {-1.4, 1.5}};
  description.bodies = {{.on = "upper_arm",
                         .mass = 0.06,
                         .centre = {0.034, 0.0, -0.002},
                         .inertia = Vector3(6e-6, 45e-6, 48e-6).asDiagonal()},
                        {.on = "forearm",
                         .mass = 0.036,
                         .centre = {0.0, 0.0, 0.08},
                         .inertia = Vector3(76.8e-6, 76.8e-6, 0.0).asDiagonal()},
                        {.on = "platform", .mass = 0.085, .inertia = Vector3(7e-5, 7e-5, 13e-5).asDiagonal()}};
  return description;
}

constexpr double kStep = 1e-3;
const Vector3 kMiddle(0.5, 0.5, 0.5);

// The drives hold the device near the middle and shake it: one law for every engine.
Vector3 law(const Vector3& theta, const Vector3& rate, double time) {
  Vector3 torque;
  for (int i = 0; i < 3; ++i)
    torque[i] = 0.05 * std::sin(6.0 * time + i) - 0.5 * (theta[i] - kMiddle[i]) - 0.004 * rate[i];
  return torque;
}

void delta(const bench::Options& options) {
  Mechanism mechanism(delta_with_bodies());
  mechanism.set_drive_inertia(Vector3::Constant(6.5e-4));
  const DeltaDynamics dynamics = *DeltaDynamics::of(mechanism);
  const Posture home = *solve_forward(mechanism, kMiddle).posture;

  const auto mujoco_step = [time = 0.0](Mujoco& mujoco, double dt) mutable {
    Vector3 theta, rate;
    for (int i = 0; i < 3; ++i) {
      theta[i] = mujoco.position(i);
      rate[i] = mujoco.rate(i);
    }
    mujoco.step(law(theta, rate, time));
    time += dt;
  };
  {  // half a second by both, with short steps
    Mujoco mujoco(home);
    constexpr double kShort = 2e-5;
    mujoco.use(mjSOL_NEWTON, mjINT_EULER, kShort);
    DeltaMotion motion{kMiddle, Vector3::Zero()};
    auto step = mujoco_step;
    const int steps = options.rounds <= 2 ? 2500 : 25000;
    for (int k = 0; k < steps; ++k) {
      step(mujoco, kShort);
      check(dynamics.step(motion, law(motion.theta, motion.rate, k * kShort), Vector3::Zero(), kShort) ==
                SolveStatus::reached,
            "the delta's loops");
    }
    double apart = 0.0;
    for (int i = 0; i < 3; ++i) apart = std::max(apart, std::abs(mujoco.position(i) - motion.theta[i]));
    std::printf("After %.2f s in steps of %.0f us the driven angles are %.1e rad from MuJoCo's.\n",
                steps * kShort, kShort * 1e6, apart);
    check(apart < 2e-3, "MuJoCo's motion of the delta");
  }

  bench::Suite suite("One 1 ms step of the delta, its loops closed", options);
  std::vector<std::unique_ptr<Mujoco>> engines;
  for (const auto& [name, solver] : {std::pair("MuJoCo 2.2.2 mj_step, Euler, Newton", mjSOL_NEWTON),
                                     std::pair("MuJoCo, CG", mjSOL_CG), std::pair("MuJoCo, PGS", mjSOL_PGS)}) {
    engines.push_back(std::make_unique<Mujoco>(home));
    engines.back()->use(solver, mjINT_EULER, kStep);
    suite.add(name, 1, [engine = engines.back().get(), step = mujoco_step](long n) mutable {
      for (long i = 0; i < n; ++i) step(*engine, kStep);
      bench::keep(*engine);
    });
  }
  DeltaMotion motion{kMiddle, Vector3::Zero()};
  double time = 0.0;
  suite.add("zwidth DeltaDynamics::step", 1, [&](long n) {
    for (long i = 0; i < n; ++i) {
      dynamics.step(motion, law(motion.theta, motion.rate, time), Vector3::Zero(), kStep);
      time += kStep;
    }
    bench::keep(motion);
  });
  DeltaMotion general{kMiddle, Vector3::Zero()};
  double general_time = 0.0;
  suite.add("zwidth solve_forward + forward_dynamics, any mechanism", 1, [&](long n) {
    for (long i = 0; i < n; ++i) {
      const Solution solution = solve_forward(mechanism, general.theta);
      const Vector3 acceleration =
          forward_dynamics(*solution.posture, general.rate, law(general.theta, general.rate, general_time));
      general.rate += kStep * acceleration;
      general.theta += kStep * general.rate;
      general_time += kStep;
    }
    bench::keep(general);
  });
  suite.run();
  double open = 0.0;
  const DeltaGeometry& geometry = *mechanism.delta();
  const Vector3 tool = delta_forward(geometry, motion.theta).position;
  for (int i = 0; i < 3; ++i) {
    const double azimuth = delta_azimuth(i),
                 outward = geometry.offset() + geometry.upper_arm * std::cos(motion.theta[i]);
    const Vector3 elbow(outward * std::cos(azimuth), outward * std::sin(azimuth),
                        geometry.upper_arm * std::sin(motion.theta[i]));
    open = std::max(open, std::abs((tool - elbow).norm() - geometry.forearm));
  }
  std::printf("After all those steps the loops are open by %.1e m.\n\n", open);
  check(open < 1e-12, "the loops stay closed");
}

}  // namespace

int main(int argc, char** argv) {
  const bench::Options options = bench::options_of(argc, argv);
  arm(options);
  delta(options);
  return 0;
}
