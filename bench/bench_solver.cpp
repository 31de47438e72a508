#include <numbers>
#include <string>
#include <vector>

#include "harness.h"

#include "zwidth/mechanism/families.h"
#include "zwidth/mechanism/jacobian.h"
#include "zwidth/mechanism/mechanism.h"
#include "zwidth/mechanism/posture.h"

/// The general solver of legs, following a smooth walk from posture to posture as a control loop does.

namespace {

using zwidth::ActiveVector;
using zwidth::Mechanism;
using zwidth::Solution;
using zwidth::Vector3;

constexpr int kPoses = 1024;
constexpr double kDegree = std::numbers::pi / 180.0;

zwidth::MechanismDescription published_delta() {
  return zwidth::DeltaDescription{.base_radius = 0.08,
                                  .upper_arm = 0.08,
                                  .forearm = 0.16,
                                  .platform_radius = 0.055,
                                  .joint_range = {-36.0 * kDegree, 84.0 * kDegree}};
}

// Three legs of five revolutes: a driven link, a universal joint, two links on parallel axes.
zwidth::MechanismDescription r_cube() {
  return zwidth::RCubeDescription{.drive_link = 0.08,
                                  .inner_link = 0.11,
                                  .outer_link = 0.12,
                                  .base_offset = 0.08,
                                  .joint_range = {-50.0 * kDegree, 50.0 * kDegree}};
}

// Up to 0.4 degrees a step around `middle`.
std::vector<Vector3> smooth_walk(double middle) {
  std::vector<Vector3> walk(kPoses);
  for (int p = 0; p < kPoses; ++p) {
    const double t = 2.0 * std::numbers::pi * p / kPoses;
    walk[p] =
        Vector3::Constant(middle) + 0.3 * Vector3(std::sin(t), std::sin(2.0 * t + 1.0), std::sin(3.0 * t));
  }
  return walk;
}

void measure(const std::string& title, const zwidth::MechanismDescription& family, double middle, double goal,
             const bench::Options& options) {
  zwidth::Description description;
  description.mechanism = family;
  const Mechanism own(description), legs(zwidth::spelled_out(description));
  const std::vector<Vector3> walk = smooth_walk(middle);

  const Solution start = solve_forward(legs, ActiveVector(walk[0]));
  std::vector<zwidth::Pose> path;
  double iterations = 0.0, worst = 0.0;
  Solution last = start;
  for (const Vector3& q : walk) {
    last = solve_forward(legs, ActiveVector(q), {.start = &*last.posture});
    iterations += last.iterations;
    path.push_back(last.posture->tool());
    const Solution other = solve_forward(own, ActiveVector(q));
    worst = std::max(worst, (other.posture->tool().position - path.back().position).norm());
  }
  std::printf("%s: %.2f Newton steps a posture; differs from the family's own solution by at most %.1e m\n\n",
              title.c_str(), iterations / kPoses, worst);

  bench::Suite suite(title + " as legs, warm-started along a smooth walk", options);
  suite.add("solve_forward and jacobian", kPoses, [&](long n) {
    for (long it = 0; it < n; ++it) {
      Solution at = start;
      for (const Vector3& q : walk) {
        Solution next = solve_forward(legs, ActiveVector(q), {.start = &*at.posture});
        bench::keep(zwidth::jacobian(*next.posture));
        at = std::move(next);
      }
    }
  });
  suite.goal(goal);
  suite.add("solve_inverse and jacobian", kPoses, [&](long n) {
    for (long it = 0; it < n; ++it) {
      Solution at = start;
      for (const zwidth::Pose& tool : path) {
        Solution next = solve_inverse(legs, tool, {.start = &*at.posture});
        bench::keep(zwidth::jacobian(*next.posture));
        at = std::move(next);
      }
    }
  });
  suite.add("rates of one posture", kPoses, [&](long n) {
    for (long it = 0; it < n * kPoses; ++it) bench::keep(zwidth::rates(*start.posture));
  });
  if (own.closed_form() != nullptr) {
    suite.add("solve_forward and jacobian, closed form", kPoses, [&](long n) {
      for (long it = 0; it < n; ++it) {
        for (const Vector3& q : walk) {
          const Solution solution = solve_forward(own, ActiveVector(q));
          bench::keep(zwidth::jacobian(*solution.posture));
        }
      }
    });
  }
  suite.run();
}

}  // namespace

int main(int argc, char** argv) {
  const bench::Options options = bench::options_of(argc, argv);
  measure("Delta", published_delta(), 0.4, 3e-6, options);
  measure("R-CUBE", r_cube(), 0.0, 8e-6, options);
  return 0;
}
