#include "sheet_plane.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numbers>

#include "figure/plot.h"
#include "terminal.h"

#include "zwidth/analysis/force.h"
#include "zwidth/mechanism/jacobian.h"

namespace zwidth {

namespace {

constexpr double kWide = 900.0;
constexpr double kWidth = 470.0;
constexpr double kMapWidth = 350.0;  // three beside each other

using Curves = std::vector<std::vector<Point2>>;

// Classes of the condition number, good to bad: they must keep their order in grey, too.
constexpr std::array<std::string_view, 4> kClassColours = {"#2f9e77", "#a8d08d", "#f0b24d", "#c9403a"};

Point2 millimetres(const Vector3& p) {
  return {p.x() * kMilli, p.y() * kMilli};
}

Curves millimetres(const std::vector<Outline>& outlines) {
  Curves curves;
  for (const Outline& outline : outlines) {
    std::vector<Point2> curve;
    for (const auto& point : outline) curve.push_back({point[0] * kMilli, point[1] * kMilli});
    curves.push_back(std::move(curve));
  }
  return curves;
}

/// What a mechanism in a plane looks like: its legs as rows of points, from the base to the tool [mm].
struct Skeleton {
  Curves legs;
  Point2 tool;
};

std::optional<Skeleton> skeleton_of(const Mechanism& mechanism) {
  ActiveVector middle(mechanism.active_count());
  for (int i = 0; i < middle.size(); ++i) middle[i] = mechanism.active_range(i).middle();
  const Solution solution = solve_forward(mechanism, middle);
  if (!solution) return std::nullopt;
  Skeleton skeleton{.tool = millimetres(solution.posture->tool().position)};
  for (size_t l = 0; l < mechanism.legs().size(); ++l) {
    const LegModel& leg = mechanism.legs()[l];
    std::vector<Point2> points;
    for (int j = leg.first; j < leg.first + leg.count; ++j)
      points.push_back(millimetres(solution.posture->joint_point(j)));
    points.push_back(millimetres(solution.posture->leg_tip(static_cast<int>(l))));
    skeleton.legs.push_back(std::move(points));
  }
  return skeleton;
}

class PlaneFigures {
 public:
  PlaneFigures(const DataSheet& sheet, const Description& description)
      : sheet_(sheet), plane_(*sheet.plane), mechanism_(description), skeleton_(skeleton_of(mechanism_)) {
    for (size_t k = 0; k < 2; ++k) {
      const Interval& range = plane_.extents.range[k];
      window_[k] = {range.min * kMilli, range.max * kMilli};
    }
    for (Interval& side : window_) {
      const double extra = 0.04 * std::max(side.width(), 1e-6);
      side = {side.min - extra, side.max + extra};
    }
    boundary_ = millimetres(plane_.map.slice.outlines);
  }

  std::vector<SheetFigure> draw() {
    device();
    if (plane_.map.nu == 0) return std::move(figures_);
    shapes();
    singularities();
    classes();
    conditioning();
    ellipses();
    forces();
    return std::move(figures_);
  }

 private:
  Plot plot(double width) const {
    Plot result(width, width, {"x [mm]", window_[0]}, {"y [mm]", window_[1]});
    result.keep_shape();
    return result;
  }

  void device() {
    if (!skeleton_) return;
    std::array<Interval, 2> window = window_;
    for (const auto& leg : skeleton_->legs) {
      for (const Point2& p : leg) {
        window[0] = {std::min(window[0].min, p.x), std::max(window[0].max, p.x)};
        window[1] = {std::min(window[1].min, p.y), std::max(window[1].max, p.y)};
      }
    }
    const double extra = 0.05 * std::max(window[0].width(), window[1].width());
    for (size_t k = 0; k < 2; ++k) {
      if (window[k] != window_[k]) window[k] = {window[k].min - extra, window[k].max + extra};
    }
    Plot picture(kWide, kWide, {"x [mm]", window[0]}, {"y [mm]", window[1]});
    picture.keep_shape();
    picture.curves(boundary_, 1);
    draw_mechanism(picture, 13.0);
    figures_.push_back({"device", "device", "",
                        "In the middle of its joint ranges, in the area that its tool reaches.",
                        picture.svg("The device in its workspace")});
  }

  void draw_mechanism(Plot& picture, double width) const {
    if (!skeleton_) return;
    for (const auto& leg : skeleton_->legs) {
      for (size_t j = leg.size() - 1; j-- > 0;)
        picture.bar(leg[j], leg[j + 1], j == 0 ? width : 0.8 * width, j == 0 ? "#427ad1" : "#a9b4c4");
    }
    for (const auto& leg : skeleton_->legs) {
      for (size_t j = 1; j + 1 < leg.size(); ++j) picture.disc(leg[j], 0.5 * width, "#5d6878");
      picture.ground(leg.front(), 1.15 * width);
    }
    picture.disc(skeleton_->tool, 0.75 * width, "#f0963c");
  }

