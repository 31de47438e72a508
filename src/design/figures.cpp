#include "zwidth/design/figures.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "zwidth/actuation/arm_cylinder.h"
#include "zwidth/actuation/drive_problems.h"
#include "zwidth/analysis/balance.h"
#include "zwidth/analysis/data_sheet.h"
#include "zwidth/analysis/five_bar_search.h"
#include "zwidth/analysis/force.h"
#include "zwidth/analysis/joint_torque.h"
#include "zwidth/analysis/mechanical.h"
#include "zwidth/analysis/posture_sweep.h"
#include "zwidth/analysis/resolution.h"
#include "zwidth/analysis/sizing.h"
#include "zwidth/analysis/workspace.h"
#include "zwidth/description/validate.h"
#include "zwidth/mechanism/beam_link.h"
#include "zwidth/mechanism/dynamics.h"
#include "zwidth/mechanism/vibration.h"

namespace zwidth {
namespace {

constexpr double kUndefined = std::numeric_limits<double>::quiet_NaN();

// ------------------------------------------------------------------------------------------------ postures

// A singular posture has no finite condition number.
double finite_or_undefined(double value) {
  return std::isfinite(value) ? value : kUndefined;
}

double condition_number(PostureFigures& at, const FigureOptions&) {
  return finite_or_undefined(at.dexterity().condition_number);
}
double inverse_condition(PostureFigures& at, const FigureOptions&) {
  return 1.0 / at.dexterity().condition_number;
}
double manipulability(PostureFigures& at, const FigureOptions&) {
  return at.dexterity().manipulability;
}
double min_singular_value(PostureFigures& at, const FigureOptions&) {
  return at.dexterity().min_singular_value;
}
double max_singular_value(PostureFigures& at, const FigureOptions&) {
  return at.dexterity().max_singular_value;
}
double closure(PostureFigures& at, const FigureOptions&) {
  return at.rates().closure;
}
template <int axis>
double position(PostureFigures& at, const FigureOptions&) {
  return at.posture().tool().position[axis];
}

Jacobian linear_rows(PostureFigures& at) {
  return at.rates().tool.topRows(at.device().mechanism().linear_rows());
}

ForcePolytope forces(PostureFigures& at, bool peak) {
  const BuiltDevice& device = at.device();
  const TorqueRange range =
      torque_range(device.drives(), device.pneumatic_drives(), at.posture().active(), peak);
  return force_polytope(linear_rows(at), range);
}
double force_min(PostureFigures& at, const FigureOptions&) {
  return forces(at, false).weakest;
}
double force_max(PostureFigures& at, const FigureOptions&) {
  return finite_or_undefined(forces(at, false).strongest);
}
double peak_force_min(PostureFigures& at, const FigureOptions&) {
  return forces(at, true).weakest;
}

double gravity_torque(PostureFigures& at, const FigureOptions&) {
  return gravity_torques(at.posture(), at.rates()).cwiseAbs().maxCoeff();
}

// A load on the tool is held by pushing back.
ActiveVector holding_torques(PostureFigures& at, const FigureOptions& options) {
  const Mechanism& mechanism = at.device().mechanism();
  ToolVector load(mechanism.tool_rows());
  for (int r = 0; r < load.size(); ++r) {
    load[r] = options.load[mechanism.tool_axes()[static_cast<std::size_t>(r)]];
  }
  return gravity_torques(at.posture(), at.rates()) - torques_for_load(at.rates().tool, load);
}
double load_torque(PostureFigures& at, const FigureOptions& options) {
  return holding_torques(at, options).cwiseAbs().maxCoeff();
}
double load_utilisation(PostureFigures& at, const FigureOptions& options) {
  const BuiltDevice& device = at.device();
  const ActiveVector torque = holding_torques(at, options);
  const TorqueRange range =
      torque_range(device.drives(), device.pneumatic_drives(), at.posture().active(), false);
  double worst = 0.0;
  for (int i = 0; i < torque.size(); ++i) {
    if (device.mechanism().is_free(i)) continue;
    worst = std::max(worst, std::abs(torque[i]) / std::abs(torque[i] > 0.0 ? range.max[i] : range.min[i]));
  }
  return finite_or_undefined(worst);
}

template <class Function>
double of_mass(PostureFigures& at, bool with_drives, Function function) {
  const std::optional<ToolMatrix>& mass = at.apparent_mass(with_drives);
  return mass ? function(*mass) : kUndefined;
}
double smallest(const ToolMatrix& matrix) {
  return Eigen::SelfAdjointEigenSolver<ToolMatrix>(matrix, Eigen::EigenvaluesOnly).eigenvalues()[0];
}
double largest(const ToolMatrix& matrix) {
  return Eigen::SelfAdjointEigenSolver<ToolMatrix>(matrix, Eigen::EigenvaluesOnly)
      .eigenvalues()[matrix.rows() - 1];
}
double determinant(const ToolMatrix& matrix) {
  return matrix.determinant();
}
template <bool with_drives, double (*of)(const ToolMatrix&)>
double mass_figure(PostureFigures& at, const FigureOptions&) {
  return of_mass(at, with_drives, of);
}

constexpr FigureOption kElastic[] = {
    {"drives", 1, Dimension::number,
     "0 takes the drives as rigid; else they give where their stiffness is known"}};
const std::optional<Compliance>& compliance_of(PostureFigures& at, const FigureOptions& options) {
  return at.compliance(options.get("drives", kElastic[0].otherwise) != 0.0);
}

// What the tool gives along its linear axes under pure forces, the tool turning as it likes.
std::optional<ToolMatrix> linear_compliance(PostureFigures& at, const FigureOptions& options) {
  const std::optional<Compliance>& compliance = compliance_of(at, options);
  if (!compliance) return std::nullopt;
  const Mechanism& mechanism = at.device().mechanism();
  const int n = mechanism.linear_rows();
  ToolMatrix C(n, n);
  for (int r = 0; r < n; ++r) {
    for (int c = 0; c < n; ++c) {
      C(r, c) = compliance->matrix(mechanism.tool_axes()[static_cast<std::size_t>(r)],
                                   mechanism.tool_axes()[static_cast<std::size_t>(c)]);
    }
  }
  return C;
}
double stiffness_min(PostureFigures& at, const FigureOptions& options) {
  const std::optional<ToolMatrix> C = linear_compliance(at, options);
  return C ? 1.0 / largest(*C) : kUndefined;
}
double stiffness_max(PostureFigures& at, const FigureOptions& options) {
  const std::optional<ToolMatrix> C = linear_compliance(at, options);
  return C ? finite_or_undefined(1.0 / smallest(*C)) : kUndefined;
}
double held_stiffness_determinant(PostureFigures& at, const FigureOptions&) {
  if (at.stiffness(false).rigid) return kUndefined;
  return stiffness_indices(at.stiffness(false).matrix).determinant_translation;
}
double stiffness_norm(PostureFigures& at, const FigureOptions&) {
  if (at.stiffness(false).rigid) return kUndefined;
  return stiffness_indices(at.stiffness(false).matrix).frobenius;
}
double deflection(PostureFigures& at, const FigureOptions& options) {
  const std::optional<Compliance>& compliance = compliance_of(at, options);
  return compliance ? (compliance->matrix * options.load).head<3>().norm() : kUndefined;
}
double tilt(PostureFigures& at, const FigureOptions& options) {
  const std::optional<Compliance>& compliance = compliance_of(at, options);
  return compliance ? (compliance->matrix * options.load).tail<3>().norm() : kUndefined;
}

// With the drives held: the links' mass on what gives way.
double natural_frequency(PostureFigures& at, const FigureOptions& options) {
  const Mechanism& mechanism = at.device().mechanism();
  const std::optional<Compliance>& compliance = compliance_of(at, options);
  if (!compliance) return kUndefined;
  const std::optional<ToolMatrix> K = felt_stiffness(mechanism, *compliance);
  if (!K || at.link_mass().llt().info() != Eigen::Success) return kUndefined;
  const auto found = modes_by_mobility(*K, tool_mobility(at.rates().tool, at.link_mass()));
  return found ? found->frequencies[0] / (2.0 * std::numbers::pi) : kUndefined;
}

double resolution(PostureFigures& at, const FigureOptions&) {
  const BuiltDevice& device = at.device();
  ActiveVector step = ActiveVector::Zero(device.mechanism().active_count());
  for (int i = 0; i < step.size(); ++i) {
    const auto j = static_cast<std::size_t>(i);
    if (device.drives()[j]) {
      step[i] = device.drives()[j]->angular_resolution();
    } else if (device.pneumatic_drives()[j] && device.pneumatic_drives()[j]->angular_resolution()) {
      step[i] = *device.pneumatic_drives()[j]->angular_resolution();
    } else if (!device.mechanism().is_free(i)) {
      return kUndefined;
    }
  }
  return posture_resolution(at.posture(), step).together.distance;
}

// ------------------------------------------------------------------------------------------------- devices

double total_mass(const BuiltDevice& device, const FigureOptions&) {
  return moving_mass(device.mechanism());
}

template <class Function>
double of_workspace(const BuiltDevice& device, Function function) {
  return workspace_obstacle(device.mechanism()) ? kUndefined : function(device.mechanism());
}
double volume(const BuiltDevice& device, const FigureOptions&) {
  return of_workspace(device, [](const Mechanism& m) { return workspace_volume(m, {.threads = 1}).value; });
}
double sphere_radius(const BuiltDevice& device, const FigureOptions&) {
  return of_workspace(device, [](const Mechanism& m) { return inscribed_shapes(m).sphere.size; });
}
double cube_edge(const BuiltDevice& device, const FigureOptions&) {
  return of_workspace(device, [](const Mechanism& m) { return inscribed_shapes(m).cube.size; });
}

// The worst of all electric drives; undefined without any.
template <class Function>
double over_drives(const BuiltDevice& device, bool smallest_counts, Function function) {
  double worst = kUndefined;
  for (const std::optional<Drive>& drive : device.drives()) {
    if (!drive) continue;
    const double value = function(*drive);
    if (std::isnan(worst) || (smallest_counts ? value < worst : value > worst)) worst = value;
  }
  return worst;
}
double continuous_torque(const BuiltDevice& device, const FigureOptions&) {
  return over_drives(device, true, [](const Drive& drive) { return drive.continuous_torque().usable; });
}
double peak_torque(const BuiltDevice& device, const FigureOptions&) {
  return over_drives(device, true, [](const Drive& drive) { return drive.peak_torque().usable; });
}
double slip_torque(const BuiltDevice& device, const FigureOptions&) {
  return over_drives(device, true, [](const Drive& drive) {
    return drive.continuous_torque().slip.value_or(std::numeric_limits<double>::infinity());
  });
}
double joint_speed(const BuiltDevice& device, const FigureOptions&) {
  return over_drives(device, true, [](const Drive& drive) { return drive.speed().usable; });
}
double reflected_inertia(const BuiltDevice& device, const FigureOptions&) {
  return over_drives(device, false, [](const Drive& drive) { return drive.reflected_inertia(); });
}
double perceived_mass(const BuiltDevice& device, const FigureOptions&) {
  return over_drives(device, false,
                     [](const Drive& drive) { return drive.perceived_mass().value_or(kUndefined); });
}
double friction_torque(const BuiltDevice& device, const FigureOptions&) {
  return over_drives(device, false, [](const Drive& drive) { return drive.friction_torque(); });
}
double margin_utilisation(const BuiltDevice& device, const FigureOptions&) {
  return over_drives(device, false, [](const Drive& drive) {
    double worst = 0.0;
    for (const Margin& margin : drive.margins()) worst = std::max(worst, margin.utilisation.value_or(0.0));
    return worst;
  });
}

// The postures of the device file that close; empty if one does not, or there is none.
std::vector<Posture> named_postures(const BuiltDevice& device) {
  std::vector<Posture> postures;
  for (const PostureDescription& one : device.description().postures) {
    const ActiveVector active =
        Eigen::Map<const Eigen::VectorXd>(one.joints.data(), static_cast<Eigen::Index>(one.joints.size()));
    const Solution solution = solve_forward(device.mechanism(), active);
    if (!solution) return {};
    postures.push_back(*solution.posture);
  }
  return postures;
}

constexpr FigureOption kJoints[] = {
    {"first_joint", 0, Dimension::number, "of the active joints that count, from 0"},
    {"last_joint", 1000, Dimension::number, "of the active joints that count"}};
double demand_utilisation(const BuiltDevice& device, LoadKind kind, const FigureOptions& options) {
  std::vector<SizingPosture> postures;
  for (const Posture& posture : named_postures(device)) postures.push_back({"", posture});
  const std::vector<LoadDescription>& loads = device.description().loads;
  if (postures.empty() || loads.empty()) return kUndefined;
  const Capability capability = [&](const Posture& posture, LoadKind of) {
    return torque_range(device.drives(), device.pneumatic_drives(), posture.active(), of == LoadKind::peak);
  };
  double worst = kUndefined;
  const Sizing sizing = size_drives(postures, loads, capability);
  const std::vector<JointDemand>& demands = sizing.demands(kind);
  for (std::size_t i = 0; i < demands.size(); ++i) {
    const JointDemand& demand = demands[i];
    const auto joint = static_cast<double>(i);
    if (demand.posture < 0 || joint < options.get("first_joint", kJoints[0].otherwise) ||
        joint > options.get("last_joint", kJoints[1].otherwise)) {
      continue;
    }
    worst = std::isnan(worst) ? demand.utilisation : std::max(worst, demand.utilisation);
  }
  return worst;
}
double continuous_utilisation(const BuiltDevice& device, const FigureOptions& options) {
  return demand_utilisation(device, LoadKind::continuous, options);
}
double peak_utilisation(const BuiltDevice& device, const FigureOptions& options) {
  return demand_utilisation(device, LoadKind::peak, options);
}

constexpr FigureOption kSpread[] = {
    {"postures", 64, Dimension::number, "how many postures, spread evenly over the joint ranges"}};
double balance_torque(const BuiltDevice& device, const FigureOptions& options) {
  const auto count = static_cast<std::int64_t>(options.get("postures", kSpread[0].otherwise));
  double worst = kUndefined;
  for (std::int64_t i = 0; i < count; ++i) {
    const Solution solution = solve_forward(device.mechanism(), spread_posture(device.mechanism(), i));
    if (!solution) continue;
    const double torque = gravity_torques(*solution.posture).cwiseAbs().maxCoeff();
    worst = std::isnan(worst) ? torque : std::max(worst, torque);
  }
  return worst;
}

constexpr FigureOption kPolar[] = {
    {"limit", 5.0, Dimension::number, "of the condition number"},
    {"radius_step", 0.01, Dimension::length, "between the circles of points about the origin"},
    {"angle_step", 2.0 * std::numbers::pi / 180.0, Dimension::angle, "between points of a circle"}};
const FiveBarDescription* five_bar_of(const BuiltDevice& device) {
  return std::get_if<FiveBarDescription>(&device.description().mechanism);
}
// The points of the last sampling asked for on this thread: all designs of a study have the same.
const PolarPoints& points_of(const PolarSampling& sampling, double reach) {
  struct Kept {
    PolarSampling sampling;
    double reach = -1.0;
    PolarPoints points;
  };
  thread_local Kept kept;
  if (kept.sampling != sampling || reach > kept.reach) {
    kept = {sampling, 1.5 * reach, polar_points(sampling, 1.5 * reach)};
  }
  return kept.points;
}

double badly_conditioned_points(const BuiltDevice& device, const FigureOptions& options) {
  const FiveBarDescription* five_bar = five_bar_of(device);
  if (five_bar == nullptr) return kUndefined;
  const PolarSampling sampling{.radius_step = options.get("radius_step", kPolar[1].otherwise),
                               .angle_step = options.get("angle_step", kPolar[2].otherwise)};
  const bool valid = sampling.radius_step > 0.0 && sampling.angle_step > 0.0;
  if (!valid) return kUndefined;
  const FiveBarBatch::Count found = badly_conditioned(
      {.crank = five_bar->crank, .coupler = five_bar->coupler, .half_base = five_bar->half_base},
      {five_bar->left_mode, five_bar->right_mode}, points_of(sampling, five_bar->crank + five_bar->coupler),
      options.get("limit", kPolar[0].otherwise));
  return found.reachable > 0 ? static_cast<double>(found.above) : kUndefined;
}

constexpr FigureOption kCylinder[] = {
    {"drive", 0.0, Dimension::number, "which pneumatic drive, from 0"},
    {"load", 10.0, Dimension::force, "hung on the arm"},
    {"distance", 0.1, Dimension::length, "of the load from the arm's pivot"},
    {"range", 30.0 * std::numbers::pi / 180.0, Dimension::angle, "of the arm to either side"}};
const ArmCylinderDescription* mount_of(const BuiltDevice& device, const FigureOptions& options) {
  const auto index = static_cast<std::size_t>(std::max(0.0, options.get("drive", 0.0)));
  const auto& drives = device.description().pneumatic_drives;
  return index < drives.size() ? std::get_if<ArmCylinderDescription>(&drives[index].mount) : nullptr;
}
Interval range_of(const FigureOptions& options) {
  const double range = options.get("range", kCylinder[3].otherwise);
  return {-range, range};
}
double cylinder_peak_force(const BuiltDevice& device, const FigureOptions& options) {
  const ArmCylinderDescription* mount = mount_of(device, options);
  if (mount == nullptr) return kUndefined;
  const auto peak = ArmCylinder(*mount).peak_required_force(options.get("load", kCylinder[1].otherwise),
                                                            options.get("distance", kCylinder[2].otherwise),
                                                            range_of(options));
  return peak ? peak->force : kUndefined;
}
double cylinder_length(const BuiltDevice& device, const FigureOptions& options, bool longest) {
  const ArmCylinderDescription* mount = mount_of(device, options);
  if (mount == nullptr) return kUndefined;
  const ArmCylinder arm(*mount);
  const Interval range = range_of(options);
  if (!arm.keeps_direction(range)) return kUndefined;
  const double a = arm.length(range.min), b = arm.length(range.max);
  return longest ? std::max(a, b) : std::min(a, b);
}
double cylinder_length_min(const BuiltDevice& device, const FigureOptions& options) {
  return cylinder_length(device, options, false);
}
double cylinder_length_max(const BuiltDevice& device, const FigureOptions& options) {
  return cylinder_length(device, options, true);
}

using FD = FigureDefinition;

constexpr FD of_posture(std::string_view name, std::string_view unit, std::string_view meaning,
                        double (*of)(PostureFigures&, const FigureOptions&), bool needs_drives = false,
                        bool needs_load = false, std::span<const FigureOption> options = {}) {
  return {.name = name,
          .unit = unit,
          .meaning = meaning,
          .of_posture = true,
          .needs_drives = needs_drives,
          .needs_load = needs_load,
          .of = of,
          .options = options};
}
constexpr FD of_device(std::string_view name, std::string_view unit, std::string_view meaning,
                       double (*of)(const BuiltDevice&, const FigureOptions&), bool needs_drives = false,
                       std::span<const FigureOption> options = {}) {
  return {.name = name,
          .unit = unit,
          .meaning = meaning,
          .of_posture = false,
          .needs_drives = needs_drives,
          .of_device = of,
          .options = options};
}

constexpr bool kDrives = true;
constexpr bool kNoDrives = false;
constexpr bool kLoad = true;
constexpr bool kNoLoad = false;

}  // namespace

std::optional<BuiltDevice> BuiltDevice::try_make(const Description& description, bool with_drives) {
  if (!value_problems(description).empty() || !beam_problems(description).empty()) return std::nullopt;
  if (with_drives && !drive_problems(description).empty()) return std::nullopt;
  BuiltDevice device(description);
  if (!with_drives) return device;
  device.mechanism_ = mechanism_with_drives(description);
  device.drives_ = joint_drives(description, *device.mechanism_);
  device.pneumatic_drives_ = joint_pneumatic_drives(description, *device.mechanism_);
  return device;
}

const Mechanism& BuiltDevice::mechanism() const {
  if (!mechanism_) mechanism_.emplace(*description_);
  return *mechanism_;
}

const Rates& PostureFigures::rates() {
  if (!rates_) rates_ = zwidth::rates(*posture_);
  return *rates_;
}

const Dexterity& PostureFigures::dexterity() {
  if (!dexterity_) {
    // Rows of one kind: what the tool does along its linear axes, or of one that only turns, all.
    const int linear = device_->mechanism().linear_rows();
    dexterity_ = zwidth::dexterity(linear > 0 ? Jacobian(rates().tool.topRows(linear)) : rates().tool);
  }
  return *dexterity_;
}

const ActiveMatrix& PostureFigures::link_mass() {
  if (!link_mass_) {
    link_mass_ = mass_matrix(*posture_, rates());
    *link_mass_ -= ActiveMatrix(device_->mechanism().drive_inertia().asDiagonal());
  }
  return *link_mass_;
}

const std::optional<ToolMatrix>& PostureFigures::apparent_mass(bool with_drives) {
  std::optional<std::optional<ToolMatrix>>& kept = apparent_mass_[with_drives ? 1 : 0];
  if (!kept) {
    ActiveMatrix mass = link_mass();
    if (with_drives) mass += ActiveMatrix(device_->mechanism().drive_inertia().asDiagonal());
    const int linear = device_->mechanism().linear_rows();
    const Jacobian J = linear > 0 ? Jacobian(rates().tool.topRows(linear)) : rates().tool;
    kept.emplace();
    if (mass.llt().info() == Eigen::Success) *kept = cartesian_mass(J, mass);
  }
  return *kept;
}

const Stiffness& PostureFigures::stiffness(bool with_drives) {
  std::optional<Stiffness>& kept = stiffness_[with_drives ? 1 : 0];
  if (kept) return *kept;
  StiffnessOptions options;
  if (with_drives && !device_->drives().empty()) {
    options.drive_stiffness = drive_stiffness(*posture_, device_->drives());
  }
  kept = zwidth::stiffness(*posture_, options);
  return *kept;
}

const std::optional<Compliance>& PostureFigures::compliance(bool with_drives) {
  std::optional<std::optional<Compliance>>& kept = compliance_[with_drives ? 1 : 0];
  if (!kept) {
    kept.emplace();
    const Stiffness& K = stiffness(with_drives);
    if (!K.rigid) {
      Compliance found = zwidth::compliance(K, device_->mechanism().characteristic_length());
      if (!found.free) *kept = found;
    }
  }
  return *kept;
}

double FigureOptions::get(const std::string& name, double otherwise) const {
  const auto found = further.find(name);
  return found == further.end() ? otherwise : found->second;
}

std::span<const FigureDefinition> figure_definitions() {
  static constexpr FigureDefinition list[] = {
      of_posture("condition_number", "1", "largest over smallest singular value of the Jacobian",
                 condition_number),
      of_posture("inverse_condition", "1", "its inverse: 1 isotropic, 0 singular", inverse_condition),
      of_posture("manipulability", "SI", "product of the singular values of the Jacobian", manipulability),
      of_posture("min_singular_value", "SI", "smallest singular value of the Jacobian", min_singular_value),
      of_posture("max_singular_value", "SI", "largest singular value of the Jacobian", max_singular_value),
      of_posture("closure", "1", "reciprocal condition of the loop closure: 0 where the tool gains a freedom",
                 closure),
      of_posture("position_x", "m", "tool position along x", position<0>),
      of_posture("position_y", "m", "tool position along y", position<1>),
      of_posture("position_z", "m", "tool position along z", position<2>),
      of_posture("force_min", "N", "continuous force available in every direction", force_min, kDrives),
      of_posture("force_max", "N", "largest continuous force in any direction", force_max, kDrives),
      of_posture("peak_force_min", "N", "short-time force available in every direction", peak_force_min,
                 kDrives),
      of_posture("gravity_torque", "N m", "largest torque that holds the weight of the links", gravity_torque),
      of_posture("load_torque", "N m", "largest torque that holds a load on the tool and the weight",
                 load_torque, kNoDrives, kLoad),
      of_posture("load_utilisation", "1", "that torque over what the drive gives for ever, at worst",
                 load_utilisation, kDrives, kLoad),
      of_posture("apparent_mass_min", "kg", "apparent mass along the lightest direction, drives included",
                 mass_figure<true, smallest>, kDrives),
      of_posture("apparent_mass_max", "kg", "apparent mass along the heaviest direction, drives included",
                 mass_figure<true, largest>, kDrives),
      of_posture("apparent_mass_determinant", "kg^n", "determinant of the apparent mass, drives included",
                 mass_figure<true, determinant>, kDrives),
      of_posture("link_mass_min", "kg", "apparent mass of the links along the lightest direction",
                 mass_figure<false, smallest>),
      of_posture("link_mass_max", "kg", "apparent mass of the links along the heaviest direction",
                 mass_figure<false, largest>),
      of_posture("link_mass_determinant", "kg^n", "determinant of the apparent mass of the links",
                 mass_figure<false, determinant>),
      of_posture("stiffness_min", "N/m", "force per displacement along the softest direction", stiffness_min,
                 kDrives, kNoLoad, kElastic),
      of_posture("stiffness_max", "N/m", "force per displacement along the stiffest direction", stiffness_max,
                 kDrives, kNoLoad, kElastic),
      of_posture("held_stiffness_determinant", "(N/m)^3",
                 "determinant of the links' translational stiffness with the tool kept from turning",
                 held_stiffness_determinant),
      of_posture("stiffness_norm", "mixed", "Frobenius norm of the whole stiffness matrix of the links",
                 stiffness_norm),
      of_posture("deflection", "m", "displacement of the tool under a load", deflection, kDrives, kLoad,
                 kElastic),
      of_posture("tilt", "rad", "rotation of the tool under a load", tilt, kDrives, kLoad, kElastic),
      of_posture("natural_frequency", "Hz", "lowest natural frequency with the drives held", natural_frequency,
                 kDrives, kNoLoad, kElastic),
      of_posture("resolution", "m", "largest tool step when every joint moves by its encoder's step",
                 resolution, kDrives),
      of_device("moving_mass", "kg", "mass of all bodies", total_mass),
      of_device("workspace_volume", "m^n", "volume of the workspace, or its area in a plane", volume),
      of_device("inscribed_radius", "m", "radius of the largest sphere, or circle, in the workspace",
                sphere_radius),
      of_device("inscribed_edge", "m", "edge of the largest cube, or square, in the workspace", cube_edge),
      of_device("continuous_torque", "N m", "joint torque for ever, of the weakest drive", continuous_torque,
                kDrives),
      of_device("peak_torque", "N m", "joint torque for a short time, of the weakest drive", peak_torque,
                kDrives),
      of_device("slip_torque", "N m", "joint torque at which a cable slips, of the weakest drive", slip_torque,
                kDrives),
      of_device("joint_speed", "rad/s", "fastest joint speed, of the slowest drive", joint_speed, kDrives),
      of_device("reflected_inertia", "kg m^2", "inertia of a drive felt at its joint, the largest",
                reflected_inertia, kDrives),
      of_device("perceived_mass", "kg", "mass of a drive felt at its output's radius, the largest",
                perceived_mass, kDrives),
      of_device("friction_torque", "N m", "friction of a motor felt at its joint, the largest", friction_torque,
                kDrives),
      of_device("margin_utilisation", "1", "demand over capability, the largest of all rules of the drives",
                margin_utilisation, kDrives),
      of_device("continuous_utilisation", "1",
                "torque of the continuous loads in the named postures over what the drives give, the largest",
                continuous_utilisation, kDrives, kJoints),
      of_device("peak_utilisation", "1", "the same of the peak loads", peak_utilisation, kDrives, kJoints),
      of_device("balance_torque", "N m", "largest torque of the links' weight over the joint ranges",
                balance_torque, kNoDrives, kSpread),
      of_device("badly_conditioned_points", "1",
                "of a five-bar, sampled points with a condition number above the limit",
                badly_conditioned_points, kNoDrives, kPolar),
      of_device("cylinder_peak_force", "N", "largest cylinder force that lifts a load over the arm's range",
                cylinder_peak_force, kNoDrives, kCylinder),
      of_device("cylinder_length_min", "m", "shortest distance of the cylinder's pins over the arm's range",
                cylinder_length_min, kNoDrives, kCylinder),
      of_device("cylinder_length_max", "m", "longest distance of the cylinder's pins over the arm's range",
                cylinder_length_max, kNoDrives, kCylinder),
  };
  return list;
}

const FigureDefinition* find_figure(std::string_view name) {
  for (const FigureDefinition& figure : figure_definitions()) {
    if (figure.name == name) return &figure;
  }
  return nullptr;
}

double figure_value(const FigureDefinition& figure, PostureFigures& posture, const FigureOptions& options) {
  return figure.of_posture ? figure.of(posture, options) : figure.of_device(posture.device(), options);
}

double figure_value(const FigureDefinition& figure, const BuiltDevice& device, const FigureOptions& options) {
  return figure.of_posture ? kUndefined : figure.of_device(device, options);
}

}  // namespace zwidth
