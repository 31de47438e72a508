#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <cmath>
#include <vector>

#include "zwidth/math/spatial.h"

/// A plane-and-space frame of straight bars by the displacement method (Przemieniecki 1968, section 5.6): every
/// bar brings its 12 x 12 stiffness, and hinges are rotations of their own. Written to check the method of
/// virtual joints with, so it shares nothing with it: no compliances, no wrenches, no elimination of joints.

namespace zwidth::oracle {

struct Bar {
  double EA, EIy, EIz, GJ;
};

class Frame {
 public:
  /// A displacement or rotation as a linear function of the freedoms: column i belongs to freedom `of[i]`.
  struct Motion {
    std::vector<int> of;
    std::vector<Vector3> per;
    Motion with(int freedom, const Vector3& direction) const {
      Motion more = *this;
      more.of.push_back(freedom);
      more.per.push_back(direction);
      return more;
    }
  };

  int freedom() { return count_++; }
  Motion three() {
    Motion motion;
    for (int i = 0; i < 3; ++i) motion = motion.with(freedom(), Vector3::Unit(i));
    return motion;
  }
  /// Turned by a hinge of its own against `carrier`.
  Motion hinged(const Motion& carrier, const Vector3& axis) { return carrier.with(freedom(), axis); }

  struct End {
    Vector3 at;
    Motion moves, turns;
  };

  /// `y` is the direction of the section's y axis.
  void add(const End& a, const End& b, const Vector3& y, const Bar& bar) {
    elements_.push_back({a, b, y, bar});
  }

  /// Displacements of all freedoms under the loads on some of them.
  Eigen::VectorXd solve(const Eigen::VectorXd& load) const {
    Eigen::MatrixXd K = Eigen::MatrixXd::Zero(count_, count_);
    for (const Element& element : elements_) assemble(element, K);
    // Metres and radians differ by orders of magnitude: one on the whole diagonal.
    const Eigen::VectorXd scale = K.diagonal().cwiseSqrt().cwiseInverse();
    const Eigen::MatrixXd scaled = scale.asDiagonal() * K * scale.asDiagonal();
    const Eigen::VectorXd right = scale.cwiseProduct(load);
    const Eigen::LDLT<Eigen::MatrixXd> factored(scaled);
    Eigen::VectorXd u = factored.solve(right);
    for (int round = 0; round < 3; ++round) {  // refined with residuals of more digits
      Eigen::Matrix<long double, Eigen::Dynamic, 1> residual =
          right.cast<long double>() - scaled.cast<long double>() * u.cast<long double>();
      u += factored.solve(residual.cast<double>());
    }
    return scale.cwiseProduct(u);
  }
  int freedoms() const { return count_; }

 private:
  struct Element {
    End a, b;
    Vector3 y;
    Bar bar;
  };

  static Eigen::Matrix<double, 12, 12> stiffness(const Bar& s, double L) {
    Eigen::Matrix<double, 12, 12> k = Eigen::Matrix<double, 12, 12>::Zero();
    const auto pair = [&](int i, int j, double value) { k(i, j) = k(j, i) = value; };
    pair(0, 0, s.EA / L);
    pair(6, 6, s.EA / L);
    pair(0, 6, -s.EA / L);
    pair(3, 3, s.GJ / L);
    pair(9, 9, s.GJ / L);
    pair(3, 9, -s.GJ / L);
    // Bending in the x-y plane: v1, rz1, v2, rz2, and with other signs in the x-z plane: w1, ry1, w2, ry2.
    const auto bend = [&](int v1, int r1, int v2, int r2, double EI, double sign) {
      pair(v1, v1, 12.0 * EI / (L * L * L));
      pair(v2, v2, 12.0 * EI / (L * L * L));
      pair(v1, v2, -12.0 * EI / (L * L * L));
      pair(v1, r1, sign * 6.0 * EI / (L * L));
      pair(v1, r2, sign * 6.0 * EI / (L * L));
      pair(v2, r1, -sign * 6.0 * EI / (L * L));
      pair(v2, r2, -sign * 6.0 * EI / (L * L));
      pair(r1, r1, 4.0 * EI / L);
      pair(r2, r2, 4.0 * EI / L);
      pair(r1, r2, 2.0 * EI / L);
    };
    bend(1, 5, 7, 11, s.EIz, 1.0);
    bend(2, 4, 8, 10, s.EIy, -1.0);
    return k;
  }

  static void assemble(const Element& e, Eigen::MatrixXd& K) {
    const Vector3 span = e.b.at - e.a.at;
    const double L = span.norm();
    Matrix3 axes;  // rows
    axes.row(0) = span / L;
    axes.row(1) = (e.y - axes.row(0).transpose() * axes.row(0).dot(e.y)).normalized();
    axes.row(2) = axes.row(0).cross(axes.row(1));
    const Motion* motions[] = {&e.a.moves, &e.a.turns, &e.b.moves, &e.b.turns};
    Eigen::MatrixXd T = Eigen::MatrixXd::Zero(12, K.rows());
    for (int m = 0; m < 4; ++m) {
      for (std::size_t i = 0; i < motions[m]->of.size(); ++i) {
        T.block<3, 1>(3 * m, motions[m]->of[i]) += axes * motions[m]->per[i];
      }
    }
    K += T.transpose() * stiffness(e.bar, L) * T;
  }

  int count_ = 0;
  std::vector<Element> elements_;
};

}  // namespace zwidth::oracle
