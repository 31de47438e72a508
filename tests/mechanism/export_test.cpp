#include "zwidth/mechanism/export.h"

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cstring>
#include <gtest/gtest.h>
#include <memory>
#include <mujoco/mujoco.h>
#include <stdexcept>

#include "support/deltas.h"
#include "support/r_cubes.h"

#include "zwidth/description/catalogue.h"
#include "zwidth/description/read.h"
#include "zwidth/mechanism/dynamics.h"

namespace zwidth {
namespace {

class Mujoco {
 public:
  explicit Mujoco(const std::string& xml) {
    mjVFS files;
    mj_defaultVFS(&files);
    mj_makeEmptyFileVFS(&files, "device.xml", static_cast<int>(xml.size()));
    std::memcpy(files.filedata[0], xml.data(), xml.size());
    std::array<char, 500> error{};
    model_ = mj_loadXML("device.xml", &files, error.data(), static_cast<int>(error.size()));
    mj_deleteVFS(&files);
    if (model_ == nullptr) throw std::runtime_error(std::string(error.data()) + "\n" + xml);
    data_ = mj_makeData(model_);
  }
  ~Mujoco() {
    mj_deleteData(data_);
    mj_deleteModel(model_);
  }
  Mujoco(const Mujoco&) = delete;
  Mujoco& operator=(const Mujoco&) = delete;

  int joint(const std::string& name) const {
    const int id = mj_name2id(model_, mjOBJ_JOINT, name.c_str());
    if (id < 0) throw std::runtime_error("no joint " + name);
    return id;
  }
  double& position(const std::string& name) { return data_->qpos[model_->jnt_qposadr[joint(name)]]; }
  double& rate(const std::string& name) { return data_->qvel[model_->jnt_dofadr[joint(name)]]; }
  double& torque(const std::string& name) { return data_->qfrc_applied[model_->jnt_dofadr[joint(name)]]; }
  double acceleration(const std::string& name) { return data_->qacc[model_->jnt_dofadr[joint(name)]]; }
  bool has(const std::string& name) const { return mj_name2id(model_, mjOBJ_JOINT, name.c_str()) >= 0; }
  // Sets the platform's own freedoms, which are the model's last ones and have no names.
  void set_platform(const ToolVector& by, const ToolVector& rate) {
    const int n = static_cast<int>(by.size());
    for (int i = 0; i < n; ++i) {
      data_->qpos[model_->nq - n + i] = by[i];
      data_->qvel[model_->nv - n + i] = rate[i];
    }
  }
  void forward() { mj_forward(model_, data_); }
  Eigen::VectorXd rates() const { return Eigen::Map<const Eigen::VectorXd>(data_->qvel, model_->nv); }
  Eigen::VectorXd accelerations() const { return Eigen::Map<const Eigen::VectorXd>(data_->qacc, model_->nv); }
  double acceleration(const Eigen::VectorXd& of_all, const std::string& name) const {
    return of_all[model_->jnt_dofadr[joint(name)]];
  }

  // The accelerations that MuJoCo's own mass matrix, bias forces and constraint Jacobian J come to where
  // J qddot = -Jdot qdot holds exactly; Jdot qdot from differences of J.
  Eigen::VectorXd exact_accelerations() {
    const Constraint constraint = this->constraint();
    const Eigen::VectorXd f = applied() - Eigen::Map<const Eigen::VectorXd>(data_->qfrc_bias, model_->nv);
    const Eigen::VectorXd led = -constraint.lead(constraint.bias);
    const Eigen::MatrixXd Z = constraint.free_motions(), &M = constraint.mass;
    return led + Z * (Z.transpose() * M * Z).ldlt().solve(Z.transpose() * (f - M * led));
  }

