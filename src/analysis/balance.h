#pragma once

#include <optional>
#include <span>
#include <vector>

#include "zwidth/description/description.h"
#include "zwidth/mechanism/posture.h"

/// Static balance: what weight is left for the joints to hold, and the counterweight that takes it.

namespace zwidth {

/// First moments of a serial arm: moving mass x mass centre = constant + sum_j R_j b_j, where R_j turns the
/// link of joint j and b_j [kg m] is given in that link's frame. Each b_j counts what turns with the link and
/// what it carries outwards. The share along joint j's own axis turns with the inner link as well and is
/// counted there, so that what is left weighs on a joint: the arm is balanced in every posture exactly if all
/// b_j vanish, but for those of joints whose axes keep along gravity. (For the arm of Baser 2006, eq 5.24
/// and 5.25: A along the upper link, B along the forearm.) Empty unless the mechanism is one leg of revolute
/// joints whose last link is the tool, or carries it as a point.
std::vector<Vector3> first_moments(const Mechanism& mechanism);

/// Largest |gravity torque| of each active joint over postures, and how far the mass centre strays.
struct BalanceResidual {
  ActiveVector torque;               ///< per active joint [N m, N]
  std::vector<int> worst;            ///< posture of each, by index
  Vector3 centre = Vector3::Zero();  ///< mean of the mass centres, base frame [m]
  double stray = 0.0;                ///< farthest of a mass centre from the mean [m]
};
/// REQUIRES: at least one posture.
BalanceResidual balance_residual(std::span<const Posture> postures);

/// A body m at a distance d from an axis, balanced by a counterweight M at D on the other side.
struct Counterweight {
  double mass = 0.0;      ///< M [kg]
  double distance = 0.0;  ///< D = m d / M [m]
  double inertia = 0.0;   ///< of both about the axis, m d^2 (m/M + 1) (Baser 2006, section 5.2) [kg m^2]
};
/// Throws std::invalid_argument unless all three are positive and finite.
Counterweight counterweight_of_mass(double body_mass, double body_distance, double mass);
Counterweight counterweight_at(double body_mass, double body_distance, double distance);

/// A body of a serial arm moved (its centre, and its pivot if it hangs on one) so that the first moments of the
/// link that carries it and of the one that turns it vanish.
struct BalancedBody {
  BodyDescription body;
  std::vector<Vector3> residual;  ///< `first_moments` with it in place [kg m]
};
/// Empty where `first_moments` is, if the body is on the platform, or has no mass.
/// REQUIRES: body < description.bodies.size(), `validate` finds nothing.
std::optional<BalancedBody> balanced_body(const Description& description, std::size_t body);

/// The device held by the tool alone, with the drives off: the force that comes nearest to holding its weight.
struct WeightAtTool {
  Vector3 force = Vector3::Zero();  ///< of the hand on the tool, base frame [N]
  double mass = 0.0;                ///< of it that works against gravity, as a scale would show it [kg]
  ActiveVector left;                ///< torques that no pure force at the tool holds [N m, N]
};
WeightAtTool weight_at_tool(const Posture& posture);

}  // namespace zwidth
