#include <algorithm>
#include <cmath>
#include <numbers>

#include "quantities.h"

#include "zwidth/analysis/force.h"
#include "zwidth/analysis/workspace.h"
#include "zwidth/mechanism/delta.h"
#include "zwidth/mechanism/mechanism.h"

namespace zwidth::reference {
namespace {

double positive(const Inputs& in, const std::string& key) {
  const double value = in.number(key);
  if (!(value > 0.0) || !std::isfinite(value)) throw Refusal("invalid_argument");
  return value;
}

DeltaGeometry geometry(const Inputs& in) {
  return {.base_radius = in.number("d1_m"),
          .upper_arm = positive(in, "d2_m"),
          .forearm = positive(in, "d3_m"),
          .platform_radius = in.number("d4_m")};
}

Interval window(const Inputs& in) {
  constexpr Interval kAnyAngle = {-1e9, 1e9};
  return in.has("theta_min_deg") ? Interval{in.degrees("theta_min_deg"), in.degrees("theta_max_deg")}
                                 : kAnyAngle;
}

Mechanism mechanism(const Inputs& in) {
  const DeltaGeometry lengths = geometry(in);
  if (!(window(in).width() > 0.0)) throw Refusal("invalid_argument");
  Description description;
  description.mechanism = DeltaDescription{.base_radius = lengths.base_radius,
                                           .upper_arm = lengths.upper_arm,
                                           .forearm = lengths.forearm,
                                           .platform_radius = lengths.platform_radius,
                                           .joint_range = window(in)};
  return Mechanism(description);
}

/// For the workspace, which needs a window: without one the key is missed.
Mechanism windowed(const Inputs& in) {
  in.number("theta_min_deg");
  return mechanism(in);
}

void refuse_unless_closed(SolveStatus status) {
  if (status != SolveStatus::reached && status != SolveStatus::degraded) throw Refusal(to_string(status));
}

DeltaInverse inverse(const Inputs& in, Knee knee) {
  const DeltaInverse answer = delta_inverse(geometry(in), in.vector("p_m"), window(in), {knee, knee, knee});
  refuse_unless_closed(answer.status);
  return answer;
}

DeltaState state(const Inputs& in) {
  const DeltaGeometry lengths = geometry(in);
  if (!in.has("theta_rad")) return {lengths, inverse(in, Knee::outwards).theta, in.vector("p_m")};
  const Vector3 theta = in.vector("theta_rad");
  const Solution solution = solve_forward(mechanism(in), theta);
  refuse_unless_closed(solution.status);
  return {lengths, theta, solution.posture->tool().position};
}

DeltaState regular_state(const Inputs& in) {
  const DeltaState answer = state(in);
  // What rounding leaves of det R/d3^3 = 0: forward kinematics takes a root of a difference that cancels, and
  // so does a leg that is stretched.
  const double legs = answer.inverse_singularity().cwiseAbs().minCoeff();
  const double rounding = in.has("theta_rad") ? 1e-7 : std::clamp(1e-15 / legs, 1e-12, 1e-7);
  if (std::abs(answer.direct_singularity()) < rounding) throw Refusal("singular");
  return answer;
}

DeltaPointMassDynamics dynamics(const Inputs& in) {
  return {geometry(in),
          {.upper_arm = in.number("m2_kg"),
           .forearms = in.vector("m3_kg"),
           .platform = in.number("m4_kg"),
           .payload = in.number_or("m_payload_kg", 0.0),
           .centre_along = in.number("c_x_m"),
           .centre_normal = in.number("c_n_m"),
           .upper_arm_inertia = in.vector("I2_kgm2"),
           .motor_inertia = in.vector("I_motor_kgm2"),
           .gear_ratio = in.number("k_g"),
           .mass_split = in.number_or("mass_split", 2.0 / 3.0),
           .gravity = in.number_or("g_m_s2", kStandardGravity)}};
}

Vector3 optional_vector(const Inputs& in, const std::string& key) {
  return in.has(key) ? in.vector(key) : Vector3(Vector3::Zero());
}

Values rows(const Matrix3& m) {
  return {m(0, 0), m(0, 1), m(0, 2), m(1, 0), m(1, 1), m(1, 2), m(2, 0), m(2, 1), m(2, 2)};
}
Values list(const Vector3& v) {
  return {v.x(), v.y(), v.z()};
}

LatticeSweep sweep(const Inputs& in) {
  LatticeOptions options{.spacing = positive(in, "grid_m")};
  if (in.has("tau_max_Nm")) options.limits.torque = in.vector("tau_max_Nm");
  return sweep_workspace(windowed(in), options);
}

}  // namespace

void add_delta(Quantities& q) {
  q["delta.fk"] = [](const Inputs& in) { return list(state(in).position()); };
  q["delta.ik"] = [](const Inputs& in) { return list(inverse(in, Knee::outwards).theta); };
  q["delta.ik_other_branch"] = [](const Inputs& in) { return list(inverse(in, Knee::inwards).theta); };
  q["delta.jacobian"] = [](const Inputs& in) { return rows(regular_state(in).jacobian()); };
  q["delta.jacobian_dot"] = [](const Inputs& in) {
    return rows(regular_state(in).jacobian_rate(in.vector("theta_dot_rad_s")));
  };
  q["delta.velocity"] = [](const Inputs& in) {
    return list(regular_state(in).velocity(in.vector("theta_dot_rad_s")));
  };
  q["delta.acceleration"] = [](const Inputs& in) {
    return list(regular_state(in).acceleration(in.vector("theta_dot_rad_s"), in.vector("theta_ddot_rad_s2")));
  };
  q["delta.axis_force"] = [](const Inputs& in) {
    return list(axis_force_limits(regular_state(in).jacobian(), in.vector("tau_max_Nm")));
  };

  q["delta.workspace_volume"] = [](const Inputs& in) { return Values{workspace_volume(windowed(in)).value}; };
  q["delta.workspace_volume_lattice"] = [](const Inputs& in) { return Values{sweep(in).volume}; };
  q["delta.workspace_lattice_count"] = [](const Inputs& in) {
    return Values{static_cast<double>(sweep(in).inside)};
  };
  q["delta.workspace_extents"] = [](const Inputs& in) {
    const auto range = workspace_extents(windowed(in)).range;
    return Values{range[0].min, range[0].max, range[1].min, range[1].max, range[2].min, range[2].max};
  };
  q["delta.workspace_extents.height"] = [](const Inputs& in) {
    return Values{workspace_extents(windowed(in)).size().z()};
  };
  const std::array<std::string, 3> axes = {"x", "y", "z"};
  for (int axis = 0; axis < 3; ++axis) {
    const std::string extents = "delta.workspace_extents." + axes[axis],
                      force = "delta.axis_force_statistics." + axes[axis];
    q[extents + "_min"] = [axis](const Inputs& in) {
      return Values{workspace_extents(windowed(in)).range[axis].min};
    };
    q[extents + "_max"] = [axis](const Inputs& in) {
      return Values{workspace_extents(windowed(in)).range[axis].max};
    };
    const auto statistic = [axis](const Inputs& in) {
      return sweep(in).figures[static_cast<int>(Figure::force_x) + axis];
    };
    q[force + "_min"] = [statistic](const Inputs& in) { return Values{statistic(in).min}; };
    q[force + "_max"] = [statistic](const Inputs& in) { return Values{statistic(in).max}; };
    q[force + "_avg"] = [statistic](const Inputs& in) { return Values{statistic(in).mean}; };
  }
  q["delta.axis_force_statistics"] = [](const Inputs& in) {
    const LatticeSweep all = sweep(in);
    const Statistic &x = all[Figure::force_x], &y = all[Figure::force_y], &z = all[Figure::force_z];
    return Values{x.min, y.min, z.min, x.max, y.max, z.max, x.mean, y.mean, z.mean};
  };

  q["delta.mass_matrix"] = [](const Inputs& in) { return rows(dynamics(in).mass_matrix(regular_state(in))); };
  q["delta.coriolis_matrix"] = [](const Inputs& in) {
    return rows(dynamics(in).coriolis_matrix(regular_state(in), in.vector("theta_dot_rad_s")));
  };
  q["delta.gravity_torque"] = [](const Inputs& in) {
    return list(dynamics(in).gravity_torque(regular_state(in)));
  };
  q["delta.inverse_dynamics"] = [](const Inputs& in) {
    return list(dynamics(in).inverse(regular_state(in), optional_vector(in, "theta_dot_rad_s"),
                                     optional_vector(in, "theta_ddot_rad_s2"), optional_vector(in, "f_ext_N")));
  };
}

}  // namespace zwidth::reference
