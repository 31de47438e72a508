#include <Eigen/LU>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>

#include "zwidth/analysis/internal/probe.h"
#include "zwidth/analysis/workspace.h"

/// The largest c + a U in the workspace, U the unit ball of the 2-norm (sphere) or of the maximum norm (cube).
/// For a centre c, a is the shortest way out along any ray of U's surface: a(c) = min_u t(c, u). That is
/// maximised over c by sequential linear programming on the nearest contacts, with a trust region; only the
/// question "inside?" is asked.

namespace zwidth {
namespace {

using internal::Probe;

constexpr int kMaxContacts = 14;
constexpr double kSafety = 1e-8;  // relative; keeps the answer inside in spite of the last digits

struct Shape {
  bool cube = false;
  std::vector<Vector3> samples;  // of its surface

  Vector3 onto_surface(const Vector3& u) const { return u / (cube ? u.lpNorm<Eigen::Infinity>() : u.norm()); }
};

Shape unit_sphere() {
  constexpr int kPoints = 256;  // on a spiral, some 0.22 rad apart
  Shape shape;
  for (int n = 0; n < kPoints; ++n) {
    const double z = 1.0 - (2.0 * n + 1.0) / kPoints, r = std::sqrt(1.0 - z * z);
    const double turn = std::numbers::pi * (1.0 + std::sqrt(5.0)) * n;
    shape.samples.emplace_back(r * std::cos(turn), r * std::sin(turn), z);
  }
  return shape;
}

Shape unit_cube() {
  constexpr int kHalf = 3;
  Shape shape{.cube = true};
  for (int i = -kHalf; i <= kHalf; ++i) {
    for (int j = -kHalf; j <= kHalf; ++j) {
      for (int k = -kHalf; k <= kHalf; ++k) {
        if (std::max({std::abs(i), std::abs(j), std::abs(k)}) == kHalf) {
          shape.samples.push_back(Vector3(i, j, k) / kHalf);
        }
      }
    }
  }
  return shape;
}

// A ray that leaves the workspace earlier than those around it.
struct Contact {
  Vector3 u;                        // on the surface of the unit shape
  double t = 0.0;                   // where it leaves [m]
  Vector3 slope = Vector3::Zero();  // change of t per move of the centre
};

class Inflation {
 public:
  Inflation(Probe& probe, const Shape& shape, double scale) : probe_(probe), shape_(shape), scale_(scale) {}

  // Contacts of centre c up to `margin` beyond the nearest, nearest first; those of a neighbouring centre help.
  std::vector<Contact> contacts(const Vector3& c, const std::vector<Contact>& known, double margin) {
    std::vector<Contact> found;
    if (!inside(c)) return found;
    double nearest = scale_;
    for (const Contact& contact : known) {
      found.push_back(descend(c, {contact.u, exit(c, contact.u, nearest + margin)}, 0.03));
      nearest = std::min(nearest, found.back().t);
    }
    std::vector<Contact> rays;
    for (const Vector3& u : shape_.samples) {
      const double limit = nearest + margin;
      if (inside(c + limit * u)) continue;
      rays.push_back({u, exit(c, u, limit)});
      nearest = std::min(nearest, rays.back().t);
    }
    std::ranges::sort(rays, {}, &Contact::t);
    for (const Contact& ray : rays) {
      if (ray.t > nearest + margin || found.size() >= 2 * kMaxContacts) break;
      // One contact for every neighbourhood, the one that leaves first.
      const auto covers = [&](const Contact& other) {
        return other.t <= ray.t && (other.u - ray.u).norm() < 0.35;
      };
      if (std::ranges::any_of(found, covers)) continue;
      found.push_back(descend(c, ray, 0.15));
      nearest = std::min(nearest, found.back().t);
    }
    std::ranges::sort(found, {}, &Contact::t);
    std::vector<Contact> distinct;
    for (const Contact& contact : found) {
      if (contact.t > nearest + margin || distinct.size() >= kMaxContacts) break;
      if (std::ranges::any_of(distinct, [&](const Contact& d) { return (d.u - contact.u).norm() < 1e-3; }))
        continue;
      distinct.push_back(contact);
      const Vector3 n = normal(c, contact);
      distinct.back().slope = -n / n.dot(contact.u);
    }
    return distinct;
  }

