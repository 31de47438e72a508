#include "zwidth/mechanism/positioning_arm.h"

#include <cmath>
#include <gtest/gtest.h>
#include <random>

#include "support/allocation_counter.h"
#include "support/pneumatics.h"
#include "support/storm.h"

#include "zwidth/mechanism/dynamics.h"
#include "zwidth/mechanism/families.h"
#include "zwidth/mechanism/jacobian.h"
#include "zwidth/mechanism/posture.h"

namespace zwidth {
namespace {

using test::prototype;
using test::Prototype1;
using test::Prototype2;
using test::Prototype3;

const SolveOptions kGeneral{.closed_form = false};

class Storm {
 public:
  double operator()(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  Prototype1 first() {
    return {(*this)(0.05, 0.15), (*this)(0.1, 0.3), (*this)(0.0, 0.05), (*this)(0.0, 0.05), (*this)(0.1, 0.4)};
  }
  Prototype2 second() {
    return {(*this)(0.05, 0.25), (*this)(0.0, 0.2), (*this)(-0.05, 0.05), (*this)(0.0, 0.25),
            (*this)(0.05, 0.2)};
  }
  Prototype3 third() {
    return {(*this)(0.05, 0.2), (*this)(0.0, 0.15), (*this)(0.01, 0.05), (*this)(0.01, 0.06)};
  }
  Description any(int kind) {
    return kind % 3 == 0 ? prototype(first()) : kind % 3 == 1 ? prototype(second()) : prototype(third());
  }
  ActiveVector joints(const Mechanism& mechanism) {
    ActiveVector q(mechanism.active_count());
    for (int j = 0; j < q.size(); ++j) {
      const Interval range = mechanism.active_range(j);
      q[j] = (*this)(range.min, range.max);
    }
    return q;
  }

 private:
  std::mt19937_64 random_{3100};
};

// The thesis' forms as corrected: (3.67)-(3.70), (3.84), (3.85).
TEST(Prototypes, TheFirstIsAsItsSourceHasIt) {
  Storm any;
  for (int n = 0; n < 500; ++n) {
    const Prototype1 l = any.first();
    const Mechanism arm(prototype(l));
    const ActiveVector q = any.joints(arm);
    const Solution solution = solve_forward(arm, q);
    ASSERT_TRUE(solution);
    const double c1 = std::cos(q[1]), s1 = std::sin(q[1]), c2 = std::cos(q[2]), s2 = std::sin(q[2]),
                 c12 = std::cos(q[1] + q[2]), s12 = std::sin(q[1] + q[2]);
    const Vector3 position(l.l1x + l.l2x * c1 + l.l3z * c12 + l.l3x * s12,
                           l.l2x * s1 + l.l3z * s12 - l.l3x * c12, l.l3y + q[0]);
    EXPECT_LT((solution.posture->tool().position - position).norm(), 1e-14);
    Matrix3 R;
    R << s12, 0.0, c12, -c12, 0.0, s12, 0.0, -1.0, 0.0;
    EXPECT_LT((solution.posture->tool().rotation - R).norm(), 1e-14);
    const double a = -l.l3z * s12 + l.l3x * c12, b = l.l3z * c12 + l.l3x * s12;
    Matrix3 J;
    J << 0.0, a - l.l2x * s1, a, 0.0, b + l.l2x * c1, b, 1.0, 0.0, 0.0;
    EXPECT_LT((jacobian(*solution.posture) - J).norm(), 1e-14);
    EXPECT_NEAR(dexterity(J).manipulability, std::abs(l.l2x * (l.l3z * s2 - l.l3x * c2)), 1e-14);
  }
}

// (3.93), (3.94), (3.97).
TEST(Prototypes, TheSecondIsAsItsSourceHasIt) {
  Storm any;
  for (int n = 0; n < 500; ++n) {
    const Prototype2 l = any.second();
    const Mechanism arm(prototype(l));
    const ActiveVector t = any.joints(arm);
    const Solution solution = solve_forward(arm, t);
    ASSERT_TRUE(solution);
    const double c1 = std::cos(t[0]), s1 = std::sin(t[0]), c12 = std::cos(t[0] + t[1]),
                 s12 = std::sin(t[0] + t[1]), c3 = std::cos(t[2]), s3 = std::sin(t[2]), q = l.l2x + l.lex * c3;
    const Vector3 position(l.l1x * c1 + q * c12 + l.l2z * s12, l.l1x * s1 + q * s12 - l.l2z * c12,
                           l.l12y + l.lex * s3);
    EXPECT_LT((solution.posture->tool().position - position).norm(), 1e-14);
    Matrix3 R;
    R << c12 * c3, -c12 * s3, s12, s12 * c3, -s12 * s3, -c12, s3, c3, 0.0;
    EXPECT_LT((solution.posture->tool().rotation - R).norm(), 1e-14);
    const double x2 = -q * s12 + l.l2z * c12, y2 = q * c12 + l.l2z * s12;
    Matrix3 J;
    J << x2 - l.l1x * s1, x2, -l.lex * s3 * c12, y2 + l.l1x * c1, y2, -l.lex * s3 * s12, 0.0, 0.0, l.lex * c3;
    EXPECT_LT((jacobian(*solution.posture) - J).norm(), 1e-14);
    EXPECT_NEAR(dexterity(J).manipulability,
                std::abs(l.l1x * l.lex * c3 * (q * std::sin(t[1]) - l.l2z * std::cos(t[1]))), 1e-14);
  }
}

// (3.100), (3.101), (3.104), (3.107) as corrected.
TEST(Prototypes, TheThirdIsAsItsSourceHasIt) {
  Storm any;
  for (int n = 0; n < 500; ++n) {
    const Prototype3 l = any.third();
    const Mechanism arm(prototype(l));
    const ActiveVector t = any.joints(arm);
    const Solution solution = solve_forward(arm, t);
    ASSERT_TRUE(solution);
    const double c1 = std::cos(t[0]), s1 = std::sin(t[0]), c2 = std::cos(t[1]), s2 = std::sin(t[1]),
                 c12 = std::cos(t[0] + t[1]), s12 = std::sin(t[0] + t[1]), c3 = std::cos(t[2]),
                 s3 = std::sin(t[2]), c4 = std::cos(t[3]), s4 = std::sin(t[3]), c5 = std::cos(t[4]),
                 s5 = std::sin(t[4]);
    const double L = l.l2 + l.l3, u = s3 * c4 * c5 + c3 * s5, v = s3 * c4 * s5 - c3 * c5;
    const Vector3 position(l.l0 * c1 + l.l1 * s12 + L * c12 * c3, l.l0 * s1 - l.l1 * c12 + L * s12 * c3,
                           L * s3);
    EXPECT_LT((solution.posture->tool().position - position).norm(), 1e-14);
    Matrix3 R;
    R << -c12 * u + s12 * s4 * c5, c12 * v - s12 * s4 * s5, c12 * s3 * s4 + s12 * c4,  //
        -s12 * u - c12 * s4 * c5, s12 * v + c12 * s4 * s5, s12 * s3 * s4 - c12 * c4,   //
        c3 * c4 * c5 - s3 * s5, -c3 * c4 * s5 - s3 * c5, -c3 * s4;
    EXPECT_LT((solution.posture->tool().rotation - R).norm(), 1e-14);
    const double x2 = l.l1 * c12 - L * s12 * c3, y2 = l.l1 * s12 + L * c12 * c3;
    Jacobian J = Jacobian::Zero(3, 5);
    J.leftCols(3) << x2 - l.l0 * s1, x2, -L * c12 * s3, y2 + l.l0 * c1, y2, -L * s12 * s3, 0.0, 0.0, L * c3;
    EXPECT_LT((jacobian(*solution.posture) - J).norm(), 1e-14);
    EXPECT_NEAR(dexterity(J).manipulability, std::abs(l.l0 * L * c3 * (L * c3 * s2 - l.l1 * c2)), 1e-14);
  }
}

TEST(PositioningArm, EverySolutionReachesAndOneIsWhereItCameFrom) {
  Storm any;
  for (int n = 0; n < test::storm_size(100000); ++n) {
    static std::optional<Mechanism> arm;
    if (n % 100 == 0) arm.emplace(any.any(n / 100));
    const ActiveVector q = any.joints(*arm);
    const Solution forward = solve_forward(*arm, q);
    ASSERT_TRUE(forward);
    const std::vector<Solution> all = solve_inverse_all(*arm, forward.posture->tool());
    ASSERT_GE(all.size(), 2U) << n;
    double nearest = HUGE_VAL;
    for (const Solution& one : all) {
      EXPECT_LT((one.posture->tool().position - forward.posture->tool().position).norm(), 1e-10);
      double apart = 0.0;
      for (int j = 0; j < 3; ++j) apart += std::abs(std::sin(0.5 * (one.posture->active()[j] - q[j])));
      nearest = std::min(nearest, apart);
    }
    // Near a singularity angles are known to the root of the rounding only.
    EXPECT_LT(nearest, forward.conditioning > 1e-3 ? 1e-9 : 1e-5) << n;
  }
}

TEST(PositioningArm, AgreesWithTheGeneralSolver) {
  Storm any;
  int compared = 0;
  const int count = test::storm_size(100000);
  std::optional<Mechanism> one_of_many;
  for (int n = 0; n < count; ++n) {
    if (n % 50 == 0) one_of_many.emplace(any.any(n / 50));
    const Mechanism& arm = *one_of_many;
    const ActiveVector q = any.joints(arm);
    const Solution closed = solve_forward(arm, q), general = solve_forward(arm, q, kGeneral);
    ASSERT_TRUE(closed && general);
    EXPECT_LT((closed.posture->tool().position - general.posture->tool().position).norm(), 1e-12);
    EXPECT_LT((closed.posture->tool().rotation - general.posture->tool().rotation).norm(), 1e-12);
    EXPECT_LT((jacobian(*closed.posture) - jacobian(*general.posture)).norm(), 1e-12);
    if (closed.conditioning < 1e-2) continue;
    // From a posture nearby both find the same root.
    ActiveVector near = q;
    for (int j = 0; j < 3; ++j) near[j] += any(-0.002, 0.002);
    const Solution start = solve_forward(arm, near);
    SolveOptions follow, follow_generally = kGeneral;
    follow.start = follow_generally.start = &*start.posture;
    const Solution one = solve_inverse(arm, closed.posture->tool(), follow),
                   other = solve_inverse(arm, closed.posture->tool(), follow_generally);
    ASSERT_TRUE(one && other) << n;
    if (one.status == SolveStatus::joint_limit) continue;
    EXPECT_LT((one.posture->active().head(3) - other.posture->active().head(3)).norm(), 1e-8) << n;
    ++compared;
  }
  EXPECT_GT(compared, count / 2);
}

TEST(PositioningArm, OfSeveralSolutionsOneWithinTheRangesIsTaken) {
  Storm any;
  const Mechanism arm(prototype(Prototype1{}, {-1.0, 1.0}));
  for (int n = 0; n < 2000; ++n) {
    ActiveVector q = any.joints(arm);
    q[0] = any(-0.5, 0.5);
    const Solution forward = solve_forward(arm, q);
    const Solution inverse = solve_inverse(arm, forward.posture->tool());
    EXPECT_NE(inverse.status, SolveStatus::joint_limit) << q.transpose();
  }
}

TEST(PositioningArm, SaysWhatCannotBeReached) {
  const Mechanism arm(prototype(Prototype3{}));
  const auto status = [&](double x, double y, double z) {
    return solve_inverse(arm, Pose{Vector3(x, y, z), Matrix3::Identity()}).status;
  };
  EXPECT_EQ(status(0.9, 0.0, 0.0), SolveStatus::unreachable);
  EXPECT_EQ(status(0.2, 0.0, 0.3), SolveStatus::unreachable);
  EXPECT_EQ(status(0.0, 0.001, 0.0), SolveStatus::unreachable);
  // Forearm as long as the upper arm and the tool on the first axis: theta1 turns freely.
  const Mechanism folded(prototype(Prototype3{.l0 = 0.1, .l1 = 0.06, .l2 = 0.03, .l3 = 0.05}));
  EXPECT_EQ(solve_inverse(folded, Pose{}).status, SolveStatus::degenerate);
}

TEST(PositioningArm, KnowsWhatItIsNot) {
  const auto leg = [](const Description& device) {
    return legs_of(std::get<SerialDescription>(device.mechanism)).legs.front();
  };
  EXPECT_TRUE(PositioningArm::of(leg(prototype(Prototype1{}))));
  EXPECT_TRUE(PositioningArm::of(leg(prototype(Prototype3{}))));
  Description device = prototype(Prototype3{});
  auto& rows = std::get<SerialDescription>(device.mechanism).joints;
  rows.back().a = 0.01;  // the wrist moves the tool
  EXPECT_FALSE(PositioningArm::of(leg(device)));
  device = prototype(Prototype2{});
  std::get<SerialDescription>(device.mechanism).joints[1].alpha = 1.5;  // not at right angles
  EXPECT_FALSE(PositioningArm::of(leg(device)));
  device = prototype(Prototype2{});
  std::get<SerialDescription>(device.mechanism).joints[0].alpha = 0.3;  // not parallel
  EXPECT_FALSE(PositioningArm::of(leg(device)));
  device = prototype(Prototype2{});
  std::get<SerialDescription>(device.mechanism).joints[0].a = 0.0;  // no upper arm
  EXPECT_FALSE(PositioningArm::of(leg(device)));
  // Of a tool that is a whole frame a position alone leaves the wrist open.
  device = prototype(Prototype3{});
  auto& arm = std::get<SerialDescription>(device.mechanism);
  arm.platform = PlatformFreedom::rigid;
  EXPECT_FALSE(positioning_closed_form(arm)->covers({.match = Match::position}));
  EXPECT_TRUE(positioning_closed_form(arm)->covers({}));
  arm.platform = PlatformFreedom::translation;
  EXPECT_EQ(positioning_closed_form(arm), nullptr);
}

TEST(PositioningArm, AxesMayRunTheOtherWay) {
  Storm any;
  for (int n = 0; n < 300; ++n) {
    // A half turn about x between the parallel joints turns the second axis round.
    Description device = prototype(any.second());
    std::get<SerialDescription>(device.mechanism).joints[0].alpha = std::numbers::pi;
    const Mechanism arm(device);
    ASSERT_NE(arm.closed_form(), nullptr);
    const ActiveVector q = any.joints(arm);
    const Pose tool = solve_forward(arm, q).posture->tool();
    const Solution inverse = solve_inverse(arm, tool);
    ASSERT_TRUE(inverse);
    EXPECT_LT((inverse.posture->tool().position - tool.position).norm(), 1e-12);
  }
}

TEST(PositioningArm, TheSliderMayComeAnywhere) {
  Storm any;
  for (int place = 0; place < 3; ++place) {
    Prototype1 l;
    Description device = prototype(l);
    auto& rows = std::get<SerialDescription>(device.mechanism).joints;
    // The three rows in another order; all axes stay parallel but for the end's fixed row.
    rows[2].alpha = rows[2].theta = 0.0;
    rows[3].d = 0.0;
    rows[3].a = l.l3z;
    std::rotate(rows.begin(), rows.begin() + place, rows.begin() + 3);
    const Mechanism arm(device);
    ASSERT_NE(arm.closed_form(), nullptr) << place;
    for (int n = 0; n < 100; ++n) {
      const Pose tool = solve_forward(arm, any.joints(arm)).posture->tool();
      for (const Solution& one : solve_inverse_all(arm, tool)) {
        EXPECT_LT((one.posture->tool().position - tool.position).norm(), 1e-12);
      }
    }
  }
}

TEST(PositioningArm, DoesNotAllocate) {
  const Mechanism arm(prototype(Prototype3{}));
  const Pose tool{Vector3(0.2, -0.05, 0.02), Matrix3::Identity()};
  const long before = test::allocations();
  const Solution solution = solve_inverse(arm, tool);
  const Solution forward = solve_forward(arm, solution.posture->active());
  EXPECT_EQ(test::allocations(), before);
  EXPECT_TRUE(forward);
}

// A tool that is a point is a rigid tool whose turning is left out of the rows, nothing else.
TEST(PointPlatform, IsARigidOneWithoutItsTurning) {
  Storm any;
  for (int n = 0; n < 200; ++n) {
    Description point = prototype(any.third());
    point.bodies = {
        {.on = "platform", .mass = 0.3, .centre = {0.01, -0.02, 0.03}, .inertia = Matrix3::Identity() * 1e-4},
        {.on = "arm/theta2", .mass = 0.2, .centre = {0.1, 0.0, 0.0}, .inertia = Matrix3::Identity() * 1e-4}};
    Description rigid = point;
    std::get<SerialDescription>(rigid.mechanism).platform = PlatformFreedom::rigid;
    const Mechanism a(point), b(rigid);
    EXPECT_EQ(a.tool_rows(), 3);
    const ActiveVector q = any.joints(a);
    const Solution one = solve_forward(a, q, kGeneral), other = solve_forward(b, q, kGeneral);
    ASSERT_TRUE(one && other);
    EXPECT_LT((one.posture->tool().position - other.posture->tool().position).norm(), 1e-13);
    EXPECT_LT((one.posture->tool().rotation - other.posture->tool().rotation).norm(), 1e-13);
    EXPECT_LT((jacobian(*one.posture) - jacobian(*other.posture).topRows(3)).norm(), 1e-13);
    EXPECT_LT((mass_matrix(*one.posture) - mass_matrix(*other.posture)).norm(), 1e-13);
    EXPECT_LT((gravity_torques(*one.posture) - gravity_torques(*other.posture)).norm(), 1e-13);
    const ActiveVector rate = any.joints(a), acceleration = any.joints(a);
    EXPECT_LT((inverse_dynamics(*one.posture, rate, acceleration) -
               inverse_dynamics(*other.posture, rate, acceleration))
                  .norm(),
              1e-11);
  }
}

// The arm without its wrist is the arm with the wrist held.
TEST(WithoutFreeJoints, TheDrivesDoTheSameWithTheTool) {
  Storm any;
  for (int n = 0; n < 200; ++n) {
    Description device = prototype(any.third());
    auto& rows = std::get<SerialDescription>(device.mechanism).joints;
    rows[5].home = any(-1.0, 1.0);
    rows[6].home = any(-1.0, 1.0);
    for (const char* link : {"arm/theta3", "arm/theta4", "arm/theta5", "platform"}) {
      const Matrix3 inertia = Vector3(1e-4, 2e-4, 2.5e-4).asDiagonal();
      device.bodies.push_back({.on = link,
                               .mass = 0.2,
                               .centre = {any(-0.1, 0.1), any(-0.1, 0.1), any(-0.1, 0.1)},
                               .inertia = inertia});
    }
    const Mechanism whole(device), held(without_free_joints(device));
    ASSERT_EQ(held.active_count(), 3);
    ActiveVector q = any.joints(whole);
    q[3] = rows[5].home;
    q[4] = rows[6].home;
    const Solution one = solve_forward(whole, q), other = solve_forward(held, q.head(3));
    ASSERT_TRUE(one && other);
    EXPECT_LT((one.posture->tool().position - other.posture->tool().position).norm(), 1e-13);
    EXPECT_LT((one.posture->tool().rotation - other.posture->tool().rotation).norm(), 1e-13);
    EXPECT_LT((mass_matrix(*one.posture).topLeftCorner(3, 3) - mass_matrix(*other.posture)).norm(), 1e-13);
    EXPECT_LT((gravity_torques(*one.posture).head(3) - gravity_torques(*other.posture)).norm(), 1e-12);
  }
}

}  // namespace
}  // namespace zwidth
