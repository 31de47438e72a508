#include <numbers>
#include <sys/resource.h>
#include <thread>

#include "harness.h"
#include "textbook.h"

#include "zwidth/analysis/workspace.h"
#include "zwidth/mechanism/batch_delta.h"

/// The 1 mm map of the published delta: inverse kinematics, joint limits, Jacobian, condition number and axis
/// force limits at every lattice point, reduced to volume, extremes and means. Beside it the same by the
/// textbook.

namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kSpacing = 1e-3;
constexpr double kTorque = 1.359;

struct Reduced {
  long inside = 0;
  Eigen::Matrix<double, 5, 1> min = Eigen::Matrix<double, 5, 1>::Constant(1e300);
  Eigen::Matrix<double, 5, 1> max = Eigen::Matrix<double, 5, 1>::Constant(-1e300);
  Eigen::Matrix<double, 5, 1> sum = Eigen::Matrix<double, 5, 1>::Zero();
};

void textbook_plane(const bench::Textbook& textbook, long i, const zwidth::LatticeSweep& box,
                    Reduced& reduced) {
  const auto first = [](const zwidth::Interval& side) { return std::lround(side.min / kSpacing); };
  const auto last = [](const zwidth::Interval& side) { return std::lround(side.max / kSpacing); };
  for (long j = first(box.bounds[1]); j <= last(box.bounds[1]); ++j) {
    for (long k = first(box.bounds[2]); k <= last(box.bounds[2]); ++k) {
      const Eigen::Vector3d p(static_cast<double>(i) * kSpacing, static_cast<double>(j) * kSpacing,
                              static_cast<double>(k) * kSpacing);
      Eigen::Vector3d theta;
      if (!textbook.inverse(p, theta)) continue;
      const Eigen::Matrix3d J = textbook.jacobian(theta, p);
      Eigen::Matrix<double, 5, 1> values;
      values << textbook.condition_number(J), std::abs(J.determinant()), textbook.axis_forces(J, kTorque);
      ++reduced.inside;
      reduced.min = reduced.min.cwiseMin(values);
      reduced.max = reduced.max.cwiseMax(values);
      reduced.sum += values;
    }
  }
}

double process_cpu_seconds() {
  timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

}  // namespace

int main(int argc, char** argv) {
  const bool quick = argc > 1 && std::strcmp(argv[1], "--quick") == 0;
  const int rounds = quick ? 2 : 31;
  zwidth::Description description;
  const zwidth::DeltaDescription delta{.base_radius = 0.08,
                                       .upper_arm = 0.08,
                                       .forearm = 0.16,
                                       .platform_radius = 0.055,
                                       .joint_range = {-36.0 * kDegree, 84.0 * kDegree}};
  description.mechanism = delta;
  const zwidth::Mechanism mechanism(description);
  const bench::Textbook textbook(*mechanism.delta(), delta.joint_range);
  const zwidth::LatticeOptions options{.spacing = kSpacing,
                                       .limits = {.torque = zwidth::Vector3::Constant(kTorque)}};
  zwidth::LatticeOptions all = options;
  all.all_figures = true;

  // A map, a few planes of the textbook (a whole sweep takes its time), a map on one thread, and so on.
  std::vector<double> one_wall, two_wall, one_cpu, two_cpu, all_wall, textbook_cpu, ratio;
  zwidth::LatticeSweep sweep = zwidth::sweep_workspace(mechanism, options, {.threads = 2});
  const long first = std::lround(sweep.bounds[0].min / kSpacing),
             last = std::lround(sweep.bounds[0].max / kSpacing);
  const long planes = last - first + 1, stride = quick ? 64 : 16;
  const double points_per_plane = static_cast<double>(sweep.lattice_points) / static_cast<double>(planes);
  long offset = 0;
  for (int round = 0; round < rounds; ++round) {
    double wall = bench::wall_seconds(), cpu = process_cpu_seconds();
    bench::keep(zwidth::sweep_workspace(mechanism, options, {.threads = 2}).inside);
    two_wall.push_back(bench::wall_seconds() - wall);
    two_cpu.push_back(process_cpu_seconds() - cpu);

    wall = bench::wall_seconds(), cpu = process_cpu_seconds();
    bench::keep(zwidth::sweep_workspace(mechanism, options, {.threads = 1}).inside);
    one_wall.push_back(bench::wall_seconds() - wall);
    one_cpu.push_back(process_cpu_seconds() - cpu);

    wall = bench::wall_seconds();
    bench::keep(zwidth::sweep_workspace(mechanism, all, {.threads = 2}).inside);
    all_wall.push_back(bench::wall_seconds() - wall);

    Reduced reduced;
    offset = (offset + 5) % stride;
    long done = 0;
    cpu = bench::cpu_seconds();
    for (long i = first + offset; i <= last; i += stride, ++done) textbook_plane(textbook, i, sweep, reduced);
    bench::keep(reduced);
    textbook_cpu.push_back((bench::cpu_seconds() - cpu) / (static_cast<double>(done) * points_per_plane) *
                           static_cast<double>(sweep.lattice_points));
    ratio.push_back(one_cpu.back() / textbook_cpu.back());
  }

  if (!quick) {
    Reduced reduced;
    for (long i = first; i <= last; ++i) textbook_plane(textbook, i, sweep, reduced);
    double worst = 0.0;
    for (int f = 0; f < 5; ++f) {
      const zwidth::Statistic& ours = sweep.figures[f];
      worst =
          std::max({worst, std::abs(ours.min / reduced.min[f] - 1.0), std::abs(ours.max / reduced.max[f] - 1.0),
                    std::abs(ours.mean * static_cast<double>(reduced.inside) / reduced.sum[f] - 1.0)});
    }
    std::printf("points inside: zwidth %ld, textbook %ld; figures agree to %.1e\n",
                static_cast<long>(sweep.inside), reduced.inside, worst);
  }
  rusage usage;
  getrusage(RUSAGE_SELF, &usage);
  std::printf(
      "1 mm map of the published delta: %ld lattice points in the bounding box, SIMD target %s, %u cores, "
      "largest memory %.0f MB\n%d interleaved rounds; ms per map\n\n",
      static_cast<long>(sweep.lattice_points), zwidth::batch_target_name(), std::thread::hardware_concurrency(),
      static_cast<double>(usage.ru_maxrss) / 1024.0, rounds);
  std::printf("| %-58s | %8s | %8s | %8s |\n|%.60s|%.9s:|%.9s:|%.9s:|\n", "contestant", "median", "p99",
              "worst", "------------------------------------------------------------", "---------", "---------",
              "---------");
  const auto row = [](const char* name, const std::vector<double>& seconds) {
    std::printf("| %-58s | %8.1f | %8.1f | %8.1f |\n", name, bench::quantile(seconds, 0.5) * 1e3,
                bench::quantile(seconds, 0.99) * 1e3, bench::quantile(seconds, 1.0) * 1e3);
  };
  row("zwidth, two threads, wall", two_wall);
  row("zwidth, two threads, CPU of both", two_cpu);
  row("zwidth, one thread, wall", one_wall);
  row("zwidth, one thread, CPU", one_cpu);
  row("zwidth, all 12 figures, two threads, wall", all_wall);
  row("textbook, one thread, CPU (from a share of the planes)", textbook_cpu);
  std::printf("\none thread over textbook: %.4f (median of %d rounds; goal 0.05)\n",
              bench::quantile(ratio, 0.5), rounds);
  return 0;
}
