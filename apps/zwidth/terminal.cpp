#include "terminal.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <fmt/format.h>
#include <langinfo.h>
#include <span>
#include <sys/ioctl.h>
#include <unistd.h>
#include <utility>

namespace zwidth {

namespace {

constexpr int kLabel = 32;  // columns for the label in front of cells

double now() {
  using namespace std::chrono;
  return duration<double>(steady_clock::now().time_since_epoch()).count();
}

bool set_and_not_empty(const char* name) {
  const char* value = std::getenv(name);
  return value != nullptr && *value != '\0';
}

std::string spaces(int count) {
  return std::string(static_cast<size_t>(std::max(0, count)), ' ');
}

std::string repeated(std::string_view text, int count) {
  std::string result;
  for (int i = 0; i < count; ++i) result += text;
  return result;
}

}  // namespace

Terminal detect_terminal(int fd) {
  Terminal terminal;
  // A launcher gives its first rank a terminal of its own making, wherever its own output goes.
  const bool launched = set_and_not_empty("OMPI_COMM_WORLD_SIZE") || set_and_not_empty("PMI_SIZE") ||
                        set_and_not_empty("PMIX_RANK");
  terminal.interactive = isatty(fd) == 1 && !launched;
  const char* kind = std::getenv("TERM");
  const bool dumb = kind != nullptr && std::strcmp(kind, "dumb") == 0;
  terminal.colour = terminal.interactive && !dumb && !set_and_not_empty("NO_COLOR");
  terminal.unicode = std::strcmp(nl_langinfo(CODESET), "UTF-8") == 0;
  int width = 0;
  if (const char* columns_variable = std::getenv("COLUMNS")) width = std::atoi(columns_variable);
  winsize size{};
  if (width <= 0 && terminal.interactive && ioctl(fd, TIOCGWINSZ, &size) == 0) width = size.ws_col;
  if (width <= 0) width = 80;
  terminal.width = std::clamp(width, 60, 160);
  return terminal;
}

std::string tinted(const Terminal& terminal, Tint tint, std::string_view text) {
  if (!terminal.colour || tint == Tint::none || text.empty()) return std::string(text);
  const char* code = "0";
  switch (tint) {
    case Tint::none:
      break;
    case Tint::bold:
      code = "1";
      break;
    case Tint::dim:
      code = "2";
      break;
    case Tint::good:
      code = "32";
      break;
    case Tint::warning:
      code = "33";
      break;
    case Tint::bad:
      code = "31";
      break;
    case Tint::accent:
      code = "1;36";
      break;
  }
  return fmt::format("\x1b[{}m{}\x1b[0m", code, text);
}

int columns(std::string_view text) {
  int count = 0;
  for (size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '\x1b') {
      while (i < text.size() && text[i] != 'm') ++i;
      continue;
    }
    if ((static_cast<unsigned char>(text[i]) & 0xC0) != 0x80) ++count;
  }
  return count;
}

std::string spelled_in_ascii(std::string_view text) {
  static const std::pair<std::string_view, std::string_view> kSpellings[] = {
      {"─", "-"},      {"━", "="},     {"│", "|"},   {"·", "."},  {"•", "*"},  {"…", ".."},    {"–", "-"},
      {"—", "-"},      {"−", "-"},     {"°", "deg"}, {"²", "^2"}, {"³", "^3"}, {"µ", "u"},     {"μ", "u"},
      {"Ω", "ohm"},    {"±", "+-"},    {"×", "x"},   {"≤", "<="}, {"≥", ">="}, {"→", "->"},    {"√", "sqrt "},
      {"τ", "tau"},    {"θ", "theta"}, {"✓", "ok"},  {"✗", "no"}, {"▲", "!"},  {"█", "#"},     {"░", "."},
      {"″", "arcsec"}, {"‑", "-"},     {"“", "\""},  {"”", "\""}, {"’", "'"},  {"σ", "sigma"}, {"η", "eta"},
      {"◂", "*"},      {"ᵀ", "^T"}};
  std::string result;
  for (size_t i = 0; i < text.size();) {
    if (static_cast<unsigned char>(text[i]) < 0x80) {
      result += text[i++];
      continue;
    }
    bool known = false;
    for (const auto& [from, to] : kSpellings) {
      if (text.substr(i, from.size()) == from) {
        result += to;
        i += from.size();
        known = true;
        break;
      }
    }
    if (known) continue;
    result += '?';
    for (++i; i < text.size() && (static_cast<unsigned char>(text[i]) & 0xC0) == 0x80;) ++i;
  }
  return result;
}

