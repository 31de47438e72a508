#include "sheet_page.h"

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <fmt/format.h>

#include "figure/svg.h"
#include "model.h"
#include "terminal.h"

#include "zwidth/description/units.h"

namespace zwidth {

std::string cell(const std::string& text, const char* kind) {
  return *kind != '\0' ? fmt::format("<td class=\"{}\">{}</td>", kind, escaped(text))
                       : fmt::format("<td>{}</td>", escaped(text));
}

std::string sentence(std::string text) {
  if (!text.empty()) text[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
  return text;
}

SheetPage::SheetPage(const DataSheet& sheet, const Description& description,
                     const std::vector<SheetFigure>& figures, const std::vector<std::string>& overrides)
    : sheet_(sheet),
      description_(description),
      figures_(figures),
      overrides_(overrides),
      values_(described_values(description)) {}

void SheetPage::section(const std::string& id, const std::string& title) {
  if (!contents_.empty()) body_ += "</section>\n";
  contents_.emplace_back(id, title);
  body_ += fmt::format("<section><h2 id=\"{}\">{}</h2>\n", id, escaped(title));
}

void SheetPage::how(const std::string& text) {
  body_ += fmt::format("<p class=\"how\">{}</p>\n", escaped(text));
}

void SheetPage::show_figures(const std::string& of_section, const char* kind) {
  std::string cards;
  for (const SheetFigure& figure : figures_) {
    if (figure.section != of_section) continue;
    cards += fmt::format("<figure class=\"card{}\" id=\"{}\"><b>{}</b>{}",
                         figure.id.starts_with("margins") ? " wide" : "", figure.id, escaped(figure.title),
                         figure.svg);
    if (!figure.caption.empty()) cards += fmt::format("<figcaption>{}</figcaption>", escaped(figure.caption));
    cards += "</figure>\n";
  }
  if (!cards.empty()) body_ += fmt::format("<div class=\"figures {}\">{}</div>\n", kind, cards);
}

void SheetPage::tile(const std::string& value, const std::string& label) {
  // The unit steps back behind the number.
  const size_t space = value.rfind(' ');
  const std::string text = space == std::string::npos
                               ? escaped(value)
                               : fmt::format("{} <small>{}</small>", escaped(value.substr(0, space)),
                                             escaped(value.substr(space + 1)));
  body_ += fmt::format("<div class=\"tile\"><b>{}</b><span>{}</span></div>", text, escaped(label));
}

std::string trimmed_quantity(double value, std::string_view unit) {
  const std::string text = readable(value, unit, 6);
  const size_t end = text.find_first_not_of("-0123456789.");
  if (end == 0 || text.find('.') >= end) return text;
  std::string digits = text.substr(0, end);
  digits.erase(digits.find_last_not_of('0') + 1);
  if (digits.back() == '.') digits.pop_back();
  return end == std::string::npos ? digits : digits + text.substr(end);
}

std::string SheetPage::value_text(const DescribedValue& value) const {
  if (!value.given()) return "not given";
  if (value.dimension == Dimension::angle && value.values.size() == 2) {
    return fmt::format("{}° … {}°", trimmed(value.values[0] * kDegrees), trimmed(value.values[1] * kDegrees));
  }
  if (value.values.size() == 1) return trimmed_quantity(value.values[0], si_unit(value.dimension));
  // The unit of the largest component serves all.
  const double largest = *std::max_element(value.values.begin(), value.values.end(),
                                           [](double a, double b) { return std::abs(a) < std::abs(b); });
  const std::string whole = readable(largest, si_unit(value.dimension), 6);
  const size_t space = whole.find(' ');
  const double factor = largest != 0.0 ? std::strtod(whole.c_str(), nullptr) / largest : 1.0;
  std::string text;
  for (const double component : value.values) text += (text.empty() ? "" : ", ") + trimmed(component * factor);
  return text + (space == std::string::npos ? "" : whole.substr(space));
}

bool SheetPage::overridden(const DescribedValue& value) const {
  const auto plain = [](std::string_view path) {
    std::string result;
    for (size_t i = 0; i < path.size(); ++i) {
      if (path[i] == '[') {
        while (i < path.size() && path[i] != ']') ++i;
      } else if (path[i] == '.' && i + 1 < path.size() && path[i + 1] >= '0' && path[i + 1] <= '9') {
        while (i + 1 < path.size() && path[i + 1] != '.') ++i;
      } else if (path[i] != ' ') {
        result += path[i];
      }
    }
    return result;
  };
  const std::string key = plain(value.table + "." + value.key);
  return std::any_of(overrides_.begin(), overrides_.end(),
                     [&](const std::string& text) { return plain(text.substr(0, text.find('='))) == key; });
}

std::string SheetPage::source_of(const DescribedValue& value) const {
  if (overridden(value))
    return "<td class=\"source\"><span class=\"tag\">--set</span> on the command line</td>";
  return source_cell(value.source, value.chosen());
}

std::string source_cell(const std::string& source, bool chosen) {
  if (!chosen) return fmt::format("<td class=\"source\">{}</td>", escaped(source));
  std::string_view why = source;
  why.remove_prefix(std::min(why.size(), std::string_view("chosen").size()));
  while (!why.empty() && (why.front() == ':' || why.front() == ' ')) why.remove_prefix(1);
  return fmt::format("<td class=\"source\"><span class=\"tag\">chosen</span> {}</td>", escaped(why));
}

void SheetPage::values_table(const std::function<bool(const DescribedValue&)>& wanted, bool grouped) {
  std::string rows;
  std::string group;
  for (const DescribedValue& value : values_) {
    if (!wanted(value)) continue;
    if (grouped && value.table != group) {
      group = value.table;
      rows += fmt::format("<tr class=\"group\"><td colspan=\"3\"><code>{}</code></td></tr>", escaped(group));
    }
    std::string meaning = value.meaning;
    if (!meaning.empty()) meaning[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(meaning[0])));
    rows += fmt::format("<tr><td>{} <code>{}</code></td>{}{}</tr>\n", escaped(meaning), escaped(value.key),
                        cell(value_text(value), "n"), source_of(value));
  }
  if (rows.empty()) return;
  body_ += fmt::format(
      "<div class=\"scroll\"><table><tr><th>Quantity</th><th class=\"n\">Value</th><th>Where it comes "
      "from</th></tr>{}</table></div>\n",
      rows);
}

void SheetPage::facts(const std::vector<ArmFact>& lines) {
  std::string rows = "<tr><th>Quantity</th><th class=\"n\">Value</th><th></th></tr>";
  for (const ArmFact& fact : lines) {
    std::string name = fact.name.substr(std::min(fact.name.size(), fact.name.find_first_not_of(' ')));
    if (!name.empty()) name[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(name[0])));
    rows += "<tr>" + cell(name) + cell(fact.value, "n") + cell(fact.note, "source") + "</tr>\n";
  }
  body_ += fmt::format("<div class=\"scroll\"><table>{}</table></div>\n", rows);
}

