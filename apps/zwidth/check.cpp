#include <CLI/CLI.hpp>
#include <algorithm>
#include <fmt/format.h>
#include <memory>
#include <random>

#include "model.h"
#include "verbs.h"

#include "zwidth/description/names.h"
#include "zwidth/description/problem.h"
#include "zwidth/mechanism/mobility.h"

namespace zwidth {

namespace {

struct CheckArguments {
  std::vector<std::string> devices;
  std::vector<std::string> overrides;
  bool json = false;
};

/// Freedoms counted at many postures of the joint ranges.
struct MobilitySample {
  int closed = 0;  ///< postures that close
  int tried = 0;
  Mobility least{};  ///< at the posture with the fewest freedoms: the others may be singular
};

MobilitySample sample_mobility(const Mechanism& mechanism) {
  MobilitySample sample;
  std::mt19937_64 random(1);
  for (sample.tried = 0; sample.tried < 50; ++sample.tried) {
    ActiveVector q(mechanism.active_count());
    for (int i = 0; i < q.size(); ++i) {
      const Interval range = mechanism.active_range(i);
      // The middle first, then anywhere.
      q[i] = sample.tried == 0 ? range.middle() : std::uniform_real_distribution(range.min, range.max)(random);
    }
    const Solution solution = solve_forward(mechanism, q);
    if (!solution) continue;
    const Mobility here = mobility(*solution.posture);
    if (sample.closed == 0 || here.freedoms < sample.least.freedoms) sample.least = here;
    ++sample.closed;
  }
  return sample;
}

Json problem_json(const Problem& problem) {
  Json entry;
  entry["file"] = problem.file;
  entry["line"] = problem.line;
  entry["column"] = problem.column;
  entry["key"] = problem.key;
  entry["value"] = problem.value;
  entry["rule"] = problem.rule;
  entry["advice"] = problem.advice;
  return entry;
}

std::vector<std::string> warnings_of(const Model& model, const MobilitySample& sample) {
  std::vector<std::string> warnings;
  const Mobility& mobility = sample.least;
  if (sample.closed < sample.tried) {
    warnings.push_back(fmt::format("the legs close at {} of {} postures tried in the joint ranges",
                                   sample.closed, sample.tried));
  }
  if (sample.closed > 0 && mobility.freedoms != mobility.active) {
    warnings.push_back(
        fmt::format("the mechanism has {} freedoms but {} active joints", mobility.freedoms, mobility.active));
  }
  for (int i = 0; i < model.mechanism.active_count(); ++i) {
    const std::string& name = model.mechanism.active_names()[static_cast<size_t>(i)];
    if (!model.has_drive(i))
      warnings.push_back(fmt::format("{} has no drive: forces and resolution are not known", name));
  }
  if (model.description.bodies.empty())
    warnings.push_back("no body has mass: gravity and inertia are those of the drives alone");
  std::vector<std::string> said;
  const auto say_failed = [&](const std::vector<Margin>& margins) {
    for (const Margin& margin : margins) {
      const std::string text =
          fmt::format("{}: {} of {}; {}", margin.name, readable(margin.demand, margin.unit),
                      readable(margin.capability, margin.unit), margin.rule);
      if (margin.ok || std::find(said.begin(), said.end(), text) != said.end()) continue;
      said.push_back(text);
      warnings.push_back(text);
    }
  };
  for (const auto& drive : model.drives) {
    if (drive) say_failed(drive->margins());
  }
  for (const auto& drive : model.pneumatic_drives) {
    if (drive) say_failed(drive->margins());
  }
  return warnings;
}

int check(const CheckArguments& arguments, const Terminal& terminal) {
  Json list = Json::array();
  Sheet sheet(terminal);
  bool good = true;
  for (const std::string& device : arguments.devices) {
    Json entry;
    entry["device"] = device;
    try {
      const Model model(read_device(device, arguments.overrides));
      const Mechanism& mechanism = model.mechanism;
      const MobilitySample sample = sample_mobility(mechanism);
      const auto warnings = warnings_of(model, sample);
      const std::string family = family_name(model.description.mechanism);
      entry["ok"] = true;
      entry["name"] = model.description.name;
      entry["title"] = model.description.title;
      entry["mechanism"] = family;
      entry["legs"] = mechanism.legs().size();
      entry["joints"] = mechanism.joint_count();
      entry["active_joints"] = mechanism.active_count();
      entry["bodies"] = model.description.bodies.size();
      entry["drives"] = model.description.drives.size() + model.description.pneumatic_drives.size();
      Json freedom;
      freedom["gruebler"] = sample.least.gruebler;
      freedom["freedoms"] = sample.least.freedoms;
      freedom["tool_freedoms"] = sample.least.tool_freedoms;
      freedom["redundant_equations"] = sample.least.redundant_equations;
      freedom["postures_tried"] = sample.tried;
      freedom["postures_closed"] = sample.closed;
      entry["mobility"] = freedom;
      entry["problems"] = Json::array();
      entry["warnings"] = warnings;
      sheet.title(device, "no problems");
      sheet.row("device", model.description.name, model.description.title);
      sheet.row("mechanism", family,
                fmt::format("{} legs, {} joints, {} of them active", mechanism.legs().size(),
                            mechanism.joint_count(), mechanism.active_count()));
      sheet.row("mobility", fmt::format("{} freedoms", sample.least.freedoms),
                fmt::format(
                    "rank of the loop closure at {} postures; Grübler counts {}{}", sample.closed,
                    sample.least.gruebler,
                    sample.least.redundant_equations > 0
                        ? fmt::format(", {} closure equations repeat others", sample.least.redundant_equations)
                        : ""));
      sheet.row("bodies", fmt::format("{}", model.description.bodies.size()));
      sheet.row("drives",
                fmt::format("{}", model.description.drives.size() + model.description.pneumatic_drives.size()));
      for (const std::string& warning : warnings)
        sheet.paragraph(tinted(terminal, Tint::warning, "warning: ") + warning);
      sheet.gap();
    } catch (const DescriptionError& error) {
      good = false;
      entry["ok"] = false;
      entry["problems"] = Json::array();
      for (const Problem& problem : error.problems()) {
        entry["problems"].push_back(problem_json(problem));
        complain(to_string(problem));
      }
      complain(fmt::format("{}: {} problem{}", device, error.problems().size(),
                           error.problems().size() == 1 ? "" : "s"));
    }
    list.push_back(entry);
  }
  if (arguments.json) {
    Json document;
    document["ok"] = good;
    document["devices"] = list;
    print_json(document);
  } else {
    print(sheet.text());
  }
  return good ? kDone : kInputWrong;
}

}  // namespace

void add_check(CLI::App& app, Context& context) {
  CLI::App* verb = add_verb(app, "check", "Read device files and list every problem and warning",
                            "  zwidth check mine.toml\n"
                            "  zwidth check delta --set drive.transmission.preload=\"5 N\"\n"
                            "  zwidth check devices/*.toml --json\n"
                            "\nExits 2 if any file has a problem; warnings do not count.");
  auto arguments = std::make_shared<CheckArguments>();
  verb->add_option("DEVICE", arguments->devices, "built-in devices or .toml files")->required();
  verb->add_option("--set", arguments->overrides, "change a value of the device files; may be repeated")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
  add_json_flag(*verb, arguments->json);
  verb->callback([arguments, &context] {
    context.run = [arguments, &context] { return check(*arguments, context.terminal); };
  });
}

}  // namespace zwidth
