#include "zwidth/math/linear_system.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>
#include <unsupported/Eigen/MatrixFunctions>

namespace zwidth {
namespace {

using std::numbers::pi;

constexpr int kMaxAugmented = kMaxStates + kMaxPorts;
using AugmentedMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxAugmented, kMaxAugmented>;
using AugmentedVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxAugmented, 1>;
using ComplexStateMatrix =
    Eigen::Matrix<std::complex<double>, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxStates, kMaxStates>;
using ComplexStateVector = Eigen::Matrix<std::complex<double>, Eigen::Dynamic, 1, 0, kMaxStates, 1>;

/// Scale d such that diag(d)^-1 A diag(d) has rows and columns of like norm (Parlett & Reinsch 1969). Powers of
/// two, so that scaling rounds nothing. States in metres and metres per second on springs of 1e8 N/m need it.
template <typename Matrix>
AugmentedVector balance(Matrix A) {
  const Eigen::Index n = A.rows();
  AugmentedVector d = AugmentedVector::Ones(n);
  for (bool again = true; again;) {
    again = false;
    for (Eigen::Index i = 0; i < n; ++i) {
      const double self = std::abs(A(i, i));
      const double column = A.col(i).template lpNorm<1>() - self;
      const double row = A.row(i).template lpNorm<1>() - self;
      if (!(column > 0.0) || !(row > 0.0)) {
        continue;
      }
      const int exponent = static_cast<int>(std::lround(0.5 * std::log2(row / column)));
      const double f = std::ldexp(1.0, exponent);
      if (column * f + row / f < 0.95 * (column + row)) {
        A.col(i) *= f;
        A.row(i) /= f;
        d(i) *= f;
        again = true;
      }
    }
  }
  return d;
}

LinearSystem balanced(const LinearSystem& system) {
  assert(system.A.rows() == system.A.cols() && system.B.rows() == system.A.rows());
  assert(system.C.cols() == system.A.cols());
  assert(system.D.rows() == system.C.rows() && system.D.cols() == system.B.cols());
  const AugmentedVector d = balance(system.A);
  LinearSystem scaled = system;
  for (Eigen::Index i = 0; i < d.size(); ++i) {
    scaled.A.col(i) *= d(i);
    scaled.A.row(i) /= d(i);
    scaled.B.row(i) /= d(i);
    scaled.C.col(i) *= d(i);
  }
  return scaled;
}

PoleVector eigenvalues(const StateMatrix& A) {
  StateMatrix scaled = A;
  const AugmentedVector d = balance(A);
  for (Eigen::Index i = 0; i < d.size(); ++i) {
    scaled.col(i) *= d(i);
    scaled.row(i) /= d(i);
  }
  return Eigen::EigenSolver<StateMatrix>(scaled, /*computeEigenvectors=*/false).eigenvalues();
}

/// j w I - A.
ComplexStateMatrix shifted(const StateMatrix& A, double w) {
  ComplexStateMatrix M = -A.cast<std::complex<double>>();
  M.diagonal().array() += std::complex<double>(0.0, w);
  return M;
}

std::complex<double> product(const StateVector& c, const ComplexStateVector& x) {
  return {c.dot(x.real()), c.dot(x.imag())};
}

/// |G|^2 of one input and output, and its derivative by the angular frequency.
class SquaredGain {
 public:
  SquaredGain(const LinearSystem& system, int output, int input)
      : A_(system.A),
        b_(system.B.col(input).cast<std::complex<double>>()),
        c_(system.C.row(output)),
        d_(system.D(output, input)) {}

  double value(double w) const {
    const ComplexStateVector x = Eigen::PartialPivLU<ComplexStateMatrix>(shifted(A_, w)).solve(b_);
    return std::norm(product(c_, x) + d_);
  }

  double derivative(double w) const {
    const Eigen::PartialPivLU<ComplexStateMatrix> M(shifted(A_, w));
    const ComplexStateVector x = M.solve(b_);
    const ComplexStateVector dx = M.solve(x);  // d(M^-1)/dw = -j M^-2
    const std::complex<double> G = product(c_, x) + d_;
    const std::complex<double> dG = std::complex<double>(0.0, -1.0) * product(c_, dx);
    return 2.0 * std::real(std::conj(G) * dG);
  }

