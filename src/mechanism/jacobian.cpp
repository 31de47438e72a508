#include "zwidth/mechanism/jacobian.h"

#include <limits>

#include "zwidth/math/svd.h"
#include "zwidth/mechanism/internal/closure.h"

namespace zwidth {

using internal::Closure;
using internal::ClosureVector;

namespace {

// Of an arm, whose closure has nothing to solve.
Rates arm_rates(const Posture& posture) noexcept {
  const Mechanism& mechanism = posture.mechanism();
  const int n = mechanism.active_count();
  Rates result;
  result.tool.setZero(6, n);
  result.joints.setIdentity(n, n);
  result.closure = 1.0;
  for (int j = 0; j < n; ++j) {
    const Vector3& axis = posture.joint_axis(j);
    if (mechanism.joints()[j].type == JointType::prismatic) {
      result.tool.col(j).head<3>() = axis;
      continue;
    }
    result.tool.col(j).head<3>() = axis.cross(posture.tool().position - posture.joint_point(j));
    result.tool.col(j).tail<3>() = axis;
  }
  return result;
}

}  // namespace

Rates rates(const Posture& posture) noexcept {
  if (posture.mechanism().serial() != nullptr) return arm_rates(posture);
  return internal::rates_of(posture, Closure(posture));
}

Jacobian jacobian(const Posture& posture) noexcept {
  return rates(posture).tool;
}

BiasAcceleration bias_acceleration(const Posture& posture, const Rates& rates,
                                   const ActiveVector& active_rate) noexcept {
  const Mechanism& mechanism = posture.mechanism();
  const double length = mechanism.characteristic_length();
  const JointVector joint_rate = rates.joints * active_rate;
  const Vector3 platform_rate = mechanism.six_components(rates.tool * active_rate).tail<3>();

  // Acceleration of each closure row with every joint at constant rate, by recursion along the leg.
  ClosureVector w{};
  for (int l = 0; l < static_cast<int>(mechanism.legs().size()); ++l) {
    const LegModel& leg = mechanism.legs()[l];
    Vector3 omega = Vector3::Zero(), alpha = Vector3::Zero();  // of the link that carries the next joint's axis
    Vector3 acceleration = Vector3::Zero();                    // of the current point
    for (int j = leg.first; j < leg.first + leg.count; ++j) {
      const JointModel& joint = mechanism.joints()[j];
      const Vector3 spin = posture.joint_axis(j) * joint_rate[j];
      const bool last = j + 1 == leg.first + leg.count;
      const Vector3 arm = posture.link_rotation(j) * (last ? leg.tip : mechanism.joints()[j + 1].offset);
      if (joint.type == JointType::prismatic) {
        const Vector3 extension = posture.joint_axis(j) * posture.joints()[j];
        acceleration += alpha.cross(extension) + omega.cross(omega.cross(extension)) + 2.0 * omega.cross(spin);
        acceleration += alpha.cross(arm) + omega.cross(omega.cross(arm));
        continue;
      }
      const Vector3 link_omega = omega + spin;
      const Vector3 link_alpha = alpha + omega.cross(spin);
      acceleration += link_alpha.cross(arm) + link_omega.cross(link_omega.cross(arm));
      if (joint.type == JointType::revolute) {
        omega = link_omega;
        alpha = link_alpha;
      }
    }
    const Vector3 held = posture.tool().rotation * leg.platform_point;
    const Vector3 linear = acceleration - platform_rate.cross(platform_rate.cross(held));
    for (int i = 0; i < 3; ++i) {
      w[l][i] = linear[i];
      w[l][3 + i] = alpha[i] * length;
    }
  }
  BiasAcceleration bias;
  if (mechanism.serial() != nullptr) {  // nothing else moves
    bias.tool = Eigen::Map<const Vector6>(w[0].data());
    bias.tool.tail<3>() /= length;
    bias.joints.setZero(mechanism.joint_count());
    return bias;
  }
  bias.tool.setZero(mechanism.tool_rows());
  bias.joints.setZero(mechanism.joint_count());
  std::array<double, 6> tool;
  Closure(posture).solve(w, tool, [&bias](int j, double acceleration) { bias.joints[j] = acceleration; });
  bias.tool = Eigen::Map<const Vector6>(tool.data()).head(mechanism.tool_rows());
  return bias;
}

Dexterity dexterity(const Jacobian& jacobian) {
  const auto [u, sigma, v] = svd(jacobian);
  Dexterity result;
  const Eigen::Index last = sigma.size() - 1;
  result.max_singular_value = sigma[0];
  result.min_singular_value = sigma[last];
  result.condition_number = result.min_singular_value > 0.0
                                ? result.max_singular_value / result.min_singular_value
                                : std::numeric_limits<double>::infinity();
  result.manipulability = sigma.prod();
  result.weak_direction = u.col(last);
  return result;
}

}  // namespace zwidth
