#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// Parallel coordinates (Inselberg 1985), as inline SVG.

namespace zwidth {

/// One axis of the figure.
struct ParallelAxis {
  std::string name;
  std::string low, high;       ///< what stands at its ends
  std::vector<double> shares;  ///< of each line, 0 at the lower end, 1 at the upper
  bool strong = false;         ///< set apart from the others
};

/// One line for each entry of the axes' shares, `marked` among them drawn above the others. REQUIRES: two axes
/// or more, all with as many shares. `height`: of the axes; texts above and below add theirs.
std::string parallel_coordinates(double width, double height, const std::vector<ParallelAxis>& axes,
                                 std::optional<std::size_t> marked, std::string_view title);

}  // namespace zwidth
