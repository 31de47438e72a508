#include "zwidth/analysis/sizing.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <random>

#include "support/deltas.h"
#include "support/drives.h"
#include "support/positioning_stage.h"

#include "zwidth/analysis/statics.h"
#include "zwidth/mechanism/dynamics.h"

namespace zwidth {
namespace {

using test::kDegreeOfArc;

SizingPosture posture(const Mechanism& arm, const char* name, std::initializer_list<double> degrees) {
  ActiveVector joints(static_cast<Eigen::Index>(degrees.size()));
  Eigen::Index i = 0;
  for (const double value : degrees) joints[i++] = value * kDegreeOfArc;
  return {name, *solve_forward(arm, joints).posture};
}

// The 18 cases of Baser 2006, section 5.1.
std::vector<SizingPosture> critical_positions(const Mechanism& arm) {
  return {posture(arm, "1", {0, 90, 60, 45, 90, 90, 90}), posture(arm, "2", {0, 90, 60, 90, 90, 90, 90}),
          posture(arm, "3", {0, 60, 0, 45, 90, 90, 90})};
}

std::vector<LoadDescription> published_loads() {
  std::vector<LoadDescription> loads;
  for (const bool peak : {true, false}) {
    for (int axis = 0; axis < 3; ++axis) {
      LoadDescription load;
      load.name = std::string(peak ? "peak " : "continuous ") + static_cast<char>('x' + axis);
      load.force = (peak ? 10.0 : 1.5) * Vector3::Unit(axis);
      load.moment.setConstant(peak ? 0.5 : 0.18);
      load.moment_frame = MomentFrame::published;
      load.kind = peak ? LoadKind::peak : LoadKind::continuous;
      loads.push_back(load);
    }
  }
  return loads;
}

Capability symmetric(const ActiveVector& continuous, const ActiveVector& peak) {
  return [=](const Posture&, LoadKind kind) {
    return TorqueRange::symmetric(kind == LoadKind::peak ? peak : continuous);
  };
}

TEST(Sizing, WorstTorquesOfTheSource) {  // Baser 2006, section 5.1; maxima over all 18 cases
  const Mechanism arm(test::arm_description());
  ActiveVector continuous(7), peak(7);
  // Motor torques times the ratios 10, 8, 5, 8, and a wrist that is of no interest here.
  continuous << 1.86, 8 * 0.0849, 5 * 0.0849, 8 * 0.0608, 1.0, 1.0, 1.0;
  peak << 21.9, 8 * 0.640, 5 * 0.640, 8 * 0.447, 1.0, 1.0, 1.0;
  const Sizing sizing = size_drives(critical_positions(arm), published_loads(), symmetric(continuous, peak));
  EXPECT_EQ(sizing.cases.size(), 18u);
  const double peaks[] = {5.080, 4.226, 2.665, 2.364}, continuous_torques[] = {0.886, 0.560, 0.546, 0.530};
  const bool met[] = {true, true, false, false};
  for (std::size_t j = 0; j < 4; ++j) {
    EXPECT_NEAR(std::abs(sizing.peak[j].torque), peaks[j], 5.1e-4) << j;
    EXPECT_NEAR(std::abs(sizing.continuous[j].torque), continuous_torques[j], 5.1e-4) << j;
    EXPECT_TRUE(sizing.peak[j].ok) << j;
    EXPECT_EQ(sizing.continuous[j].ok, met[j]) << j;
  }
  EXPECT_FALSE(sizing.ok);
  EXPECT_EQ(sizing.peak[0].posture, 2);
  EXPECT_EQ(sizing.peak[0].load, 1);
  EXPECT_EQ(sizing.continuous[0].posture, 0);  // the source takes the smaller 0.867 of position 3
}

TEST(Sizing, NoCaseIsWorseThanTheWorst) {
  std::mt19937_64 random(91);
  const Mechanism arm(test::balanced_arm({}));
  std::vector<SizingPosture> postures;
  for (int n = 0; n < 10; ++n) {
    ActiveVector q(7);
    for (double& x : q) x = test::uniform(random, -3, 3);
    postures.push_back({"", *solve_forward(arm, q).posture});
  }
  const std::vector<LoadDescription> loads = published_loads();
  // A range that is not symmetric, and shrinks from posture to posture.
  const Capability capability = [](const Posture& at, LoadKind kind) {
    const double most = (kind == LoadKind::peak ? 4.0 : 1.0) * (1.2 + std::cos(at.active()[1]));
    return TorqueRange{ActiveVector::Constant(7, -0.5 * most), ActiveVector::Constant(7, most)};
  };
  for (const bool gravity : {true, false}) {
    const Sizing sizing = size_drives(postures, loads, capability, {.gravity = gravity});
    std::vector<double> worst_continuous(7, 0.0), worst_peak(7, 0.0);
    for (const SizingCase& one : sizing.cases) {
      const Posture& at = postures[static_cast<std::size_t>(one.posture)].posture;
      const LoadDescription& load = loads[static_cast<std::size_t>(one.load)];
      ActiveVector torque = load_torques(at, load);
      if (gravity) torque += gravity_torques(at);
      EXPECT_LT((torque - one.torque).norm(), 1e-12);
      const TorqueRange range = capability(at, load.kind);
      auto& worst = load.kind == LoadKind::peak ? worst_peak : worst_continuous;
      for (int j = 0; j < 7; ++j) {
        const double used = torque[j] > 0.0 ? torque[j] / range.max[j] : torque[j] / range.min[j];
        worst[static_cast<std::size_t>(j)] = std::max(worst[static_cast<std::size_t>(j)], used);
      }
    }
    for (std::size_t j = 0; j < 7; ++j) {
      EXPECT_NEAR(sizing.continuous[j].utilisation, worst_continuous[j], 1e-12);
      EXPECT_NEAR(sizing.peak[j].utilisation, worst_peak[j], 1e-12);
    }
  }
}

TEST(Sizing, TheHandBearsTheWeightOfAFreeJointButNoLoad) {
  Description description = test::balanced_arm({});
  auto& joints = std::get<SerialDescription>(description.mechanism).joints;
  joints[6].free = true;
  BodyDescription pen;
  pen.on = "platform";
  pen.mass = 0.1;
  pen.centre = {0.1, 0.0, 0.0};
  description.bodies.push_back(pen);
  const Mechanism arm(description);
  const std::vector<SizingPosture> postures = {posture(arm, "", {0, 60, 20, 45, 30, 80, 20})};
  LoadDescription push;
  push.force = {1.0, 0.0, 0.0};
  ActiveVector limit = ActiveVector::Constant(7, 10.0);
  limit[6] = 0.0;
  EXPECT_GT(std::abs(gravity_torques(postures[0].posture)[6]), 1e-3);
  const Sizing pushed = size_drives(postures, std::vector{push}, symmetric(limit, limit));
  EXPECT_TRUE(pushed.ok);
  EXPECT_EQ(pushed.continuous[6].torque, 0.0);
  LoadDescription turn;
  turn.moment = {0.1, 0.2, 0.3};
  const Sizing turned = size_drives(postures, std::vector{turn}, symmetric(limit, limit));
  EXPECT_FALSE(turned.continuous[6].ok);
  EXPECT_TRUE(std::isinf(turned.continuous[6].utilisation));
}

TEST(LoadMargins, AreMetExactlyByWhatTheDriveGives) {
  DriveDescription geared = test::published_drive();
  GearheadDescription gear;
  gear.gearhead.reduction_numerator = 27.0;
  gear.gearhead.reduction_denominator = 5.0;
  gear.gearhead.continuous_torque = 0.2;
  gear.gearhead.intermittent_torque = 0.3;
  gear.gearhead.max_efficiency = 0.9;
  geared.transmission = gear;
  geared.preloader.reset();
  for (const DriveDescription& description : {test::published_drive(), geared}) {
    const Drive drive(description, test::published_drive_range());
    for (const LoadKind kind : {LoadKind::continuous, LoadKind::peak}) {
      const double usable = (kind == LoadKind::peak ? drive.peak_torque() : drive.continuous_torque()).usable;
      double most = 0.0;
      for (const Margin& margin : load_margins(drive, usable, kind)) {
        EXPECT_TRUE(margin.ok) << margin.name;
        most = std::max(most, *margin.utilisation);
      }
      EXPECT_NEAR(most, 1.0, 1e-9);
      bool broken = false;
      for (const Margin& margin : load_margins(drive, -1.01 * usable, kind)) broken = broken || !margin.ok;
      EXPECT_TRUE(broken);
    }
  }
}

class Candidates : public ::testing::Test {
 protected:
  Candidates() : catalogue_(Catalogue::load()) {
    DriveDescription description = test::published_drive();
    description.preloader.reset();
    description.output.reset();
    description.motor = *catalogue_.find<Motor>("maxon-re-16-4w5-12v");
    description.supply_voltage = 12.0;
    description.encoder.max_frequency = kNotGiven;
    description.peak_factor = 5.6;
    GearheadDescription gear;
    gear.gearhead = *catalogue_.find<Gearhead>("maxon-gp-16-a-19");
    description.transmission = gear;
    description_ = description;
  }

