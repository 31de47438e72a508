#include "zwidth/mechanism/export.h"

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
  void move_platform(const Vector3& by) {
    // Its joints have no names: the last ones of the model.
    for (int i = 0; i < 3; ++i) data_->qpos[model_->nq - 3 + i] = by[i];
  }
  void forward() { mj_forward(model_, data_); }
  const mjModel& model() const { return *model_; }

 private:
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

// Accelerations of the active joints by both, in random states; the largest difference over the largest
// acceleration.
double worst_difference(const Description& description, int states, bool moving,
                        const MjcfOptions& options = {}, bool platform_slides = false) {
  Mechanism mechanism(description);
  ActiveVector inertia = ActiveVector::Constant(mechanism.active_count(), 1e-4);
  mechanism.set_drive_inertia(inertia);
  const Posture home = home_of(mechanism);
  Mujoco mujoco(export_mjcf(home, options).text);
  std::mt19937_64 random(51);
  double worst = 0.0;
  for (int s = 0; s < states; ++s) {
    ActiveVector joints(mechanism.active_count()), rate(joints.size()), torque(joints.size());
    std::optional<Posture> posture;
    while (!posture) {
      for (int i = 0; i < joints.size(); ++i) {
        const Interval range = mechanism.active_range(i);
        joints[i] = range.middle() + 0.4 * range.width() * test::uniform(random, -1.0, 1.0);
      }
      SolveOptions follow;
      follow.start = &home;
      posture = solve_forward(mechanism, joints, follow).posture;
    }
    for (int i = 0; i < joints.size(); ++i) {
      rate[i] = moving ? test::uniform(random, -2.0, 2.0) : 0.0;
      torque[i] = test::uniform(random, -0.5, 0.5);
      mujoco.torque(exported_name(mechanism, mechanism.active_joint(i))) = torque[i];
    }
    set_state(mujoco, mechanism, *posture, rates(*posture).joints * rate);
    if (platform_slides) mujoco.move_platform(posture->tool().position - home.tool().position);
    mujoco.forward();
    const ActiveVector expected = forward_dynamics(*posture, rate, torque);
    for (int i = 0; i < joints.size(); ++i) {
      const double got = mujoco.acceleration(exported_name(mechanism, mechanism.active_joint(i)));
      worst = std::max(worst, std::abs(got - expected[i]) / expected.cwiseAbs().maxCoeff());
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
    EXPECT_LT(worst_difference(device(name), 50, true), 1e-6) << name;
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
  EXPECT_LT(worst_difference(arm, 50, true), 1e-6);
}

TEST(ExportMjcf, ClosedLoopsMoveAsFarAsMujocosConstraintsHold) {
  // From rest: MuJoCo leaves out what velocities of its constraints' own Jacobian do. They give by 1 -
  // impedance.
  const MjcfOptions soft{.impedance = 0.999}, stiff{.impedance = 0.9998};
  const auto both = [&](const Description& description, bool slides) {
    const double a = worst_difference(description, 50, false, soft, slides),
                 b = worst_difference(description, 50, false, stiff, slides);
    EXPECT_LT(b, 0.3 * a) << description.name;  // in proportion to what is missing to 1
    return b;
  };
  EXPECT_LT(both(test::with_bodies(test::published_delta()), true), 3e-3);
  EXPECT_LT(both(device("r-cube"), false), 2e-2);
  EXPECT_LT(both(device("seven-dof"), false), 2e-2);
  EXPECT_LT(both(test::with_parallelograms(test::published_delta()), false), 3e-2);
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