 private:
  StateMatrix A_;
  ComplexStateVector b_;
  StateVector c_;
  double d_;
};

/// Where the sign of f changes between a and b, to the last bit: f(a) and f(b) have different signs.
template <typename Function>
double sign_change(const Function& f, double a, double b) {
  const bool rising = f(b) > 0.0;
  for (;;) {
    const double middle = 0.5 * (a + b);
    if (middle <= a || middle >= b) {
      return middle;
    }
    ((f(middle) > 0.0) == rising ? b : a) = middle;
  }
}

/// Finite zeros of one input and output. In z = 1/(s - s0) the system has the feedthrough G(s0), so that its
/// zeros are the eigenvalues of A' - b' c'/G(s0). They only guide a search: where G(s0) vanishes, none are
/// returned.
std::vector<std::complex<double>> zeros(const LinearSystem& system, double s0, int output, int input) {
  const Eigen::Index n = system.A.rows();
  const Eigen::FullPivLU<StateMatrix> M(system.A - s0 * StateMatrix::Identity(n, n));
  const StateMatrix M_inverse = M.inverse();
  const StateVector b = M_inverse * system.B.col(input);
  const StateVector c = M_inverse.transpose() * system.C.row(output).transpose();
  const double G = system.D(output, input) - system.C.row(output).dot(b);
  if (!(std::abs(G) > 0.0) || !std::isfinite(G)) {
    return {};
  }
  const PoleVector z = eigenvalues(M_inverse + b * c.transpose() / G);
  std::vector<std::complex<double>> finite;
  for (Eigen::Index i = 0; i < n; ++i) {
    if (std::abs(z(i)) > 1e-13 * z.cwiseAbs().maxCoeff()) {
      finite.push_back(s0 + 1.0 / z(i));
    }
  }
  return finite;
}

/// Angular frequencies, rising, between which |G| is monotone: a grid that knows every pole and zero, refined
/// by the zeros of the derivative. Covers [first, last]; outside the slowest and fastest landmark nothing
/// happens.
class Landmarks {
 public:
  Landmarks(const LinearSystem& system, int output, int input) : gain_(system, output, input) {
    const PoleVector poles = eigenvalues(system.A);
    std::vector<std::complex<double>> roots(poles.begin(), poles.end());
    double fastest_pole = 0.0;
    double log_sum = 0.0;
    int counted = 0;
    for (const std::complex<double>& pole : poles) {
      fastest_pole = std::max(fastest_pole, std::abs(pole));
      if (std::abs(pole) > 0.0) {
        log_sum += std::log(std::abs(pole));
        ++counted;
      }
    }
    if (counted > 0) {  // seen from the midst of the poles, on the side where there is none
      const auto found = zeros(system, std::exp(log_sum / counted), output, input);
      roots.insert(roots.end(), found.begin(), found.end());
    }
    for (const std::complex<double>& root : roots) {
      const double magnitude = std::abs(root);
      // Rounding leaves roots near zero and near infinity that mean nothing.
      if (magnitude > 1e-10 * fastest_pole && magnitude < 1e10 * fastest_pole) {
        places_.push_back(magnitude);
        if (std::abs(root.imag()) > 1e-10 * fastest_pole) {
          places_.push_back(std::abs(root.imag()));
        }
      }
    }
    std::sort(places_.begin(), places_.end());
  }

  const SquaredGain& gain() const { return gain_; }

  double slowest() const { return places_.empty() ? 1.0 : 1e-3 * places_.front(); }
  double fastest() const { return places_.empty() ? 1.0 : 1e2 * places_.back(); }

