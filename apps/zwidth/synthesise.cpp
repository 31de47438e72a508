#include <CLI/CLI.hpp>
#include <cmath>
#include <fmt/format.h>
#include <memory>
#include <numbers>

#include "verbs.h"

#include "zwidth/actuation/arm_cylinder.h"
#include "zwidth/actuation/cylinder.h"
#include "zwidth/description/names.h"
#include "zwidth/description/units.h"

/// `zwidth synthesise arm-cylinder`: lengths of a linkage from a cylinder's stroke and a range of the arm.

namespace zwidth {

namespace {

struct Arguments {
  std::string what;
  std::string cylinder;
  std::string stroke;
  std::string retracted;
  std::string range;
  std::string layout;
  std::string lever;
  std::string height;
  std::string base_distance;
  std::string load;
  std::string distance;
  std::string pressure;
  bool json = false;
};

/// The value of an option, or `fallback` where it is left out.
double option(const char* name, const std::string& text, Dimension dimension, double fallback) {
  if (text.empty()) return fallback;
  const ParsedQuantity parsed = parse_quantity(text, dimension);
  if (!parsed) {
    throw InputError(fmt::format("{} \"{}\": {}{}", name, text, parsed.rule,
                                 parsed.advice.empty() ? "" : "; " + parsed.advice));
  }
  return *parsed.value;
}

double positive_option(const char* name, const std::string& text, Dimension dimension, double fallback) {
  const double value = option(name, text, dimension, fallback);
  if (!(value > 0.0)) throw InputError(fmt::format("{} \"{}\": must be positive", name, text));
  return value;
}

/// One linkage that was found, or why there is none.
struct Candidate {
  std::string rule;  ///< how it was found: "optimal", "minus root", ...
  ArmCylinderLayout layout = ArmCylinderLayout::one;
  std::optional<ArmCylinderDescription> design;
  bool turns = false;  ///< the lever keeps away from zero in the whole range

  const char* status() const { return !design ? "infeasible_design" : turns ? "ok" : "dead_point"; }
};

class Synthesis {
 public:
  Synthesis(const Arguments& arguments, const Terminal& terminal) : arguments_(arguments), sheet_(terminal) {
    read();
  }

  int run() {
    search();
    head();
    std::vector<std::vector<std::string>> rows;
    Json designs = Json::array();
    bool found = false, dead = false;
    for (const Candidate& candidate : candidates_) {
      found = found || candidate.turns;
      dead = dead || (candidate.design && !candidate.turns);
      designs.push_back(json_of(candidate));
      rows.push_back(row_of(candidate));
    }
    document_["designs"] = std::move(designs);
    std::vector<std::string> columns = {"layout", "rule", "l0", "l1", "l2", "h mm", "lever mm", "peak force"};
    sheet_.heading("Linkages");
    sheet_.table(columns, rows, false);
    if (found) mounts();
    if (!buildable()) {
      sheet_.gap();
      sheet_.paragraph("Not to be built like this: " + short_cylinder() + ".", 2, Tint::warning);
    }
    if (arguments_.json) {
      print_json(document_);
    } else {
      print(sheet_.text());
    }
    if (!buildable() && arguments_.json) complain("warning: " + short_cylinder());
    if (!found && dead) {
      complain(fmt::format(
          "dead_point: every linkage of this kind that has the travel loses its lever within the range; {}",
          arguments_.lever.empty() && arguments_.height.empty() ? advice() : "give a shorter lever, or none"));
    } else if (!found) {
      complain(fmt::format("infeasible_design: no linkage of this kind has the travel; {}", advice()));
    }
    return found ? kDone : kNo;
  }