  void shapes() {
    Plot picture = plot(kWidth);
    picture.curves(boundary_, 1);
    if (plane_.dexterous.annulus) {
      // A band of circles about the origin: the inner one runs the other way round.
      Curves band;
      for (const double r : {plane_.dexterous.annulus->max, plane_.dexterous.annulus->min}) {
        std::vector<Point2> circle;
        for (int n = 0; n < 180; ++n) {
          const double angle = 2.0 * std::numbers::pi * n / 180.0;
          circle.push_back({r * kMilli * std::cos(angle), r * kMilli * std::sin(angle)});
        }
        band.push_back(std::move(circle));
      }
      picture.curves(band, 3);
    }
    const InscribedShape &circle = plane_.inscribed.circle(), &square = plane_.inscribed.square();
    picture.circle(millimetres(circle.centre), circle.size * kMilli, {});
    picture.rectangle(millimetres(square.centre), square.size * kMilli, {});
    figures_.push_back(
        {"workspace-plane", "workspace", "Workspace",
         plane_.dexterous.annulus
             ? fmt::format(
                   "Dashed: the largest circle and square inside. Green: every full circle about the origin "
                   "has a condition number below {:g}.",
                   plane_.dexterous.limit)
             : "Dashed: the largest circle and square inside.",
         picture.svg("Workspace with the largest circle and square inside")});
  }

  void singularities() {
    if (plane_.singular_curves.empty()) return;
    std::array<Interval, 2> window = window_;
    for (const FiveBarCurve& curve : plane_.singular_curves) {
      for (const auto& point : curve.points) {
        for (size_t k = 0; k < 2; ++k)
          window[k] = {std::min(window[k].min, 1.03 * point[k] * kMilli),
                       std::max(window[k].max, 1.03 * point[k] * kMilli)};
      }
    }
    Plot picture(kWidth, kWidth, {"x [mm]", window[0]}, {"y [mm]", window[1]});
    picture.keep_shape();
    picture.curves(boundary_, 1);
    bool direct = false;
    for (const FiveBarCurve& curve : plane_.singular_curves) {
      const std::vector<Point2> points = millimetres({curve.points}).front();
      // In halves: a line needs two ends to be simplified between.
      const auto half = points.begin() + std::ssize(points) / 2;
      std::vector<Point2> first(points.begin(), half + 1), second(half, points.end());
      if (curve.closed) second.push_back(points.front());
      for (const auto& part : {first, second})
        picture.line(part, is_direct(curve.kind) ? 2 : 4, {}, !is_direct(curve.kind));
      direct = direct || is_direct(curve.kind);
    }
    figures_.push_back(
        {"singularities", "workspace", "Singularities",
         std::string("In this working mode, whatever the joint ranges. Dashed: a leg is stretched or "
                     "folded, and the tool loses a freedom.") +
             (direct ? " Solid: the tool gains a freedom that locked motors do not hold." : ""),
         picture.svg("Singular curves in the plane")});
  }

  void classes() {
    Plot picture = plot(kMapWidth);
    std::vector<std::pair<std::string_view, std::string_view>> key = {{kClassColours[0], "K<5"},
                                                                      {kClassColours[1], "5–10"},
                                                                      {kClassColours[2], "10–100"},
                                                                      {kClassColours[3], ">100"}};
    picture.swatches(key);
    picture.area(boundary_, kClassColours[3]);
    for (size_t k = plane_.condition_regions.size(); k-- > 0;)
      picture.area(millimetres(plane_.condition_regions[k].outlines), kClassColours[k]);
    picture.edge(boundary_);
    figures_.push_back({"condition-classes", "dexterity", "Condition number K by classes",
                        "Within the bounds of the classes of Singh, Saha and Manivannan.",
                        picture.svg("Classes of the condition number")});
  }

  Field field(Figure which) const {
    const SliceMap& map = plane_.map;
    return {{map.u_range.min * kMilli, map.u_range.max * kMilli},
            {map.v_range.min * kMilli, map.v_range.max * kMilli},
            map.nu,
            map.nv,
            map.values[static_cast<size_t>(which)]};
  }

  void conditioning() {
    Plot picture = plot(kMapWidth);
    Field values = field(Figure::condition_number);
    for (double& value : values.values) value = 1.0 / value;
    picture.map(values, boundary_, "", {0.0, 1.0});
    figures_.push_back({"conditioning", "dexterity", "1/K",
                        "Zero at a singularity, one where the tool moves equally well in all directions.",
                        picture.svg("Reciprocal condition number over the workspace")});
  }

