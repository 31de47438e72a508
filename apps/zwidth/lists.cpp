#include <CLI/CLI.hpp>
#include <cctype>
#include <cmath>
#include <fmt/format.h>
#include <memory>

#include "verbs.h"

#include "zwidth/actuation/motor.h"
#include "zwidth/description/problem.h"
#include "zwidth/design/figures.h"

/// `zwidth devices` and `zwidth parts`: what comes with zwidth.

namespace zwidth {

namespace {

int devices(bool json, const Terminal& terminal) {
  Json list = Json::array();
  Sheet sheet(terminal);
  std::vector<std::vector<std::string>> rows;
  for (const BuiltinFile& device : catalogue().devices()) {
    Json entry;
    entry["name"] = device.name;
    entry["title"] = device.title;
    entry["path"] = device.path.string();
    list.push_back(entry);
    rows.push_back({device.name, device.title});
  }
  if (json) {
    Json document;
    document["devices"] = list;
    print_json(document);
    return kDone;
  }
  sheet.title("Built-in devices", fmt::format("in {}", (catalogue().directory() / "devices").string()));
  sheet.table({"name", "title"}, rows, false);
  sheet.gap();
  sheet.paragraph(
      "`zwidth report NAME` prints a data sheet, `zwidth show NAME > mine.toml` starts a device of your own.",
      2, Tint::dim);
  print(sheet.text());
  return kDone;
}

/// What studies may ask for.
int figures(const std::string& word, bool json, const Terminal& terminal) {
  Json list = Json::array();
  Sheet sheet(terminal);
  sheet.title("Figures", "for [[measure]] in a study");
  std::string heading;
  bool any = false;
  for (const FigureDefinition& figure : figure_definitions()) {
    const std::string group =
        figure.topic + (figure.of_posture ? ", of a posture" : ", of the device as a whole");
    std::string searched = figure.name + " " + figure.meaning + " " + group;
    for (char& c : searched) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    if (searched.find(word) == searched.npos) continue;
    any = true;
    if (group != heading) sheet.heading(group);
    heading = group;
    Json entry;
    entry["name"] = figure.name;
    entry["unit"] = figure.unit;
    entry["meaning"] = figure.meaning;
    entry["topic"] = figure.topic;
    entry["of"] = figure.of_posture ? "posture" : "device";
    entry["needs_load"] = figure.load == FigureLoad::needed;
    entry["takes_load"] = figure.load != FigureLoad::none;
    Json options = Json::array();
    std::string note = figure.meaning;
    if (figure.load != FigureLoad::none) note += "; takes force, moment";
    for (const FigureOption& option : figure.options) {
      options.push_back({{"name", option.name}, {"default", option.otherwise}, {"meaning", option.meaning}});
      if (word.empty())
        note += fmt::format("{}{}", &option == figure.options.data() ? "; options " : ", ", option.name);
    }
    entry["options"] = options;
    Json answers = Json::array();
    for (const FigureAnswer& answer : figure.answers) answers.push_back(answer.place);
    entry["same_as"] = answers;
    list.push_back(entry);
    const bool unitless = figure.unit == "1" || figure.unit == "SI";
    sheet.line(fmt::format("  {:<34}{}", figure.name, unitless ? "" : figure.unit));
    sheet.paragraph(note, 6, Tint::dim);
    for (const FigureOption& option : figure.options) {
      if (word.empty()) break;
      sheet.paragraph(fmt::format("{} = {}: {}", option.name, trimmed(option.otherwise), option.meaning), 10,
                      Tint::dim);
    }
  }
  const std::string reached =
      "reached_share is the share of many postures, or of a box, that the tool reaches.";
  if (!any && reached.find(word) == reached.npos) {
    std::vector<std::string> known;
    for (const FigureDefinition& figure : figure_definitions()) known.push_back(figure.name);
    throw InputError(fmt::format("figures {}: no figure is about that; {}", word, suggest(word, known)));
  }
  if (json) {
    Json document;
    document["figures"] = list;
    print_json(document);
    return kDone;
  }
  sheet.gap();
  sheet.paragraph(reached);
  if (word.empty())
    sheet.paragraph("`zwidth figures stiffness` lists those about one thing, with their options.");
  print(sheet.text());
  return kDone;
}

struct PartsArguments {
  std::string kind;
  std::string name;
  bool json = false;
};

/// A figure that tells parts of a kind apart at a glance.
struct Column {
  std::string title;
  std::string key;
  double factor;
};

template <class Part>
std::vector<Column> overview();
template <>
std::vector<Column> overview<Motor>() {
  return {{"torque mN m", "nominal_torque", 1e3},
          {"current A", "nominal_current", 1.0},
          {"mN m/A", "torque_constant", 1e3},
          {"rotor g cm²", "rotor_inertia", 1e7}};
}
template <>
std::vector<Column> overview<Gearhead>() {
  return {{"turns", "reduction_numerator", 1.0}, {"per turns", "reduction_denominator", 1.0},
          {"N m", "continuous_torque", 1.0},     {"N m short", "intermittent_torque", 1.0},
          {"efficiency", "max_efficiency", 1.0}, {"deg backlash", "backlash", kDegrees}};
}
template <>
std::vector<Column> overview<Encoder>() {
  return {{"pulses/turn", "pulses_per_turn", 1.0}, {"at most kHz", "max_frequency", 1e-3}};
}
template <>
std::vector<Column> overview<Amplifier>() {
  return {{"continuous A", "continuous_current", 1.0},
          {"peak A", "max_current", 1.0},
          {"supply V", "max_supply_voltage", 1.0}};
}
template <>
std::vector<Column> overview<Cable>() {
  return {{"coated mm", "coated_diameter", 1e3},
          {"working N", "max_working_load", 1.0},
          {"breaking N", "breaking_load", 1.0}};
}
template <>
std::vector<Column> overview<Bearing>() {
  return {{"bore mm", "bore", 1e3},
          {"outer mm", "outer_diameter", 1e3},
          {"static N", "static_load", 1.0},
          {"dynamic N", "dynamic_load", 1.0}};
}
template <>
std::vector<Column> overview<Material>() {
  return {{"modulus GPa", "elastic_modulus", 1e-9},
          {"density kg/m³", "density", 1.0},
          {"yield MPa", "yield_strength", 1e-6}};
}

template <>
std::vector<Column> overview<Lamina>() {
  return {{"E1 GPa", "longitudinal_modulus", 1e-9},
          {"E2 GPa", "transverse_modulus", 1e-9},
          {"G12 GPa", "shear_modulus", 1e-9},
          {"density kg/m³", "density", 1.0}};
}
template <>
std::vector<Column> overview<Cylinder>() {
  return {{"mm stroke", "stroke", 1e3},
          {"mm² rear", "rear_area", 1e6},
          {"mm² rod side", "rod_area", 1e6},
          {"kPa max", "max_pressure", 1e-3}};
}
template <>
std::vector<Column> overview<Regulator>() {
  return {
      {"kPa", "max_pressure", 1e-3}, {"V", "max_command", 1.0}, {"kPa supply", "max_supply_pressure", 1e-3}};
}
template <>
std::vector<Column> overview<Potentiometer>() {
  return {{"deg", "electrical_angle", 180.0 / 3.14159265358979323846}, {"linearity", "linearity", 1.0}};
}

class Parts {
 public:
  Parts(const PartsArguments& arguments, const Terminal& terminal) : arguments_(arguments), sheet_(terminal) {}

