// How large is the workspace, what fits in it, and what does it look like from above?
//
//   02_workspace [DEVICE]

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <string>

#include "zwidth/analysis/workspace.h"
#include "zwidth/description/read.h"

namespace {

// A plane as characters: a digit for the condition number where the tool can be, a dot where it cannot.
void print_map(const zwidth::SliceMap& map) {
  const std::vector<double>& condition = map.values[static_cast<int>(zwidth::Figure::condition_number)];
  for (int iv = map.nv - 1; iv >= 0; --iv) {
    std::string row;
    for (int iu = 0; iu < map.nu; ++iu) {
      const double value = condition[iv * map.nu + iu];
      // A character is twice as high as wide.
      row += std::string(
          2, std::isnan(value) ? '.' : static_cast<char>('0' + std::min(9, static_cast<int>(value))));
    }
    std::printf("  %s\n", row.c_str());
  }
}

}  // namespace

int main(int argc, char** argv) {
  using namespace zwidth;
  try {
    const Description device = read_description(argc > 1 ? argv[1] : "delta", {}, Catalogue::load());
    const Mechanism mechanism(device);
    if (const auto obstacle = workspace_obstacle(mechanism)) {
      std::printf("no workspace of %s: %s\n", device.name.c_str(), obstacle->c_str());
      return 1;
    }

    const bool in_plane = mechanism.tool_rows() == 2;
    const Extents extents = workspace_extents(mechanism);
    for (int axis = 0; axis < (in_plane ? 2 : 3); ++axis) {
      std::printf("%c from %7.1f to %6.1f mm\n", 'x' + axis, 1e3 * extents.range[axis].min,
                  1e3 * extents.range[axis].max);
    }
    const double size = workspace_volume(mechanism).value;
    in_plane ? std::printf("area %.1f cm2\n", 1e4 * size) : std::printf("volume %.3f litres\n", 1e3 * size);
    const InscribedShape cube = inscribed_shapes(mechanism).cube;
    std::printf("largest upright %s %.1f mm, centred at %.1f, %.1f, %.1f mm\n\n", in_plane ? "square" : "cube",
                1e3 * cube.size, 1e3 * cube.centre.x(), 1e3 * cube.centre.y(), 1e3 * cube.centre.z());

    std::printf("condition number from above, at the height of the cube's centre:\n");
    print_map(map_slice(mechanism, extents, 2, cube.centre.z(), 36, DriveLimits{}));
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
}
