#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "zwidth/math/spatial.h"

/// Text for people: what an output can show, and sheets of headings, rows and tables that fit its width.

namespace zwidth {

/// What an output can show.
struct Terminal {
  bool interactive = false;  ///< a person is watching
  bool colour = false;       ///< a terminal, and NO_COLOR is not set
  bool unicode = false;      ///< the locale's characters are UTF-8
  int width = 80;            ///< columns, 60..160
};

/// What file descriptor `fd` can show. COLUMNS overrides the width of a terminal; anything else has 80 columns.
Terminal detect_terminal(int fd);

enum class Tint { none, bold, dim, good, warning, bad, accent };

/// `text` in a tint, or as it is where there is no colour.
std::string tinted(const Terminal& terminal, Tint tint, std::string_view text);

/// Columns that UTF-8 `text` takes, escape sequences left out.
int columns(std::string_view text);

/// `text` in lines of at most `width` columns, broken between words; a longer word stands alone.
std::vector<std::string> wrapped(std::string_view text, int width);

/// UTF-8 typography (dashes, degree signs, superscripts, Greek) spelled in ASCII.
std::string spelled_in_ascii(std::string_view text);

/// A page of text under construction. Give it UTF-8; `text()` spells it in ASCII where the terminal needs that.
class Sheet {
 public:
  explicit Sheet(const Terminal& terminal) : terminal_(terminal) {}

  void title(std::string_view left, std::string_view right = {});
  void heading(std::string_view text);
  /// One "label  value  note" line; a long note goes on below itself.
  void row(std::string_view label, std::string_view value, std::string_view note = {});
  /// A label, cells of ten columns each, right-aligned, and a note where the width allows one.
  void cells(std::string_view label, const std::vector<std::string>& cells, std::string_view note = {});
  /// Columns after the first align right when `numeric`; widths follow the contents. `marks` tints whole lines.
  void table(const std::vector<std::string>& head, const std::vector<std::vector<std::string>>& rows,
             bool numeric = true);
  void paragraph(std::string_view text, int indent = 2, Tint tint = Tint::none);
  void line(std::string_view text);
  void gap();

  const Terminal& terminal() const { return terminal_; }
  std::string text() const { return terminal_.unicode ? text_ : spelled_in_ascii(text_); }

 private:
  /// Columns of the text as it will be printed.
  int width_of(std::string_view text) const;
  /// Measured as it will be printed.
  std::vector<std::string> wrapped(std::string_view text, int width) const;

  Terminal terminal_;
  std::string text_;
};

/// A progress bar with rate and time left on a terminal, a line now and then elsewhere. Writes to stderr.
class Progress {
 public:
  Progress(std::string what, std::string unit);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// So much was done before this run: part of the share that is done, not of the rate.
  void go_on_from(double done) { before_ = done; }

  /// `done` of `total` units are done; `note` says more. Cheap to call often.
  void update(double done, double total, std::string_view note = {});

 private:
  std::string what_;
  std::string unit_;
  Terminal terminal_;
  double start_;
  double last_;
  double before_ = 0.0;
  bool drawn_ = false;
};

/// "1.234 mm": `value` times `factor` with `digits` significant digits, no exponent between 1e-4 and 1e7.
std::string quantity(double value, double factor, std::string_view unit, int digits = 4);
/// The number alone, with as many significant digits; "not given" for NaN. `trimmed` leaves out zeros at its
/// end.
std::string number(double value, int digits = 4);
std::string trimmed(double value, int digits = 6);
/// "(x, y, z) mm" of a position [m].
std::string point_text(const Vector3& position);
/// "(x, y) mm" of a position [m].
std::string plane_point_text(const Vector3& position);
/// "min … max unit".
std::string interval(double min, double max, double factor, std::string_view unit, int digits = 4);

/// The unit in which people read numbers of a size, and what SI values are multiplied with for it.
struct ReadableUnit {
  double factor = 1.0;
  std::string text;  ///< may be empty
};
ReadableUnit readable_unit(double magnitude, std::string_view si_unit);

/// An SI value in the unit that people use for its size: 0.0612, "m" gives "61.2 mm".
std::string readable(double value, std::string_view si_unit, int digits = 4);

inline constexpr double kMilli = 1e3;                      ///< SI to thousandths
inline constexpr double kDegrees = 57.295779513082320877;  ///< rad to deg

}  // namespace zwidth
