#include "zwidth/description/reference.h"

#include <cstdlib>
#include <gtest/gtest.h>
#include <set>

#include "description/support.h"

namespace zwidth {
namespace {

// The document with every table between "<!-- keys of NAME -->" and "<!-- end -->" printed anew.
std::string updated(std::string document) {
  for (const TableReference& table : file_reference()) {
    const std::string begin = "<!-- keys of " + table.name + " -->\n", end = "<!-- end -->";
    const std::size_t at = document.find(begin);
    EXPECT_NE(at, std::string::npos) << "docs/device_file.md has no line " << begin;
    if (at == std::string::npos) continue;
    const std::size_t from = at + begin.size(), to = document.find(end, from);
    document.replace(from, to - from, markdown(table));
  }
  return document;
}

TEST(Reference, TheDocumentHasTheKeysOfTheCode) {
  const std::string document = text_of(ZWIDTH_DEVICE_FILE_DOC);
  const std::string expected = updated(document);
  if (std::getenv("ZWIDTH_UPDATE") != nullptr) {
    std::ofstream(ZWIDTH_DEVICE_FILE_DOC) << expected;
    return;
  }
  EXPECT_TRUE(document == expected)
      << "docs/device_file.md is out of date; ZWIDTH_UPDATE=1 description_test writes it anew";
}

const std::set<std::string> kFamilies = {"delta", "five-bar", "r-cube", "serial", "serial-joint"};

const std::set<std::string> kBeams = {"tube", "bar", "laminate", "ply"};

const std::set<std::string> kPneumatic = {"pneumatic-drive", "mount"};

// A file made of nothing but the examples of the reference.
std::string example_file() {
  std::string text;
  for (const TableReference& table : file_reference()) {
    if (table.name == "motor") break;
    if (table.name == "posture") continue;  // as many joints as the mechanism has
    if (kFamilies.contains(table.name) || kPneumatic.contains(table.name) || kBeams.contains(table.name))
      continue;
    if (table.name == "ratio" || table.name == "gearhead transmission")
      continue;  // a drive has one transmission
    std::string header = "[[" + table.name + "]]";
    if (table.name == "device") header = "[device]";
    if (table.name == "legs") header = "[mechanism]";
    if (table.name == "joint") header = "[[leg.joint]]";
    if (table.name == "capstan") header = "[drive.transmission]";
    if (table.name == "preloader" || table.name == "output") header = "[drive." + table.name + "]";
    text += header + "\n";
    for (const KeyReference& key : table.keys) {
      // The tool of this mechanism does not turn, and no body hangs on a pin.
      static const std::set<std::string> kElsewhere = {"transmission", "joints", "moment", "turns_with",
                                                       "pivot"};
      if (!key.example.empty() && !kElsewhere.contains(key.key)) text += key.key + " = " + key.example + "\n";
    }
  }
  return text;
}

TEST(Reference, ItsExamplesMakeAFileThatReads) {
  const std::vector<Problem> problems = problems_of(example_file());
  for (const Problem& problem : problems) ADD_FAILURE() << to_string(problem) << "\n" << example_file();
}

TEST(Reference, TheExamplesOfEachFamilyRead) {
  for (const TableReference& table : file_reference()) {
    if (!kFamilies.contains(table.name) || table.name == "serial") continue;
    std::string text = "[device]\nname = \"x\"\n[mechanism]\n";
    if (table.name == "serial-joint") text += "type = \"serial\"\n[[joint]]\n";
    for (const KeyReference& key : table.keys) {
      if (!key.example.empty()) text += key.key + " = " + key.example + "\n";
    }
    EXPECT_TRUE(problems_of(text).empty()) << text;
  }
}

TEST(Reference, TheExamplesOfTheOtherTransmissionsRead) {
  for (const TableReference& table : file_reference()) {
    if (table.name != "ratio" && table.name != "gearhead transmission") continue;
    std::string text = example_file();
    const std::string header = "[drive.transmission]\n";
    const std::size_t from = text.find(header) + header.size(), to = text.find("[drive.preloader]");
    std::string keys;
    for (const KeyReference& key : table.keys) {
      if (!key.example.empty()) keys += key.key + " = " + key.example + "\n";
    }
    text.replace(from, to - from, keys);
    for (const Problem& problem : problems_of(text)) ADD_FAILURE() << to_string(problem) << "\n" << text;
  }
}

TEST(Reference, TheExamplesOfBeamsRead) {
  const std::string device =
      "[device]\nname = \"x\"\n[mechanism]\ntype = \"serial\"\n"
      "[[joint]]\nname = \"theta1\"\ntype = \"revolute\"\na = 0.1\nrange = [-0.5, 0.5]\n"
      "[[body]]\non = \"arm/theta1\"\n";
  const auto keys_of = [](const std::string& name) {
    std::string text;
    for (const TableReference& table : file_reference()) {
      for (const KeyReference& key : table.keys) {
        if (table.name == name && !key.example.empty()) text += key.key + " = " + key.example + "\n";
      }
    }
    return text;
  };
  for (const std::string beam : {"tube", "bar"}) {
    const std::string of_material = "[body." + beam + "]\n" + keys_of(beam);
    std::string of_plies = of_material;
    of_plies.erase(of_plies.find("material ="),
                   of_plies.find('\n', of_plies.find("material =")) - of_plies.find("material =") + 1);
    of_plies += "[body." + beam + ".laminate]\n" + keys_of("laminate");
    std::string one_by_one = of_plies;
    one_by_one.erase(one_by_one.find("plies ="),
                     one_by_one.find('\n', one_by_one.find("plies =")) - one_by_one.find("plies =") + 1);
    one_by_one += "[[body." + beam + ".laminate.plies]]\n" + keys_of("ply");
    for (const std::string& text : {of_material, of_plies, one_by_one}) {
      for (const Problem& problem : problems_of(device + text))
        ADD_FAILURE() << to_string(problem) << "\n" << device + text;
    }
  }
}

TEST(Reference, TheExamplesOfAPneumaticDriveRead) {
  std::string text =
      "[device]\nname = \"x\"\n[mechanism]\ntype = \"serial\"\n"
      "[[joint]]\nname = \"theta1\"\ntype = \"revolute\"\na = 0.1\nrange = [-0.5, 0.5]\n";
  for (const TableReference& table : file_reference()) {
    if (!kPneumatic.contains(table.name)) continue;
    text += table.name == "mount" ? "[drive.mount]\n" : "[[drive]]\n";
    for (const KeyReference& key : table.keys) {
      // h belongs to another layout than that of the example.
      if (!key.example.empty() && key.key != "h") text += key.key + " = " + key.example + "\n";
    }
  }
  for (const Problem& problem : problems_of(text)) ADD_FAILURE() << to_string(problem) << "\n" << text;
}

TEST(Reference, ThePartsOfTheCatalogueHaveNoOtherKeys) {
  for (const TableReference& table : file_reference()) {
    if (table.name != "motor") continue;
    for (const PartValue& value : part_values(catalogue().all<Motor>().front())) {
      EXPECT_TRUE(std::any_of(table.keys.begin(), table.keys.end(), [&](const KeyReference& key) {
        return key.key == value.key;
      })) << value.key;
    }
  }
}

}  // namespace
}  // namespace zwidth
