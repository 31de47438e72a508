#pragma once

#include <optional>
#include <string>
#include <vector>

#include "context.h"
#include "model.h"

#include "zwidth/analysis/dexterity.h"
#include "zwidth/description/units.h"
#include "zwidth/mechanism/jacobian.h"
#include "zwidth/mechanism/singularity.h"

/// `zwidth at` answers in sections. Each is a function that writes one key of the JSON document, or a few that
/// belong together, and the lines that show them on the page. A new question is a new function and a row in the
/// table of section.cpp; `--only`, its suggestions and the order of the answer follow from that table.

namespace zwidth::at {

struct Arguments : DeviceArguments {
  std::string joints;
  std::string position;
  std::string orientation;
  std::string rotation;
  std::string keep;
  std::string near;
  std::string maximise;
  std::string load;
  std::string rate;
  std::string acceleration;
  std::string torque;
  std::string frame = "device";
  std::vector<std::string> only;
};

/// The values of one option, or InputError.
std::vector<double> option_values(const char* option, const std::string& text,
                                  const std::vector<Dimension>& dimensions);

/// The frame in which the user gives and reads tool vectors: the base frame, or the user's.
struct Frame {
  Matrix3 R = Matrix3::Identity();  ///< turns vectors of the base frame into this one
  /// Which components of (vx, vy, vz, wx, wy, wz) tool vectors have here: those of `Mechanism::tool_axes`, or,
  /// turned, all that these come to.
  std::vector<int> axes;
  ToolMatrix turn;  ///< from the mechanism's tool rows to these; its transpose leads back

  int linear() const;  ///< how many of the axes, the first ones, are linear
  /// "x", "y", "rz", ... of the axes.
  std::vector<std::string> names() const;
};
Frame frame_of(const Arguments& arguments, const Description& description, const Mechanism& mechanism);

/// A way of the tool that the posture loses or gains, in the user's frame; turning counts as the way of a point
/// at the characteristic length.
struct SingularWay {
  ToolVector direction;           ///< unit
  std::vector<std::string> legs;  ///< that bar a lost one
};

/// What is wrong with a posture's Jacobian, to within rounding: values that are only what rounding leaves of
/// zero must not be taken for figures.
struct Singularity {
  bool gains = false;             ///< the tool moves although every joint is held; J means nothing
  std::vector<SingularWay> free;  ///< along these, where the solvers see which; the freest first
  bool loses = false;             ///< the tool cannot move along `lost`, whatever the joints do
  std::vector<SingularWay> lost;
  std::vector<SingularWay> hardly;  ///< of a posture near a singularity: the ways it is about to lose
  std::vector<SingularWay> nearly;  ///< or to gain
};

/// One posture, and what the user asks of it. Tool vectors and the Jacobian are in the user's frame.
struct Situation {
  Situation(const Model& model, const Arguments& arguments, const Frame& frame, const Solution& solution);

  const Model& model;
  const Mechanism& mechanism;
  const Posture& posture;
  bool degraded;  ///< near a singularity
  Frame frame;
  Rates rates;  ///< as the library gives them, in the base frame
  Jacobian J;   ///< with singular values that are rounding made zero
  Singularity singularity;
  std::optional<ToolVector> load;      ///< what the device exerts on the hand [N, N m]
  ActiveVector rate;                   ///< zero unless given
  ActiveVector acceleration;           ///< zero unless given
  bool moving = false;                 ///< a rate or an acceleration was given
  std::optional<ActiveVector> torque;  ///< what the drives give, to ask for the accelerations [N m, N]
};

/// The answer under construction: one JSON document, or one page.
class Answer {
 public:
  Answer(const Terminal& terminal, const std::vector<std::string>& only) : sheet_(terminal), only_(only) {}

  /// Whether the user wants any of these keys.
  bool wants(const std::string& key) const;

  void put(const std::string& key, Json value) { document_[key] = std::move(value); }
  /// Null, with the reason in `notes`.
  void undefined(const std::string& key, const std::string& reason);
  bool has(const std::string& key) const { return document_.contains(key); }