int Sheet::width_of(std::string_view text) const {
  return columns(terminal_.unicode ? std::string(text) : spelled_in_ascii(text));
}

void Sheet::title(std::string_view left, std::string_view right) {
  const int room = terminal_.width - width_of(left) - 2;
  if (!right.empty() && width_of(right) <= room) {
    text_ += tinted(terminal_, Tint::bold, left) + spaces(terminal_.width - width_of(left) - width_of(right)) +
             tinted(terminal_, Tint::dim, right) + "\n";
  } else {
    text_ += tinted(terminal_, Tint::bold, left) + "\n";
    if (!right.empty()) paragraph(right, 0, Tint::dim);
  }
  text_ += tinted(terminal_, Tint::dim, repeated("━", terminal_.width)) + "\n";
}

void Sheet::heading(std::string_view text) {
  gap();
  text_ += tinted(terminal_, Tint::accent, text) + " " +
           tinted(terminal_, Tint::dim, repeated("─", terminal_.width - width_of(text) - 1)) + "\n";
}

void Sheet::row(std::string_view label, std::string_view value, std::string_view note) {
  const int label_width = 25;
  const int value_width = terminal_.width >= 110 ? 30 : 25;
  const int indent = 2 + label_width + 1 + value_width + 1;
  std::string line =
      "  " + std::string(label) + spaces(label_width - width_of(label)) + " " + std::string(value);
  if (note.empty()) {
    text_ += line + "\n";
    return;
  }
  const auto notes = wrapped(note, terminal_.width - indent);
  size_t first = 0;
  if (width_of(line) < indent) {
    line += spaces(indent - width_of(line)) + tinted(terminal_, Tint::dim, notes[0]);
    first = 1;
  }
  text_ += line + "\n";
  for (size_t i = first; i < notes.size(); ++i)
    text_ += spaces(indent) + tinted(terminal_, Tint::dim, notes[i]) + "\n";
}

void Sheet::cells(std::string_view label, const std::vector<std::string>& cells, std::string_view note) {
  std::string line = "  " + std::string(label) + spaces(kLabel - width_of(label));
  for (const std::string& cell : cells) {
    const std::string padded = spaces(std::max(1, 11 - width_of(cell))) + cell;
    // More cells than fit, those of seven joints, say, go on below, as the names of their columns do.
    if (width_of(line) > kLabel + 2 && width_of(line) + width_of(padded) > terminal_.width) {
      text_ += line + "\n";
      line = spaces(kLabel + 2);
    }
    line += padded;
  }
  const int left = terminal_.width - width_of(line) - 2;
  if (!note.empty() && width_of(note) <= left) line += "  " + tinted(terminal_, Tint::dim, note);
  text_ += line + "\n";
}

void Sheet::table(const std::vector<std::string>& head, const std::vector<std::vector<std::string>>& rows,
                  bool numeric) {
  std::vector<int> widths(head.size());
  for (size_t c = 0; c < head.size(); ++c) {
    widths[c] = width_of(head[c]);
    for (const auto& cells : rows) widths[c] = std::max(widths[c], c < cells.size() ? width_of(cells[c]) : 0);
  }
  int total = 2;
  for (const int width : widths) total += width + 2;
  const int last = static_cast<int>(head.size()) - 1;
  const int room_of_last = terminal_.width - (total - widths[last]) + 2;
  const bool wrap_last = !numeric && total - 2 > terminal_.width && room_of_last > 16;
  if (wrap_last) widths[last] = room_of_last;
  const auto print = [&](const std::vector<std::string>& cells, Tint tint) {
    std::string line = "  ";
    std::vector<std::string> more;
    int indent = 2;
    for (size_t c = 0; c < cells.size(); ++c) {
      std::string cell = cells[c];
      if (wrap_last && static_cast<int>(c) == last) {
        more = wrapped(cell, widths[c]);
        cell = more[0];
      }
      const int padding = widths[c] - width_of(cell);
      if (numeric && c > 0) {
        line += spaces(padding) + cell;
      } else {
        line += cell + (static_cast<int>(c) == last ? "" : spaces(padding));
      }
      if (static_cast<int>(c) != last) {
        line += "  ";
        indent += widths[c] + 2;
      }
    }
    line.erase(line.find_last_not_of(' ') + 1);
    text_ += tinted(terminal_, tint, line) + "\n";
    for (size_t i = 1; i < more.size(); ++i) text_ += spaces(indent) + more[i] + "\n";
  };
  print(head, Tint::dim);
  for (const auto& cells : rows) print(cells, Tint::none);
}

void Sheet::paragraph(std::string_view text, int indent, Tint tint) {
  for (const auto& line : wrapped(text, terminal_.width - indent)) {
    text_ += spaces(indent) + tinted(terminal_, tint, line) + "\n";
  }
}

