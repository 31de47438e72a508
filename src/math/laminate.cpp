#include "zwidth/math/laminate.h"

#include <Eigen/LU>
#include <cmath>
#include <numbers>

namespace zwidth {
namespace {

bool positive(double value) {
  return std::isfinite(value) && value > 0.0;
}

// Plies in all; nothing if that is no laminate.
std::optional<double> ply_count(const PlyModuli& ply, std::span<const PlyGroup> plies) {
  double count = 0.0;
  for (const PlyGroup& group : plies) {
    if (!(group.count >= 0.0) || !std::isfinite(group.angle)) return std::nullopt;
    count += group.count;
  }
  if (!ply.valid() || !positive(count)) return std::nullopt;
  return count;
}

// 1/Gxy of eq 5.175 and 5.178: the last term of eq 4.69 at 45 deg is 1/(2 G12), printed as 1/(4 G12).
double printed_shear_at_45(const PlyModuli& ply) {
  const double E1 = ply.longitudinal, E2 = ply.transverse, G12 = ply.shear, nu12 = ply.poisson;
  return 1.0 / (2.0 * (0.5 / E1 + 0.5 / E2 + nu12 / E1 - 0.25 / G12) + 0.25 / G12);
}

bool is_diagonal(double angle) {
  return std::abs(std::abs(std::remainder(angle, std::numbers::pi)) - 0.25 * std::numbers::pi) < 1e-9;
}

}  // namespace

bool PlyModuli::valid() const {
  return positive(longitudinal) && positive(transverse) && positive(shear) &&
         poisson * poisson < longitudinal / transverse;
}

std::optional<PlyModuli> ply_of(const Constituent& fibre, const Constituent& matrix,
                                double fibre_share) noexcept {
  if (!positive(fibre.elastic_modulus) || !positive(fibre.shear_modulus) || !positive(matrix.elastic_modulus) ||
      !positive(matrix.shear_modulus) || !(fibre_share >= 0.0 && fibre_share <= 1.0)) {
    return std::nullopt;
  }
  const double Vf = fibre_share, Vm = 1.0 - fibre_share;
  return PlyModuli{.longitudinal = fibre.elastic_modulus * Vf + matrix.elastic_modulus * Vm,
                   .transverse = 1.0 / (Vf / fibre.elastic_modulus + Vm / matrix.elastic_modulus),
                   .shear = 1.0 / (Vf / fibre.shear_modulus + Vm / matrix.shear_modulus),
                   .poisson = fibre.poisson_ratio * Vf + matrix.poisson_ratio * Vm};
}

WallModuli turned_ply(const PlyModuli& ply, double angle) noexcept {
  const double E1 = ply.longitudinal, E2 = ply.transverse, G12 = ply.shear, nu12 = ply.poisson;
  const double s2 = std::pow(std::sin(angle), 2), c2 = std::pow(std::cos(angle), 2);
  const double mixed = (1.0 / G12 - 2.0 * nu12 / E1) * s2 * c2;
  return {.axial = 1.0 / (c2 * c2 / E1 + mixed + s2 * s2 / E2),
          .transverse = 1.0 / (s2 * s2 / E1 + mixed + c2 * c2 / E2),
          .shear = 1.0 / (2.0 * (2.0 / E1 + 2.0 / E2 + 4.0 * nu12 / E1 - 1.0 / G12) * s2 * c2 +
                          (s2 * s2 + c2 * c2) / G12)};
}

std::optional<WallModuli> mean_moduli(const PlyModuli& ply, std::span<const PlyGroup> plies,
                                      ShearAt45 shear) noexcept {
  const std::optional<double> count = ply_count(ply, plies);
  if (!count) return std::nullopt;
  WallModuli mean;
  for (const PlyGroup& group : plies) {
    const WallModuli one = turned_ply(ply, group.angle);
    const bool misprinted = shear == ShearAt45::printed && is_diagonal(group.angle);
    const double share = group.count / *count;
    mean.axial += share * one.axial;
    mean.transverse += share * one.transverse;
    mean.shear += share * (misprinted ? printed_shear_at_45(ply) : one.shear);
  }
  return mean;
}

std::optional<WallModuli> laminate_moduli(const PlyModuli& ply, std::span<const PlyGroup> plies) noexcept {
  const std::optional<double> count = ply_count(ply, plies);
  if (!count) return std::nullopt;
  const double nu21 = ply.poisson_transverse(), rigid = 1.0 / (1.0 - ply.poisson * nu21);
  const double Q11 = ply.longitudinal * rigid, Q22 = ply.transverse * rigid,
               Q12 = nu21 * ply.longitudinal * rigid, Q66 = ply.shear;
  Matrix3 A = Matrix3::Zero();  // per thickness
  for (const PlyGroup& group : plies) {
    const double s = std::sin(group.angle), c = std::cos(group.angle), s2 = s * s, c2 = c * c;
    const double both = s2 * c2, coupling = Q12 + 2.0 * Q66;
    Matrix3 Q;
    Q(0, 0) = Q11 * c2 * c2 + 2.0 * coupling * both + Q22 * s2 * s2;
    Q(1, 1) = Q11 * s2 * s2 + 2.0 * coupling * both + Q22 * c2 * c2;
    Q(0, 1) = Q(1, 0) = (Q11 + Q22 - 4.0 * Q66) * both + Q12 * (s2 * s2 + c2 * c2);
    Q(2, 2) = (Q11 + Q22 - 2.0 * Q12 - 2.0 * Q66) * both + Q66 * (s2 * s2 + c2 * c2);
    Q(0, 2) = Q(2, 0) = (Q11 - coupling) * s * c * c2 + (coupling - Q22) * s * c * s2;
    Q(1, 2) = Q(2, 1) = (Q11 - coupling) * s * c * s2 + (coupling - Q22) * s * c * c2;
    A += group.count / *count * Q;
  }
  const Matrix3 a = A.inverse();
  return WallModuli{.axial = 1.0 / a(0, 0), .transverse = 1.0 / a(1, 1), .shear = 1.0 / a(2, 2)};
}

}  // namespace zwidth
