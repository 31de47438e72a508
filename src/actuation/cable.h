#pragma once

#include <optional>

/// A wire rope as a spring.

namespace zwidth {

/// Cross-section of a rope of equal wires, laid in hexagonal layers both in a strand and in the rope
/// (1, 7, 19, 37, ... of each): 7x19, 7x7, 1x19.
struct RopeSection {
  double strand_diameter = 0.0;  ///< [m]
  double wire_diameter = 0.0;    ///< [m]
  double wire_area = 0.0;        ///< of one wire [m^2]
  double metal_area = 0.0;       ///< of all wires [m^2]
};

/// From the bare diameter [m] (Neal 2015, table 4.9). Empty when it is not positive, or a count is not that of
/// full hexagonal layers.
std::optional<RopeSection> rope_section(double bare_diameter, int strands, int wires_per_strand);

/// S E A / l [N/m]: factor [-], modulus [Pa], area [m^2], length [m] (Neal 2015, eq 5.5).
/// Empty unless all are positive and finite.
std::optional<double> cable_stiffness(double elastic_modulus, double metal_area, double length,
                                      double factor = 1.0);

}  // namespace zwidth
