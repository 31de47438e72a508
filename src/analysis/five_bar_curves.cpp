#include "zwidth/analysis/five_bar_curves.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <functional>
#include <numbers>

namespace zwidth {
namespace {

using Complex = std::complex<double>;

constexpr double kTurn = 2.0 * std::numbers::pi;

Vector2 vector(const Complex& z) {
  return {z.real(), z.imag()};
}

// The posture that a parameter of a curve stands for.
struct CurvePosture {
  Complex position;
  Vector2 theta;
};
using Curve = std::function<std::optional<CurvePosture>(double)>;

class Tracer {
 public:
  Tracer(const FiveBarGeometry& geometry, const FiveBarCurveOptions& options)
      : geometry_(geometry), options_(options), n_(std::max(options.points_per_turn, 8)) {}

  // Pieces of the curve over a turn of its parameter on which `curve` answers with an admissible posture.
  void trace(FiveBarCurveKind kind, const Curve& curve) {
    const auto at = [&](int k) { return kTurn * k / n_; };
    std::vector<std::optional<Complex>> samples(static_cast<std::size_t>(n_));
    int gap = -1;
    for (int k = 0; k < n_; ++k) {
      samples[static_cast<std::size_t>(k)] = admissible(curve, kind, at(k));
      if (gap < 0 && !samples[static_cast<std::size_t>(k)]) gap = k;
    }
    if (gap < 0) {
      FiveBarCurve piece{.kind = kind, .closed = true, .points = {}};
      for (const auto& point : samples) piece.points.push_back({point->real(), point->imag()});
      pieces_.push_back(std::move(piece));
      return;
    }
    // Once round from a gap, so that no piece is cut at the seam.
    FiveBarCurve piece{.kind = kind, .closed = false, .points = {}};
    for (int step = 1; step <= n_; ++step) {
      const int k = gap + step;
      const auto& point = samples[static_cast<std::size_t>(k % n_)];
      if (point) {
        if (piece.points.empty()) piece.points.push_back(end(curve, kind, at(k), at(k - 1)));
        piece.points.push_back({point->real(), point->imag()});
      } else if (!piece.points.empty()) {
        piece.points.push_back(end(curve, kind, at(k - 1), at(k)));
        pieces_.push_back(std::move(piece));
        piece = {.kind = kind, .closed = false, .points = {}};
      }
    }
  }

  std::vector<FiveBarCurve> take() { return std::move(pieces_); }

 private:
  std::optional<Complex> admissible(const Curve& curve, FiveBarCurveKind kind, double parameter) const {
    const std::optional<CurvePosture> posture = curve(parameter);
    if (!posture) return std::nullopt;
    if (!options_.mode) return posture->position;
    for (int i = 0; i < 2; ++i) {
      if (!in_range(options_.ranges[static_cast<std::size_t>(i)], posture->theta[i])) return std::nullopt;
    }
    const Vector2 sides =
        FiveBarState(geometry_, posture->theta, vector(posture->position)).inverse_singularity();
    // On a leg's own boundary both of its modes are there.
    const bool left_free = kind == FiveBarCurveKind::left_stretched || kind == FiveBarCurveKind::left_folded;
    const bool right_free = kind == FiveBarCurveKind::right_stretched || kind == FiveBarCurveKind::right_folded;
    const bool left = left_free || sides[0] * options_.mode->left <= 0.0;
    const bool right = right_free || sides[1] * options_.mode->right <= 0.0;
    return left && right ? std::optional(posture->position) : std::nullopt;
  }

  static bool in_range(const Interval& range, double angle) {
    return range.contains(angle, 1e-9) || range.contains(angle + kTurn, 1e-9) ||
           range.contains(angle - kTurn, 1e-9);
  }

  // The last admissible point between a parameter that is and one that is not.
  std::array<double, 2> end(const Curve& curve, FiveBarCurveKind kind, double good, double bad) const {
    Complex point = *admissible(curve, kind, good);
    for (int halving = 0; halving < 48; ++halving) {
      const double middle = 0.5 * (good + bad);
      if (const auto found = admissible(curve, kind, middle)) {
        good = middle;
        point = *found;
      } else {
        bad = middle;
      }
    }
    return {point.real(), point.imag()};
  }