 private:
  bool inside(const Vector3& p) { return probe_.inverse(p).inside; }

  // How far the joints are from the ends of their ranges [rad]; below zero beyond, NaN off the device's branch.
  double margin(const Vector3& p) {
    const Probe::Answer answer = probe_.inverse(p);
    if (!answer.reached || !answer.on_branch) return std::numeric_limits<double>::quiet_NaN();
    double least = std::numeric_limits<double>::infinity();
    for (int j = 0; j < 3; ++j) {
      const Interval range = probe_.range(j);
      least = std::min({least, answer.joints[j] - range.min, range.max - answer.joints[j]});
    }
    return least;
  }

  // Where the ray leaves between `in`, inside, and `out`, outside: by false position on the margin (Illinois),
  // or bisection where there is none.
  double exit_between(const Vector3& c, const Vector3& u, double in, double out) {
    double margin_in = margin(c + in * u), margin_out = margin(c + out * u);
    int side = 0;
    for (int step = 0; step < 100 && out - in > 1e-13 * scale_; ++step) {
      const bool measured = margin_in > 0.0 && margin_out < 0.0 && step % 8 != 7;
      const double t = measured ? in + (out - in) * margin_in / (margin_in - margin_out) : 0.5 * (in + out);
      const double here = margin(c + t * u);
      if (std::abs(here) < 1e-14) return t;
      if (here > 0.0) {
        in = t;
        margin_in = here;
        if (side == 1) margin_out *= 0.5;
        side = 1;
      } else {
        out = t;
        margin_out = here;
        if (side == -1) margin_in *= 0.5;
        side = -1;
      }
    }
    return in;
  }

  // Where the ray leaves, if it is outside at `limit`; else `limit`.
  double exit(const Vector3& c, const Vector3& u, double limit) {
    return inside(c + limit * u) ? limit : exit_between(c, u, 0.0, limit);
  }

  // Pattern search for the ray near by that leaves first.
  Contact descend(const Vector3& c, Contact best, double step) {
    while (step > 2e-6) {
      bool gained = false;
      for (int direction = 0; direction < 6 && !gained; ++direction) {
        const Vector3 u =
            shape_.onto_surface(best.u + (direction < 3 ? step : -step) * Vector3::Unit(direction % 3));
        if (inside(c + best.t * u)) continue;
        const double t = exit_between(c, u, 0.0, best.t);
        if (t < best.t) {
          best = {u, t};
          gained = true;
        }
      }
      if (!gained) step *= 0.4;
    }
    return best;
  }

  // Outward normal of the boundary where a contact leaves.
  Vector3 normal(const Vector3& c, const Contact& contact) {
    const Probe::Answer answer = probe_.inverse(c + contact.t * contact.u);
    Vector3 n = shape_.cube ? shape_.onto_surface(contact.u).normalized() : contact.u;
    if (!answer.reached || answer.jacobian.determinant() == 0.0) return n;
    const Matrix3 inverse = answer.jacobian.inverse();
    double closest = 1e-3;  // [rad]; the joint that has come to an end of its range
    for (int j = 0; j < 3; ++j) {
      const Interval range = probe_.range(j);
      const double below = answer.joints[j] - range.min, above = range.max - answer.joints[j];
      const double gap = std::min(std::abs(below), std::abs(above));
      const Vector3 candidate =
          (std::abs(below) < std::abs(above) ? -1.0 : 1.0) * inverse.row(j).transpose().normalized();
      if (gap < closest && candidate.dot(contact.u) > 0.05) {
        closest = gap;
        n = candidate;
      }
    }
    return n;
  }

