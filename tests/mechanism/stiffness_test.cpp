#include "zwidth/mechanism/stiffness.h"

#include <Eigen/LU>
#include <array>
#include <gtest/gtest.h>
#include <limits>
#include <numbers>

#include "oracle/frame.h"
#include "support/allocation_counter.h"
#include "support/r_cubes.h"

#include "zwidth/mechanism/families.h"
#include "zwidth/mechanism/jacobian.h"

namespace zwidth {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
const Material kSteel{.elastic_modulus = 200e9, .poisson_ratio = 0.3, .density = 7850.0};
const double kShear = 200e9 / 2.6;

// Görgülü 2018, section 5.2.5: solution 1 with tubes of 10 x 6 mm.
Description tubes(const RCubeGeometry& geometry = test::published_r_cube()) {
  Description device = test::r_cube_device(geometry);
  for (const char* link : {"drive_link", "inner_link", "outer_link"}) {
    device.bodies.push_back({.on = link, .beam = TubeDescription{0.01, 0.006, kSteel}});
  }
  return device;
}

// Links of different sections, one of them with two principal axes.
Description mixed() {
  Description device = test::r_cube_device();
  device.bodies = {
      {.on = "drive_link", .beam = TubeDescription{0.02, 0.015, kSteel}},
      {.on = "inner_link", .beam = BarDescription{.width = 0.008, .height = 0.015, .wall = kSteel}},
      {.on = "outer_link", .beam = TubeDescription{0.012, 0.0, kSteel}}};
  return device;
}

Posture at(const Mechanism& mechanism, double a, double b, double c) {
  ActiveVector theta(3);
  theta << a * kDegree, b * kDegree, c * kDegree;
  const Solution solution = solve_forward(mechanism, theta);
  EXPECT_TRUE(solution) << to_string(solution.status);
  return *solution.posture;
}

// Table 5.2 of the source [deg].
const std::array<std::array<double, 3>, 10> kPostures = {{{30, -30, 30},
                                                          {0, -30, 30},
                                                          {30, -30, -30},
                                                          {0, -30, -30},
                                                          {0, 0, 30},
                                                          {0, 30, 30},
                                                          {0, 0, -30},
                                                          {-30, -30, -30},
                                                          {0, 0, 0},
                                                          {30, 30, 30}}};
// Table 5.1 [N], with its seventh case as it was meant.
const std::array<Vector3, 8> kForces = {Vector3(5, 5, 5),   Vector3(5, 5, -5),  Vector3(5, -5, 5),
                                        Vector3(5, -5, -5), Vector3(-5, 5, 5),  Vector3(-5, 5, -5),
                                        Vector3(-5, -5, 5), Vector3(-5, -5, -5)};

// The R-CUBE as a frame with hinge releases, from the places of its joints alone.
Vector6 by_frame(const Posture& posture, const Vector6& load, const std::array<oracle::Bar, 3>& bars) {
  oracle::Frame frame;
  const oracle::Frame::Motion moves = frame.three(), turns = frame.three();  // of the platform
  const oracle::Frame::Motion held;
  for (int leg = 0; leg < 3; ++leg) {
    const int first = 5 * leg;
    const Vector3 A = posture.joint_point(first), B = posture.joint_point(first + 2),
                  C = posture.joint_point(first + 3), P = posture.leg_tip(leg);
    const Vector3 a = posture.joint_axis(first + 2), b = posture.joint_axis(first);
    const oracle::Frame::Motion move_B = frame.three(), turn_B = frame.three(), move_C = frame.three(),
                                turn_C = frame.three();
    // y of a bar's section lies along the axis of the joint that moves it.
    frame.add({A, held, held}, {B, move_B, turn_B}, b, bars[0]);
    frame.add({B, move_B, frame.hinged(frame.hinged(turn_B, b), a)}, {C, move_C, turn_C}, a, bars[1]);
    frame.add({C, move_C, frame.hinged(turn_C, a)}, {P, moves, frame.hinged(turns, a)}, a, bars[2]);
  }
  Eigen::VectorXd loads = Eigen::VectorXd::Zero(frame.freedoms());
  loads.head<6>() = load;
  return frame.solve(loads).head<6>();
}

oracle::Bar bar_of(const Section& s) {
  return {200e9 * s.area, 200e9 * s.second_moment_y, 200e9 * s.second_moment_z, kShear * s.torsion_constant};
}

// As large as displacements of the tool are where it is, rotations as lengths.
double size_of(const Vector6& u) {
  return std::max(u.head<3>().norm(), 0.1 * u.tail<3>().norm());
}

TEST(Stiffness, AFrameWithHingeReleasesAgrees) {
  const Mechanism tube(tubes()), other(mixed());
  const oracle::Bar steel = bar_of(*tube_section(0.01, 0.006));
  const std::array<oracle::Bar, 3> equal = {steel, steel, steel},
                                   different = {bar_of(*tube_section(0.02, 0.015)),
                                                bar_of(*bar_section(0.008, 0.015)),
                                                bar_of(*tube_section(0.012, 0.0))};
  for (const auto& q : kPostures) {
    for (const bool is_mixed : {false, true}) {
      const Mechanism& mechanism = is_mixed ? other : tube;
      const Posture posture = at(mechanism, q[0], q[1], q[2]);
      const Stiffness K = stiffness(posture);
      ASSERT_FALSE(K.rigid);
      const Compliance C = compliance(K, mechanism.characteristic_length());
      ASSERT_FALSE(C.free);
      for (const Vector3& force : kForces) {
        Vector6 load;
        load << force, 0.02 * force.cross(Vector3(1.0, 2.0, -0.5));
        if (!is_mixed) load.tail<3>().setZero();
        const Vector6 expected = by_frame(posture, load, is_mixed ? different : equal), u = C.matrix * load;
        EXPECT_LT(size_of(u - expected), 1e-9 * size_of(expected)) << u.transpose() << "\n"
                                                                   << expected.transpose();
      }
    }
  }
}

TEST(Stiffness, IsTheLeadingBlockOfTheBorderedInverse) {
  // Görgülü 2018, eq 5.122: the augmented matrix of one leg, with the 18 springs' compliance and the Jacobian
  // of the passive joints.
  const Mechanism mechanism(mixed());
  for (const auto& q : kPostures) {
    const Posture posture = at(mechanism, q[0], q[1], q[2]);
    const Stiffness K = stiffness(posture);
    const Vector3 P = posture.tool().position;
    Matrix6 sum = Matrix6::Zero();
    for (int leg = 0; leg < 3; ++leg) {
      Eigen::Matrix<double, 10, 10> bordered = Eigen::Matrix<double, 10, 10>::Zero();
      for (int k = 0; k < 3; ++k) {
        const BeamModel& beam = mechanism.beams()[static_cast<std::size_t>(3 * leg + k)];
        const Matrix3 R = posture.link_rotation(beam.joint) * beam.frame;
        const Vector3 end = posture.joint_point(beam.joint) + beam.length * R.col(0);
        Matrix6 J = Matrix6::Zero();
        J.topLeftCorner<3, 3>() = J.bottomRightCorner<3, 3>() = R;
        J.topRightCorner<3, 3>() = -cross_matrix(P - end) * R;
        bordered.topLeftCorner<6, 6>() += J * beam_compliance(beam.rigidity, beam.length) * J.transpose();
      }
      for (int p = 0; p < 4; ++p) {
        const int j = 5 * leg + 1 + p;
        const Vector3 axis = posture.joint_axis(j);
        bordered.block<3, 1>(0, 6 + p) = axis.cross(P - posture.joint_point(j));
        bordered.block<3, 1>(3, 6 + p) = axis;
      }
      bordered.bottomLeftCorner<4, 6>() = bordered.topRightCorner<6, 4>().transpose();
      // Loads in newtons, displacements in micrometres: entries of one size.
      Eigen::Matrix<double, 10, 1> scale = Eigen::Matrix<double, 10, 1>::Constant(1e3);
      scale.tail<4>().setConstant(1e-3);
      const Eigen::Matrix<double, 10, 10> inverse =
          scale.asDiagonal() *
          Eigen::Matrix<double, 10, 10>(scale.asDiagonal() * bordered * scale.asDiagonal()).inverse() *
          scale.asDiagonal();
      const Matrix6 of_leg = inverse.topLeftCorner<6, 6>();
      EXPECT_EQ(K.legs[leg].wrenches, 2);  // and not 3, as the source says
      EXPECT_LT((K.legs[leg].matrix() - of_leg).cwiseAbs().maxCoeff(), 1e-9 * of_leg.cwiseAbs().maxCoeff());
      sum += of_leg;
    }
    EXPECT_LT((K.matrix - sum).cwiseAbs().maxCoeff(), 1e-9 * sum.cwiseAbs().maxCoeff());
  }
}

TEST(Stiffness, IsSymmetricAndPositiveInEveryPosture) {
  std::mt19937_64 random(5);
  const Mechanism mechanism(tubes());
  for (int i = 0; i < 200; ++i) {
    const Posture posture = at(mechanism, test::uniform(random, -32, 32), test::uniform(random, -32, 32),
                               test::uniform(random, -32, 32));
    const Stiffness K = stiffness(posture);
    EXPECT_EQ(K.matrix, Matrix6(K.matrix.transpose()));
    const Compliance C = compliance(K, mechanism.characteristic_length());
    EXPECT_FALSE(C.free);
    EXPECT_GT(Eigen::LDLT<Matrix6>(C.matrix).vectorD().minCoeff(), 0.0);
    EXPECT_LT((K.matrix * C.matrix - Matrix6::Identity()).cwiseAbs().maxCoeff(), 1e-8);
  }
}

TEST(Stiffness, TheToolFeelsSofterThanTheBlockOfAHeldRotation) {
  // The source's comparison of both at home for the design of table 7.8, 0.66.
  Description device = test::r_cube_device();
  device.bodies = {{.on = "drive_link", .beam = TubeDescription{0.03, 0.0225, kSteel}},
                   {.on = "inner_link", .beam = TubeDescription{0.024, 0.018, kSteel}},
                   {.on = "outer_link", .beam = TubeDescription{0.0144, 0.0108, kSteel}}};
  const Mechanism mechanism(device);
  const Stiffness K = stiffness(at(mechanism, 0, 0, 0));
  const ToolMatrix felt = *felt_stiffness(mechanism, compliance(K, 0.1));
  EXPECT_EQ(felt.rows(), 3);
  EXPECT_LT(felt(0, 0), 0.8 * K.matrix(0, 0));
  const Matrix3 condensed = K.matrix.topLeftCorner<3, 3>() - K.matrix.topRightCorner<3, 3>() *
                                                                 K.matrix.bottomRightCorner<3, 3>().inverse() *
                                                                 K.matrix.bottomLeftCorner<3, 3>();
  EXPECT_LT((Matrix3(felt) - condensed).cwiseAbs().maxCoeff(), 1e-9 * condensed.cwiseAbs().maxCoeff());
}

TEST(Stiffness, SharesOfTheLinksAddUpAndFallWithTheirStiffness) {
  const Mechanism mechanism(mixed());
  const Posture posture = at(mechanism, 10, -20, 25);
  const Vector6 load = (Vector6() << 3.0, -2.0, 5.0, 0.1, 0.0, -0.2).finished();
  StiffnessOptions options;
  options.drive_stiffness = Vector3(900.0, 500.0, 700.0);
  const Stiffness K = stiffness(posture, options);
  const Compliance C = compliance(K, 0.1);
  const ComplianceShares shares = *compliance_shares(posture, K, C, load, options);
  double sum = 0.0;
  for (const double share : shares.beams) sum += share;
  for (const double share : shares.drives) sum += share;
  EXPECT_NEAR(sum, 1.0, 1e-12);
  // A share is how fast the displacement along the load falls as that link alone grows stiffer.
  const double displacement = load.dot(C.matrix * load), step = 1e-4;
  for (std::size_t link = 0; link < 3; ++link) {
    Description stiffer = mixed();
    auto& wall =
        std::visit([](auto& beam) -> WallDescription& { return beam.wall; }, *stiffer.bodies[link].beam);
    std::get<Material>(wall).elastic_modulus *= 1.0 + step;
    const Mechanism other(stiffer);
    const Posture same = at(other, 10, -20, 25);
    const double less = load.dot(compliance(stiffness(same, options), 0.1).matrix * load);
    const double share = shares.beams[link] + shares.beams[3 + link] + shares.beams[6 + link];
    EXPECT_NEAR((1.0 - less / displacement) / step, share, 3e-4);
  }
}

TEST(Stiffness, DrivesGiveAlongTheJacobianAlone) {
  // With links far stiffer than the drives, the tool feels J^-T k J^-1.
  Description device = tubes();
  for (BodyDescription& body : device.bodies) {
    std::get<Material>(std::get<TubeDescription>(*body.beam).wall).elastic_modulus = 200e15;
  }
  const Mechanism mechanism(device);
  const Posture posture = at(mechanism, 20, -10, 5);
  StiffnessOptions options;
  options.drive_stiffness = Vector3(900.0, 500.0, 700.0);
  const ToolMatrix felt = *felt_stiffness(mechanism, compliance(stiffness(posture, options), 0.1));
  const Matrix3 J = jacobian(posture);
  const Matrix3 expected = J.inverse().transpose() * Vector3(900.0, 500.0, 700.0).asDiagonal() * J.inverse();
  EXPECT_LT((Matrix3(felt) - expected).cwiseAbs().maxCoeff(), 1e-3 * expected.maxCoeff());
  // Rigid drives are the limit of stiff ones.
  options.drive_stiffness.setConstant(std::numeric_limits<double>::infinity());
  EXPECT_EQ(stiffness(posture, options).matrix, stiffness(posture).matrix);
}

TEST(Stiffness, WithoutHeldDrivesTheToolIsFree) {
  const Mechanism mechanism(tubes());
  const Posture posture = at(mechanism, 20, -10, 5);
  const Stiffness K = stiffness(posture, {.drives = DriveState::free});
  ASSERT_FALSE(K.rigid);
  const Compliance C = compliance(K, mechanism.characteristic_length());
  EXPECT_TRUE(C.free);
  EXPECT_TRUE(C.matrix.allFinite());
  EXPECT_LT((K.matrix * C.free_direction).norm(), 1e-6 * K.matrix.norm());
  EXPECT_FALSE(felt_stiffness(mechanism, C));
  EXPECT_FALSE(compliance_shares(posture, K, C, Vector6::Unit(0)));
}

TEST(Stiffness, ASerialArmIsTheSumOfItsLinks) {
  // One leg without passive joints: C = sum of J C J^T, with nothing to eliminate.
  SerialDescription arm;
  for (const char* name : {"a", "b", "c"}) {
    arm.joints.push_back({.name = name, .a = 0.1, .alpha = 0.7, .range = {-2.0, 2.0}});
  }
  Description device;
  device.name = "arm";
  device.mechanism = arm;
  for (const char* link : {"arm/a", "arm/b", "arm/c"}) {
    device.bodies.push_back({.on = link, .beam = TubeDescription{0.01, 0.0, kSteel}});
  }
  const Mechanism mechanism(device);
  ActiveVector q(3);
  q << 0.3, -0.8, 1.1;
  const Solution solution = solve_forward(mechanism, q);
  const Posture& posture = *solution.posture;
  const Compliance C = compliance(stiffness(posture), 0.1);
  Matrix6 expected = Matrix6::Zero();
  const Vector3 P = posture.tool().position;
  for (int k = 0; k < 3; ++k) {
    const BeamModel& beam = mechanism.beams()[static_cast<std::size_t>(k)];
    const Matrix3 R = posture.link_rotation(k) * beam.frame;
    Matrix6 J = Matrix6::Zero();
    J.topLeftCorner<3, 3>() = J.bottomRightCorner<3, 3>() = R;
    J.topRightCorner<3, 3>() = -cross_matrix(P - posture.joint_point(k) - beam.length * R.col(0)) * R;
    expected += J * beam_compliance(beam.rigidity, beam.length) * J.transpose();
  }
  EXPECT_LT((C.matrix - expected).cwiseAbs().maxCoeff(), 1e-11 * expected.cwiseAbs().maxCoeff());
}

TEST(Stiffness, RigidWhereNoLinkIsABeam) {
  const Mechanism rigid(test::r_cube_device());
  EXPECT_TRUE(stiffness(at(rigid, 0, 0, 0)).rigid);
  // One leg of rigid links is enough.
  Description device = spelled_out(tubes());
  std::erase_if(device.bodies, [](const BodyDescription& body) { return body.on.starts_with("leg2"); });
  const Mechanism some(device);
  EXPECT_TRUE(stiffness(at(some, 0, 0, 0)).rigid);
}

TEST(Stiffness, AStraightArmHoldsOneWrenchMore) {
  // With sin q3 = 0 two of three parallel joints suffice for what all three did.
  const RCubeGeometry geometry{.drive_link = 0.1, .inner_link = 0.06, .outer_link = 0.04, .base_offset = 0.1};
  const Mechanism mechanism(tubes(geometry));
  const Solution home = solve_forward(mechanism, ActiveVector::Zero(3));
  ASSERT_TRUE(home) << to_string(home.status);
  const Stiffness K = stiffness(*home.posture);
  for (int leg = 0; leg < 3; ++leg) EXPECT_EQ(K.legs[leg].wrenches, 3);
  EXPECT_FALSE(K.rigid);
  EXPECT_FALSE(compliance(K, 0.1).free);
}

Mechanism five_bar() {
  Description device;
  device.name = "five-bar";
  device.mechanism = FiveBarDescription{
      .crank = 0.1, .coupler = 0.1, .half_base = 0.1, .left_range = {0.0, 3.0}, .right_range = {0.0, 3.0}};
  for (const char* link : {"left/theta1", "left/elbow1", "right/theta2", "right/elbow2"}) {
    device.bodies.push_back({.on = link, .beam = TubeDescription{0.01, 0.008, kSteel}});
  }
  return Mechanism(device);
}

TEST(Stiffness, AFiveBarsToolIsDisplacedWithoutTurning) {
  const Mechanism mechanism = five_bar();
  ActiveVector theta(2);
  theta << 1.2, 1.9;
  const Solution solution = solve_forward(mechanism, theta);
  ASSERT_TRUE(solution);
  const Stiffness K = stiffness(*solution.posture);
  EXPECT_EQ(K.rows, 3);
  EXPECT_EQ(K.legs[0].wrenches, 2);  // along the coupler, and out of the plane
  const Compliance C = compliance(K, 0.1);
  EXPECT_FALSE(C.free);
  // Out of the plane both legs bend and twist side by side.
  Section tube = *tube_section(0.01, 0.008);
  double stiff = 0.0;
  const Posture& posture = *solution.posture;
  for (int leg = 0; leg < 2; ++leg) {
    const Vector3 elbow = posture.joint_point(2 * leg + 1), root = posture.joint_point(2 * leg),
                  arm = posture.tool().position - elbow;
    const Vector3 along = (elbow - root).normalized();
    const double b = along.dot(arm),
                 t = (arm - b * along).norm();  // bending and twisting arm of the crank's end
    const double EI = 200e9 * tube.second_moment_y, GJ = kShear * tube.torsion_constant, l = 0.1;
    const double give =
        l * l * l / (3.0 * EI) + l * l * b / EI + l * b * b / EI + l * t * t / GJ + l * l * l / (3.0 * EI);
    stiff += 1.0 / give;
  }
  EXPECT_NEAR(K.matrix(2, 2), stiff, 1e-9 * stiff);
  EXPECT_EQ(felt_stiffness(mechanism, C)->rows(), 2);
}

TEST(Stiffness, CouplersInLineLeaveTheToolFreeAcrossThem) {
  const Mechanism mechanism = five_bar();
  ActiveVector theta(2);
  theta << 0.5 * std::numbers::pi, 0.5 * std::numbers::pi;
  const Solution solution = solve_forward(mechanism, theta);
  ASSERT_TRUE(solution) << to_string(solution.status);
  const Compliance C = compliance(stiffness(*solution.posture), 0.1);
  EXPECT_TRUE(C.free);
  EXPECT_NEAR(std::abs(C.free_direction[1]), 1.0, 1e-6);
  EXPECT_TRUE(C.matrix.allFinite());
  EXPECT_FALSE(felt_stiffness(mechanism, C));
}

TEST(Stiffness, DoesNotAllocate) {
  const Mechanism mechanism(tubes());
  const Posture posture = at(mechanism, 20, -10, 5);
  StiffnessOptions options;
  options.drive_stiffness = Vector3(900.0, 500.0, 700.0);
  const long before = test::allocations();
  const Stiffness K = stiffness(posture, options);
  const Compliance C = compliance(K, 0.1);
  const auto felt = felt_stiffness(mechanism, C);
  const auto shares = compliance_shares(posture, K, C, Vector6::Unit(1), options);
  EXPECT_EQ(test::allocations(), before);
  EXPECT_TRUE(felt && shares);
}

}  // namespace
}  // namespace zwidth