  /// The frequencies from first to last, both included; 0 < first <= last.
  std::vector<double> between(double first, double last) const {
    constexpr double kPointsPerDecade = 40.0;
    std::vector<double> grid{first};
    const double ratio = std::pow(10.0, 1.0 / kPointsPerDecade);
    for (double w = std::max(first, slowest()); w < std::min(last, fastest()); w *= ratio) {
      grid.push_back(w);
    }
    std::copy(places_.begin(), places_.end(), std::back_inserter(grid));
    grid.push_back(last);
    std::erase_if(grid, [&](double w) { return w < first || w > last; });
    std::sort(grid.begin(), grid.end());
    grid.erase(std::unique(grid.begin(), grid.end()), grid.end());

    std::vector<double> points;
    const auto slope = [&](double w) { return gain_.derivative(w); };
    double slope_before = 0.0;
    for (std::size_t i = 0; i < grid.size(); ++i) {
      const double slope_here = slope(grid[i]);
      if (i > 0 && slope_before * slope_here < 0.0) {
        points.push_back(sign_change(slope, grid[i - 1], grid[i]));
      }
      points.push_back(grid[i]);
      slope_before = slope_here;
    }
    return points;
  }

 private:
  SquaredGain gain_;
  std::vector<double> places_;
};

/// Collects the metrics sample by sample, so that a long response need not be kept.
class StepMeter {
 public:
  void add(double y) {
    reach(first_tenth_, y, 0.1);
    reach(first_time_constant_, y, 0.632);
    reach(first_nine_tenths_, y, 0.9);
    if (!(std::abs(y - 1.0) <= 0.02)) {
      settled_from_ = count_ + 1;
    }
    largest_ = std::max(largest_, y);
    last_ = y;
    ++count_;
  }

  StepMetrics metrics() const {
    StepMetrics result;
    if (first_tenth_ && first_nine_tenths_) {
      result.rise_samples = *first_nine_tenths_ - *first_tenth_;
    }
    result.time_constant_samples = first_time_constant_;
    if (settled_from_ < count_) {
      result.settling_samples = settled_from_;
    }
    result.overshoot = std::max(0.0, largest_ - 1.0);
    result.steady_state_error = 1.0 - last_;
    return result;
  }

 private:
  void reach(std::optional<int>& first, double y, double level) const {
    if (!first && y >= level) {
      first = count_;
    }
  }

