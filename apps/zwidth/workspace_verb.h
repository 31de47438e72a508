#pragma once

#include <atomic>
#include <mutex>
#include <string>
#include <vector>

#include "context.h"
#include "model.h"
#include "sheet_arm.h"
#include "sheet_json.h"
#include "terminal.h"

#include "zwidth/analysis/conditioning.h"
#include "zwidth/analysis/mechanical.h"
#include "zwidth/analysis/reach_shapes.h"
#include "zwidth/mechanism/plane_figure.h"

/// Parts of the verb `workspace`, which looks different for tools in space and in a plane.

namespace zwidth {

struct WorkspaceArguments : DeviceArguments {
  std::string grid;  ///< empty: one that suits
  std::string against;
  std::string map;
  std::string figure;
  std::string position;
  std::string of = "condition_number";
  std::string orientation, rotation;
  bool all = false;
};

/// How far an answer of several stages is, from any thread.
class StagedProgress {
 public:
  explicit StagedProgress(const std::atomic<bool>* cancel) : cancel_(cancel), progress_("workspace", "%") {}

  /// For the next stage, which takes `share` of the time of all.
  Effort next(double share);

 private:
  const std::atomic<bool>* cancel_;
  Progress progress_;
  std::mutex mutex_;
  double done_ = 0.0;
};

inline bool in_plane(const Mechanism& mechanism) {
  return mechanism.platform() == PlatformFreedom::planar_translation;
}

/// Two devices on common cells; `spacing` 0: one that suits both. Throws InputError if they cannot be compared.
int compare(const WorkspaceArguments& arguments, const Model& model, double spacing, const Terminal& terminal);

/// What the hand alone moves does not decide where a tool that is a point can be.
Description without_hand_joints(const Description& description);

/// The verb for a tool in a plane. `asked` 0: one that suits. REQUIRES: !workspace_obstacle(model.mechanism).
int plane_workspace(const WorkspaceArguments& arguments, const Model& model, double asked,
                    const Terminal& terminal);

/// The verb for an arm whose tool turns. `spacing` 0: one that fits. REQUIRES:
/// !reach_obstacle(model.mechanism).
int arm_workspace(const WorkspaceArguments& arguments, const Model& model, double spacing,
                  const Terminal& terminal);

/// The verb for a platform on several legs that turns. `spacing` 0: one that fits. REQUIRES:
/// !pose_workspace_obstacle(model.mechanism).
int platform_workspace(const WorkspaceArguments& arguments, const Model& model, double spacing,
                       const Terminal& terminal);

/// How the tool of an arm can be turned; nothing for others.
struct Turning {
  std::optional<OrientationWorkspace> orientations;
  std::optional<PlaceOrientations> place;  ///< --position, or the home posture's
};
/// Throws InputError if --position makes no sense.
Turning turning_of(const WorkspaceArguments& arguments, const Mechanism& mechanism,
                   std::optional<OrientationWorkspace> orientations);
void write_turning(const Turning& turning, Json& document);
void print_turning(const Turning& turning, Sheet& sheet);

/// `figures` and `notes` of the document, and a row of text per figure.
void read_figures(const LatticeSweep& sweep, const Mechanism& mechanism, bool all, bool driven, Json& document,
                  std::vector<std::vector<std::string>>& rows);
/// With where the condition number is least.
void print_conditioning(const GlobalConditioning& conditioning, const Statistic& condition_number, bool plane,
                        Sheet& sheet);
/// A lattice without a point in the workspace answers nothing: throws InputError with its size.
void refuse_wide_lattice(const WorkspaceArguments& arguments, const LatticeSweep& sweep, const Extents& extents,
                         bool plane);
/// What `--of` asks to draw: a figure of the Jacobian or a mechanical one.
struct Drawn {
  bool mechanical = false;
  int index = 0;      ///< of the figure
  std::string title;  ///< with its unit
  double factor = 1.0;
};
/// InputError if there is no such figure, or none for the device.
Drawn drawn_of(const WorkspaceArguments& arguments, const Model& model);
/// Its values on a cut, in the order of the grid.
std::vector<double> drawn_values(const Drawn& drawn, const Model& model, const SliceMap& map);
/// Of the values on all cuts, without the few near singularities.
Interval drawn_range(const std::vector<std::vector<double>>& cuts);
/// Throws InputError if what `--figure --of` asks for has no value on any of the cuts: it is not known of the
/// device.
void refuse_unknown_figure(const WorkspaceArguments& arguments, const Drawn& drawn, const Model& model,
                           const std::vector<std::vector<double>>& cuts, const SliceMap& map,
                           const MechanicalSweep& mechanics);
/// A coarse lattice, so that it takes a moment.
MechanicalSweep mechanics_of(const Model& model, const Extents& extents, double spacing, const Effort& effort);

/// As .npy or .csv, by the name. Throws MachineError.
void write_map(const WorkspaceMap& map, const std::string& path);

/// The start of a gnuplot script that writes `path` (.svg, .png, .pdf), its size in pixels of an SVG. Throws
/// MachineError if the file cannot be written.
std::string gnuplot_terminal(const std::string& path, double width, double height);
std::string gnuplot_palette();
/// Commands that draw a cut with its conditioning into the next panel; `number` makes its names unique.
std::string gnuplot_cut(const ReachSlice& cut, int number);
/// A data block of values on a grid, row after row, and one of a slice's outlines [mm].
std::string gnuplot_block(const std::vector<double>& values, int columns, const std::string& name);
std::string gnuplot_outlines(const Slice& slice, const std::string& name);

}  // namespace zwidth