  FiveBarGeometry geometry_;
  FiveBarCurveOptions options_;
  int n_;
  std::vector<FiveBarCurve> pieces_;
};

// A point of the circle of radius r1 about `centre` from which `to` is r2 away, to the left or right of the
// line.
std::optional<Complex> crossing(const Complex& centre, double r1, const Complex& to, double r2, int side) {
  const double d = std::abs(to - centre);
  if (!(d > 0.0)) return std::nullopt;
  const double along = (d * d + (r1 - r2) * (r1 + r2)) / (2.0 * d), across2 = (r1 - along) * (r1 + along);
  if (!(across2 >= 0.0)) return std::nullopt;
  return centre + (to - centre) / d * Complex(along, side * std::sqrt(across2));
}

}  // namespace

const char* to_string(FiveBarCurveKind kind) {
  switch (kind) {
    case FiveBarCurveKind::left_stretched:
      return "left leg stretched";
    case FiveBarCurveKind::left_folded:
      return "left leg folded";
    case FiveBarCurveKind::right_stretched:
      return "right leg stretched";
    case FiveBarCurveKind::right_folded:
      return "right leg folded";
    case FiveBarCurveKind::elbows_coincide:
      return "elbows coincide";
    case FiveBarCurveKind::couplers_aligned:
      break;
  }
  return "couplers aligned";
}

std::vector<FiveBarCurve> singular_curves(const FiveBarGeometry& geometry, const FiveBarCurveOptions& options) {
  if (!can_assemble(geometry)) return {};
  const double r1 = geometry.crank, r2 = geometry.coupler, r3 = geometry.half_base;
  const std::array<Complex, 2> O = {Complex(-r3, 0.0), Complex(r3, 0.0)};
  Tracer tracer(geometry, options);

  // A leg is straight: its crank angle is the parameter; the other leg must reach, by either root.
  constexpr std::array<std::array<FiveBarCurveKind, 2>, 2> kBoundary = {
      {{FiveBarCurveKind::left_stretched, FiveBarCurveKind::left_folded},
       {FiveBarCurveKind::right_stretched, FiveBarCurveKind::right_folded}}};
  for (std::size_t leg = 0; leg < 2; ++leg) {
    for (const int fold : {1, -1}) {
      const double reach = r1 + fold * r2;
      if (reach == 0.0) continue;  // folded equal links: a point, and any crank angle
      // Both roots of the other leg give the same point; with a mode only one is wanted.
      const int other_sign = !options.mode ? 1 : leg == 0 ? options.mode->right : options.mode->left;
      tracer.trace(kBoundary[leg][fold > 0 ? 0 : 1], [=](double angle) -> std::optional<CurvePosture> {
        const Complex C = O[leg] + std::polar(1.0, angle) * reach;
        const auto B = crossing(O[1 - leg], r1, C, r2, other_sign);
        if (!B) return std::nullopt;
        Vector2 theta;
        theta[static_cast<int>(leg)] = angle > std::numbers::pi ? angle - kTurn : angle;
        theta[static_cast<int>(1 - leg)] = std::arg(*B - O[1 - leg]);
        return CurvePosture{C, theta};
      });
    }
  }

  // Elbows coincide where both crank circles meet; the tool goes round them.
  if (r3 <= r1) {
    for (const int side : {1, -1}) {
      const Complex B(0.0, side * std::sqrt((r1 - r3) * (r1 + r3)));
      tracer.trace(FiveBarCurveKind::elbows_coincide, [=](double angle) -> std::optional<CurvePosture> {
        return CurvePosture{B + std::polar(r2, angle), {std::arg(B - O[0]), std::arg(B - O[1])}};
      });
    }
  }

  // Couplers aligned along a direction: B1 on its own circle and, moved by 2 r2 along it, on the other's.
  for (const int side : {1, -1}) {
    tracer.trace(FiveBarCurveKind::couplers_aligned, [=](double angle) -> std::optional<CurvePosture> {
      const Complex along = std::polar(r2, angle);
      const auto B = crossing(O[0], r1, O[1] - 2.0 * along, r1, side);
      if (!B) return std::nullopt;
      return CurvePosture{*B + along, {std::arg(*B - O[0]), std::arg(*B + 2.0 * along - O[1])}};
    });
  }
  return tracer.take();
}

}  // namespace zwidth
