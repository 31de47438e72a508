#include <algorithm>
#include <filesystem>
#include <gtest/gtest.h>

#include "laws/laws.h"
#include "support/random_mechanisms.h"
#include "support/storm.h"

#include "zwidth/analysis/data_sheet.h"
#include "zwidth/description/read.h"
#include "zwidth/mechanism/families.h"
#include "zwidth/mechanism/jacobian.h"
#include "zwidth/mechanism/mobility.h"

namespace zwidth {
namespace {

ActiveVector within_ranges(const Mechanism& mechanism, std::mt19937_64& random) {
  ActiveVector active(mechanism.active_count());
  for (int i = 0; i < active.size(); ++i) {
    const Interval range = mechanism.active_range(i);
    active[i] = std::uniform_real_distribution(range.min, range.max)(random);
  }
  return active;
}

// A case here is a posture or a mechanism, with all laws: worth a thousand of other storms' cases.
int cases(int default_size) {
  constexpr int kWorth = 1000;
  return test::storm_size(default_size * kWorth) / kWorth;
}

constexpr double kRegular = 1e-3;  // conditioning below is left to the laws about singularities

// ------------------------------------------------------------------------------------------- devices/*.toml

std::vector<std::string> device_files() {
  std::vector<std::string> files;
  for (const auto& entry : std::filesystem::directory_iterator(ZWIDTH_DEVICES)) {
    if (entry.path().extension() == ".toml") files.push_back(entry.path().string());
  }
  std::sort(files.begin(), files.end());
  return files;
}

class DeviceLaws : public ::testing::TestWithParam<std::string> {
 protected:
  DeviceLaws() : description_(read_description(GetParam(), {}, catalogue())) {}

  static const Catalogue& catalogue() {
    static const Catalogue loaded = Catalogue::load();
    return loaded;
  }
  Mechanism mechanism() const { return mechanism_with_drives(description_); }

