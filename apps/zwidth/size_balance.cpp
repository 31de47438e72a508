#include "size_balance.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>

#include "efforts.h"

#include "zwidth/analysis/balance.h"
#include "zwidth/mechanism/dynamics.h"

namespace zwidth {

namespace {

/// How many of an arm's joints, from the base on, have axes that keep along gravity: their links turn about it
/// and weigh on no joint, however their masses lie.
size_t level_joints(const Mechanism& mechanism) {
  size_t count = 0;
  while (count < mechanism.joints().size() &&
         mechanism.joints()[count].axis.cross(mechanism.gravity().normalized()).norm() < 1e-9)
    ++count;
  return count;
}

/// Of the links that weigh on a joint.
double total(const std::vector<Vector3>& moments, size_t level) {
  double sum = 0.0;
  for (size_t j = level; j < moments.size(); ++j) sum += moments[j].squaredNorm();
  return std::sqrt(sum);
}

/// The body that, moved, leaves the least to hold; of several that leave as little, the one that moves least.
struct Best {
  size_t body = 0;
  BalancedBody balanced;
  double residual = 0.0;  // [kg m]
  double way = 0.0;       // that it moves [m]
};
std::optional<Best> best_counterweight(const Description& description, const std::vector<Vector3>& moments,
                                       size_t level) {
  const double nothing = 1e-12 * (1.0 + total(moments, level));
  std::optional<Best> best;
  for (size_t i = 0; i < description.bodies.size(); ++i) {
    const std::optional<BalancedBody> moved = balanced_body(description, i);
    if (!moved) continue;
    const BodyDescription& now = description.bodies[i];
    const Best one{i, *moved, total(moved->residual, level),
                   (moved->body.centre - now.centre).norm() + (moved->body.pivot - now.pivot).norm()};
    const bool better = !best || one.residual < best->residual - nothing ||
                        (one.residual < best->residual + nothing && one.way < best->way);
    if (better) best = one;
  }
  return best;
}

Json counterweight_json(const Best& best) {
  const BodyDescription& body = best.balanced.body;
  Json entry{{"body", best.body}, {"on", body.on}, {"mass", json_number(body.mass)}};
  if (!body.turns_with.empty()) {
    entry["turns_with"] = body.turns_with;
    entry["pivot"] = json_array(body.pivot);
  }
  entry["centre"] = json_array(body.centre);
  entry["residual"] = json_number(best.residual);
  return entry;
}

}  // namespace

Json write_balance(const Description& description, const Mechanism& mechanism,
                   std::span<const Posture> postures, Sheet& sheet) {
  if (moving_mass(mechanism) == 0.0) return nullptr;
  const BalanceResidual residual = balance_residual(postures);
  const std::vector<Vector3> moments = first_moments(mechanism);
  const double g = mechanism.gravity().norm();
  const size_t level = level_joints(mechanism);

  sheet.heading("Static balance");
  Json joints = Json::array();
  std::vector<std::vector<std::string>> rows;
  for (int i = 0; i < mechanism.active_count(); ++i) {
    const std::string& name = mechanism.active_names()[static_cast<size_t>(i)];
    Json joint{{"joint", name}, {"gravity", json_number(residual.torque[i])}};
    std::string moment;
    if (!moments.empty()) {
      const Vector3& b = moments[static_cast<size_t>(mechanism.active_joint(i))];
      joint["moment"] = json_array(b);
      moment = static_cast<size_t>(i) < level ? "turns level" : readable(g * b.norm(), "N m");
    }
    joints.push_back(joint);
    const double held = residual.torque[i] < 1e-12 * residual.torque.maxCoeff() ? 0.0 : residual.torque[i];
    rows.push_back({name, readable(held, effort_unit(joint_slides(mechanism, i))), moment});
  }
  const bool arm = !moments.empty();
  if (!arm) {
    for (auto& row : rows) row.pop_back();
  }
  sheet.table(arm ? std::vector<std::string>{"joint", "weight held, at worst", "residual moment"}
                  : std::vector<std::string>{"joint", "weight held, at worst"},
              rows);

  double lightest = std::numeric_limits<double>::infinity(), heaviest = -lightest;
  for (const Posture& posture : postures) {
    const double mass = weight_at_tool(posture).mass;
    if (!std::isfinite(mass)) continue;
    lightest = std::min(lightest, mass);
    heaviest = std::max(heaviest, mass);
  }
  sheet.row("moving mass", quantity(moving_mass(mechanism), kMilli, "g"));
  sheet.row("mass centre strays", quantity(residual.stray, kMilli, "mm"), "from its mean over the postures");
  const bool moves = mechanism.linear_rows() > 0;  // or only turns, and rests on no scale
  if (moves)
    sheet.row("weight at the tool", interval(lightest, heaviest, kMilli, "g"),
              "with the drives off, as a scale shows it");

  Json entry{{"joints", joints},
             {"moving_mass", json_number(moving_mass(mechanism))},
             {"mass_centre", json_array(residual.centre)},
             {"stray", json_number(residual.stray)},
             {"weight_at_tool", moves ? Json{json_number(lightest), json_number(heaviest)} : Json(nullptr)}};
  entry["counterweight"] = nullptr;
  if (const std::optional<Best> best = arm ? best_counterweight(description, moments, level) : std::nullopt) {
    const BodyDescription &now = description.bodies[best->body], &then = best->balanced.body;
    entry["counterweight"] = counterweight_json(*best);
    const double left = g * best->residual;
    std::string text = fmt::format("Nearest to balance comes body[{}], {} on {}, ", best->body,
                                   quantity(now.mass, kMilli, "g"), now.on);
    if (then.turns_with.empty()) {
      text += fmt::format("with its centre at {}", point_text(then.centre));
    } else {
      text += fmt::format("hung at {} with its centre at {}", point_text(then.pivot), point_text(then.centre));
    }
    text += left < 1e-9 ? ": the joints then hold no weight."
                        : fmt::format(": {} are left.", readable(left, "N m"));
    sheet.paragraph(text);
  }
  return entry;
}

}  // namespace zwidth
