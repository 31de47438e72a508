#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <regex>

#include "even_study.h"
#include "run_command.h"

// The page and the figures that `optimise` writes.

namespace zwidth::testing {
namespace {

struct Written {
  ScratchDirectory scratch;
  std::string folder = (scratch.path() / "out").string();
  Outcome outcome;
  std::string page;

  explicit Written(const std::string& study) {
    outcome = run({"optimise", scratch.file("study.toml", study), "-o", folder, "--json", "--samples", "100"});
    page = read_text(std::filesystem::path(folder) / "index.html");
  }
  bool says(const std::string& words) const { return page.find(words) != std::string::npos; }
};

// As the page has lengths: four digits.
std::string millimetres(double metres) {
  return fmt::format("{:.{}f} mm", 1e3 * metres, metres < 0.1 ? 2 : 1);
}

int letters(const std::string& text) {
  int count = 0;
  for (const char c : text) count += (static_cast<unsigned char>(c) & 0xC0U) != 0x80U ? 1 : 0;
  return count;
}

// No text of a figure is cut off at its edges, nor runs into the name of the axis at the left.
void expect_texts_inside(const std::filesystem::path& folder) {
  constexpr double kLetter = 6.6;  // of the default sans-serif at 12 px
  const std::regex box("viewBox=\"0 0 ([0-9.]+) ([0-9.]+)\""),
      text("<text([^>]*) x=\"(-?[0-9.]+)\" y=\"(-?[0-9.]+)\"( text-anchor=\"(middle|end|start)\")?>([^<]*)");
  int seen = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::string svg = read_text(entry.path());
    std::smatch size;
    ASSERT_TRUE(std::regex_search(svg, size, box)) << entry.path();
    const double width = std::stod(size[1]), height = std::stod(size[2]);
    const bool upright_name = svg.find("rotate(-90)") != std::string::npos;
    for (std::sregex_iterator one(svg.begin(), svg.end(), text), end; one != end; ++one) {
      const double x = std::stod((*one)[2]), y = std::stod((*one)[3]), long_ = kLetter * letters((*one)[6]);
      const std::string anchor = (*one)[5];
      const double left = anchor == "middle" ? x - long_ / 2.0 : anchor == "end" ? x - long_ : x;
      EXPECT_GE(left, upright_name ? 18.0 : -0.1) << entry.path() << ": " << (*one)[6];
      EXPECT_LE(left + long_, width + 0.1) << entry.path() << ": " << (*one)[6];
      EXPECT_GE(y, 8.0) << entry.path() << ": " << (*one)[6];
      EXPECT_LE(y, height) << entry.path() << ": " << (*one)[6];
      ++seen;
    }
  }
  EXPECT_GT(seen, 20);
}

TEST(OutcomePage, SaysUnitsAndSetsDesignsSideBySide) {
  const Written done(even_study(8) + "[[tolerance]]\nkey = \"mechanism.crank\"\nhalf_width = \"0.1 mm\"\n");
  ASSERT_EQ(done.outcome.status, 0) << done.outcome.err;
  const auto document = done.outcome.json();
  const auto row_of = [&](std::size_t objective) {
    const std::string name = objective == 0 ? "worst" : "length";
    double best = HUGE_VAL;
    for (const auto& one : document["pareto"]) best = std::min(best, one["objectives"][name].get<double>());
    return best;
  };
  for (const std::string& words :
       {std::string("length [mm]"), std::string("device as it is"), std::string("best worst"),
        std::string("best length"), millimetres(row_of(1)),
        millimetres(document["start"]["objectives"]["length"].get<double>()),
        millimetres(document["chosen"]["variables"]["crank"].get<double>()),
        std::string("Which constraints decide"), std::string("What small changes do"),
        std::string("crank ±0.1"), std::string("hypervolume, % of the last")}) {
    EXPECT_TRUE(done.says(words)) << words;
  }
  EXPECT_FALSE(document["start"]["moved"].get<bool>());
  expect_texts_inside(std::filesystem::path(done.folder) / "figures");
}

// A factor on a logarithm means nothing: its changes are differences. Large numbers keep off the axis' name.
TEST(OutcomePage, TellsLogarithmsByDifferences) {
  std::string text = even_study(8);
  text.replace(text.find("minimise = \"condition\""), 22, "minimise = \"log10(condition)\"");
  text.replace(text.find("minimise = \"crank + coupler\""), 28, "minimise = \"1e12*(crank + coupler)^3\"");
  const Written done(text);
  ASSERT_EQ(done.outcome.status, 0) << done.outcome.err;
  EXPECT_EQ(done.page.find(" times"), std::string::npos);
  const std::size_t tornado = done.page.find("id=\"sensitivity-1\"");
  ASSERT_NE(tornado, std::string::npos);
  const std::string first = done.page.substr(tornado, done.page.find("</figure>", tornado) - tornado);
  EXPECT_NE(first.find("+0.6 mm"), std::string::npos) << first;
  EXPECT_EQ(first.find("%"), std::string::npos) << first;
  EXPECT_TRUE(done.says("10⁹ m³")) << "powers of ten belong to the unit";
  expect_texts_inside(std::filesystem::path(done.folder) / "figures");
}

TEST(OutcomePage, SaysWhereTheDeviceIsNotADesignOfTheStudy) {
  std::string text = even_study(6);
  text.replace(text.find("max = \"14 cm\""), 13, "max = \"8.5 cm\"");
  const Written done(text);
  ASSERT_EQ(done.outcome.status, 0) << done.outcome.err;
  EXPECT_TRUE(done.says("nearest to the device"));
  EXPECT_TRUE(done.outcome.json()["start"]["moved"].get<bool>());
}

// What a growth by 1 % of the range does is asked for, not drawn out from a slope: exp(0.6) - 1.
TEST(OutcomePage, TellsWhatAChangeReallyDoes) {
  std::string text = even_study(3);
  text.replace(text.find("minimise = \"crank + coupler\""), 28, "minimise = \"exp(crank / 1 mm) + 0*coupler\"");
  const Written done(text);
  ASSERT_EQ(done.outcome.status, 0) << done.outcome.err;
  EXPECT_TRUE(done.says("+82.2 %"));
}

// Two variables may choose among the same parts.
TEST(OutcomePage, NamesTheVariableOfAPart) {
  const Written done(
      "[study]\nname = \"motor\"\ndevice = \"delta\"\n[search]\nalgorithm = \"grid\"\n"
      "[[variable]]\nname = \"which\"\nkey = \"drive.motor\"\n"
      "parts = [\"maxon-ec-max-40-70w-48v\", \"maxon-ec-max-40-120w-48v\"]\n"
      "[[measure]]\nname = \"force\"\nfigure = \"force_min\"\nat = \"home\"\n"
      "[[objective]]\nname = \"strength\"\nmaximise = \"force\"\n");
  ASSERT_EQ(done.outcome.status, 0) << done.outcome.err;
  const std::string bar = read_text(std::filesystem::path(done.folder) / "figures" / "steps-1.svg");
  EXPECT_NE(bar.find("which maxon-ec-max-40-70w-48v"), std::string::npos) << bar;
}

TEST(OutcomePage, TellsOfDesignsThatMeetNotAllConstraints) {
  std::string text = even_study(2);
  text.replace(text.find("max = 5"), 7, "max = 0.5");
  const Written done(text);
  EXPECT_EQ(done.outcome.status, 1);
  EXPECT_TRUE(done.says("never met"));
  EXPECT_TRUE(done.says("least violation"));
}

}  // namespace
}  // namespace zwidth::testing
