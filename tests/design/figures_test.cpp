#include "zwidth/design/figures.h"

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <gtest/gtest.h>
#include <set>
#include <sstream>

#include "zwidth/analysis/force.h"
#include "zwidth/analysis/workspace.h"
#include "zwidth/description/read.h"
#include "zwidth/mechanism/dynamics.h"
#include "zwidth/mechanism/r_cube_stiffness.h"

namespace zwidth {
namespace {

const Catalogue& catalogue() {
  static const Catalogue loaded = Catalogue::load();
  return loaded;
}

double at(const BuiltDevice& device, const ActiveVector& joints, std::string_view name,
          const FigureOptions& options = {}) {
  const Solution solution = solve_forward(device.mechanism(), joints);
  EXPECT_TRUE(solution) << name;
  PostureFigures posture(device, *solution.posture);
  return figure_value(*find_figure(name), posture, options);
}

// docs/figures.md as the table of figures makes it.
std::string document() {
  std::string text =
      "# Figures\n\nWhat a `[[measure]]` of a [study](study_file.md) may ask for; `zwidth figures` lists the "
      "same, and "
      "`zwidth figures WORD` what\nis about one thing. Units are SI; where none stands, the number has none or "
      "it depends on "
      "the device. Options have their value\nin brackets if they are not given; those that count start from 0, "
      "and -1 takes "
      "all. Each figure equals what stands in the\nlast column: in `zwidth at DEVICE ... --json`, or in "
      "`zwidth report DEVICE "
      "--json`, where over the workspace.\n";
  std::string heading;
  for (const FigureDefinition& figure : figure_definitions()) {
    const std::string group =
        figure.topic + (figure.of_posture ? ", of a posture" : ", of the device as a whole");
    if (group != heading)
      text += "\n## " + group + "\n\n| figure | unit | what | options | same as |\n|---|---|---|---|---|\n";
    heading = group;
    const bool unitless = figure.unit == "1" || figure.unit == "SI";
    std::string options, answers;
    if (figure.load != FigureLoad::none) {
      options = figure.load == FigureLoad::needed ? "`force`, `moment`" : "`force`, `moment` if there are any";
    }
    for (const FigureOption& one : figure.options) {
      std::string value = std::to_string(one.otherwise);
      value.erase(value.find_last_not_of('0') + 1);
      if (value.back() == '.') value.pop_back();
      options += (options.empty() ? "" : "; ") + ("`" + one.name + "` (" + value + ") ") + one.meaning;
    }
    for (const FigureAnswer& one : figure.answers) answers += (answers.empty() ? "`" : ", `") + one.place + "`";
    text += "| `" + figure.name + "` | " + (unitless ? "" : figure.unit) + " | " + figure.meaning + " | " +
            options + " | " + answers + " |\n";
  }
  return text;
}

TEST(Figures, TheDocumentHasThemAll) {
  if (std::getenv("ZWIDTH_UPDATE") != nullptr) {
    std::ofstream(ZWIDTH_FIGURES_DOC) << document();
    return;
  }
  std::ostringstream text;
  text << std::ifstream(ZWIDTH_FIGURES_DOC).rdbuf();
  EXPECT_TRUE(text.str() == document())
      << "docs/figures.md is out of date; ZWIDTH_UPDATE=1 design_test writes it anew";
}

TEST(Figures, HaveNamesOfTheirOwn) {
  std::set<std::string_view> names;
  for (const FigureDefinition& figure : figure_definitions()) {
    EXPECT_TRUE(names.insert(figure.name).second) << figure.name;
    EXPECT_FALSE(figure.unit.empty() || figure.meaning.empty()) << figure.name;
    EXPECT_NE(figure.of == nullptr, figure.of_device == nullptr) << figure.name;
    EXPECT_EQ(find_figure(figure.name), &figure);
  }
  EXPECT_EQ(find_figure("no_such"), nullptr);
}

// Of every built-in device in a posture off its middle: a number or undefined, never infinite.
TEST(Figures, AreNumbersOrUndefined) {
  for (const BuiltinFile& file : catalogue().devices()) {
    const Description description = read_description(file.name, {}, catalogue());
    const auto device = BuiltDevice::try_make(description, true);
    ASSERT_TRUE(device) << file.name;
    ActiveVector joints(device->mechanism().active_count());
    for (int i = 0; i < joints.size(); ++i) {
      const Interval range = device->mechanism().active_range(i);
      joints[i] = device->mechanism().home_guess()[device->mechanism().active_joint(i)] + 0.03 * range.width();
      if (!range.contains(joints[i])) joints[i] -= 0.06 * range.width();
    }
    FigureOptions options;
    options.load << 1.0, 2.0, 3.0, 0.0, 0.0, 0.0;
    int defined = 0;
    for (const FigureDefinition& figure : figure_definitions()) {
      if (!figure.of_posture) continue;
      const double value = at(*device, joints, figure.name, options);
      EXPECT_FALSE(std::isinf(value)) << file.name << " " << figure.name;
      defined += std::isnan(value) ? 0 : 1;
    }
    EXPECT_GE(defined, 8) << file.name;
  }
}

TEST(Figures, OfThePostureAreThoseOfTheLibrary) {
  const Description description = read_description("delta", {}, catalogue());
  const auto device = BuiltDevice::try_make(description, true);
  ASSERT_TRUE(device);
  const ActiveVector joints = Vector3(0.2, 0.5, 0.8);
  const Solution solution = solve_forward(device->mechanism(), joints);
  const Jacobian J = jacobian(*solution.posture);
  EXPECT_DOUBLE_EQ(at(*device, joints, "condition_number"), dexterity(J).condition_number);
  EXPECT_DOUBLE_EQ(at(*device, joints, "inverse_condition") * at(*device, joints, "condition_number"), 1.0);
  const double torque = device->drives()[0]->continuous_torque().usable;
  EXPECT_DOUBLE_EQ(figure_value(*find_figure("continuous_torque"), *device, {}), torque);
  EXPECT_NEAR(at(*device, joints, "force_min"),
              force_polytope(J, ActiveVector(Vector3::Constant(torque))).weakest, 1e-12);
  const ToolMatrix mass = cartesian_mass(J, mass_matrix(*solution.posture));
  EXPECT_NEAR(at(*device, joints, "apparent_mass_determinant"), mass.determinant(), 1e-12);
  EXPECT_LT(at(*device, joints, "link_mass_max"), at(*device, joints, "apparent_mass_max"));
  FigureOptions push;
  push.load.head<3>() << 2.0, -1.0, 3.0;
  const ActiveVector hold = gravity_torques(*solution.posture) - J.transpose() * push.load.head<3>();
  EXPECT_NEAR(at(*device, joints, "load_torque", push), hold.cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_NEAR(at(*device, joints, "load_utilisation", push), hold.cwiseAbs().maxCoeff() / torque, 1e-9);
}

TEST(Figures, DeflectionGrowsWithTheLoad) {
  const Description description = read_description("r-cube", {}, catalogue());
  const auto device = BuiltDevice::try_make(description, false);
  ASSERT_TRUE(device);
  const ActiveVector joints = Vector3::Constant(0.5);
  FigureOptions one, two;
  one.load[0] = 10.0;
  two.load[0] = 20.0;
  const double small = at(*device, joints, "deflection", one), large = at(*device, joints, "deflection", two);
  EXPECT_GT(small, 0.0);
  EXPECT_NEAR(large / small, 2.0, 1e-12);
  EXPECT_GT(at(*device, joints, "natural_frequency"), 10.0);
  EXPECT_LE(at(*device, joints, "stiffness_min"), at(*device, joints, "stiffness_max"));
}

TEST(Figures, DrivesGiveUnlessTheyCountAsRigid) {
  const Description description = read_description("r-cube", {}, catalogue());
  const auto device = BuiltDevice::try_make(description, true);
  const auto links = BuiltDevice::try_make(description, false);
  ASSERT_TRUE(device && links);
  const ActiveVector joints = Vector3::Constant(0.4);
  FigureOptions rigid;
  rigid.further["drives"] = 0.0;
  EXPECT_EQ(at(*device, joints, "stiffness_min", rigid), at(*links, joints, "stiffness_min"));
  EXPECT_LT(at(*device, joints, "stiffness_min"), at(*device, joints, "stiffness_min", rigid));
  EXPECT_LT(at(*device, joints, "natural_frequency"), at(*device, joints, "natural_frequency", rigid));
  // A delta without beams gives in its drives alone.
  const Description delta = read_description("delta", {}, catalogue());
  const auto built = BuiltDevice::try_make(delta, true);
  ASSERT_TRUE(built);
  EXPECT_GT(at(*built, Vector3::Constant(0.4), "natural_frequency"), 10.0);
}

TEST(Figures, OfTheDeviceAreThoseOfTheSheet) {
  const Description description = read_description("five-bar", {}, catalogue());
  const auto device = BuiltDevice::try_make(description, true);
  ASSERT_TRUE(device);
  EXPECT_NEAR(figure_value(*find_figure("workspace_volume"), *device, {}),
              workspace_volume(device->mechanism()).value, 1e-12);
  EXPECT_NEAR(figure_value(*find_figure("inscribed_radius"), *device, {}),
              inscribed_shapes(device->mechanism()).circle().size, 1e-12);
  EXPECT_DOUBLE_EQ(figure_value(*find_figure("moving_mass"), *device, {}), moving_mass(device->mechanism()));
  EXPECT_TRUE(std::isnan(figure_value(*find_figure("cylinder_peak_force"), *device, {})));
}

TEST(BuiltDevice, RefusesWhatBreaksARule) {
  Description description = read_description("r-cube", {}, catalogue());
  EXPECT_TRUE(BuiltDevice::try_make(description, true));
  std::get<RCubeDescription>(description.mechanism).outer_link = -0.1;
  EXPECT_FALSE(BuiltDevice::try_make(description, false));
  description = read_description("r-cube", {}, catalogue());
  std::get<TubeDescription>(*description.bodies[1].beam).inner_diameter = 0.03;
  EXPECT_FALSE(BuiltDevice::try_make(description, false));
}

}  // namespace
}  // namespace zwidth
