#include "zwidth/design/figures.h"

#include <cmath>
#include <cstdlib>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <map>
#include <optional>
#include <random>
#include <regex>
#include <set>

#include "run_command.h"

#include "zwidth/description/read.h"
#include "zwidth/mechanism/dynamics.h"

// Studies may ask for whatever `at` and `report` answer: every number of their documents is a figure, or on the
// lists below with the reason why not; and every figure equals what they say.

namespace zwidth::testing {
namespace {

using Json = nlohmann::json;

const Catalogue& catalogue() {
  static const Catalogue loaded = Catalogue::load();
  return loaded;
}

std::vector<std::string> all_devices() {
  std::vector<std::string> list;
  for (const BuiltinFile& file : catalogue().devices()) list.push_back(file.path.string());
  for (const char* name : {"hexapod", "lamps", "three-rrr"}) {
    list.push_back(std::string(ZWIDTH_EXAMPLES) + "/devices/" + name + ".toml");
  }
  return list;
}

// A posture off the singular ones, as likely one as another.
std::optional<Posture> random_posture(const Mechanism& mechanism, std::mt19937& draw) {
  for (int attempt = 0; attempt < 1000; ++attempt) {
    ActiveVector joints(mechanism.active_count());
    for (int i = 0; i < joints.size(); ++i) {
      const Interval range = mechanism.active_range(i);
      const double home = mechanism.home_guess()[mechanism.active_joint(i)];
      const double width = std::min(range.width(), 1.5);
      joints[i] = std::clamp(home + width * std::uniform_real_distribution<double>(-0.4, 0.4)(draw), range.min,
                             range.max);
    }
    const Solution solution = solve_forward(mechanism, joints);
    if (solution.status != SolveStatus::reached) continue;
    if (rates(*solution.posture).closure < 0.01) continue;
    const Dexterity figures = dexterity(jacobian(*solution.posture));
    if (figures.condition_number < 1e4) return solution.posture;
  }
  return std::nullopt;
}

std::string joined(const Eigen::VectorXd& values) {
  std::string text;
  for (const double value : values) text += fmt::format("{}{:.17g}", text.empty() ? "" : ",", value);
  return text;
}

// ------------------------------------------------------------------------------------ places in documents

// "force_limits.continuous.axis[x]" in steps: keys, and what stands in brackets.
std::vector<std::string> steps_of(const std::string& place) {
  std::vector<std::string> steps;
  static const std::regex step(R"(([A-Za-z_0-9]+)|\[([^\]]+)\])");
  for (std::sregex_iterator it(place.begin(), place.end(), step), end; it != end; ++it) {
    steps.push_back((*it)[1].matched ? (*it)[1].str() : "[" + (*it)[2].str() + "]");
  }
  return steps;
}

bool has_option(const FigureDefinition& figure, const std::string& name) {
  return std::ranges::any_of(figure.options, [&](const FigureOption& one) { return one.name == name; });
}

// Follows a place; what options it stands for is put in `options`. Null where the document has nothing there.
Json look_up(const Json& document, const FigureDefinition& figure, const std::string& place,
             const Mechanism& mechanism, const std::vector<std::string>& joint_names, FigureOptions& options,
             std::mt19937& draw) {
  const Json* at = &document;
  for (const std::string& step : steps_of(place)) {
    if (at->is_null()) return nullptr;
    if (!step.starts_with("[")) {
      if (!at->is_object() || !at->contains(step)) return nullptr;
      at = &(*at)[step];
      continue;
    }
    if (!at->is_array() || at->empty()) return nullptr;
    const std::string index = step.substr(1, step.size() - 2);
    std::size_t entry = 0;
    const std::vector<std::string> names{"x", "y", "z", "rx", "ry", "rz"};
    if (const auto axis = std::ranges::find(names, index); axis != names.end()) {
      // Rows of one kind: an array that is shorter than the tool's axes has those from its own first one.
      const auto wanted = static_cast<int>(axis - names.begin());
      int row = 0, found = -1;
      for (const int one : mechanism.tool_axes()) {
        const bool same_kind = at->size() == mechanism.tool_axes().size() || (one < 3) == (wanted < 3);
        if (one == wanted) found = row;
        row += same_kind ? 1 : 0;
      }
      if (found < 0) return nullptr;
      entry = static_cast<std::size_t>(found);
    } else if (has_option(figure, index)) {
      if (const auto known = options.further.find(index); known == options.further.end()) {
        options.further[index] =
            static_cast<double>(std::uniform_int_distribution<std::size_t>(0, at->size() - 1)(draw));
      }
      entry = static_cast<std::size_t>(options.further[index]);
      const Json& first = at->front();
      if (index == "joint" && first.is_object()) {  // by the name of the joint
        const bool list = first.contains("joints");
        const Json& one = (*at)[entry];
        const std::string name = list ? one["joints"][0].get<std::string>() : one["joint"].get<std::string>();
        options.further[index] =
            static_cast<double>(std::ranges::find(joint_names, name) - joint_names.begin());
      }
    } else {
      entry = static_cast<std::size_t>(std::stoul(index));
    }
    if (entry >= at->size()) return nullptr;
    at = &(*at)[entry];
  }
  return *at;
}

bool near(double a, double b, double scale = 0.0) {
  constexpr double kRounding = 1e-9;  // of sums that are formed in another order
  return std::abs(a - b) <= kRounding * std::max({std::abs(a), std::abs(b), scale});
}

// Largest number in a matrix or list that a place ends in: entries may cancel.
double scale_of(const Json& value) {
  if (value.is_number()) return std::abs(value.get<double>());
  double largest = 0.0;
  if (value.is_array()) {
    for (const Json& one : value) largest = std::max(largest, scale_of(one));
  }
  return largest;
}
double scale_around(const Json& document, const std::string& place) {
  const Json* at = &document;
  for (const std::string& step : steps_of(place)) {
    if (step.starts_with("[")) return scale_of(*at);
    if (!at->is_object() || !at->contains(step)) return 0.0;
    at = &(*at)[step];
  }
  return 0.0;
}

TEST(Figures, OfPosturesAreWhatAtSays) {
  std::mt19937 draw(20251);
  std::set<std::string> compared, wanted;
  for (const std::string& file : all_devices()) {
    const Description description = read_description(file, {}, catalogue());
    const auto device = BuiltDevice::try_make(description, true);
    ASSERT_TRUE(device) << file;
    const Mechanism& mechanism = device->mechanism();
    for (int round = 0; round < 2; ++round) {
      const auto posture = random_posture(mechanism, draw);
      ASSERT_TRUE(posture) << file;
      FigureOptions loaded;
      ToolVector push(mechanism.tool_rows());
      for (int r = 0; r < push.size(); ++r) {
        const int axis = mechanism.tool_axes()[static_cast<std::size_t>(r)];
        push[r] = std::uniform_real_distribution<double>(-1.0, 1.0)(draw) * (axis < 3 ? 1.0 : 0.01);
        loaded.load[axis] = -push[r];  // the load of `at` is what the device exerts
      }
      const Outcome outcome =
          run({"at", file, "--joints=" + joined(posture->active()), "--load=" + joined(push), "--json"});
      ASSERT_EQ(outcome.status, 0) << file << outcome.err;
      const Json document = outcome.json();
      for (const FigureDefinition& figure : figure_definitions()) {
        for (const FigureAnswer& answer : figure.answers) {
          if (!answer.place.starts_with("at ")) continue;
          wanted.insert(answer.place);
          FigureOptions options = loaded;
          options.further = answer.options;
          const std::string place = answer.place.substr(3);
          Json said = look_up(document, figure, place, mechanism,
                              document["joint_names"].get<std::vector<std::string>>(), options, draw);
          if (said.is_array()) {  // the nearest of several distances
            double least = HUGE_VAL;
            for (const Json& one : said) least = std::min(least, std::abs(one.get<double>()));
            said = least;
          }
          if (!said.is_number()) continue;
          PostureFigures figures(*device, *posture);
          const double value =
              figure.of_posture ? figure.of(figures, options) : figure.of_device(*device, options);
          double expected = said.get<double>();
          if (std::isnan(value) && answer.options.contains("drives")) {
            // `at` says of the links what it knows, and of the drives where it knows nothing of links.
            options.further["drives"] = 1.0 - options.further["drives"];
            PostureFigures again(*device, *posture);
            EXPECT_TRUE(near(figure.of(again, options), expected, scale_around(document, place)))
                << file << " " << figure.name;
          } else {
            const double scale = scale_around(document, place) * answer.factor;
            EXPECT_TRUE(near(value, expected * answer.factor, scale))
                << file << " " << figure.name << " at " << joined(posture->active()) << ": " << value
                << ", said " << expected * answer.factor;
          }
          compared.insert(answer.place);
        }
      }
    }
  }
  // No device has as many driven joints as its tool has freedoms, and turns about x.
  compared.insert({"at resolution.force[rx]", "at resolution.force[ry]"});
  for (const std::string& place : wanted)
    EXPECT_TRUE(compared.contains(place)) << place << " stands in no answer";
}

// Devices that are quick to report on and have, together, every kind of workspace and drive.
std::vector<std::string> reported_devices() {
  return {"delta",       "five-bar",         "r-cube",
          "pneumatic-2", "seven-dof-locked", std::string(ZWIDTH_EXAMPLES) + "/devices/three-rrr.toml"};
}

// The data sheets as JSON, made once.
const std::map<std::string, Json>& reports() {
  static const std::map<std::string, Json> list = [] {
    std::map<std::string, Json> found;
    const ScratchDirectory scratch;
    for (const std::string& device : reported_devices()) {
      const Outcome outcome = run({"report", device, "--json", "-o", (scratch.path() / "report").string()});
      EXPECT_EQ(outcome.status, 0) << device << outcome.err;
      found.emplace(device, outcome.json());
    }
    return found;
  }();
  return list;
}

TEST(Figures, OfDevicesAreWhatReportSays) {
  std::mt19937 draw(20252);
  std::set<std::string> compared, wanted;
  for (const auto& [name, document] : reports()) {
    const Description description = read_description(name, {}, catalogue());
    const auto device = BuiltDevice::try_make(description, true);
    ASSERT_TRUE(device) << name;
    for (const FigureDefinition& figure : figure_definitions()) {
      if (figure.of_posture) continue;
      for (const FigureAnswer& answer : figure.answers) {
        if (!answer.place.starts_with("report ")) continue;
        wanted.insert(answer.place);
        // What takes an arm seconds is a call of what other devices need less time for.
        if (name == "seven-dof-locked" && has_option(figure, "cubes")) continue;
        // Entries are drawn until one is given, if any is.
        FigureOptions options;
        Json said;
        for (int attempt = 0; attempt < 20 && !said.is_number(); ++attempt) {
          options.further = answer.options;
          said = look_up(document, figure, answer.place.substr(7), device->mechanism(),
                         document["mechanism"]["active_joints"].get<std::vector<std::string>>(), options, draw);
        }
        if (!said.is_number()) continue;
        if (figure.name == "conditioning_length" && !device->mechanism().tool_turns()) continue;
        if (name == "pneumatic-2" && has_option(figure, "cubes")) {
          // A positioning arm has a workspace of its own, of which its reach is a coarser picture.
          EXPECT_NEAR(figure.of_device(*device, options) / said.get<double>(), 1.0, 0.06)
              << name << " " << figure.name;
          compared.insert(answer.place);
          continue;
        }
        // As finely as data sheets look.
        if (has_option(figure, "cubes")) options.further["cubes"] = 400000;
        if (has_option(figure, "places")) options.further["places"] = 30000;
        if (has_option(figure, "postures")) options.further["postures"] = 20000;
        const double value = figure.of_device(*device, options), expected = said.get<double>();
        // A data sheet counts finer where counting is all there is.
        const double slack = answer.place == "report workspace.volume" ? 0.01 : 0.0;
        EXPECT_TRUE(near(value, expected) || std::abs(value - expected) <= slack * std::abs(expected))
            << name << " " << figure.name << ": " << value << ", said " << expected;
        compared.insert(answer.place);
      }
    }
  }
  const std::set<std::string> rare = {"report drives[joint].speed.gearhead",  // of no part in the catalogue
                                      "report workspace.dexterous.annulus[0]",
                                      "report workspace.dexterous.annulus[1]",  // there is no whole ring
                                      "report workspace.turning.about.x[0]",
                                      "report workspace.turning.about.x[1]",  // of a plane
                                      "report workspace.turning.about.y[0]",
                                      "report workspace.turning.about.y[1]",
                                      "report workspace.any_orientation.length",
                                      "report workspace.any_orientation.volume",
                                      "report workspace.any_orientation.ranges.z[0]",
                                      "report workspace.any_orientation.ranges.z[1]",
                                      "report workspace.any_orientation.turned_every_way[level].volume"};
  for (const std::string& place : wanted) {
    const bool slow = place.find("arm.orientations") != std::string::npos;
    EXPECT_TRUE(slow || rare.contains(place) || compared.contains(place)) << place << " stands in no report";
  }
}

// ---------------------------------------------------------------------------------------------- completeness

void collect(const Json& value, const std::string& path, std::set<std::string>& leaves) {
  if (value.is_object()) {
    for (const auto& [key, inner] : value.items())
      collect(inner, path.empty() ? key : path + "." + key, leaves);
  } else if (value.is_array()) {
    for (const Json& inner : value) collect(inner, path + "[]", leaves);
  } else if (value.is_number()) {
    leaves.insert(path);
  }
}

// Whether a number of a document stands where an answer of some figure says.
bool is_figure(const std::string& verb, const std::string& leaf) {
  static const std::regex bracket(R"(\[[^\]]*\])");
  for (const FigureDefinition& figure : figure_definitions()) {
    for (const FigureAnswer& answer : figure.answers) {
      if (!answer.place.starts_with(verb + " ")) continue;
      const std::string place = std::regex_replace(answer.place.substr(verb.size() + 1), bracket, "[]");
      if (leaf == place || leaf == place + "[]") return true;
      // Least, mean and most over the workspace.
      if (verb == "report" && leaf.starts_with(place + ".")) return true;
    }
  }
  return false;
}

struct Left {
  const char* pattern;
  const char* why;
};

TEST(Figures, AreAllThatAtAnswers) {
  const Left left[] = {
      {R"(.*(direction|directions|shapes|axes|turned)(\[\])*)", "a direction is no figure"},
      {R"(inertia_ellipsoid\..*)", "the reciprocal roots of apparent_mass_min to apparent_mass_max"},
      {R"(velocity_ellipsoid\..*)", "min_singular_value to max_singular_value"},
      {R"(force_limits\..*\.torque\[\])",
       "continuous_torque and peak_torque of a joint, torque_up, torque_down"},
      {R"(force_limits\.continuous\.axis_range.*)", "force_x and so on, with way"},
      {R"(acceleration_limits\..*\.coasting\[\])", "coasting is its size"},
      {R"(mass_matrix_point_mass.*)", "a coarser model, to compare with a source"},
      {R"(singularity\.(working_mode|assembly_mode).*)", "a choice of the description"},
      {R"(singularity\.couplers)", "platform_singularity is its size"},
      {R"(cylinders\[\]\.(force_range|torque_range).*)", "push_force, pull_force; torque_up, torque_down"},
      {R"(cylinders\[\]\.torque)", "load_torque of a joint"},
      {R"(resolution\.(joint|torque)\[\])", "angular_resolution, torque_resolution of a joint"},
      {R"(loaded\.(iterations|residual))", "how it was computed"},
      {R"(load\[\])", "the question"},
  };
  std::mt19937 draw(20253);
  for (const std::string& file : all_devices()) {
    const Mechanism mechanism(read_description(file, {}, catalogue()));
    const auto posture = random_posture(mechanism, draw);
    ASSERT_TRUE(posture) << file;
    const ToolVector push = ToolVector::Ones(mechanism.tool_rows());
    const Outcome outcome =
        run({"at", file, "--joints=" + joined(posture->active()), "--load=" + joined(push), "--json"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    std::set<std::string> leaves;
    collect(outcome.json(), "", leaves);
    for (const std::string& leaf : leaves) {
      const bool out = std::ranges::any_of(
          left, [&](const Left& one) { return std::regex_match(leaf, std::regex(one.pattern)); });
      EXPECT_TRUE(out || is_figure("at", leaf)) << file << ": no study can ask for " << leaf;
    }
  }
}

TEST(Figures, AreAllThatReportAnswers) {
  const Left left[] = {
      {R"(.*_at\[\])", "where an extreme lies"},
      {R"(.*(centre|direction|tool_axis)\[\])", "a place or direction is no figure"},
      {R"(.*(error|error_estimate))", "how sure another number is"},
      {R"((.*\.)?(volumes\[\]\.share|spacing|inside|postures|places|grid|points|lattice|lattice\..*|limit|plies))",
       "how it was computed"},
      {R"((middle|arm\.home)\..*)", "figures at = \"middle\" and at = \"home\""},
      {R"(arm\.(farthest)\.(joints|position).*)", "where that is"},
      {R"(arm\.conditioning\.(best_joints|worst_joints).*)", "where that is"},
      {R"(conditioning\..*)", "inverse_condition and well_conditioned over the workspace"},
      {R"(drives\[\]\.current_loop\..*)", "current_loop_bandwidth; a curve"},
      {R"(drives\[\]\.actuator\..*)", "resonance_frequency and so on; a curve"},
      {R"(workspace\.forces\..*)", "force_x and so on, over postures"},
      {R"(.*\.(median|percentile_95))", "statistics are least, mean, most and deviation"},
      {R"(.*\.turned_every_way\[\]\.angle)", "a level of any_orientation_turned_volume"},
      {R"(drives\[\]\.torque\.(guaranteed|greatest)\[\])", "guaranteed_torque_up and so on"},
      {R"(drives\[\]\.usable_pressure)", "usable_pressure"},
      {R"(forces\..*\.torque\[\])", "continuous_torque and peak_torque of a joint"},
      {R"(resolution\.(joint|torque)\[\])", "angular_resolution, torque_resolution of a joint"},
      {R"(mechanism\.(joint_ranges|tool_freedoms).*)", "keys of the device"},
      {R"(values\[\].*)", "keys of the device"},
      {R"(stiffness\.shares.*)", "compliance_share"},
      {R"(workspace\.(turning\.position|orientation).*)", "the home posture"},
  };
  for (const auto& [name, document] : reports()) {
    std::set<std::string> leaves;
    collect(document, "", leaves);
    for (const std::string& leaf : leaves) {
      const bool out = std::ranges::any_of(
          left, [&](const Left& one) { return std::regex_match(leaf, std::regex(one.pattern)); });
      EXPECT_TRUE(out || is_figure("report", leaf)) << name << ": no study can ask for " << leaf;
    }
  }
}

}  // namespace
}  // namespace zwidth::testing