  /// Lines follow under this heading, which shows with the first of them.
  void begin(const std::string& heading);
  /// The page, to add lines to.
  Sheet& page();
  /// Names of the columns of the `cells` that follow, unless they stand there already.
  void columns(const std::vector<std::string>& names);
  void axes() { columns({"x", "y", "z"}); }
  /// A line for the linear part of a tool vector and one for its angular part, each under its axes, where there
  /// are any.
  void tool_vector(const Frame& frame, const ToolVector& values, std::string_view linear, double linear_factor,
                   std::string_view angular, double angular_factor, std::string_view note = {});
  /// A line of cells: `values` times `factor`; values that are rounding beside the largest are zeros.
  void cells(std::string_view label, const Eigen::Ref<const Eigen::VectorXd>& values, double factor,
             std::string_view note = {}, int digits = 4, double rounding = 1e-13);
  void cell(std::string_view label, double value, std::string_view note = {});

  std::string text() const { return sheet_.text(); }
  /// Device, status, and what was asked for.
  Json document() const;

 private:
  Sheet sheet_;
  std::vector<std::string> only_;
  Json document_;
  Json notes_;
  std::string heading_;                     // that lines belong to
  std::string shown_heading_;               // last one on the page
  std::vector<std::string> shown_columns_;  // since then
};

struct Section {
  const char* heading;            ///< on the page; neighbours with the same one share it
  std::vector<const char*> keys;  ///< of the JSON document
  void (*write)(const Situation&, Answer&);
  bool needs_rates = false;         ///< means nothing where the tool gains a freedom
  const char* otherwise = nullptr;  ///< why its keys may be absent
};

/// In the order of the answer.
const std::vector<Section>& sections();
/// Writes those that the user wants.
void write_sections(const Situation& situation, Answer& answer);
/// InputError where --only names a key that is not there.
void check_only(const std::vector<std::string>& only);

// kinematics.cpp
void write_joints(const Situation&, Answer&);
void write_tool_axes(const Situation&, Answer&);
void write_position(const Situation&, Answer&);
void write_orientation(const Situation&, Answer&);
void write_jacobian(const Situation&, Answer&);
void write_singularity(const Situation&, Answer&);
void write_motion(const Situation&, Answer&);
// dexterity.cpp
void write_dexterity(const Situation&, Answer&);
void write_ellipsoids(const Situation&, Answer&);
// forces.cpp
void write_gravity(const Situation&, Answer&);
void write_torques(const Situation&, Answer&);
void write_force_limits(const Situation&, Answer&);
// cylinders.cpp
void write_cylinders(const Situation&, Answer&);
// inertia.cpp
void write_mass_matrix(const Situation&, Answer&);
void write_point_mass(const Situation&, Answer&);
void write_cartesian_mass(const Situation&, Answer&);
void write_resolution(const Situation&, Answer&);
// acceleration.cpp
void write_drive_inertia(const Situation&, Answer&);
void write_apparent_mass(const Situation&, Answer&);
void write_dynamic_manipulability(const Situation&, Answer&);
void write_acceleration_limits(const Situation&, Answer&);
void write_power(const Situation&, Answer&);
void write_accelerations(const Situation&, Answer&);
void write_energy(const Situation&, Answer&);
// stiffness.cpp
void write_stiffness(const Situation&, Answer&);
void write_deflection(const Situation&, Answer&);
void write_stiffness_indices(const Situation&, Answer&);
void write_loaded(const Situation&, Answer&);
void write_compliance_shares(const Situation&, Answer&);
void write_natural_frequencies(const Situation&, Answer&);

/// "10.000°" or "1.2345 mm".
std::string joint_text(const Mechanism& mechanism, int joint, double value);
bool slides(const Mechanism& mechanism, int joint);
/// What the rows and columns of the Jacobian are measured in.
JacobianUnits units_of(const Situation& at);
/// What efforts and inertias of the active joints are shown in: joints that turn, joints that slide, or some of
/// both.
struct JointUnits {
  const char* effort_name;  ///< "torque"
  const char* effort;       ///< "mN m"
  double effort_factor;     ///< from SI
  const char* inertia;
  double inertia_factor;
};
JointUnits joint_units(const Mechanism& mechanism);
/// "0.577, 0.577, 0.577".
std::string direction_text(const ToolVector& direction);

}  // namespace zwidth::at