  int run() {
    const std::vector<std::string> kinds = {"motor",    "gearhead",  "encoder",      "amplifier",
                                            "cable",    "bearing",   "material",     "lamina",
                                            "cylinder", "regulator", "potentiometer"};
    std::string kind = arguments_.kind;
    if (kind.ends_with('s') || kind == "laminae") kind.pop_back();
    if (!kind.empty() && std::find(kinds.begin(), kinds.end(), kind) == kinds.end()) {
      // A part's name alone says its kind too.
      if (!arguments_.name.empty())
        throw InputError(
            fmt::format("there is no kind of part called \"{}\"; {}", arguments_.kind, suggest(kind, kinds)));
      name_ = arguments_.kind;
    } else {
      kind_ = kind;
      name_ = arguments_.name;
    }
    each<Motor>();
    each<Gearhead>();
    each<Encoder>();
    each<Amplifier>();
    each<Cable>();
    each<Bearing>();
    each<Material>();
    each<Lamina>();
    each<Cylinder>();
    each<Regulator>();
    each<Potentiometer>();
    if (!name_.empty() && found_ == 0) {
      std::vector<std::string> known = known_names_;
      if (kind_.empty()) known.insert(known.end(), kinds.begin(), kinds.end());
      throw InputError(fmt::format("there is no {} called \"{}\"; {}", kind_.empty() ? "part" : kind_, name_,
                                   suggest(name_, known)));
    }
    if (arguments_.json) {
      Json document;
      document["parts"] = list_;
      print_json(document);
    } else {
      print(sheet_.text());
    }
    return kDone;
  }