void SheetPage::statistics_head(double spacing, bool quantiles) {
  statistics_head("Over a lattice of " + format_quantity(spacing, Dimension::length), quantiles);
}

void SheetPage::statistics_head(const std::string& over, bool quantiles) {
  quantiles_ = quantiles;
  rows_ = fmt::format("<tr><th>{}</th>", escaped(over));
  for (const char* head : {"Least", quantiles ? "Median" : "Mean", quantiles ? "95 % below" : "", "Most"})
    if (*head != '\0') rows_ += fmt::format("<th class=\"n\">{}</th>", head);
  rows_ += "<th>Unit</th></tr>";
}

void SheetPage::statistics_row(const std::vector<std::string>& cells) {
  shown_.push_back(cells);
  rows_ += "<tr>" + cell(sentence(cells.front()));
  for (std::size_t c = 1; c + 1 < cells.size(); ++c) rows_ += cell(cells[c], "n");
  rows_ += cell(cells.back(), "w") + "</tr>\n";
}

void SheetPage::statistics_end() {
  body_ += fmt::format("<div class=\"scroll\"><table>{}</table></div>\n", rows_);
  const std::string note = rows_note(shown_, quantiles_);
  if (!note.empty()) how(note);
  shown_.clear();
}

}  // namespace zwidth