 private:
  void read() {
    double stroke = kNotGiven;
    if (!arguments_.cylinder.empty()) {
      part_ = catalogue().find<Cylinder>(arguments_.cylinder);
      if (part_ == nullptr) {
        std::vector<std::string> names;
        for (const Cylinder& known : catalogue().all<Cylinder>()) names.push_back(known.info.name);
        throw InputError(fmt::format("--cylinder {}: is not a known cylinder; {}", arguments_.cylinder,
                                     suggest(arguments_.cylinder, names)));
      }
      stroke = part_->stroke;
    } else if (arguments_.stroke.empty()) {
      throw InputError(
          "give --cylinder NAME (see `zwidth parts cylinder`) or --stroke, such as --stroke 12.5mm");
    }
    stroke = positive_option("--stroke", arguments_.stroke, Dimension::length, stroke);
    if (arguments_.retracted.empty()) {
      throw InputError(
          "give --retracted, the length from pin to pin with the rod in, such as --retracted 75mm");
    }
    travel_.min_length = positive_option("--retracted", arguments_.retracted, Dimension::length, 0.0);
    travel_.max_length = travel_.min_length + stroke;
    if (arguments_.range.empty()) throw InputError("give --range, the angle either way, such as --range 30deg");
    travel_.half_range = positive_option("--range", arguments_.range, Dimension::angle, 0.0);
    if (!(travel_.half_range < 0.5 * std::numbers::pi)) {
      throw InputError(fmt::format("--range \"{}\": must be less than 90 deg either way", arguments_.range));
    }
    load_ = option("--load", arguments_.load, Dimension::force, kNotGiven);
    distance_ = positive_option("--distance", arguments_.distance, Dimension::length, 1.0);
    if (given(load_) != !arguments_.distance.empty()) {
      throw InputError("--load and --distance belong together: a force, and how far out on the arm it hangs");
    }
    pressure_ = option("--pressure", arguments_.pressure, Dimension::pressure,
                       part_ != nullptr ? part_->max_pressure : kNotGiven);
    if (!arguments_.layout.empty()) {
      std::vector<std::string> names;
      for (const auto& [name, layout] : arm_cylinder_layout_names()) {
        names.push_back(name);
        if (name == arguments_.layout) layout_ = layout;
      }
      if (!layout_) {
        throw InputError(
            fmt::format("--layout {}: is not known; {}", arguments_.layout, suggest(arguments_.layout, names)));
      }
    }
    if (arguments_.height.empty() != arguments_.base_distance.empty()) {
      throw InputError("--height and --base-distance belong together: the base pin of layout three");
    }
  }

  /// A cylinder with the rod in is longer than its stroke, for the rod must have room inside.
  bool buildable() const { return travel_.min_length > travel_.stroke(); }
  std::string short_cylinder() const {
    return fmt::format("a cylinder of {} stroke is longer than that from pin to pin with the rod in, not {}",
                       readable(travel_.stroke(), "m"), readable(travel_.min_length, "m"));
  }

  bool wants(ArmCylinderLayout layout) const { return !layout_ || *layout_ == layout; }

  void search() {
    using enum ArmCylinderLayout;
    const bool free_lever = !arguments_.lever.empty(), free_pin = !arguments_.height.empty();
    const auto add = [this](std::string rule, ArmCylinderLayout layout,
                            std::optional<ArmCylinderDescription> design) {
      const Interval range{-travel_.half_range, travel_.half_range};
      const bool turns = design && ArmCylinder(*design).keeps_direction(range);
      candidates_.push_back({std::move(rule), layout, std::move(design), turns});
    };
    if (free_lever) {
      const double lever = positive_option("--lever", arguments_.lever, Dimension::length, 0.0);
      for (const ArmCylinderLayout layout : {two, two_mod}) {
        if (!wants(layout)) continue;
        add("minus root", layout, design_two(travel_, lever, DesignRoot::minus, layout));
        add("plus root", layout, design_two(travel_, lever, DesignRoot::plus, layout));
      }
    }
    if (free_pin && wants(three)) {
      const double h = option("--height", arguments_.height, Dimension::length, 0.0);
      const double l2 = positive_option("--base-distance", arguments_.base_distance, Dimension::length, 0.0);
      add("minus root", three, design_three(travel_, h, l2, DesignRoot::minus));
      add("plus root", three, design_three(travel_, h, l2, DesignRoot::plus));
    }
    if (free_lever || free_pin) {
      if (candidates_.empty()) {
        throw InputError(
            "--lever belongs to the layouts two and two_mod, --height and --base-distance to three");
      }
      return;
    }
    if (wants(one)) {
      add("l1 longer", one, design_one(travel_, DesignRoot::plus));
      add("l2 longer", one, design_one(travel_, DesignRoot::minus));
    }
    for (const ArmCylinderLayout layout : {two, two_mod}) {
      if (wants(layout)) add("optimal", layout, design_two_optimal(travel_, layout));
    }
    if (wants(two)) add("least peak", two, design_least_peak(travel_));
    if (wants(three)) add("optimal", three, design_three_optimal(travel_));
  }

