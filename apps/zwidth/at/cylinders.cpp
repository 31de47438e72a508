#include <fmt/format.h>

#include "section.h"

#include "zwidth/mechanism/dynamics.h"

/// From the torques of a posture to the pressures of its cylinders and the commands of their regulators.

namespace zwidth::at {

void write_cylinders(const Situation& at, Answer& answer) {
  if (at.model.description.pneumatic_drives.empty()) return;
  ToolVector push = ToolVector::Zero(at.mechanism.tool_rows());
  if (at.load) push = -(at.frame.turn.transpose() * *at.load);
  const ActiveVector torques = inverse_dynamics(at.posture, at.rate, at.acceleration, push);
  const ActiveVector joints = at.posture.active();
  Json list = Json::array();
  std::vector<std::vector<std::string>> rows;
  for (int j = 0; j < at.mechanism.active_count(); ++j) {
    const auto& drive = at.model.pneumatic_drives[static_cast<size_t>(j)];
    if (!drive) continue;
    const std::string& name = at.mechanism.active_names()[static_cast<size_t>(j)];
    const PneumaticCommand command = drive->command(torques[j], joints[j]);
    Json entry;
    entry["joint"] = name;
    entry["status"] = to_string(command.status);
    entry["length"] = json_number(drive->length(joints[j]));
    entry["lever"] = json_number(drive->lever(joints[j]));
    entry["torque"] = json_number(torques[j]);
    entry["torque_range"] = json_interval(drive->torque_range(joints[j]));
    entry["force"] = json_number(command.force);
    entry["force_range"] = json_interval(drive->force_range());
    entry["pressures"] = {json_number(command.pressures.rear), json_number(command.pressures.rod)};
    entry["voltages"] = {json_number(command.voltages[0]), json_number(command.voltages[1])};
    list.push_back(entry);
    rows.push_back({name, drive->arm() ? number(drive->lever(joints[j]) * kMilli) : "–", number(command.force),
                    number(command.pressures.rear / kMilli), number(command.pressures.rod / kMilli),
                    fmt::format("{} {}", number(command.voltages[0], 3), number(command.voltages[1], 3)),
                    command.status == PneumaticStatus::ok ? "✓" : to_string(command.status)});
  }
  answer.put("cylinders", list);
  answer.page().table({"joint", "lever mm", "push N", "rear kPa", "rod kPa", "commands V", ""}, rows);
}

}  // namespace zwidth::at
