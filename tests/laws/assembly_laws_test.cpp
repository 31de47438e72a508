#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <gtest/gtest.h>
#include <optional>
#include <random>

#include "support/random_mechanisms.h"
#include "support/storm.h"

#include "zwidth/description/read.h"
#include "zwidth/mechanism/mechanism.h"
#include "zwidth/mechanism/posture.h"

// Of the postures that close the loops at the same active joints a mechanism stands in one, that which it comes
// to from home. Others lie beyond a direct singularity, where the determinant of the closure changes its sign.

namespace zwidth {
namespace {

int cases(int default_size) {
  constexpr int kWorth = 1000;
  return test::storm_size(default_size * kWorth) / kWorth;
}

ActiveVector within_ranges(const Mechanism& mechanism, std::mt19937_64& random) {
  ActiveVector active(mechanism.active_count());
  for (int i = 0; i < active.size(); ++i) {
    const Interval range = mechanism.active_range(i);
    const double half = 0.5 * std::min(range.width(), 6.0);
    active[i] = std::uniform_real_distribution(range.middle() - half, range.middle() + half)(random);
  }
  return active;
}

// The closure in passive rates and platform twist, written down anew from what a posture shows; lengths over
// the characteristic one.
Eigen::MatrixXd closure_matrix(const Posture& posture) {
  const Mechanism& mechanism = posture.mechanism();
  const double length = mechanism.characteristic_length();
  int passive = 0;
  for (const JointModel& joint : mechanism.joints()) passive += joint.active < 0 ? 1 : 0;
  const auto legs = static_cast<Eigen::Index>(mechanism.legs().size());
  Eigen::MatrixXd M = Eigen::MatrixXd::Zero(6 * legs, passive + mechanism.tool_rows());
  Eigen::Index column = 0;
  for (int l = 0; l < legs; ++l) {
    const LegModel& leg = mechanism.legs()[static_cast<std::size_t>(l)];
    const bool rigid = leg.attachment == Attachment::rigid;
    for (int j = leg.first; j < leg.first + leg.count; ++j) {
      const JointModel& joint = mechanism.joints()[static_cast<std::size_t>(j)];
      if (joint.active >= 0) continue;
      const Vector3& axis = posture.joint_axis(j);
      const Vector3 end = j + 1 < leg.first + leg.count ? posture.joint_point(j + 1) : posture.leg_tip(l);
      Vector3 linear = axis, angular = Vector3::Zero();
      if (joint.type == JointType::revolute) {
        linear = axis.cross(posture.leg_tip(l) - posture.joint_point(j)) / length;
        angular = axis;
      } else if (joint.type == JointType::parallelogram) {
        linear = axis.cross(end - posture.joint_point(j)) / length;
      }
      M.col(column).segment<3>(6 * l) = linear;
      if (rigid) M.col(column).segment<3>(6 * l + 3) = angular;
      ++column;
    }
    const Vector3 arm = (posture.tool().rotation * leg.platform_point) / length;
    for (std::size_t c = 0; c < mechanism.tool_axes().size(); ++c) {
      const int axis = mechanism.tool_axes()[c];
      const auto at = passive + static_cast<Eigen::Index>(c);
      const Vector3 unit = Vector3::Unit(axis % 3);
      M.col(at).segment<3>(6 * l) = -(axis < 3 ? unit : Vector3(unit.cross(arm)));
      if (rigid && axis >= 3) M.col(at).segment<3>(6 * l + 3) = -unit;
    }
  }
  return M;
}

// Its determinant, without the rows that say nothing in a plane; nothing if equations outnumber the unknowns.
std::optional<double> closure_determinant(const Posture& posture) {
  const Eigen::MatrixXd M = closure_matrix(posture);
  std::vector<Eigen::Index> rows;
  for (Eigen::Index i = 0; i < M.rows(); ++i) {
    if (M.row(i).norm() > 1e-9) rows.push_back(i);
  }
  if (static_cast<Eigen::Index>(rows.size()) != M.cols()) return std::nullopt;
  return M(rows, Eigen::all).fullPivLu().determinant();
}

double gap(const Mechanism& mechanism, const Pose& a, const Pose& b) {
  const double turn = mechanism.tool_turns() ? (a.rotation - b.rotation).norm() : 0.0;
  return std::max((a.position - b.position).norm() / mechanism.characteristic_length(), turn);
}

// How far answers may lie apart: Newton's tolerance over the condition, and where the condition itself is
// small, its root, for there the equations are quadratic.
double tolerance_of(double conditioning) {
  return std::min(1e-10 / std::max(conditioning, 1e-12), 1e-4);
}

struct Tally {
  int answers = 0, walks = 0;
};

// The posture at `q` that many short steps of the joints lead to from home, each alone too short to go astray;
// none if that way ends. `narrowest` is the least conditioning on it.
std::optional<Posture> walked(const Posture& home, const ActiveVector& q, double& narrowest) {
  constexpr int kSteps = 400;
  const ActiveVector from = home.active();
  std::optional<Posture> last = home;
  narrowest = 1.0;
  for (int k = 1; k <= kSteps && last; ++k) {
    Solution next = solve_forward(home.mechanism(), from + (q - from) * (k / static_cast<double>(kSteps)),
                                  {.start = &*last, .closed_form = false, .restart = false});
    last = std::move(next.posture);
    narrowest = std::min(narrowest, next.conditioning);
  }
  return last;
}

// The laws at one place of the joint ranges.
void look_at(const Mechanism& mechanism, const Posture& home, const ActiveVector& q, std::mt19937_64& random,
             Tally& tally) {
  constexpr double kRegular = 1e-4;
  const SolveOptions general{.closed_form = false};
  const Solution here = solve_forward(mechanism, q, general);
  double narrowest = 0.0;
  const std::optional<Posture> slow = walked(home, q, narrowest);
  if (slow) ++tally.walks;
  EXPECT_TRUE(here || !slow || narrowest < 10.0 * kRegular)
      << "a way is there, but not taken to " << q.transpose() << ", narrowest " << narrowest;
  if (!here || here.conditioning < kRegular) return;
  ++tally.answers;
  if (slow) {
    EXPECT_LT(gap(mechanism, slow->tool(), here.posture->tool()), tolerance_of(here.conditioning))
        << "short steps lead elsewhere";
  }
  SCOPED_TRACE(testing::Message() << "at " << q.transpose() << ", conditioning " << here.conditioning);

  const auto at_home = closure_determinant(home), there = closure_determinant(*here.posture);
  if (at_home && there) {
    EXPECT_GT(*at_home * *there, 0.0) << "past a singularity";
  }

  // From a posture close by, which is itself reached from home, the answer is the same.
  ActiveVector aside = q;
  for (int i = 0; i < aside.size(); ++i) {
    const bool slides =
        mechanism.joints()[static_cast<std::size_t>(mechanism.active_joint(i))].type == JointType::prismatic;
    const double step = 0.1 * here.conditioning * (slides ? mechanism.characteristic_length() : 1.0);
    aside[i] += std::uniform_real_distribution(-step, step)(random);
  }
  const Solution beside = solve_forward(mechanism, aside, general);
  if (!beside) return;  // the way there is barred
  const Solution again =
      solve_forward(mechanism, q, {.start = &*beside.posture, .closed_form = false, .restart = false});
  ASSERT_TRUE(again);
  EXPECT_LT(gap(mechanism, again.posture->tool(), here.posture->tool()), tolerance_of(here.conditioning))
      << "another start, another answer";

  // What reaches a pose, driven to, is there.
  const Solution inverse = solve_inverse(mechanism, here.posture->tool(), general);
  if (!inverse || inverse.conditioning < kRegular || mechanism.serial() != nullptr ||
      inverse.status == SolveStatus::joint_limit)
    return;
  const Solution back = solve_forward(mechanism, inverse.posture->active(), general);
  if (!back) return;
  EXPECT_LT(gap(mechanism, back.posture->tool(), here.posture->tool()), tolerance_of(inverse.conditioning))
      << "the tool does not go where it was sent";
}

void look_around(const Mechanism& mechanism, int postures, std::mt19937_64& random, Tally& tally) {
  ActiveVector active(mechanism.active_count());
  for (int i = 0; i < active.size(); ++i) active[i] = mechanism.home_guess()[mechanism.active_joint(i)];
  const Solution home = solve_forward(mechanism, active, {.closed_form = false});
  ASSERT_TRUE(home);
  for (int k = 0; k < postures; ++k)
    look_at(mechanism, *home.posture, within_ranges(mechanism, random), random, tally);
}

TEST(AssemblyMode, IsKeptByDevices) {
  const Catalogue catalogue = Catalogue::load();
  for (const char* folder : {ZWIDTH_DEVICES, ZWIDTH_EXAMPLE_DEVICES}) {
    std::vector<std::string> files;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
      if (entry.path().extension() == ".toml") files.push_back(entry.path().string());
    }
    std::sort(files.begin(), files.end());
    for (const std::string& file : files) {
      SCOPED_TRACE(file);
      std::mt19937_64 random(74);
      const Mechanism mechanism(read_description(file, {}, catalogue));
      Tally tally;
      look_around(mechanism, cases(200), random, tally);
      EXPECT_GT(tally.answers, 0);
    }
  }
}

class RandomAssemblyMode : public ::testing::TestWithParam<int> {};

TEST_P(RandomAssemblyMode, IsKept) {
  const int kinds = test::random_mechanism_kinds(), count = (cases(210) + kinds - 1) / kinds;
  Tally tally;
  for (int k = 0; k < count; ++k) {
    const int number = GetParam() + k * kinds;
    const auto seed = static_cast<std::uint64_t>(number);
    const test::RandomMechanism made = test::random_mechanism(seed);
    SCOPED_TRACE(testing::Message() << "seed " << seed << ", " << made.kind);
    const Mechanism mechanism(made.description);
    std::mt19937_64 random(seed);
    look_around(mechanism, 20, random, tally);
  }
  EXPECT_GT(tally.answers, 4 * count);
  EXPECT_GE(tally.walks, tally.answers * 9 / 10);
}

INSTANTIATE_TEST_SUITE_P(Kinds, RandomAssemblyMode, ::testing::Range(0, test::random_mechanism_kinds()));

// The three cranks of the plate turned alike: it turns about its middle until the couplers stand along the
// radii, at 130 - 41.4 deg, and on either side of that lies a posture for the same cranks.
TEST(AssemblyMode, OfThePlateOnThreeArmsIsThatBeforeTheFold) {
  const Mechanism plate(read_description(ZWIDTH_EXAMPLE_DEVICES "/three-rrr.toml", {}, Catalogue::load()));
  constexpr double kDegree = 0.017453292519943295;
  double before = 0.0;
  for (double angle = -0.5; angle > -41.4; angle -= 0.25) {
    const Solution solution = solve_forward(plate, Vector3::Constant(angle * kDegree));
    ASSERT_TRUE(solution) << angle;
    const Matrix3& R = solution.posture->tool().rotation;
    const double turn = std::remainder(std::atan2(R(1, 0), R(0, 0)) / kDegree, 360.0);
    // Crank tip at distance r from the middle, plate 40 mm, coupler 90 mm: r^2 + 40^2 - 2 r 40 cos(a) = 90^2,
    // and the angle a between them goes on growing.
    EXPECT_GT(turn, before) << angle;
    EXPECT_LT(turn, 141.0) << angle;
    before = turn;
  }
}

}  // namespace
}  // namespace zwidth
