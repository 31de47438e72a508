#include "zwidth/analysis/balance.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <stdexcept>

#include "zwidth/math/svd.h"
#include "zwidth/mechanism/dynamics.h"
#include "zwidth/mechanism/mechanism.h"

namespace zwidth {
namespace {

bool positive(double value) {
  return value > 0.0 && std::isfinite(value);
}

Counterweight counterweight(double m, double d, double M, double D) {
  if (!positive(m) || !positive(d) || !positive(M) || !positive(D)) {
    throw std::invalid_argument("masses and distances of a counterweight must be positive and finite");
  }
  return {M, D, m * d * d * (m / M + 1.0)};
}

bool serial_and_revolute(const Mechanism& mechanism) {
  // Where the tool is but a point, the platform's bodies lie on the last link.
  return mechanism.legs().size() == 1 &&
         (mechanism.legs()[0].attachment == Attachment::rigid ||
          mechanism.platform() == PlatformFreedom::point) &&
         std::all_of(mechanism.joints().begin(), mechanism.joints().end(),
                     [](const JointModel& joint) { return joint.type == JointType::revolute; });
}

// As the bodies lie, with the share along each axis still on its own link.
std::vector<Vector3> own_moments(const Mechanism& mechanism) {
  const int n = mechanism.joint_count();
  const LegModel& leg = mechanism.legs()[0];
  std::vector<Vector3> moments(static_cast<std::size_t>(n), Vector3::Zero());
  std::vector<double> carried(static_cast<std::size_t>(n), 0.0);  // mass on link j
  double at_tip = 0.0;
  for (const BodyModel& body : mechanism.bodies()) {
    if (body.joint < 0) {
      // The tool turns with the last link, from its tip.
      const Vector3 centre = leg.platform_rotation * (body.centre - leg.platform_point);
      moments.back() += body.mass * centre;
      at_tip += body.mass;
    } else {
      carried[static_cast<std::size_t>(body.joint)] += body.mass;
      moments[static_cast<std::size_t>(body.joint)] += body.mass * body.pivot;
      moments[static_cast<std::size_t>(body.turns_with)] += body.mass * body.centre;
    }
  }
  double outside = at_tip;
  for (int j = n - 1; j >= 0; --j) {
    const Vector3& arm = j + 1 < n ? mechanism.joints()[static_cast<std::size_t>(j) + 1].offset : leg.tip;
    moments[static_cast<std::size_t>(j)] += outside * arm;
    outside += carried[static_cast<std::size_t>(j)];
  }
  return moments;
}

// The share along a joint's axis is handed to the inner link, which it turns with.
std::vector<Vector3> handed_inwards(const Mechanism& mechanism, std::vector<Vector3> moments) {
  for (std::size_t j = moments.size(); j-- > 1;) {
    const Vector3& axis = mechanism.joints()[j].axis;
    const Vector3 along = axis * axis.dot(moments[j]);
    moments[j] -= along;
    moments[j - 1] += along;
  }
  return moments;
}

}  // namespace

std::vector<Vector3> first_moments(const Mechanism& mechanism) {
  if (!serial_and_revolute(mechanism)) return {};
  return handed_inwards(mechanism, own_moments(mechanism));
}

BalanceResidual balance_residual(std::span<const Posture> postures) {
  assert(!postures.empty());
  const int n = postures[0].mechanism().active_count();
  BalanceResidual residual{ActiveVector::Zero(n), std::vector<int>(static_cast<std::size_t>(n), 0)};
  std::vector<Vector3> centres;
  for (std::size_t i = 0; i < postures.size(); ++i) {
    const ActiveVector torque = gravity_torques(postures[i]).cwiseAbs();
    for (int j = 0; j < n; ++j) {
      if (torque[j] <= residual.torque[j]) continue;
      residual.torque[j] = torque[j];
      residual.worst[static_cast<std::size_t>(j)] = static_cast<int>(i);
    }
    centres.push_back(mass_centre(postures[i]));
    residual.centre += centres.back() / static_cast<double>(postures.size());
  }
  for (const Vector3& centre : centres)
    residual.stray = std::max(residual.stray, (centre - residual.centre).norm());
  return residual;
}

Counterweight counterweight_of_mass(double body_mass, double body_distance, double mass) {
  return counterweight(body_mass, body_distance, mass, body_mass * body_distance / mass);
}

Counterweight counterweight_at(double body_mass, double body_distance, double distance) {
  return counterweight(body_mass, body_distance, body_mass * body_distance / distance, distance);
}

std::optional<BalancedBody> balanced_body(const Description& description, std::size_t body) {
  assert(body < description.bodies.size());
  const Mechanism mechanism(description);
  if (!serial_and_revolute(mechanism) || mechanism.bodies().size() != description.bodies.size())
    return std::nullopt;
  const BodyModel& model = mechanism.bodies()[body];
  if (description.bodies[body].on == "platform" || !(model.mass > 0.0)) return std::nullopt;
  BalancedBody result{description.bodies[body], {}};
  std::vector<Vector3> moments = own_moments(mechanism);
  // What a point of the link can take: its own moment, and along its axis that of the inner link.
  const auto take = [&](int joint) {
    const auto j = static_cast<std::size_t>(joint);
    const std::vector<Vector3> left = handed_inwards(mechanism, moments);
    Vector3 moment = left[j];
    if (j > 0) {
      const Vector3& axis = mechanism.joints()[j].axis;
      moment += axis * axis.dot(left[j - 1]);
    }
    moments[j] -= moment;
    return Vector3(moment / model.mass);
  };
  if (model.turns_with == model.joint) {
    result.body.centre -= take(model.joint);
  } else {
    const Vector3 pin = take(model.joint), centre = take(model.turns_with);
    result.body.pivot -= pin;
    result.body.centre -= pin + centre;
  }
  Description moved = description;
  moved.bodies[body] = result.body;
  result.residual = first_moments(Mechanism(moved));
  return result;
}

WeightAtTool weight_at_tool(const Posture& posture) {
  const Mechanism& mechanism = posture.mechanism();
  const Rates all = rates(posture);
  const ActiveVector holding = gravity_torques(posture, all);
  const int rows = mechanism.linear_rows();
  WeightAtTool weight;
  weight.left = holding;
  if (rows == 0) return weight;
  // The hand's force f does what the torques would: J^T f = holding, as nearly as may be.
  const Jacobian J = all.tool.topRows(rows);
  const ToolVector f = pseudo_inverse(SmallMatrix(J.transpose())) * holding;
  weight.left -= J.transpose() * f;
  ToolVector padded = ToolVector::Zero(mechanism.tool_rows());
  padded.head(rows) = f;
  weight.force = mechanism.six_components(padded).head<3>();
  const double g = mechanism.gravity().norm();
  if (g > 0.0) weight.mass = -weight.force.dot(mechanism.gravity()) / (g * g);
  return weight;
}

}  // namespace zwidth
