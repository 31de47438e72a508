#include "zwidth/design/study_model.h"

#include <cmath>
#include <gtest/gtest.h>
#include <random>

#include "zwidth/actuation/arm_cylinder.h"
#include "zwidth/analysis/conditioning.h"
#include "zwidth/analysis/data_sheet.h"
#include "zwidth/analysis/five_bar_search.h"
#include "zwidth/analysis/inertia.h"
#include "zwidth/analysis/joint_torque.h"
#include "zwidth/analysis/mechanical.h"
#include "zwidth/analysis/posture_sweep.h"
#include "zwidth/analysis/r_cube_synthesis.h"
#include "zwidth/description/read.h"
#include "zwidth/description/validate.h"
#include "zwidth/design/expression_unit.h"

namespace zwidth {
namespace {

const Catalogue& catalogue() {
  static const Catalogue loaded = Catalogue::load();
  return loaded;
}

struct Loaded {
  Study study;
  Description device;
};

Loaded load(const Study& study) {
  return {study, read_description(study.device, study.overrides, catalogue())};
}

StudyCheck check() {
  return [](const Study& study) { return study_problems(study, load(study).device, catalogue()); };
}

// A small study of the five-bar, with what a test has to say.
std::string small(const std::string& more) {
  return "[study]\nname = \"small\"\ndevice = \"five-bar\"\n" + more;
}
constexpr const char* kCrank =
    "[[variable]]\nname = \"a1\"\nkey = \"mechanism.crank\"\nmin = \"9 cm\"\nmax = \"12 cm\"\n";
constexpr const char* kSmallest = "[[objective]]\nname = \"length\"\nminimise = \"a1\"\n";

std::string complaint(const std::string& text) {
  try {
    parse_study(text, "study.toml", {}, check());
  } catch (const DescriptionError& error) {
    return error.what();
  }
  return "";
}

StudyModel small_model(const std::string& more) {
  const Loaded loaded = load(parse_study(small(more), "study.toml", {}, check()));
  return StudyModel(loaded.study, loaded.device, catalogue());
}

TEST(StudyModel, EveryStudyThatComesWithZwidthMakesSense) {
  ASSERT_GE(catalogue().studies().size(), 6U);
  for (const BuiltinFile& file : catalogue().studies()) {
    EXPECT_NO_THROW(read_study(file.name, {}, catalogue(), check())) << file.name;
  }
}

// Two routes: the study's expressions and general figures, against the formulas in code.
TEST(StudyModel, RCubeStudyAgreesWithItsFormulas) {
  const Loaded loaded = load(read_study("r-cube-kinematics", {}, catalogue(), check()));
  const StudyModel model(loaded.study, loaded.device, catalogue());
  StudyEvaluator evaluator(model);
  const Material steel = std::get<Material>(std::get<TubeDescription>(*loaded.device.bodies[0].beam).wall);
  const double E = steel.elastic_modulus, G = E / (2.0 * (1.0 + steel.poisson_ratio));
  const RCubeLinkChoice links{
      .section = *tube_section(0.020, 0.010), .elastic_modulus = E, .shear_modulus = G, .density = 2000.0};
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> angle(0.3, 0.8), length(0.06, 0.25);
  int feasible = 0, infeasible = 0;
  for (int i = 0; i < 3000; ++i) {
    const RCubeDesign design{
        .max_angle = angle(random), .inner_link = length(random), .outer_link = length(random)};
    const std::vector<double> row = {design.max_angle, design.inner_link, design.outer_link};
    std::vector<double> outcome(model.search_problem().outcome_size());
    evaluator.evaluate(row, outcome);
    const auto constraints = r_cube_constraints(design);
    ASSERT_TRUE(constraints);
    const double expected[] = {constraints->far_low,     constraints->near,  constraints->raised_far,
                               constraints->raised_near, constraints->elbow, constraints->raised_elbow};
    for (int c = 0; c < 6; ++c) {
      EXPECT_NEAR(outcome[static_cast<std::size_t>(4 + c)], std::max(0.0, expected[c]),
                  1e-12 * (1.0 + std::abs(expected[c])))
          << c;
    }
    if (constraints->worst() > 0.0) {
      EXPECT_TRUE(std::isnan(outcome[0]) && std::isnan(outcome[1]) && std::isnan(outcome[2]));
      ++infeasible;
      continue;
    }
    const auto objectives = r_cube_objectives(design, links);
    if (!objectives) continue;
    EXPECT_EQ(outcome[3], 0.0);
    EXPECT_NEAR(outcome[0] / objectives->closeness, 1.0, 1e-12);
    EXPECT_NEAR(std::pow(10.0, outcome[1]) / objectives->inertia, 1.0, 1e-9);
    EXPECT_NEAR(std::pow(10.0, outcome[2]) / objectives->compliance, 1.0, 1e-9);
    ++feasible;
  }
  EXPECT_GT(feasible, 20);
  EXPECT_GT(infeasible, 100);
}

TEST(StudyModel, FiveBarGridAgreesWithItsSearch) {
  const Loaded loaded = load(read_study("five-bar-grid", {}, catalogue(), check()));
  const StudyModel model(loaded.study, loaded.device, catalogue());
  StudyEvaluator evaluator(model);
  const SearchProblem problem = model.search_problem();
  EXPECT_EQ(problem.variables[0].max, 3.0);
  EXPECT_EQ(problem.variables[1].max, 4.0);
  EXPECT_EQ(problem.variables[2].max, 2.0);
  const FiveBarSearchResult search = search_five_bars({.crank = {0.09, 0.12, 0.01},
                                                       .coupler = {0.11, 0.15, 0.01},
                                                       .base = {0.03, 0.05, 0.01},
                                                       .mode = {1, -1}});
  ASSERT_EQ(search.designs.size(), 60U);
  for (const FiveBarScore& one : search.designs) {
    const std::vector<double> row = {std::round((one.lengths[0] - 0.09) / 0.01),
                                     std::round((one.lengths[1] - 0.11) / 0.01),
                                     std::round((one.lengths[2] - 0.03) / 0.01)};
    std::vector<double> outcome(problem.outcome_size());
    evaluator.evaluate(row, outcome);
    EXPECT_EQ(outcome[0], static_cast<double>(one.bad));
    EXPECT_NEAR(-outcome[1], one.inscribed_radius, 1e-15);
  }
}

TEST(StudyModel, CylinderStudyAgreesWithTheSynthesis) {
  const Loaded loaded = load(read_study("pneumatic-arm-cylinder", {}, catalogue(), check()));
  const StudyModel model(loaded.study, loaded.device, catalogue());
  StudyEvaluator evaluator(model);
  const CylinderTravel travel{.min_length = 0.075, .max_length = 0.0875, .half_range = M_PI / 6.0};
  for (const auto& [h, l2] : {std::pair{0.01, 0.08}, {0.005, 0.07}, {0.0125, 0.085}}) {
    const auto design = design_three(travel, h, l2);
    ASSERT_TRUE(design);
    const auto peak = ArmCylinder(*design).peak_required_force(8.75, 0.11, {-M_PI / 6.0, M_PI / 6.0});
    const DesignSheet sheet = evaluator.sheet(std::vector{h / 0.00025, (l2 - 0.06) / 0.00025});
    if (!peak) {
      EXPECT_FALSE(sheet.feasible);
      continue;
    }
    EXPECT_TRUE(sheet.feasible);
    EXPECT_NEAR(sheet.objectives[0], peak->force, 1e-9 * peak->force);
  }
}

TEST(StudyModel, DesignsBecomeDescriptions) {
  const StudyModel model = small_model(
      std::string(kCrank) + "[[derived]]\nkey = \"mechanism.coupler\"\nvalue = \"2*a1\"\n" + kSmallest);
  StudyEvaluator evaluator(model);
  const Description design = evaluator.description(std::vector{0.11}, "chosen: a test");
  const auto& five_bar = std::get<FiveBarDescription>(design.mechanism);
  EXPECT_EQ(five_bar.crank, 0.11);
  EXPECT_EQ(five_bar.coupler, 0.22);
  EXPECT_EQ(five_bar.sources.at("crank"), "chosen: a test");
  EXPECT_EQ(five_bar.sources.at("coupler"), "chosen: a test");
  EXPECT_TRUE(validate(design).empty());
  EXPECT_EQ(model.device_design(), std::vector{0.10});
}

TEST(StudyModel, PartsAreChosenByName) {
  const StudyModel model = small_model(
      "[[variable]]\nname = \"motor\"\nkey = \"drive.motor\"\n"
      "parts = [\"maxon-ec-max-40-70w-48v\", \"maxon-ec-4pole-30-100w-48v\"]\n"
      "[[measure]]\nname = \"torque\"\nfigure = \"continuous_torque\"\n"
      "[[objective]]\nname = \"torque\"\nmaximise = \"torque\"\n");
  StudyEvaluator evaluator(model);
  std::vector<double> first(2), second(2), again(2);
  evaluator.evaluate(std::vector{0.0}, first);
  evaluator.evaluate(std::vector{1.0}, second);
  evaluator.evaluate(std::vector{0.0}, again);
  EXPECT_NE(first[0], second[0]);
  EXPECT_EQ(first, again);
  EXPECT_EQ(evaluator.description(std::vector{1.0}, "").drives[0].motor.info.name,
            "maxon-ec-4pole-30-100w-48v");
}

TEST(StudyModel, DesignsThatCannotBeAreNotEvaluated) {
  // The links do not reach each other: r3 >= r1 + r2.
  const StudyModel model = small_model(
      "[[variable]]\nkey = \"mechanism.half_base\"\nmin = \"2 cm\"\nmax = \"60 cm\"\n"
      "[[measure]]\nname = \"k\"\nfigure = \"condition_number\"\nposition = [0, \"18 cm\", 0]\n"
      "[[objective]]\nname = \"k\"\nminimise = \"k\"\n");
  StudyEvaluator evaluator(model);
  std::vector<double> good(2), bad(2);
  evaluator.evaluate(std::vector{0.03}, good);
  evaluator.evaluate(std::vector{0.5}, bad);
  EXPECT_EQ(good[1], 0.0);
  EXPECT_GT(good[0], 1.0);
  EXPECT_GT(bad[1], 0.0);
  EXPECT_TRUE(std::isnan(bad[0]));
}

TEST(StudyModel, TolerancesMoveAndLeaveNoTrace) {
  const StudyModel model =
      small_model(std::string(kCrank) +
                  "[[measure]]\nname = \"k\"\nfigure = \"condition_number\"\nposition = [\"5 cm\", "
                  "\"14 cm\", 0]\n[[objective]]\nname = \"k\"\nminimise = \"k\"\n"
                  "[[tolerance]]\nkey = \"mechanism.coupler\"\nhalf_width = \"1 mm\"\n");
  StudyEvaluator evaluator(model);
  const double before = evaluator.sheet(std::vector{0.1}).objectives[0];
  const double high = evaluator.sheet(std::vector{0.1}, std::vector{1.0}).objectives[0];
  const double low = evaluator.sheet(std::vector{0.1}, std::vector{-1.0}).objectives[0];
  EXPECT_NE(high, before);
  EXPECT_NEAR(0.5 * (high + low), before, 0.01 * std::abs(high - low));
  EXPECT_EQ(evaluator.sheet(std::vector{0.1}).objectives[0], before);
}

TEST(StudyModel, BoxesHaveToBeReachedAllOver) {
  const auto share = [](const char* size) {
    const StudyModel model =
        small_model(std::string(kCrank) +
                    "[[measure]]\nname = \"share\"\nfigure = \"reached_share\"\nover = \"box\"\n"
                    "position = [0, \"18 cm\", 0]\nsize = [" +
                    size + ", " + size +
                    ", 0]\npoints = 9\nstatistic = \"mean\"\n"
                    "[[measure]]\nname = \"k\"\nfigure = \"condition_number\"\nover = \"box\"\n"
                    "position = [0, \"18 cm\", 0]\nsize = [" +
                    size + ", " + size + ", 0]\npoints = 9\nstatistic = \"max\"\n" + kSmallest);
    StudyEvaluator evaluator(model);
    const DesignSheet sheet = evaluator.sheet(std::vector{0.1});
    return std::pair{sheet.derived[0].value, sheet.derived[1].value};
  };
  const auto [all, worst] = share("0.05");
  EXPECT_EQ(all, 1.0);
  EXPECT_GT(worst, 1.0);
  const auto [some, undefined] = share("0.4");
  EXPECT_GT(some, 0.0);
  EXPECT_LT(some, 1.0);
  EXPECT_TRUE(std::isnan(undefined));
}

// Two routes: a measure over the workspace, or over postures, and the sweeps of data sheets.
class OverMany {
 public:
  explicit OverMany(const std::string& device) : device_(device) {}
  double operator()(const std::string& figure, const std::string& place, const std::string& statistic) const {
    const std::string text =
        "[study]\nname = \"s\"\ndevice = \"" + device_ +
        "\"\n[[variable]]\nname = \"v\"\nmin = 1\nmax = 2\n[[measure]]\nname = \"m\"\nfigure = \"" + figure +
        "\"\n" + place + "\nstatistic = \"" + statistic + "\"\n[[objective]]\nname = \"o\"\nminimise = \"v\"\n";
    const Loaded loaded = load(parse_study(text, "study.toml", {}, check()));
    const StudyModel model(loaded.study, loaded.device, catalogue());
    return StudyEvaluator(model).sheet(std::vector{1.0}).derived[0].value;
  }