 private:
  template <class Part>
  void each() {
    const std::string kind(part_kind<Part>());
    if (!kind_.empty() && kind != kind_) return;
    const auto columns_of_kind = overview<Part>();
    std::vector<std::vector<std::string>> rows;
    for (const Part& part : catalogue().all<Part>()) {
      known_names_.push_back(part.info.name);
      if (!name_.empty() && part.info.name != name_) continue;
      ++found_;
      const auto values = part_values(part);
      Json entry;
      entry["kind"] = kind;
      entry["name"] = part.info.name;
      entry["title"] = part.info.title;
      entry["source"] = part.info.source;
      Json numbers;
      for (const PartValue& value : values) {
        Json number_entry;
        number_entry["value"] = json_number(value.value);
        number_entry["unit"] = si_unit(value.dimension);
        number_entry["source"] = value.source;
        if (!std::isfinite(value.value)) number_entry["note"] = "not given by the source";
        numbers[value.key] = number_entry;
      }
      entry["values"] = numbers;
      list_.push_back(entry);
      if constexpr (std::is_same_v<Part, Motor>) {
        Json checks = Json::array();
        for (const MotorConsistency& check : motor_consistency(part)) {
          checks.push_back({{"key", check.key},
                            {"given", json_number(check.given)},
                            {"computed", json_number(check.computed)},
                            {"difference", json_number(check.difference())}});
        }
        list_.back()["consistency"] = checks;
      }
      if (!name_.empty()) {
        one(kind, part.info, values);
        if constexpr (std::is_same_v<Part, Motor>) consistency(part);
      }
      std::vector<std::string> row{part.info.name};
      for (const Column& column : columns_of_kind) {
        for (const PartValue& value : values) {
          if (value.key == column.key)
            row.push_back(given(value.value) ? trimmed(value.value * column.factor, 4) : "–");
        }
      }
      rows.push_back(row);
    }
    if (!name_.empty()) return;
    sheet_.heading(kind == "lamina" ? "laminae" : kind + (kind.ends_with('y') ? "" : "s"));
    std::vector<std::string> head{"name"};
    for (const Column& column : columns_of_kind) head.push_back(column.title);
    sheet_.table(head, rows);
  }

  void one(const std::string& kind, const PartInfo& info, const std::vector<PartValue>& values) {
    sheet_.title(info.name, kind);
    sheet_.paragraph(info.title);
    sheet_.paragraph("source: " + info.source, 2, Tint::dim);
    sheet_.gap();
    for (const PartValue& value : values) {
      const std::string text = given(value.value) ? format_quantity(value.value, value.dimension) : "not given";
      std::string note = value.meaning;
      if (value.source != info.source) note += " (" + value.source + ")";
      sheet_.row(value.key, text, note);
    }
  }

  void consistency(const Motor& motor) {
    sheet_.heading("What the data sheet repeats, beside what follows from its other values");
    std::vector<std::vector<std::string>> rows;
    for (const MotorConsistency& check : motor_consistency(motor)) {
      const std::string_view unit = check.dimension == Dimension::number ? "" : si_unit(check.dimension);
      rows.push_back({check.key, readable(check.given, unit), readable(check.computed, unit),
                      fmt::format("{:+.1f} %", 100.0 * check.difference())});
    }
    sheet_.table({"", "given", "computed", "apart"}, rows);
  }

  const PartsArguments& arguments_;
  Sheet sheet_;
  std::string kind_;
  std::string name_;
  std::vector<std::string> known_names_;
  Json list_ = Json::array();
  int found_ = 0;
};

}  // namespace

void add_devices(CLI::App& app, Context& context) {
  CLI::App* verb =
      add_verb(app, "devices", "List the built-in devices", "  zwidth devices\n  zwidth devices --json");
  auto json = std::make_shared<bool>(false);
  add_json_flag(*verb, *json);
  verb->callback(
      [json, &context] { context.run = [json, &context] { return devices(*json, context.terminal); }; });
}

void add_figures(CLI::App& app, Context& context) {
  CLI::App* verb =
      add_verb(app, "figures", "The figures that a study may ask for",
               "  zwidth figures\n"
               "  zwidth figures stiffness                 those about one thing, with their options\n"
               "  zwidth figures --json | jq -r '.figures[].name'");
  auto json = std::make_shared<bool>(false);
  auto word = std::make_shared<std::string>();
  verb->add_option("WORD", *word, "only those that have it in their name, meaning or heading");
  add_json_flag(*verb, *json);
  verb->callback([json, word, &context] {
    context.run = [json, word, &context] { return figures(*word, *json, context.terminal); };
  });
}

void add_parts(CLI::App& app, Context& context) {
  CLI::App* verb = add_verb(app, "parts", "List the part catalogue, or everything about one part",
                            "  zwidth parts                             every kind\n"
                            "  zwidth parts motor                       the motors\n"
                            "  zwidth parts maxon-epos2-50-5            one part, each value with its source");
  auto arguments = std::make_shared<PartsArguments>();
  verb->add_option("KIND", arguments->kind,
                   "motor, gearhead, encoder, amplifier, cable, bearing or material; or a part's name");
  verb->add_option("NAME", arguments->name, "name of the part");
  add_json_flag(*verb, arguments->json);
  verb->callback([arguments, &context] {
    context.run = [arguments, &context] { return Parts(*arguments, context.terminal).run(); };
  });
}

}  // namespace zwidth
