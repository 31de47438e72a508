#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

/// Arithmetic that users write: "60 mm / sin(qmax)".
///
/// Numbers are SI, or carry a unit of one word ("60 mm", "30 deg", "0.5 MPa"). Operators + - * / ^, comparisons
/// and c ? a : b; pi; sin cos tan asin acos atan atan2 sinh cosh tanh sqrt exp log (natural) log10 abs sign min
/// max hypot clamp(x, low, high) floor ceil round. Angles are in rad. Names may contain dots and indices, as
/// keys of device files do.

namespace zwidth {

/// What an expression asks for, or why it is none.
struct ParsedExpression {
  std::vector<std::string> names;  ///< that it uses, each once
  std::string rule;                ///< what is the matter; empty if nothing
  std::string advice;
  explicit operator bool() const { return rule.empty(); }
};
ParsedExpression parse_expression(std::string_view text);

/// An expression with its names bound to numbers. Not to be used by two threads at once.
class Expression {
 public:
  /// `number` gives the place of each name's value, which must outlive the expression.
  /// REQUIRES: `parse_expression(text)` finds nothing wrong.
  Expression(std::string_view text, const std::function<double*(const std::string& name)>& number);
  Expression(Expression&&) noexcept;
  Expression& operator=(Expression&&) noexcept;
  ~Expression();

  /// NaN where it has no finite value: a division by zero, the root of a negative number.
  double operator()() const;

 private:
  struct Parser;
  std::unique_ptr<Parser> parser_;
};

}  // namespace zwidth
