#include "zwidth/design/expression.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <muParser.h>
#include <mutex>

#include "zwidth/description/problem.h"
#include "zwidth/description/units.h"
#include "zwidth/design/internal/expression_text.h"

namespace zwidth {
namespace {

using internal::kNameCharacters;
using internal::name_character;
using internal::name_start;
using internal::number_end;

const std::vector<std::string>& function_names() {
  static const std::vector<std::string> names = {
      "sin", "cos",   "tan", "asin", "acos", "atan", "atan2", "sinh",  "cosh",  "tanh", "sqrt", "exp",
      "log", "log10", "abs", "sign", "min",  "max",  "hypot", "clamp", "floor", "ceil", "round"};
  return names;
}

// The text with every number that has a unit as the SI number in brackets. Puts what is wrong in `problem`.
std::string without_units(std::string_view text, ParsedExpression& problem) {
  std::string result;
  for (std::size_t i = 0; i < text.size();) {
    if (name_start(text[i])) {
      const std::size_t start = i;
      while (i < text.size() && name_character(text[i])) ++i;
      const std::string name(text.substr(start, i - start));
      const std::size_t next = text.find_first_not_of(' ', i);
      const bool called = next != std::string_view::npos && text[next] == '(';
      if (called && std::ranges::find(function_names(), name) == function_names().end()) {
        problem.rule = fmt::format("calls '{}', which is no function", name);
        problem.advice = suggest(name, function_names());
        return {};
      }
      result += name;
      continue;
    }
    if (text[i] == '=') {
      const bool compares = i + 1 < text.size() && text[i + 1] == '=';
      if (!compares && (i == 0 || std::string_view("<>!").find(text[i - 1]) == std::string_view::npos)) {
        problem.rule = "assigns with =";
        problem.advice = "compare with ==, or add a [[derived]] value";
        return {};
      }
      result += compares ? "==" : "=";
      i += compares ? 2 : 1;
      continue;
    }
    if (!internal::number_start(text, i)) {
      result += text[i++];
      continue;
    }
    const std::size_t end = number_end(text, i);
    const std::string_view number = text.substr(i, end - i);
    i = end;
    const internal::NumberUnit unit = internal::number_unit(text, end - number.size(), end);
    if (unit.text.empty()) {
      result += number;
      continue;
    }
    if (!unit.quantity) {
      problem.rule = fmt::format("has '{}', which is no unit", unit.text);
      problem.advice = "write a product with *, units as in \"60 mm\"";
      return {};
    }
    // The square of ten millimetres, or ten square millimetres?
    const std::size_t next = text.find_first_not_of(' ', unit.end);
    if (next != std::string_view::npos && text[next] == '^') {
      problem.rule = fmt::format("raises '{}{}' to a power, which can be read in two ways", number,
                                 text.substr(end, unit.end - end));
      problem.advice = fmt::format("write ({}{})^2 for the power of the whole, or the number in SI", number,
                                   text.substr(end, unit.end - end));
      return {};
    }
    result += fmt::format("({})", unit.quantity->value);
    i = unit.end;
  }
  return result;
}

double clamp(double value, double low, double high) {
  return std::fmin(std::fmax(value, low), high);
}
double sign(double value) {
  return static_cast<double>(value > 0.0) - static_cast<double>(value < 0.0);
}

// muParser keeps its locale in one place for all parsers, and writes it whenever one is made.
std::mutex& making() {
  static std::mutex mutex;
  return mutex;
}

void set_up(mu::Parser& parser) {
  parser.ResetLocale();
  parser.DefineNameChars(kNameCharacters);
  parser.ClearConst();
  parser.DefineConst("pi", 3.14159265358979323846);
  parser.DefineFun("log", static_cast<double (*)(double)>(std::log));
  parser.DefineFun("floor", static_cast<double (*)(double)>(std::floor));
  parser.DefineFun("ceil", static_cast<double (*)(double)>(std::ceil));
  parser.DefineFun("round", static_cast<double (*)(double)>(std::round));
  parser.DefineFun("sign", sign);
  parser.DefineFun("hypot", static_cast<double (*)(double, double)>(std::hypot));
  parser.DefineFun("clamp", clamp);
}

}  // namespace

ParsedExpression parse_expression(std::string_view text) {
  ParsedExpression parsed;
  const std::string plain = without_units(text, parsed);
  if (!parsed) return parsed;
  const std::scoped_lock lock(making());
  try {
    mu::Parser parser;
    set_up(parser);
    parser.SetExpr(plain);
    for (const auto& [name, at] : parser.GetUsedVar()) parsed.names.push_back(name);
    // Only with all names known does the parser look at the whole of it.
    std::vector<double> values(parsed.names.size(), 1.0);
    for (std::size_t i = 0; i < values.size(); ++i) parser.DefineVar(parsed.names[i], &values[i]);
    parser.Eval();
  } catch (const mu::ParserError& error) {
    parsed.names.clear();
    std::string message = error.GetMsg();
    while (!message.empty() && (message.back() == '.' || message.back() == ' ')) message.pop_back();
    if (!message.empty()) message[0] = static_cast<char>(std::tolower(static_cast<unsigned char>(message[0])));
    parsed.rule = fmt::format("is no expression: {}", message);
    parsed.advice = "see docs/study_file.md for what may be written";
  }
  return parsed;
}

struct Expression::Parser {
  mu::Parser parser;
};

Expression::Expression(std::string_view text, const std::function<double*(const std::string& name)>& number) {
  ParsedExpression parsed = parse_expression(text);
  const std::scoped_lock lock(making());
  parser_ = std::make_unique<Parser>();
  mu::Parser& parser = parser_->parser;
  set_up(parser);
  parser.SetExpr(without_units(text, parsed));
  for (const std::string& name : parsed.names) parser.DefineVar(name, number(name));
  parser.Eval();  // compiles it
}

Expression::Expression(Expression&&) noexcept = default;
Expression& Expression::operator=(Expression&&) noexcept = default;
Expression::~Expression() = default;

double Expression::operator()() const {
  const double value = parser_->parser.Eval();
  return std::isfinite(value) ? value : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace zwidth
