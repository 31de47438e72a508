#pragma once

#include "context.h"

/// The verbs of the command, one file each. Every function adds its verb to the command line.

namespace zwidth {

void add_report(CLI::App& app, Context& context);
void add_at(CLI::App& app, Context& context);
void add_workspace(CLI::App& app, Context& context);
void add_size(CLI::App& app, Context& context);
void add_reproduce(CLI::App& app, Context& context);
void add_synthesise(CLI::App& app, Context& context);
void add_optimise(CLI::App& app, Context& context);
void add_show(CLI::App& app, Context& context);
void add_export(CLI::App& app, Context& context);
void add_check(CLI::App& app, Context& context);
void add_devices(CLI::App& app, Context& context);
void add_figures(CLI::App& app, Context& context);
void add_parts(CLI::App& app, Context& context);
void add_completion(CLI::App& app, Context& context);

}  // namespace zwidth
