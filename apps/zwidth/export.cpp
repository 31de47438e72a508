#include "zwidth/mechanism/export.h"

#include <CLI/CLI.hpp>
#include <cmath>
#include <fmt/format.h>
#include <fstream>
#include <memory>

#include "model.h"
#include "verbs.h"

namespace zwidth {

namespace {

struct ExportArguments : DeviceArguments {
  std::string to;
  std::string output;
};

/// The posture that the mechanism starts solving from.
Posture home_posture(const Mechanism& mechanism) {
  ActiveVector joints(mechanism.active_count());
  for (int i = 0; i < mechanism.active_count(); ++i)
    joints[i] = mechanism.home_guess()[mechanism.active_joint(i)];
  const Solution solution = solve_forward(mechanism, joints);
  if (!solution)
    throw InputError(fmt::format("{}: its loops do not close at home ({}); give its joints another home",
                                 mechanism.name(), to_string(solution.status)));
  return *solution.posture;
}

ExportedModel exported(const ExportArguments& arguments, const Model& model) {
  if (arguments.to == "mjcf") return export_mjcf(home_posture(model.mechanism));
  ActiveVector speed = ActiveVector::Constant(model.mechanism.active_count(), NAN);
  for (int i = 0; i < speed.size(); ++i) {
    if (const auto& drive = model.drives[static_cast<size_t>(i)]) speed[i] = drive->speed().usable;
  }
  return export_urdf(model.mechanism, model.peak_torque(), speed);
}

int run_export(const ExportArguments& arguments) {
  if (arguments.to != "mjcf" && arguments.to != "urdf")
    throw InputError(fmt::format("--to {}: must be \"mjcf\" (for MuJoCo) or \"urdf\"", arguments.to));
  const Model model(read_device(arguments));
  const ExportedModel result = exported(arguments, model);
  for (const std::string& notice : result.notices) complain(notice);
  if (!arguments.output.empty()) {
    std::ofstream file(arguments.output, std::ios::binary);
    file << result.text << std::flush;
    if (!file) throw MachineError(fmt::format("cannot write {}", arguments.output));
  }
  if (arguments.json) {
    Json document;
    document["device"] = model.description.name;
    document["format"] = arguments.to;
    document["text"] = result.text;
    document["notices"] = result.notices;
    print_json(document);
  } else if (arguments.output.empty()) {
    print(result.text);
  }
  return kDone;
}

}  // namespace

void add_export(CLI::App& app, Context& context) {
  CLI::App* verb = add_verb(app, "export", "Write a device for other programs: MJCF or URDF",
                            "  zwidth export r-cube --to mjcf > r-cube.xml     for MuJoCo, loops and all\n"
                            "  zwidth export seven-dof --to urdf -o arm.urdf   a tree of links and joints\n"
                            "\nWhat the format cannot say stands on the standard error, and in the file.");
  auto arguments = std::make_shared<ExportArguments>();
  add_device_arguments(*verb, *arguments);
  verb->add_option("--to", arguments->to, "mjcf or urdf")->required();
  verb->add_option("-o,--output", arguments->output, "file to write instead of the standard output");
  verb->callback([arguments, &context] { context.run = [arguments] { return run_export(*arguments); }; });
}

}  // namespace zwidth
