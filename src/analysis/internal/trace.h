#pragma once

#include <algorithm>
#include <unordered_map>
#include <vector>

#include "zwidth/analysis/workspace.h"

namespace zwidth::internal {

/// A line from grid point (iu, iv) to its right neighbour, or to its upper one.
struct GridLine {
  int iu = 0, iv = 0;
  bool up = false;
};

/// Closed outlines of a region on a grid of nu x nv points by marching squares, the region on their left; holes
/// run the other way round.
///
/// `inside(iu, iv)` tells whether a point belongs to it, `joined(iu, iv)` whether two opposite corners of the
/// cell right and above of (iu, iv) are joined across its middle, and `crossing(line)` where an outline crosses
/// a grid line. REQUIRES: no point on the rim of the grid is inside.
template <class Inside, class Joined, class Crossing>
std::vector<Outline> trace_outlines(int nu, int nv, const Inside& inside, const Joined& joined,
                                    const Crossing& crossing) {
  const auto number = [nu](int iu, int iv, bool up) { return 2 * (iv * nu + iu) + (up ? 1 : 0); };
  std::unordered_map<int, int> next;  // the grid line that follows a grid line on its outline
  for (int iv = 0; iv + 1 < nv; ++iv) {
    for (int iu = 0; iu + 1 < nu; ++iu) {
      const bool corner[4] = {inside(iu, iv), inside(iu + 1, iv), inside(iu + 1, iv + 1), inside(iu, iv + 1)};
      const int lines[4] = {number(iu, iv, false), number(iu + 1, iv, true), number(iu, iv + 1, false),
                            number(iu, iv, true)};
      // Going round the cell counter-clockwise, runs of inside corners begin at `enter` and end at `leave`.
      int enter[2], leave[2], enters = 0, leaves = 0;
      for (int e = 0; e < 4; ++e) {
        const bool from = corner[e], to = corner[(e + 1) % 4];
        if (!from && to) enter[enters++] = lines[e];
        if (from && !to) leave[leaves++] = lines[e];
      }
      if (enters == 1) next[leave[0]] = enter[0];
      if (enters == 2) {
        // Two opposite corners inside. `enter` and `leave` alternate; a run that begins at enter[0] ends at
        // leave[0] unless the walk began inside.
        const bool across = joined(iu, iv);
        const int shift = corner[0] ? 1 : 0;
        next[leave[shift]] = enter[across ? 1 : 0];
        next[leave[1 - shift]] = enter[across ? 0 : 1];
      }
    }
  }
  std::vector<Outline> outlines;
  while (!next.empty()) {
    Outline outline;
    const int first = std::ranges::min_element(next, {}, [](const auto& link) { return link.first; })->first;
    int following = first;
    for (auto link = next.find(first); link != next.end(); link = next.find(following)) {
      const int start = link->first / 2;
      outline.push_back(crossing(GridLine{start % nu, start / nu, link->first % 2 == 1}));
      following = link->second;
      next.erase(link);
    }
    if (outline.size() > 2) outlines.push_back(std::move(outline));
  }
  return outlines;
}

/// Area within outlines, holes taken off.
inline double enclosed_area(const std::vector<Outline>& outlines) {
  double area = 0.0;
  for (const Outline& outline : outlines) {
    for (std::size_t p = 0; p < outline.size(); ++p) {
      const auto& a = outline[p];
      const auto& b = outline[(p + 1) % outline.size()];
      area += 0.5 * (a[0] * b[1] - a[1] * b[0]);
    }
  }
  return area;
}

}  // namespace zwidth::internal
