#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <kdl/chain.hpp>
#include <kdl/chainfksolverpos_recursive.hpp>
#include <kdl/chainjnttojacsolver.hpp>
#include <memory>
#include <mujoco/mujoco.h>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "harness.h"

#include "zwidth/analysis/reach.h"
#include "zwidth/mechanism/batch_serial.h"
#include "zwidth/mechanism/jacobian.h"
#include "zwidth/mechanism/posture.h"
#include "zwidth/mechanism/serial_chain.h"
#include "zwidth/mechanism/srs_arm.h"

/// The 7-DOF arm: one posture and many, forward and inverse, beside MuJoCo and KDL; and the volume of its
/// reach.

namespace {

using namespace zwidth;

constexpr int kPoses = 1024;
constexpr double kDegree = std::numbers::pi / 180.0, kQuarter = 0.5 * std::numbers::pi;
constexpr SrsLengths kLengths{.upper_arm = 0.25, .forearm = 0.25};

Description arm_of_baser() {
  const double alpha[7] = {-kQuarter, kQuarter, -kQuarter, kQuarter, -kQuarter, kQuarter, 0.0};
  const double d[7] = {0.0, 0.0, kLengths.upper_arm, 0.0, kLengths.forearm, 0.0, 0.0};
  const Interval range[7] = {{-90.0, 90.0}, {30.0, 120.0}, {-60.0, 60.0}, {45.0, 135.0},
                             {0.0, 360.0},  {0.0, 360.0},  {0.0, 360.0}};
  const double home[7] = {0.0, 75.0, 0.0, 90.0, 90.0, 90.0, 90.0};
  SerialDescription arm;
  for (int i = 0; i < 7; ++i) {
    arm.joints.push_back({.name = "theta" + std::to_string(i + 1),
                          .d = d[i],
                          .alpha = alpha[i],
                          .range = {range[i].min * kDegree, range[i].max * kDegree},
                          .home = home[i] * kDegree});
  }
  Description description;
  description.name = "arm";
  description.mechanism = arm;
  return description;
}

/// The same arm for MuJoCo: hinges about z and y in turn, the tool's site in the wrist.
class MujocoArm {
 public:
  MujocoArm() {
    const std::string hinge_z = "<joint type='hinge' axis='0 0 1'/>",
                      hinge_y = "<joint type='hinge' axis='0 1 0'/>";
    const std::string mass = "<geom type='sphere' size='0.01' mass='0.1'/>";
    std::string open, close;
    for (int i = 0; i < 7; ++i) {
      const char* at = i == 3 ? "0 0 0.25" : i == 4 ? "0 0 0.25" : "0 0 0";
      open += std::string("<body pos='") + at + "'>" + (i % 2 == 0 ? hinge_z : hinge_y) + mass;
      if (i == 6) open += "<site name='tool'/>";
      close += "</body>";
    }
    const std::string xml = "<mujoco><worldbody>" + open + close + "</worldbody></mujoco>";
    auto vfs = std::make_unique<mjVFS>();
    mj_defaultVFS(vfs.get());
    mj_makeEmptyFileVFS(vfs.get(), "arm.xml", static_cast<int>(xml.size()));
    std::copy(xml.begin(), xml.end(), static_cast<char*>(vfs->filedata[0]));
    char error[256] = "";
    model_ = mj_loadXML("arm.xml", vfs.get(), error, sizeof error);
    mj_deleteVFS(vfs.get());
    if (model_ == nullptr) {
      std::fprintf(stderr, "MuJoCo: %s\n", error);
      std::abort();
    }
    data_ = mj_makeData(model_);
    site_ = mj_name2id(model_, mjOBJ_SITE, "tool");
  }
  ~MujocoArm() {
    mj_deleteData(data_);
    mj_deleteModel(model_);
  }
  MujocoArm(const MujocoArm&) = delete;
  MujocoArm& operator=(const MujocoArm&) = delete;

  void forward(const ActiveVector& q) {
    std::copy(q.data(), q.data() + 7, data_->qpos);
    mj_kinematics(model_, data_);
    mj_comPos(model_, data_);  // what mj_jac reads
    mj_jac(model_, data_, linear_.data(), angular_.data(), data_->site_xpos + 3 * site_,
           model_->site_bodyid[site_]);
  }
  Vector3 position() const { return Eigen::Map<const Vector3>(data_->site_xpos + 3 * site_); }
  double jacobian(int row, int column) const {
    return row < 3 ? linear_[7 * row + column] : angular_[7 * (row - 3) + column];
  }

