#pragma once

#include <string>
#include <string_view>
#include <vector>

/// Bars to both sides of a line, one below the other: what each of several changes does to one number. As
/// inline SVG.

namespace zwidth {

struct TornadoBar {
  std::string name;   ///< what is changed
  std::string note;   ///< and by how much; may be empty
  double change = 0;  ///< how far the bar goes, to the right if positive; NaN draws none
  std::string text;   ///< the same in words, at the bar's end
  bool better = false;
};

/// In the order given, all to one scale. Names that are too long for their column end in dots.
std::string tornado(double width, const std::vector<TornadoBar>& bars, std::string_view title);

}  // namespace zwidth
