#!/usr/bin/env python3
"""Writes tests/data/five-bar-more.json: cases of the five-bar by a route of their own.

    tests/oracle/five_bar_cases.py > tests/data/five-bar-more.json

Standard library only, and nothing of the formulas in src/: points are complex numbers, legs are intersections of
two circles, matrices are worked out in decimals of 50 digits.
"""

import cmath
import json
import math
import random
import sys
from decimal import Decimal, getcontext

getcontext().prec = 50
CASES = []


def circles(c1, R1, c2, R2):
    """Intersections of two circles: the one to the left of c1 -> c2, then the one to its right."""
    d = abs(c2 - c1)
    if d == 0:
        raise ValueError("degenerate")
    along = (d * d + R1 * R1 - R2 * R2) / (2 * d)
    across2 = R1 * R1 - along * along
    if across2 < -1e-13 * R1 * R1:
        raise ValueError("unreachable")
    across = math.sqrt(max(across2, 0.0))
    u = (c2 - c1) / d
    return c1 + u * complex(along, across), c1 + u * complex(along, -across)


def elbow(r, p, leg, sign):
    r1, r2, r3 = r
    O = -r3 if leg == 0 else r3
    if abs(p - O) < 1e-13 * sum(r):
        raise ValueError("degenerate" if r1 == r2 else "unreachable")
    left, right = circles(complex(O), r1, p, r2)
    return left if sign > 0 else right  # counter-clockwise of O -> C


def inverse(r, p, mode):
    r3 = r[2]
    found, problems = [], []
    for leg in (0, 1):
        try:
            B = elbow(r, p, leg, mode[leg])
            found.append(cmath.phase(B - (-r3 if leg == 0 else r3)))
        except ValueError as problem:
            problems.append(str(problem))
    if problems:
        raise ValueError("unreachable" if "unreachable" in problems else "degenerate")
    return found


def forward(r, theta, branch):
    r1, r2, r3 = r
    B1, B2 = -r3 + cmath.rect(r1, theta[0]), r3 + cmath.rect(r1, theta[1])
    if abs(B1 - B2) < 1e-13 * sum(r):
        raise ValueError("degenerate")
    left, right = circles(B1, r2, B2, r2)
    return left if branch > 0 else right


def matrices(r, p, theta):
    """Jp by rows and the diagonal of Jtheta, as printed."""
    r1, r2, r3 = r
    x, y = p.real, p.imag
    c, s = [math.cos(t) for t in theta], [math.sin(t) for t in theta]
    Jp = [[x - r1 * c[0] + r3, y - r1 * s[0]], [x - r1 * c[1] - r3, y - r1 * s[1]]]
    return Jp, [r1 * (y * c[0] - (x + r3) * s[0]), r1 * (y * c[1] + (r3 - x) * s[1])]


def source_jacobian(r, p, theta):
    Jp, Jt = matrices(r, p, theta)
    return [[v / t for v in row] for row, t in zip(Jp, Jt)]


def eigen(J):
    """Eigenvalues, larger first, of J^T J, and the direction of the first vector in [0, pi)."""
    a, b, c, d = (Decimal(v) for row in J for v in row)
    m00, m01, m11 = a * a + c * c, a * b + c * d, b * b + d * d
    trace, det = m00 + m11, (a * d - b * c) ** 2
    root = (trace * trace - 4 * det).sqrt()
    large = (trace + root) / 2
    small = det / large
#(J ^ T J - large) v = 0, by the row that is further from zero.
    rows = [(m00 - large, m01), (m01, m11 - large)]
    row = max(rows, key=lambda q: abs(q[0]) + abs(q[1]))
    return large, small, math.atan2(float(row[0]), float(-row[1])) % math.pi


def condition_number(J):
    large, small, _ = eigen(J)
    return float((large / small).sqrt())


def add(quantity, inputs, value, tolerance, note=""):
    CASES.append({"id": f"fivebar.more.{len(CASES) + 1}", "source": "tests/oracle/five_bar_cases.py",
                  "quantity": f"fivebar.{quantity}", "inputs": inputs, "value": value, "tolerance": tolerance,
                  "note": note})


