#include "zwidth/description/problem.h"

#include <algorithm>
#include <cassert>
#include <fmt/format.h>
#include <numeric>
#include <tuple>

namespace zwidth {
namespace {

std::string join(const std::vector<Problem>& problems) {
  std::string text;
  for (const Problem& problem : problems) {
    if (!text.empty()) text += '\n';
    text += to_string(problem);
  }
  return text;
}

// Damerau-Levenshtein distance of neighbouring swaps: insertions, deletions, replacements and swaps count one
// each.
std::size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> before(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
  std::iota(last.begin(), last.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, replaced});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        row[j] = std::min(row[j], before[j - 2] + 1);
    }
    before.swap(last);
    last.swap(row);
  }
  return last[b.size()];
}

std::string quoted_list(const std::vector<std::string>& names, std::string_view last_separator) {
  std::string text;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (i > 0) text += i + 1 == names.size() ? last_separator : ", ";
    text += '"' + names[i] + '"';
  }
  return text;
}

}  // namespace

std::string to_string(const Problem& problem) {
  std::string text = problem.file;
  if (problem.line > 0) text += fmt::format(":{}:{}", problem.line, problem.column);
  if (!text.empty()) text += ": ";
  if (!problem.key.empty()) {
    text += problem.key;
    if (!problem.value.empty()) text += " = " + problem.value;
    text += ": ";
  }
  text += problem.rule;
  if (!problem.advice.empty()) text += "; " + problem.advice;
  // A file must not steer the terminal that shows its mistakes.
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return c < 0x20U || c == 0x7FU; }, '?');
  return text;
}

DescriptionError::DescriptionError(std::vector<Problem> problems)
    : std::runtime_error(join(problems)), problems_(std::move(problems)) {
  assert(!problems_.empty());
}

std::vector<std::string> nearest_names(const std::string& name, const std::vector<std::string>& candidates) {
  constexpr std::size_t kLongestName = 64;  // longer ones are garbage, and would take long to compare
  constexpr std::size_t kMost = 3;
  if (name.empty() || name.size() > kLongestName) return {};

  std::vector<std::tuple<std::size_t, std::string>> near;
  for (const std::string& candidate : candidates) {
    const std::size_t allowed = std::max<std::size_t>(1, std::max(name.size(), candidate.size()) / 3);
    std::size_t distance = edit_distance(name, candidate);
    // A part of the name, or a name with something added, is near however much is missing.
    const bool contains =
        name.size() >= 3 && (candidate.find(name) != std::string::npos ||
                             (candidate.size() >= 3 && name.find(candidate) != std::string::npos));
    if (contains) distance = std::min(distance, allowed);
    const auto known = [&](const auto& one) { return std::get<1>(one) == candidate; };
    if (distance <= allowed && std::none_of(near.begin(), near.end(), known))
      near.emplace_back(distance, candidate);
  }
  std::stable_sort(near.begin(), near.end(),
                   [](const auto& a, const auto& b) { return std::get<0>(a) < std::get<0>(b); });
  std::vector<std::string> names;
  for (std::size_t i = 0; i < std::min(near.size(), kMost); ++i) names.push_back(std::get<1>(near[i]));
  return names;
}

std::string suggest(const std::string& name, const std::vector<std::string>& candidates) {
  constexpr std::size_t kMostListed = 12;
  const std::vector<std::string> near = nearest_names(name, candidates);
  if (!near.empty()) return "did you mean " + quoted_list(near, " or ") + "?";
  if (candidates.empty()) return "there are none to choose from";
  std::vector<std::string> listed(candidates.begin(),
                                  candidates.begin() + std::min(candidates.size(), kMostListed));
  const std::size_t more = candidates.size() - listed.size();
  return "known are " + quoted_list(listed, more == 0 ? " and " : ", ") +
         (more == 0 ? std::string() : fmt::format(" and {} more", more));
}

}  // namespace zwidth