void Sheet::line(std::string_view text) {
  text_ += std::string(text) + "\n";
}

void Sheet::gap() {
  if (!text_.empty()) text_ += "\n";
}

std::vector<std::string> Sheet::wrapped(std::string_view text, int width) const {
  // Spelling in ASCII lengthens words.
  return zwidth::wrapped(terminal_.unicode ? std::string(text) : spelled_in_ascii(text), width);
}

std::vector<std::string> wrapped(std::string_view text, int width) {
  std::vector<std::string> lines(1);
  for (size_t i = 0; i < text.size();) {
    if (text[i] == '\n') {
      lines.emplace_back();
      ++i;
      continue;
    }
    if (text[i] == ' ') {
      ++i;
      continue;
    }
    const size_t end = std::min(text.find_first_of(" \n", i), text.size());
    const std::string_view word = text.substr(i, end - i);
    if (!lines.back().empty() && columns(lines.back()) + 1 + columns(word) > width) lines.emplace_back();
    if (!lines.back().empty()) lines.back() += ' ';
    lines.back() += word;
    i = end;
  }
  return lines;
}

Progress::Progress(std::string what, std::string unit)
    : what_(std::move(what)),
      unit_(std::move(unit)),
      terminal_(detect_terminal(STDERR_FILENO)),
      start_(now()),
      last_(start_) {}

Progress::~Progress() {
  if (drawn_ && terminal_.interactive) std::fputs("\r\x1b[K", stderr);
}

void Progress::update(double done, double total, std::string_view note) {
  const double time = now();
  const double pause = terminal_.interactive ? 0.1 : 5.0;
  // Work that ends at once shows nothing.
  if (time - last_ < pause || time - start_ < 0.3) return;
  last_ = time;
  drawn_ = true;
  const double rate = (done - before_) / (time - start_);
  const double left = rate > 0.0 ? (total - done) / rate : 0.0;
  const double share = total > 0.0 ? std::clamp(done / total, 0.0, 1.0) : 0.0;
  const std::string rate_text =
      rate >= 1e6 ? fmt::format("{:.1f} M{}/s", rate / 1e6, unit_) : fmt::format("{:.3g} {}/s", rate, unit_);
  std::string more;
  if (!note.empty()) more.append("  ").append(note);
  std::string line;
  if (terminal_.interactive) {
    const int cells = note.empty() ? 24 : 12;
    const int full = static_cast<int>(std::lround(share * cells));
    line = fmt::format("\r\x1b[K{} {}{} {:3.0f} %  {}  {:.0f} s left", what_, repeated("█", full),
                       repeated("░", cells - full), 100.0 * share, rate_text, left);
    // One line only: what does not fit of the note is left out.
    const int room = terminal_.width - 1 - columns(line);
    if (room > 2) line += more.substr(0, static_cast<size_t>(room));
  } else {
    line = fmt::format("{}: {:.0f} %, {}, {:.0f} s left{}\n", what_, 100.0 * share, rate_text, left, more);
  }
  std::fputs((terminal_.unicode ? line : spelled_in_ascii(line)).c_str(), stderr);
  std::fflush(stderr);
}

std::string number(double value, int digits) {
  if (std::isnan(value)) return "not given";
  if (std::isinf(value)) return value > 0.0 ? "unlimited" : "-unlimited";
  if (value == 0.0) return "0";
  const double magnitude = std::abs(value);
  if (magnitude < 1e-4 || magnitude >= 1e7) return fmt::format("{:.{}g}", value, digits);
  // The exponent of the rounded value: 0.99996 with four digits is 1.000.
  const std::string scientific = fmt::format("{:.{}e}", magnitude, digits - 1);
  const int exponent = std::atoi(scientific.c_str() + scientific.find('e') + 1);
  return fmt::format("{:.{}f}", value, std::max(0, digits - 1 - exponent));
}

std::string trimmed(double value, int digits) {
  std::string text = number(value, digits);
  if (text.find('.') == std::string::npos || text.find('e') != std::string::npos) return text;
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  return text;
}

namespace {

std::string millimetre_tuple(std::span<const double> values) {
  std::string text;
  for (const double value : values) {
    const double rounded = std::round(value * kMilli * 10.0) / 10.0;
    text += fmt::format("{}{:.1f}", text.empty() ? "(" : ", ", rounded == 0.0 ? 0.0 : rounded);
  }
  return text + ") mm";
}

}  // namespace

std::string point_text(const Vector3& position) {
  return millimetre_tuple({position.data(), 3});
}

