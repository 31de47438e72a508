#include <Eigen/Dense>
#include <array>
#include <memory>
#include <mujoco/mujoco.h>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "harness.h"

#include "zwidth/analysis/five_bar_search.h"
#include "zwidth/mechanism/batch_five_bar.h"
#include "zwidth/mechanism/families.h"
#include "zwidth/mechanism/jacobian.h"
#include "zwidth/mechanism/mechanism.h"
#include "zwidth/mechanism/posture.h"

/// The five-bar: one posture at a time and many at once, beside MuJoCo and the textbook; and the design search.

namespace {

using zwidth::Matrix2;
using zwidth::Vector2;

constexpr int kPoses = 1024;
constexpr double kDegree = std::numbers::pi / 180.0;
constexpr zwidth::FiveBarGeometry kLengths{.crank = 0.10, .coupler = 0.15, .half_base = 0.03};
const std::array<zwidth::Interval, 2> kRanges = {zwidth::Interval{85.0 * kDegree, 210.0 * kDegree},
                                                 zwidth::Interval{-30.0 * kDegree, 95.0 * kDegree}};

/// The five-bar as the paper writes it down, with Eigen.
struct Textbook {
  double r1, r2, r3;

  Matrix2 jacobian(const Vector2& theta, const Vector2& p) const {
    Matrix2 Jp, Jt = Matrix2::Zero();
    Jp << p.x() - r1 * std::cos(theta[0]) + r3, p.y() - r1 * std::sin(theta[0]),
        p.x() - r1 * std::cos(theta[1]) - r3, p.y() - r1 * std::sin(theta[1]);
    Jt(0, 0) = r1 * (p.y() * std::cos(theta[0]) - (p.x() + r3) * std::sin(theta[0]));
    Jt(1, 1) = r1 * (p.y() * std::cos(theta[1]) + (r3 - p.x()) * std::sin(theta[1]));
    return Jp.inverse() * Jt;
  }

  Vector2 forward(const Vector2& theta) const {
    const double c1 = std::cos(theta[0]), s1 = std::sin(theta[0]), c2 = std::cos(theta[1]),
                 s2 = std::sin(theta[1]);
    const double q = 2 * r3 - r1 * c1 + r1 * c2, d = r1 * (s1 - s2) / q, e = r1 * r3 * (c1 + c2) / q;
    const double f = 1 + d * d, g = 2 * (d * e - d * r1 * c1 + d * r3 - r1 * s1);
    const double h = std::pow(e, 2) - 2 * e * (r1 * c1 - r3) - 2 * r1 * r3 * c1 + r3 * r3 + r1 * r1 - r2 * r2;
    const double y = (-g + std::sqrt(g * g - 4 * f * h)) / (2 * f);
    return {d * y + e, y};
  }

  bool inverse(const Vector2& p, Vector2& theta) const {
    for (int i = 0; i < 2; ++i) {
      const double x = i == 0 ? p.x() + r3 : p.x() - r3, D = std::hypot(x, p.y());
      const double cosine = (r1 * r1 + D * D - r2 * r2) / (2 * r1 * D);
      if (std::abs(cosine) > 1.0) return false;
      theta[i] = std::atan2(p.y(), x) + (i == 0 ? 1 : -1) * std::acos(cosine);
    }
    return true;
  }

