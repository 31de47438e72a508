#include "figure/field.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace zwidth {

namespace {

// Marks the points between two that stay which stay too.
void simplify(const std::vector<Point2>& points, size_t first, size_t last, double tolerance,
              std::vector<bool>& keep) {
  if (last <= first + 1) return;
  const double dx = points[last].x - points[first].x;
  const double dy = points[last].y - points[first].y;
  const double length = std::hypot(dx, dy);
  double worst = -1.0;
  size_t at = first;
  for (size_t i = first + 1; i < last; ++i) {
    const double ax = points[i].x - points[first].x;
    const double ay = points[i].y - points[first].y;
    const double distance = length > 0.0 ? std::abs(dx * ay - dy * ax) / length : std::hypot(ax, ay);
    if (distance > worst) {
      worst = distance;
      at = i;
    }
  }
  if (worst <= tolerance) return;
  keep[at] = true;
  simplify(points, first, at, tolerance, keep);
  simplify(points, at, last, tolerance, keep);
}

}  // namespace

Field spread(const Field& field, int rounds) {
  Field result = field;
  for (int round = 0; round < rounds; ++round) {
    const Field before = result;
    for (int r = 0; r < field.rows; ++r) {
      for (int c = 0; c < field.columns; ++c) {
        if (!std::isnan(before.at(c, r))) continue;
        double sum = 0.0;
        int count = 0;
        for (int dr = -1; dr <= 1; ++dr) {
          for (int dc = -1; dc <= 1; ++dc) {
            const int rr = r + dr;
            const int cc = c + dc;
            if (rr < 0 || cc < 0 || rr >= field.rows || cc >= field.columns || std::isnan(before.at(cc, rr)))
              continue;
            sum += before.at(cc, rr);
            ++count;
          }
        }
        if (count > 0) result.values[static_cast<size_t>(r) * field.columns + c] = sum / count;
      }
    }
  }
  return result;
}

Field presence(const Field& field) {
  Field result = field;
  for (int r = 0; r < field.rows; ++r) {
    for (int c = 0; c < field.columns; ++c) {
      int inside = 0;
      for (int dr = -1; dr <= 1; ++dr) {
        for (int dc = -1; dc <= 1; ++dc) {
          const int rr = r + dr;
          const int cc = c + dc;
          if (rr >= 0 && cc >= 0 && rr < field.rows && cc < field.columns && !std::isnan(field.at(cc, rr)))
            ++inside;
        }
      }
      result.values[static_cast<size_t>(r) * field.columns + c] = inside / 9.0;
    }
  }
  return result;
}

std::vector<std::vector<Point2>> contours(const Field& field, double threshold) {
  // A border of cells below the threshold closes every curve.
  const int w = field.columns + 2;
  const int h = field.rows + 2;
  const auto value = [&](int c, int r) {
    if (c == 0 || r == 0 || c == w - 1 || r == h - 1) return -1e300;
    const double v = field.at(c - 1, r - 1);
    return std::isnan(v) ? -1e300 : v;
  };
  const auto crossing = [&](int c0, int r0, int c1, int r1) {
    const double a = value(c0, r0);
    const double b = value(c1, r1);
    const double t = a < -1e299 || b < -1e299 ? 0.5 : (threshold - a) / (b - a);
    return Point2{c0 + t * (c1 - c0) - 1.0, r0 + t * (r1 - r0) - 1.0};
  };
  // Edge ids: 2 (r w + c) is the edge to the right of node (c, r), 2 (r w + c) + 1 the edge upwards.
  std::vector<int> next(static_cast<size_t>(2) * w * h, -1);
  std::vector<Point2> points(next.size());
  const auto join = [&](int from, int to) { next[static_cast<size_t>(from)] = to; };
  for (int r = 0; r + 1 < h; ++r) {
    for (int c = 0; c + 1 < w; ++c) {
      const bool a = value(c, r) >= threshold;
      const bool b = value(c + 1, r) >= threshold;
      const bool d = value(c + 1, r + 1) >= threshold;
      const bool e = value(c, r + 1) >= threshold;
      const int kind = a + 2 * b + 4 * d + 8 * e;
      if (kind == 0 || kind == 15) continue;
      const int south = 2 * (r * w + c);
      const int west = south + 1;
      const int north = 2 * ((r + 1) * w + c);
      const int east = 2 * (r * w + c + 1) + 1;
      if (a != b) points[static_cast<size_t>(south)] = crossing(c, r, c + 1, r);
      if (a != e) points[static_cast<size_t>(west)] = crossing(c, r, c, r + 1);
      if (d != e) points[static_cast<size_t>(north)] = crossing(c, r + 1, c + 1, r + 1);
      if (b != d) points[static_cast<size_t>(east)] = crossing(c + 1, r, c + 1, r + 1);
      // Inside lies on the left of each piece.
      switch (kind) {
        case 1:
          join(south, west);
          break;
        case 2:
          join(east, south);
          break;
        case 3:
          join(east, west);
          break;
        case 4:
          join(north, east);
          break;
        case 5:
          join(south, west), join(north, east);
          break;
        case 6:
          join(north, south);
          break;
        case 7:
          join(north, west);
          break;
        case 8:
          join(west, north);
          break;
        case 9:
          join(south, north);
          break;
        case 10:
          join(east, south), join(west, north);
          break;
        case 11:
          join(east, north);
          break;
        case 12:
          join(west, east);
          break;
        case 13:
          join(south, east);
          break;
        case 14:
          join(west, south);
          break;
        default:
          break;
      }
    }
  }
  std::vector<std::vector<Point2>> result;
  for (size_t start = 0; start < next.size(); ++start) {
    if (next[start] < 0) continue;
    std::vector<Point2> curve;
    for (int at = static_cast<int>(start); at >= 0 && next[static_cast<size_t>(at)] >= 0;) {
      curve.push_back(points[static_cast<size_t>(at)]);
      at = std::exchange(next[static_cast<size_t>(at)], -1);
    }
    if (curve.size() >= 4) result.push_back(std::move(curve));
  }
  return result;
}

std::vector<Point2> simplified(const std::vector<Point2>& points, double tolerance) {
  if (points.size() < 3) return points;
  std::vector<bool> keep(points.size(), false);
  keep.front() = keep.back() = true;
  simplify(points, 0, points.size() - 1, tolerance, keep);
  std::vector<Point2> result;
  for (size_t i = 0; i < points.size(); ++i) {
    if (keep[i]) result.push_back(points[i]);
  }
  return result;
}

}  // namespace zwidth