  // What MuJoCo's solver says. Its constraints pull J qdot to zero with a damping b of ours, but leave out
  // Jdot qdot; it is put in by rates that lag behind by Jdot qdot / b, which is what its constraints would
  // settle on. They give by 1 - impedance: `impedances` are extrapolated to 1.
  Eigen::VectorXd solver_accelerations(const std::vector<double>& impedances) {
    constexpr double kDamping = 1e6;
    const Constraint constraint = this->constraint();
    const Eigen::VectorXd exact = rates();
    std::vector<Eigen::VectorXd> results;
    for (const double impedance : impedances) {
      for (int e = 0; e < model_->neq; ++e) {
        mjtNum* reference = model_->eq_solref + e * mjNREF;
        mjtNum* stiff = model_->eq_solimp + e * mjNIMP;
        reference[0] = 0.0;
        reference[1] = -kDamping * impedance;  // MuJoCo divides by the impedance
        stiff[0] = stiff[1] = impedance;
      }
      const Eigen::VectorXd lag = constraint.lead(constraint.bias / kDamping);
      for (int i = 0; i < model_->nv; ++i) data_->qvel[i] = exact[i] + lag[i];
      mj_forward(model_, data_);
      results.push_back(accelerations());
    }
    std::copy(exact.begin(), exact.end(), data_->qvel);
    // Lagrange's polynomial through all of them, at impedance 1.
    Eigen::VectorXd rigid = Eigen::VectorXd::Zero(model_->nv);
    for (std::size_t i = 0; i < impedances.size(); ++i) {
      double weight = 1.0;
      for (std::size_t k = 0; k < impedances.size(); ++k) {
        if (k != i) weight *= (1.0 - impedances[k]) / (impedances[i] - impedances[k]);
      }
      rigid += weight * results[i];
    }
    return rigid;
  }
  const mjModel& model() const { return *model_; }

 private:
  struct Constraint {
    Eigen::MatrixXd J, mass;
    Eigen::VectorXd bias;  // Jdot qdot

    // The smallest change of rates that changes J qdot by v. Planar loops hold some rows twice.
    Eigen::VectorXd lead(const Eigen::VectorXd& v) const {
      if (J.rows() == 0) return Eigen::VectorXd::Zero(J.cols());
      return rows().solve(v);
    }
    // Columns: motions that J leaves free.
    Eigen::MatrixXd free_motions() const {
      if (J.rows() == 0) return Eigen::MatrixXd::Identity(J.cols(), J.cols());
      const Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> of = rows();
      const Eigen::MatrixXd back = of.colsPermutation() * of.matrixZ().transpose();
      return back.rightCols(J.cols() - of.rank());
    }

   private:
    Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> rows() const {
      Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> of;
      of.setThreshold(1e-9);
      of.compute(J);
      return of;
    }
  };
  Eigen::VectorXd applied() const { return Eigen::Map<const Eigen::VectorXd>(data_->qfrc_applied, model_->nv); }
  Eigen::MatrixXd constraint_jacobian() const {
    using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    return Eigen::Map<const Rows>(data_->efc_J, data_->ne, model_->nv);
  }
  Constraint constraint() {
    const Eigen::VectorXd at = Eigen::Map<const Eigen::VectorXd>(data_->qpos, model_->nq), v = rates();
    Eigen::VectorXd moved[2];
    constexpr double h = 1e-5;
    for (const int side : {0, 1}) {
      mj_integratePos(model_, data_->qpos, v.data(), side == 0 ? -h : h);
      mj_fwdPosition(model_, data_);
      moved[side] = constraint_jacobian() * v;
      std::copy(at.begin(), at.end(), data_->qpos);
    }
    mj_forward(model_, data_);
    Constraint result{constraint_jacobian(), Eigen::MatrixXd(model_->nv, model_->nv),
                      (moved[1] - moved[0]) / (2.0 * h)};
    mj_fullM(model_, result.mass.data(), data_->qM);  // symmetric
    return result;
  }

