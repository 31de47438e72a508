#pragma once

#include <CLI/CLI.hpp>
#include <string>

/// `--help` that fits the terminal.

namespace zwidth {

class HelpFormatter : public CLI::Formatter {
 public:
  /// `width` columns.
  explicit HelpFormatter(int width) : width_(width) {}

  std::string make_option(const CLI::Option* option, bool is_positional) const override;
  std::string make_subcommand(const CLI::App* verb) const override;
  std::string make_description(const CLI::App* app) const override;
  std::string make_footer(const CLI::App* app) const override;

 private:
  std::string entry(const std::string& name, const std::string& meaning) const;

  int width_;
};

}  // namespace zwidth
