#include <gtest/gtest.h>
#include <regex>
#include <set>
#include <toml++/toml.h>

#include "house/sources.h"

namespace zwidth::house {
namespace {

// Files that people write, as opposed to pictures and data copied from elsewhere.
bool is_written(const std::filesystem::path& file) {
  static const std::set<std::string> kWritten = {".h", ".cpp", ".cmake", ".txt", ".toml", ".md", ".in", ""};
  return kWritten.contains(file.extension().string());
}

bool is_code(const std::filesystem::path& file) {
  const std::string extension = file.extension().string();
  return extension == ".h" || extension == ".cpp" || extension == ".cmake" || extension.empty();
}

TEST(Repository, NamesNoPlaceOfOneMachine) {
  const std::regex place(R"((^|[\s"'=(:])/(home|root|work|Users|tmp)/?[A-Za-z0-9_.-]*/)");
  for (const std::filesystem::path& file : files(root())) {
    if (!is_written(file)) continue;
    int number = 0;
    for (const std::string& line : lines(file)) {
      ++number;
      EXPECT_FALSE(std::regex_search(line, place)) << name(file) << ":" << number << ": " << line;
    }
  }
}

TEST(Repository, LeavesNothingForLater) {
  const std::regex mark(R"(\b(TO)(DO)\b|\b(FIX)(ME)\b|\b(XX)(X)\b)");
  for (const std::filesystem::path& file : files(root())) {
    if (!is_written(file)) continue;
    int number = 0;
    for (const std::string& line : lines(file)) {
      ++number;
      EXPECT_FALSE(std::regex_search(line, mark)) << name(file) << ":" << number << ": " << line;
    }
  }
}

TEST(Repository, NoTestIsSwitchedOffWithoutAReason) {
  const std::regex off(R"(GTEST_SKIP\(\)(?! << ")|\bDISABLED_\w)");
  for (const std::filesystem::path& file : files(root() / "tests")) {
    if (!is_code(file)) continue;
    EXPECT_FALSE(std::regex_search(read(file), off)) << name(file);
  }
}

TEST(Repository, NoSourceIsLongerThanEightHundredLines) {
  for (const std::filesystem::path& file : files(root())) {
    if (!is_code(file)) continue;
    EXPECT_LE(lines(file).size(), 800u) << name(file);
  }
}

// Every table that holds a value says where it comes from, itself or a table around it.
void expect_sources(const toml::table& table, bool has_source, const std::string& file,
                    const std::string& path) {
  has_source = has_source || table["source"].is_string();
  for (const auto& [key, node] : table) {
    const std::string place = path.empty() ? std::string(key.str()) : path + "." + std::string(key.str());
    if (const toml::table* inner = node.as_table()) {
      expect_sources(*inner, has_source, file, place);
    } else if (const toml::array* array = node.as_array(); array != nullptr && array->is_array_of_tables()) {
      for (const toml::node& element : *array) expect_sources(*element.as_table(), has_source, file, place);
    } else {
      EXPECT_TRUE(has_source) << file << ":" << node.source().begin.line << ": " << place << " has no source";
    }
  }
}

TEST(Repository, EveryValueOfADeviceOrPartHasASource) {
  for (const char* folder : {"devices", "parts"}) {
    int count = 0;
    for (const std::filesystem::path& file : files(root() / folder)) {
      if (file.extension() != ".toml") continue;
      ++count;
      const toml::table table = toml::parse_file(file.string());
      // [device] speaks for the whole file, unless a table brings a source of its own.
      expect_sources(table, table["device"]["source"].is_string(), name(file), "");
    }
    EXPECT_GT(count, 0) << folder;
  }
}

// `tools/make_images` draws and writes it anew.
TEST(Repository, GalleryShowsEveryDevice) {
  const std::string gallery = read(root() / "docs/gallery.md");
  for (const std::filesystem::path& file : files(root() / "devices")) {
    if (file.extension() != ".toml") continue;
    const std::string picture = "images/" + file.stem().string() + ".png";
    EXPECT_NE(gallery.find("](" + picture + ")"), std::string::npos) << picture;
    EXPECT_LT(std::filesystem::file_size(root() / "docs" / picture), 150'000u) << picture;
  }
}

TEST(Repository, LinksOfTheDocumentsResolve) {
  const std::regex link(R"(\]\(([^)\s]+)\))");
  int count = 0;
  for (const std::filesystem::path& file : files(root())) {
    if (file.extension() != ".md") continue;
    const std::string text = read(file);
    for (std::sregex_iterator match(text.begin(), text.end(), link), end; match != end; ++match) {
      const std::string target = (*match)[1].str().substr(0, (*match)[1].str().find('#'));
      if (target.empty() || target.find("://") != std::string::npos) continue;
      ++count;
      EXPECT_TRUE(std::filesystem::exists(file.parent_path() / target)) << name(file) << " links to " << target;
    }
  }
  EXPECT_GT(count, 0);
}

// The table formula -> function of docs/notation.md: each row's file holds each name in the row's last column.
TEST(Repository, FormulasAreWhereTheNotationSays) {
  const std::regex row(R"(^\|.*\| `([^`]+\.(?:h|cpp))` \| (.*) \|$)");
  const std::regex code("`([A-Za-z_0-9:]+)`");
  int count = 0;
  for (const std::string& line : lines(root() / "docs/notation.md")) {
    std::smatch match;
    if (!std::regex_match(line, match, row)) continue;
    const std::filesystem::path file = root() / "src" / match[1].str();
    ASSERT_TRUE(std::filesystem::exists(file)) << line;
    const std::string text = read(file);
    const std::string names = match[2].str();
    for (std::sregex_iterator named(names.begin(), names.end(), code), end; named != end; ++named) {
      ++count;
      EXPECT_NE(text.find((*named)[1].str()), std::string::npos) << match[1] << " has no " << (*named)[1];
    }
  }
  EXPECT_GT(count, 20);
}

}  // namespace
}  // namespace zwidth::house
