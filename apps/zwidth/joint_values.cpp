#include "joint_values.h"

#include <algorithm>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <vector>

#include "context.h"
#include "efforts.h"

#include "zwidth/description/units.h"

namespace zwidth {

std::string joint_values_wanted(const Mechanism& mechanism) {
  std::vector<std::string> driven, free;
  for (int i = 0; i < mechanism.active_count(); ++i)
    (mechanism.is_free(i) ? free : driven).push_back(mechanism.active_names()[static_cast<size_t>(i)]);
  const auto values = [](size_t count) { return fmt::format("{} value{}", count, count == 1 ? "" : "s"); };
  if (free.empty()) {
    return fmt::format("{}, one for each active joint ({})", values(driven.size()), fmt::join(driven, ", "));
  }
  return fmt::format("{}, one for each driven joint ({}), or {} with the joint{} that the hand moves ({})",
                     values(driven.size()), fmt::join(driven, ", "), mechanism.active_count(),
                     free.size() == 1 ? "" : "s", fmt::join(free, ", "));
}

ActiveVector joint_values(const char* option, const std::string& text, const Mechanism& mechanism, int order) {
  constexpr Dimension kTurns[] = {Dimension::angle, Dimension::angular_speed, Dimension::angular_acceleration,
                                  Dimension::torque};
  constexpr Dimension kSlides[] = {Dimension::length, Dimension::speed, Dimension::acceleration,
                                   Dimension::force};
  const auto entries = static_cast<int>(std::count(text.begin(), text.end(), ',')) + 1;
  const bool all = entries == mechanism.active_count();
  if (!all && entries != mechanism.driven_count()) {
    throw InputError(fmt::format("{} \"{}\": has {} {}; give {}", option, text, entries,
                                 entries == 1 ? "entry" : "entries", joint_values_wanted(mechanism)));
  }
  std::vector<Dimension> dimensions;
  for (int i = 0; i < mechanism.active_count(); ++i) {
    if (all || !mechanism.is_free(i))
      dimensions.push_back((joint_slides(mechanism, i) ? kSlides : kTurns)[order]);
  }
  const ParsedQuantities parsed = parse_quantity_list(text, dimensions);
  if (!parsed) {
    throw InputError(fmt::format("{} \"{}\": {}{}", option, text, parsed.rule,
                                 parsed.advice.empty() ? "" : "; " + parsed.advice));
  }
  const ActiveVector values =
      Eigen::Map<const Eigen::VectorXd>(parsed.values.data(), static_cast<Eigen::Index>(parsed.values.size()));
  if (all) return values;
  ActiveVector joints = mechanism.with_free_at_home(values);
  for (int i = 0; i < mechanism.active_count() && order > 0; ++i) {
    if (mechanism.is_free(i)) joints[i] = 0.0;
  }
  return joints;
}

}  // namespace zwidth
