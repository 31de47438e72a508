#include <cmath>
#include <numbers>

#include "quantities.h"

#include "zwidth/analysis/five_bar_search.h"
#include "zwidth/mechanism/five_bar.h"

namespace zwidth::reference {
namespace {

FiveBarGeometry checked(const FiveBarGeometry& geometry) {
  // The source wants the motors apart.
  if (!can_assemble(geometry) || geometry.half_base == 0.0) throw Refusal("invalid_argument");
  return geometry;
}

FiveBarGeometry geometry(const Inputs& in) {
  return checked({.crank = in.number("r1"), .coupler = in.number("r2"), .half_base = in.number("r3")});
}

int sign(double value) {
  if (std::abs(value) != 1.0) throw Refusal("invalid_argument");
  return value < 0.0 ? -1 : 1;
}

WorkingMode mode(const Inputs& in) {
  if (!in.has("mode")) return {};
  const Values signs = in.list("mode");
  if (signs.size() != 2) throw Refusal("invalid_argument");
  return {.left = sign(signs[0]), .right = sign(signs[1])};
}

int branch(const Inputs& in) {
  return sign(in.number_or("branch", 1.0));
}

Vector2 position(const Inputs& in) {
  return {in.number("x"), in.number("y")};
}

Vector2 angles(const Inputs& in) {
  return {in.number("theta1_rad"), in.number("theta2_rad")};
}

void refuse_unless_closed(SolveStatus status) {
  if (status != SolveStatus::reached && status != SolveStatus::degraded) throw Refusal(to_string(status));
}

Vector2 inverse(const Inputs& in) {
  const FiveBarInverse answer = five_bar_inverse(geometry(in), position(in), mode(in));
  refuse_unless_closed(answer.status);
  return answer.theta;
}

Vector2 forward(const Inputs& in) {
  const FiveBarForward answer = five_bar_forward(geometry(in), angles(in), branch(in));
  refuse_unless_closed(answer.status);
  return answer.position;
}

// Of a tool position in a mode, of crank angles in a branch, or of both as they are given.
FiveBarState state(const Inputs& in) {
  if (!in.has("theta1_rad")) return {geometry(in), inverse(in), position(in)};
  return {geometry(in), angles(in), in.has("x") ? position(in) : forward(in)};
}

template <class T>
T regular(const std::optional<T>& value) {
  if (!value) throw Refusal("singular");
  return *value;
}

Values list(const Vector2& v) {
  return {v.x(), v.y()};
}
Values rows(const Matrix2& m) {
  return {m(0, 0), m(0, 1), m(1, 0), m(1, 1)};
}
Values yes_or_no(bool value) {
  return {value ? 1.0 : 0.0};
}

constexpr double kDegree = std::numbers::pi / 180.0;

PolarSampling sampling(const Inputs& in) {
  return {.radius_step = in.number("radius_step_cm"),
          .angle_step = in.number("angle_step_deg") * kDegree,
          .angle_span = in.number_or("angle_span_deg", 360.0) * kDegree};
}

LengthRange range(const Inputs& in, const std::string& key) {
  const Values ends = in.list(key);
  return ends.size() == 1 ? LengthRange{ends[0], ends[0], 0.0}
                          : LengthRange{ends.at(0), ends.at(1), ends.at(2)};
}

FiveBarSearchResult search(const Inputs& in) {
  const bool one = in.has("half_base_cm");
  FiveBarSearch search{.crank = range(in, "a1_cm"),
                       .coupler = range(in, "a2_cm"),
                       .base = range(in, one ? "half_base_cm" : "a3_cm"),
                       .base_is_half = one || !in.has("a3_meaning") || in.text("a3_meaning") == "half base",
                       .sampling = sampling(in),
                       .mode = mode(in),
                       .limit = in.number_or("limit", 5.0),
                       .count_singular = in.has("count_singular") && in.flag("count_singular")};
  if (!one && !search.base_is_half && in.text("a3_meaning") != "full base") throw Refusal("invalid_argument");
  return search_five_bars(search);
}

FiveBarScore only(const Inputs& in) {
  const double base = in.has("half_base_cm") ? in.number("half_base_cm") : in.number("a3_cm");
  checked({in.number("a1_cm"), in.number("a2_cm"), base});
  const FiveBarSearchResult result = search(in);
  return result.designs.empty() ? FiveBarScore{} : result.designs.front();
}

FiveBarScore selected(const Inputs& in) {
  const FiveBarSearchResult result = search(in);
  if (!result.selected) throw Refusal("invalid_argument");
  return result.designs[*result.selected];
}

Values count(std::int64_t value) {
  return {static_cast<double>(value)};
}

}  // namespace

void add_five_bar(Quantities& q) {
  q["fivebar.ik"] = [](const Inputs& in) { return list(inverse(in)); };
  q["fivebar.ik_all"] = [](const Inputs& in) {
    const FiveBarSolutions all = five_bar_inverse_all(geometry(in), position(in));
    refuse_unless_closed(all.status);
    Values values;
    for (int s = 0; s < all.count; ++s) values.insert(values.end(), {all.theta[s][0], all.theta[s][1]});
    return values;
  };
  q["fivebar.ik_solution_count"] = [](const Inputs& in) {
    const FiveBarSolutions all = five_bar_inverse_all(geometry(in), position(in));
    if (all.status == SolveStatus::degenerate) throw Refusal("degenerate");
    return count(all.count);
  };
  q["fivebar.fk"] = [](const Inputs& in) { return list(forward(in)); };
  q["fivebar.fk_solution_count"] = [](const Inputs& in) {
    const std::optional<int> solutions = five_bar_forward_count(geometry(in), angles(in));
    if (!solutions) throw Refusal("degenerate");
    return count(*solutions);
  };

  q["fivebar.jp"] = [](const Inputs& in) { return rows(state(in).jacobian_p()); };
  q["fivebar.jtheta"] = [](const Inputs& in) { return list(state(in).jacobian_theta()); };
  q["fivebar.jtheta_diagonal"] = [](const Inputs& in) {
    return Values{state(in).jacobian_theta()[in.integer("leg") - 1]};
  };
  q["fivebar.det_jp"] = [](const Inputs& in) { return Values{state(in).det_p()}; };
  q["fivebar.jacobian"] = [](const Inputs& in) { return rows(regular(state(in).inverse_jacobian())); };
  q["fivebar.condition_number"] = [](const Inputs& in) {
    const double K = state(in).condition_number();
    if (std::isinf(K)) throw Refusal("singular");
    return Values{K};
  };
  q["fivebar.condition_class"] = [](const Inputs& in) -> Answer {
    const double K = in.has("K") ? in.number("K") : state(in).condition_number();
    return symbol(condition_class(K));
  };
  q["fivebar.torque_from_force"] = [](const Inputs& in) {
    const Values f = in.list("f");
    const FiveBarState at = state(in);
    regular(at.inverse_jacobian());  // tau = J^-T f with the source's J
    return list(regular(at.torque_from_force({f.at(0), f.at(1)})));
  };
  q["fivebar.force_ellipse"] = [](const Inputs& in) {
    const Ellipse ellipse = regular(state(in).force_ellipse());
    return Values{ellipse.major, ellipse.minor, ellipse.direction};
  };

  q["fivebar.elbows_can_coincide"] = [](const Inputs& in) {
    return yes_or_no(avoidance_conditions(geometry(in)).elbows_can_coincide);
  };
  q["fivebar.couplers_can_align"] = [](const Inputs& in) {
    return yes_or_no(avoidance_conditions(geometry(in)).couplers_can_align);
  };
  q["fivebar.mic"] = [](const Inputs& in) {
    const auto circle = inscribed_circle({in.number("a1"), in.number("a2"), in.number("half_base")});
    if (!circle) throw Refusal("invalid_argument");
    return Values{circle->radius, circle->centre_y};
  };
  q["fivebar.normalised_lengths"] = [](const Inputs& in) {
    const FiveBarGeometry r =
        normalised_lengths(checked({in.number("a1_cm"), in.number("a2_cm"), in.number("a3_cm")}));
    return Values{r.crank, r.coupler, r.half_base};
  };

  q["fivebar.count_above"] = [](const Inputs& in) { return count(only(in).bad); };
  q["fivebar.reachable_count"] = [](const Inputs& in) { return count(only(in).reachable); };
  q["fivebar.optimum_set"] = [](const Inputs& in) {
    const FiveBarSearchResult result = search(in);
    Values values;
    for (const std::size_t d : result.optimum) {
      const auto& lengths = result.designs[d].lengths;
      values.insert(values.end(), lengths.begin(), lengths.end());
    }
    return values;
  };
  q["fivebar.optimum_count"] = [](const Inputs& in) { return count(selected(in).bad); };
  q["fivebar.optimum_a3"] = [](const Inputs& in) { return Values{selected(in).lengths[2]}; };
  q["fivebar.selected_design"] = [](const Inputs& in) {
    const auto lengths = selected(in).lengths;
    return Values(lengths.begin(), lengths.end());
  };
}

}  // namespace zwidth::reference