  void head() {
    document_["stroke"] = travel_.stroke();
    document_["retracted_length"] = travel_.min_length;
    document_["half_range"] = travel_.half_range;
    document_["buildable"] = buildable();
    sheet_.title("a cylinder that turns an arm", part_ != nullptr ? part_->info.title : std::string());
    sheet_.row("cylinder",
               fmt::format("{} … {}", readable(travel_.min_length, "m"), readable(travel_.max_length, "m")),
               fmt::format("a stroke of {}", readable(travel_.stroke(), "m")));
    sheet_.row("arm", fmt::format("±{}°", number(travel_.half_range * kDegrees, 4)));
    if (part_ != nullptr) document_["cylinder"] = part_->info.name;
    if (part_ != nullptr && given(pressure_)) {
      available_ = {-pressure_ * part_->rod_area, pressure_ * part_->rear_area};
      document_["available_force"] = json_interval(available_);
      sheet_.row("force it has",
                 fmt::format("{} push, {} pull", readable(available_.max, "N"), readable(-available_.min, "N")),
                 fmt::format("at {}, the other side vented", readable(pressure_, "Pa")));
    }
    const Interval levers = feasible_levers(travel_);
    document_["feasible_lever"] = json_interval(levers);
    if (given(load_)) {
      const double bound = minimum_peak_force(travel_.stroke(), travel_.half_range, load_, distance_);
      document_["load"] = load_;
      document_["distance"] = distance_;
      document_["minimum_peak_force"] = bound;
      sheet_.row("load", fmt::format("{} at {}", readable(load_, "N"), readable(distance_, "m")));
      sheet_.row("no linkage needs less than", readable(bound, "N"),
                 "at its worst angle: 2 F l_F sin θm / stroke");
    } else {
      sheet_.paragraph(
          "Peak forces are per torque of the load about the pivot at angle zero; "
          "--load and --distance give newtons.");
    }
  }

  /// Peak force for the load, or for one newton metre.
  std::optional<PeakForce> peak_of(const ArmCylinder& arm) const {
    return arm.peak_required_force(given(load_) ? load_ : 1.0, given(load_) ? distance_ : 1.0,
                                   {-travel_.half_range, travel_.half_range});
  }

  Json json_of(const Candidate& candidate) const {
    Json entry;
    entry["layout"] = to_string(candidate.layout);
    entry["rule"] = candidate.rule;
    entry["status"] = candidate.status();
    if (!candidate.design) return entry;
    const ArmCylinder arm(*candidate.design);
    const Interval range{-travel_.half_range, travel_.half_range};
    entry["l0"] = candidate.design->l0;
    entry["l1"] = candidate.design->l1;
    entry["l2"] = candidate.design->l2;
    entry["h"] = candidate.design->h;
    entry["lever"] = {arm.lever(range.min), arm.lever(0.0), arm.lever(range.max)};
    entry["alpha"] = arm.form().alpha;
    entry["keeps_direction"] = candidate.turns;
    const auto peak = peak_of(arm);
    entry["peak_force"] = peak ? Json(peak->force) : Json(nullptr);
    entry["peak_angle"] = peak ? Json(peak->angle) : Json(nullptr);
    if (part_ != nullptr && given(load_) && given(pressure_))
      entry["suffices"] = peak && suffices(arm, peak->force);
    return entry;
  }

  /// A load that hangs down is carried by a push where the cylinder lengthens with the angle, else by a pull.
  bool suffices(const ArmCylinder& arm, double force) const {
    return force <= (arm.lever(0.0) > 0.0 ? available_.max : -available_.min) * (1.0 + 1e-9);
  }

  std::vector<std::string> row_of(const Candidate& candidate) const {
    if (!candidate.design) {
      return {to_string(candidate.layout), candidate.rule, "–", "–", "–", "–", "", "infeasible_design"};
    }
    const ArmCylinder arm(*candidate.design);
    const auto mm = [](double metres) { return number(metres * kMilli, 6); };
    const auto peak = peak_of(arm);
    std::string force = "✗ a dead point in the range";
    if (candidate.turns && peak) {
      force = fmt::format("{} at {}°", given(load_) ? readable(peak->force, "N") : number(peak->force) + " /m",
                          number(peak->angle * kDegrees, 3));
      if (part_ != nullptr && given(load_) && given(pressure_))
        force += suffices(arm, peak->force) ? "  ✓" : "  ✗";
    }
    const bool three = candidate.layout == ArmCylinderLayout::three;
    return {to_string(candidate.layout),
            candidate.rule,
            candidate.layout == ArmCylinderLayout::one ? "" : mm(candidate.design->l0),
            mm(candidate.design->l1),
            mm(candidate.design->l2),
            three ? mm(candidate.design->h) : "",
            fmt::format("{} {} {}", number(arm.lever(-travel_.half_range) * kMilli, 4),
                        number(arm.lever(0.0) * kMilli, 4), number(arm.lever(travel_.half_range) * kMilli, 4)),
            force};
  }

