#include <array>
#include <memory>
#include <mujoco/mujoco.h>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "harness.h"
#include "textbook.h"

#include "zwidth/analysis/force.h"
#include "zwidth/mechanism/batch_delta.h"
#include "zwidth/mechanism/families.h"
#include "zwidth/mechanism/jacobian.h"
#include "zwidth/mechanism/mechanism.h"
#include "zwidth/mechanism/posture.h"

/// One posture of the delta at a time, and many at once, beside MuJoCo and the textbook.

namespace {

using zwidth::Vector3;

constexpr int kPoses = 1024;
constexpr double kTorque = 1.359;
constexpr double kDegree = std::numbers::pi / 180.0;

zwidth::DeltaDescription published() {
  return {.base_radius = 0.08,
          .upper_arm = 0.08,
          .forearm = 0.16,
          .platform_radius = 0.055,
          .joint_range = {-36.0 * kDegree, 84.0 * kDegree}};
}

// The same mechanism for MuJoCo: legs of three hinges, a platform on three slides, held together by
// connections.
std::string mujoco_model(const zwidth::DeltaGeometry& geometry) {
  std::string xml = "<mujoco><compiler angle='radian'/><worldbody>";
  const auto inertia = [](const char* at) {
    return "<inertial pos='" + std::string(at) + "' mass='0.03' diaginertia='1e-5 1e-5 1e-5'/>";
  };
  const auto number = [](double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.17g ", value);
    return std::string(text);
  };
  for (int i = 0; i < 3; ++i) {
    const double a = zwidth::delta_azimuth(i), d1 = geometry.base_radius;
    xml += "<body pos='" + number(d1 * std::cos(a)) + number(d1 * std::sin(a)) + "0' quat='" +
           number(std::cos(a / 2)) + "0 0 " + number(std::sin(a / 2)) + "'>";
    xml += "<body><joint type='hinge' axis='0 -1 0'/>" + inertia("0.04 0 0");
    xml += "<body name='forearm" + std::to_string(i) + "' pos='" + number(geometry.upper_arm) +
           "0 0'><joint type='hinge' axis='0 -1 0'/><joint type='hinge' axis='1 0 0'/>" + inertia("0 0 0.08") +
           "</body></body></body>";
  }
  xml +=
      "<body name='platform' pos='0 0 0.15'><joint type='slide' axis='1 0 0'/><joint type='slide' axis='0 1 "
      "0'/>"
      "<joint type='slide' axis='0 0 1'/>" +
      inertia("0 0 0") + "</body></worldbody><equality>";
  for (int i = 0; i < 3; ++i) {
    xml += "<connect body1='forearm" + std::to_string(i) + "' body2='platform' anchor='0 0 " +
           number(geometry.forearm) + "'/>";
  }
  return xml + "</equality></mujoco>";
}

struct MujocoDelta {
  explicit MujocoDelta(const zwidth::DeltaGeometry& geometry) {
    const std::string xml = mujoco_model(geometry);
    auto files = std::make_unique<mjVFS>();
    mj_defaultVFS(files.get());
    mj_makeEmptyFileVFS(files.get(), "delta.xml", static_cast<int>(xml.size()));
    std::copy(xml.begin(), xml.end(), static_cast<char*>(files->filedata[0]));
    char error[500] = "";
    model = mj_loadXML("delta.xml", files.get(), error, sizeof error);
    mj_deleteVFS(files.get());
    if (model == nullptr) {
      std::fprintf(stderr, "MuJoCo: %s\n", error);
      std::exit(3);
    }
    data = mj_makeData(model);
    platform = mj_name2id(model, mjOBJ_BODY, "platform");
  }
  ~MujocoDelta() {
    mj_deleteData(data);
    mj_deleteModel(model);
  }
  MujocoDelta(const MujocoDelta&) = delete;
  MujocoDelta& operator=(const MujocoDelta&) = delete;

  mjModel* model = nullptr;
  mjData* data = nullptr;
  int platform = 0;
};

}  // namespace