 private:
  mjModel* model_ = nullptr;
  mjData* data_ = nullptr;
  int site_ = 0;
  std::array<mjtNum, 21> linear_{}, angular_{};
};

class KdlArm {
 public:
  explicit KdlArm(const SerialDescription& arm) : chain_(of(arm)), position_(chain_), jacobian_(chain_) {}
  void forward(const ActiveVector& q) {
    for (int j = 0; j < 7; ++j) joints_(j) = q[j];
    position_.JntToCart(joints_, frame);
    jacobian_.JntToJac(joints_, jacobian);
  }
  KDL::Frame frame;
  KDL::Jacobian jacobian{7};

 private:
  static KDL::Chain of(const SerialDescription& arm) {
    KDL::Chain chain;
    for (const SerialJointDescription& row : arm.joints)
      chain.addSegment(
          KDL::Segment(KDL::Joint(KDL::Joint::RotZ), KDL::Frame::DH(row.a, row.alpha, row.d, row.theta)));
    return chain;
  }
  KDL::Chain chain_;
  KDL::ChainFkSolverPos_recursive position_;
  KDL::ChainJntToJacSolver jacobian_;
  KDL::JntArray joints_{7};
};

void check(bool ok, const char* what) {
  if (ok) return;
  std::fprintf(stderr, "contestants disagree: %s\n", what);
  std::exit(1);
}

}  // namespace