  Probe& probe_;
  const Shape& shape_;
  double scale_;
};

// The move within |move|_inf <= radius that makes the smallest of t_m + slope_m . move largest: the best of all
// vertices of the linear program, of which there are few. A vertex lies where contact i is met together with
// three more: contacts, or sides of the trust region.
Vector3 best_move(const std::vector<Contact>& contacts, double radius) {
  const auto value_at = [&](const Vector3& move) {
    double value = 1e300;
    for (const Contact& contact : contacts) value = std::min(value, contact.t + contact.slope.dot(move));
    return value;
  };
  Vector3 best = Vector3::Zero();
  double best_value = value_at(best);
  std::vector<Vector3> rows;
  std::vector<double> bounds;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    rows.clear();
    bounds.clear();
    for (std::size_t j = i + 1; j < contacts.size(); ++j) {
      rows.push_back(contacts[j].slope - contacts[i].slope);
      bounds.push_back(contacts[i].t - contacts[j].t);
    }
    for (int axis = 0; axis < 3; ++axis) {
      for (const double side : {-radius, radius}) {
        rows.push_back(Vector3::Unit(axis));
        bounds.push_back(side);
      }
    }
    for (std::size_t j = 0; j < rows.size(); ++j) {
      for (std::size_t k = j + 1; k < rows.size(); ++k) {
        const Vector3 across = rows[j].cross(rows[k]);
        for (std::size_t l = k + 1; l < rows.size(); ++l) {
          const double det = across.dot(rows[l]);
          if (std::abs(det) < 1e-9) continue;
          const Vector3 move =
              (bounds[j] * rows[k].cross(rows[l]) + bounds[k] * rows[l].cross(rows[j]) + bounds[l] * across) /
              det;
          if (!(move.lpNorm<Eigen::Infinity>() <= radius * (1.0 + 1e-9))) continue;
          const double value = value_at(move);
          if (value > best_value) {
            best_value = value;
            best = move;
          }
        }
      }
    }
  }
  return best;
}

InscribedShape inflate(Probe& probe, const Shape& shape, const Vector3& start, double trust, double scale) {
  Inflation inflation(probe, shape, scale);
  Vector3 c = start;
  std::vector<Contact> contacts = inflation.contacts(c, {}, 2.0 * trust);
  if (contacts.empty()) return {};
  for (int iteration = 0; iteration < 60 && trust > 1e-10 * scale; ++iteration) {
    const Vector3 move = best_move(contacts, trust);
    if (move.isZero(0.0)) {
      trust *= 0.3;
      contacts = inflation.contacts(c, contacts, 2.0 * trust);
      continue;
    }
    std::vector<Contact> there = inflation.contacts(c + move, contacts, 2.0 * trust);
    double expected = 1e300;
    for (const Contact& contact : contacts) expected = std::min(expected, contact.t + contact.slope.dot(move));
    const double gain = there.empty() ? -1.0 : there.front().t - contacts.front().t;
    if (gain > 0.0) {
      const bool faithful = gain > 0.5 * (expected - contacts.front().t);
      c += move;
      contacts = std::move(there);
      trust *= faithful ? 1.5 : 0.5;
    } else {
      trust *= 0.25;
    }
  }
  InscribedShape result;
  result.centre = c;
  const double a = contacts.front().t * (1.0 - kSafety);
  result.size = shape.cube ? 2.0 * a : a;
  result.volume = shape.cube ? 8.0 * a * a * a : 4.0 / 3.0 * std::numbers::pi * a * a * a;
  return result;
}

// Promising centres: points of a coarse lattice, far from the lattice points outside.
struct Start {
  Vector3 centre;
  double distance[2];  // by the 2-norm and by the maximum norm [m]
};

std::vector<Start> starts(Probe& probe, const Extents& extents, double h) {
  std::array<int, 3> n;
  for (int axis = 0; axis < 3; ++axis) n[axis] = static_cast<int>(extents.range[axis].width() / h) + 3;
  const auto index = [&](int i, int j, int k) { return (i * n[1] + j) * n[2] + k; };
  const auto point = [&](int i, int j, int k) {
    return Vector3(extents.range[0].min + (i - 0.5) * h, extents.range[1].min + (j - 0.5) * h,
                   extents.range[2].min + (k - 0.5) * h);
  };
  std::vector<char> inside(static_cast<std::size_t>(n[0] * n[1] * n[2]));
  for (int i = 0; i < n[0]; ++i) {
    for (int j = 0; j < n[1]; ++j) {
      probe.restart();
      for (int k = 0; k < n[2]; ++k)
        inside[static_cast<std::size_t>(index(i, j, k))] = probe.inverse(point(i, j, k)).inside;
    }
  }
  std::vector<Start> centres;
  std::vector<Vector3> rim;
  const auto is_inside = [&](int i, int j, int k) {
    return i >= 0 && j >= 0 && k >= 0 && i < n[0] && j < n[1] && k < n[2] &&
           inside[static_cast<std::size_t>(index(i, j, k))] != 0;
  };
  for (int i = 0; i < n[0]; ++i) {
    for (int j = 0; j < n[1]; ++j) {
      for (int k = 0; k < n[2]; ++k) {
        if (is_inside(i, j, k)) {
          centres.push_back({point(i, j, k), {1e300, 1e300}});
        } else if (is_inside(i - 1, j, k) || is_inside(i + 1, j, k) || is_inside(i, j - 1, k) ||
                   is_inside(i, j + 1, k) || is_inside(i, j, k - 1) || is_inside(i, j, k + 1)) {
          rim.push_back(point(i, j, k));
        }
      }
    }
  }
  for (Start& start : centres) {
    double squared = 1e300, largest = 1e300;
    for (const Vector3& outside : rim) {
      const Vector3 d = outside - start.centre;
      squared = std::min(squared, d.squaredNorm());
      largest = std::min(largest, d.lpNorm<Eigen::Infinity>());
    }
    start.distance[0] = std::sqrt(squared);
    start.distance[1] = largest;
  }
  return centres;
}

}  // namespace

