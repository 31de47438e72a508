#include <Eigen/LU>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "zwidth/analysis/internal/probe.h"
#include "zwidth/analysis/internal/region.h"
#include "zwidth/analysis/workspace.h"

/// The largest c + a U in the workspace, U the unit ball of the 2-norm (sphere, circle) or of the maximum norm
/// (cube, square).
/// For a centre c, a is the shortest way out along any ray of U's surface: a(c) = min_u t(c, u). That is
/// maximised over c by sequential linear programming on the nearest contacts, with a trust region; only the
/// question "inside?" is asked.

namespace zwidth {
namespace {

using internal::Probe;
using internal::Region;
using internal::RegionLattice;

constexpr std::size_t kMaxContacts = 14;
constexpr std::size_t kMaxRays = 64;  // enough for all faces of a cube
constexpr double kSafety = 1e-8;      // relative; keeps the answer inside in spite of the last digits

struct Shape {
  bool cube = false;
  int dimension = 3;             // 2: all in the plane of x and y
  std::vector<Vector3> samples;  // of its surface
  std::vector<Vector3> many;     // of them, to look at the answer once more

  Vector3 onto_surface(const Vector3& u) const { return u / (cube ? u.lpNorm<Eigen::Infinity>() : u.norm()); }
};

std::vector<Vector3> sphere_samples(int count) {
  std::vector<Vector3> samples;
  for (int n = 0; n < count; ++n) {  // on a spiral
    const double z = 1.0 - (2.0 * n + 1.0) / count, r = std::sqrt(1.0 - z * z);
    const double turn = std::numbers::pi * (1.0 + std::sqrt(5.0)) * n;
    samples.emplace_back(r * std::cos(turn), r * std::sin(turn), z);
  }
  return samples;
}

std::vector<Vector3> cube_samples(int half) {
  std::vector<Vector3> samples;
  for (int i = -half; i <= half; ++i) {
    for (int j = -half; j <= half; ++j) {
      for (int k = -half; k <= half; ++k) {
        if (std::max({std::abs(i), std::abs(j), std::abs(k)}) == half)
          samples.push_back(Vector3(i, j, k) / half);
      }
    }
  }
  return samples;
}

Shape unit_sphere() {
  return {.samples = sphere_samples(256), .many = sphere_samples(5000)};  // 0.22 rad and 0.05 rad apart
}

Shape unit_cube() {
  return {.cube = true, .samples = cube_samples(3), .many = cube_samples(14)};
}

Shape unit_circle() {
  constexpr int kPoints = 96;
  Shape shape{.dimension = 2};
  for (int n = 0; n < kPoints; ++n) {
    const double angle = 2.0 * std::numbers::pi * n / kPoints;
    shape.samples.emplace_back(std::cos(angle), std::sin(angle), 0.0);
  }
  return shape;
}

Shape unit_square() {
  constexpr int kHalf = 12;
  Shape shape{.cube = true, .dimension = 2};
  for (int i = -kHalf; i < kHalf; ++i) {
    const double a = static_cast<double>(i) / kHalf;
    for (const Vector3& u : {Vector3(a, -1, 0), Vector3(1, a, 0), Vector3(-a, 1, 0), Vector3(-1, -a, 0)}) {
      shape.samples.push_back(u);
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
  // `hole` is the size of the smallest hole that is looked for [m]; infinite: there is none.
  Inflation(Region& region, const Shape& shape, double scale, double hole)
      : region_(region), shape_(shape), scale_(scale), hole_(hole) {}

  // Contacts of centre c up to `margin` beyond the nearest, nearest first; those of a neighbouring centre help.
  // The shape of size `safe` fits, and none is expected to beyond `reach`.
  std::vector<Contact> contacts(const Vector3& c, const std::vector<Contact>& known, double margin, double safe,
                                double reach) {
    std::vector<Contact> found;
    if (!inside(c)) return found;
    safe_ = std::max(0.0, safe);
    double nearest = reach;
    for (const Contact& contact : known) {
      const double limit = nearest + margin;
      found.push_back(descend(c, {contact.u, exit(c, contact.u, limit).value_or(limit)}, 0.03));
      nearest = std::min(nearest, found.back().t);
    }
    std::vector<Contact> rays;
    for (const Vector3& u : shape_.samples) {
      const std::optional<double> t = exit(c, u, nearest + margin);
      if (!t) continue;
      rays.push_back({u, *t});
      nearest = std::min(nearest, *t);
    }
    std::ranges::sort(rays, {}, &Contact::t);
    for (const Contact& ray : rays) {
      if (ray.t > nearest + margin || found.size() >= kMaxRays) break;
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
      const Vector3 n = normal(c, contact), slope = -n / n.dot(contact.u);
      // Many rays meet a flat side of the workspace that the cube lies against; the first of them says all.
      if (std::ranges::any_of(distinct, [&](const Contact& d) { return (d.slope - slope).norm() < 1e-6; }))
        continue;
      distinct.push_back({contact.u, contact.t, slope});
    }
    return distinct;
  }

  // The ray that leaves earliest of those that leave before `t`, if the samples so far have missed any.
  std::optional<Contact> missed(const Vector3& c, double t) {
    std::optional<Contact> first;
    for (const Vector3& u : shape_.many) {
      const double limit = first ? first->t : t * (1.0 - 1e-6);
      if (inside(c + limit * u)) continue;
      first = Contact{.u = u, .t = exit_between(c, u, 0.0, limit)};
    }
    if (!first) return first;
    first = descend(c, *first, 0.05);
    const Vector3 n = normal(c, *first);
    first->slope = -n / n.dot(first->u);
    return first;
  }

 private:
  bool inside(const Vector3& p) { return region_.inside(p); }
  double margin(const Vector3& p) { return region_.margin(p); }

  // Where the ray leaves between `in`, inside, and `out`, outside: by false position on the margin (Illinois),
  // or bisection where there is none.
  double exit_between(const Vector3& c, const Vector3& u, double in, double out) {
    double margin_in = margin(c + in * u), margin_out = margin(c + out * u);
    int side = 0;
    for (int step = 0; step < 100 && out - in > 1e-13 * scale_; ++step) {
      const bool measured = margin_in > 0.0 && margin_out < 0.0 && step % 8 != 7;
      const double t = measured ? in + (out - in) * margin_in / (margin_in - margin_out) : 0.5 * (in + out);
      const double here = margin(c + t * u);
      if (measured && std::abs(here) < 1e-14) return t;
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

  // Where the ray leaves before `limit`, if it does: in steps, since it may enter again beyond a hole.
  std::optional<double> exit(const Vector3& c, const Vector3& u, double limit) {
    double in = std::min(safe_, limit);
    while (in < limit) {
      const double next = std::min(in + hole_, limit);
      if (!inside(c + next * u)) return exit_between(c, u, in, next);
      in = next;
    }
    return std::nullopt;
  }

  // Pattern search for the ray near by that leaves first.
  Contact descend(const Vector3& c, Contact best, double step) {
    while (step > 2e-6) {
      bool gained = false;
      const int axes = shape_.dimension;
      for (int direction = 0; direction < 2 * axes && !gained; ++direction) {
        const Vector3 u =
            shape_.onto_surface(best.u + (direction < axes ? step : -step) * Vector3::Unit(direction % axes));
        if (inside(c + best.t * u)) continue;
        const double t = exit_between(c, u, std::min(safe_, best.t), best.t);
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
    if (shape_.dimension == 2) return plane_normal(c, contact);
    const std::optional<Vector3> known = region_.normal(c + contact.t * contact.u, contact.u);
    if (known) return *known;
    // From where rays close by leave.
    constexpr double kTurn = 1e-4;
    const Vector3& u = contact.u;
    const Vector3 e = u.unitOrthogonal(), f = u.normalized().cross(e);
    const auto exit_near = [&](const Vector3& way) -> Vector3 {
      const Vector3 v = u + kTurn * u.norm() * way;
      const double limit = contact.t * (1.0 + 50.0 * kTurn);
      return exit(c, v, limit).value_or(limit) * v;
    };
    const Vector3 n = (exit_near(e) - exit_near(-e)).cross(exit_near(f) - exit_near(-f)).normalized();
    if (n.allFinite() && std::abs(n.dot(u)) > 0.05 * u.norm()) return n.dot(u) < 0.0 ? Vector3(-n) : n;
    return shape_.cube ? shape_.onto_surface(u).normalized() : u;
  }

  // The same in a plane, where the boundary need not be the end of a joint's range. Where a ray leaves first
  // among those around it, boundary and shape touch; only a corner of the square tells nothing of the boundary.
  Vector3 plane_normal(const Vector3& c, const Contact& contact) {
    const Vector3& u = contact.u;
    if (!shape_.cube) return u;
    const int along = std::abs(u.x()) < std::abs(u.y()) ? 0 : 1;  // the axis that runs along the edge
    if (std::abs(u[along]) < 1.0 - 1e-4) return std::copysign(1.0, u[1 - along]) * Vector3::Unit(1 - along);
    constexpr double kTurn = 1e-4;
    std::array<Vector3, 2> beside;
    for (int side = 0; side < 2; ++side) {
      const double turn = side == 0 ? -kTurn : kTurn;
      const Vector3 v = u + turn * Vector3(-u.y(), u.x(), 0.0);
      const double limit = contact.t * (1.0 + 50.0 * kTurn);
      beside[side] = c + exit(c, v, limit).value_or(limit) * v;
    }
    const Vector3 tangent = beside[1] - beside[0];
    return Vector3(tangent.y(), -tangent.x(), 0.0).normalized();
  }

  Region& region_;
  const Shape& shape_;
  double scale_;
  double hole_;
  double safe_ = 0.0;
};

// The move within |move|_inf <= radius that makes the smallest of t_m + slope_m . move largest: the best of all
// vertices of the linear program, of which there are few. A vertex lies where contact i is met together with
// three more: contacts, or sides of the trust region.
Vector3 best_move(const std::vector<Contact>& contacts, double radius, int dimension) {
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
        // In a plane nothing moves along z, and one row says so.
        if (axis == 2 && dimension == 2 && side > 0.0) {
          rows.push_back(Vector3::Unit(2));
          bounds.push_back(0.0);
        }
        if (axis == 2 && dimension == 2) continue;
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

// Promising centres: points of a coarse lattice, far from the lattice points outside.
struct Start {
  Vector3 centre = Vector3::Zero();
  std::array<Vector3, 2> outside{Vector3::Zero(), Vector3::Zero()};  // the nearest of those
  std::array<double, 2> distance{1e300, 1e300};  // by the 2-norm and by the maximum norm [m]
};

InscribedShape inflate(Region& region, const Shape& shape, const Start& start, double spacing, double scale) {
  // In a plane, whose workspace often has holes, rays go step by step from where the shape is known to fit.
  const bool in_plane = shape.dimension == 2;
  Inflation inflation(region, shape, scale, in_plane ? spacing : std::numeric_limits<double>::infinity());
  Vector3 c = start.centre;
  double trust = spacing;
  std::vector<Contact> known;
  if (in_plane) known.push_back({.u = shape.onto_surface(start.outside[shape.cube] - c)});
  const double distance = start.distance[shape.cube];
  std::vector<Contact> contacts = inflation.contacts(
      c, known, 2.0 * trust, in_plane ? distance - 2.0 * spacing : 0.0, in_plane ? distance : scale);
  if (contacts.empty()) return {};
  // What fits still fits around a centre near by, smaller by the move; a tenth is looked at again.
  const auto still_fits = [&](const Vector3& move) {
    const double length = shape.cube ? move.lpNorm<Eigen::Infinity>() : move.norm();
    return in_plane ? 0.9 * contacts.front().t - length : 0.0;
  };
  // What the rays between the contacts have missed is one more contact.
  for (int look = 0; look < 12; ++look) {
    if (contacts.empty()) return {};
    if (look > 0) {
      const std::optional<Contact> missed = inflation.missed(c, contacts.front().t);
      if (!missed) break;
      contacts.insert(contacts.begin(), *missed);
      trust = 0.1 * spacing;
    }
    for (int iteration = 0; iteration < 60 && trust > 1e-10 * scale; ++iteration) {
      const Vector3 move = best_move(contacts, trust, shape.dimension);
      if (move.isZero(0.0)) {
        trust *= 0.3;
        contacts = inflation.contacts(c, contacts, 2.0 * trust, still_fits(move), scale);
        continue;
      }
      std::vector<Contact> there = inflation.contacts(c + move, contacts, 2.0 * trust, still_fits(move), scale);
      double expected = 1e300;
      for (const Contact& contact : contacts)
        expected = std::min(expected, contact.t + contact.slope.dot(move));
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
  }
  InscribedShape result;
  result.centre = c;
  const double a = contacts.front().t * (1.0 - kSafety);
  result.size = shape.cube ? 2.0 * a : a;
  if (in_plane) {
    result.volume = (shape.cube ? 4.0 : std::numbers::pi) * a * a;
  } else {
    result.volume = (shape.cube ? 8.0 : 4.0 / 3.0 * std::numbers::pi) * a * a * a;
  }
  return result;
}

std::vector<Start> starts(const RegionLattice& lattice) {
  const std::array<int, 3>& n = lattice.count;
  std::vector<Start> centres;
  std::vector<Vector3> rim;
  for (int i = 0; i < n[0]; ++i) {
    for (int j = 0; j < n[1]; ++j) {
      for (int k = 0; k < n[2]; ++k) {
        if (lattice.at(i, j, k)) {
          centres.push_back({.centre = lattice.point(i, j, k)});
        } else if (lattice.at(i - 1, j, k) || lattice.at(i + 1, j, k) || lattice.at(i, j - 1, k) ||
                   lattice.at(i, j + 1, k) || lattice.at(i, j, k - 1) || lattice.at(i, j, k + 1)) {
          rim.push_back(lattice.point(i, j, k));
        }
      }
    }
  }
  for (Start& start : centres) {
    double squared = 1e300, largest = 1e300;
    for (const Vector3& outside : rim) {
      const Vector3 d = outside - start.centre;
      if (const double length = d.squaredNorm(); length < squared) {
        squared = length;
        start.outside[0] = outside;
      }
      if (const double length = d.lpNorm<Eigen::Infinity>(); length < largest) {
        largest = length;
        start.outside[1] = outside;
      }
    }
    start.distance[0] = std::sqrt(squared);
    start.distance[1] = largest;
  }
  return centres;
}

// The workspace of a mechanism whose tool translates.
class TranslationRegion : public Region {
 public:
  explicit TranslationRegion(const Mechanism& mechanism) : probe_(mechanism) {}

  int dimension() const override { return probe_.dimension(); }
  bool inside(const Vector3& point) override { return probe_.inverse(point).inside; }

  // How far the driven joints are from the ends of their ranges [rad]; NaN off the device's branch, and where a
  // joint that no drive moves is beyond its own.
  double margin(const Vector3& point) override {
    const Probe::Answer answer = probe_.inverse(point);
    if (!answer.reached || !answer.on_branch) return std::numeric_limits<double>::quiet_NaN();
    double least = std::numeric_limits<double>::infinity();
    for (int j = 0; j < probe_.dimension(); ++j) {
      const Interval range = probe_.range(j);
      least = std::min({least, answer.joints[j] - range.min, range.max - answer.joints[j]});
    }
    return answer.inside || least < 0.0 ? least : std::numeric_limits<double>::quiet_NaN();
  }

  // Of the surface on which the joint that has come to an end of its range stays there.
  std::optional<Vector3> normal(const Vector3& point, const Vector3& outwards) override {
    const Probe::Answer answer = probe_.inverse(point);
    if (!answer.reached || answer.jacobian.determinant() == 0.0) return std::nullopt;
    const Matrix3 inverse = answer.jacobian.inverse();
    std::optional<Vector3> n;
    double closest = 1e-3;  // [rad]
    for (int j = 0; j < 3; ++j) {
      const Interval range = probe_.range(j);
      const double below = answer.joints[j] - range.min, above = range.max - answer.joints[j];
      const double gap = std::min(std::abs(below), std::abs(above));
      const Vector3 candidate =
          (std::abs(below) < std::abs(above) ? -1.0 : 1.0) * inverse.row(j).transpose().normalized();
      if (gap < closest && candidate.dot(outwards) > 0.05) {
        closest = gap;
        n = candidate;
      }
    }
    return n;
  }

  void restart() { probe_.restart(); }

 private:
  Probe probe_;
};

RegionLattice lattice_of(TranslationRegion& region, const Extents& extents, double h) {
  RegionLattice lattice{.spacing = h};
  for (int axis = 0; axis < region.dimension(); ++axis) {
    lattice.count[axis] = static_cast<int>(extents.range[axis].width() / h) + 3;
    lattice.origin[axis] = extents.range[axis].min - 0.5 * h;
  }
  lattice.inside.resize(lattice.index(lattice.count[0] - 1, lattice.count[1] - 1, lattice.count[2] - 1) + 1);
  for (int i = 0; i < lattice.count[0]; ++i) {
    for (int j = 0; j < lattice.count[1]; ++j) {
      region.restart();
      for (int k = 0; k < lattice.count[2]; ++k)
        lattice.inside[lattice.index(i, j, k)] = region.inside(lattice.point(i, j, k)) ? 1 : 0;
    }
  }
  return lattice;
}

}  // namespace

namespace internal {

InscribedShape largest_shape(Region& region, bool cube, const RegionLattice& lattice, double scale, int tries) {
  const bool in_plane = region.dimension() == 2;
  const double h = lattice.spacing;
  const Shape shape = in_plane ? (cube ? unit_square() : unit_circle()) : cube ? unit_cube() : unit_sphere();
  std::vector<Start> centres = starts(lattice);
  std::ranges::sort(centres, std::ranges::greater(),
                    [cube](const Start& start) { return start.distance[cube]; });
  InscribedShape best;
  std::vector<Vector3> tried;
  for (const Start& start : centres) {
    if (std::ssize(tried) == tries) break;
    // Others lead to the same place.
    const double apart = std::max(3.0 * h, 0.5 * start.distance[cube]);
    if (std::ranges::any_of(tried, [&](const Vector3& c) { return (c - start.centre).norm() < apart; }))
      continue;
    tried.push_back(start.centre);
    const InscribedShape found = inflate(region, shape, start, h, scale);
    if (found.size > best.size) best = found;
  }
  return best;
}

}  // namespace internal

InscribedShapes inscribed_shapes(const Mechanism& mechanism) {
  assert(!workspace_obstacle(mechanism));
  const Extents extents = workspace_extents(mechanism);
  const double scale = extents.size().maxCoeff();
  InscribedShapes shapes;
  if (!(scale > 0.0)) return shapes;
  TranslationRegion region(mechanism);
  const bool in_plane = region.dimension() == 2;
  // An arm that positions often covers a shell, thin beside its width: as many points as a cube would have then
  // lie closer in its flat box.
  const bool arm = mechanism.platform() == PlatformFreedom::point;
  const bool quick = Probe(mechanism).fast() || arm;
  const double edge = arm ? std::cbrt(extents.size().prod()) : scale;
  const double h = edge / (in_plane ? 80.0 : quick ? 24.0 : 12.0);
  const int tries = in_plane ? 5 : quick ? 3 : 1;
  const RegionLattice lattice = lattice_of(region, extents, h);
  shapes.sphere = internal::largest_shape(region, false, lattice, scale, tries);
  shapes.cube = internal::largest_shape(region, true, lattice, scale, tries);
  return shapes;
}

}  // namespace zwidth
