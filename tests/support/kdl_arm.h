#pragma once

#include <kdl/chain.hpp>
#include <kdl/chainfksolverpos_recursive.hpp>
#include <kdl/chainjnttojacsolver.hpp>

#include "zwidth/description/description.h"
#include "zwidth/math/spatial.h"
#include "zwidth/mechanism/sizes.h"

namespace zwidth::test {

/// The same rows for KDL, which has the joint in front of the row's constant transform.
class KdlArm {
 public:
  explicit KdlArm(const SerialDescription& arm) {
    for (const SerialJointDescription& row : arm.joints) {
      const KDL::Joint::JointType type = row.type == SerialJointType::fixed       ? KDL::Joint::None
                                         : row.type == SerialJointType::prismatic ? KDL::Joint::TransZ
                                                                                  : KDL::Joint::RotZ;
      chain_.addSegment(KDL::Segment(KDL::Joint(type), KDL::Frame::DH(row.a, row.alpha, row.d, row.theta)));
    }
  }
  void forward(const ActiveVector& q, KDL::Frame& frame, KDL::Jacobian& jacobian) {
    KDL::JntArray joints(chain_.getNrOfJoints());
    for (unsigned j = 0; j < chain_.getNrOfJoints(); ++j) joints(j) = q[j];
    jacobian.resize(chain_.getNrOfJoints());
    KDL::ChainFkSolverPos_recursive(chain_).JntToCart(joints, frame);
    KDL::ChainJntToJacSolver(chain_).JntToJac(joints, jacobian);
  }

  Pose pose(const ActiveVector& q) {
    KDL::JntArray joints(chain_.getNrOfJoints());
    for (unsigned j = 0; j < chain_.getNrOfJoints(); ++j) joints(j) = q[j];
    KDL::Frame frame;
    KDL::ChainFkSolverPos_recursive(chain_).JntToCart(joints, frame);
    Pose pose;
    for (int i = 0; i < 3; ++i) {
      pose.position[i] = frame.p[i];
      for (int k = 0; k < 3; ++k) pose.rotation(i, k) = frame.M(i, k);
    }
    return pose;
  }

 private:
  KDL::Chain chain_;
};

}  // namespace zwidth::test
