#include <cmath>

#include "quantities.h"

#include "zwidth/design/pareto.h"
#include "zwidth/design/sensitivity.h"

// Fronts, their measure, and what tolerances do.

namespace zwidth::reference {
namespace {

std::size_t objectives(const Inputs& in) {
  return in.list("F").size() / in.count("F");
}

// Front after front, the rows of each in rising order.
Values fronts(const Inputs& in) {
  Values rows;
  const std::vector<double> violations = in.has("V") ? in.list("V") : std::vector<double>();
  for (const std::vector<std::size_t>& front : pareto_fronts(in.list("F"), objectives(in), violations)) {
    rows.insert(rows.end(), front.begin(), front.end());
  }
  return rows;
}

// The cases write -1 for infinite.
Values crowding(const Inputs& in) {
  Values distances = crowding_distances(in.list("F"), objectives(in));
  for (double& distance : distances) distance = std::isinf(distance) ? -1.0 : distance;
  return distances;
}

// The tip of two links whose lengths and angles err.
Values two_links(const Inputs& in) {
  const std::vector<double> design = {in.number("l1"), in.number("l2"), in.number("q1"), in.number("q2")};
  const BatchEvaluation tip = [](std::span<const double> g, std::span<double> x) {
    for (std::size_t row = 0; row < x.size() / 2; ++row) {
      const double l1 = g[4 * row], l2 = g[4 * row + 1], q1 = g[4 * row + 2], q12 = q1 + g[4 * row + 3];
      x[2 * row] = l1 * std::cos(q1) + l2 * std::cos(q12);
      x[2 * row + 1] = l1 * std::sin(q1) + l2 * std::sin(q12);
    }
    return true;
  };
  const std::vector<double> steps(4, 1e-4);
  const double length = in.number("sl"), angle = in.number("sq");
  const LinearSpread spread = linear_spread(sensitivity(tip, design, steps, 2).slope,
                                            std::vector<double>{length, length, angle, angle});
  return {spread.deviation[0], spread.deviation[1], spread.worst};
}

}  // namespace

void add_design(Quantities& quantities) {
  quantities["pareto.fronts"] = fronts;
  quantities["pareto.crowding"] = crowding;
  quantities["pareto.hypervolume"] = [](const Inputs& in) -> Values {
    return {hypervolume(in.list("F"), in.list("ref"))};
  };
  quantities["pareto.topsis"] = [](const Inputs& in) -> Values {
    return topsis(in.list("F"), objectives(in), in.list("w"));
  };
  quantities["tol.cov_2r"] = two_links;
}

}  // namespace zwidth::reference