  double condition_number(const Vector2& p) const {
    Vector2 theta;
    if (!inverse(p, theta)) return -1.0;
    const Vector2 sigma = Eigen::JacobiSVD<Matrix2>(jacobian(theta, p)).singularValues();
    return sigma[0] / sigma[1];
  }
};

// The same mechanism for MuJoCo: two legs of two hinges, held together by a connection.
std::string mujoco_model(const zwidth::FiveBarGeometry& lengths) {
  const auto number = [](double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.17g ", value);
    return std::string(text);
  };
  const std::string inertia = "<inertial pos='0.05 0 0' mass='0.04' diaginertia='1e-5 1e-5 1e-5'/>";
  std::string xml = "<mujoco><compiler angle='radian'/><worldbody>";
  for (int i = 0; i < 2; ++i) {
    xml += "<body pos='" + number(i == 0 ? -lengths.half_base : lengths.half_base) +
           "0 0'><joint type='hinge' axis='0 0 1'/>" + inertia + "<body name='coupler" + std::to_string(i) +
           "' pos='" + number(lengths.crank) + "0 0'><joint type='hinge' axis='0 0 1'/>" + inertia +
           "</body></body>";
  }
  return xml + "</worldbody><equality><connect body1='coupler0' body2='coupler1' anchor='" +
         number(lengths.coupler) + "0 0'/></equality></mujoco>";
}

struct MujocoFiveBar {
  explicit MujocoFiveBar(const zwidth::FiveBarGeometry& lengths) {
    const std::string xml = mujoco_model(lengths);
    auto files = std::make_unique<mjVFS>();
    mj_defaultVFS(files.get());
    mj_makeEmptyFileVFS(files.get(), "five_bar.xml", static_cast<int>(xml.size()));
    std::copy(xml.begin(), xml.end(), static_cast<char*>(files->filedata[0]));
    char error[500] = "";
    model = mj_loadXML("five_bar.xml", files.get(), error, sizeof error);
    mj_deleteVFS(files.get());
    if (model == nullptr) {
      std::fprintf(stderr, "MuJoCo: %s\n", error);
      std::exit(3);
    }
    data = mj_makeData(model);
  }
  ~MujocoFiveBar() {
    mj_deleteData(data);
    mj_deleteModel(model);
  }
  MujocoFiveBar(const MujocoFiveBar&) = delete;
  MujocoFiveBar& operator=(const MujocoFiveBar&) = delete;

  mjModel* model = nullptr;
  mjData* data = nullptr;
};

}  // namespace

