#include <cstdio>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "house/sources.h"

// docs/json.md names every key that the command writes.

namespace zwidth::house {
namespace {

struct Verb {
  std::string arguments;
  std::vector<std::string> free;  // objects whose keys are names of things, not of quantities
};

nlohmann::json run(const std::string& arguments) {
  const std::string command = std::string(ZWIDTH_PROGRAM) + " " + arguments + " --json 2>/dev/null";
  std::string text;
  FILE* pipe = popen(command.c_str(), "r");
  if (pipe == nullptr) return {};
  char buffer[4096];
  for (std::size_t count = 0; (count = std::fread(buffer, 1, sizeof buffer, pipe)) > 0;)
    text.append(buffer, count);
  pclose(pipe);
  return nlohmann::json::parse(text, nullptr, false);
}

void expect_documented(const nlohmann::json& value, const Verb& verb, const std::string& path,
                       const std::string& page) {
  if (value.is_array()) {
    for (const nlohmann::json& element : value) expect_documented(element, verb, path, page);
  }
  if (!value.is_object()) return;
  const bool names = std::find(verb.free.begin(), verb.free.end(), path) != verb.free.end();
  for (const auto& [key, inner] : value.items()) {
    const std::string place = path.empty() ? key : path + "." + key;
    EXPECT_TRUE(names || page.find("`" + key + "`") != std::string::npos)
        << "docs/json.md does not explain " << place << " of zwidth " << verb.arguments;
    expect_documented(inner, verb, names ? path + ".*" : place, page);
  }
}

TEST(JsonKeys, AreAllDocumented) {
  const std::string page = read(root() / "docs/json.md");
  const std::vector<Verb> verbs = {
      {"at delta --joints 0.1,0.2,0.3 --load 1,2,3 --rate 1,0,0 --acceleration 0,1,0", {}},
      {"at delta --position 0.02,-0.03,0.12", {}},
      {"at delta --position 0,0,1", {}},
      {"at seven-dof --position 0.3,0,0.1 --orientation 0,0,0 --keep theta3", {}},
      {"at seven-dof --position 0.3,0,0.1 --maximise manipulability", {}},
      {"workspace delta --grid 5mm --all-figures", {}},
      {"workspace five-bar --grid 10mm --all-figures", {}},
      {"workspace five-bar --grid 10mm --against five-bar", {}},
      {"workspace seven-dof --grid 60mm", {}},
      {"workspace " + (root() / "examples/devices/three-rrr.toml").string() + " --grid 10mm", {}},
      {"workspace pneumatic-3 --grid 20mm", {}},
      {"size delta", {}},
      {"size pneumatic-3 --load 1,0,2", {}},
      {"synthesise arm-cylinder --cylinder airpel-m9d12.5u --retracted 75mm --range 30deg --load 5N --distance "
       "68mm",
       {}},
      {"show delta", {}},
      {"export r-cube --to urdf", {}},
      {"check delta", {}},
      {"check five-bar-grid", {}},
      {"optimise five-bar-grid -o " ZWIDTH_REPORT "/optimise",
       {"pareto.variables", "pareto.objectives", "pareto.constraints", "pareto.derived", "chosen.variables",
        "chosen.objectives", "chosen.constraints", "chosen.derived", "chosen.slopes", "chosen.slopes.*",
        "chosen.steps", "chosen.steps.*.up.figures", "chosen.steps.*.down.figures", "chosen.margins",
        "chosen.tolerances.objectives", "start.variables", "start.objectives", "start.constraints",
        "start.derived"}},
      {"figures", {}},
      {"devices", {}},
      {"parts", {"parts.values"}},
      {"reproduce delta", {}},
      {"report delta -o " ZWIDTH_REPORT, {"drives.figures"}},
      {"report five-bar -o " ZWIDTH_REPORT, {"drives.figures"}},
  };
  for (const Verb& verb : verbs) {
    const nlohmann::json document = run(verb.arguments);
    ASSERT_TRUE(document.is_object()) << "zwidth " << verb.arguments << " --json wrote no JSON document";
    expect_documented(document, verb, "", page);
  }
}

}  // namespace
}  // namespace zwidth::house
