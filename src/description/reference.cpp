#include "zwidth/description/reference.h"

#include <cmath>
#include <fmt/format.h>

#include "zwidth/description/internal/schema.h"

namespace zwidth {
namespace {

std::string unit_text(Dimension dimension) {
  if (dimension == Dimension::number) return "number";
  const std::string_view name = dimension_name(dimension);
  return fmt::format("{} [{}]", name.substr(name.find(' ') + 1), si_unit(dimension));
}

template <class Owner>
KeyReference reference_of(const Field<Owner>& field) {
  static const Owner untouched{};
  KeyReference key{.key = std::string(field.key),
                   .takes = unit_text(field.dimension),
                   .left_out = "required",
                   .rule = bounds_rule(field.bounds, field.dimension),
                   .meaning = std::string(field.meaning),
                   .example = std::string(field.example)};
  std::visit(
      [&](auto member) {
        using Value = std::remove_cvref_t<decltype(untouched.*member)>;
        if constexpr (std::is_same_v<Value, Interval>) {
          key.takes = "[lowest, highest] " + key.takes;
        } else if constexpr (std::is_same_v<Value, Vector3>) {
          key.takes = "[x, y, z] " + key.takes;
        } else {
          if constexpr (std::is_same_v<Value, int>) key.takes = "whole number";
          const auto value = static_cast<double>(untouched.*member);
          if (field.need == Need::optional)
            key.left_out = std::isnan(value) ? "not given" : fmt::format("{}", value);
        }
      },
      field.member);
  return key;
}

template <class Owner>
std::vector<KeyReference> references_of() {
  std::vector<KeyReference> keys;
  for (const Field<Owner>& field : fields<Owner>()) keys.push_back(reference_of(field));
  return keys;
}

const std::vector<KeyReference> kSourceKeys{
    {"source", "string", "empty", "", "where the values come from; \"chosen: why\" where no source gives them",
     "\"Neal 2015, table 3.1\""},
    {"sources", "table of strings", "empty", "of keys that this table has",
     "where single values come from, if not from `source`", ""}};

template <class Owner>
TableReference table(std::string name, std::vector<KeyReference> before,
                     const std::vector<KeyReference>& after = {}) {
  TableReference result{.name = std::move(name), .keys = std::move(before)};
  const auto append = [&](const std::vector<KeyReference>& more) {
    result.keys.insert(result.keys.end(), more.begin(), more.end());
  };
  if constexpr (!std::is_void_v<Owner>) append(references_of<Owner>());
  append(after);
  append(kSourceKeys);
  return result;
}

template <class Part>
TableReference part_table(std::string name) {
  TableReference result =
      table<Part>(std::move(name),
                  {{"title", "string", "the part's name", "", "what a person calls it", "\"Maxon RE 40\""}});
  result.keys[result.keys.size() - 2].left_out = "required";  // the source
  return result;
}

KeyReference part_key(const char* kind, const char* example) {
  return {kind,
          fmt::format("name of a {}, or table with `base`", kind),
          "required",
          "is in the catalogue",
          fmt::format("the {}; see parts", kind),
          example};
}

}  // namespace

namespace {

std::vector<KeyReference> with_wall(std::vector<KeyReference> keys) {
  keys.push_back(part_key("material", "\"steel-s235\""));
  keys.back().left_out = "required without laminate";
  keys.push_back(
      {"laminate", "table", "no plies", "instead of material", "plies of fibres; see `laminate`", ""});
  return keys;
}
std::vector<KeyReference> wall_keys() {
  return with_wall({});
}

TableReference serial_joint_table() {
  TableReference joint{.name = "serial-joint",
                       .keys = {{"name", "string", "required", "differs from joint to joint, has no '/'",
                                 "what drives and bodies refer to", "\"theta1\""},
                                {"type", "\"revolute\", \"prismatic\" or \"fixed\"", "required", "",
                                 "its value adds to theta, adds to d, or there is none", "\"revolute\""}}};
  for (KeyReference& key : references_of<SerialJointDescription>()) joint.keys.push_back(std::move(key));
  joint.keys.push_back({"range", "[lowest, highest] angle [rad] or length [m]", "required",
                        "smaller to larger; not of a fixed row", "how far the joint goes",
                        "[\"-90 deg\", \"90 deg\"]"});
  joint.keys.push_back({"home", "angle [rad] or length [m]", "0, or the middle of the range",
                        "must be in the range", "value in the home posture", "\"45 deg\""});
  joint.keys.push_back({"free", "true or false", "false", "has no drive", "whether the hand moves it", "true"});
  joint.keys.insert(joint.keys.end(), kSourceKeys.begin(), kSourceKeys.end());
  return joint;
}

}  // namespace

std::vector<TableReference> file_reference() {
  return {
      table<void>("device",
                  {{"name", "string", "required", "must not be empty", "what commands and results call it",
                    "\"delta\""},
                   {"title", "string", "the name", "", "what a person calls it", "\"Delta controller\""},
                   {"gravity", "[x, y, z] acceleration [m/s^2]", "[0, 0, -9.80665]", "must be finite",
                    "gravity in the base frame", "[0, 0, -9.80665]"},
                   {"to_user", "three rows of three numbers", "identity", "must be a rotation, to 1e-6",
                    "turns base coordinates into the user's: x to the user, y to the user's right, z up",
                    "[[0, 1, 0], [-1, 0, 0], [0, 0, 1]]"}}),
      table<DeltaDescription>("delta",
                              {{"type", "string", "required", "", "the kind of mechanism", "\"delta\""}}),
      table<FiveBarDescription>("five-bar",
                                {{"type", "string", "required", "", "the kind of mechanism", "\"five-bar\""}}),
      table<RCubeDescription>("r-cube",
                              {{"type", "string", "required", "", "the kind of mechanism", "\"r-cube\""}}),
      table<void>("serial",
                  {{"type", "string", "required", "", "the kind of mechanism", "\"serial\""},
                   {"platform", "as of legs", "\"rigid\"", "",
                    "what the tool is: the whole frame of the last row, or its \"point\" where the arm "
                    "only positions",
                    "\"point\""}}),
      serial_joint_table(),
      table<void>(
          "legs",
          {{"type", "string", "required", "", "the kind of mechanism", "\"legs\""},
           {"platform",
            "\"translation\", \"rigid\", \"planar-translation\", \"planar\", \"rotation\" or \"point\"",
            "required", "",
            "what the platform may do: keep its axes parallel to the base's, move freely, move "
            "as a point in x and y, move in x and y and turn about z, turn about a point, or move as a point "
            "in x, y and z that turns as it must",
            "\"translation\""}}),
      {.name = "leg",
       .keys = {{"name", "string", "required", "differs from leg to leg, has no '/'",
                 "what joints and links refer to", "\"leg1\""},
                {"tip", "[x, y, z] length [m]", "required", "must be finite",
                 "the point of the last link that meets the platform, at the leg's zero posture",
                 "[0, \"160 mm\", \"160 mm\"]"},
                {"attachment", "\"rigid\" or \"spherical\"", "required", "",
                 "whether the platform is the last link, or hangs on it in one point", "\"spherical\""},
                {"platform_point", "[x, y, z] length [m]", "[0, 0, 0]", "must be finite",
                 "the same point in the platform frame, whose origin is the tool", "[0, \"55 mm\", 0]"},
                {"platform_rotation", "three rows of three numbers", "identity", "must be a rotation, to 1e-6",
                 "columns: the platform's axes at the leg's zero posture; for rigid attachments",
                 "[[0, 0, 1], [-1, 0, 0], [0, -1, 0]]"}}},
      {.name = "joint",
       .keys = {{"name", "string", "required", "differs from joint to joint of a leg, has no '/'",
                 "what drives and bodies refer to", "\"theta1\""},
                {"type", "\"revolute\", \"prismatic\" or \"parallelogram\"", "required", "",
                 "turns the following links, slides them, or swings them on parallel bars without turning them",
                 "\"revolute\""},
                {"active", "true or false", "false", "at least one joint, at most 8",
                 "whether it is independent: moved by a drive, or by the hand", "true"},
                {"free", "true or false", "false", "only of an active joint, which then has no drive",
                 "whether the hand moves it", "true"},
                {"axis", "[x, y, z] number", "required", "must not be zero",
                 "direction of the axis at the leg's zero posture, of any length", "[1, 0, 0]"},
                {"point", "[x, y, z] length [m]", "required", "must be finite",
                 "a point on the axis at the leg's zero posture; the root end of the bars of a parallelogram",
                 "[0, \"80 mm\", 0]"},
                {"range", "[lowest, highest] angle [rad] or length [m]", "unlimited",
                 "smaller to larger; required if active", "how far the joint goes",
                 "[\"-36 deg\", \"84 deg\"]"},
                {"home", "angle [rad] or length [m]", "0", "must be in the range",
                 "value in a posture that closes the loops, from which solving starts", "\"24 deg\""}}},
      table<void>(
          "body",
          {{"on", "string", "required", "names a link",
            "the link that it is fixed to: \"platform\", \"LEG/JOINT\" for the link that this joint moves; a "
            "delta also has \"upper_arm\" and \"forearm\", an R-CUBE \"drive_link\", \"inner_link\" and "
            "\"outer_link\", "
            "for all three legs",
            "\"platform\""},
           {"turns_with", "string", "the link itself", "names a link that a joint moves, \"LEG/JOINT\"",
            "the link whose orientation the body keeps, where parallel bars turn it about a pin on the first",
            "\"leg1/theta1\""},
           {"pivot", "[x, y, z] length [m]", "required with turns_with", "must be finite",
            "that pin, at the leg's zero posture, in the base frame", "[0, 0, \"60 mm\"]"},
           {"mass", "mass [kg]", "required without tube or bar", "must be from 0 to 1000 kg", "mass",
            "\"80 g\""},
           {"centre", "[x, y, z] length [m]", "[0, 0, 0]", "must be finite",
            "centre of mass at the leg's zero posture, in the base frame; of the platform in its frame; of "
            "upper_arm and forearm from the link's inner joint, x outwards, z up; of the links of an R-CUBE "
            "from "
            "the link's inner joint, x along the axis that the leg drives, z along the link",
            "[\"40 mm\", 0, 0]"},
           {"inertia", "[xx, yy, zz], [xx, yy, zz, xy, xz, yz] or three rows, moment of inertia [kg m^2]", "0",
            "of a possible body: symmetric, positive, no principal moment above the sum of the others",
            "about the centre of mass", "[0, \"430 g cm^2\", \"430 g cm^2\"]"},
           {"tube", "table", "the body is rigid", "instead of mass, centre and inertia; not on the platform",
            "the link itself as a tube or round bar; see `tube`", ""},
           {"bar", "table", "the body is rigid", "instead of mass, centre and inertia; not on the platform",
            "the link itself as a rectangular bar; see `bar`", ""}}),
      table<TubeDescription>("tube", {}, wall_keys()),
      table<BarDescription>(
          "bar", {},
          with_wall({{"width_along", "[x, y, z] number", "the axis of the link's joint", "not along the link",
                      "direction of the width, at the leg's zero posture, in the base frame", "[0, 1, 0]"}})),
      {.name = "laminate",
       .keys =
           {part_key("lamina", "\"m55j-epoxy\""),
            {"plies", "array of tables", "required", "at least one ply; see `ply`", "the plies of the wall",
             "[{ count = 2 }, { count = 6, angle = \"90 deg\" }]"},
            {"rule", "\"lamination\" or \"mean\"", "\"lamination\"", "",
             "how the wall's moduli follow: from strains that all plies share, or as the mean of the plies' "
             "moduli, the rule of Görgülü 2018",
             "\"mean\""}}},
      {.name = "ply", .keys = references_of<PlyDescription>()},
      table<DriveDescription>(
          "drive",
          {{"joints", "\"all\", a name or a list of names", "\"all\"", "active joints, each with one drive",
            "the joints that have this drive, one each", "[\"theta1\", \"theta2\"]"},
           part_key("motor", "\"maxon-ec-4pole-30-100w-48v\""),
           part_key("encoder", "\"maxon-mr-1000\""),
           part_key("amplifier", "\"maxon-epos2-50-5\"")},
          {{"transmission", "table", "direct drive", "",
            "see `capstan`, `ratio` and `gearhead`; { type = \"direct\" } for none",
            "{ type = \"ratio\", ratio = 10 }"},
           {"preloader", "table", "none", "", "spring that keeps the cable tight; see `preloader`", ""},
           {"output", "table", "none", "", "what the drive moves, for its frequency response; see `output`",
            ""}}),
      table<PneumaticDriveDescription>(
          "pneumatic-drive",
          {{"joints", "\"all\", a name or a list of names", "\"all\"", "active joints, each with one drive",
            "the joints that have this drive, one each", "[\"theta1\"]"},
           part_key("cylinder", "\"airpel-m9d12.5u\""),
           part_key("regulator", "\"smc-itv0030-3ums\"")},
          {{"potentiometer", "name of a potentiometer, or table with `base`", "not given",
            "is in the catalogue", "the potentiometer on the joint; see parts", "\"bourns-3382\""},
           {"mount", "table", "the rod is the joint, which slides", "of a joint that turns; see `mount`",
            "where the cylinder's pins are", ""}}),
      table<ArmCylinderDescription>("mount",
                                    {{"layout", "\"one\", \"two\", \"two_mod\" or \"three\"", "required", "",
                                      "how the cylinder lies between base and arm", "\"two\""}}),
      table<CapstanDescription>("capstan",
                                {{"type", "string", "required", "", "the kind of transmission", "\"capstan\""}},
                                {part_key("cable", "\"7x19-nylon-0.762\"")}),
      table<RatioDescription>("ratio",
                              {{"type", "string", "required", "", "the kind of transmission", "\"ratio\""}}),
      table<GearheadDescription>("gearhead transmission", {{"type", "string", "required", "",
                                                            "the kind of transmission", "\"gearhead\""},
                                                           part_key("gearhead", "\"maxon-gp-16-a-19\"")}),
      table<FlexureDescription>("preloader", {}, {part_key("material", "\"aluminium-6061-t6\"")}),
      table<DriveOutputDescription>("output", {}),
      table<void>(
          "load",
          {{"name", "string", "required", "differs from load to load", "what results call it", "\"10 N up\""},
           {"force", "[x, y, z] force [N]", "[0, 0, 0]", "must be finite",
            "force of the tool on its environment, in the base frame", "[0, 0, \"10 N\"]"},
           {"moment", "[x, y, z] torque [N m]", "[0, 0, 0]",
            "must be finite; zero for a tool that does not turn",
            "moment of the tool on its environment, about the tool point", "[0, 0, \"0.5 N m\"]"},
           {"moment_frame", "\"base\", \"tool\" or \"published\"", "\"base\"", "",
            "what the components of the moment refer to; \"published\" is a reading of Baser 2006, there to "
            "reproduce its tables: it is not physics",
            "\"tool\""},
           {"kind", "\"continuous\" or \"peak\"", "\"continuous\"", "",
            "how long it lasts, and so what a drive may give for it", "\"peak\""}}),
      table<void>("posture",
                  {{"name", "string", "required", "differs from posture to posture", "what results call it",
                    "\"stretched\""},
                   {"joints", "array of angle [rad] or length [m]", "required",
                    "one for each active joint, in its range", "the active joints, in their order", ""}}),
      part_table<Motor>("motor"),
      part_table<Gearhead>("gearhead"),
      part_table<Encoder>("encoder"),
      part_table<Amplifier>("amplifier"),
      part_table<Cable>("cable"),
      part_table<Bearing>("bearing"),
      part_table<Material>("material"),
      part_table<Lamina>("lamina"),
      part_table<Cylinder>("cylinder"),
      part_table<Regulator>("regulator"),
      part_table<Potentiometer>("potentiometer"),
  };
}

std::string markdown(const TableReference& table) {
  std::string text = "| key | takes | left out | rule | meaning | example |\n|---|---|---|---|---|---|\n";
  for (const KeyReference& key : table.keys) {
    const std::string example = key.example.empty() ? "" : '`' + key.example + '`';
    text += fmt::format("| `{}` | {} | {} | {} | {} | {} |\n", key.key, key.takes, key.left_out, key.rule,
                        key.meaning, example);
  }
  return text;
}

}  // namespace zwidth