def lengths(r):
    return {"r1": r[0], "r2": r[1], "r3": r[2]}


def posture_cases(draw, r, p, mode):
    place = {**lengths(r), "x": p.real, "y": p.imag, "mode": mode}
    try:
        theta = inverse(r, p, mode)
    except ValueError as problem:
        for quantity in ("ik", "condition_number", "jacobian"):
            add(quantity, place, f"error:{problem}", 0)
        return
    size = sum(r)
    Jp, Jt = matrices(r, p, theta)
    det = Jp[0][0] * Jp[1][1] - Jp[0][1] * Jp[1][0]
    if min(abs(t) for t in Jt) < 1e-3 * r[0] * r[1] or abs(det) < 1e-3 * r[1] ** 2:
        return  # rounding is amplified beyond the tolerances below
    J = source_jacobian(r, p, theta)
    scale = max(abs(v) for row in J for v in row)
    inv = 1 / (J[0][0] * J[1][1] - J[0][1] * J[1][0])
    force = [round(draw.uniform(-3, 3), 2), round(draw.uniform(-3, 3), 2)]
#J ^ T tau = f by Cramer.
    tau = [(force[0] * J[1][1] - force[1] * J[1][0]) * inv, (force[1] * J[0][0] - force[0] * J[0][1]) * inv]
    large, small, direction = eigen(J)
    K = condition_number(J)
    everything = [
        ("ik", place, theta, 1e-10),
        ("jp", place, Jp, 1e-10 * size),
        ("jtheta", place, Jt, 1e-10 * size * size),
        ("jtheta_diagonal", {**place, "leg": 2}, Jt[1], 1e-10 * size * size),
        ("det_jp", place, det, 1e-10 * size * size),
        ("jacobian", place, J, 1e-7 * scale),
        ("condition_number", place, K, 1e-7 * K),
        ("torque_from_force", {**place, "f": force}, tau, 1e-7 * max(map(abs, tau))),
        ("force_ellipse", place, [float(large.sqrt()), float(small.sqrt()), direction], 1e-7 * scale),
        ("ik_solution_count", place, 4, 0),
        ("ik_all", place, sorted(inverse(r, p, [a, b]) for a in (-1, 1) for b in (-1, 1)), 1e-10),
    ]
    if K > 1.05:  # the ellipse has a direction
        for one in draw.sample(everything, 3):
            add(*one)
    branch = 1 if forward_matches(r, theta, p) else -1
    add("fk", {**lengths(r), "theta1_rad": theta[0], "theta2_rad": theta[1], "branch": branch}, [p.real, p.imag],
        1e-9 * size)


def forward_matches(r, theta, p):
    return abs(forward(r, theta, 1) - p) < abs(forward(r, theta, -1) - p)


def random_postures(draw):
    designs = [(10.0, 15.0, 3.0), (1.2, 1.0, 0.8), (0.8, 1.2, 1.0), (0.06, 0.09, 0.04), (1.0, 1.0, 0.4)]
    designs += [tuple(round(draw.uniform(0.4, 1.6), 3) for _ in range(3)) for _ in range(9)]
    for r in designs:
        if r[2] >= r[0] + r[1]:
            continue
        for _ in range(4):
            p = cmath.rect(draw.uniform(0.2, 0.95) * (r[0] + r[1]), draw.uniform(-math.pi, math.pi))
            p = complex(round(p.real, 4), round(p.imag, 4))
            posture_cases(draw, r, p, [draw.choice((-1, 1)), draw.choice((-1, 1))])


def forward_cases(draw):
    for _ in range(24):
        r = tuple(round(draw.uniform(0.4, 1.6), 3) for _ in range(3))
        theta = [round(draw.uniform(-math.pi, math.pi), 4) for _ in range(2)]
        inputs = {**lengths(r), "theta1_rad": theta[0], "theta2_rad": theta[1]}
        B1, B2 = -r[2] + cmath.rect(r[0], theta[0]), r[2] + cmath.rect(r[0], theta[1])
        if r[2] >= r[0] + r[1] or abs(abs(B1 - B2) - 2 * r[1]) < 1e-3:
            continue
        branch = draw.choice((-1, 1))
        try:
            p = forward(r, theta, branch)
        except ValueError as problem:
            add("fk", {**inputs, "branch": branch}, f"error:{problem}", 0)
            add("fk_solution_count", inputs, 0, 0)
            continue
        add("fk", {**inputs, "branch": branch}, [p.real, p.imag], 1e-9)
        add("fk_solution_count", inputs, 2, 0)


