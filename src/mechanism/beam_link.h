#pragma once

#include <optional>
#include <string>
#include <vector>

#include "zwidth/description/description.h"
#include "zwidth/description/problem.h"
#include "zwidth/math/beam.h"
#include "zwidth/math/laminate.h"

/// Links that are beams: what their description comes to.

namespace zwidth {

/// What a link's wall is made of, in the axes of the link.
struct WallProperties {
  WallModuli moduli;     ///< [Pa]
  double density = 0.0;  ///< [kg/m^3]
};
/// REQUIRES: `validate` finds nothing wrong with it.
WallProperties wall_properties(const WallDescription& wall);
/// The same by another rule for laminates than the description's own.
WallProperties wall_properties(const WallDescription& wall, LaminateRule rule);

/// A laminate by both rules.
struct LaminateComparison {
  std::string on;                                ///< the link, as its body names it
  LaminateRule rule = LaminateRule::lamination;  ///< that the description takes
  int plies = 0;
  WallModuli lamination, mean;  ///< [Pa]
};
/// Of every link that is laminated, in the order of the bodies. REQUIRES: `validate` finds nothing.
std::vector<LaminateComparison> laminate_comparisons(const Description& description);

/// One beam, by the two ends of its link.
struct BeamLink {
  double length = 0.0;  ///< [m]
  /// Columns: along the link, the section's y (along a bar's width) and z, in the frame that the ends are in.
  Matrix3 frame = Matrix3::Identity();
  BeamRigidity rigidity;
  double mass = 0.0;                  ///< [kg]
  Vector3 centre = Vector3::Zero();   ///< of mass, in that frame [m]
  Matrix3 inertia = Matrix3::Zero();  ///< about the centre, in that frame [kg m^2]
};

/// `axis` is that of the link's joint. Nothing if the link has no length, or a bar's width lies along it.
/// REQUIRES: `validate` finds nothing wrong with the beam.
std::optional<BeamLink> beam_link(const BeamDescription& beam, const Vector3& from, const Vector3& to,
                                  const Vector3& axis);

/// What `validate` cannot see of the beams of a description: links without length, a bar's width along its
/// link, two beams on one link, bars of a parallelogram. A DescriptionCheck. REQUIRES: `validate` finds
/// nothing.
std::vector<Problem> beam_problems(const Description& description);

}  // namespace zwidth
