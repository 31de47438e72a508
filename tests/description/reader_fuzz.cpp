// Feeds mutated device files and overrides to the reader for ZWIDTH_FUZZ_SECONDS (20 if that is not set),
// always the same ones. Whatever comes must end in a description or in a DescriptionError; a description must
// pass `validate`, and read back equal after writing.

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <sstream>

#include "description/support.h"

#include "zwidth/description/validate.h"
#include "zwidth/description/write.h"

namespace zwidth {
namespace {

class Mutator {
 public:
  explicit Mutator(std::uint64_t seed) : random_(seed) {}

  std::size_t below(std::size_t n) {
    return n == 0 ? 0 : std::uniform_int_distribution<std::size_t>(0, n - 1)(random_);
  }

  std::string mutated(std::string text, const std::string& other) {
    for (std::size_t count = 1 + below(4); count > 0; --count) mutate(text, other);
    return text;
  }

  std::string override_text() {
    static const std::vector<std::string> keys{"mechanism.forearm",
                                               "mechanism.joint_range",
                                               "drive.motor",
                                               "drive[0].motor.resistance",
                                               "body.inertia",
                                               "drive.0.transmission",
                                               "leg[0].joint[1].axis",
                                               "device",
                                               "device.to_user[1]",
                                               "leg.joint.type",
                                               "a.b[3].c"};
    static const std::vector<std::string> values{
        "170 mm",       "-1",        "nan",  "[1, 2]",     "[]",        "{}",
        "{base=\"x\"}", "\"80 kg\"", "true", "1979-05-27", "[[1,2,3]]", "maxon-ec-max-40-120w-48v",
        "1e308",        "",          "'"};
    std::string text = keys[below(keys.size())] + "=" + values[below(values.size())];
    if (below(3) == 0) mutate(text, keys[below(keys.size())]);
    return text;
  }

 private:
  void mutate(std::string& text, const std::string& other) {
    static const std::vector<std::string> pieces{"nan",         "inf",        "-",
                                                 "0",           "1e999",      "1e-320",
                                                 "\"",          "'''",        "\"\"\"",
                                                 "[",           "]",          "[[",
                                                 "]]",          "{",          "}",
                                                 "=",           ".",          ",",
                                                 "\n",          "#",          "\\u0000",
                                                 "\\",          "\xff",       "\xe2\x82",
                                                 "[[drive]]\n", "[[leg]]\n",  "[[leg.joint]]\n",
                                                 "[[body]]\n",  " mm\"",      " deg\"",
                                                 " kg\"",       "true",       "9999999999999999999",
                                                 "a.a.a.a",     "[device]\n", "base = \"maxon-mr-1000\"\n",
                                                 "1979-05-27"};
    const std::size_t at = below(text.size() + 1),
                      length = below(1 + std::min<std::size_t>(40, text.size() - at));
    switch (below(6)) {
      case 0:
        text.erase(at, length);
        break;
      case 1:
        text.insert(at, pieces[below(pieces.size())]);
        break;
      case 2:
        text.replace(at, length, pieces[below(pieces.size())]);
        break;
      case 3:
        if (at < text.size()) text[at] = static_cast<char>(below(256));
        break;
      case 4: {  // a line moves
        const std::size_t begin = other.rfind('\n', below(other.size() + 1));
        const std::size_t start = begin == std::string::npos ? 0 : begin;
        text.insert(std::min(text.find('\n', at), text.size()),
                    other.substr(start, other.find('\n', start + 1) - start));
        break;
      }
      default:
        text.resize(at);
    }
  }

  std::mt19937_64 random_;
};

int run(double seconds) {
  const std::vector<std::string> seeds{delta_text(), legs_text()};
  Mutator mutator(4);
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
  long inputs = 0, accepted = 0;
  while (std::chrono::steady_clock::now() < end) {
    const std::string& seed = seeds[mutator.below(seeds.size())];
    const std::string text = mutator.mutated(seed, seeds[mutator.below(seeds.size())]);
    std::vector<std::string> overrides;
    for (std::size_t count = mutator.below(2) * mutator.below(3); count > 0; --count)
      overrides.push_back(mutator.override_text());
    ++inputs;
    const char* wrong = nullptr;
    try {
      const Description device = parse_description(text, "fuzz.toml", overrides, catalogue());
      ++accepted;
      std::ostringstream out;
      write_description(device, out, catalogue());
      if (!validate(device).empty()) wrong = "was accepted, but is not valid";
      if (parse_description(out.str(), "again.toml", {}, catalogue()) != device)
        wrong = "does not read back equal";
    } catch (const DescriptionError& error) {
      if (error.problems().empty()) wrong = "was refused without a reason";
    } catch (const std::exception& error) {
      std::fprintf(stderr, "%s\n", error.what());
      wrong = "ended in another exception";
    }
    if (wrong != nullptr) {
      std::fprintf(stderr, "input %ld %s:\n%s\n", inputs, wrong, text.c_str());
      for (const std::string& set : overrides) std::fprintf(stderr, "--set %s\n", set.c_str());
      return 1;
    }
  }
  std::printf("%ld inputs, %ld of them accepted\n", inputs, accepted);
  return 0;
}

}  // namespace
}  // namespace zwidth

int main() {
  const char* seconds = std::getenv("ZWIDTH_FUZZ_SECONDS");
  return zwidth::run(seconds == nullptr ? 20.0 : std::atof(seconds));
}
