#pragma once

#include <cmath>
#include <stdexcept>
#include <string>

namespace zwidth {

/// A quantity that divides: returns it, or throws std::invalid_argument naming it and its value unless it is
/// positive and finite.
inline double require_positive(const char* name, double value) {
  if (!(value > 0.0) || !std::isfinite(value)) {
    throw std::invalid_argument(std::string("the ") + name + " must be positive and finite, not " +
                                std::to_string(value));
  }
  return value;
}

}  // namespace zwidth
