#include "zwidth/mechanism/solve_status.h"

namespace zwidth {

const char* to_string(SolveStatus status) noexcept {
  switch (status) {
    case SolveStatus::reached:
      return "reached";
    case SolveStatus::degraded:
      return "degraded";
    case SolveStatus::joint_limit:
      return "joint_limit";
    case SolveStatus::degenerate:
      return "degenerate";
    case SolveStatus::unreachable:
      return "unreachable";
  }
  return "unknown";
}

}  // namespace zwidth