  Description description_;
};

TEST_P(DeviceLaws, HoldInAndAroundItsJointRanges) {
  std::mt19937_64 random(71);
  const Mechanism device = mechanism();
  const int postures = cases(60);
  int regular = 0;
  for (const bool closed_form : {true, false}) {
    if (closed_form && device.closed_form() == nullptr) continue;
    for (int k = 0; k < postures; ++k) {
      const Solution solution =
          solve_forward(device, within_ranges(device, random), {.closed_form = closed_form});
      if (!solution || solution.conditioning < kRegular) continue;
      ++regular;
      SCOPED_TRACE(testing::Message() << (closed_form ? "closed form" : "general solver") << " at "
                                      << solution.posture->active().transpose());
      laws::all(laws::any_situation(solution, closed_form, random));
    }
  }
  EXPECT_GT(regular, postures / 4);
}

TEST_P(DeviceLaws, ClosedFormAndGeneralSolverAgree) {
  std::mt19937_64 random(72);
  const Mechanism device = mechanism();
  if (device.closed_form() == nullptr) GTEST_SKIP() << "it has no closed form";
  const int postures = cases(300);
  int compared = 0;
  for (int k = 0; k < postures; ++k) {
    const ActiveVector q = within_ranges(device, random);
    const Solution closed = solve_forward(device, q),
                   general = solve_forward(device, q, {.closed_form = false});
    ASSERT_EQ(closed.posture.has_value(), general.posture.has_value()) << q.transpose();
    if (!closed || closed.conditioning < kRegular) continue;
    ++compared;
    const double tolerance = 1e-11 / closed.conditioning;
    EXPECT_EQ(closed.status, general.status);
    EXPECT_LT((closed.posture->tool().position - general.posture->tool().position).norm(), tolerance)
        << q.transpose();
    EXPECT_LT((closed.posture->tool().rotation - general.posture->tool().rotation).norm(), tolerance);
    for (int j = 0; j < device.joint_count(); ++j) {
      EXPECT_LT(std::abs(std::remainder(closed.posture->joints()[j] - general.posture->joints()[j],
                                        6.283185307179586)),
                10.0 * tolerance);
    }
    EXPECT_LT((jacobian(*closed.posture) - jacobian(*general.posture)).norm(),
              10.0 * tolerance / closed.conditioning);
  }
  EXPECT_GT(compared, postures / 4);
}

TEST_P(DeviceLaws, BordersAndCornersAreFinite) {
  std::mt19937_64 random(73);
  const Mechanism device = mechanism();
  for (const bool closed_form : {true, false}) {
    if (closed_form && device.closed_form() == nullptr) continue;
    const SolveOptions options{.closed_form = closed_form};
    for (int k = 0; k < cases(10); ++k) {
      const Solution start = solve_forward(device, within_ranges(device, random), options);
      if (start) laws::borders_are_finite(device, start, closed_form, random);
    }
    // Angles at which things line up.
    for (int k = 0; k < cases(60); ++k) {
      ActiveVector q(device.active_count());
      for (int i = 0; i < q.size(); ++i) {
        const Interval range = device.active_range(i);
        const int which = std::uniform_int_distribution(0, 5)(random);
        q[i] = which == 0   ? range.min
               : which == 1 ? range.max
               : which == 2 ? range.middle()
                            : 1.5707963267948966 * (which - 4);
      }
      const Solution corner = solve_forward(device, q, options);
      SCOPED_TRACE(testing::Message() << q.transpose());
      if (corner) laws::everything_is_finite(corner);
    }
  }
}

TEST_P(DeviceLaws, HasAsManyActiveJointsAsFreedoms) {
  const Mechanism device = mechanism();
  const Mobility count = sample_mobility(device).typical;
  EXPECT_EQ(count.freedoms, count.active);
  EXPECT_EQ(count.gruebler, count.freedoms);
  EXPECT_EQ(count.loose, 0);
  EXPECT_EQ(count.undeclared, 0);
  // Spelled out it is the same mechanism.
  const Mobility spelled = sample_mobility(Mechanism(spelled_out(description_))).typical;
  EXPECT_EQ(spelled.freedoms, count.freedoms);
}

INSTANTIATE_TEST_SUITE_P(All, DeviceLaws, ::testing::ValuesIn(device_files()), [](const auto& file) {
  std::string name = std::filesystem::path(file.param).stem().string();
  std::replace_if(
      name.begin(), name.end(), [](char c) { return std::isalnum(static_cast<unsigned char>(c)) == 0; }, '_');
  return name;
});

// --------------------------------------------------------------------------------------- random mechanisms

class RandomLaws : public ::testing::TestWithParam<int> {};

TEST_P(RandomLaws, HoldForMechanismsThatNobodyDesigned) {
  const int kinds = test::random_mechanism_kinds();
  const int count = (cases(210) + kinds - 1) / kinds;
  int regular = 0, asked = 0, found = 0;
  for (int k = 0; k < count; ++k) {
    const auto seed = static_cast<std::uint64_t>(GetParam() + k * kinds);
    const test::RandomMechanism made = test::random_mechanism(seed);
    SCOPED_TRACE(testing::Message() << "seed " << seed << ", " << made.kind);
    const Mechanism mechanism(made.description);
    std::mt19937_64 random(seed);
    for (int posture = 0; posture < 6; ++posture) {
      const ActiveVector q = posture == 0 ? ActiveVector(ActiveVector::Zero(mechanism.active_count()))
                                          : within_ranges(mechanism, random);
      const Solution solution = solve_forward(mechanism, q);
      if (posture == 0) {
        ASSERT_TRUE(solution);
      }
      if (!solution) continue;
      if (solution.conditioning < kRegular) {
        laws::everything_is_finite(solution);
        continue;
      }
      ++regular;
      laws::all(laws::any_situation(solution, false, random));
      // Without a hint where to start, the pose may be met in another way, or the straight way to it may be
      // barred.
      const Solution cold = solve_inverse(mechanism, solution.posture->tool());
      ++asked;
      if (!cold) continue;
      ++found;
      EXPECT_LT((cold.posture->tool().position - solution.posture->tool().position).norm(), 1e-9);
    }
    const Solution zero = solve_forward(mechanism, ActiveVector::Zero(mechanism.active_count()));
    laws::borders_are_finite(mechanism, zero, false, random);
    const MobilitySample sample = sample_mobility(mechanism, 10);
    EXPECT_EQ(sample.typical.freedoms, mechanism.active_count());
    EXPECT_EQ(sample.typical.loose, 0);
    EXPECT_GE(sample.typical.redundant_equations, 0);
  }
  EXPECT_GT(regular, 2 * count);
  EXPECT_GT(found, asked / 2) << "of " << asked;
}

INSTANTIATE_TEST_SUITE_P(Kinds, RandomLaws, ::testing::Range(0, test::random_mechanism_kinds()));

TEST(RandomMechanisms, CountAsTheirKindsAreBuilt) {
  // What Grübler counts, and in which group, for one of each kind; rank says how many freedoms there are.
  for (int kind = 0; kind < test::random_mechanism_kinds(); ++kind) {
    const test::RandomMechanism made = test::random_mechanism(static_cast<std::uint64_t>(kind));
    const Mobility count = sample_mobility(Mechanism(made.description), 10).typical;
    EXPECT_EQ(count.gruebler, count.freedoms) << made.kind;
    if (made.kind.starts_with("planar")) {
      EXPECT_EQ(count.group, MotionGroup::planar) << made.kind;
    }
    if (made.kind.starts_with("fixed orientation") && made.kind != "fixed orientation by rods") {
      EXPECT_EQ(count.group, MotionGroup::translation) << made.kind;
    }
    if (made.kind == "rotation") {
      EXPECT_EQ(count.group, MotionGroup::spherical);
    }
    if (made.kind == "hexapod") {
      EXPECT_EQ(count.group, MotionGroup::spatial);
    }
  }
}

}  // namespace
}  // namespace zwidth
