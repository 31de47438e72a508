#include "zwidth/actuation/flexure.h"

#include <cmath>

namespace zwidth {

std::optional<Flexure> Flexure::make(double flexible_length, double rigid_length, double width, double height,
                                     double elastic_modulus) {
  for (double dimension : {flexible_length, rigid_length, width, height, elastic_modulus}) {
    if (!(dimension > 0.0) || !std::isfinite(dimension)) {
      return std::nullopt;
    }
  }
  Flexure flexure;
  flexure.flexible_length_ = flexible_length;
  flexure.rigid_length_ = rigid_length;
  flexure.width_ = width;
  flexure.height_ = height;
  flexure.elastic_modulus_ = elastic_modulus;
  return flexure;
}

std::optional<Flexure> Flexure::make(const FlexureDescription& description) {
  return make(description.flexible_length, description.rigid_length, description.width, description.height,
              description.material.elastic_modulus);
}

double Flexure::area_moment() const {
  return width_ * height_ * height_ * height_ / 12.0;
}

double Flexure::section_modulus() const {
  return width_ * height_ * height_ / 6.0;
}

double Flexure::stiffness() const {
  const double l1 = flexible_length_;
  const double l2 = rigid_length_;
  const double EI = elastic_modulus_ * area_moment();
  return 6.0 * EI / (l1 * (l1 * (2.0 * l1 + 3.0 * l2) + 3.0 * l2 * (l1 + 2.0 * l2)));
}

std::optional<double> Flexure::deflection(double force, double x) const {
  if (!(x >= 0.0 && x <= length())) {
    return std::nullopt;
  }
  const double l1 = flexible_length_;
  const double l2 = rigid_length_;
  const double F_per_6EI = force / (6.0 * elastic_modulus_ * area_moment());
  if (x <= l1) {
    return -F_per_6EI * x * x * (3.0 * (l1 + l2) - x);
  }
  return -F_per_6EI * l1 * (l1 * (2.0 * l1 + 3.0 * l2) + 3.0 * (l1 + 2.0 * l2) * (x - l1));
}

std::optional<double> Flexure::slope(double force, double x) const {
  if (!(x >= 0.0 && x <= length())) {
    return std::nullopt;
  }
  const double l1 = flexible_length_;
  const double l2 = rigid_length_;
  const double F_per_2EI = force / (2.0 * elastic_modulus_ * area_moment());
  return x <= l1 ? -F_per_2EI * x * (2.0 * (l1 + l2) - x) : -F_per_2EI * l1 * (l1 + 2.0 * l2);
}

std::optional<double> Flexure::moment(double force, double x) const {
  if (!(x >= 0.0 && x <= length())) {
    return std::nullopt;
  }
  return -force * (length() - x);
}

double Flexure::bending_stress(double force) const {
  return std::abs(force) * length() / section_modulus();
}

std::optional<double> Flexure::safety_factor(double force, double yield_strength) const {
  const double stress = bending_stress(force);
  return yield_strength > 0.0 && stress > 0.0 ? std::optional(yield_strength / stress) : std::nullopt;
}

}  // namespace zwidth
