#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <memory>

#include "model.h"
#include "study.h"
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

std::string counted(int number, const char* singular, const char* plural) {
  return fmt::format("{} {}", number, number == 1 ? singular : plural);
}

constexpr int kSeldom = 10;  // a tenth of the postures tried is no longer hardly anywhere

/// A device that only stands at home: its legs close at no other posture of the joint ranges that was tried.
void refuse_home_alone(const std::string& device, const Mechanism& mechanism, const MobilitySample& sample) {
  if (mechanism.legs().size() < 2 || sample.closed > 1) return;
  throw DescriptionError(
      {{.file = device,
        .key = "mechanism",
        .rule = fmt::format(
            "closes its legs at home alone, if there: at none of {} other postures in the joint ranges",
            sample.tried - 1),
        .advice = "look for a length that is wrong, or narrow the joint ranges to what the device can do"}});
}

/// What the counts come to, in a word.
const char* verdict_of(const Mobility& mobility) {
  if (mobility.loose > 0) return "under-constrained";
  if (mobility.active > mobility.freedoms) return "over-actuated";
  return mobility.redundant_equations > 0 ? "over-constrained" : "constrained";
}

/// How the freedoms were counted.
std::string counting_text(const MobilitySample& sample) {
  const Mobility& mobility = sample.typical;
  std::string text =
      fmt::format("rank of the loop closure at {}; Grübler counts {} {}",
                  counted(sample.closed, "posture", "postures"), mobility.gruebler, in_words(mobility.group));
  if (sample.singular > 0) {
    text +=
        fmt::format("; {} singular with {} at the moment",
                    sample.singular == 1 ? "one posture is" : fmt::format("{} postures are", sample.singular),
                    sample.most_freedoms);
  }
  return text;
}

