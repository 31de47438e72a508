#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <memory>
#include <sstream>

#include "verbs.h"

#include "zwidth/description/write.h"
#include "zwidth/mechanism/delta.h"
#include "zwidth/mechanism/families.h"

namespace zwidth {

namespace {

struct ShowArguments : DeviceArguments {
  std::string as = "device";
};

int show(const ShowArguments& arguments) {
  Description description = read_device(arguments);
  if (arguments.as == "legs") {
    description = spelled_out(description);
  } else if (arguments.as != "device") {
    throw InputError(fmt::format(
        "--as {}: must be \"device\" (as it was written) or \"legs\" (the general form)", arguments.as));
  }
  std::ostringstream toml;
  write_description(description, toml, catalogue());
  if (arguments.json) {
    Json document;
    document["device"] = description.name;
    document["title"] = description.title;
    document["source"] = description.source;
    document["form"] = arguments.as;
    document["toml"] = toml.str();
    print_json(document);
  } else {
    print(toml.str());
  }
  return kDone;
}

}  // namespace

void add_show(CLI::App& app, Context& context) {
  CLI::App* verb =
      add_verb(app, "show", "Print a device file, with its overrides",
               "  zwidth show delta                       the file, ready to be edited\n"
               "  zwidth show delta --as legs > d.toml    the same mechanism spelled out joint by joint\n"
               "  zwidth show delta --set mechanism.forearm=\"170 mm\" > longer.toml");
  auto arguments = std::make_shared<ShowArguments>();
  add_device_arguments(*verb, *arguments);
  verb->add_option("--as", arguments->as, "device (as written) or legs (the general form)");
  verb->callback([arguments, &context] { context.run = [arguments] { return show(*arguments); }; });
}

}  // namespace zwidth
