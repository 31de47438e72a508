#pragma once

#include <optional>

/// Cross-sections of straight links, and the mass of a link of one section.

namespace zwidth {

/// What a beam needs to know of its section; y and z are principal axes through the centroid.
struct Section {
  double area = 0.0;              ///< A [m^2]
  double second_moment_y = 0.0;   ///< I_y, against bending about y [m^4]
  double second_moment_z = 0.0;   ///< I_z, against bending about z [m^4]
  double torsion_constant = 0.0;  ///< J, against twist about the link's axis [m^4]
};

/// Tube, or round bar if the inner diameter is 0 (Görgülü 2018, eq 5.162-5.165).
/// Nothing unless 0 <= inner < outer, both finite [m].
std::optional<Section> tube_section(double outer_diameter, double inner_diameter) noexcept;

/// Solid rectangular bar, `width` along y and `height` along z [m]; torsion constant by Saint-Venant's series
/// (Timoshenko & Goodier 1970, section 109). Nothing unless both are positive and finite.
std::optional<Section> bar_section(double width, double height) noexcept;

/// Inertia of a uniform straight link, about its centre.
struct LinkMass {
  double mass = 0.0;        ///< rho A L [kg]
  double about_axis = 0.0;  ///< rho L (I_y + I_z) [kg m^2]
  double about_y = 0.0;     ///< m L^2/12 + rho L I_y [kg m^2]
  double about_z = 0.0;     ///< m L^2/12 + rho L I_z [kg m^2]
};

/// REQUIRES: length [m] and density [kg/m^3] finite and not negative.
LinkMass link_mass(const Section& section, double length, double density) noexcept;

/// Diameters of a tube.
struct TubeDiameters {
  double outer = 0.0;  ///< D [m]
  double inner = 0.0;  ///< d [m]
};

/// The tube whose wall of `plies` layers of `ply_thickness` [m] makes d/D = `ratio`: D = 2 t/(1 - ratio)
/// (Görgülü 2018, eq 6.94-6.96). Nothing unless plies >= 1, thickness > 0 and 0 <= ratio < 1.
std::optional<TubeDiameters> laminated_tube(int plies, double ply_thickness, double ratio) noexcept;

}  // namespace zwidth