  mjModel* model_ = nullptr;
  mjData* data_ = nullptr;
};

std::string exported_name(const Mechanism& mechanism, int j) {
  std::string name = mechanism.joint_names()[static_cast<std::size_t>(j)];
  for (char& c : name) c = c == '/' ? '_' : c;
  return name;
}

Posture home_of(const Mechanism& mechanism) {
  ActiveVector joints(mechanism.active_count());
  for (int i = 0; i < mechanism.active_count(); ++i)
    joints[i] = mechanism.home_guess()[mechanism.active_joint(i)];
  const Solution solution = solve_forward(mechanism, joints);
  if (!solution) throw std::runtime_error("home does not close");
  return *solution.posture;
}

// Puts a posture, and rates of every joint, into MuJoCo's model.
void set_state(Mujoco& mujoco, const Mechanism& mechanism, const Posture& posture, const JointVector& rate) {
  for (int j = 0; j < mechanism.joint_count(); ++j) {
    const std::string name = exported_name(mechanism, j);
    mujoco.position(name) = posture.joints()[j];
    mujoco.rate(name) = rate[j];
    const double turned = posture.joints()[j] - home_of(mechanism).joints()[j];
    if (mujoco.has(name + "_keeps")) {
      mujoco.position(name + "_keeps") = -turned;
      mujoco.rate(name + "_keeps") = -rate[j];
    }
    // Bodies on pins of the link before are turned by this joint.
    for (int k = 1; j > 0 && mujoco.has(exported_name(mechanism, j - 1) + "_pin" + std::to_string(k)); ++k) {
      mujoco.position(exported_name(mechanism, j - 1) + "_pin" + std::to_string(k)) = turned;
      mujoco.rate(exported_name(mechanism, j - 1) + "_pin" + std::to_string(k)) = rate[j];
    }
  }
}

// A posture anywhere in the middle of the joint ranges, reached from home.
Posture random_posture(std::mt19937_64& random, const Mechanism& mechanism, const Posture& home) {
  for (;;) {
    ActiveVector joints(mechanism.active_count());
    for (int i = 0; i < joints.size(); ++i) {
      const Interval range = mechanism.active_range(i);
      joints[i] = range.middle() + 0.4 * range.width() * test::uniform(random, -1.0, 1.0);
    }
    SolveOptions follow;
    follow.start = &home;
    const Solution solution = solve_forward(mechanism, joints, follow);
    if (solution.status == SolveStatus::reached && solution.conditioning > 0.02) return *solution.posture;
  }
}

// Accelerations of the active joints in random states, as largest difference over largest acceleration.
struct Differences {
  double exact = 0.0;   // from what MuJoCo's own matrices come to with closed loops
  double solver = 0.0;  // from what its constraint solver says
};
Differences worst_differences(const Description& description, int states, bool moving,
                              const std::vector<double>& impedances = {}) {
  Mechanism mechanism(description);
  ActiveVector inertia = ActiveVector::Constant(mechanism.active_count(), 1e-4);
  mechanism.set_drive_inertia(inertia);
  const Posture home = home_of(mechanism);
  const LegModel& first = mechanism.legs().front();
  const bool slides = first.attachment != Attachment::rigid && mechanism.platform() != PlatformFreedom::point;
  Mujoco mujoco(export_mjcf(home).text);
  std::mt19937_64 random(51);
  Differences worst;
  for (int s = 0; s < states; ++s) {
    const Posture posture = random_posture(random, mechanism, home);
    const int n = mechanism.active_count();
    ActiveVector rate(n), torque(n);
    for (int i = 0; i < n; ++i) {
      rate[i] = moving ? test::uniform(random, -2.0, 2.0) : 0.0;
      torque[i] = test::uniform(random, -0.5, 0.5);
      mujoco.torque(exported_name(mechanism, mechanism.active_joint(i))) = torque[i];
    }
    const Rates all = rates(posture);
    set_state(mujoco, mechanism, posture, all.joints * rate);
    if (slides) {
      const ToolVector by = (posture.tool().position - home.tool().position).head(mechanism.linear_rows());
      mujoco.set_platform(by, all.tool * rate);
    }
    mujoco.forward();
    const ActiveVector expected = forward_dynamics(posture, rate, torque);
    const Eigen::VectorXd exact = mujoco.exact_accelerations();
    const Eigen::VectorXd solver =
        impedances.empty() ? mujoco.accelerations() : mujoco.solver_accelerations(impedances);
    for (int i = 0; i < n; ++i) {
      const std::string name = exported_name(mechanism, mechanism.active_joint(i));
      const double largest = expected.cwiseAbs().maxCoeff();
      worst.exact = std::max(worst.exact, std::abs(mujoco.acceleration(exact, name) - expected[i]) / largest);
      worst.solver =
          std::max(worst.solver, std::abs(mujoco.acceleration(solver, name) - expected[i]) / largest);
    }
  }
  return worst;
}

Description device(const char* name) {
  static const Catalogue catalogue = Catalogue::load();
  return read_description(name, {}, catalogue);
}

TEST(ExportMjcf, OpenChainsMoveAsInMujoco) {
  for (const char* name : {"pneumatic-1", "pneumatic-2", "pneumatic-3"}) {
    EXPECT_LT(worst_differences(device(name), 50, true).solver, 1e-6) << name;
  }
  // An arm with a sliding joint, and bodies of every shape.
  Description arm;
  arm.name = "arm";
  arm.mechanism = SerialDescription{
      .joints = {
          {.name = "a", .a = 0.2, .alpha = 0.7, .range = {-2, 2}},
          {.name = "b", .type = SerialJointType::prismatic, .d = 0.1, .alpha = -1.2, .range = {-0.1, 0.1}},
          {.name = "c", .d = 0.1, .a = 0.3, .alpha = 0.4, .range = {-2, 2}}}};
  for (const char* on : {"arm/a", "arm/b", "arm/c", "platform"}) {
    arm.bodies.push_back(
        {.on = on,
         .mass = 0.3,
         .centre = {0.1, -0.05, 0.02},
         .inertia = (Matrix3() << 3e-4, 2e-5, -1e-5, 2e-5, 4e-4, 3e-5, -1e-5, 3e-5, 5e-4).finished()});
  }
  EXPECT_LT(worst_differences(arm, 50, true).solver, 1e-6);
}

// Every device with closed loops, in 50 states at rest and 50 in motion.
class ClosedLoops : public testing::Test {
 protected:
  static std::vector<Description> devices() {
    return {test::with_bodies(test::published_delta()),
            test::with_parallelograms(test::published_delta()),
            device("delta"),
            device("five-bar"),
            device("r-cube"),
            device("seven-dof")};
  }
};

TEST_F(ClosedLoops, MoveAsMujocosMatricesSay) {
  // It has 1e-9 kg on links without mass and 1e-12 kg m^2 more on every link: some 1e-7 of what moves here.
  for (const Description& description : devices()) {
    for (const bool moving : {false, true}) {
      const double worst = worst_differences(description, 50, moving).exact;
      EXPECT_LT(worst, 1e-6) << description.name << moving;
    }
  }
}

TEST_F(ClosedLoops, MoveAsMujocosSolverSays) {
  // Of what its constraints give by, up to 2 % of the acceleration at the stiffest, three impedances leave the
  // cube; then the links' masses are what differs.
  for (const Description& description : devices()) {
    for (const bool moving : {false, true}) {
      const double worst = worst_differences(description, 50, moving, {0.9996, 0.9998, 0.9999}).solver;
      EXPECT_LT(worst, 1e-6) << description.name << moving;
    }
  }
}

TEST(ExportMjcf, SaysItsJointsAndMotors) {
  const Mechanism mechanism(device("r-cube"));
  const ExportedModel exported = export_mjcf(home_of(mechanism));
  EXPECT_TRUE(exported.notices.empty());
  const Mujoco mujoco(exported.text);
  EXPECT_EQ(mujoco.model().njnt, 15);
  EXPECT_EQ(mujoco.model().neq, 2);  // the first leg carries the platform
  EXPECT_EQ(mujoco.model().nu, 3);
  EXPECT_NE(exported.text.find("<motor name=\"leg1_theta1\""), std::string::npos);
}

TEST(ExportUrdf, HasEveryJointOfATreeAndSaysWhatIsMissing) {
  const Mechanism mechanism(device("r-cube"));
  const ExportedModel exported = export_urdf(mechanism, ActiveVector::Constant(3, 1.2));
  ASSERT_EQ(exported.notices.size(), 1u);
  EXPECT_NE(exported.notices[0].find("URDF is a tree"), std::string::npos);
  EXPECT_NE(exported.text.find("effort=\"1.2"), std::string::npos);
  // MuJoCo reads URDF too: the tree of fifteen joints, with the weight of the links.
  const Mujoco mujoco(exported.text);
  EXPECT_EQ(mujoco.model().njnt, 15);
  EXPECT_NEAR(mj_getTotalmass(&mujoco.model()), moving_mass(mechanism), 1e-7);
  EXPECT_EQ(export_urdf(Mechanism(device("pneumatic-3"))).notices.size(), 0u);
}

TEST(ExportUrdf, ASerialArmFallsAsItDoesHere) {
  // URDF by MuJoCo, which fuses what is fixed: the same accelerations, without inertia of drives.
  Description description = device("pneumatic-3");
  description.gravity = {0.0, 0.0, -9.81};  // URDF has none; this is MuJoCo's
  const Mechanism mechanism(description);
  Mujoco mujoco(export_urdf(mechanism).text);
  std::mt19937_64 random(52);
  for (int s = 0; s < 20; ++s) {
    ActiveVector joints(mechanism.active_count());
    for (int i = 0; i < joints.size(); ++i) {
      const Interval range = mechanism.active_range(i);
      joints[i] = range.middle() + 0.4 * range.width() * test::uniform(random, -1.0, 1.0);
    }
    const Solution solution = solve_forward(mechanism, joints);
    ASSERT_TRUE(solution);
    set_state(mujoco, mechanism, *solution.posture, JointVector::Zero(mechanism.joint_count()));
    mujoco.forward();
    const ActiveVector rest = ActiveVector::Zero(joints.size()),
                       expected = forward_dynamics(*solution.posture, rest, rest);
    for (int i = 0; i < joints.size(); ++i) {
      EXPECT_NEAR(mujoco.acceleration(exported_name(mechanism, mechanism.active_joint(i))), expected[i],
                  1e-6 * expected.cwiseAbs().maxCoeff());
    }
  }
}

}  // namespace
}  // namespace zwidth
