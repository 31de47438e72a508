#include "zwidth/actuation/cable.h"

#include <cmath>
#include <numbers>

namespace zwidth {
namespace {

/// Diameters of the parts that lie across a bundle of `count`: 3 for 1 + 6, 5 for 1 + 6 + 12, ...; 0 if the
/// layers are not full.
int across(int count) {
  int layers = 0;
  int held = 1;
  while (held < count) {
    ++layers;
    held += 6 * layers;
  }
  return held == count ? 2 * layers + 1 : 0;
}

}  // namespace

std::optional<RopeSection> rope_section(double bare_diameter, int strands, int wires_per_strand) {
  const int strands_across = strands > 0 ? across(strands) : 0;
  const int wires_across = wires_per_strand > 0 ? across(wires_per_strand) : 0;
  if (!(bare_diameter > 0.0) || !std::isfinite(bare_diameter) || strands_across == 0 || wires_across == 0) {
    return std::nullopt;
  }
  RopeSection section;
  section.strand_diameter = bare_diameter / strands_across;
  section.wire_diameter = section.strand_diameter / wires_across;
  section.wire_area = std::numbers::pi / 4.0 * section.wire_diameter * section.wire_diameter;
  section.metal_area = strands * static_cast<double>(wires_per_strand) * section.wire_area;
  return section;
}

std::optional<double> cable_stiffness(double elastic_modulus, double metal_area, double length, double factor) {
  const double stiffness = factor * elastic_modulus * metal_area / length;
  if (!(elastic_modulus > 0.0) || !(metal_area > 0.0) || !(length > 0.0) || !(factor > 0.0) ||
      !std::isfinite(stiffness)) {
    return std::nullopt;
  }
  return stiffness;
}

}  // namespace zwidth