  void ellipses() {
    // Every so many grid points inside, clear of the boundary.
    const SliceMap& map = plane_.map;
    const int step = std::max(3, std::max(map.nu, map.nv) / 9);
    struct Sample {
      Point2 at;
      Ellipsoid velocity, force;
    };
    std::vector<Sample> samples;
    std::vector<double> longest[2];
    const ActiveVector unit = ActiveVector::Ones(2);
    const double height = skeleton_height();
    for (int iv = step / 2; iv < map.nv; iv += step) {
      for (int iu = step / 2; iu < map.nu; iu += step) {
        const double K =
            map.values[0][static_cast<size_t>(iv) * static_cast<size_t>(map.nu) + static_cast<size_t>(iu)];
        if (!(K < 100.0)) continue;
        const Vector3 p(map.u_range.min + map.u_range.width() * iu / (map.nu - 1),
                        map.v_range.min + map.v_range.width() * iv / (map.nv - 1), height);
        const Solution solution = solve_inverse(mechanism_, {.position = p});
        if (!solution) continue;
        const Jacobian J = jacobian(*solution.posture).topRows(2);
        samples.push_back({millimetres(p), velocity_ellipsoid(J, unit), force_ellipsoid(J, unit)});
        longest[0].push_back(samples.back().velocity.lengths[0]);
        longest[1].push_back(samples.back().force.lengths[0]);
      }
    }
    if (samples.empty()) return;
    // The median reaches most of the way to its neighbour; the longest are cut.
    const double room = 0.46 * step * map.u_range.width() / (map.nu - 1) * kMilli;
    double scale[2];
    for (int kind = 0; kind < 2; ++kind) {
      std::ranges::nth_element(longest[kind], longest[kind].begin() + std::ssize(longest[kind]) / 2);
      scale[kind] = 0.85 * room / longest[kind][longest[kind].size() / 2];
    }
    Plot picture = plot(kMapWidth);
    picture.edge(boundary_);
    for (const Sample& sample : samples) {
      for (int kind = 0; kind < 2; ++kind) {
        const Ellipsoid& ellipse = kind == 0 ? sample.velocity : sample.force;
        // Too long ones shrink as a whole, so that their shape stays true.
        const double fit = std::min(scale[kind], 1.15 * room / ellipse.lengths[0]);
        std::vector<Point2> curve;
        for (int n = 0; n < 40; ++n) {
          const double angle = 2.0 * std::numbers::pi * n / 40.0;
          const ToolVector p = ellipse.axes.col(0) * (fit * ellipse.lengths[0] * std::cos(angle)) +
                               ellipse.axes.col(1) * (fit * ellipse.lengths[1] * std::sin(angle));
          curve.push_back({sample.at.x + p[0], sample.at.y + p[1]});
        }
        picture.curves({curve}, kind + 1);
      }
    }
    figures_.push_back(
        {"ellipses", "dexterity", "Velocity and force ellipses",
         "Blue: tool velocities for joint rates of length 1. Orange: tool forces for joint torques of "
         "length 1. Each to a scale of its own; the longest are drawn smaller.",
         picture.svg("Velocity and force ellipses at points of the workspace")});
  }

  double skeleton_height() const {
    ActiveVector middle(2);
    for (int i = 0; i < 2; ++i) middle[i] = mechanism_.active_range(i).middle();
    const Solution solution = solve_forward(mechanism_, middle);
    return solution ? solution.posture->tool().position.z() : 0.0;
  }

  void forces() {
    if (!sheet_.continuous) return;
    const std::array<std::pair<Figure, const char*>, 3> maps = {
        {{Figure::force_x, "Force along x"},
         {Figure::force_y, "Force along y"},
         {Figure::weakest_force, "Force in every direction"}}};
    // One scale for all, without the few values near a singularity.
    std::vector<double> values;
    for (const auto& [which, title] : maps) {
      for (const double value : plane_.map.values[static_cast<size_t>(which)]) {
        if (std::isfinite(value)) values.push_back(value);
      }
    }
    if (values.empty()) return;
    const auto high =
        values.begin() + static_cast<std::ptrdiff_t>(0.95 * static_cast<double>(values.size() - 1));
    std::ranges::nth_element(values, high);
    const Interval range{0.0, *high};
    for (const auto& [which, title] : maps) {
      Plot picture = plot(kMapWidth);
      Field one = field(which);
      for (double& value : one.values) {
        if (std::isinf(value)) value = range.max;
      }
      picture.map(one, boundary_, "N", range);
      figures_.push_back({std::string(figure_info(static_cast<int>(which)).name), "force", title,
                          which == Figure::weakest_force
                              ? "Continuous; the radius of the circle within the force polygon."
                              : "Continuous, with no force across.",
                          picture.svg(title)});
    }
  }

  const DataSheet& sheet_;
  const PlaneSheet& plane_;
  Mechanism mechanism_;
  std::optional<Skeleton> skeleton_;
  std::array<Interval, 2> window_;  // [mm]
  Curves boundary_;                 // [mm]
  std::vector<SheetFigure> figures_;
};

}  // namespace

std::vector<SheetFigure> plane_sheet_figures(const DataSheet& sheet, const Description& description) {
  return PlaneFigures(sheet, description).draw();
}

}  // namespace zwidth
