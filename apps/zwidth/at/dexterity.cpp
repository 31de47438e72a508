#include "zwidth/analysis/dexterity.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <fmt/format.h>

#include "section.h"

#include "zwidth/analysis/force.h"

/// How evenly the tool moves and pushes.

namespace zwidth::at {

JacobianUnits units_of(const Situation& at) {
  JacobianUnits units = jacobian_units(at.mechanism);
  units.linear_rows = at.frame.linear();  // in the user's frame a plane may lie askew
  return units;
}

namespace {

/// The rows of the Jacobian that move, where the legs keep the tool from moving or turning some way: they are
/// zero but for a singularity.
struct Moving {
  Jacobian J;
  JacobianUnits units;
};
Moving moving_rows(const Situation& at) {
  Moving moving{at.J, units_of(at)};
  if (at.singularity.loses || at.singularity.gains) return moving;
  std::vector<Eigen::Index> rows;
  int linear = 0;
  for (Eigen::Index r = 0; r < at.J.rows(); ++r) {
    if (at.J.row(r).isZero(0.0)) continue;
    rows.push_back(r);
    linear += r < at.frame.linear() ? 1 : 0;
  }
  if (rows.empty()) return moving;
  moving.J = at.J(rows, Eigen::all);
  moving.units.linear_rows = linear;
  return moving;
}

/// Translations and rotations by themselves, and both together with a radian as a length.
void write_mixed(const Situation& at, const Moving& moving, Answer& answer) {
  answer.undefined("manipulability", "metres and radians cannot be multiplied with each other");
  const bool shown = answer.wants("condition_number") || answer.wants("homogeneous");
  if (at.singularity.loses) {
    answer.undefined("condition_number", "infinite: the Jacobian is singular here");
    answer.undefined("homogeneous", "the Jacobian is singular here");
    if (shown) answer.page().cells("condition number", {"infinite"}, "1 is best");
    return;
  }
  // In the base frame, as maps and data sheets have it.
  const JacobianScale scale = jacobian_scale(at.mechanism);
  const double all = scale.condition_number(at.rates.tool);
  answer.put("condition_number", json_number(all));
  Json entry;
  entry["length"] = json_number(scale.length);
  entry["condition_number"] = json_number(all);
  entry["isotropy"] = json_number(isotropy(scale.homogeneous(at.rates.tool)));
  const auto of_one_kind = [&](const char* key, const Jacobian& rows) {
    const double condition = scale.rows_condition_number(rows);
    entry[key] = {{"condition_number", json_number(condition)},
                  {"isotropy", json_number(isotropy(scale.homogeneous_rows(rows)))}};
    if (shown && std::isfinite(condition))
      answer.cell(fmt::format("condition number, {}", key), condition, "1 is best");
  };
  const auto& [J, units] = moving;
  const int linear = units.linear_rows;
  const bool both = linear > 0 && linear < J.rows();
  if (both) {
    of_one_kind("translation", J.topRows(linear));
    of_one_kind("rotation", J.bottomRows(J.rows() - linear));
  }
  answer.put("homogeneous", entry);
  if (shown)
    answer.cell(both ? "condition number, both" : "condition number", all,
                fmt::format("a radian as {} mm{}", number(scale.length * 1e3),
                            J.cols() < J.rows() ? "; of the motions that there are" : ""));
}

Json ellipsoid_entry(const Ellipsoid& ellipsoid) {
  Json directions = Json::array();
  for (Eigen::Index i = 0; i < ellipsoid.axes.cols(); ++i)
    directions.push_back(json_array(ellipsoid.axes.col(i)));
  return {{"half_axes", json_array(ellipsoid.lengths)}, {"directions", directions}};
}

/// "201.6 × 27.12 mm/s", the longest first.
std::string half_axes(const Ellipsoid& ellipsoid, double factor, const char* unit) {
  std::string text;
  for (const double length : ellipsoid.lengths) {
    text += fmt::format("{}{}", text.empty() ? "" : " × ",
                        std::isfinite(length) ? number(length * factor) : std::string("unlimited"));
  }
  return fmt::format("{} {}", text, unit);
}

}  // namespace

void write_dexterity(const Situation& at, Answer& answer) {
  const Moving moving = moving_rows(at);
  const auto& [J, units] = moving;
  if (!units.homogeneous(J)) {
    write_mixed(at, moving, answer);
    return;
  }
  const Dexterity figures = dexterity(J);
  const double condition = jacobian_scale(at.mechanism).condition_number(at.rates.tool);
  if (at.singularity.loses) {
    answer.undefined("condition_number", "infinite: the Jacobian is singular here");
  } else {
    answer.put("condition_number", json_number(condition));
  }
  answer.put("isotropy", json_number(at.singularity.loses ? 0.0 : isotropy(J)));
  const double manipulability = at.singularity.loses ? 0.0 : figures.manipulability;
  answer.put("manipulability", json_number(manipulability));
  if (answer.wants("condition_number")) {
    if (at.singularity.loses) {
      answer.page().cells("condition number", {"infinite"}, "1 is best");
    } else {
      answer.cell("condition number", condition, "1 is best");
    }
  }
  if (!answer.wants("manipulability")) return;
  const bool fewer = J.cols()<J.rows(), metres = units.linear_rows> 0 && units.sliding_joints == 0;
  const auto motions = static_cast<int>(std::min(J.cols(), J.rows()));
  const std::string unit = !metres        ? ""
                           : motions == 3 ? " [cm³/rad³]"
                           : motions == 2 ? " [cm²/rad²]"
                                          : " [cm/rad]";
  answer.cell("manipulability" + unit, manipulability * (metres ? std::pow(100.0, motions) : 1.0),
              fewer ? "√ det Jᵀ J, of the motions that there are" : "√ det J Jᵀ");
}

void write_ellipsoids(const Situation& at, Answer& answer) {
  const Eigen::Index linear = at.frame.linear(), angular = at.J.rows() - linear;
  const int joints = at.mechanism.active_count();
  const int sliding = std::popcount(units_of(at).sliding_joints);
  const bool rates_alike = sliding == 0 || sliding == joints, driven = at.model.driven();
  const ActiveVector one = ActiveVector::Ones(joints);
  Json velocity, force;
  const auto of_one_kind = [&](const char* key, const char* load, const Jacobian& rows, double factor,
                               const char* speed_unit, const char* load_unit) {
    if (rows.isZero(0.0) && !at.J.isZero(0.0)) return;  // the legs keep the tool from it
    const char* shape = rows.rows() == 2 ? "ellipse" : "ellipsoid";
    if (rates_alike) {
      const Ellipsoid moves = velocity_ellipsoid(rows, one);
      velocity[key] = ellipsoid_entry(moves);
      answer.page().row(fmt::format("{} {}", key, shape), half_axes(moves, factor, speed_unit),
                        fmt::format("half-axes at 1 {}", sliding == 0 ? "rad/s" : "m/s"));
    }
    if (driven) {
      const Ellipsoid pushes = force_ellipsoid(rows, at.model.continuous_torque());
      force[load] = ellipsoid_entry(pushes);
      answer.page().row(fmt::format("{} {}", load, shape), half_axes(pushes, 1.0, load_unit),
                        "half-axes, continuous");
    }
  };
  if (linear > 0) of_one_kind("translation", "force", at.J.topRows(linear), 1e3, "mm/s", "N");
  if (angular > 0) of_one_kind("rotation", "moment", at.J.bottomRows(angular), 1.0, "rad/s", "N m");
  if (rates_alike) {
    answer.put("velocity_ellipsoid", velocity);
  } else {
    answer.undefined("velocity_ellipsoid", "rates of joints that turn and that slide cannot be compared");
  }
  if (driven) {
    answer.put("force_ellipsoid", force);
  } else {
    answer.undefined("force_ellipsoid", "some joints have no electric drive");
  }
}

}  // namespace zwidth::at
