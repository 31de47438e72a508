#include <fmt/format.h>

#include "efforts.h"
#include "figure/svg.h"
#include "mechanics.h"
#include "sheet_page.h"
#include "sheet_stiffness.h"
#include "terminal.h"

namespace zwidth {

void write_arm(SheetPage& page) {
  const DataSheet& sheet = page.sheet();
  const ArmSheet& arm = *sheet.arm;
  const Mechanism mechanism(page.description());
  if (arm.pose) {
    const bool moves = arm.pose->dimension() > 0;
    page.section("pose", moves ? "Workspace in one orientation" : "Orientations");
    page.how(moves ? "Where the tool can be without turning, away from its home posture: no joint beyond its "
                     "range, no "
                     "singularity passed."
                   : "How the tool can be turned away from its home posture: no joint beyond its range, no "
                     "singularity "
                     "passed.");
    page.facts(pose_facts(*arm.pose));
    page.show_figures("pose", "three");
    if (const std::vector<ArmFact> loads = pose_load_facts(*arm.pose); !loads.empty()) {
      page.how(
          "Pure forces and pure moments of the continuous torques over these places, whichever way is weaker; "
          "the "
          "device's own weight is not taken off.");
      page.facts(loads);
    }
    if (const std::vector<ArmFact> anyhow = any_orientation_facts(*arm.pose); !anyhow.empty()) {
      page.section("any-orientation", "Workspace in any orientation");
      page.how(
          "Where the tool can be led to from home, turning on the way as its joints need, and how it can be "
          "turned "
          "there: of all orientations, and every way from that of home.");
      page.facts(anyhow);
    }
    page.section("turning", "Turned at home");
    page.how("How far the tool turns at its home place: about one axis alone, and of all orientations.");
    page.facts(turning_facts(arm.pose->turning));
  }
  if (mechanism.linear_rows() > 0) {
    page.section("reach", arm.pose ? "Reach of the tool point in any orientation" : "Reach of the tool point");
    page.facts(reach_facts(arm, mechanism));
    page.show_figures("reach", "three");
  }
  if (arm.orientations) {
    page.section("orientations", "Orientations of the tool");
    page.how(
        "How the tool can be turned at the places that it reaches, with the joints in their ranges: of "
        "orientations spread evenly over all there are, and directions of its axis over the sphere, those "
        "that a posture has.");
    page.facts(orientation_facts(arm.orientations, home_turning(arm)));
  }
  if (arm.home) {
    page.section("home", "Home posture");
    page.facts(home_facts(arm, mechanism));
  }
  for (const PostureTable& table : arm_tables(sheet, mechanism)) {
    page.section(table.id, table.title);
    page.how(table.how);
    page.statistics_head("Over the joint ranges", table.quantiles);
    for (const PostureRow& row : table.rows) page.statistics(row.name, *row.statistic, row.factor, row.unit);
    page.statistics_end();
    if (table.id == "inertia")
      page.values_table([](const DescribedValue& value) { return value.table.starts_with("body"); }, true);
  }
}

void write_inertia(SheetPage& page) {
  const DataSheet& sheet = page.sheet();
  if (!sheet.mechanics || !knows_inertia(sheet.mechanics->sweep)) return;
  const MechanicalSweep& sweep = sheet.mechanics->sweep;
  page.section("inertia", "Inertia");
  page.how("Apparent mass at the tool, free to move sideways, with rotors and transmissions.");
  page.statistics_head(sweep.spacing, true);
  for (const std::vector<std::string>& row : inertia_rows(sweep, sheet.joint_slides)) page.statistics_row(row);
  page.statistics_end();
  page.add(fmt::format("<p>{}</p>\n", escaped(acceleration_text(sweep, sheet.plane.has_value()))));
  page.show_figures("inertia", "three");
  page.values_table([](const DescribedValue& value) { return value.table.starts_with("body"); }, true);
}

void write_stiffness(SheetPage& page) {
  const DataSheet& sheet = page.sheet();
  page.section("stiffness", "Stiffness and vibration");
  if (sheet.stiffness) {
    page.how(stiffness_how(*sheet.stiffness));
    page.statistics_head(sentence(stiffness_over(sheet)), true);
    for (const std::vector<std::string>& row : stiffness_rows(sheet)) page.statistics_row(row);
    page.statistics_end();
    page.add(fmt::format("<p>What gives way: {}.</p>\n", escaped(give_text(*sheet.stiffness))));
  }
  if (sheet.mechanics && sheet.mechanics->sweep.of) {
    std::string places;
    for (const MechanicsPlace& place : mechanics_places(sheet.mechanics->sweep, sheet.plane.has_value()))
      places += fmt::format("{}{}: {} {}", places.empty() ? "" : "; ", place.name, place.value, place.place);
    if (!places.empty()) page.add(fmt::format("<p>Over the workspace: {}.</p>\n", escaped(places)));
    page.show_figures("stiffness", "three");
  }
  for (const std::string& laminate : laminate_texts(page.description()))
    page.add(fmt::format("<p>{}</p>\n", escaped(laminate)));
  for (const std::string& missing : not_given(sheet)) page.add(fmt::format("<p>{}</p>\n", escaped(missing)));
}

}  // namespace zwidth
