#include "zwidth/actuation/internal/margin.h"

#include <cmath>

namespace zwidth::internal {

void add_margin(std::vector<Margin>& margins, const char* name, double demand, double capability,
                const char* unit, const char* rule) {
  if (!std::isfinite(demand) || !std::isfinite(capability)) return;
  constexpr double kRounding = 1e-9;
  const std::optional<double> utilisation =
      capability > 0.0 ? std::optional(demand / capability) : std::nullopt;
  margins.push_back(
      {name, demand, capability, unit, utilisation, demand <= capability * (1.0 + kRounding), rule});
}

}  // namespace zwidth::internal