def special_cases():
    selected, equal = (10.0, 15.0, 3.0), (1.0, 1.0, 0.25)
#Elbows above each other : the source's elimination divides by zero, nothing is singular.
    theta = [math.acos(0.3), math.pi - math.acos(0.3)]
    vertical = {**lengths((1.0, 1.0, 0.6)), "theta1_rad": math.pi / 3, "theta2_rad": -math.acos(-0.7)}
    B1, B2 = -0.6 + cmath.rect(1.0, math.pi / 3), 0.6 + cmath.rect(1.0, -math.acos(-0.7))
    assert abs(B1.real - B2.real) < 1e-12 and abs(B1 - B2) < 2
    for branch in (1, -1):
        p = forward((1.0, 1.0, 0.6), [vertical["theta1_rad"], vertical["theta2_rad"]], branch)
        add("fk", {**vertical, "branch": branch}, [p.real, p.imag], 1e-9, "elbows above each other: q = 0")
    coincide = {**lengths(selected), "theta1_rad": theta[0], "theta2_rad": theta[1], "branch": 1}
    add("fk", coincide, "error:degenerate", 0, "elbows coincide")
#Cranks stretched apart, couplers flat : 2 r3 + 2 r1 = 2 r2.
    flat = {**lengths((1.0, 1.5, 0.5)), "theta1_rad": math.pi, "theta2_rad": 0.0}
    add("fk", {**flat, "branch": 1}, [0.0, 0.0], 1e-7, "couplers aligned, both roots coincide")
    add("fk_solution_count", flat, 1, 0, "couplers aligned")
    add("fk", {**flat, "r2": 1.4, "branch": 1}, "error:unreachable", 0)
#Boundary circles.
    for p, note in ((22.0, "left leg stretched"), (8.0, "right leg folded"), (-8.0, "left leg folded")):
        place = {**lengths(selected), "x": p, "y": 0.0}
        add("jacobian", {**place, "mode": [1, -1]}, "error:singular", 0, note)
        add("condition_number", {**place, "mode": [1, -1]}, "error:singular", 0, note)
        add("force_ellipse", {**place, "mode": [1, -1]}, "error:singular", 0, note)
        add("ik_solution_count", place, 2, 0, note)
    add("ik_solution_count", {**lengths(selected), "x": 0.0, "y": 4.0}, 1, 0, "both legs folded")
    add("ik", {**lengths(selected), "x": 22.0, "y": 0.0, "mode": [1, -1]},
        inverse(selected, complex(22.0), [1, -1]), 1e-9, "left leg stretched")
    add("ik_solution_count", {**lengths(selected), "x": 0.0, "y": 25.0}, 0, 0, "out of reach")
#A tool on a motor axis.
    for mode in ([1, -1], [-1, 1]):
        add("ik", {**lengths(equal), "x": -0.25, "y": 0.0, "mode": mode}, "error:degenerate", 0, "tool on O1, r1 = r2")
        add("ik", {**lengths((1.0, 0.9, 0.25)), "x": 0.25, "y": 0.0, "mode": mode}, "error:unreachable", 0,
            "tool on O2, r1 and r2 differ")
    add("ik", {**lengths((1.0, 1.0, 1.25)), "x": -1.25, "y": 0.0, "mode": [1, -1]}, "error:unreachable", 0,
        "tool on O1, out of the right leg's reach")
