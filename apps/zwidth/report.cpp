#include <CLI/CLI.hpp>
#include <filesystem>
#include <fmt/format.h>
#include <memory>
#include <mutex>

#include "interrupt.h"
#include "sheet_figures.h"
#include "sheet_html.h"
#include "sheet_json.h"
#include "sheet_text.h"
#include "verbs.h"

#include "zwidth/analysis/data_sheet.h"

namespace zwidth {

namespace {

namespace fs = std::filesystem;

struct ReportArguments : DeviceArguments {
  std::string directory;
};

int report(const ReportArguments& arguments, const Terminal& terminal) {
  const Description description = read_device(arguments);
  DataSheetOptions options;
  options.surface_divisions = 14;  // enough for the figures of a page
  options.effort.cancel = &stop_on_interrupt();
  DataSheet sheet;
  {
    Progress progress("data sheet", "%");
    std::mutex mutex;
    options.effort.progress = [&](double fraction) {
      const std::lock_guard lock(mutex);
      progress.update(100.0 * fraction, 100.0);
    };
    sheet = data_sheet(description, options);
  }
  if (!sheet.complete) {
    complain("stopped before the end; nothing was written");
    return kNo;
  }
  // Only now: a design that cannot be computed leaves nothing behind.
  const fs::path directory = results_directory(arguments.directory, fs::path("report") / description.name);
  const std::vector<SheetFigure> figures = sheet_figures(sheet, description);
  const Json document = data_sheet_json(sheet, description);
  for (const SheetFigure& figure : figures)
    write_file((directory / "figures" / (figure.id + ".svg")).string(), standalone_svg(figure));
  write_file((directory / "report.json").string(), document.dump(2) + "\n");
  const std::string page = (directory / "report.html").string();
  write_file(page, data_sheet_html(sheet, description, figures, arguments.overrides));
  if (arguments.json) {
    print_json(document);
    complain("report: " + page);
    return kDone;
  }
  Sheet files(terminal);
  files.heading("Files");
  files.row("page with figures", page);
  files.row("numbers, SI", (directory / "report.json").string());
  files.row("figures", fmt::format("{}/*.svg", (directory / "figures").string()));
  print(data_sheet_text(sheet, description, terminal) + "\n" + files.text());
  return kDone;
}

}  // namespace

void add_report(CLI::App& app, Context& context) {
  CLI::App* verb =
      add_verb(app, "report", "The data sheet of a device: text, a page with figures, JSON",
               "  zwidth report delta                                  writes report/delta/report.html\n"
               "  zwidth report mine.toml -o out\n"
               "  zwidth report delta --set mechanism.forearm=\"170 mm\" -o longer\n"
               "  zwidth report delta --json | jq .workspace.volume");
  auto arguments = std::make_shared<ReportArguments>();
  add_device_arguments(*verb, *arguments);
  verb->add_option("-o,--output", arguments->directory,
                   "directory for report.html, report.json and figures/; report/NAME if not given")
      ->type_name("DIR");
  verb->callback([arguments, &context] {
    context.run = [arguments, &context] { return report(*arguments, context.terminal); };
  });
}

}  // namespace zwidth
