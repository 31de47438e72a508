#include "zwidth/analysis/inertia.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cassert>
#include <cmath>

#include "zwidth/analysis/internal/lattice.h"
#include "zwidth/analysis/internal/parallel.h"
#include "zwidth/analysis/internal/probe.h"

namespace zwidth {

double apparent_mass(const ToolMatrix& cartesian_mass, const ToolVector& direction) {
  assert(direction.size() == cartesian_mass.rows());
  const ToolVector u = direction.normalized();
  return 1.0 / u.dot(cartesian_mass.ldlt().solve(u));
}

ApparentMass apparent_mass(const ToolMatrix& cartesian_mass) {
  const auto n = cartesian_mass.rows();
  ApparentMass mass;
  mass.along_axes.resize(n);
  const Eigen::LDLT<ToolMatrix> factors(cartesian_mass);
  for (Eigen::Index k = 0; k < n; ++k) {
    const ToolVector u = ToolVector::Unit(n, k);
    mass.along_axes[k] = 1.0 / u.dot(factors.solve(u));
  }
  // 1/(u^T Lambda^-1 u) is extreme along the eigenvectors, where it is the eigenvalue.
  const Eigen::SelfAdjointEigenSolver<ToolMatrix> eigen(cartesian_mass);
  mass.lightest = eigen.eigenvalues()[0];
  mass.heaviest = eigen.eigenvalues()[n - 1];
  mass.lightest_direction = eigen.eigenvectors().col(0);
  mass.heaviest_direction = eigen.eigenvectors().col(n - 1);
  return mass;
}

InertiaSweep sweep_inertia(const Mechanism& mechanism, double spacing, const Effort& effort) {
  assert(!workspace_obstacle(mechanism) && spacing > 0.0);
  struct Plane {
    std::int64_t inside = 0;
    std::array<internal::StatisticBuilder, 3> along_axes;
    internal::StatisticBuilder lightest, heaviest, gravity_torque;
  };
  const int axes = internal::tool_dimension(mechanism);
  const auto box = internal::lattice_box(mechanism, spacing);
  std::vector<Plane> planes(static_cast<std::size_t>(internal::size(box[0])));
  InertiaSweep sweep;
  sweep.spacing = spacing;
  sweep.complete = internal::for_each_index(planes.size(), effort, [&](std::size_t index) {
    Plane& plane = planes[index];
    internal::Probe probe(mechanism);
    const double x = static_cast<double>(box[0].first + static_cast<std::int64_t>(index)) * spacing;
    for (std::int64_t j = box[1].first; j <= box[1].last; ++j) {
      if (axes == 3) probe.restart();
      for (std::int64_t k = box[2].first; k <= box[2].last; ++k) {
        const Vector3 point(x, static_cast<double>(j) * spacing, static_cast<double>(k) * spacing);
        if (!probe.inverse(point).inside) continue;
        const std::optional<Posture> posture = probe.posture(point);
        if (!posture) continue;
        const Rates rate = rates(*posture);
        const ActiveMatrix M = mass_matrix(*posture, rate);
        const ApparentMass mass = apparent_mass(cartesian_mass(rate.tool.topRows(axes), M));
        ++plane.inside;
        for (int axis = 0; axis < axes; ++axis) plane.along_axes[axis].add(mass.along_axes[axis], point);
        plane.lightest.add(mass.lightest, point);
        plane.heaviest.add(mass.heaviest, point);
        plane.gravity_torque.add(gravity_torques(*posture, rate).cwiseAbs().maxCoeff(), point);
      }
    }
  });
  Plane total;
  for (const Plane& plane : planes) {
    total.inside += plane.inside;
    for (int axis = 0; axis < 3; ++axis) total.along_axes[axis].add(plane.along_axes[axis]);
    total.lightest.add(plane.lightest);
    total.heaviest.add(plane.heaviest);
    total.gravity_torque.add(plane.gravity_torque);
  }
  sweep.inside = total.inside;
  for (int axis = 0; axis < 3; ++axis) sweep.along_axes[axis] = total.along_axes[axis].result();
  sweep.lightest = total.lightest.result();
  sweep.heaviest = total.heaviest.result();
  sweep.gravity_torque = total.gravity_torque.result();
  return sweep;
}

}  // namespace zwidth