#Couplers aligned at a regular pose of the legs.
    r = (1.0, 1.25, 0.5)
    B = [complex(-1.25, math.sqrt(1 - 0.75 ** 2)), complex(1.25, math.sqrt(1 - 0.75 ** 2))]
    p = (B[0] + B[1]) / 2
    theta = [cmath.phase(B[0] + 0.5), cmath.phase(B[1] - 0.5)]
    place = {**lengths(r), "x": p.real, "y": p.imag, "theta1_rad": theta[0], "theta2_rad": theta[1]}
    add("det_jp", place, 0.0, 1e-12, "couplers aligned")
    add("torque_from_force", {**place, "f": [1.0, 0.5]}, "error:singular", 0, "couplers aligned")
    add("condition_number", place, "error:singular", 0, "couplers aligned")
#Impossible lengths.
    for r in ((0.0, 1.0, 0.5), (1.0, -1.0, 0.5), (1.0, 1.0, 0.0), (1.0, 1.0, 2.0), (0.5, 0.4, 1.2)):
        add("ik", {**lengths(r), "x": 0.1, "y": 0.9, "mode": [1, -1]}, "error:invalid_argument", 0)
        add("fk", {**lengths(r), "theta1_rad": 1.0, "theta2_rad": 2.0, "branch": 1}, "error:invalid_argument", 0)
    add("elbows_can_coincide", lengths((0.0, 1.0, 0.5)), "error:invalid_argument", 0)
    add("mic", {"a1": 10.0, "a2": 15.0, "half_base": 25.0}, "error:invalid_argument", 0)
    add("mic", {"a1": 1.0, "a2": 1.5, "half_base": 1.6}, "error:invalid_argument", 0, "no circle on the y axis")


def design_cases(draw):
    for _ in range(10):
        r = tuple(round(draw.uniform(0.3, 1.7), 2) for _ in range(3))
        if r[2] >= r[0] + r[1]:
            continue
#By sampling the two cranks all round, which the conditions must agree with.
        apart = [abs(2 * r[2] + cmath.rect(r[0], a * math.pi / 90) - cmath.rect(r[0], b * math.pi / 90))
                 for a in range(180) for b in range(180)]
        step = 0.1 * r[0]
        if abs(r[2] - r[0]) > step:
            add("elbows_can_coincide", lengths(r), min(apart) < step, 0)
        if min(abs(max(apart) - 2 * r[1]), abs(min(apart) - 2 * r[1])) > step:
            add("couplers_can_align", lengths(r), min(apart) <= 2 * r[1] <= max(apart), 0)
    for a in ((10.0, 15.0, 3.0), (15.0, 10.0, 3.0), (9.0, 14.0, 3.0), (1.2, 1.0, 0.8), (7.0, 7.0, 2.0)):
#Tangency : the circle's far and near points lie on both boundary circles of O1.
        low, high = 0.0, sum(a)
        for _ in range(200):  # height at which the distance from O1 is the middle of the annulus
            mid = (low + high) / 2
            low, high = (mid, high) if math.hypot(a[2], mid) < (a[0] + a[1] + abs(a[0] - a[1])) / 2 else (low, mid)
        radius = (a[0] + a[1] - abs(a[0] - a[1])) / 2
        add("mic", {"a1": a[0], "a2": a[1], "half_base": a[2]}, [radius, low], 1e-9)
        add("normalised_lengths", {"a1_cm": a[0], "a2_cm": a[1], "a3_cm": a[2]}, [3 * v / sum(a) for v in a], 1e-12)
    for K, name in ((1.0, "plus"), (4.9999, "plus"), (5.0, "asterisk"), (10.0, "asterisk"), (10.001, "square"),
                    (100.0, "square"), (100.01, "diamond"), (1e9, "diamond")):
        add("condition_class", {"K": K}, name, 0)


def polar_points(reach, radius_step, angle_step, span):
    angles = int(round(span / angle_step)) + (0 if span == 360.0 else 1)
    for k in range(1, int(math.floor(reach / radius_step + 1e-9)) + 1):
        for j in range(angles):
            yield cmath.rect(k * radius_step, math.radians(j * angle_step))