 private:
  std::string device_;
};

TEST(StudyModel, TheWorkspaceIsThatOfDataSheets) {
  const std::string place = "over = \"workspace\"\nspacing = \"20 mm\"";
  for (const char* device : {"delta", "five-bar", "r-cube"}) {
    const OverMany ask(device);
    const Description description = read_description(device, {}, catalogue());
    const Mechanism mechanism = mechanism_with_drives(description);
    const auto drives = joint_drives(description, mechanism);
    const LatticeSweep sweep = sweep_workspace(
        mechanism, {.spacing = 0.02, .limits = drive_limits(drives, false), .all_figures = true});
    const auto compare = [&](const std::string& figure, const Statistic& expected, double factor = 1.0) {
      if (expected.count == 0) return;
      EXPECT_NEAR(ask(figure, place, "mean") / (factor * expected.mean), 1.0, 1e-9) << device << " " << figure;
      // A study looks at the lattice alone; sheets lead its extremes to where they are.
      EXPECT_GE(ask(figure, place, "min"), factor * expected.min * (1.0 - 1e-9)) << device << " " << figure;
      if (!expected.unbounded) {
        EXPECT_LE(ask(figure, place, "max"), factor * expected.max * (1.0 + 1e-9)) << device << " " << figure;
      }
    };
    compare("condition_number", sweep[Figure::condition_number]);
    compare("manipulability", sweep[Figure::manipulability]);
    compare("force_x", sweep[Figure::force_x]);
    compare("force_min", sweep[Figure::weakest_force]);
    compare("force_max", sweep[Figure::strongest_force]);
    compare("step_y", sweep[Figure::step_y]);
    compare("leg_singularity", sweep[Figure::leg_singularity]);
    if (mechanism.delta()) compare("platform_singularity", sweep[Figure::platform_singularity]);
    const MechanicalSweep mechanics = sweep_mechanics(mechanism, drives, 0.02);
    compare("apparent_mass_x", mechanics[MechanicalFigure::mass_x]);
    compare("apparent_mass_min", mechanics[MechanicalFigure::lightest]);
    compare("apparent_mass_max", mechanics[MechanicalFigure::heaviest]);
    compare("gravity_torque", mechanics[MechanicalFigure::gravity_torque]);
    compare("acceleration_min", mechanics[MechanicalFigure::acceleration]);
    if (mechanics.of) {
      compare("stiffness_y", mechanics[MechanicalFigure::stiffness_y]);
      compare("stiffness_min", mechanics[MechanicalFigure::softest]);
      compare("natural_frequency", mechanics[MechanicalFigure::frequency_held], 0.5 / M_PI);
      compare("free_natural_frequency", mechanics[MechanicalFigure::frequency_free], 0.5 / M_PI);
    }
    const GlobalConditioning conditioning = sweep_conditioning(mechanism, 0.02).of_all;
    EXPECT_NEAR(ask("inverse_condition", place, "mean"), conditioning.index(), 1e-9) << device;
    EXPECT_NEAR(ask("inverse_condition", place, "min"), conditioning.worst(), 1e-9) << device;
    EXPECT_NEAR(ask("inverse_condition", place, "deviation"), conditioning.spread(), 1e-9) << device;
    EXPECT_NEAR(ask("well_conditioned", place, "mean"), conditioning.share(ConditionClass::below_5), 1e-9);
    EXPECT_NEAR(ask("well_conditioned", place + "\noptions = { limit = 2 }", "mean"),
                conditioning.near_isotropic(), 1e-9);
  }
}

TEST(StudyModel, PosturesAreThoseOfDataSheets) {
  const std::string place = "over = \"postures\"\nsamples = 400";
  for (const char* device : {"seven-dof", "pneumatic-3"}) {
    const OverMany ask(device);
    const Description description = read_description(device, {}, catalogue());
    const Mechanism mechanism = mechanism_with_drives(description);
    const auto drives = joint_drives(description, mechanism);
    const auto cylinders = joint_pneumatic_drives(description, mechanism);
    const PostureSweep sweep =
        sweep_postures(mechanism, {.samples = 400, .torque = [&](const Posture& posture) {
                                     return torque_range(drives, cylinders, posture.active(), false);
                                   }});
    const auto compare = [&](const std::string& figure, const PostureStatistic& expected) {
      if (expected.count == 0) return;
      EXPECT_NEAR(ask(figure, place, "mean") / expected.mean, 1.0, 1e-6) << device << " " << figure;
      EXPECT_GE(ask(figure, place, "min"), expected.min * (1.0 - 1e-6)) << device << " " << figure;
      if (!expected.unbounded) {
        EXPECT_LE(ask(figure, place, "max"), expected.max * (1.0 + 1e-6)) << device << " " << figure;
      }
    };
    compare("translation_inverse_condition", sweep.translation_conditioning);
    compare("rotation_inverse_condition", sweep.rotation_conditioning);
    compare("manipulability", sweep.manipulability);
    compare("force_z", sweep.force[2]);
    compare("moment_y", sweep.moment[1]);
  }
}

TEST(StudyProblems, SaysAPartThatIsNoneOnce) {
  const std::string said = complaint(
      small("[[variable]]\nname = \"m\"\nkey = [\"drive[0].motor\", \"drive[1].motor\"]\nparts = "
            "[\"maxon-ec-max-40-70w-48v\", \"no-such\"]\n[[objective]]\nname = \"o\"\nminimise = \"m\"\n"));
  const std::size_t first = said.find("no-such");
  EXPECT_NE(first, std::string::npos) << said;
  EXPECT_EQ(said.find("no-such", first + 1), std::string::npos) << said;
}

TEST(StudyProblems, LetsWholeNumbersBeWithoutUnits) {
  EXPECT_EQ(complaint(small(std::string(kCrank) + kSmallest +
                            "[[constraint]]\nname = \"c\"\nvalue = \"a1 - 0.01\"\nmin = 0.01\nmax = \"1 m\"\n"
                            "[[derived]]\nkey = \"mechanism.coupler\"\nvalue = \"0.1 + 2*a1*a1\"\n")),
            "");
}

// What an expression measures, with numbers that are plain.
TEST(ExpressionUnit, IsThatOfItsParts) {
  const auto of_name = [](const std::string& name) -> std::optional<UnitPowers> {
    if (name == "l") return unit_powers(Dimension::length);
    if (name == "f") return unit_powers(Dimension::force);
    if (name == "m") return unit_powers(Dimension::mass);
    if (name == "phi") return unit_powers(Dimension::angle);
    return std::nullopt;
  };
  const auto text_of = [&](const char* text) {
    const ExpressionUnit found = expression_unit(text, of_name, BareNumber::pure);
    return !found.rule.empty() ? found.rule : found.unit ? unit_text(*found.unit) : "unknown";
  };
  const std::pair<const char*, const char*> cases[] = {
      {"2*l + 3 mm", "m"},
      {"f / m", "m/s^2"},
      {"f / l", "N/m"},
      {"-l^2 * 4", "m^2"},
      {"sqrt(l*l)", "m"},
      {"log10(f)", "1"},
      {"l > 2 mm ? f : 3 N", "N"},
      {"max(l, 2 mm) * f", "N m"},
      {"f * l^2 / m", "m^3 s^-2"},
      {"sin(phi / 2)", "1"},
      {"atan2(l, 2 mm)", "1"},
      {"x * l", "unknown"},
      {"l + f", "adds a length and a force"},
      {"min(l, m)", "compares a length and a mass"},
      {"cos(f)", "takes the cos of a force"},
  };
  for (const auto& [text, unit] : cases) {
    EXPECT_EQ(text_of(text), unit) << text;
  }
  EXPECT_FALSE(expression_unit("450e-7 * (l / 80 mm)^3", of_name, BareNumber::any).unit);
}

TEST(StudyModel, SaysWhatIsUndefinedAndWhere) {
  const StudyModel model = small_model(
      std::string(kCrank) +
      "[[derived]]\nname = \"d\"\nvalue = \"1 / sqrt(a1 - 10 cm)\"\n"
      "[[measure]]\nname = \"k\"\nfigure = \"condition_number\"\nposition = [0, \"a1 + 11 cm\", 0]\n"
      "[[objective]]\nname = \"o\"\nminimise = \"k * d\"\n");
  StudyEvaluator evaluator(model);
  EXPECT_TRUE(evaluator.obstacles(std::vector{0.11}).empty());
  const std::vector<DesignObstacle> root = evaluator.obstacles(std::vector{0.095});
  ASSERT_EQ(root.size(), 1U);  // what follows from it is not said again
  EXPECT_EQ(root[0].place, "derived[0].value");
  EXPECT_EQ(root[0].what, "1 / sqrt(a1 - 10 cm)");
  EXPECT_EQ(root[0].with, "a1 = 0.095");
  // Farther than both links.
  const StudyModel far =
      small_model(std::string(kCrank) +
                  "[[measure]]\nname = \"k\"\nfigure = \"condition_number\"\nposition = [0, \"1 m\", 0]\n"
                  "[[objective]]\nname = \"o\"\nminimise = \"k\"\n");
  const std::vector<DesignObstacle> reach = StudyEvaluator(far).obstacles(std::vector{0.1});
  ASSERT_EQ(reach.size(), 1U);
  EXPECT_EQ(reach[0].place, "measure[0].figure");
  EXPECT_NE(reach[0].rule.find("cannot take"), std::string::npos);
  const StudyModel broken = small_model(
      "[[variable]]\nkey = \"mechanism.half_base\"\nmin = \"2 cm\"\nmax = \"60 cm\"\n"
      "[[measure]]\nname = \"k\"\nfigure = \"moving_mass\"\n[[objective]]\nname = \"k\"\nminimise = \"k\"\n");
  const std::vector<DesignObstacle> rule = StudyEvaluator(broken).obstacles(std::vector{0.5});
  ASSERT_EQ(rule.size(), 1U);
  EXPECT_EQ(rule[0].place, "");
  EXPECT_FALSE(rule[0].rule.empty());
}

TEST(StudyProblems, SaysWhatIsUnknownAndWhatIsNear) {
  EXPECT_NE(
      complaint(small(std::string("[[variable]]\nkey = \"mechanism.cranck\"\nmin = 1\nmax = 2\n") + kSmallest))
          .find("mechanism.crank"),
      std::string::npos);
  EXPECT_NE(complaint(small(std::string(kCrank) +
                            "[[measure]]\nname = \"k\"\nfigure = \"condition_numbr\"\nat = "
                            "\"home\"\n" +
                            kSmallest))
                .find("condition_number"),
            std::string::npos);
  EXPECT_NE(
      complaint(small(std::string(kCrank) + "[[objective]]\nname = \"o\"\nminimise = \"a2\"\n")).find("a1"),
      std::string::npos);
}

TEST(StudyProblems, RefusesWhatMakesNoSense) {
  const std::string good = std::string(kCrank) + kSmallest;
  EXPECT_EQ(complaint(small(good)), "");
  const std::pair<std::string, std::string> cases[] = {
      {"", "is missing"},
      {"[[variable]]\nkey = \"mechanism.crank\"\nmin = \"12 cm\"\nmax = \"9 cm\"\n" + std::string(kSmallest),
       "more than min"},
      {"[[variable]]\nname = \"a1\"\nkey = \"mechanism.crank\"\nmin = \"12 deg\"\nmax = \"90 deg\"\n" +
           std::string(kSmallest),
       "is an angle"},
      {good + kCrank, "used twice"},
      {good + "[[derived]]\nkey = \"mechanism.crank\"\nvalue = 1\n", "second time"},
      {good + "[[derived]]\nname = \"p\"\nvalue = \"q\"\n[[derived]]\nname = \"q\"\nvalue = \"p + 1\"\n",
       "follows from itself"},
      {good + "[[derived]]\nname = \"p\"\nvalue = \"1 +\"\n", "is no expression"},
      {good + "[[derived]]\nname = \"p\"\nvalue = \"2 mm / (1 - 1)\"\n", "has no value"},
      {good + "[[measure]]\nname = \"k\"\nfigure = \"condition_number\"\n", "figure of a posture"},
      {good + "[[measure]]\nname = \"k\"\nfigure = \"moving_mass\"\nat = \"home\"\n", "device as a whole"},
      {good + "[[measure]]\nname = \"k\"\nfigure = \"condition_number\"\nat = \"hme\"\n", "no posture"},
      {good + "[[measure]]\nname = \"k\"\nfigure = \"condition_number\"\njoints = [1]\n", "must be 2"},
      {good + "[[measure]]\nname = \"k\"\nfigure = \"deflection\"\nat = \"home\"\n", "under a load"},
      {good + "[[measure]]\nname = \"k\"\nfigure = \"moving_mass\"\noptions = { x = 1 }\n", "no option"},
      {good + "[[measure]]\nname = \"k\"\nfigure = \"force_z\"\nat = \"home\"\n", "does not move along z"},
      {good + "[[measure]]\nname = \"k\"\nfigure = \"moment_x\"\nat = \"home\"\n", "does not turn about x"},
      {good + "[[measure]]\nname = \"k\"\nfigure = \"force_x\"\nover = \"workspace\"\nstatistic = \"min\"\n",
       "distance of the lattice"},
      {good + "[[measure]]\nname = \"k\"\nfigure = \"force_x\"\nat = \"home\"\nsamples = 3\n", "goes with"},
      {good + "[[constraint]]\nname = \"c\"\nvalue = \"a1\"\n", "no limit"},
      {good + "[[constraint]]\nname = \"c\"\nvalue = \"a1\"\nmin = \"3 mm\"\nmax = \"2 mm\"\n",
       "is less than min"},
      {good + "[[constraint]]\nname = \"c\"\nvalue = \"a1\"\nmin = \"3 N\"\n",
       "is a force, but a1 is a length"},
      {good + "[[derived]]\nname = \"p\"\nvalue = \"a1 + 2 kg\"\n", "adds a length and a mass"},
      {good + "[[derived]]\nname = \"p\"\nvalue = \"sin(a1)\"\n", "the sin of a length"},
      {good + "[[derived]]\nkey = \"mechanism.coupler\"\nvalue = \"a1 * 2 m\"\n",
       "is an area, but mechanism.coupler is a length"},
      {good + "[[derived]]\nname = \"p\"\nvalue = \"a1 / (a1 - a1)\"\n", "has no value, whatever a1 may be"},
      {good + "[[derived]]\nkey = [\"mechanism.coupler\", \"mechanism.copler\"]\nvalue = \"a1\"\n",
       "has mechanism.copler, which is no number of the device"},
      {good + "[[objective]]\nname = \"a1\"\nminimise = \"2 * a1\"\n", "the name of a variable too"},
      {good + "[[constraint]]\nname = \"length\"\nvalue = \"a1\"\nmax = 1\n", "the name of an objective too"},
      {good + "[[derived]]\nkey = \"mechanism.coupler\"\nvalue = \"mechanism.coupler + 1 mm\"\n",
       "follows from itself"},
      // What else is wrong is said although an objective is missing.
      {std::string(kCrank) + "[[tolerance]]\nkey = \"mechanism.cranck\"\nhalf_width = \"1 mm\"\n",
       "did you mean"},
      {good + "[choice]\nweights = { lenght = 1 }\n", "no objective"},
      {good + "[search]\nalgorithm = \"nsga3\"\n", "nsga2"},
      {good + "[search]\npopulation = 2.5\n", "whole number"},
      {good + "[[tolerance]]\nkey = \"mechanism.crank\"\n", "unknown amount"},
      {"[[variable]]\nname = \"m\"\nkey = \"drive.motor\"\nparts = [\"maxon-ec-max-40-70w-48v\", \"x\"]\n"
       "[[objective]]\nname = \"o\"\nminimise = \"m\"\n",
       "no motor"},
      {good + "[[measure]]\nname = \"k\"\nfigure = \"moving_mass\"\n"
              "[[derived]]\nkey = \"mechanism.coupler\"\nvalue = \"k\"\n",
       "only when the design stands"},
  };
  for (const auto& [text, rule] : cases) {
    const std::string said = complaint(small(text));
    EXPECT_NE(said.find(rule), std::string::npos) << text << "\n" << said;
    EXPECT_NE(said.find("study.toml:"), std::string::npos) << said;
  }
}

}  // namespace
}  // namespace zwidth