int main(int argc, char** argv) {
  const bench::Options options = bench::options_of(argc, argv);
  const zwidth::DeltaDescription delta = published();
  const zwidth::DeltaGeometry geometry = zwidth::delta_geometry(delta);
  const bench::Textbook textbook(geometry, delta.joint_range);

  // Random postures.
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> angle(delta.joint_range.min, delta.joint_range.max);
  std::vector<Vector3> theta(kPoses), position(kPoses);
  for (int p = 0; p < kPoses; ++p) {
    theta[p] = {angle(random), angle(random), angle(random)};
    position[p] = zwidth::delta_forward(geometry, theta[p]).position;
  }

  double worst = 0.0;
  for (int p = 0; p < kPoses; ++p) {
    Vector3 angles;
    const bool inside = textbook.inverse(position[p], angles);
    worst = std::max(
        {worst, (textbook.forward(theta[p]) - position[p]).norm(), inside ? (angles - theta[p]).norm() : 0.0});
  }
  std::printf("library and textbook agree to %.1e; SIMD target %s\n\n", worst, zwidth::batch_target_name());

  MujocoDelta mujoco(geometry);
  bench::Suite forward("Forward kinematics with Jacobian, random postures of the published delta", options);
  forward.add("textbook: elimination, Eigen inverse", kPoses, [&](long n) {
    for (long it = 0; it < n; ++it) {
      for (const Vector3& q : theta) {
        const Vector3 p = textbook.forward(q);
        bench::keep(p);
        bench::keep(textbook.jacobian(q, p));
      }
    }
  });
  forward.add("zwidth delta_forward", kPoses, [&](long n) {
    for (long it = 0; it < n; ++it) {
      for (const Vector3& q : theta) bench::keep(zwidth::delta_forward(geometry, q));
    }
  });
  forward.goal(120e-9);
  forward.add("MuJoCo " + std::string(mj_versionString()) + " mj_kinematics + mj_comPos, loops given", kPoses,
              [&](long n) {
                for (long it = 0; it < n; ++it) {
                  for (int p = 0; p < kPoses; ++p) {
                    for (int i = 0; i < 3; ++i) {
                      mujoco.data->qpos[3 * i] = theta[p][i];
                      mujoco.data->qpos[9 + i] = position[p][i];
                    }
                    mj_kinematics(mujoco.model, mujoco.data);
                    mj_comPos(mujoco.model, mujoco.data);
                  }
                }
              });
  forward.add("MuJoCo, the same with mj_jac of the three forearm ends", kPoses, [&](long n) {
    std::array<mjtNum, 3 * 12> jacobian;
    for (long it = 0; it < n; ++it) {
      for (int p = 0; p < kPoses; ++p) {
        for (int i = 0; i < 3; ++i) {
          mujoco.data->qpos[3 * i] = theta[p][i];
          mujoco.data->qpos[9 + i] = position[p][i];
        }
        mj_kinematics(mujoco.model, mujoco.data);
        mj_comPos(mujoco.model, mujoco.data);
        for (int body : {3, 6, 9}) {
          mj_jac(mujoco.model, mujoco.data, jacobian.data(), nullptr, mujoco.data->xpos + 3 * body, body);
          bench::keep(jacobian);
        }
      }
    }
  });
  const zwidth::DeltaBatch batch(geometry, delta.joint_range, {.torque = Vector3::Constant(kTorque)});
  std::vector<double> cosine(3 * kPoses), sine(3 * kPoses), x(kPoses), y(kPoses), z(kPoses), det(kPoses);
  for (int leg = 0; leg < 3; ++leg) {
    for (int p = 0; p < kPoses; ++p) {
      cosine[leg * kPoses + p] = std::cos(theta[p][leg]);
      sine[leg * kPoses + p] = std::sin(theta[p][leg]);
    }
  }
  forward.add("zwidth DeltaBatch::forward, positions and det J, angles as cosines", kPoses, [&](long n) {
    for (long it = 0; it < n; ++it) {
      batch.forward(cosine, sine, x, y, z, det);
      bench::keep(x[0]);
    }
  });
  forward.run();

  bench::Suite inverse("Inverse kinematics with Jacobian and axis force limits, random points of the workspace",
                       options);
  inverse.add("textbook: acos and atan2, Eigen inverse", kPoses, [&](long n) {
    for (long it = 0; it < n; ++it) {
      for (const Vector3& p : position) {
        Vector3 q;
        if (!textbook.inverse(p, q)) continue;
        const Eigen::Matrix3d J = textbook.jacobian(q, p);
        bench::keep(J);
        bench::keep(textbook.axis_forces(J, kTorque));
      }
    }
  });
  inverse.add("zwidth delta_inverse, axis_force_limits", kPoses, [&](long n) {
    const Vector3 torque = Vector3::Constant(kTorque);
    for (long it = 0; it < n; ++it) {
      for (const Vector3& p : position) {
        const zwidth::DeltaInverse pose = zwidth::delta_inverse(geometry, p, delta.joint_range);
        bench::keep(pose);
        bench::keep(zwidth::axis_force_limits(pose.jacobian, torque));
      }
    }
  });
  inverse.goal(100e-9);
  std::vector<double> px(kPoses), py(kPoses), pz(kPoses), figures(kPoses * zwidth::kFigureCount);
  for (int p = 0; p < kPoses; ++p) {
    px[p] = position[p].x();
    py[p] = position[p].y();
    pz[p] = position[p].z();
  }
  inverse.add("zwidth DeltaBatch::figures, all 12 stored", kPoses, [&](long n) {
    for (long it = 0; it < n; ++it) {
      batch.figures(px, py, pz, figures);
      bench::keep(figures[0]);
    }
  });
  inverse.run();
  return 0;
}
