#pragma once

#include <string>
#include <string_view>
#include <vector>

/// What every figure shares: its style, colours, ticks and text as inline SVG. Colours that must follow the
/// page's light or dark theme are CSS classes (`figure_style`), colours that carry a value are written out.

namespace zwidth {

struct Point2 {
  double x = 0.0;
  double y = 0.0;
};

/// CSS for the classes that figures use: inside a page it follows the theme.
std::string_view figure_style();

/// `text` with the characters that HTML and SVG reserve written as entities.
std::string escaped(std::string_view text);

/// Colour "#rrggbb" of a share 0..1 on a perceptually even dark-to-light scale.
std::string map_colour(double share);

/// Round values that divide a range into about `count` steps.
std::vector<double> round_ticks(double min, double max, int count);

/// A coordinate in pixels, to a tenth.
std::string pixel(double value);

}  // namespace zwidth
