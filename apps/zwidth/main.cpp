#include <CLI/CLI.hpp>
#include <algorithm>
#include <clocale>
#include <exception>
#include <fmt/format.h>
#include <memory>
#include <new>
#include <string>
#include <vector>

#include "help.h"
#include "verbs.h"

#include "zwidth/description/problem.h"

namespace zwidth {
namespace {

/// Words of the command line with their mistakes explained: unknown verbs and options come with the nearest
/// known.
int explain(const CLI::App& app, const CLI::ParseError& error) {
  const CLI::App* verb = &app;
  for (const CLI::App* used : app.get_subcommands()) verb = used;
  std::string message = error.what();
  std::string advice = fmt::format("see `{} --help`", verb == &app ? "zwidth" : "zwidth " + verb->get_name());
  const std::vector<std::string> extras = app.remaining(true);
  if (dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr && !extras.empty()) {
    const std::string& word = extras.front();
    std::vector<std::string> known;
    if (word.starts_with('-')) {
      for (const CLI::Option* option : verb->get_options()) {
        for (const std::string& name : option->get_lnames()) known.push_back("--" + name);
      }
      message = fmt::format("unknown option {}", word);
    } else if (verb == &app) {
      for (const CLI::App* candidate : app.get_subcommands({})) known.push_back(candidate->get_name());
      message = fmt::format("unknown verb \"{}\"", word);
    } else {
      message = fmt::format("one argument too many: \"{}\"", word);
    }
    if (!known.empty()) advice = suggest(word, known) + "; " + advice;
  }
  complain(message + "; " + advice);
  return kInputWrong;
}

int run(int argc, char** argv) {
  // Only the kind of characters follows the user's locale; numbers keep their decimal point.
  std::setlocale(LC_CTYPE, "");
  Context context;
  context.terminal = detect_terminal(1);

  CLI::App app("zwidth designs, simulates and drives force-feedback haptic devices.", "zwidth");
  app.formatter(std::make_shared<HelpFormatter>(context.terminal.width));
  app.set_version_flag("--version", "zwidth " ZWIDTH_VERSION);
  app.require_subcommand(0, 1);
  app.footer(
      "\nDEVICE is a built-in name or the path of a .toml file.\n"
      "Exit status: 0 done, 1 the answer is \"no\", 2 the input is wrong, 3 the machine failed.\n"
      "\nExamples:\n"
      "  zwidth report delta                              the data sheet, with figures\n"
      "  zwidth at delta --joints 10deg,20deg,30deg       everything about one posture\n"
      "  zwidth report delta --set mechanism.forearm=\"170 mm\"\n"
      "\n`zwidth VERB --help` has more.");
  add_report(app, context);
  add_at(app, context);
  add_workspace(app, context);
  add_size(app, context);
  add_synthesise(app, context);
  add_optimise(app, context);
  add_reproduce(app, context);
  add_show(app, context);
  add_export(app, context);
  add_check(app, context);
  add_devices(app, context);
  add_parts(app, context);
  add_figures(app, context);
  add_completion(app, context);

  // `zwidth help VERB` is `zwidth VERB --help`.
  std::vector<std::string> words(argv + 1, argv + argc);
  if (!words.empty() && words.front() == "help") {
    words.erase(words.begin());
    // What is no verb is left to be refused.
    const auto named = [&](const CLI::App* verb) { return verb->check_name(words.front()); };
    if (words.empty() || !app.get_subcommands(named).empty()) words.emplace_back("--help");
  }
  std::reverse(words.begin(), words.end());  // as CLI11 takes them
  try {
    app.parse(words);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() != 0) return explain(app, error);
    // Help and version.
    std::ostringstream text;
    app.exit(error, text, text);
    print(text.str());
    return kDone;
  }
  if (!context.run) {
    if (argc > 1) {
      complain("no verb given; see `zwidth --help`");
      return kInputWrong;
    }
    print(app.help());
    return kDone;
  }
  return context.run();
}

}  // namespace
}  // namespace zwidth

int main(int argc, char** argv) {
  using namespace zwidth;
  try {
    return run(argc, argv);
  } catch (const DescriptionError& error) {
    for (const Problem& problem : error.problems()) complain(to_string(problem));
    return kInputWrong;
  } catch (const InputError& error) {
    complain(error.what());
    return kInputWrong;
  } catch (const MachineError& error) {
    complain(error.what());
    return kMachineFailed;
  } catch (const std::bad_alloc&) {
    complain("out of memory; a coarser --grid needs less");
    return kMachineFailed;
  } catch (const std::exception& error) {
    complain(fmt::format("internal error: {}; this is a mistake in zwidth, please report it", error.what()));
    return kMachineFailed;
  }
}