std::vector<std::string> warnings_of(const Model& model, const MobilitySample& sample) {
  std::vector<std::string> warnings;
  const Mobility& mobility = sample.typical;
  if (sample.closed < sample.tried) {
    warnings.push_back(fmt::format(
        "the legs close at {} of {} postures tried in the joint ranges{}", sample.closed, sample.tried,
        sample.closed * kSeldom > sample.tried
            ? ""
            : ": hardly anywhere; look for a length that is wrong, or narrow the ranges to "
              "what the device uses"));
  }
  if (sample.closed > 0 && mobility.loose > 0) {
    std::string joints;
    for (const int j : loose_joints(sample.posture.front())) {
      joints += fmt::format("{}{}", joints.empty() ? "" : ", ",
                            model.mechanism.joint_names()[static_cast<size_t>(j)]);
    }
    warnings.push_back(fmt::format("under-constrained: {} that no drive holds{}",
                                   counted(mobility.loose, "freedom", "freedoms"),
                                   joints.empty() ? ", of the platform alone" : ", of " + joints));
  }
  if (sample.closed > 0 && mobility.redundant_equations > 0) {
    warnings.push_back(
        fmt::format("over-constrained: {} in the loops repeat{} others, so that they close only with exact "
                    "lengths and axes; "
                    "in a real device play or bending must give way",
                    counted(mobility.redundant_equations, "equation", "equations"),
                    mobility.redundant_equations == 1 ? "s" : ""));
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

/// "1 leg, 5 joints, 5 of them active, 2 of which the hand alone moves".
std::string joints_text(const Mechanism& mechanism) {
  const int free = mechanism.active_count() - mechanism.driven_count();
  return fmt::format("{}, {}, {} of them active{}",
                     counted(static_cast<int>(mechanism.legs().size()), "leg", "legs"),
                     counted(mechanism.joint_count(), "joint", "joints"), mechanism.active_count(),
                     free > 0 ? fmt::format(", {} of which the hand alone moves", free) : "");
}

/// A study in a few lines: what it chooses, what it asks for.
void check_study(const std::string& name, const std::vector<std::string>& overrides, Json& entry,
                 Sheet& sheet) {
  const std::unique_ptr<StudyModel> model = read_study_model(name, overrides);
  const Study& study = model->study();
  const SearchProblem problem = model->search_problem();
  entry["ok"] = true;
  entry["name"] = study.name;
  entry["title"] = study.title;
  entry["study_of"] = study.device;
  entry["variables"] = Json::array();
  entry["objectives"] = problem.objectives;
  entry["constraints"] = problem.constraints;
  entry["problems"] = Json::array();
  sheet.title(name, "no problems");
  sheet.row("study", study.name, study.title);
  sheet.row("device", study.device);
  double designs = 1.0;
  for (const SearchVariable& one : problem.variables) {
    entry["variables"].push_back(one.name);
    designs *= one.integer ? one.max - one.min + 1.0 : HUGE_VAL;
  }
  sheet.row("variables", fmt::format("{}", problem.variables.size()),
            std::isfinite(designs) ? fmt::format("{} designs in all", number(designs)) : "");
  sheet.row("objectives", fmt::format("{}", problem.objectives.size()));
  sheet.row("constraints", fmt::format("{}", study.constraints.size()));
  sheet.row("figures", fmt::format("{}", study.measures.size()));
  sheet.gap();
}

int check(const CheckArguments& arguments, const Terminal& terminal) {
  Json list = Json::array();
  Sheet sheet(terminal);
  bool good = true;
  for (const std::string& device : arguments.devices) {
    Json entry;
    entry["device"] = device;
    try {
      if (names_study(device)) {
        check_study(device, arguments.overrides, entry, sheet);
        list.push_back(entry);
        continue;
      }
      const Model model(read_device(device, arguments.overrides));
      const Mechanism& mechanism = model.mechanism;
      const MobilitySample sample = sample_mobility(mechanism);
      refuse_home_alone(device, mechanism, sample);
      const auto warnings = warnings_of(model, sample);
      const std::string family = family_name(model.description.mechanism);
      entry["ok"] = true;
      entry["name"] = model.description.name;
      entry["title"] = model.description.title;
      entry["mechanism"] = family;
      entry["legs"] = mechanism.legs().size();
      entry["joints"] = mechanism.joint_count();
      entry["active_joints"] = mechanism.active_count();
      entry["free_joints"] = mechanism.active_count() - mechanism.driven_count();
      entry["bodies"] = model.description.bodies.size();
      entry["drives"] = model.description.drives.size() + model.description.pneumatic_drives.size();
      Json freedom;
      freedom["gruebler"] = sample.typical.gruebler;
      freedom["freedoms"] = sample.typical.freedoms;
      freedom["tool_freedoms"] = sample.typical.tool_freedoms;
      freedom["redundant_equations"] = sample.typical.redundant_equations;
      freedom["active_joints"] = sample.typical.active;
      freedom["group"] = to_string(sample.typical.group);
      freedom["verdict"] = verdict_of(sample.typical);
      freedom["postures_tried"] = sample.tried;
      freedom["postures_closed"] = sample.closed;
      freedom["singular_postures"] = sample.singular;
      entry["mobility"] = freedom;
      entry["problems"] = Json::array();
      entry["warnings"] = warnings;
      sheet.title(device, "no problems");
      sheet.row("device", model.description.name, model.description.title);
      sheet.row("mechanism", family, joints_text(mechanism));
      sheet.row("mobility",
                fmt::format("{}, {}", counted(sample.typical.freedoms, "freedom", "freedoms"),
                            verdict_of(sample.typical)),
                counting_text(sample));
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
  CLI::App* verb = add_verb(app, "check", "Read device and study files and list every problem and warning",
                            "  zwidth check mine.toml\n"
                            "  zwidth check delta --set drive.transmission.preload=\"5 N\"\n"
                            "  zwidth check devices/*.toml --json\n"
                            "  zwidth check r-cube-kinematics\n"
                            "\nExits 2 if any file has a problem; warnings do not count.");
  auto arguments = std::make_shared<CheckArguments>();
  verb->add_option("DEVICE", arguments->devices, "built-in devices or studies, or .toml files")->required();
  verb->add_option("--set", arguments->overrides, "change a value of the device files; may be repeated")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
  add_json_flag(*verb, arguments->json);
  verb->callback([arguments, &context] {
    context.run = [arguments, &context] { return check(*arguments, context.terminal); };
  });
}

}  // namespace zwidth
