#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <memory>

#include "reach.h"
#include "section.h"
#include "verbs.h"

namespace zwidth {

namespace {

int run_at(const at::Arguments& arguments, const Terminal& terminal) {
  if (arguments.joints.empty() == arguments.position.empty()) {
    throw InputError(
        "give either --joints (e.g. --joints 10deg,20deg,30deg) or --position (e.g. --position 0,0,150mm)");
  }
  at::check_only(arguments.only);
  const Model model(read_device(arguments));
  const at::Frame frame = at::frame_of(arguments, model.description, model.mechanism);
  at::Found found = at::find_posture(model, arguments, frame);
  const char* status = to_string(found.solution.status);

  at::Answer answer(terminal, arguments.only);
  answer.put("device", model.description.name);
  answer.put("status", status);
  answer.put("frame", arguments.frame);
  const std::string& where = arguments.joints.empty() ? arguments.position : arguments.joints;
  answer.page().title(
      fmt::format("{} at {}", model.description.name, where),
      arguments.frame == "user" ? "user's frame: x to the user, y right, z up" : "device frame");
  const Tint tint = !found.reached()                                 ? Tint::bad
                    : found.solution.status == SolveStatus::degraded ? Tint::warning
                                                                     : Tint::good;
  answer.page().row("status", tinted(terminal, tint, status));
  if (!found.reason.empty()) answer.page().paragraph(found.reason, 2, Tint::bad);

  if (found.solution) at::write_sections(at::Situation(model, arguments, frame, found.solution), answer);
  if (!arguments.position.empty()) {
    at::write_branches(found, model, answer);
    if (!found.reached()) at::write_nearest(found, model, arguments, frame, answer);
  }
  if (!found.reason.empty()) answer.put("reason", found.reason);
  if (arguments.json) {
    print_json(answer.document());
    if (!found.reached()) complain(fmt::format("{}: {}", status, found.reason));
  } else {
    print(answer.text());
  }
  return found.reached() ? kDone : kNo;
}

}  // namespace

void add_at(CLI::App& app, Context& context) {
  CLI::App* verb = add_verb(
      app, "at", "Everything about one posture",
      "  zwidth at delta --joints 10deg,20deg,30deg\n"
      "  zwidth at delta --position 20mm,-30mm,120mm          with every branch of the inverse kinematics\n"
      "  zwidth at delta --joints 0,0,0 --load 1,2,3 --json   torques for a force on the hand\n"
      "  zwidth at delta --position 0,0,0.15 --only position,force_limits\n"
      "\nThe load is the force that the device exerts on the user's hand, so torques = gravity_torques + J^T "
      "load\n"
      "(at rest). Numbers without a unit are SI: metres, radians, newtons.");
  auto arguments = std::make_shared<at::Arguments>();
  add_device_arguments(*verb, *arguments);
  verb->add_option("--joints", arguments->joints, "values of the active joints, between commas")
      ->type_name("A,B,...");
  verb->add_option("--position", arguments->position, "position of the tool; X,Y of one that moves in a plane")
      ->type_name("X,Y,Z");
  verb->add_option("--load", arguments->load, "force that the device exerts on the hand")
      ->type_name("FX,FY,FZ");
  verb->add_option("--rate", arguments->rate, "rates of the active joints")->type_name("A,B,...");
  verb->add_option("--acceleration", arguments->acceleration, "accelerations of the active joints")
      ->type_name("A,B,...");
  verb->add_option("--frame", arguments->frame,
                   "frame of positions and forces, given and printed: device or user")
      ->type_name("FRAME");
  verb->add_option("--only", arguments->only, "keys of docs/json.md to answer; the page shows their lines only")
      ->type_name("KEY,...")
      ->delimiter(',')
      ->allow_extra_args(false);
  verb->callback([arguments, &context] {
    context.run = [arguments, &context] { return run_at(*arguments, context.terminal); };
  });
}

}  // namespace zwidth
