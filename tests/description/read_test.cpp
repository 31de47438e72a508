#include "zwidth/description/read.h"

#include <filesystem>
#include <gtest/gtest.h>
#include <numbers>
#include <sys/stat.h>

#include "description/support.h"

#include "zwidth/description/internal/table_reader.h"

namespace zwidth {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

TEST(Read, TheDeltaIsAsPublished) {
  const Description device = read_description("delta", {}, catalogue());
  const auto& delta = std::get<DeltaDescription>(device.mechanism);
  EXPECT_EQ(delta.base_radius, 0.08);
  EXPECT_EQ(delta.upper_arm, 0.08);
  EXPECT_EQ(delta.forearm, 0.16);
  EXPECT_EQ(delta.platform_radius, 0.055);
  EXPECT_DOUBLE_EQ(delta.joint_range.min, -36.0 * kDegree);
  EXPECT_DOUBLE_EQ(delta.joint_range.max, 84.0 * kDegree);

  ASSERT_EQ(device.drives.size(), 1U);
  const DriveDescription& drive = device.drives[0];
  EXPECT_TRUE(drive.joints.empty());
  EXPECT_EQ(drive.motor.torque_constant, 0.0255);
  EXPECT_EQ(drive.motor.inductance, 0.118e-3);
  EXPECT_EQ(drive.encoder.pulses_per_turn, 1000.0);
  EXPECT_EQ(drive.amplifier.integral_gain_scale, 0.0256);
  const double inertia = drive.motor.rotor_inertia + drive.encoder.code_wheel_inertia + drive.input_inertia;
  EXPECT_NEAR(inertia, 1.944e-6, 1e-18);  // J1 of table 5.1
  const auto& capstan = std::get<CapstanDescription>(drive.transmission);
  EXPECT_EQ(capstan.output_diameter, 0.15);
  EXPECT_DOUBLE_EQ(capstan.cable.bare_diameter, 0.6096e-3);
  ASSERT_TRUE(drive.preloader);
  EXPECT_EQ(drive.preloader->material.elastic_modulus, 68.98e9);
  EXPECT_EQ(drive.preloader->material.yield_strength, 276e6);
  ASSERT_TRUE(drive.output);
  EXPECT_EQ(drive.output->inertia, 2.117e-4);
  EXPECT_EQ(device.bodies.size(), 3U);
}

TEST(Read, LegsKeepTheirOrderAndUnits) {
  const Description device = parse_description(legs_text(), "x.toml", {}, catalogue());
  const auto& legs = std::get<LegsDescription>(device.mechanism);
  ASSERT_EQ(legs.legs.size(), 2U);
  EXPECT_EQ(legs.platform, PlatformFreedom::rigid);
  const JointDescription& turn = legs.legs[0].joints[0];
  EXPECT_TRUE(turn.active);
  EXPECT_EQ(turn.axis, Vector3(0, 0, 1));  // given as (0, 0, 2)
  EXPECT_DOUBLE_EQ(turn.home, 30.0 * kDegree);
  const JointDescription& slide = legs.legs[1].joints[0];
  EXPECT_EQ(slide.type, JointType::prismatic);
  EXPECT_EQ(slide.range, (Interval{-0.2, 0.2}));
  EXPECT_EQ(legs.legs[1].attachment, Attachment::spherical);
  EXPECT_EQ(device.bodies[0].inertia(0, 1), 5e-8);
  EXPECT_EQ(device.bodies[0].inertia(1, 0), 5e-8);
}

TEST(Read, NeedsNoDrivesAndNoBodies) {
  const std::string text = delta_text();
  const Description device =
      parse_description(text.substr(0, text.find("# No masses")), "x.toml", {}, catalogue());
  EXPECT_TRUE(device.drives.empty());
  EXPECT_TRUE(device.bodies.empty());
}

TEST(Read, SourcesOfTablesAndOfSingleValuesAreKept) {
  const Description device = read_description("delta", {}, catalogue());
  EXPECT_EQ(std::get<DeltaDescription>(device.mechanism).source, "Neal 2015, table 3.1");
  EXPECT_TRUE(device.drives[0].sources.at("supply_voltage").starts_with("chosen: "));
  EXPECT_EQ(problem_of(with(delta_text(), "sources = { to_user", "sources = { to_usr")).rule,
            "is the source of a key that this table does not have");
}

TEST(Read, TheMiddleOfTheRangeIsTheDefaultOfTheCapstan) {
  const Description device =
      parse_description(with(with(delta_text(), "mid_angle = \"24.14 deg\"", ""), "mid_angle =", "wraps ="),
                        "x.toml", {}, catalogue());
  EXPECT_DOUBLE_EQ(std::get<CapstanDescription>(device.drives[0].transmission).mid_angle, 24.0 * kDegree);
}

// ------------------------------------------------------------------------------------------------- mistakes

struct Mistake {
  std::string from, to, key, value, rule;
};

TEST(Read, EveryMistakeNamesPlaceKeyValueAndRule) {
  const std::vector<Mistake> mistakes{
      {"forearm = \"160 mm\"", "forearm = \"-80 mm\"", "mechanism.forearm", "\"-80 mm\"",
       "must be more than 0 and at most 10 m"},
      {"forearm = \"160 mm\"", "forearm = \"80 kg\"", "mechanism.forearm", "\"80 kg\"",
       "has the dimension of a mass, a length was expected"},
      {"forearm = \"160 mm\"", "forearm = nan", "mechanism.forearm", "nan", "must be finite"},
      {"forearm = \"160 mm\"", "forearm = -inf", "mechanism.forearm", "-inf", "must be finite"},
      {"forearm = \"160 mm\"", "forearm = 160", "mechanism.forearm", "160",
       "must be more than 0 and at most 10 m"},
      {"forearm = \"160 mm\"", "forearm = true", "mechanism.forearm", "true",
       "must be a length, not true or false"},
      {"forearm = \"160 mm\"", "forearm = 1979-05-27", "mechanism.forearm", "1979-05-27",
       "must be a length, not a date or time"},
      {"[\"-36 deg\", \"84 deg\"]", "[\"84 deg\", \"-36 deg\"]", "mechanism.joint_range",
       "[\"84 deg\", \"-36 deg\"]", "must go from a smaller to a larger value"},
      {"[\"-36 deg\", \"84 deg\"]", "[\"-36 deg\"]", "mechanism.joint_range", "[\"-36 deg\"]",
       "must be an array of 2, not 1"},
      {"[\"-36 deg\", \"84 deg\"]", "[\"-36 deg\", \"84 mm\"]", "mechanism.joint_range[1]", "\"84 mm\"",
       "has the dimension of a length, an angle was expected"},
      {"type = \"delta\"", "type = \"detla\"", "mechanism.type", "\"detla\"", "is not known"},
      {"motor = \"maxon-ec-4pole-30-100w-48v\"", "motor = \"maxon-ec-4pole-30\"", "drive[0].motor",
       "\"maxon-ec-4pole-30\"", "is not a known motor"},
      {"on = \"forearm\"", "on = \"foream\"", "body[1].on", "\"foream\"", "is no link of this mechanism"},
      {"joints = \"all\"", "joints = [\"theta1\", \"theta9\"]", "drive[0].joints", "[\"theta1\", \"theta9\"]",
       "is no active joint of this mechanism"},
      {"joints = \"all\"", "joints = [\"theta1\", \"leg1/theta1\"]", "drive[0].joints",
       "[\"theta1\", \"leg1/theta1\"]", "has another drive already"},
      {"supply_voltage = \"48 V\"", "supply_voltage = \"60 V\"", "drive[0].supply_voltage", "\"60 V\"",
       "is more than the amplifier takes, 50 V"},
      {"wraps = 3", "wraps = 0.5", "drive[0].transmission.wraps", "0.5", "must be at least 1"},
      {"friction = 0.1", "friction = 0", "drive[0].transmission.friction", "0", "must be positive"},
      {"centre_distance = \"80.5 mm\"", "centre_distance = \"70 mm\"", "drive[0].transmission.centre_distance",
       "\"70 mm\"", "makes the pulleys overlap; they touch at 80 mm"},
      {"mass = \"85 g\"", "mass = \"-85 g\"", "body[2].mass", "\"-85 g\"", "must be from 0 to 1000 kg"},
      {"[[0, 1, 0], [-1, 0, 0], [0, 0, 1]]", "[[0, 1, 0], [1, 0, 0], [0, 0, 1]]", "device.to_user",
       "[[0, 1, 0], [1, 0, 0], [0, 0, 1]]", "must be a rotation, but mirrors"},
      {"[[0, 1, 0], [-1, 0, 0], [0, 0, 1]]", "[[0, 2, 0], [-1, 0, 0], [0, 0, 1]]", "device.to_user",
       "[[0, 2, 0], [-1, 0, 0], [0, 0, 1]]", "must be a rotation; its rows are 3 away from orthonormal"},
  };
  for (const Mistake& mistake : mistakes) {
    const std::string text = with(delta_text(), mistake.from, mistake.to);
    const Problem problem = problem_of(text);
    EXPECT_EQ(problem.file, "x.toml") << mistake.to;
    EXPECT_EQ(problem.line, place_of(text, mistake.to).first) << mistake.to;
    EXPECT_GT(problem.column, 0) << mistake.to;
    EXPECT_EQ(problem.key, mistake.key);
    EXPECT_EQ(problem.value, mistake.value);
    EXPECT_EQ(problem.rule, mistake.rule);
    EXPECT_NE(problem.advice, "") << mistake.to;
  }
}

TEST(Read, ValuesArePlacedToTheColumn) {
  const std::string text = with(delta_text(), "forearm = \"160 mm\"", "forearm = \"-1 mm\"");
  const Problem problem = problem_of(text);
  EXPECT_EQ(std::pair(problem.line, problem.column), place_of(text, "\"-1 mm\""));
}

TEST(Read, SuggestsTheNearestKeyPartAndJoint) {
  EXPECT_EQ(problem_of(with(delta_text(), "forearm =", "foream =")).rule.substr(0, 10), "2 problems");
  const std::string twice = with(delta_text(), "upper_arm = \"80 mm\"", "upper_arm = \"80 mm\"\nuper_arm = 1");
  EXPECT_EQ(problem_of(twice).advice, "did you mean \"upper_arm\"?");
  EXPECT_EQ(problem_of(with(delta_text(), "cable = \"7x19-nylon-0.762\"", "cable = \"7x19-nylon\"")).advice,
            "did you mean \"7x19-nylon-0.762\"?");
  EXPECT_EQ(problem_of(with(delta_text(), "joints = \"all\"", "joints = \"tetha2\"")).advice,
            "did you mean \"theta2\"?");
}

TEST(Read, AllMistakesComeAtOnceInTheOrderOfTheFile) {
  std::string text = with(delta_text(), "upper_arm = \"80 mm\"", "upper_arm = 0");
  text = with(text, "wraps = 3", "wraps = \"3 turn\"");
  text = with(text, "mass = \"60 g\"", "mass = []");
  text = with(text, "on = \"platform\"", "on = \"platfrom\"");
  text = with(text, "title =", "titel =");
  const std::vector<Problem> problems = problems_of(text);
  std::vector<std::string> keys;
  for (const Problem& problem : problems) keys.push_back(problem.key);
  EXPECT_EQ(keys, (std::vector<std::string>{"device.titel", "mechanism.upper_arm", "body[0].mass", "body[2].on",
                                            "drive[0].transmission.wraps"}));
}

TEST(Read, MissingKeysArePlacedAtTheirTable) {
  const std::string text = with(delta_text(), "forearm = \"160 mm\"", "");
  const Problem problem = problem_of(text);
  EXPECT_EQ(problem.key, "mechanism.forearm");
  EXPECT_EQ(problem.rule, "is missing");
  EXPECT_EQ(problem.line, place_of(text, "[mechanism]").first);
  EXPECT_EQ(problem.advice, "give the length of the parallelogram, such as \"160 mm\"");
}

TEST(Read, GeometryThatNeverClosesIsRefused) {
  const Problem problem = problem_of(with(delta_text(), "forearm = \"160 mm\"", "forearm = \"30 mm\""));
  EXPECT_EQ(problem.key, "mechanism");
  EXPECT_TRUE(problem.rule.starts_with("never closes")) << problem.rule;
}

// -------------------------------------------------------------------------------------------- hostile input

TEST(Read, AnEmptyFileIsRefused) {
  EXPECT_EQ(problem_of("").rule, "is empty");
  EXPECT_EQ(problem_of(" \n\t\r\n").rule, "is empty");
  EXPECT_EQ(problems_of("# nothing but a comment\n").size(), 2U);  // neither [device] nor [mechanism]
}

TEST(Read, EveryTruncationOfADeviceFileEndsInProblemsOrADescription) {
  const std::string text = delta_text();
  for (std::size_t length = 0; length < text.size(); length += 7) {
    for (const Problem& problem : problems_of(text.substr(0, length))) EXPECT_NE(problem.rule, "");
  }
}

TEST(Read, TextThatIsNoTomlIsPlaced) {
  const Problem problem = problem_of("[device]\nname = \"a\nb\"");
  EXPECT_TRUE(problem.rule.starts_with("is not TOML")) << problem.rule;
  EXPECT_EQ(problem.line, 2);
  EXPECT_EQ(problem_of("[device]\nname =").advice, "the file seems to be cut off here: is it complete?");
}

TEST(Read, BytesThatAreNoUtf8AreRefused) {
  EXPECT_EQ(problem_of("[device]\nname = \"\xff\xfe\"\n").advice, "save the file as UTF-8");
  EXPECT_TRUE(problem_of("[device]\nname = \"\xff\xfe\"\n").rule.starts_with("is not TOML"));
  EXPECT_FALSE(problems_of(std::string("[device]\0name=1", 15)).empty());
  EXPECT_FALSE(problems_of(std::string(1000, '\0')).empty());
}

TEST(Read, DeepNestingIsRefused) {
  std::string dots = "a";
  for (int i = 0; i < 200000; ++i) dots += ".a";
  EXPECT_EQ(problem_of(dots + " = 1").rule, "has a key of more than 16 parts");
  EXPECT_EQ(problem_of(std::string("[").append(dots).append("]")).rule, "has a key of more than 16 parts");
  EXPECT_EQ(problem_of("a = " + std::string(100000, '[')).rule, "nests deeper than 32 brackets");
  EXPECT_EQ(problem_of("a = \"\"\"\"\"\"\"\nb = " + std::string(100000, '[')).rule.substr(0, 5), "nests");
  EXPECT_FALSE(problems_of("a = \"\\\"#\"\nb = " + std::string(40, '[') + std::string(40, ']')).empty());
  // Dots and brackets in strings and comments count for nothing.
  std::string harmless = delta_text() + "\n# " + std::string(500, '[') + dots.substr(0, 300) + "\n";
  harmless = with(harmless, "title = \"Delta",
                  "title = \"" + std::string(100, '[') + "a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a");
  EXPECT_TRUE(problems_of(harmless).empty());
}

TEST(Read, LongFilesAreRefusedWithoutReadingThem) {
  EXPECT_EQ(problem_of(std::string(50 << 20, ' ') + "x").rule, "is longer than 1024 KiB");
  const std::filesystem::path path = std::filesystem::temp_directory_path() / "zwidth-long-file.toml";
  std::ofstream(path) << delta_text();
  std::filesystem::resize_file(path, 50 << 20);
  try {
    read_description(path.string(), {}, catalogue());
    FAIL();
  } catch (const DescriptionError& error) {
    EXPECT_EQ(error.problems()[0].rule, "is longer than 1024 KiB");
    EXPECT_EQ(error.problems()[0].file, path.string());
  }
  std::filesystem::remove(path);
}

TEST(Read, PathsThatAreNoFilesAreRefused) {
  const auto rule = [](const std::string& path) -> std::string {
    try {
      read_description(path, {}, catalogue());
    } catch (const DescriptionError& error) {
      return error.problems().at(0).rule;
    }
    return "";
  };
  EXPECT_EQ(rule("/nowhere/x.toml"), "there is no such file");
  EXPECT_EQ(rule("/"), "is a directory");
  EXPECT_EQ(rule("detla"), "is neither a built-in device nor a file");
  EXPECT_EQ(rule(""), "is neither a built-in device nor a file");
  EXPECT_EQ(rule("/dev/zero"), "is longer than 1024 KiB");
  EXPECT_EQ(rule("/dev/null"), "is empty");
}

TEST(Read, HugeNumbersAreRefused) {
  EXPECT_FALSE(problems_of(with(delta_text(), "wraps = 3", "wraps = 99999999999999999999")).empty());
  EXPECT_FALSE(problems_of(with(delta_text(), "mass = \"85 g\"", "mass = 1e308")).empty());
  EXPECT_FALSE(problems_of(with(delta_text(), "mass = \"85 g\"", "mass = 1e999")).empty());
}

// ------------------------------------------------------------------------------------------------ overrides

Description overridden(const std::vector<std::string>& overrides) {
  return parse_description(delta_text(), "x.toml", overrides, catalogue());
}

TEST(Overrides, ReachEveryKindOfValue) {
  const Description device = overridden(
      {"mechanism.forearm=\"170 mm\"", "mechanism.upper_arm=90 mm", "mechanism.base_radius=0.07",
       "mechanism.joint_range[0]=-30 deg", "mechanism.joint_range.1=80 deg",
       "drive.motor=maxon-ec-max-40-120w-48v", "drive[0].supply_voltage=24 V", "drive.0.transmission.wraps=4",
       "device.title=A delta = mine", "body[1].mass=50 g", "device.gravity=[0,0,-1.62]"});
  const auto& delta = std::get<DeltaDescription>(device.mechanism);
  EXPECT_EQ(delta.forearm, 0.17);
  EXPECT_EQ(delta.upper_arm, 0.09);
  EXPECT_EQ(delta.base_radius, 0.07);
  EXPECT_DOUBLE_EQ(delta.joint_range.min, -30.0 * kDegree);
  EXPECT_DOUBLE_EQ(delta.joint_range.max, 80.0 * kDegree);
  EXPECT_EQ(device.drives[0].motor.info.name, "maxon-ec-max-40-120w-48v");
  EXPECT_EQ(device.drives[0].supply_voltage, 24.0);
  EXPECT_EQ(std::get<CapstanDescription>(device.drives[0].transmission).wraps, 4.0);
  EXPECT_EQ(device.title, "A delta = mine");
  EXPECT_EQ(device.bodies[1].mass, 0.05);
  EXPECT_EQ(device.gravity, Vector3(0, 0, -1.62));
}

TEST(Overrides, WithoutAnIndexReachEveryTable) {
  for (const BodyDescription& body : overridden({"body.mass=1 g"}).bodies) EXPECT_EQ(body.mass, 0.001);
}

TEST(Overrides, ReplaceAValueOfAPart) {
  const Description plain = overridden({});
  const Description device =
      overridden({"drive.motor.resistance=1 ohm", "drive.transmission.cable.breaking_load=100 N"});
  EXPECT_EQ(device.drives[0].motor.resistance, 1.0);
  EXPECT_EQ(device.drives[0].motor.inductance, plain.drives[0].motor.inductance);
  EXPECT_EQ(std::get<CapstanDescription>(device.drives[0].transmission).cable.breaking_load, 100.0);
}

TEST(Overrides, TheLastOneWins) {
  const Description device = overridden({"mechanism.forearm=170 mm", "mechanism.forearm=180 mm"});
  EXPECT_EQ(std::get<DeltaDescription>(device.mechanism).forearm, 0.18);
}

TEST(Overrides, MaySetWhatTheFileLeavesOut) {
  EXPECT_EQ(overridden({"drive.motor.viscous_damping=1e-6"}).drives[0].motor.viscous_damping, 1e-6);
  EXPECT_EQ(overridden({"device.gravity=[0, 0, 0]"}).gravity, Vector3(0, 0, 0));
}

TEST(Overrides, AreCheckedAndPlacedAsSuch) {
  const Problem problem = problem_of(delta_text(), {"mechanism.forearm=80 kg"});
  EXPECT_EQ(problem.file, "--set mechanism.forearm");
  EXPECT_EQ(problem.line, 0);
  EXPECT_EQ(problem.key, "mechanism.forearm");
  EXPECT_EQ(problem.value, "\"80 kg\"");
  EXPECT_EQ(problem.rule, "has the dimension of a mass, a length was expected");

  EXPECT_EQ(problem_of(delta_text(), {"mechanism.foream=80 mm"}).advice, "did you mean \"forearm\"?");
  EXPECT_EQ(problem_of(delta_text(), {"mechanismm.forearm=80 mm"}).advice, "did you mean \"mechanism\"?");
  EXPECT_EQ(problem_of(delta_text(), {"mechanismm.forearm=80 mm"}).file, "--set mechanismm.forearm");
  EXPECT_EQ(problem_of(delta_text(), {"drive[0].motor.resistnce=1 ohm"}).advice,
            "did you mean \"resistance\"?");
  EXPECT_EQ(problem_of(delta_text(), {"mechanism.joint_range.0=nan"}).rule, "must be finite");
  EXPECT_EQ(problem_of(delta_text(), {"mechanism.forearm.x=1"}).key, "mechanism.forearm");
}

TEST(Overrides, ThatAreNoneAreExplained) {
  EXPECT_EQ(problem_of(delta_text(), {"mechanism.forearm"}).rule, "has no value");
  EXPECT_EQ(problem_of(delta_text(), {"=3"}).rule, "is no key");
  EXPECT_EQ(problem_of(delta_text(), {"forearm=0.17"}).advice, "did you mean mechanism.forearm?");
  EXPECT_EQ(problem_of(delta_text(), {"a..b=3"}).rule, "is no key");
  EXPECT_EQ(problem_of(delta_text(), {"drive[0=3"}).rule, "is no key");
  EXPECT_EQ(problem_of(delta_text(), {"drive[7].wraps=3"}).rule, "has no element 7");
  EXPECT_EQ(problem_of(delta_text(), {"drive[99999999999999999999].wraps=3"}).file,
            "--set drive[99999999999999999999].wraps");
  EXPECT_FALSE(problems_of(delta_text(), {"mechanism=1"}).empty());
  EXPECT_FALSE(problems_of(delta_text(), {"drive=[]", "drive.motor=x"}).empty());
  EXPECT_FALSE(problems_of(delta_text(), {"mechanism.forearm=" + std::string(100000, '[')}).empty());
}

TEST(Overrides, AValueCannotSmuggleInAKey) {
  const Problem problem = problem_of(delta_text(), {"mechanism.forearm=1\nmechanism.upper_arm=2"});
  EXPECT_EQ(problem.key, "mechanism.forearm");
}

TEST(Read, LinksThatAreBeams) {
  const auto body = [](const std::string& keys) {
    return "[device]\nname = \"x\"\n[mechanism]\ntype = \"serial\"\n[[joint]]\nname = \"a\"\n"
           "type = \"revolute\"\na = 0.1\nrange = [-1, 1]\n[[body]]\non = \"arm/a\"\n" +
           keys;
  };
  const Description device = parse_description(
      body("tube = { outer_diameter = \"12 mm\", material = \"carbon-rod\" }\n"), "x.toml", {}, catalogue());
  const auto& tube = std::get<TubeDescription>(*device.bodies[0].beam);
  EXPECT_EQ(tube.outer_diameter, 0.012);
  EXPECT_EQ(tube.inner_diameter, 0.0);
  EXPECT_EQ(std::get<Material>(tube.wall).info.name, "carbon-rod");

  const auto only = [&](const std::string& keys) {
    const std::vector<Problem> problems = problems_of(body(keys));
    return problems.size() == 1 ? to_string(problems[0]) : std::to_string(problems.size()) + " problems";
  };
  const std::string tube_text = "tube = { outer_diameter = \"12 mm\", material = \"carbon-rod\" }\n";
  EXPECT_NE(only(tube_text + "mass = \"10 g\"\n").find("13:8: body[0].mass = \"10 g\": follows from"),
            std::string::npos)
      << only(tube_text + "mass = \"10 g\"\n");
  EXPECT_NE(only(tube_text + "bar = { width = 0.01, height = 0.01, material = \"carbon-rod\" }\n")
                .find("stands beside a tube"),
            std::string::npos);
  EXPECT_NE(only("tube = { outer_diameter = \"12 mm\", inner_diameter = \"12 mm\", material = \"acrylic\" }\n")
                .find("body[0].tube.inner_diameter = \"12 mm\": must be less than outer_diameter"),
            std::string::npos);
  EXPECT_NE(only("tube = { outer_diameter = \"12 mm\", material = \"carbon-rods\" }\n").find("carbon-rod"),
            std::string::npos);
  EXPECT_NE(only("tube = { outer_diameter = \"12 mm\", material = \"acrylic\", laminate = { lamina = "
                 "\"m55j-epoxy\", plies = [{ count = 1 }] } }\n")
                .find("stands beside a laminate"),
            std::string::npos);
  EXPECT_NE(only("tube = { outer_diameter = \"12 mm\", laminate = { lamina = \"m55j-epoxy\", plies = [] } }\n")
                .find("has no plies"),
            std::string::npos);
  EXPECT_NE(only("mass = \"-1 g\"\n").find("must be from 0 to 1000 kg"), std::string::npos);
}

}  // namespace
}  // namespace zwidth
