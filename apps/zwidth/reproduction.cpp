#include "reproduction.h"

#include <cmath>

namespace zwidth {

bool ReproducedFigure::ok() const {
  return std::abs(difference()) <= tolerance;
}

bool SearchFinding::ok() const {
  return std::isfinite(value) && value >= at_least.value_or(-HUGE_VAL) && value <= at_most.value_or(HUGE_VAL);
}

ReproducedFigure& Figures::add(const std::string& id, const std::string& what, const PrintedUnit& unit,
                               int decimals, double printed, double computed_si) {
  ReproducedFigure figure;
  figure.id = device_ + "." + id;
  figure.source = heading_;
  figure.what = what;
  figure.unit = unit;
  figure.decimals = decimals;
  figure.printed = printed * unit.factor;
  figure.computed = computed_si;
  // Half a unit of the last printed digit, and what rounding adds to it.
  figure.tolerance = 0.501 * std::pow(10.0, -decimals) * unit.factor;
  figures_.push_back(figure);
  return figures_.back();
}

void read_otherwise(ReproducedFigure& figure, std::string reading, std::string label, double value,
                    std::string how) {
  figure.reading = std::move(reading);
  figure.other = {std::move(label), value, std::move(how)};
}

}  // namespace zwidth