  /// Lines to paste into a device file.
  void mounts() {
    sheet_.heading("For a device file");
    for (const Candidate& candidate : candidates_) {
      if (!candidate.turns) continue;
      // To the picometre, for `check` compares lengths to a part in 10^9.
      const auto length = [](double value) {
        const std::string text = fmt::format("{:.9f}", value * kMilli);
        const std::string digits = text.substr(0, text.find_last_not_of('0') + 1);
        return value == 0.0 ? std::string("0")
                            : fmt::format("\"{} mm\"",
                                          digits.ends_with('.') ? digits.substr(0, digits.size() - 1) : digits);
      };
      std::string line = fmt::format("mount = {{ layout = \"{}\"", to_string(candidate.layout));
      if (candidate.layout != ArmCylinderLayout::one) line += ", l0 = " + length(candidate.design->l0);
      line += fmt::format(", l1 = {}, l2 = {}", length(candidate.design->l1), length(candidate.design->l2));
      if (candidate.layout == ArmCylinderLayout::three) line += ", h = " + length(candidate.design->h);
      sheet_.line(line + fmt::format(", retracted_length = {} }}", length(travel_.min_length)));
    }
  }

  std::string advice() const {
    const Interval levers = feasible_levers(travel_);
    if (!arguments_.lever.empty()) {
      return fmt::format("--lever must be from {} to {}", readable(levers.min, "m"), readable(levers.max, "m"));
    }
    return "a longer cylinder, a shorter stroke or a wider range would do; layout two always does";
  }

  const Arguments& arguments_;
  Sheet sheet_;
  Json document_;
  CylinderTravel travel_;
  const Cylinder* part_ = nullptr;
  std::optional<ArmCylinderLayout> layout_;
  double load_ = kNotGiven;
  double distance_ = 1.0;
  double pressure_ = kNotGiven;
  Interval available_;
  std::vector<Candidate> candidates_;
};

int synthesise(const Arguments& arguments, const Terminal& terminal) {
  if (arguments.what != "arm-cylinder") {
    throw InputError(fmt::format("\"{}\" is nothing to synthesise; {}", arguments.what,
                                 suggest(arguments.what, {"arm-cylinder"})));
  }
  return Synthesis(arguments, terminal).run();
}

}  // namespace

void add_synthesise(CLI::App& app, Context& context) {
  CLI::App* verb =
      add_verb(app, "synthesise", "Lengths from what a linkage should do",
               "  zwidth synthesise arm-cylinder --cylinder airpel-m9d12.5u --retracted 75mm --range 30deg\n"
               "  zwidth synthesise arm-cylinder --stroke 100mm --retracted 228.1mm --range 25deg --load 25N "
               "--distance 360mm\n"
               "  zwidth synthesise arm-cylinder --stroke 12.5mm --retracted 75mm --range 30deg --lever 13mm\n"
               "  zwidth synthesise arm-cylinder --stroke 12.5mm --retracted 75mm --range 30deg --height 3mm "
               "--base-distance "
               "75mm\n"
               "\nLayouts are explained in docs/devices/pneumatic.md. Exits 1 if no linkage has the travel.");
  auto arguments = std::make_shared<Arguments>();
  verb->add_option("WHAT", arguments->what, "arm-cylinder: a cylinder between base and arm")->required();
  verb->add_option("--cylinder", arguments->cylinder, "cylinder of the catalogue: its stroke and its force")
      ->type_name("NAME");
  verb->add_option("--stroke", arguments->stroke, "stroke to use, instead of the cylinder's own")
      ->type_name("S");
  verb->add_option("--retracted", arguments->retracted, "length from pin to pin with the rod in")
      ->type_name("D");
  verb->add_option("--range", arguments->range, "angle that the arm turns either way")->type_name("ANGLE");
  verb->add_option("--layout", arguments->layout, "one, two, two_mod or three; all of them if left out")
      ->type_name("LAYOUT");
  verb->add_option("--lever", arguments->lever, "arm pin from the pivot, of the layouts two and two_mod")
      ->type_name("L2");
  verb->add_option("--height", arguments->height, "base pin above the pivot, of layout three")->type_name("H");
  verb->add_option("--base-distance", arguments->base_distance, "base pin behind the pivot, of layout three")
      ->type_name("L2");
  verb->add_option("--load", arguments->load, "force that hangs on the arm")->type_name("F");
  verb->add_option("--distance", arguments->distance, "how far out on the arm it hangs")->type_name("L");
  verb->add_option("--pressure", arguments->pressure, "of the cylinder, gauge; its highest if left out")
      ->type_name("P");
  add_json_flag(*verb, arguments->json);
  verb->callback([arguments, &context] {
    context.run = [arguments, &context] { return synthesise(*arguments, context.terminal); };
  });
}

}  // namespace zwidth
