#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <sstream>

#include "optimise/outcome.h"
#include "optimise/outcome_page.h"

#include "zwidth/description/write.h"

namespace zwidth {

namespace {

std::string csv_field(const std::string& text) {
  if (text.find_first_of(",\"\n") == text.npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? "\"\"" : std::string(1, c);
  return quoted + '"';
}

std::string pareto_csv(const StudyOutcome& outcome, const Study& study) {
  std::string text;
  const auto cell = [&](const std::string& value, bool last) {
    text += csv_field(value) + (last ? "\n" : ",");
  };
  for (const StudyVariable& one : study.variables) cell(one.name, false);
  for (const StudyObjective& one : study.objectives)
    cell(one.name, study.constraints.empty() && &one == &study.objectives.back());
  for (const StudyConstraint& one : study.constraints) cell(one.name, &one == &study.constraints.back());
  for (const DesignSheet& sheet : outcome.front) {
    std::vector<std::string> row;
    for (const DesignValue& one : sheet.variables) {
      row.push_back(one.part.empty() ? fmt::format("{}", one.value) : one.part);
    }
    for (const double value : sheet.objectives) row.push_back(fmt::format("{}", value));
    for (const double value : sheet.constraints) row.push_back(fmt::format("{}", value));
    for (std::size_t i = 0; i < row.size(); ++i) cell(row[i], i + 1 == row.size());
  }
  return text;
}

std::string history_csv(const StudyOutcome& outcome) {
  std::string text =
      "generation,evaluations,feasible_share,front,hypervolume,seconds_evaluating,seconds_in_algorithm\n";
  for (const Generation& one : outcome.result.history) {
    text += fmt::format("{},{},{},{},{},{:.6f},{:.6f}\n", one.number, one.evaluations, one.feasible_share,
                        one.front, std::isnan(one.hypervolume) ? "" : fmt::format("{}", one.hypervolume),
                        one.seconds_evaluating, one.seconds_in_algorithm);
  }
  return text;
}

/// The chosen design as a device of its own.
std::string chosen_device(const StudyOutcome& outcome, const StudyModel& model) {
  const Study& study = model.study();
  StudyEvaluator evaluator(model);
  const std::string source = fmt::format("chosen: by the study {}", study.name);
  Description device = evaluator.description(outcome.design(*outcome.chosen), source);
  device.source = fmt::format("{}, from the device {} ({})", source, device.name, device.source);
  device.title = study.title;
  device.name = study.name;
  std::ostringstream text;
  write_description(device, text, catalogue());
  return text.str();
}

}  // namespace

std::vector<std::pair<std::string, std::string>> write_outcome(const StudyOutcome& outcome,
                                                               const StudyModel& model,
                                                               const std::string& directory) {
  const Study& study = model.study();
  std::vector<std::pair<std::string, std::string>> files;
  const auto write = [&](const std::string& what, const std::string& name, const std::string& text) {
    const std::string path = (std::filesystem::path(directory) / name).string();
    write_file(path, text);
    files.emplace_back(what, path);
  };
  const std::vector<SheetFigure> figures = outcome_drawings(outcome, model);
  write("page with figures", "index.html", outcome_page(outcome, model, figures));
  if (outcome.chosen) write("chosen device", "chosen.toml", chosen_device(outcome, model));
  if (!outcome.front.empty()) write("Pareto set", "pareto.csv", pareto_csv(outcome, study));
  write("numbers, SI", "pareto.json", outcome_json(outcome, model).dump(2) + "\n");
  write("history", "history.csv", history_csv(outcome));
  for (const SheetFigure& figure : figures) {
    write_file((std::filesystem::path(directory) / "figures" / (figure.id + ".svg")).string(),
               standalone_svg(figure));
  }
  if (!figures.empty()) files.emplace_back("figures", directory + "/figures/*.svg");
  files.emplace_back("to go on from", (std::filesystem::path(directory) / "checkpoint").string());
  return files;
}

}  // namespace zwidth
