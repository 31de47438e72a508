#include <algorithm>
#include <cctype>
#include <filesystem>
#include <gtest/gtest.h>
#include <sstream>
#include <string>
#include <vector>

#include "run_command.h"

namespace zwidth::testing {
namespace {

class Report : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    scratch_ = new ScratchDirectory;
    outcome_ = new Outcome(run({"report", "delta", "-o", (scratch_->path() / "out").string()}));
    html_ = new std::string(read_text(scratch_->path() / "out/report.html"));
  }
  static void TearDownTestSuite() {
    delete html_;
    delete outcome_;
    delete scratch_;
  }
  static ScratchDirectory* scratch_;
  static Outcome* outcome_;
  static std::string* html_;
};
ScratchDirectory* Report::scratch_ = nullptr;
Outcome* Report::outcome_ = nullptr;
std::string* Report::html_ = nullptr;

size_t count(const std::string& text, const std::string& word) {
  size_t found = 0;
  for (size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++found;
  return found;
}

TEST_F(Report, PrintsTheSheetAndSaysWhereThePageIs) {
  EXPECT_EQ(outcome_->status, 0) << outcome_->err;
  for (const char* word : {"Workspace", "Force", "Inertia", "Drive", "report.html"})
    EXPECT_NE(outcome_->out.find(word), std::string::npos) << word;
}

TEST_F(Report, FitsEightyColumns) {
  std::istringstream lines(outcome_->out);
  for (std::string line; std::getline(lines, line);) {
    if (line.find(scratch_->path().string()) != std::string::npos) continue;  // a path is as long as it is
    const auto columns = std::count_if(line.begin(), line.end(),
                                       [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; });
    EXPECT_LE(columns, 80) << line;
  }
}

TEST_F(Report, PageLoadsNothingFromElsewhere) {
  // Only links that a person clicks and names of namespaces may hold an address.
  EXPECT_EQ(html_->find("http://"), std::string::npos);
  EXPECT_EQ(html_->find("https://"), std::string::npos);
  for (const char* tag : {"<script", "<link", "<img", "<iframe", "@import"})
    EXPECT_EQ(html_->find(tag), std::string::npos) << tag;
}

TEST_F(Report, PageIsWellFormed) {
  // Every element that is opened is closed, in order; void elements aside. (No std::regex: the compiler warns
  // about its insides under the sanitizers.)
  const std::string& html = *html_;
  std::vector<std::string> open;
  for (size_t at = html.find('<'); at != std::string::npos; at = html.find('<', at + 1)) {
    size_t end = at;
    for (bool quoted = false; end < html.size() && (quoted || html[end] != '>'); ++end) {
      if (html[end] == '"') quoted = !quoted;
    }
    ASSERT_LT(end, html.size()) << "a tag without an end near " << html.substr(at, 80);
    const bool closes = html[at + 1] == '/';
    const size_t start = at + (closes ? 2 : 1);
    const std::string name = html.substr(start, std::min(html.find_first_of(" >/", start), end) - start);
    if (name == "!DOCTYPE" || name == "meta" || html[end - 1] == '/') continue;
    if (closes) {
      ASSERT_FALSE(open.empty()) << name;
      ASSERT_EQ(open.back(), name) << "near " << html.substr(at, 80);
      open.pop_back();
    } else {
      open.push_back(name);
    }
  }
  EXPECT_TRUE(open.empty());
  const auto is_letter = [](char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0; };
  for (const char* word : {"nan", "inf"}) {
    for (size_t at = html.find(word); at != std::string::npos; at = html.find(word, at + 1)) {
      EXPECT_TRUE(is_letter(html[at - 1]) || is_letter(html[at + 3])) << html.substr(at - 40, 80);
    }
  }
}

TEST_F(Report, EveryFigureIsThereAndNotTrivial) {
  for (const char* id : {"device", "workspace-3d", "view-xy", "view-xz", "view-yz", "condition-xy",
                         "condition-xz", "condition-yz", "force-xy", "force-xz", "force-yz", "margins",
                         "current-loop", "frequency-response", "phase-response", "step-response"}) {
    const std::string file = read_text(scratch_->path() / "out/figures" / (std::string(id) + ".svg"));
    EXPECT_GT(file.size(), 2500u) << id;
    EXPECT_NE(html_->find("id=\"" + std::string(id) + "\""), std::string::npos) << id;
  }
  // A map has bands of many colours.
  const std::string map = read_text(scratch_->path() / "out/figures/condition-xy.svg");
  EXPECT_GT(count(map, "<path fill=\"#"), 8u);
}

// The sphere in a view of the workspace is a circle: the view is to scale.
TEST_F(Report, ViewsAreToScale) {
  for (const char* id : {"view-xy", "view-xz", "view-yz"}) {
    const std::string figure = read_text(scratch_->path() / "out/figures" / (std::string(id) + ".svg"));
    const auto half_axis = [&](const std::string& name) {
      const size_t at = figure.find(name, figure.find("<ellipse"));
      EXPECT_NE(at, std::string::npos) << id;
      return std::stod(figure.substr(at + name.size()));
    };
    EXPECT_NEAR(half_axis(" rx=\""), half_axis(" ry=\""), 0.11) << id;  // both rounded to a tenth of a pixel
  }
}

TEST_F(Report, ContentsLinkToSectionsThatExist) {
  const std::string start = "href=\"#";
  size_t links = 0;
  for (size_t at = html_->find(start); at != std::string::npos; at = html_->find(start, at + 1), ++links) {
    const size_t from = at + start.size();
    const std::string id = html_->substr(from, html_->find('"', from) - from);
    EXPECT_NE(html_->find("id=\"" + id + "\""), std::string::npos) << id;
  }
  EXPECT_GE(links, 8u);
}

TEST_F(Report, ChosenValuesAreMarked) {
  EXPECT_GT(count(*html_, "<span class=\"tag\">chosen</span>"), 3u);
}

TEST_F(Report, JsonHasThePublishedFigures) {
  const auto document = nlohmann::json::parse(read_text(scratch_->path() / "out/report.json"));
  // Spec values for the printed window -36..84 deg, table 3.1.
  EXPECT_NEAR(document["workspace"]["volume"].get<double>(), 4.18188e-3, 5e-9);
  EXPECT_EQ(document["workspace"]["lattice"]["inside"].get<long>(), 4182280);
  EXPECT_NEAR(document["workspace"]["ranges"]["x"][1].get<double>(), 0.129635, 1e-6);
  EXPECT_NEAR(document["workspace"]["ranges"]["z"][0].get<double>(), 0.066811, 1e-6);
  EXPECT_NEAR(document["drives"][0]["torque"]["continuous"]["usable"].get<double>(), 1.0453, 1e-4);
  EXPECT_NEAR(document["drives"][0]["actuator"]["resonance_frequency"].get<double>(), 193.0, 0.5);
}

TEST(ReportOptions, JsonIsTheDocumentOfTheFile) {
  const ScratchDirectory scratch;
  const Outcome outcome = run({"report", "delta", "--json", "-o", scratch.path().string()});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(outcome.out, read_text(scratch.path() / "report.json"));
}

TEST(ReportOptions, OverridesAreShown) {
  const ScratchDirectory scratch;
  const Outcome outcome =
      run({"report", "delta", "--set", "mechanism.forearm=170 mm", "-o", scratch.path().string()});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const std::string html = read_text(scratch.path() / "report.html");
  EXPECT_NE(html.find("<span class=\"tag\">--set</span>"), std::string::npos);
  EXPECT_NE(html.find("mechanism.forearm=170 mm"), std::string::npos);
}

TEST(ReportOptions, DefaultDirectoryBearsTheNameOfTheDevice) {
  const ScratchDirectory scratch;
  const Outcome outcome = run({"report", "delta", "--json"}, {.directory = scratch.path()});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_TRUE(std::filesystem::exists(scratch.path() / "report/delta/report.html"));
}

TEST(ReportOptions, MechanismOfLegsGetsTheSameWorkspace) {
  const ScratchDirectory scratch;
  const std::string file = scratch.file("d.toml", run({"show", "delta", "--as", "legs"}).out);
  const Outcome outcome = run({"report", file, "--json", "-o", (scratch.path() / "out").string()});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_NEAR(outcome.json()["workspace"]["volume"].get<double>(), 4.18188e-3, 2e-6);
}

}  // namespace
}  // namespace zwidth::testing