  Catalogue catalogue_;
  DriveDescription description_;
};

TEST_F(Candidates, FitExactlyIfTheDriveWithThemGivesWhatIsAsked) {
  const Drive drive(description_, {-3.0, 3.0});
  const DriveDemand demand{0.10, 0.20};
  int fitting = 0;
  for (const DriveCandidate& one : drive_candidates(drive, catalogue_, demand)) {
    EXPECT_EQ(one.fits, one.reason.empty()) << one.name;
    if (one.fits) {
      ++fitting;
      EXPECT_GE(one.continuous * (1.0 + 1e-9), demand.continuous) << one.name;
      EXPECT_GE(one.peak * (1.0 + 1e-9), demand.peak) << one.name;
    }
    if (one.used) {
      EXPECT_NEAR(one.continuous, drive.continuous_torque().usable, 1e-15);
    }
  }
  EXPECT_GT(fitting, 0);
}

TEST_F(Candidates, ComeRankedKindByKind) {
  const Drive drive(description_, {-3.0, 3.0});
  const std::vector<DriveCandidate> list = drive_candidates(drive, catalogue_, {0.05, 0.15});
  std::vector<std::string> kinds;
  for (std::size_t i = 0; i < list.size(); ++i) {
    if (kinds.empty() || kinds.back() != list[i].kind) kinds.push_back(list[i].kind);
    if (i == 0 || list[i - 1].kind != list[i].kind) continue;
    EXPECT_GE(list[i - 1].fits, list[i].fits);
    if (list[i - 1].fits && list[i].fits) {
      EXPECT_LE(list[i - 1].reflected_inertia, list[i].reflected_inertia);
    }
    if (!list[i - 1].fits && !list[i].fits) {
      EXPECT_LE(list[i - 1].utilisation, list[i].utilisation);
    }
  }
  EXPECT_EQ(kinds, (std::vector<std::string>{"motor", "gearhead", "motor and gearhead", "amplifier"}));
}

TEST_F(Candidates, TheGearheadOfTheSourceHoldsItsHalfNewtonMetreBack) {
  const Drive drive(description_, {-3.0, 3.0});
  const auto list = drive_candidates(drive, catalogue_, {0.0, 0.5});
  const auto used = std::find_if(list.begin(), list.end(), [](const auto& one) { return one.used; });
  ASSERT_NE(used, list.end());
  EXPECT_FALSE(used->fits);
  EXPECT_EQ(used->reason, "gearhead torque, short");
  EXPECT_NEAR(used->utilisation, 0.5 / 0.225, 1e-12);
}

TEST_F(Candidates, LeastRatioJustSuffices) {
  DriveDescription description = description_;
  RatioDescription ratio;
  ratio.ratio = 6.0;
  ratio.efficiency = 0.9;
  description.transmission = ratio;
  const DriveDemand demand{0.07, 0.2};
  const double least = *least_ratio(Drive(description, {-3.0, 3.0}), demand);
  std::get<RatioDescription>(description.transmission).ratio = least;
  const Drive drive(description, {-3.0, 3.0});
  const double continuous = drive.continuous_torque().usable / demand.continuous,
               peak = drive.peak_torque().usable / demand.peak;
  EXPECT_NEAR(std::min(continuous, peak), 1.0, 1e-12);
  description.transmission = DirectDriveDescription{};
  EXPECT_FALSE(least_ratio(Drive(description, {-3.0, 3.0}), demand));
}

}  // namespace
}  // namespace zwidth
