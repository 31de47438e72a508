// Seven joints for a pose of six freedoms: what may the seventh do? The tool goes round a circle, turned the
// same way all the time, once by the nearest posture each time, once with a joint kept, once as dexterous as
// can be.
//
//   04_spare_joint

#include <cmath>
#include <cstdio>
#include <exception>
#include <numbers>
#include <optional>

#include "zwidth/description/read.h"
#include "zwidth/mechanism/posture.h"

int main() {
  using namespace zwidth;
  try {
    const Mechanism arm(read_description("seven-dof", {}, Catalogue::load()));
    const Redundancy rules[] = {{.rule = Redundancy::Rule::nearest},
                                {.rule = Redundancy::Rule::keep, .joint = 2, .value = 0.2},
                                {.rule = Redundancy::Rule::maximise}};
    const char* const names[] = {"nearest to the last posture", "theta3 kept at 0.2 rad",
                                 "largest manipulability"};
    for (int r = 0; r < 3; ++r) {
      std::printf("%s\n   angle   theta1   theta2   theta3   theta4 [deg]\n", names[r]);
      std::optional<Posture> last;
      for (int step = 0; step <= 6; ++step) {
        const double angle = step * std::numbers::pi / 3.0;
        const Pose goal{.position = {0.32, 0.06 * std::cos(angle), -0.02 + 0.06 * std::sin(angle)},
                        .rotation = Eigen::AngleAxisd(0.5 * std::numbers::pi, Vector3::UnitY()).matrix()};
        SolveOptions options{.start = last ? &*last : nullptr};
        options.redundancy = rules[r];
        const Solution solution = solve_inverse(arm, goal, options);
        std::printf("%8.0f", angle * 180.0 / std::numbers::pi);
        if (solution.status != SolveStatus::reached) {
          std::printf("  %s\n", to_string(solution.status));
          continue;
        }
        const ActiveVector q = solution.posture->active();
        for (int j = 0; j < 4; ++j) std::printf("%9.2f", q[j] * 180.0 / std::numbers::pi);
        std::printf("\n");
        last = solution.posture;
      }
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
}
