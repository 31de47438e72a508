#pragma once

#include <string>
#include <vector>

#include "context.h"
#include "model.h"
#include "sheet_json.h"

#include "zwidth/analysis/conditioning.h"
#include "zwidth/mechanism/plane_figure.h"

/// Parts of the verb `workspace`, which looks different for tools in space and in a plane.

namespace zwidth {

struct WorkspaceArguments : DeviceArguments {
  std::string grid = "1mm";
  bool grid_given = false;
  std::string against;
  std::string map;
  std::string figure;
  bool all = false;
};

inline bool in_plane(const Mechanism& mechanism) {
  return mechanism.platform() == PlatformFreedom::planar_translation;
}

/// The verb for a tool in a plane. REQUIRES: !workspace_obstacle(model.mechanism).
int plane_workspace(const WorkspaceArguments& arguments, const Model& model, double spacing,
                    const Terminal& terminal);

/// `figures` and `notes` of the document, and a row of text per figure.
void read_figures(const LatticeSweep& sweep, int dimension, bool all, bool driven, Json& document,
                  std::vector<std::vector<std::string>>& rows);
void print_conditioning(const GlobalConditioning& conditioning, int dimension, Sheet& sheet);

/// The start of a gnuplot script that writes `path` (.svg, .png, .pdf), its size in pixels of an SVG. Throws
/// MachineError if the file cannot be written.
std::string gnuplot_terminal(const std::string& path, double width, double height);
std::string gnuplot_palette();
/// A data block of one figure of a slice, and one of its outlines [mm].
std::string gnuplot_block(const SliceMap& map, Figure figure, const std::string& name);
std::string gnuplot_outlines(const Slice& slice, const std::string& name);

}  // namespace zwidth
