#include "zwidth/analysis/stiffness_sheet.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "zwidth/analysis/internal/posture_statistic.h"
#include "zwidth/analysis/mechanical.h"
#include "zwidth/mechanism/dynamics.h"
#include "zwidth/mechanism/stiffness.h"
#include "zwidth/mechanism/vibration.h"

namespace zwidth {

using internal::add;

const char* to_string(Elasticity elasticity) noexcept {
  switch (elasticity) {
    case Elasticity::links:
      return "links";
    case Elasticity::drives:
      return "drives";
    case Elasticity::both:
      return "links and drives";
  }
  return "";
}

std::optional<StiffnessSheet> stiffness_sheet(const Mechanism& mechanism,
                                              const std::vector<std::optional<Drive>>& drives,
                                              std::int64_t samples) {
  const int linear = mechanism.linear_rows();
  if (linear == 0) return std::nullopt;
  StiffnessSheet sheet;
  std::vector<double> beams(mechanism.beams().size(), 0.0), motors(drives.size(), 0.0);
  double total = 0.0;
  const double length = mechanism.characteristic_length();
  for (std::int64_t sample = 0; sample < samples; ++sample) {
    const Solution solution = solve_forward(mechanism, spread_posture(mechanism, sample));
    if (!solution) continue;
    const Posture& posture = *solution.posture;
    const std::optional<KnownStiffness> give = known_stiffness(posture, drives);
    if (!give) return std::nullopt;
    const Compliance compliance = zwidth::compliance(give->stiffness, length);
    const std::optional<ToolMatrix> felt = felt_stiffness(mechanism, compliance);
    if (!felt) continue;
    sheet.of = give->of;
    ++sheet.postures;
    const ActiveVector at = posture.active();
    // Pure forces: what turning the tool may do is left to it.
    ToolMatrix C(linear, linear);
    for (int r = 0; r < linear; ++r) {
      const int row = mechanism.tool_axes()[static_cast<std::size_t>(r)];
      for (int c = 0; c < linear; ++c)
        C(r, c) = compliance.matrix(row, mechanism.tool_axes()[static_cast<std::size_t>(c)]);
      add(sheet.along[static_cast<std::size_t>(row)], 1.0 / C(r, r), at);
      const auto shares =
          compliance_shares(posture, give->stiffness, compliance, Vector6::Unit(row), give->options);
      if (!shares) continue;
      for (std::size_t b = 0; b < beams.size(); ++b) beams[b] += C(r, r) * shares->beams[b];
      for (std::size_t d = 0; d < motors.size(); ++d) motors[d] += C(r, r) * shares->drives[d];
      total += C(r, r);
    }
    const Eigen::SelfAdjointEigenSolver<ToolMatrix> principal(C, Eigen::EigenvaluesOnly);
    add(sheet.softest, 1.0 / principal.eigenvalues()[linear - 1], at);
    add(sheet.stiffest, 1.0 / principal.eigenvalues()[0], at);

    const Rates rate = rates(posture);
    ActiveMatrix links = mass_matrix(posture, rate);
    links.diagonal() -= mechanism.drive_inertia();
    constexpr double kNothing = 1e-9;
    if (!(links.diagonal().minCoeff() > kNothing * links.diagonal().maxCoeff())) continue;
    const ToolMatrix mobility = tool_mobility(rate.tool, links);
    if (const auto held = modes_by_mobility(*felt, mobility)) add(sheet.lowest_held, held->frequencies[0], at);
    if (!(mechanism.drive_inertia().minCoeff() > 0.0)) continue;
    const ActiveMatrix rotors = mechanism.drive_inertia().asDiagonal();
    if (const auto free = modes_by_mobility(*felt, mobility + tool_mobility(rate.tool, rotors)))
      add(sheet.lowest_free, free->frequencies[0], at);
  }
  if (sheet.postures == 0 || !(total > 0.0)) return std::nullopt;
  for (std::size_t b = 0; b < beams.size(); ++b) {
    sheet.shares.push_back(
        {.name = mechanism.joint_names()[static_cast<std::size_t>(mechanism.beams()[b].joint)],
         .share = beams[b] / total});
  }
  for (std::size_t d = 0; d < motors.size(); ++d) {
    if (motors[d] > 0.0)
      sheet.shares.push_back({.drive = true, .name = mechanism.active_names()[d], .share = motors[d] / total});
  }
  std::stable_sort(sheet.shares.begin(), sheet.shares.end(),
                   [](const GiveShare& a, const GiveShare& b) { return a.share > b.share; });
  return sheet;
}

}  // namespace zwidth