int main(int argc, char** argv) {
  const bench::Options options = bench::options_of(argc, argv);
  const Textbook textbook{kLengths.crank, kLengths.coupler, kLengths.half_base};

  // Random postures, and a smooth walk for warm starts.
  std::mt19937_64 random(1);
  std::vector<Vector2> theta(kPoses), position(kPoses), walk(kPoses);
  for (int p = 0; p < kPoses; ++p) {
    for (int i = 0; i < 2; ++i) {
      theta[p][i] = std::uniform_real_distribution<double>(kRanges[i].min, kRanges[i].max)(random);
    }
    position[p] = zwidth::five_bar_forward(kLengths, theta[p]).position;
    const double t = 2.0 * std::numbers::pi * p / kPoses;
    walk[p] = Vector2(2.5 + 0.4 * std::sin(t), 0.6 + 0.4 * std::sin(2.0 * t + 1.0));
  }
  double worst = 0.0;
  for (int p = 0; p < kPoses; ++p) {
    Vector2 angles;
    const bool inside = textbook.inverse(position[p], angles);
    worst = std::max(
        {worst, (textbook.forward(theta[p]) - position[p]).norm(), inside ? (angles - theta[p]).norm() : 1.0});
  }
  std::printf("library and textbook agree to %.1e\n\n", worst);

  zwidth::Description description;
  description.mechanism = zwidth::FiveBarDescription{.crank = kLengths.crank,
                                                     .coupler = kLengths.coupler,
                                                     .half_base = kLengths.half_base,
                                                     .left_range = kRanges[0],
                                                     .right_range = kRanges[1]};
  const zwidth::Mechanism mechanism(description), legs(zwidth::spelled_out(description));
  MujocoFiveBar mujoco(kLengths);

  bench::Suite forward("Forward kinematics with Jacobian, random postures of the selected design", options);
  forward.add("textbook: elimination, Eigen inverse", kPoses, [&](long n) {
    for (long it = 0; it < n; ++it) {
      for (const Vector2& q : theta) {
        const Vector2 p = textbook.forward(q);
        bench::keep(p);
        bench::keep(textbook.jacobian(q, p));
      }
    }
  });
  forward.add("zwidth five_bar_forward", kPoses, [&](long n) {
    for (long it = 0; it < n; ++it) {
      for (const Vector2& q : theta) bench::keep(zwidth::five_bar_forward(kLengths, q));
    }
  });
  forward.goal(100e-9);
  forward.add("MuJoCo " + std::string(mj_versionString()) + " mj_kinematics + mj_comPos, loop given", kPoses,
              [&](long n) {
                for (long it = 0; it < n; ++it) {
                  for (int p = 0; p < kPoses; ++p) {
                    for (int i = 0; i < 2; ++i) {
                      mujoco.data->qpos[2 * i] = theta[p][i];
                      mujoco.data->qpos[2 * i + 1] = -theta[p][i];
                    }
                    mj_kinematics(mujoco.model, mujoco.data);
                    mj_comPos(mujoco.model, mujoco.data);
                  }
                }
              });
  forward.run();

  bench::Suite inverse("Inverse kinematics with Jacobian, random points of the workspace", options);
  inverse.add("textbook: acos and atan2, Eigen inverse", kPoses, [&](long n) {
    for (long it = 0; it < n; ++it) {
      for (const Vector2& p : position) {
        Vector2 q;
        if (textbook.inverse(p, q)) bench::keep(textbook.jacobian(q, p));
      }
    }
  });
  inverse.add("zwidth five_bar_inverse", kPoses, [&](long n) {
    for (long it = 0; it < n; ++it) {
      for (const Vector2& p : position) bench::keep(zwidth::five_bar_inverse(kLengths, p, {}, kRanges));
    }
  });
  inverse.goal(100e-9);
  const zwidth::FiveBarBatch batch(kLengths, {}, kRanges);
  std::vector<double> x(kPoses), y(kPoses), cosine(2 * kPoses), sine(2 * kPoses), J(4 * kPoses), K(kPoses);
  for (int p = 0; p < kPoses; ++p) {
    x[p] = position[p].x();
    y[p] = position[p].y();
  }
  inverse.add("zwidth FiveBarBatch::inverse, angles as cosines", kPoses, [&](long n) {
    for (long it = 0; it < n; ++it) {
      batch.inverse(x, y, cosine, sine, J);
      bench::keep(J[0]);
    }
  });
  inverse.run();

  bench::Suite conditions("Condition number, random points of the workspace", options);
  conditions.add("textbook: inverse, Eigen singular values", kPoses, [&](long n) {
    for (long it = 0; it < n; ++it) {
      for (const Vector2& p : position) bench::keep(textbook.condition_number(p));
    }
  });
  conditions.add("zwidth five_bar_inverse, FiveBarState::condition_number", kPoses, [&](long n) {
    for (long it = 0; it < n; ++it) {
      for (const Vector2& p : position) {
        const zwidth::FiveBarInverse pose = zwidth::five_bar_inverse(kLengths, p);
        bench::keep(zwidth::FiveBarState(kLengths, pose.theta, p).condition_number());
      }
    }
  });
  conditions.add("zwidth FiveBarBatch::condition_numbers", kPoses, [&](long n) {
    for (long it = 0; it < n; ++it) {
      batch.condition_numbers(x, y, K);
      bench::keep(K[0]);
    }
  });
  conditions.add("zwidth FiveBarBatch::count_above", kPoses, [&](long n) {
    for (long it = 0; it < n; ++it) bench::keep(batch.count_above(x, y, 5.0));
  });
  conditions.run();

  const zwidth::FiveBarSearch table_1{.crank = {9.0, 12.0, 1.0},
                                      .coupler = {11.0, 15.0, 1.0},
                                      .base = {3.0, 5.0, 1.0},
                                      .sampling = {.radius_step = 1.0, .angle_step = 2.0 * kDegree}};
  const auto points = static_cast<double>(zwidth::search_five_bars(table_1, {.threads = 1}).points);
  bench::Suite search("Design search of table 1: 60 designs, one thread, per design and point", options);
  search.add("zwidth search_five_bars", points, [&](long n) {
    for (long it = 0; it < n; ++it) bench::keep(zwidth::search_five_bars(table_1, {.threads = 1}).selected);
  });
  search.goal(10e-9);
  search.run();

  bench::Suite solver("General solver of legs, warm-started along a smooth walk", options);
  solver.add("zwidth solve_forward and jacobian, general, from the last posture", kPoses, [&](long n) {
    for (long it = 0; it < n; ++it) {
      zwidth::Solution last = zwidth::solve_forward(legs, zwidth::ActiveVector(walk[0]));
      for (const Vector2& q : walk) {
        zwidth::Solution next = zwidth::solve_forward(legs, zwidth::ActiveVector(q), {.start = &*last.posture});
        bench::keep(zwidth::jacobian(*next.posture));
        last = std::move(next);
      }
    }
  });
  solver.add("zwidth solve_forward and jacobian, closed form", kPoses, [&](long n) {
    for (long it = 0; it < n; ++it) {
      for (const Vector2& q : walk) {
        const zwidth::Solution solution = zwidth::solve_forward(mechanism, zwidth::ActiveVector(q));
        bench::keep(zwidth::jacobian(*solution.posture));
      }
    }
  });
  solver.run();
  return 0;
}