std::string plane_point_text(const Vector3& position) {
  return millimetre_tuple({position.data(), 2});
}

std::string quantity(double value, double factor, std::string_view unit, int digits) {
  if (std::isnan(value)) return "not given";
  return unit.empty() ? number(value * factor, digits)
                      : fmt::format("{} {}", number(value * factor, digits), unit);
}

ReadableUnit readable_unit(double magnitude, std::string_view si_unit) {
  struct Scale {
    std::string_view si;
    double from;  // smallest magnitude that this unit suits
    double factor;
    std::string_view text;
  };
  static constexpr Scale kScales[] = {{"m", 1.0, 1.0, "m"},
                                      {"m", 1e-4, 1e3, "mm"},
                                      {"m", 1e-7, 1e6, "µm"},
                                      {"m", 0.0, 1e9, "nm"},
                                      {"m^3", 0.1, 1.0, "m³"},
                                      {"m^3", 1e-4, 1e3, "dm³"},
                                      {"m^3", 0.0, 1e6, "cm³"},
                                      {"rad", 5e-3, kDegrees, "°"},
                                      {"rad", 0.0, kDegrees * 3600.0, "″"},
                                      {"N m", 0.1, 1.0, "N m"},
                                      {"N m", 1e-3, 1e3, "mN m"},
                                      {"N m", 0.0, 1e6, "µN m"},
                                      {"N", 0.1, 1.0, "N"},
                                      {"N", 0.0, 1e3, "mN"},
                                      {"kg", 1.0, 1.0, "kg"},
                                      {"kg", 0.0, 1e3, "g"},
                                      {"kg m^2", 0.0, 1e7, "g cm²"},
                                      {"s", 0.5, 1.0, "s"},
                                      {"s", 0.0, 1e3, "ms"},
                                      {"rad/s", 0.0, 9.5492965855137211, "rpm"},
                                      {"N/m", 1e3, 1e-3, "N/mm"},
                                      {"N/m", 0.0, 1.0, "N/m"},
                                      {"Pa", 1e9, 1e-9, "GPa"},
                                      {"Pa", 1e5, 1e-6, "MPa"},
                                      {"Pa", 0.0, 1e-3, "kPa"},
                                      {"Hz", 1e4, 1e-3, "kHz"},
                                      {"Hz", 0.0, 1.0, "Hz"},
                                      {"N m s/rad", 0.0, 1e3, "mN m s/rad"},
                                      {"A", 0.1, 1.0, "A"},
                                      {"A", 0.0, 1e3, "mA"},
                                      {"ohm", 0.0, 1.0, "Ω"},
                                      {"H", 0.0, 1e3, "mH"},
                                      {"N m/A", 0.0, 1e3, "mN m/A"},
                                      {"rad/s/V", 0.0, 9.5492965855137211, "rpm/V"},
                                      {"kg/m^3", 0.0, 1.0, "kg/m³"},
                                      {"m^2", 0.0, 1e6, "mm²"},
                                      {"m^3/rad^3", 0.0, 1e6, "cm³/rad³"},
                                      {"m/rad", 0.0, 1e3, "mm/rad"}};
  for (const Scale& scale : kScales) {
    if (scale.si != si_unit || (magnitude != 0.0 && std::abs(magnitude) < scale.from)) continue;
    return {scale.factor, std::string(scale.text)};
  }
  if (si_unit == "1") return {};
  // Small whole powers as people write them.
  std::string text(si_unit);
  for (const auto& [power, raised] : {std::pair("^2", "²"), std::pair("^3", "³")}) {
    for (size_t at = text.find(power); at != text.npos; at = text.find(power, at + 1)) {
      const bool whole =
          at + 2 == text.size() || text[at + 2] == ' ' || text[at + 2] == '/' || text[at + 2] == ')';
      if (whole) text.replace(at, 2, raised);
    }
  }
  return {1.0, text};
}

std::string readable(double value, std::string_view si_unit, int digits) {
  if (std::isnan(value)) return "not given";
  const ReadableUnit unit = readable_unit(value, si_unit);
  const std::string text = number(value * unit.factor, digits);
  if (unit.text == "°" || unit.text == "″") return text + unit.text;
  return unit.text.empty() ? text : fmt::format("{} {}", text, unit.text);
}

std::string interval(double min, double max, double factor, std::string_view unit, int digits) {
  // What rounding leaves of an end at zero.
  const auto end = [&](double value) { return std::abs(value) < 1e-7 * (max - min) ? 0.0 : value * factor; };
  return fmt::format("{} … {} {}", number(end(min), digits), number(end(max), digits), unit);
}

}  // namespace zwidth
