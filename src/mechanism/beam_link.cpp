#include "zwidth/mechanism/beam_link.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <set>
#include <string>

#include "zwidth/mechanism/families.h"

namespace zwidth {
namespace {

constexpr double kShortest = 1e-9;  // of a link [m]
constexpr double kAlong = 1e-6;     // sine of the angle to a link below which a direction lies along it

Section section_of(const TubeDescription& tube) {
  return *tube_section(tube.outer_diameter, tube.inner_diameter);
}
Section section_of(const BarDescription& bar) {
  return *bar_section(bar.width, bar.height);
}

// Direction of the section's y; zero if any will do.
Vector3 width_of(const TubeDescription&, const Vector3&) {
  return Vector3::Zero();
}
Vector3 width_of(const BarDescription& bar, const Vector3& axis) {
  return bar.width_along.isZero(0.0) ? axis : bar.width_along;
}

}  // namespace

WallProperties wall_properties(const WallDescription& wall) {
  const auto* laminate = std::get_if<LaminateDescription>(&wall);
  return wall_properties(wall, laminate != nullptr ? laminate->rule : LaminateRule::lamination);
}

WallProperties wall_properties(const WallDescription& wall, LaminateRule rule) {
  if (const auto* material = std::get_if<Material>(&wall)) {
    const double E = material->elastic_modulus;
    return {.moduli = {.axial = E, .transverse = E, .shear = 0.5 * E / (1.0 + material->poisson_ratio)},
            .density = material->density};
  }
  const LaminateDescription& laminate = std::get<LaminateDescription>(wall);
  const Lamina& lamina = laminate.lamina;
  const PlyModuli ply{.longitudinal = lamina.longitudinal_modulus,
                      .transverse = lamina.transverse_modulus,
                      .shear = lamina.shear_modulus,
                      .poisson = lamina.poisson_ratio};
  std::vector<PlyGroup> plies;
  for (const PlyDescription& one : laminate.plies) {
    plies.push_back({.angle = one.angle, .count = static_cast<double>(one.count)});
  }
  const std::optional<WallModuli> moduli =
      rule == LaminateRule::mean ? mean_moduli(ply, plies) : laminate_moduli(ply, plies);
  assert(moduli);
  return {.moduli = *moduli, .density = lamina.density};
}

std::vector<LaminateComparison> laminate_comparisons(const Description& description) {
  std::vector<LaminateComparison> comparisons;
  for (const BodyDescription& body : description.bodies) {
    if (!body.beam) continue;
    const WallDescription& wall =
        std::visit([](const auto& beam) -> const WallDescription& { return beam.wall; }, *body.beam);
    const auto* laminate = std::get_if<LaminateDescription>(&wall);
    if (laminate == nullptr) continue;
    LaminateComparison one{.on = body.on,
                           .rule = laminate->rule,
                           .lamination = wall_properties(wall, LaminateRule::lamination).moduli,
                           .mean = wall_properties(wall, LaminateRule::mean).moduli};
    for (const PlyDescription& ply : laminate->plies) one.plies += ply.count;
    comparisons.push_back(std::move(one));
  }
  return comparisons;
}

std::optional<BeamLink> beam_link(const BeamDescription& beam, const Vector3& from, const Vector3& to,
                                  const Vector3& axis) {
  return std::visit(
      [&](const auto& one) -> std::optional<BeamLink> {
        BeamLink link;
        link.length = (to - from).norm();
        if (link.length < kShortest) return std::nullopt;
        const Vector3 along = (to - from) / link.length;
        Vector3 width = width_of(one, axis);
        if (width.isZero(0.0)) width = along.unitOrthogonal();
        const Vector3 across = width - along * along.dot(width);
        if (across.norm() < kAlong * width.norm()) return std::nullopt;
        link.frame.col(0) = along;
        link.frame.col(1) = across.normalized();
        link.frame.col(2) = along.cross(link.frame.col(1));

        const Section section = section_of(one);
        const WallProperties wall = wall_properties(one.wall);
        link.rigidity = beam_rigidity(section, wall.moduli.axial, wall.moduli.shear);
        const LinkMass mass = link_mass(section, link.length, wall.density);
        link.mass = mass.mass;
        link.centre = 0.5 * (from + to);
        link.inertia = link.frame * Vector3(mass.about_axis, mass.about_y, mass.about_z).asDiagonal() *
                       link.frame.transpose();
        return link;
      },
      beam);
}

std::vector<Problem> beam_problems(const Description& description) {
  std::vector<Problem> problems;
  const auto is_beam = [](const BodyDescription& body) { return body.beam.has_value(); };
  if (std::none_of(description.bodies.begin(), description.bodies.end(), is_beam)) return problems;
  std::set<std::string> taken;  // links that are beams already
  Description one = description;
  for (std::size_t i = 0; i < description.bodies.size(); ++i) {
    const BodyDescription& body = description.bodies[i];
    if (!body.beam) continue;
    const bool tube = std::holds_alternative<TubeDescription>(*body.beam);
    const std::string path = "body[" + std::to_string(i) + "]";
    const auto report = [&](const char* key, std::string value, std::string rule, std::string advice) {
      problems.push_back(
          {.key = path + key, .value = std::move(value), .rule = std::move(rule), .advice = std::move(advice)});
    };
    // The links that it stands for, one for each leg where a family gives them a common name.
    one.bodies = {body};
    const Description general = spelled_out(one);
    for (const BodyDescription& each : general.bodies) {
      for (const LegDescription& leg : std::get<LegsDescription>(general.mechanism).legs) {
        for (std::size_t j = 0; j < leg.joints.size(); ++j) {
          if (leg.name + "/" + leg.joints[j].name != each.on) continue;
          const Vector3& from = leg.joints[j].point;
          const Vector3& to = j + 1 < leg.joints.size() ? leg.joints[j + 1].point : leg.tip;
          const std::string on = '"' + body.on + '"';
          if (leg.joints[j].type == JointType::parallelogram) {
            report(".on", on, "is a pair of parallel bars, not one beam", "give its mass instead");
          } else if (!taken.insert(each.on).second) {
            report(".on", on, "is a beam already", "give every link one tube or bar");
          } else if ((to - from).norm() < kShortest) {
            report(".on", on, "has no length: its joint and the next one are in one point",
                   "name the link that has; see `zwidth show DEVICE --as legs`");
          } else if (!beam_link(*each.beam, from, to, leg.joints[j].axis)) {
            report(tube ? ".tube" : ".bar.width_along", "",
                   "lies along the link, as the axis of its joint does",
                   "give a direction across the link, such as [0, 1, 0]");
          }
        }
      }
      if (!problems.empty() && problems.back().key.starts_with(path)) break;  // the other legs are the same
    }
  }
  return problems;
}

}  // namespace zwidth
