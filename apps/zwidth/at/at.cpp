#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <memory>

#include "reach.h"
#include "section.h"
#include "verbs.h"

namespace zwidth {

namespace {

/// A tool that only turns is where it is: of it an orientation alone says all.
void place_what_only_turns(at::Arguments& arguments, const Model& model, const at::Frame& frame) {
  const Mechanism& mechanism = model.mechanism;
  if (!arguments.joints.empty() || !arguments.position.empty() || mechanism.linear_rows() > 0) return;
  ActiveVector home(mechanism.active_count());
  for (int i = 0; i < home.size(); ++i) home[i] = mechanism.home_guess()[mechanism.active_joint(i)];
  const Solution there = solve_forward(mechanism, home);
  if (!there) return;
  const Vector3 p = frame.R * there.posture->tool().position;
  arguments.position = fmt::format("{},{},{}", p.x(), p.y(), p.z());
}

int run_at(at::Arguments arguments, const Terminal& terminal) {
  at::check_only(arguments.only);
  const Model model(read_device(arguments));
  const at::Frame frame = at::frame_of(arguments, model.description, model.mechanism);
  const std::string where_given = arguments.joints.empty() ? arguments.position : arguments.joints;
  if (!arguments.orientation.empty() || !arguments.rotation.empty())
    place_what_only_turns(arguments, model, frame);
  if (arguments.joints.empty() == arguments.position.empty()) {
    throw InputError(
        model.mechanism.linear_rows() > 0
            ? "give either --joints (e.g. --joints 10deg,20deg,30deg) or --position (e.g. --position 0,0,150mm)"
            : "give either --joints (e.g. --joints 10deg,20deg) or --orientation (e.g. --orientation "
              "10deg,20deg,0)");
  }
  for (const auto& [option, value] : {std::pair("--orientation", &arguments.orientation),
                                      {"--rotation", &arguments.rotation},
                                      {"--keep", &arguments.keep},
                                      {"--near", &arguments.near},
                                      {"--maximise", &arguments.maximise}}) {
    if (!value->empty() && arguments.position.empty())
      throw InputError(
          fmt::format("{} {}: goes with --position; joint values leave nothing open", option, *value));
  }
  at::Found found;
  at::find_posture(model, arguments, frame, found);
  const char* status = to_string(found.solution.status);

  at::Answer answer(terminal, arguments.only);
  answer.put("device", model.description.name);
  answer.put("status", status);
  const bool degraded = found.solution.near_singularity();
  answer.put("degraded", degraded);
  answer.put("frame", arguments.frame);
  std::string where = where_given.empty() ? "" : " at " + where_given;
  const std::string& turned = arguments.orientation.empty() ? arguments.rotation : arguments.orientation;
  if (!turned.empty()) where += (where.empty() ? " turned " : ", turned ") + turned;
  answer.page().title(model.description.name + where, arguments.frame == "user"
                                                          ? "user's frame: x to the user, y right, z up"
                                                          : "device frame");
  const Tint tint = !found.reached() ? Tint::bad : degraded ? Tint::warning : Tint::good;
  const bool both = degraded && found.solution.status != SolveStatus::degraded;
  answer.page().row("status", tinted(terminal, tint, fmt::format("{}{}", status, both ? ", degraded" : "")));
  at::write_choice(found, model, answer);
  if (!found.reason.empty()) answer.page().paragraph(found.reason, 2, Tint::bad);

  if (found.solution) at::write_sections(at::Situation(model, arguments, frame, found.solution), answer);
  if (!arguments.position.empty()) {
    at::write_branches(found, model, answer);
    if (!found.reached() && !found.kept_in_vain) at::write_nearest(found, model, arguments, frame, answer);
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
      "  zwidth at seven-dof --position 0.35,0.05,0.1         the posture nearest to home, however the tool "
      "turns\n"
      "  zwidth at seven-dof --position 0.3,0,0.1 --orientation 0,90deg,0 --keep theta3\n"
      "\nThe load is the force that the device exerts on the user's hand, so torques = gravity_torques + J^T "
      "load (at rest). Numbers without a unit are SI: metres, radians, newtons.\n"
      "\nAn orientation is R = Rz(yaw) Ry(pitch) Rx(roll), about the fixed axes of the frame, or a quaternion; "
      "R's columns are the axes of the tool, as in the answer. Left out, an arm of one leg may turn its tool "
      "as "
      "it likes, and other tools keep their axes along those of the base. Joints that the goal leaves open are "
      "chosen by --keep, --near or --maximise: a position alone takes the posture nearest to home without "
      "them, "
      "a pose needs one of them.");
  auto arguments = std::make_shared<at::Arguments>();
  add_device_arguments(*verb, *arguments);
  verb->add_option("--joints", arguments->joints,
                   "values of the active joints, between commas; those that the hand alone moves may be left "
                   "out, and are then at home")
      ->type_name("A,B,...");
  verb->add_option("--position", arguments->position,
                   "position of the tool; X,Y of one that moves in a plane, left out of one that only turns")
      ->type_name("X,Y,Z");
  verb->add_option("--orientation", arguments->orientation,
                   "orientation of the tool: angles ROLL,PITCH,YAW or a quaternion W,X,Y,Z")
      ->type_name("A,B,C[,D]");
  verb->add_option("--rotation", arguments->rotation, "the same as a matrix: nine numbers, row by row")
      ->type_name("R11,R12,...");
  verb->add_option(
          "--keep", arguments->keep,
          "of an arm with joints to spare: hold this joint, at a value or where it is in --near or home")
      ->type_name("JOINT[=VALUE]");
  verb->add_option("--near", arguments->near, "take the posture nearest to these joint values, or to home")
      ->type_name("A,B,...");
  verb->add_option("--maximise", arguments->maximise,
                   "take the posture with the largest manipulability, inverse_condition or limit_distance")
      ->type_name("FIGURE");
  verb->add_option("--load", arguments->load, "force that the device exerts on the hand")
      ->type_name("FX,FY,FZ");
  verb->add_option("--rate", arguments->rate, "rates of the active joints")->type_name("A,B,...");
  verb->add_option("--acceleration", arguments->acceleration, "accelerations of the active joints")
      ->type_name("A,B,...");
  verb->add_option("--torque", arguments->torque,
                   "torques of the drives, to ask how joints and tool accelerate under them")
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
