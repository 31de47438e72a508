#include <Eigen/Geometry>
#include <numbers>

#include "quantities.h"
#include "support/pneumatics.h"

#include "zwidth/actuation/arm_cylinder.h"
#include "zwidth/actuation/cylinder.h"
#include "zwidth/analysis/force.h"
#include "zwidth/description/names.h"
#include "zwidth/description/units.h"
#include "zwidth/mechanism/jacobian.h"
#include "zwidth/mechanism/posture.h"

// The pneumatic prototypes: cylinders on arms, pressures, and three positioning stages by their tables.

namespace zwidth::reference {
namespace {

using test::prototype;

// ------------------------------------------------------------------------------------------- cylinder on an
// arm

ArmCylinderLayout layout(const Inputs& in) {
  const std::string name = in.text("config");
  for (const auto& [known, value] : arm_cylinder_layout_names()) {
    if (known == name) return value;
  }
  throw std::out_of_range("there is no layout " + name);
}

ArmCylinder arm(const Inputs& in) {
  return ArmCylinder({.layout = layout(in),
                      .l0 = in.number_or("l0_m", 0.0),
                      .l1 = in.number_or("l1_m", 0.0),
                      .l2 = in.number_or("l2_m", 0.0),
                      .h = in.number_or("h_m", 0.0)});
}

Interval range(const Inputs& in) {
  const double half = in.degrees("theta_max_deg");
  return {-half, half};
}

double at_dead_point(const std::optional<double>& value) {
  if (!value) throw Refusal("dead_point");
  return *value;
}

CylinderTravel travel(const Inputs& in) {
  return {in.number("dmin_m"), in.number("dmax_m"), in.number("theta_max_rad")};
}

DesignRoot root(const Inputs& in) {
  return in.number_or("root", 1.0) < 0.0 ? DesignRoot::minus : DesignRoot::plus;
}

const ArmCylinderDescription& feasible(const std::optional<ArmCylinderDescription>& design) {
  if (!design) throw Refusal("infeasible_design");
  return *design;
}

// -------------------------------------------------------------------------------------------------- prototypes

ActiveVector joints(const std::vector<double>& values) {
  return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}

Mechanism first(const Inputs& in) {
  return Mechanism(prototype(test::Prototype1{in.number_or("l1x_m", 0.1), in.number_or("l2x_m", 0.2),
                                              in.number_or("l3x_m", 0.01), in.number_or("l3y_m", 0.03),
                                              in.number_or("l3z_m", 0.3)}));
}
// The reference gives theta1, theta2, then the slide; the device has the slide first.
ActiveVector first_joints(const Inputs& in) {
  const std::vector<double> theta = in.list("theta_rad");
  return joints({in.number_or("d1z_m", 0.0), theta.at(0), theta.at(1)});
}
Matrix3 slide_last(const Jacobian& J) {
  return (Matrix3() << J.col(1), J.col(2), J.col(0)).finished();
}

Mechanism second(const Inputs& in) {
  return Mechanism(prototype(test::Prototype2{in.number_or("l1x_m", 0.2), in.number_or("l12y_m", 0.03),
                                              in.number_or("l2z_m", 0.04), in.number_or("l2x_m", 0.15),
                                              in.number_or("lex_m", 0.12)}));
}

Mechanism third(const Inputs& in) {
  return Mechanism(prototype(test::Prototype3{in.number_or("l0_m", 0.15), in.number_or("l1_m", 0.11),
                                              in.number_or("l2_m", 0.028), in.number_or("l3_m", 0.04)}));
}
// The wrist may be left out.
ActiveVector third_joints(const Inputs& in) {
  std::vector<double> theta = in.list("theta_rad");
  theta.resize(5, 0.0);
  return joints(theta);
}

// Answers of one posture; the mechanism lives as long.
template <class Function>
auto at(const Mechanism& mechanism, const ActiveVector& active, const Function& function) {
  const Solution solution = solve_forward(mechanism, active);
  if (!solution) throw Refusal(to_string(solution.status));
  return function(*solution.posture);
}

Values transform(const Posture& posture) {
  Eigen::Matrix<double, 4, 4, Eigen::RowMajor> T = Eigen::Matrix4d::Identity();
  T.topLeftCorner<3, 3>() = posture.tool().rotation;
  T.topRightCorner<3, 1>() = posture.tool().position;
  return {T.data(), T.data() + T.size()};
}

Values rows(const Eigen::Ref<const Eigen::MatrixXd>& matrix) {
  Values values;
  for (Eigen::Index r = 0; r < matrix.rows(); ++r) {
    for (Eigen::Index c = 0; c < matrix.cols(); ++c) values.push_back(matrix(r, c));
  }
  return values;
}

// Cylinder and lengths of set A (8.75 N and 5 cm) or B (80 mm) of the final device.
struct Set {
  test::Prototype3 lengths;
  std::array<ArmCylinder, 3> cylinders;
};
Set chosen_set(const Inputs& in) {
  const bool larger = in.text("set") == "B";
  const CylinderTravel travel{0.075, 0.0875, (larger ? 45.0 : 30.0) * std::numbers::pi / 180.0};
  return {test::Prototype3{0.15, 0.11, larger ? 0.02 : 0.028, 0.04},
          {ArmCylinder(design_two_optimal(travel)),
           ArmCylinder(design_two_optimal(travel, ArmCylinderLayout::two_mod)),
           ArmCylinder(design_three_optimal(travel))}};
}

std::array<double, 3> pushes(const Inputs& in) {
  const Set set = chosen_set(in);
  const Mechanism mechanism(prototype(set.lengths));
  return at(mechanism, third_joints(in), [&](const Posture& posture) {
    const ActiveVector torque = torques_for_load(jacobian(posture), in.vector("F_N"));
    std::array<double, 3> push{};
    for (int j = 0; j < 3; ++j) {
      push[j] = at_dead_point(set.cylinders[j].push_for_torque(torque[j], posture.active()[j]));
    }
    return push;
  });
}

PressureAllocation allocation(const Inputs& in) {
  return {in.number("A1_m2"), in.number("A2_m2"), in.number("p_bias_Pa"), in.number("p_max_Pa")};
}

void add_cylinders(Quantities& q) {
  q["actuator_length"] = [](const Inputs& in) { return Values{arm(in).length(in.number("theta_rad"))}; };
  q["actuator_length_rate"] = [](const Inputs& in) { return Values{arm(in).lever(in.number("theta_rad"))}; };
  q["phi"] = [](const Inputs& in) { return Values{arm(in).phi(in.number("theta_rad"))}; };
  q["stroke"] = [](const Inputs& in) {
    return Values{std::abs(arm(in).length(range(in).max) - arm(in).length(range(in).min))};
  };
  q["required_actuator_force"] = [](const Inputs& in) {
    return Values{
        at_dead_point(arm(in).required_force(in.number("F_N"), in.number("lF_m"), in.number("theta_rad")))};
  };
  q["push_force_for_torque"] = [](const Inputs& in) {
    return Values{at_dead_point(arm(in).push_for_torque(in.number("T_Nm"), in.number("theta_rad")))};
  };
  q["theta_of_length"] = [](const Inputs& in) {
    const auto angle = arm(in).angle(in.number("d_m"));
    if (!angle) throw Refusal("length_unreachable");
    return Values{*angle};
  };
  q["peak_force_within_limit"] = [](const Inputs& in) {
    const auto peak = arm(in).peak_required_force(in.number("F_N"), in.number("lF_m"), range(in));
    if (!peak) throw Refusal("dead_point");
    return Values{peak->force <= in.number("limit_N") ? 1.0 : 0.0};
  };
  // How many newtons at the arm's end the cylinder's force carries.
  q["max_vertical_force"] = [](const Inputs& in) {
    const double area = in.number("A1_m2");
    const double per_newton =
        at_dead_point(arm(in).required_force(1.0, in.number("L_m"), in.number("theta_rad")));
    return Values{cylinder_force(area, area, in.number("P1_Pa"), 0.0) / per_newton};
  };

  q["design_one"] = [](const Inputs& in) {
    const ArmCylinderDescription design = feasible(design_one(travel(in), root(in)));
    return Values{design.l1, design.l2};
  };
  q["design_two"] = [](const Inputs& in) {
    const ArmCylinderDescription design = feasible(design_two(travel(in), in.number("l2_m"), root(in)));
    return Values{design.l0, design.l1};
  };
  q["design_two_optimal"] = [](const Inputs& in) {
    const ArmCylinderDescription design = design_two_optimal(travel(in));
    return Values{design.l0, design.l1, design.l2};
  };
  q["design_three"] = [](const Inputs& in) {
    const ArmCylinderDescription design =
        feasible(design_three(travel(in), in.number("h_m"), in.number("l2_m"), root(in)));
    return Values{design.l0, design.l1};
  };
  q["minimum_peak_force"] = [](const Inputs& in) {
    return Values{minimum_peak_force(in.number("stroke_m"), in.number("theta_max_rad"), in.number("F_N"),
                                     in.number("lF_m"))};
  };

  q["cylinder_force"] = [](const Inputs& in) {
    return Values{
        cylinder_force(in.number("A1_m2"), in.number("A2_m2"), in.number("P1_Pa"), in.number("P2_Pa"))};
  };
  q["allocate_pressures"] = [](const Inputs& in) {
    const ChamberPressures pressures = allocation(in).pressures(in.number("F_N"));
    return Values{pressures.rear, pressures.rod, pressures.saturated ? 1.0 : 0.0};
  };
  q["regulator_pressure"] = [](const Inputs& in) {
    Regulator itv0030;
    itv0030.min_pressure = 1e3;
    itv0030.max_pressure = 500e3;
    itv0030.max_command = 10.0;
    return Values{regulator_pressure(itv0030, in.number("u_V"))};
  };
  q["mdot_iso6358"] = [](const Inputs& in) {
    const FlowPath path{in.number("C_m3_per_sPa"), in.number("b"), in.number("r_lam"), in.number("rho0_kgm3"),
                        in.number("T0_K")};
    return Values{mass_flow(path, in.number("p1_Pa"), in.number("p2_Pa"), in.number("T_K"))};
  };
  q["newton_of_lbf"] = [](const Inputs& in) {
    return Values{in.number("lbf") * parse_quantity("1 lbf", Dimension::force).value.value()};
  };
  q["metre_of_foot"] = [](const Inputs& in) {
    return Values{in.number("ft") * parse_quantity("1 ft", Dimension::length).value.value()};
  };
}

void add_prototypes(Quantities& q) {
  const auto rotation = [](const Posture& posture) { return rows(posture.tool().rotation); };
  q["proto1_transform"] = [](const Inputs& in) { return at(first(in), first_joints(in), transform); };
  q["proto1_rotation"] = [rotation](const Inputs& in) { return at(first(in), first_joints(in), rotation); };
  q["proto1_position_YZ"] = [](const Inputs& in) {
    return at(first(in), first_joints(in), [](const Posture& posture) {
      return Values{posture.tool().position.y(), posture.tool().position.z()};
    });
  };
  q["proto1_jacobian"] = [](const Inputs& in) {
    return at(first(in), first_joints(in),
              [](const Posture& posture) { return rows(slide_last(jacobian(posture))); });
  };
  q["proto1_velocity"] = [](const Inputs& in) {
    return at(first(in), first_joints(in),
              [&](const Posture& posture) { return rows(slide_last(jacobian(posture)) * in.vector("rates")); });
  };
  q["proto1_manipulability"] = [](const Inputs& in) {
    return at(first(in), first_joints(in),
              [](const Posture& posture) { return Values{dexterity(jacobian(posture)).manipulability}; });
  };

  const auto plain_jacobian = [](const Posture& posture) { return rows(jacobian(posture)); };
  q["proto2_transform"] = [](const Inputs& in) {
    return at(second(in), joints(in.list("theta_rad")), transform);
  };
  q["proto2_rotation"] = [rotation](const Inputs& in) {
    return at(second(in), joints(in.list("theta_rad")), rotation);
  };
  q["proto2_position_XY"] = [](const Inputs& in) {
    return at(second(in), joints(in.list("theta_rad")), [](const Posture& posture) {
      return Values{posture.tool().position.x(), posture.tool().position.y()};
    });
  };
  q["proto2_jacobian"] = [plain_jacobian](const Inputs& in) {
    return at(second(in), joints(in.list("theta_rad")), plain_jacobian);
  };

  q["proto3_transform"] = [](const Inputs& in) { return at(third(in), third_joints(in), transform); };
  q["proto3_rotation_elements"] = [](const Inputs& in) {
    return at(third(in), third_joints(in), [&](const Posture& posture) {
      Values values;
      for (const std::string& element : in.texts("elements")) {
        values.push_back(posture.tool().rotation(element.at(0) - '1', element.at(1) - '1'));
      }
      return values;
    });
  };
  q["proto3_position_Z"] = [](const Inputs& in) {
    return at(third(in), third_joints(in),
              [](const Posture& posture) { return Values{posture.tool().position.z()}; });
  };
  q["proto3_jacobian"] = [plain_jacobian](const Inputs& in) {
    return at(third(in), third_joints(in), plain_jacobian);
  };
  q["proto3_manipulability"] = [](const Inputs& in) {
    return at(third(in), third_joints(in),
              [](const Posture& posture) { return Values{dexterity(jacobian(posture)).manipulability}; });
  };
  q["proto3_torques"] = [](const Inputs& in) {
    return at(third(in), third_joints(in), [&](const Posture& posture) {
      return rows(torques_for_load(jacobian(posture), in.vector("F_N")));
    });
  };
  q["proto3_ik"] = [](const Inputs& in) {
    const Mechanism mechanism = third(in);
    const Pose tool{.position = in.vector("r_m")};
    const Solution one = solve_inverse(mechanism, tool);
    if (!one) throw Refusal(to_string(one.status));
    AngleRows solutions;
    for (const Solution& solution : solve_inverse_all(mechanism, tool)) {
      solutions.rows.push_back(rows(solution.posture->active().head(3)));
    }
    return solutions;
  };
  q["proto3_actuator_forces"] = [](const Inputs& in) {
    const std::array<double, 3> push = pushes(in);
    return Values(push.begin(), push.end());
  };
  q["proto3_pressures"] = [](const Inputs& in) {
    Values values;
    for (const double push : pushes(in)) {
      const ChamberPressures pressures = allocation(in).pressures(push);
      values.insert(values.end(), {pressures.rear, pressures.rod});
    }
    return values;
  };
}

}  // namespace

void add_pneumatic(Quantities& quantities) {
  add_cylinders(quantities);
  add_prototypes(quantities);
}

}  // namespace zwidth::reference