  int count_ = 0;
  int settled_from_ = 0;
  std::optional<int> first_tenth_;
  std::optional<int> first_time_constant_;
  std::optional<int> first_nine_tenths_;
  double largest_ = 0.0;
  double last_ = 0.0;
};

void require_target(double target) {
  if (!std::isfinite(target) || target == 0.0) {
    throw std::invalid_argument("step_metrics: the target must be finite and not zero");
  }
}

}  // namespace

PortVector DiscreteSystem::output(const StateVector& x, const PortVector& u) const noexcept {
  PortVector y = C.lazyProduct(x);
  y += D.lazyProduct(u);
  return y;
}

StateVector DiscreteSystem::next(const StateVector& x, const PortVector& u) const noexcept {
  StateVector result = A.lazyProduct(x);
  result += B.lazyProduct(u);
  return result;
}

PoleVector DiscreteSystem::poles() const {
  PoleVector result = eigenvalues(A);
  std::sort(result.begin(), result.end(),
            [](const auto& a, const auto& b) { return std::abs(a) > std::abs(b); });
  return result;
}

LinearSystem LinearSystem::from_transfer_function(std::span<const double> numerator,
                                                  std::span<const double> denominator) {
  if (denominator.empty() || denominator[0] == 0.0 || !std::isfinite(denominator[0])) {
    throw std::invalid_argument(
        "from_transfer_function: the denominator must start with a finite number other than 0");
  }
  const int n = static_cast<int>(denominator.size()) - 1;
  if (n > kMaxStates || numerator.size() > denominator.size() || numerator.empty()) {
    throw std::invalid_argument("from_transfer_function: the degrees must obey numerator <= denominator <= " +
                                std::to_string(kMaxStates));
  }
  // Coefficient of s^k.
  const auto a = [&](int k) { return denominator[n - k] / denominator[0]; };
  const auto b = [&](int k) {
    const int degree = static_cast<int>(numerator.size()) - 1;
    return k > degree ? 0.0 : numerator[degree - k] / denominator[0];
  };
  LinearSystem system;
  system.A = StateMatrix::Zero(n, n);
  system.B = InputMatrix::Zero(n, 1);
  system.C = OutputMatrix::Zero(1, n);
  system.D = FeedthroughMatrix::Constant(1, 1, b(n));
  for (int i = 0; i < n; ++i) {
    if (i + 1 < n) {
      system.A(i, i + 1) = 1.0;
    }
    system.A(n - 1, i) = -a(i);
    system.C(0, i) = b(i) - b(n) * a(i);
  }
  if (n > 0) {
    system.B(n - 1, 0) = 1.0;
  }
  return system;
}

PoleVector LinearSystem::poles() const {
  PoleVector result = eigenvalues(A);
  std::sort(result.begin(), result.end(), [](const auto& a, const auto& b) { return a.real() > b.real(); });
  return result;
}

bool LinearSystem::is_stable() const {
  const PoleVector all = eigenvalues(A);
  return std::all_of(all.begin(), all.end(),
                     [](const std::complex<double>& pole) { return pole.real() < 0.0; });
}

std::optional<FeedthroughMatrix> LinearSystem::dc_gain() const {
  const LinearSystem scaled = balanced(*this);
  if (states() == 0) {
    return D;
  }
  const Eigen::FullPivLU<StateMatrix> lu(scaled.A);
  if (!lu.isInvertible()) {
    return std::nullopt;
  }
  const InputMatrix x = lu.solve(scaled.B);
  return FeedthroughMatrix(scaled.D - scaled.C * x);
}

PortGains LinearSystem::frequency_response(double angular_frequency) const {
  const LinearSystem scaled = balanced(*this);
  const Eigen::PartialPivLU<ComplexStateMatrix> M(shifted(scaled.A, angular_frequency));
  PortGains gains(C.rows(), B.cols());
  for (int input = 0; input < B.cols(); ++input) {
    const ComplexStateVector b = scaled.B.col(input).cast<std::complex<double>>();
    const ComplexStateVector x = M.solve(b);
    for (int output = 0; output < C.rows(); ++output) {
      gains(output, input) = D(output, input) + product(scaled.C.row(output), x);
    }
  }
  return gains;
}

DiscreteSystem LinearSystem::zero_order_hold(double period) const {
  if (!(period > 0.0) || !std::isfinite(period)) {
    throw std::invalid_argument("zero_order_hold: the period must be positive and finite, not " +
                                std::to_string(period));
  }
  const Eigen::Index n = A.rows();
  const Eigen::Index m = B.cols();
  AugmentedMatrix M = AugmentedMatrix::Zero(n + m, n + m);
  M.topLeftCorner(n, n) = A * period;
  M.topRightCorner(n, m) = B * period;
  const AugmentedVector d = balance(AugmentedMatrix(M.topLeftCorner(n, n)));
  for (Eigen::Index i = 0; i < n; ++i) {
    M.col(i) *= d(i);
    M.row(i) /= d(i);
  }
  // The exponential is linear in the inputs' columns: their scale is free, and must not spoil the matrix's
  // norm.
  AugmentedVector input_scale = AugmentedVector::Ones(m);
  for (Eigen::Index j = 0; j < m; ++j) {
    const double size = M.col(n + j).lpNorm<Eigen::Infinity>();
    if (size > 0.0 && std::isfinite(size)) {
      input_scale(j) = std::ldexp(1.0, -std::ilogb(size));
      M.col(n + j) *= input_scale(j);
    }
  }
  const AugmentedMatrix E = M.exp();
  DiscreteSystem discrete{E.topLeftCorner(n, n), E.topRightCorner(n, m), C, D, period};
  for (Eigen::Index i = 0; i < n; ++i) {
    discrete.A.col(i) /= d(i);
    discrete.A.row(i) *= d(i);
    discrete.B.row(i) *= d(i);
  }
  for (Eigen::Index j = 0; j < m; ++j) {
    discrete.B.col(j) /= input_scale(j);
  }
  return discrete;
}

GainPeak LinearSystem::peak_gain(double max_frequency, int output, int input) const {
  const Landmarks landmarks(balanced(*this), output, input);
  const double limit = 2.0 * pi * std::max(0.0, max_frequency);
  const std::optional<FeedthroughMatrix> dc = dc_gain();
  GainPeak peak;
  double start = std::min(landmarks.slowest(), limit);
  if (dc) {
    peak.gain = std::abs((*dc)(output, input));
  } else {
    peak.gain = std::sqrt(landmarks.gain().value(start));
    peak.frequency = start / (2.0 * pi);
  }
  if (limit <= 0.0) {
    return peak;
  }
  constexpr double kNoise = 1e-12;  // of a gain, far above rounding: ripples below it are no resonance
  const std::vector<double> points = landmarks.between(start, limit);
  for (double w : points) {
    const double gain = std::sqrt(landmarks.gain().value(w));
    if (gain > peak.gain * (1.0 + kNoise)) {
      peak = {w / (2.0 * pi), gain, w < limit};
    }
  }
  return peak;
}

std::optional<double> LinearSystem::first_fall_below(double level, double start, int output, int input) const {
  const Landmarks landmarks(balanced(*this), output, input);
  const double target = level * level;
  const auto excess = [&](double w) { return landmarks.gain().value(w) - target; };
  double first = std::max(2.0 * pi * start, 1e-3 * landmarks.slowest());
  if (excess(first) < 0.0) {
    return std::max(0.0, start);
  }
  // Past the last landmark |G| falls as a power of the frequency or not at all.
  double last = std::max(landmarks.fastest(), 10.0 * first);
  for (int extension = 0; extension < 12; ++extension) {
    const std::vector<double> points = landmarks.between(first, last);
    for (std::size_t i = 1; i < points.size(); ++i) {
      if (excess(points[i]) < 0.0) {
        return sign_change(excess, points[i - 1], points[i]) / (2.0 * pi);
      }
    }
    first = last;
    last *= 10.0;
  }
  return std::nullopt;
}

StepMetrics step_metrics(std::span<const double> samples, double target) {
  require_target(target);
  StepMeter meter;
  for (double y : samples) {
    meter.add(y / target);
  }
  return meter.metrics();
}

std::optional<StepMetrics> step_metrics(const DiscreteSystem& system, double target, int output, int input) {
  require_target(target);
  const PoleVector poles = system.poles();
  const double slowest = poles.size() == 0 ? 0.0 : std::abs(poles(0));
  if (!(slowest < 1.0)) {
    return std::nullopt;
  }
  constexpr double kRest = 1e-18;  // of a transient, below the rounding of the response itself
  const double samples =
      slowest > 0.0 ? std::log(kRest) / std::log(slowest) + 2.0 * kMaxStates : 2.0 * kMaxStates;
  if (!(samples <= kMaxStepSamples)) {
    return std::nullopt;
  }
  StepMeter meter;
  StateVector x = StateVector::Zero(system.A.rows());
  PortVector u = PortVector::Zero(system.B.cols());
  u(input) = 1.0;
  for (int k = 0; k < static_cast<int>(samples) + 1; ++k) {
    meter.add(system.output(x, u)(output) / target);
    x = system.next(x, u);
  }
  return meter.metrics();
}

std::vector<double> step_response(const DiscreteSystem& system, int count, double height, int output,
                                  int input) {
  std::vector<double> samples;
  samples.reserve(static_cast<std::size_t>(std::max(0, count)));
  StateVector x = StateVector::Zero(system.A.rows());
  PortVector u = PortVector::Zero(system.B.cols());
  u(input) = height;
  for (int k = 0; k < count; ++k) {
    samples.push_back(system.output(x, u)(output));
    x = system.next(x, u);
  }
  return samples;
}

double decibel(double ratio) {
  return 20.0 * std::log10(ratio);
}

double ratio_of_decibel(double decibels) {
  return std::pow(10.0, decibels / 20.0);
}

}  // namespace zwidth
