#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <memory>

#include "verbs.h"

namespace zwidth {

namespace {

/// A bash completion of verbs, their options, and the built-in devices.
std::string bash_completion(const CLI::App& app) {
  std::string verbs;
  std::string cases;
  for (const CLI::App* verb : app.get_subcommands({})) {
    verbs += (verbs.empty() ? "" : " ") + verb->get_name();
    std::string options;
    for (const CLI::Option* option : verb->get_options()) {
      for (const std::string& name : option->get_lnames()) options += (options.empty() ? "--" : " --") + name;
    }
    cases += fmt::format("    {}) options=\"{}\" ;;\n", verb->get_name(), options);
  }
  return fmt::format(R"bash(# zwidth: bash completion. Use it with: source <(zwidth completion bash)
_zwidth() {{
  local word=${{COMP_WORDS[COMP_CWORD]}} options=""
  if [ "$COMP_CWORD" -eq 1 ]; then
    COMPREPLY=($(compgen -W "{} --help --version" -- "$word"))
    return
  fi
  case ${{COMP_WORDS[1]}} in
{}  esac
  case $word in
    -*) COMPREPLY=($(compgen -W "$options" -- "$word")) ;;
    *) COMPREPLY=($(compgen -W "$(zwidth devices --json 2>/dev/null | sed -n 's/.*"name": "\(.*\)".*/\1/p')" -- "$word") $(compgen -f -- "$word")) ;;
  esac
}}
complete -o filenames -F _zwidth zwidth
)bash",
                     verbs, cases);
}

}  // namespace

void add_completion(CLI::App& app, Context& context) {
  CLI::App* verb = add_verb(app, "completion", "Print a completion script for a shell",
                            "  source <(zwidth completion bash)");
  auto shell = std::make_shared<std::string>("bash");
  verb->add_option("SHELL", *shell, "bash");
  verb->callback([shell, &app, &context] {
    context.run = [shell, &app] {
      if (*shell != "bash") throw InputError(fmt::format("completion {}: there is one for bash only", *shell));
      print(bash_completion(app));
      return kDone;
    };
  });
}

}  // namespace zwidth
