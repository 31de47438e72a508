#include <gtest/gtest.h>
#include <map>

#include "run_command.h"

namespace zwidth::testing {
namespace {

std::map<std::string, double> findings(const nlohmann::json& document) {
  std::map<std::string, double> found;
  for (const nlohmann::json& one : document.at("reproductions")[0].at("search")) {
    found[one.at("id")] = one.at("computed").get<double>();
  }
  return found;
}

// What an independent search of the same problem reached: 38 of the 40 published designs beaten, smallest
// max_j(O_j/O_j,published) 0.972 in the median; a front above 0.99 or 1.06 has not converged.
TEST(ReproduceSearch, BeatsThePublishedRCubes) {
  const Outcome outcome = run({"reproduce", "r-cube", "--strict", "--json"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  std::map<std::string, double> found = findings(outcome.json());
  EXPECT_EQ(found["r-cube.search.feasible"], 22.0);
  EXPECT_EQ(found["r-cube.search.nearly_feasible"], 40.0);
  EXPECT_GE(found["r-cube.search.dominated"], 38.0);
  EXPECT_EQ(found["r-cube.search.dominated_of_ours"], 0.0);
  EXPECT_GT(found["r-cube.search.hypervolume_ratio"], 1.3);
  EXPECT_NEAR(found["r-cube.search.ratio_median"], 0.972, 0.01);
  EXPECT_LT(found["r-cube.search.ratio_worst"], 1.06);
}

TEST(ReproduceSearch, FindsTheOtherOptimaByStudies) {
  for (const char* device : {"five-bar", "pneumatic"}) {
    const Outcome outcome = run({"reproduce", device, "--strict"});
    EXPECT_EQ(outcome.status, 0) << outcome.out;
    EXPECT_NE(outcome.out.find("by the study"), std::string::npos) << device;
  }
}

}  // namespace
}  // namespace zwidth::testing
