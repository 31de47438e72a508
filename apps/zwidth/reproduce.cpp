#include <CLI/CLI.hpp>
#include <algorithm>
#include <fmt/format.h>
#include <memory>

#include "reproduction.h"
#include "verbs.h"

/// `zwidth reproduce`: published against computed.

namespace zwidth {

namespace {

struct Source {
  std::string device;
  Reproduction (*reproduce)(const Catalogue&);
};

const std::vector<Source>& sources() {
  static const std::vector<Source> all = {{"delta", reproduce_delta},
                                          {"five-bar", reproduce_five_bar},
                                          {"r-cube", reproduce_r_cube},
                                          {"seven-dof", reproduce_seven_dof},
                                          {"pneumatic", reproduce_pneumatic}};
  return all;
}

/// Devices with a common source are named after it: "pneumatic-1" after "pneumatic".
bool covers(const Source& source, const std::string& name) {
  return name == source.device || name.starts_with(source.device + "-");
}

struct Arguments {
  std::string device;
  bool strict = false;
  bool json = false;
};

std::string shown(const ReproducedFigure& figure, double si, int more_digits = 0) {
  return fmt::format("{:.{}f}", si / figure.unit.factor, std::max(0, figure.decimals + more_digits));
}

int missed(const Reproduction& reproduction) {
  return static_cast<int>(std::count_if(reproduction.figures.begin(), reproduction.figures.end(),
                                        [](const ReproducedFigure& figure) { return !figure.ok(); }));
}

int fallen_short(const Reproduction& reproduction) {
  return static_cast<int>(std::count_if(reproduction.search.begin(), reproduction.search.end(),
                                        [](const SearchFinding& finding) { return !finding.ok(); }));
}

void print_figures(Sheet& sheet, const Reproduction& reproduction) {
  std::string heading;
  std::vector<std::vector<std::string>> rows;
  std::vector<std::string> notes;
  const auto flush = [&] {
    if (rows.empty()) return;
    sheet.heading(heading);
    sheet.table({"figure", "printed", "computed", "unit", ""}, rows);
    for (const std::string& note : notes) sheet.paragraph(note, 4, Tint::dim);
    rows.clear();
    notes.clear();
  };
  for (const ReproducedFigure& figure : reproduction.figures) {
    if (figure.source != heading) {
      flush();
      heading = figure.source;
    }
    rows.push_back({figure.what, shown(figure, figure.printed), shown(figure, figure.computed, 1),
                    figure.unit.name, figure.ok() ? "ok" : "MISS"});
    if (figure.other) {
      rows.push_back(
          {"  " + figure.other->label, "", shown(figure, figure.other->value, 1), figure.unit.name, "*"});
      std::string note =
          fmt::format("* computed: {}; {}: {}", figure.reading, figure.other->label, figure.other->how);
      if (std::find(notes.begin(), notes.end(), note) == notes.end()) notes.push_back(std::move(note));
    }
  }
  flush();
}

std::string expected(const SearchFinding& finding) {
  const auto shown = [&](double value) { return fmt::format("{:.{}f}", value, finding.decimals); };
  if (finding.at_least && finding.at_most) {
    return *finding.at_least == *finding.at_most
               ? shown(*finding.at_least)
               : fmt::format("{} to {}", shown(*finding.at_least), shown(*finding.at_most));
  }
  if (finding.at_least) return fmt::format("at least {}", shown(*finding.at_least));
  if (finding.at_most) return fmt::format("at most {}", shown(*finding.at_most));
  return "";
}

void print_search(Sheet& sheet, const Reproduction& reproduction) {
  std::string heading;
  std::vector<std::vector<std::string>> rows;
  const auto flush = [&] {
    if (rows.empty()) return;
    sheet.heading(heading);
    sheet.table({"searched again", "computed", "unit", "expected", ""}, rows);
    rows.clear();
  };
  for (const SearchFinding& finding : reproduction.search) {
    if (finding.source != heading) {
      flush();
      heading = finding.source;
    }
    const std::string judged = expected(finding);
    rows.push_back({finding.what, fmt::format("{:.{}f}", finding.value, finding.decimals), finding.unit, judged,
                    judged.empty() ? ""
                    : finding.ok() ? "ok"
                                   : "MISS"});
  }
  flush();
}

void print_errata(Sheet& sheet, const std::string& heading, const std::vector<Erratum>& errata) {
  if (errata.empty()) return;
  sheet.heading(heading);
  for (const Erratum& erratum : errata) {
    sheet.paragraph(fmt::format("{}: {} → {}", erratum.where, erratum.printed, erratum.right));
    sheet.paragraph(erratum.reason, 6, Tint::dim);
  }
}

std::string text(const Reproduction& reproduction, const Terminal& terminal) {
  Sheet sheet(terminal);
  sheet.title(reproduction.device, reproduction.source);
  print_figures(sheet, reproduction);
  print_search(sheet, reproduction);
  print_errata(sheet, "Stated, but not reproduced", reproduction.not_reproduced);
  print_errata(sheet, "Errata", reproduction.errata);
  sheet.heading("Measured only");
  for (const std::string& item : reproduction.measured_only) sheet.paragraph(item);
  sheet.gap();
  const int all = static_cast<int>(reproduction.figures.size()), bad = missed(reproduction);
  sheet.line(bad == 0
                 ? fmt::format("{}: all {} published figures reproduced.", reproduction.device, all)
                 : fmt::format("{}: {} of {} published figures differ beyond their tolerance (MISS above).",
                               reproduction.device, bad, all));
  if (const int found = static_cast<int>(reproduction.search.size()); found > 0) {
    const int short_of = fallen_short(reproduction);
    sheet.line(short_of == 0 ? fmt::format("{}: our searches find what they should.", reproduction.device)
                             : fmt::format("{}: {} of {} findings of our searches fall short (MISS above).",
                                           reproduction.device, short_of, found));
  }
  return sheet.text();
}

Json json(const std::vector<Erratum>& errata) {
  Json list = Json::array();
  for (const Erratum& erratum : errata) {
    list.push_back({{"where", erratum.where},
                    {"printed", erratum.printed},
                    {"right", erratum.right},
                    {"reason", erratum.reason}});
  }
  return list;
}

Json json(const Reproduction& reproduction) {
  Json figures = Json::array();
  for (const ReproducedFigure& figure : reproduction.figures) {
    Json one;
    one["id"] = figure.id;
    one["source"] = figure.source;
    one["what"] = figure.what;
    one["unit"] = figure.unit.si_name;
    one["printed"] = figure.printed;
    one["computed"] = json_number(figure.computed);
    one["difference"] = json_number(figure.difference());
    one["tolerance"] = figure.tolerance;
    one["ok"] = figure.ok();
    if (!figure.reading.empty()) one["reading"] = figure.reading;
    if (figure.other) {
      one["other"] = {{"label", figure.other->label},
                      {"value", json_number(figure.other->value)},
                      {"how", figure.other->how}};
    }
    figures.push_back(std::move(one));
  }
  Json search = Json::array();
  for (const SearchFinding& finding : reproduction.search) {
    Json one;
    one["id"] = finding.id;
    one["source"] = finding.source;
    one["what"] = finding.what;
    one["unit"] = finding.unit.empty() ? "1" : finding.unit;
    one["computed"] = json_number(finding.value);
    if (finding.at_least) one["at_least"] = *finding.at_least;
    if (finding.at_most) one["at_most"] = *finding.at_most;
    one["ok"] = finding.ok();
    search.push_back(std::move(one));
  }
  Json document;
  document["device"] = reproduction.device;
  document["source"] = reproduction.source;
  document["reproduced"] = static_cast<int>(reproduction.figures.size()) - missed(reproduction);
  document["missed"] = missed(reproduction);
  document["figures"] = std::move(figures);
  document["search"] = std::move(search);
  document["not_reproduced"] = json(reproduction.not_reproduced);
  document["errata"] = json(reproduction.errata);
  document["measured_only"] = reproduction.measured_only;
  return document;
}

int reproduce(const Arguments& arguments, const Terminal& terminal) {
  Json documents = Json::array();
  int bad = 0;
  bool found = false;
  for (const Source& source : sources()) {
    if (!arguments.device.empty() && !covers(source, arguments.device)) continue;
    found = true;
    const Reproduction reproduction = source.reproduce(catalogue());
    bad += missed(reproduction) + fallen_short(reproduction);
    if (arguments.json) {
      documents.push_back(json(reproduction));
    } else {
      print(text(reproduction, terminal));
    }
  }
  if (!found) {
    std::string names;
    for (const Source& source : sources()) names += (names.empty() ? "" : ", ") + source.device;
    throw InputError(
        fmt::format("no published figures are known for \"{}\": name one of {}, or none for all of them",
                    arguments.device, names));
  }
  if (arguments.json) print_json({{"reproductions", std::move(documents)}});
  return arguments.strict && bad > 0 ? kNo : kDone;
}

}  // namespace

void add_reproduce(CLI::App& app, Context& context) {
  const auto arguments = std::make_shared<Arguments>();
  CLI::App* verb =
      add_verb(app, "reproduce", "Published figures next to computed ones",
               "  zwidth reproduce                  every source\n"
               "  zwidth reproduce delta --strict   exit 1 if a figure differs beyond its tolerance\n"
               "  zwidth reproduce delta --json     every figure with its difference and tolerance");
  verb->add_option("NAME", arguments->device,
                   "Built-in device whose source is reproduced; all of them if left out");
  verb->add_flag("--strict", arguments->strict, "Exit 1 if any figure differs beyond its tolerance");
  add_json_flag(*verb, arguments->json);
  verb->callback([arguments, &context] {
    context.run = [arguments, &context] { return reproduce(*arguments, context.terminal); };
  });
}

}  // namespace zwidth