def count(r, sampling, mode, limit, count_singular):
    above = reachable = 0
    nearest = math.inf
    for p in polar_points(r[0] + r[1], *sampling):
        try:
            theta = inverse(r, p, mode)
        except ValueError:
            continue
        reachable += 1
        Jp, Jt = matrices(r, p, theta)
        S = sum(v * v for v in Jp[0]) * Jt[1] ** 2 + sum(v * v for v in Jp[1]) * Jt[0] ** 2
        delta = abs(Jt[0] * Jt[1] * (Jp[0][0] * Jp[1][1] - Jp[0][1] * Jp[1][0]))
        limits = [(r[0] ** 2 + abs(p - O) ** 2 - r[1] ** 2) / (2 * r[0] * abs(p - O)) for O in (-r[2], r[2])]
        if delta <= 1e-12 * S or any(abs(abs(c) - 1) <= 1e-9 for c in limits):
            above += count_singular
            continue
        K = (S + math.sqrt(max(S * S - 4 * delta * delta, 0.0))) / (2 * delta)
        nearest = min(nearest, abs(K - limit))
        above += K > limit
    return above, reachable, nearest


def steps(first, last, step):
    return [first + i * step for i in range(int(round((last - first) / step)) + 1)]


def search_cases():
    base = {"radius_step_cm": 1.0, "angle_step_deg": 4.0, "angle_span_deg": 360.0, "mode": [1, -1], "limit": 5.0,
            "count_singular": False}
    for a, change in (((10, 15, 3), {}), ((9, 14, 3), {"angle_span_deg": 180.0}), ((8, 11, 2.5), {"mode": [-1, 1]}),
                      ((10, 15, 3), {"mode": [1, 1], "limit": 10.0}), ((12, 7, 4), {"limit": 3.0}),
                      ((10, 15, 3), {"count_singular": True, "limit": 20.0}), ((6, 6, 2), {"radius_step_cm": 0.5})):
        s = {**base, **change}
        sampling = (s["radius_step_cm"], s["angle_step_deg"], s["angle_span_deg"])
        above, reachable, nearest = count(a, sampling, s["mode"], s["limit"], s["count_singular"])
        assert nearest > 1e-6
        inputs = {"a1_cm": a[0], "a2_cm": a[1], "half_base_cm": a[2], **s}
        add("count_above", inputs, above, 0)
        add("reachable_count", inputs, reachable, 0)
    for ranges, meaning, change in (([[9, 10, 1], [13, 15, 1], [3, 4, 1]], "half base", {}),
                                    ([[9, 10, 0.5], [14, 15, 1], [3, 3, 1]], "half base", {"angle_span_deg": 180.0}),
                                    ([[9, 10, 1], [14, 15, 1], [3, 5, 1]], "full base", {"mode": [-1, 1]})):
        s = {**base, **change}
        sampling = (s["radius_step_cm"], s["angle_step_deg"], s["angle_span_deg"])
        scores = {}
        for a1 in steps(*ranges[0]):
            for a2 in steps(*ranges[1]):
                for a3 in steps(*ranges[2]):
                    half = a3 if meaning == "half base" else a3 / 2
                    scores[a1, a2, a3] = count((a1, a2, half), sampling, s["mode"], s["limit"], False)[0]
        best = min(scores.values())
        winners = sorted(d for d, score in scores.items() if score == best)
        widest = max(min(d[0], d[1]) for d in winners)
        inputs = {"a1_cm": ranges[0], "a2_cm": ranges[1], "a3_cm": ranges[2], "a3_meaning": meaning, **s}
        add("optimum_set", inputs, [list(d) for d in winners], 0)
        add("optimum_count", inputs, best, 0)
        selected = [d for d in winners if min(d[0], d[1]) == widest]
        if len(selected) == 1:
            add("selected_design", {**inputs, "tie_break": "largest r_MIC = min(a1, a2)"}, list(selected[0]), 0)
            add("optimum_a3", inputs, selected[0][2], 0)


def main():
    draw = random.Random(5)
    random_postures(draw)
    forward_cases(draw)
    special_cases()
    design_cases(draw)
    search_cases()
    out = ",\n".join(" " + json.dumps(case) for case in CASES)
    sys.stdout.write(f"[\n{out}\n]\n")


if __name__ == "__main__":
    main()
