#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "run_command.h"

// A mechanism that zwidth does not know, from its file alone: docs/your_own_device.md.

namespace zwidth::testing {
namespace {

using Json = nlohmann::json;

const std::string kLamps = ZWIDTH_EXAMPLES "/devices/lamps.toml";

TEST(OwnDevice, IsChecked) {
  const Json mobility = run({"check", kLamps, "--json"}).json()["devices"][0]["mobility"];
  EXPECT_EQ(mobility["freedoms"], 3);
  EXPECT_EQ(mobility["gruebler"], 3);
  EXPECT_EQ(mobility["group"], "translation");
  EXPECT_EQ(mobility["verdict"], "constrained");
}

TEST(OwnDevice, MovesAsItsSketchSays) {
  const Json home = run({"at", kLamps, "--joints", "0,0,0", "--json"}).json();
  EXPECT_EQ(home["status"], "reached");
  for (size_t row = 0; row < 3; ++row) {
    EXPECT_NEAR(home["position"][row].get<double>(), 0.0, 1e-12);
    for (size_t column = 0; column < 3; ++column)
      EXPECT_NEAR(home["jacobian"][row][column].get<double>(), row == column ? 0.1 : 0.0, 1e-12);
  }
  EXPECT_NEAR(home["condition_number"].get<double>(), 1.0, 1e-12);
  // By hand: the arm of x lifts by a, its bars swing to make good the height, and so x = 100 sin a - 120 (1 -
  // cos b), where 120 sin b = 100 (1 - cos a) + z.
  const Json there = run({"at", kLamps, "--position", "20mm,-10mm,15mm", "--json"}).json();
  ASSERT_EQ(there["status"], "reached");
  const std::vector<double> p{0.020, -0.010, 0.015};
  for (size_t i = 0; i < 3; ++i) {
    const double a = there["joints"][i].get<double>(), across = p[(i + 2) % 3];
    const double b = std::asin((0.1 * (1.0 - std::cos(a)) + across) / 0.12);
    EXPECT_NEAR(0.1 * std::sin(a) + 0.12 * (1.0 - std::cos(b)), p[i], 1e-10);
  }
}

TEST(OwnDevice, HasAWorkspaceAndAReport) {
  const Json workspace = run({"workspace", kLamps, "--grid", "10mm", "--json"}).json();
  EXPECT_GT(workspace["inside"].get<int>(), 200);
  EXPECT_GT(workspace["volume"].get<double>(), 2e-4);
  for (const char* axis : {"x", "y", "z"}) {
    // The sketch is the same for all three: -57.36 mm with the lamp's drive at its end, and 70 mm of slide.
    EXPECT_NEAR(workspace["ranges"][axis][0].get<double>(), -0.1 * std::sin(35.0 * 0.017453292519943), 2e-5);
    EXPECT_NEAR(workspace["ranges"][axis][1].get<double>(), 0.07, 1e-6);
  }
  const ScratchDirectory scratch;
  const Outcome outcome = run({"report", kLamps, "-o", scratch.path().string(), "--json"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const Json report = outcome.json();
  EXPECT_EQ(report["mechanism"]["type"], "legs");
  EXPECT_GT(report["workspace"]["volume"].get<double>(), 2e-4);
  EXPECT_GT(report["forces"]["continuous"]["axis"]["x"]["min"].get<double>(), 1.0);
  EXPECT_TRUE(std::filesystem::exists(scratch.path() / "report.html"));
  EXPECT_FALSE(std::filesystem::is_empty(scratch.path() / "figures"));
}

TEST(OwnDevice, IsSized) {
  const Json sized = run({"size", kLamps, "--load", "2,0,0", "--json"}).json();
  EXPECT_EQ(sized["joints"].size(), 3u);
  EXPECT_NEAR(sized["balance"]["moving_mass"].get<double>(), 0.315, 1e-12);
}

// Rates of the struts by hand, u . v + (p x u) . w for a platform that moves with v and turns with w: the
// Jacobian's inverse.
TEST(OwnDevice, AHexapodMovesAndTurnsAsItsStrutsSay) {
  const std::string hexapod = ZWIDTH_EXAMPLES "/devices/hexapod.toml";
  const Json checked = run({"check", hexapod, "--json"}).json()["devices"][0];
  EXPECT_EQ(checked["mobility"]["freedoms"], 6);
  EXPECT_EQ(checked["mobility"]["gruebler"], 6);
  EXPECT_EQ(checked["mobility"]["verdict"], "constrained");
  const Json home = run({"at", hexapod, "--joints", "0,0,0,0,0,0", "--json"}).json();
  ASSERT_EQ(home["status"], "reached");
  const double degree = 0.017453292519943295;
  const std::vector<double> base{-12, 12, 108, 132, 228, 252}, top{-48, 48, 72, 168, 192, 288};
  for (size_t k = 0; k < 6; ++k) {
    const double px = 0.06 * std::cos(top[k] * degree), py = 0.06 * std::sin(top[k] * degree);
    double ux = px - 0.15 * std::cos(base[k] * degree), uy = py - 0.15 * std::sin(base[k] * degree), uz = 0.2;
    const double length = std::sqrt(ux * ux + uy * uy + uz * uz);
    ux /= length, uy /= length, uz /= length;
    const std::vector<double> row{ux, uy, uz, py * uz, -px * uz, px * uy - py * ux};
    for (size_t j = 0; j < 6; ++j) {
      double product = 0.0;
      for (size_t i = 0; i < 6; ++i) product += row[i] * home["jacobian"][i][j].get<double>();
      EXPECT_NEAR(product, k == j ? 1.0 : 0.0, 1e-4) << k << ", " << j;  // the file has micrometres
    }
  }
  const ScratchDirectory scratch;
  const Outcome report = run({"report", hexapod, "-o", scratch.path().string(), "--json"});
  ASSERT_EQ(report.status, 0) << report.err;
  EXPECT_GT(report.json()["arm"]["postures"].get<int>(), 1000);
}

// A rod between two slides on one rail: the tool's height y and the slides are y^2 + (d/2)^2 = 0.2^2.
const char* const kSlides = R"([device]
name = "slides"
[mechanism]
type = "legs"
platform = "planar-translation"
[[leg]]
name = "left"
tip = [0, 0.16, 0]
attachment = "spherical"
[[leg.joint]]
name = "slide"
type = "prismatic"
axis = [1, 0, 0]
point = [-0.12, 0, 0]
active = true
range = [-0.1, 0.1]
[[leg.joint]]
name = "pin"
type = "revolute"
axis = [0, 0, 1]
point = [-0.12, 0, 0]
[[leg]]
name = "right"
tip = [0, 0.16, 0]
attachment = "spherical"
[[leg.joint]]
name = "slide"
type = "prismatic"
axis = [1, 0, 0]
point = [0.12, 0, 0]
active = true
range = [-0.1, 0.1]
[[leg.joint]]
name = "pin"
type = "revolute"
axis = [0, 0, 1]
point = [0.12, 0, 0]
)";

TEST(OwnDevice, AtAnExactSingularityNothingIsRounding) {
  const ScratchDirectory scratch;
  const std::string file = scratch.file("slides.toml", kSlides);
  // Both rods in line: the loops close to 1e-12 only, so that the root of that is all that tells y from 0.
  const Json flat = run({"at", file, "--joints=-80mm,80mm", "--json"}).json();
  EXPECT_EQ(flat["status"], "degraded");
  ASSERT_EQ(flat["singularity"]["free_directions"].size(), 1u) << flat["singularity"];
  EXPECT_NEAR(std::abs(flat["singularity"]["free_direction"][1].get<double>()), 1.0, 1e-9);
  EXPECT_TRUE(flat["jacobian"].is_null());
  // A tenth of a millimetre before that it is a posture like any other, with dy/dx = -(d/2)/y / 2.
  const Json near = run({"at", file, "--joints=-79.9mm,79.9mm", "--json"}).json();
  EXPECT_EQ(near["status"], "reached");
  EXPECT_NEAR(near["jacobian"][1][0].get<double>(), 0.5 * 0.1999 / std::sqrt(0.04 - 0.1999 * 0.1999), 1e-6);
}

TEST(OwnDevice, AGoalThatIsFarAwayIsUnreachableAtOnce) {
  const ScratchDirectory scratch;
  const std::string file = scratch.file("slides.toml", kSlides);
  for (const char* goal :
       {"--position=0,1e6", "--position=0,1e300", "--position=1e300,0", "--joints=1e300,0"}) {
    const Outcome outcome = run({"at", file, goal, "--json"});
    EXPECT_EQ(outcome.status, 1) << goal;
    const Json document = outcome.json();
    EXPECT_NE(document["status"], "reached") << goal;
    EXPECT_FALSE(document.contains("joints") && document["joints"][0].is_null()) << goal;
  }
}

// The right crank may not be where home's working mode has it, but on the other side of its leg it may.
TEST(OwnDevice, APositionThatOnlyAnotherWorkingModeReachesSaysWhich) {
  const std::vector<std::string> device = {"five-bar", "--set",
                                           "mechanism.right_range=[\"60 deg\", \"200 deg\"]", "--set",
                                           "mechanism.left_range=[\"-20 deg\", \"200 deg\"]"};
  const auto ask = [&device](const std::string& goal) {
    std::vector<std::string> arguments{"at"};
    arguments.insert(arguments.end(), device.begin(), device.end());
    arguments.insert(arguments.end(), {goal, "--json"});
    return run(arguments);
  };
  const Outcome outcome = ask("--position=20mm,150mm");
  EXPECT_EQ(outcome.status, 1);
  const Json document = outcome.json();
  EXPECT_EQ(document["status"], "joint_limit");
  const std::string reason = document["reason"].get<std::string>(), hint = "--joints ";
  EXPECT_NE(reason.find("theta2 is at 23.443°, its range is"), std::string::npos) << reason;
  EXPECT_NE(reason.find("this is home's working mode"), std::string::npos) << reason;
  ASSERT_NE(reason.find(hint), std::string::npos) << reason;
  // And what it says is so, to the digits that it gives: 5e-5 deg of 250 mm.
  const Json there = ask("--joints=" + reason.substr(reason.find(hint) + hint.size())).json();
  EXPECT_EQ(there["status"], "reached");
  EXPECT_NEAR(there["position"][0].get<double>(), 0.020, 1e-6);
  EXPECT_NEAR(there["position"][1].get<double>(), 0.150, 1e-6);
}

// At 105 mm the right slide would be beyond its end. With the rods crossed both were within, but where the pins
// meet on the way there the tool swings freely: that is no advice.
TEST(OwnDevice, AWorkingModeThatTheDeviceCannotBeDrivenToIsNoAdvice) {
  const ScratchDirectory scratch;
  std::string text = kSlides;
  text.replace(text.find("[-0.1, 0.1]"), 11, "[-0.1, 0.4]");
  text.replace(text.find("[-0.1, 0.1]"), 11, "[-0.2, 0.1]");
  const std::string file = scratch.file("slides.toml", text);
  const Json document = run({"at", file, "--position=105mm,160mm", "--json"}).json();
  EXPECT_EQ(document["status"], "joint_limit");
  EXPECT_EQ(document["reason"].get<std::string>().find("--joints"), std::string::npos) << document["reason"];
  EXPECT_EQ(run({"at", file, "--joints=345mm,-135mm"}).status, 1);
}

// A crank of 50 mm and a coupler: one drive, so matrices of one column.
TEST(OwnDevice, WithOneDriveMatricesStayMatrices) {
  const ScratchDirectory scratch;
  const std::string file = scratch.file("crank.toml", R"([device]
name = "crank"
[mechanism]
type = "legs"
platform = "planar-translation"
[[leg]]
name = "arm"
tip = [0.05, 0, 0]
attachment = "rigid"
[[leg.joint]]
name = "turn"
type = "parallelogram"
axis = [0, 0, 1]
point = [0, 0, 0]
active = true
range = [-1, 1]
[[body]]
on = "platform"
mass = 0.2
)");
  const Json at = run({"at", file, "--joints=0.3", "--json"}).json();
  ASSERT_EQ(at["jacobian"].size(), 2u) << at["jacobian"];
  EXPECT_NEAR(at["jacobian"][0][0].get<double>(), -0.05 * std::sin(0.3), 1e-12);
  EXPECT_NEAR(at["jacobian"][1][0].get<double>(), 0.05 * std::cos(0.3), 1e-12);
  EXPECT_NEAR(at["mass_matrix"][0][0].get<double>(), 0.2 * 0.05 * 0.05, 1e-12);
  // One motion, along a circle of 50 mm: even, and as large as its radius.
  EXPECT_NEAR(at["condition_number"].get<double>(), 1.0, 1e-12);
  EXPECT_NEAR(at["manipulability"].get<double>(), 0.05, 1e-12);
  EXPECT_NEAR(at["isotropy"].get<double>(), 1.0, 1e-12);
}

// A gimbal: two rings, whose motors turn about x and, on it, y. The tool turns in two ways.
const char* const kGimbal = R"([device]
name = "gimbal"
[mechanism]
type = "legs"
platform = "rotation"
[[leg]]
name = "ring"
tip = [0, 0, 0]
attachment = "rigid"
[[leg.joint]]
name = "outer"
type = "revolute"
axis = [1, 0, 0]
point = [0, 0, 0]
active = true
range = [-0.8, 0.8]
[[leg.joint]]
name = "inner"
type = "revolute"
axis = [0, 1, 0]
point = [0, 0, 0]
active = true
range = [-0.8, 0.8]
[[body]]
on = "platform"
mass = 0.2
centre = [0, 0, 0.1]
inertia = [1e-4, 1e-4, 1e-4]
[[drive]]
motor = "maxon-ec-4pole-30-100w-48v"
encoder = "maxon-mr-1000"
amplifier = "maxon-epos2-50-5"
supply_voltage = "48 V"
transmission = { type = "ratio", ratio = 12 }
)";

TEST(OwnDevice, AToolThatOnlyTurnsIsAskedByItsOrientationAndSizedByMoments) {
  const ScratchDirectory scratch;
  const std::string file = scratch.file("gimbal.toml", kGimbal);
  // Axes e1 = x and Rx(a) y: at right angles whatever the angles, so both singular values are 1.
  const Json at = run({"at", file, "--joints=0.2,0.1", "--json"}).json();
  EXPECT_NEAR(at["condition_number"].get<double>(), 1.0, 1e-12);
  EXPECT_NEAR(at["manipulability"].get<double>(), 1.0, 1e-12);
  const Json turned = run({"at", file, "--orientation=20deg,0,0", "--json"}).json();
  EXPECT_EQ(turned["status"], "reached");
  EXPECT_NEAR(turned["joints"][0].get<double>(), 20.0 * 0.017453292519943295, 1e-10);
  const Outcome barred = run({"at", file, "--orientation=20deg,0,10deg"});
  EXPECT_EQ(barred.status, 1);
  EXPECT_EQ(barred.out.find("Nearest reachable point"), std::string::npos) << barred.out;
  const Outcome neither = run({"at", file});
  EXPECT_EQ(neither.status, 2);
  EXPECT_NE(neither.err.find("--orientation 10deg,20deg,0"), std::string::npos) << neither.err;

  // Motor i gives at most t; the weight takes up to m g r = 0.2 9.80665 0.1 sin(0.8) of that, and a moment of
  // size M along the axis of one all of M.
  const Json sized = run({"size", file, "--json"}).json();
  EXPECT_FALSE(sized.contains("guaranteed_force"));
  const double limit = sized["joints"][0]["continuous"].get<double>();
  EXPECT_NEAR(sized["guaranteed_moment"].get<double>(), limit - 0.2 * 9.80665 * 0.1 * std::sin(0.8), 1e-9);
  EXPECT_TRUE(sized["balance"]["weight_at_tool"].is_null());
  const Json loaded = run({"size", file, "--load=0.1,0,0", "--joints=0,0", "--json"}).json();
  EXPECT_NEAR(loaded["joints"][0]["required"].get<double>(), 0.1, 1e-12);
  EXPECT_EQ(loaded["load"], Json::array({0.1, 0.0, 0.0}));
  const Outcome pushed = run({"size", file, "--load=1,0"});
  EXPECT_EQ(pushed.status, 2);
  EXPECT_NE(pushed.err.find("a moment about x, y, z: the tool only turns"), std::string::npos) << pushed.err;
}

// Three struts between universal joints (Tsai 1996): the platform does not turn, whether the file says so or
// the legs see to it. A strut's rate is u . v with u along it, 70 mm inwards for 200 mm up, so that J^-1 has
// those rows and singular values sqrt(3/2) h twice and sqrt(3) z of their level and upright parts.
TEST(OwnDevice, AThreeUpuHasTheFiguresOfItsStrutsHoweverItIsDeclared) {
  const ScratchDirectory scratch;
  const double level = 0.07 / std::hypot(0.07, 0.2), upright = 0.2 / std::hypot(0.07, 0.2);
  for (const char* platform : {"translation", "rigid"}) {
    SCOPED_TRACE(platform);
    std::string text = std::string("[device]\nname = \"upu\"\n[mechanism]\ntype = \"legs\"\nplatform = \"") +
                       platform + "\"\n";
    for (int k = 0; k < 3; ++k) {
      const double c = std::cos(2.0943951023931953 * k), s = std::sin(2.0943951023931953 * k);
      const auto vector = [](double x, double y, double z) { return fmt::format("[{}, {}, {}]\n", x, y, z); };
      const std::string foot = "point = " + vector(0.15 * c, 0.15 * s, 0.0),
                        head = "point = " + vector(0.08 * c, 0.08 * s, 0.2),
                        across = "axis = " + vector(-s, c, 0.0),
                        aslant = "axis = " + vector(0.2 * c, 0.2 * s, 0.07), turn = "type = \"revolute\"\n",
                        joint = "[[leg.joint]]\nname = ";
      text += fmt::format("[[leg]]\nname = \"leg{}\"\nattachment = \"rigid\"\n", k);
      text +=
          "tip = " + vector(0.08 * c, 0.08 * s, 0.2) + "platform_point = " + vector(0.08 * c, 0.08 * s, 0.0);
      text += joint + "\"foot\"\n" + turn + across + foot + joint + "\"ankle\"\n" + turn + aslant + foot;
      text += joint + "\"strut\"\ntype = \"prismatic\"\nactive = true\nrange = [-0.05, 0.05]\naxis = " +
              vector(-0.07 * c, -0.07 * s, 0.2) + foot;
      text += joint + "\"wrist\"\n" + turn + aslant + head + joint + "\"hand\"\n" + turn + across + head;
    }
    const std::string file = scratch.file("upu.toml", text);
    const Json at = run({"at", file, "--joints=0,0,0", "--json"}).json();
    ASSERT_EQ(at["status"], "reached");
    EXPECT_NEAR(at["condition_number"].get<double>(), std::sqrt(2.0) * upright / level, 1e-9);
    EXPECT_NEAR(at["manipulability"].get<double>(), 1.0 / (1.5 * std::sqrt(3.0) * level * level * upright),
                1e-9);
  }
}

}  // namespace
}  // namespace zwidth::testing
