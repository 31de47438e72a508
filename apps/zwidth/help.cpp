#include "help.h"

#include <sstream>

#include "terminal.h"

namespace zwidth {

namespace {

constexpr int kNames = 24;  // columns for names of verbs and options

}  // namespace

std::string HelpFormatter::entry(const std::string& name, const std::string& meaning) const {
  std::string text = "  " + name;
  const auto lines = wrapped(meaning, width_ - kNames);
  bool first = true;
  for (const std::string& line : lines) {
    // A name that leaves no gap stands on a line of its own.
    if (!first || columns(text) >= kNames - 1) text += "\n";
    const int used = first && columns(text) < kNames - 1 ? columns(text) : 0;
    text += std::string(static_cast<size_t>(kNames - used), ' ') + line;
    first = false;
  }
  return text + "\n";
}

std::string HelpFormatter::make_option(const CLI::Option* option, bool is_positional) const {
  std::string name = make_option_name(option, is_positional);
  // Of a positional the name says all.
  if (!is_positional && option->get_type_size() != 0) name += " " + option->get_type_name();
  return entry(name, make_option_desc(option));
}

std::string HelpFormatter::make_subcommand(const CLI::App* verb) const {
  return entry(verb->get_name(), verb->get_description());
}

std::string HelpFormatter::make_description(const CLI::App* app) const {
  std::string text;
  for (const std::string& line : wrapped(app->get_description(), width_)) text += line + "\n";
  return text;
}

std::string HelpFormatter::make_footer(const CLI::App* app) const {
  std::istringstream lines(app->get_footer());
  std::string text, prose;
  const auto end_prose = [&] {
    if (prose.empty()) return;
    for (const std::string& part : wrapped(prose, width_)) text += part + "\n";
    prose.clear();
  };
  for (std::string line; std::getline(lines, line);) {
    if (!line.empty() && !line.starts_with("  ")) {
      prose += (prose.empty() ? "" : " ") + line;
      if (line.ends_with('.') || line.ends_with(':')) end_prose();
      continue;
    }
    end_prose();
    if (columns(line) <= width_) {
      text += line + "\n";
      continue;
    }
    // "  an example      what it does": the explanation moves below, as does the rest of a long example.
    const size_t gap = line.find("  ", 2);
    std::string rest = line.substr(2);
    if (gap != std::string::npos) {
      text += line.substr(0, gap) + "\n";
      rest = line.substr(line.find_first_not_of(' ', gap));
    }
    bool first = gap == std::string::npos;
    for (const std::string& part : wrapped(rest, width_ - 6)) {
      text += (first ? "  " : "      ") + part + "\n";
      first = false;
    }
  }
  end_prose();
  return text;
}

}  // namespace zwidth