InscribedShapes inscribed_shapes(const Mechanism& mechanism) {
  assert(!workspace_obstacle(mechanism));
  Probe probe(mechanism);
  const Extents extents = workspace_extents(mechanism);
  const double scale = extents.size().maxCoeff();
  InscribedShapes shapes;
  if (!(scale > 0.0)) return shapes;
  // An arm that positions often covers a shell, thin beside its width: as many points as a cube would have then
  // lie closer in its flat box.
  const bool arm = mechanism.platform() == PlatformFreedom::point;
  const bool quick = mechanism.delta() || arm;
  const double edge = arm ? std::cbrt(extents.size().prod()) : scale;
  const double h = edge / (quick ? 24.0 : 12.0);
  const int tries = quick ? 3 : 1;
  std::vector<Start> centres = starts(probe, extents, h);
  for (const bool cube : {false, true}) {
    const Shape shape = cube ? unit_cube() : unit_sphere();
    std::ranges::sort(centres, std::ranges::greater(),
                      [cube](const Start& start) { return start.distance[cube]; });
    InscribedShape best;
    std::vector<Vector3> tried;
    for (const Start& start : centres) {
      if (std::ssize(tried) == tries) break;
      if (std::ranges::any_of(tried, [&](const Vector3& c) { return (c - start.centre).norm() < 3.0 * h; }))
        continue;
      tried.push_back(start.centre);
      const InscribedShape found = inflate(probe, shape, start.centre, h, scale);
      if (found.size > best.size) best = found;
    }
    (cube ? shapes.cube : shapes.sphere) = best;
  }
  return shapes;
}

}  // namespace zwidth