int main(int argc, char** argv) {
  const bench::Options options = bench::options_of(argc, argv);
  const bool quick = options.rounds <= 2;
  const Description description = arm_of_baser();
  const Mechanism mechanism(description);
  const SerialChain& chain = *mechanism.serial();
  MujocoArm mujoco;
  KdlArm kdl(std::get<SerialDescription>(description.mechanism));

  std::mt19937_64 random(1);
  std::vector<ActiveVector> joints;
  std::vector<Pose> poses;
  for (int p = 0; p < kPoses; ++p) {
    ActiveVector q(7);
    for (int j = 0; j < 7; ++j) {
      const Interval range = mechanism.active_range(j);
      q[j] = std::uniform_real_distribution<double>(range.min, range.max)(random);
    }
    joints.push_back(q);
    poses.push_back(chain.pose(q));
    SerialForward ours;
    chain.forward(q, ours);
    mujoco.forward(q);
    kdl.forward(q);
    check((ours.jacobian - kdl.jacobian.data).cwiseAbs().maxCoeff() < 1e-14, "KDL's Jacobian");
    check((ours.tool.position - mujoco.position()).norm() < 1e-14, "MuJoCo's position");
    double worst = 0.0;
    for (int r = 0; r < 6; ++r) {
      for (int c = 0; c < 7; ++c)
        worst = std::max(worst, std::abs(ours.jacobian(r, c) - mujoco.jacobian(r, c)));
    }
    check(worst < 1e-14, "MuJoCo's Jacobian");
  }
  const auto over = [](auto&& one) {
    return [one, at = std::size_t{0}](long n) mutable {
      for (long i = 0; i < n; ++i) one(at++ % kPoses);
    };
  };

  {
    bench::Suite suite("Forward kinematics of the 7-DOF arm with its 6 x 7 Jacobian", options);
    SerialForward ours;
    suite.add("MuJoCo 2.2.2 mj_kinematics + mj_comPos + mj_jac", 1, over([&](std::size_t p) {
                mujoco.forward(joints[p]);
                bench::keep(mujoco);
              }));
    suite.add("KDL 1.5 JntToCart + JntToJac", 1, over([&](std::size_t p) {
                kdl.forward(joints[p]);
                bench::keep(kdl);
              }));
    suite.add("zwidth SerialChain::forward", 1, over([&](std::size_t p) {
                chain.forward(joints[p], ours);
                bench::keep(ours);
              }));
    suite.goal(160e-9);
    suite.add("zwidth solve_forward + jacobian, judged", 1, over([&](std::size_t p) {
                const Solution solution = solve_forward(mechanism, joints[p]);
                const Jacobian J = jacobian(*solution.posture);
                bench::keep(J);
              }));
    const SerialBatch batch(chain);
    std::vector<double> flat(7 * kPoses), x(kPoses), y(kPoses), z(kPoses), manipulability(kPoses),
        conditioning(kPoses);
    for (int p = 0; p < kPoses; ++p) {
      for (int j = 0; j < 7; ++j) flat[static_cast<std::size_t>(j) * kPoses + p] = joints[p][j];
    }
    suite.add("zwidth SerialBatch::positions", kPoses, [&](long n) {
      for (long i = 0; i < n; ++i) {
        batch.positions(flat, x, y, z);
        bench::keep(x);
      }
    });
    suite.add("zwidth SerialBatch::dexterity, det(J J^T) of 6 x 7", kPoses, [&](long n) {
      for (long i = 0; i < n; ++i) {
        batch.dexterity(flat, SerialBatch::Rows::pose, 0.25, x, y, z, manipulability, {});
        bench::keep(manipulability);
      }
    });
    suite.goal(30e-9);
    suite.add("zwidth SerialBatch::dexterity, the same and conditioning", kPoses, [&](long n) {
      for (long i = 0; i < n; ++i) {
        batch.dexterity(flat, SerialBatch::Rows::pose, 0.25, x, y, z, manipulability, conditioning);
        bench::keep(manipulability);
      }
    });
    suite.goal(30e-9);
    suite.run();
  }

  {
    bench::Suite suite("Inverse kinematics of the 7-DOF arm", options);
    suite.add("srs_inverse, theta1 given: all 8", 1, over([&](std::size_t p) {
                const SrsSolutions all = srs_inverse(kLengths, poses[p], SrsGiven::theta1, joints[p][0]);
                bench::keep(all);
              }));
    suite.goal(1500e-9);
    suite.add("srs_inverse, theta2 given: all 8", 1, over([&](std::size_t p) {
                const SrsSolutions all = srs_inverse(kLengths, poses[p], SrsGiven::theta2, joints[p][1]);
                bench::keep(all);
              }));
    suite.goal(1500e-9);
    suite.add("srs_inverse, theta3 given: all 8", 1, over([&](std::size_t p) {
                const SrsSolutions all = srs_inverse(kLengths, poses[p], SrsGiven::theta3, joints[p][2]);
                bench::keep(all);
              }));
    suite.goal(1500e-9);
    const auto solve = [&](Redundancy redundancy, bool closed_form) {
      return over([&mechanism, &joints, &poses, redundancy, closed_form](std::size_t p) {
        SolveOptions how{.closed_form = closed_form};
        how.redundancy = redundancy;
        how.redundancy.value = joints[p][2];
        const Solution solution = solve_inverse(mechanism, poses[p], how);
        bench::keep(solution);
      });
    };
    suite.add("solve_inverse, theta3 kept", 1, solve({.rule = Redundancy::Rule::keep, .joint = 2}, true));
    suite.add("solve_inverse, largest manipulability", 1, solve({.rule = Redundancy::Rule::maximise}, true));
    // A control cycle: each goal a millimetre on from the last posture.
    std::vector<Posture> starts;
    std::vector<Pose> goals;
    for (ActiveVector q : joints) {
      for (int j = 0; j < 7; ++j) {  // in the middle of the ranges
        const Interval range = mechanism.active_range(j);
        q[j] = range.middle() + 0.6 * (q[j] - range.middle());
      }
      starts.push_back(*solve_forward(mechanism, q).posture);
      goals.push_back(starts.back().tool());
      goals.back().position.x() -= 0.001;
    }
    for (const bool closed_form : {true, false}) {
      suite.add(closed_form ? "solve_inverse, nearest, 1 mm on: closed form" : "the same by iteration", 1,
                over([&, closed_form](std::size_t p) {
                  const Solution solution = solve_inverse(
                      mechanism, goals[p], {.start = &starts[p], .closed_form = closed_form, .restart = false});
                  bench::keep(solution);
                }));
    }
    suite.run();
  }

  std::printf("Volume of the reach, two threads, s of wall time (goal 1)\n\n");
  std::printf("| contestant | volume m^3 | error | median | worst |\n|---|---:|---:|---:|---:|\n");
  for (const bool closed_form : {true, false}) {
    std::vector<double> times;
    ReachableVolume volume;
    for (int round = 0; round < (quick ? 1 : 5); ++round) {
      const double start = bench::wall_seconds();
      volume = reachable_volume(
          mechanism, {.closed_form = closed_form, .samples = quick ? 100'000 : 10'000'000}, {.threads = 2});
      times.push_back(bench::wall_seconds() - start);
    }
    std::printf("| %s | %.5f | %.5f | %.3f | %.3f |\n",
                closed_form ? "10^6 cubes, each decided in closed form" : "the same from 10^7 postures drawn",
                volume.value, volume.error_estimate, bench::quantile(times, 0.5), bench::quantile(times, 1.0));
  }
  return 0;
}
