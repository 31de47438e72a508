#!/usr/bin/env python3
"""Writes tests/data/pneumatic-further.json: cases of the pneumatic devices by a route of their own.

    tests/oracle/pneumatic_cases.py > tests/data/pneumatic-further.json

Standard library only, and nothing of the formulas in src/: pins are complex numbers, levers are moments of forces
or complex-step derivatives, designs come from bisection or from two-circle constructions, poses from products of
4 x 4 matrices, and inverse kinematics from intersecting circles.
"""

import cmath
import json
import math
import random
import sys

ANY = random.Random(20170701)
CASES = []
ATMOSPHERE = 101325.0
ITV = (1e3, 500e3, 10.0)
LAYOUTS = ("one", "two", "two_mod", "three")
SET_A = dict(l0_m=0.150, l1_m=0.110, l2_m=0.028, l3_m=0.040)
A1, A2 = 0.105 * 0.0254**2, 0.093 * 0.0254**2


def add(quantity, inputs, value, unit, tolerance, note=""):
    number = sum(case["quantity"] == quantity for case in CASES)
    CASES.append(dict(id=f"pn.f.{quantity}.{number}", source="computed independently", quantity=quantity,
                      inputs=inputs, value=value, unit=unit, tolerance=tolerance, note=note))


def up(low, high):
    return ANY.uniform(low, high)


# ------------------------------------------------------------------------------------------- cylinder in an arm

def pins(config, l):
    """Base pin, and arm pin at angle zero, as complex numbers."""
    if config == "one":
        return complex(0, -l["l1_m"]), complex(l["l2_m"])
    if config == "two":
        return complex(l["l0_m"], -l["l1_m"]), complex(l["l2_m"])
    if config == "two_mod":
        return complex(l["l0_m"], l["l1_m"]), complex(l["l2_m"])
    return complex(-l["l2_m"], l["h_m"]), complex(l["l0_m"], l["l1_m"])


def linkage(config):
    l = dict(l1_m=up(0.05, 0.3), l2_m=up(0.02, 0.14))
    if config != "one":
        l["l0_m"] = up(-0.08, 0.08)
    if config == "three":
        l = dict(l0_m=up(-0.03, 0.03), l1_m=up(0.01, 0.12), l2_m=up(0.05, 0.26), h_m=up(-0.1, 0.1))
    return l


def length(config, l, t):
    base, arm = pins(config, l)
    return abs(arm * cmath.exp(1j * t) - base)


def lever(config, l, t):
    """Moment about the pivot of a unit push at the arm pin."""
    base, arm = pins(config, l)
    tip = arm * cmath.exp(1j * t)
    along = (tip - base) / abs(tip - base)
    return tip.real * along.imag - tip.imag * along.real


def phi(config, l, t):
    """Angle of the cylinder as the source measures it: from the vertical, in `three` from the horizontal."""
    base, arm = pins(config, l)
    c = arm * cmath.exp(1j * t) - base
    if config in ("one", "two"):
        return math.atan2(c.real, c.imag)
    if config == "two_mod":
        return math.atan2(c.real, -c.imag)
    return math.atan2(c.imag, c.real)


def required(config, l, t, F, lF):
    return abs(F * lF * math.cos(t) / lever(config, l, t))


def bisect(f, a, b):
    fa = f(a)
    for _ in range(200):
        m = 0.5 * (a + b)
        fm = f(m)
        if fa * fm <= 0:
            b = m
        else:
            a, fa = m, fm
    return 0.5 * (a + b)


def nearest_angle(config, l, d):
    """Root of the length nearest to zero: walk outwards, then bisect."""
    f = lambda t: length(config, l, t) - d
    step = 1e-3
    n = 0
    while n * step < math.pi:
        for side in (1, -1):
            a, b = side * n * step, side * (n + 1) * step
            if f(a) * f(b) <= 0:
                return bisect(f, a, b)
        n += 1
    return None


for config in LAYOUTS:
    for _ in range(5):
        l, t = linkage(config), up(-1.2, 1.2)
        case = dict(config=config, theta_rad=t, **l)
        load = dict(F_N=up(5, 60), lF_m=up(0.1, 0.6))
        torque = up(-2, 2)
        add("actuator_length", case, length(config, l, t), "m", 1e-12)
        add("actuator_length_rate", case, lever(config, l, t), "m/rad", 1e-12)
        add("phi", case, phi(config, l, t), "rad", 1e-10)
        if abs(lever(config, l, t)) > 1e-3:
            add("required_actuator_force", dict(case, **load), required(config, l, t, **{
                "F": load["F_N"], "lF": load["lF_m"]}), "N", 1e-8)
            add("push_force_for_torque", dict(case, T_Nm=torque), torque / lever(config, l, t), "N", 1e-8)
        d = length(config, l, up(-0.6, 0.6))
        add("theta_of_length", dict(config=config, d_m=d, **l), nearest_angle(config, l, d), "rad", 1e-9)
    l = linkage(config)
    base, arm = pins(config, l)
    for d in (1.01 * (abs(base) + abs(arm)), 0.99 * abs(abs(base) - abs(arm))):
        add("theta_of_length", dict(config=config, d_m=d, **l), "error:length_unreachable", "", 0)
    dead = cmath.phase(base) - cmath.phase(arm)  # pivot and pins in one line
    add("push_force_for_torque", dict(config=config, theta_rad=dead, T_Nm=1.0, **l), "error:dead_point", "", 0)
    add("required_actuator_force", dict(config=config, theta_rad=dead, F_N=25, lF_m=0.3, **l), "error:dead_point", "", 0)
    add("actuator_length", dict(config=config, theta_rad=0.1, **dict(l, l2_m=-l["l2_m"])), "error:invalid_argument", "", 0)
add("theta_of_length", dict(config="one", d_m=-0.1, l1_m=0.25, l2_m=0.13), "error:invalid_argument", "", 0)


# ------------------------------------------------------------------------------------------------ synthesis

def travel():
    dmin = up(0.05, 0.3)
    return dict(dmin_m=dmin, dmax_m=dmin * up(1.08, 1.6), theta_max_rad=math.radians(up(12, 70)))


def pins_of_arms(a, b, d, config_angle):
    """Angle at the pivot between arms a and b whose ends are d apart (law of cosines)."""
    return math.acos((a * a + b * b - d * d) / (2 * a * b))


def span(a, b, tr):
    """By how much the angle between arms a and b changes over the stroke."""
    try:
        return pins_of_arms(a, b, tr["dmax_m"], 0) - pins_of_arms(a, b, tr["dmin_m"], 0)
    except ValueError:
        return None


def spread_twice(a, b, tr):
    s = span(a, b, tr)
    return None if s is None else s - 2 * tr["theta_max_rad"]


def layout_one(tr):
    """l1, l2 with the base pin straight below: the angle at the pivot is 90 deg + theta."""
    tm = tr["theta_max_rad"]
    # The law of cosines at both ends gives the product; then the sum of squares; solve x^2 by bisection.
    p = (tr["dmax_m"]**2 - tr["dmin_m"]**2) / (4 * math.sin(tm))
    q = (tr["dmax_m"]**2 + tr["dmin_m"]**2) / 2
    if q < 2 * p:
        return None
    f = lambda x: x * x + (p / x) ** 2 - q
    root = math.sqrt(p)
    return bisect(f, root, math.sqrt(q) * 2)


for _ in range(8):
    tr = travel()
    l1 = layout_one(tr)
    if l1 is None:
        add("design_one", tr, "error:infeasible_design", "", 0)
    else:
        p = (tr["dmax_m"]**2 - tr["dmin_m"]**2) / (4 * math.sin(tr["theta_max_rad"]))
        add("design_one", tr, dict(l1_m=l1, l2_m=p / l1), "m", 1e-11)
for tr in (dict(dmin_m=0.1, dmax_m=0.25, theta_max_rad=0.17), dict(dmin_m=0.05, dmax_m=0.1, theta_max_rad=0.3)):
    add("design_one", tr, "error:infeasible_design", "", 0)
for tr in (dict(dmin_m=0.2, dmax_m=0.1, theta_max_rad=0.4), dict(dmin_m=0.1, dmax_m=0.2, theta_max_rad=1.6),
           dict(dmin_m=-0.1, dmax_m=0.2, theta_max_rad=0.4), dict(dmin_m=0.1, dmax_m=0.2, theta_max_rad=0.0)):
    add("design_one", tr, "error:invalid_argument", "", 0)


def base_pins(arm, tr):
    """Points at dmin from the arm pin at -theta_m and at dmax from it at +theta_m: two circles."""
    tm = tr["theta_max_rad"]
    c1, c2 = arm * cmath.exp(-1j * tm), arm * cmath.exp(1j * tm)
    R1, R2 = tr["dmin_m"], tr["dmax_m"]
    apart = abs(c2 - c1)
    along = (apart**2 + R1**2 - R2**2) / (2 * apart)
    across2 = R1**2 - along**2
    if across2 < 0:
        return None
    u = (c2 - c1) / apart
    return [c1 + u * complex(along, s * math.sqrt(across2)) for s in (-1, 1)]


for n in range(10):
    tr = travel()
    least = (tr["dmax_m"] - tr["dmin_m"]) / (2 * math.sin(tr["theta_max_rad"]))
    most = (tr["dmax_m"] + tr["dmin_m"]) / (2 * math.sin(tr["theta_max_rad"]))
    l2 = least + (most - least) * up(0.02, 0.9)
    found = sorted(base_pins(complex(l2), tr), key=lambda z: z.real)
    for root, pin in zip((-1, 1), found):
        add("design_two", dict(tr, l2_m=l2, root=root), dict(l0_m=pin.real, l1_m=-pin.imag), "m", 1e-11)
    if n < 3:
        add("design_two", dict(tr, l2_m=0.98 * least, root=1), "error:infeasible_design", "", 0)
        add("design_two", dict(tr, l2_m=1.02 * most, root=-1), "error:infeasible_design", "", 0)
    if n < 6:
        # The circles touch: the pin lies on the line through both centres, beyond the nearer one.
        arm = complex(least)
        c1 = arm * cmath.exp(-1j * tr["theta_max_rad"])
        pin = c1 + complex(0, -tr["dmin_m"])
        add("design_two_optimal", tr, dict(l0_m=pin.real, l1_m=-pin.imag, l2_m=least), "m", 1e-12)
add("design_two", dict(dmin_m=0.1, dmax_m=0.12, theta_max_rad=0.4, l2_m=-0.02, root=1), "error:invalid_argument", "", 0)


def layout_three(tr, h, l2):
    """Arm pins at dmax from the base pin at -theta_m and dmin at +theta_m: turn the base pin instead of the arm."""
    tm = tr["theta_max_rad"]
    base = complex(-l2, h)
    c1, c2 = base * cmath.exp(1j * tm), base * cmath.exp(-1j * tm)  # seen from the arm at -tm and +tm
    R1, R2 = tr["dmax_m"], tr["dmin_m"]
    apart = abs(c2 - c1)
    along = (apart**2 + R1**2 - R2**2) / (2 * apart)
    across2 = R1**2 - along**2
    if across2 < 0:
        return None
    u = (c2 - c1) / apart
    return sorted((c1 + u * complex(along, s * math.sqrt(across2)) for s in (-1, 1)), key=lambda z: z.real)


feasible = infeasible = 0
while feasible < 8 or infeasible < 3:
    tr, h, l2 = travel(), up(-0.05, 0.12), up(0.03, 0.4)
    found = layout_three(tr, h, l2)
    if found is None:
        if infeasible < 3:
            add("design_three", dict(tr, h_m=h, l2_m=l2, root=1), "error:infeasible_design", "", 0)
        infeasible += 1
    elif abs(found[0] - found[1]) > 1e-3 and feasible < 8:
        feasible += 1
        for root, pin in zip((-1, 1), found):
            add("design_three", dict(tr, h_m=h, l2_m=l2, root=root), dict(l0_m=pin.real, l1_m=pin.imag), "m", 1e-11)

for _ in range(4):
    stroke, tm, F, lF = up(0.01, 0.2), math.radians(up(10, 80)), up(1, 50), up(0.1, 0.5)
    # Work of the load over the range, per stroke.
    rise = lF * (math.sin(tm) - math.sin(-tm))
    add("minimum_peak_force", dict(stroke_m=stroke, theta_max_rad=tm, F_N=F, lF_m=lF), F * rise / stroke, "N", 1e-10)
add("minimum_peak_force", dict(stroke_m=0.0, theta_max_rad=0.4, F_N=1, lF_m=1), "error:invalid_argument", "", 0)

for config in LAYOUTS:
    for _ in range(2):
        l, tm, F, lF = linkage(config), up(8, 30), up(10, 40), up(0.2, 0.5)
        t = math.radians(tm)
        ends = [length(config, l, s * t) for s in (-1, 1)]
        add("stroke", dict(config=config, theta_max_deg=tm, **l), abs(ends[1] - ends[0]), "m", 1e-12)
        levers = [lever(config, l, -t + 2 * t * k / 4000) for k in range(4001)]
        if min(levers) * max(levers) > 0:
            peak = max(required(config, l, -t + 2 * t * k / 4000, F, lF) for k in range(4001))
            for share in (0.98, 1.02):
                add("peak_force_within_limit", dict(config=config, theta_max_deg=tm, F_N=F, lF_m=lF,
                                                    limit_N=share * peak, **l), share > 1, "-", 0)

# ----------------------------------------------------------------------------------------------- cylinder and air

for _ in range(5):
    a1 = up(50e-6, 300e-6)
    case = dict(P1_Pa=up(0, 7e5), P2_Pa=up(0, 7e5), A1_m2=a1, A2_m2=a1 * up(0.8, 0.95))
    add("cylinder_force", case, math.fsum([case["P1_Pa"] * a1, -case["P2_Pa"] * case["A2_m2"]]), "N", 1e-10)
add("cylinder_force", dict(P1_Pa=1e5, P2_Pa=0, A1_m2=0.0, A2_m2=1e-5), "error:invalid_argument", "", 0)
add("cylinder_force", dict(P1_Pa=-1.02e5, P2_Pa=0, A1_m2=2e-5, A2_m2=1e-5), "error:invalid_argument", "", 0)


def allocate(F, a1, a2, bias, top):
    """Search: the side against the force stays at the bias, the other carries on until the force balances."""
    against = bias
    P1 = (F + against * a2) / a1
    P2 = against
    if P1 < bias:
        P1, P2 = against, (against * a1 - F) / a2
    low = [min(max(p, 0.0), top) for p in (P1, P2)]
    return low[0], low[1], low != [P1, P2]


for n in range(10):
    a1 = up(50e-6, 300e-6)
    a2, bias, top = a1 * up(0.8, 0.95), up(5e3, 6e4), up(3e5, 7e5)
    F = up(-1.3, 1.3) * top * a1
    P1, P2, saturated = allocate(F, a1, a2, bias, top)
    add("allocate_pressures", dict(F_N=F, A1_m2=a1, A2_m2=a2, p_bias_Pa=bias, p_max_Pa=top),
        dict(P1_Pa=P1, P2_Pa=P2, saturated=saturated), "Pa", 1e-4)
add("allocate_pressures", dict(F_N=1.0, A1_m2=-1e-5, A2_m2=1e-5, p_bias_Pa=2e4, p_max_Pa=5e5), "error:invalid_argument", "", 0)
for u in (-1.0, 0.0, 2.5, 7.3, 10.0, 11.0):
    add("regulator_pressure", dict(u_V=u), ITV[0] + (ITV[1] - ITV[0]) * min(max(u / ITV[2], 0), 1), "Pa", 1e-6)


def flow(p1, p2, C, b, T, T0, rho0, lam):
    if p2 > p1:
        return -flow(p2, p1, C, b, T, T0, rho0, lam)
    r = p2 / p1
    curve = lambda x: 1.0 if x <= b else cmath.sqrt(1 - ((x - b) / (1 - b)) ** 2).real
    share = curve(r) if r <= lam else curve(lam) * (1 - r) / (1 - lam)
    return C * rho0 * p1 * (T0 / T) ** 0.5 * share


for p1, p2 in ((6e5, 1e5), (6e5, 3e5), (3e5, 2.9e5), (2e5, 1.9995e5), (1.01e5, 4e5), (3e5, 3e5)):
    rest = dict(C_m3_per_sPa=up(1e-10, 5e-10), b=up(0.15, 0.5), T_K=up(280, 310), T0_K=293.15, rho0_kgm3=1.185, r_lam=0.999)
    add("mdot_iso6358", dict(p1_Pa=p1, p2_Pa=p2, **rest), flow(p1, p2, *rest.values()), "kg/s", 1e-12)

add("newton_of_lbf", dict(lbf=1.96), 1.96 * 0.45359237 * 9.80665, "N", 1e-9)
add("metre_of_foot", dict(ft=2.25), 2.25 * 0.3048, "m", 1e-12)
for config in LAYOUTS:
    l, L, P = linkage(config), up(0.05, 0.3), up(2e5, 7e5)
    area = up(50e-6, 200e-6)
    add("max_vertical_force", dict(config=config, theta_rad=0.0, P1_Pa=P, A1_m2=area, L_m=L, **l),
        P * area * abs(lever(config, l, 0.0)) / L, "N", 1e-9)


# -------------------------------------------------------------------------------------------------------- arms

def product(rows):
    """Standard Denavit-Hartenberg rows (theta, d, a, alpha), each as four elementary matrices; complex numbers pass."""
    T = [[float(i == j) for j in range(4)] for i in range(4)]
    mul = lambda A, B: [[sum(A[i][k] * B[k][j] for k in range(4)) for j in range(4)] for i in range(4)]
    cos = lambda x: (cmath.cos(x) if isinstance(x, complex) else math.cos(x))
    sin = lambda x: (cmath.sin(x) if isinstance(x, complex) else math.sin(x))
    for theta, d, a, alpha in rows:
        c, s, ca, sa = cos(theta), sin(theta), cos(alpha), sin(alpha)
        for M in ([[c, -s, 0, 0], [s, c, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]],
                  [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, d], [0, 0, 0, 1]],
                  [[1, 0, 0, a], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]],
                  [[1, 0, 0, 0], [0, ca, -sa, 0], [0, sa, ca, 0], [0, 0, 0, 1]]):
            T = mul(T, M)
    return T


H = math.pi / 2


def rows1(q, l):
    return [(0, q[2], l["l1x_m"], 0), (q[0], 0, l["l2x_m"], 0), (q[1] - H, l["l3y_m"], l["l3x_m"], -H),
            (0, l["l3z_m"], 0, 0)]


def rows2(q, l):
    return [(q[0], 0, l["l1x_m"], 0), (q[1], l["l12y_m"], 0, H), (0, l["l2z_m"], l["l2x_m"], 0),
            (q[2], 0, l["lex_m"], 0)]


def rows3(q, l):
    return [(q[0], 0, l["l0_m"], 0), (q[1], 0, 0, H), (0, l["l1_m"], 0, 0), (q[2] + H, 0, 0, H),
            (0, l["l2_m"], 0, 0), (q[3], l["l3_m"], 0, -H), (q[4], 0, 0, 0)]


def jacobian(rows, q, l):
    """Complex steps: exact to rounding."""
    columns = []
    for j in range(len(q)):
        step = [complex(x, 1e-30 if i == j else 0.0) for i, x in enumerate(q)]
        T = product(rows(step, l))
        columns.append([complex(T[i][3]).imag / 1e-30 for i in range(3)])
    return [[columns[j][i] for j in range(len(q))] for i in range(3)]


def manipulability(J):
    G = [[sum(a * b for a, b in zip(J[i], J[j])) for j in range(3)] for i in range(3)]
    det = (G[0][0] * (G[1][1] * G[2][2] - G[1][2] * G[2][1]) - G[0][1] * (G[1][0] * G[2][2] - G[1][2] * G[2][0]) +
           G[0][2] * (G[1][0] * G[2][1] - G[1][1] * G[2][0]))
    return math.sqrt(max(det, 0.0))


def rotation(T):
    return [row[:3] for row in T[:3]]


for n in range(5):
    l = dict(l1x_m=up(0.05, 0.15), l2x_m=up(0.1, 0.3), l3x_m=up(0.005, 0.03), l3y_m=up(0.01, 0.05), l3z_m=up(0.2, 0.4))
    t, d, rates = [up(-1, 1), up(-1, 1)], up(0, 0.1), [up(-1, 1) for _ in range(3)]
    case, q = dict(theta_rad=t, d1z_m=d, **l), t + [d]
    T, J = product(rows1(q, l)), jacobian(rows1, q, l)
    add("proto1_transform", case, T, "- and m", 1e-12)
    add("proto1_jacobian", case, J, "m/rad", 1e-12)
    add("proto1_manipulability", case, manipulability(J), "m^2", 1e-12)
    if n < 2:
        add("proto1_rotation", dict(theta_rad=t), rotation(T), "-", 1e-12)
        add("proto1_position_YZ", case, [T[1][3], T[2][3]], "m", 1e-12)
        add("proto1_velocity", dict(case, rates=rates), [sum(J[i][j] * rates[j] for j in range(3)) for i in range(3)],
            "m/s", 1e-12)

for n in range(5):
    l = dict(l1x_m=up(0.08, 0.25), l12y_m=up(0.0, 0.2), l2z_m=up(-0.05, 0.05), l2x_m=up(0.05, 0.25), lex_m=up(0.05, 0.2))
    q = [up(-1, 1), up(-1.2, 1.2), up(-1.2, 1.2)]
    case = dict(theta_rad=q, **l)
    T, J = product(rows2(q, l)), jacobian(rows2, q, l)
    add("proto2_transform", case, T, "- and m", 1e-12)
    add("proto2_jacobian", case, J, "m/rad", 1e-12)
    if n < 2:
        add("proto2_rotation", dict(theta_rad=q), rotation(T), "-", 1e-12)
        add("proto2_position_XY", case, [T[0][3], T[1][3]], "m", 1e-12)


def arm3():
    return dict(l0_m=up(0.08, 0.2), l1_m=up(0.05, 0.15), l2_m=up(0.01, 0.05), l3_m=up(0.02, 0.06))


def inverse3(r, l):
    """Height by the arm's swing, then the elbow where two circles about the base axis and the tip meet."""
    L = l["l2_m"] + l["l3_m"]
    if abs(r[2]) > L:
        return None
    found = []
    for t3 in (math.asin(r[2] / L), math.pi - math.asin(r[2] / L)):
        forearm = complex(L * math.cos(t3), -l["l1_m"])  # from elbow to tip with theta1 + theta2 = 0
        tip, R1, R2 = complex(r[0], r[1]), l["l0_m"], abs(forearm)
        D = abs(tip)
        along = (D * D + R1 * R1 - R2 * R2) / (2 * D)
        if R1 * R1 < along * along:
            continue
        for side in (1, -1):
            elbow = tip / D * complex(along, side * math.sqrt(R1 * R1 - along * along))
            t1 = cmath.phase(elbow)
            t12 = cmath.phase((tip - elbow) / forearm)
            found.append([t1, t12 - t1, t3])
    return found or None


for n in range(6):
    l = arm3()
    q = [up(-0.8, 0.8), up(-0.9, 0.9), up(-0.9, 0.9), up(-1.3, 1.3), up(-1.3, 1.3)]
    case = dict(theta_rad=q, **l)
    T, J = product(rows3(q, l)), jacobian(rows3, q, l)
    F = [up(-5, 5) for _ in range(3)]
    add("proto3_transform", case, T, "- and m", 1e-12)
    add("proto3_jacobian", case, J, "m/rad", 1e-12)
    add("proto3_manipulability", case, manipulability(J), "m^3", 1e-12)
    add("proto3_torques", dict(case, F_N=F), [sum(J[i][j] * F[i] for i in range(3)) for j in range(5)], "N m", 1e-12)
    if n < 2:
        add("proto3_rotation_elements", dict(theta_rad=q, elements=["21", "22", "31", "33", "12"]),
            [T[1][0], T[1][1], T[2][0], T[2][2], T[0][1]], "-", 1e-12)
        add("proto3_position_Z", case, T[2][3], "m", 1e-12)
    r = [T[i][3] for i in range(3)]
    add("proto3_ik", dict(r_m=r, **l), inverse3(r, l), "rad", 1e-7, "unordered set modulo 2 pi, all branches")
for r in ([0.9, 0.0, 0.0], [0.2, 0.0, 0.3], [0.0, 0.001, 0.0]):
    add("proto3_ik", dict(r_m=r, **SET_A), "error:unreachable", "", 0)

# Sets A and B: cylinders by their pins.
CYLINDERS = {
    "A": [("two", 30, 0.0125), ("two_mod", 30, 0.0125), ("three", 30, 0.0125)],
    "B": [("two", 45, 0.0125), ("two_mod", 45, 0.0125), ("three", 45, 0.0125)],
}


def set_linkages(name):
    out = []
    for config, tm, stroke in CYLINDERS[name]:
        t = math.radians(tm)
        l2 = stroke / (2 * math.sin(t))
        l0, l1 = l2 * math.cos(t), 0.08125
        out.append((config, dict(l0_m=0.0, l1_m=l2, l2_m=l1, h_m=l0) if config == "three"
                    else dict(l0_m=l0, l1_m=l1, l2_m=l2)))
    return out


LENGTHS = {"A": SET_A, "B": dict(SET_A, l2_m=0.020)}
for n in range(8):
    name = "AB"[n % 2]
    limit = {"A": 0.52, "B": 0.78}[name]
    q, F = [up(-limit, limit) for _ in range(3)], [up(-3, 3) for _ in range(3)]
    J = jacobian(rows3, q + [0.0, 0.0], LENGTHS[name])
    T = [sum(J[i][j] * F[i] for i in range(3)) for j in range(3)]
    push = [T[j] / lever(config, l, q[j]) for j, (config, l) in enumerate(set_linkages(name))]
    add("proto3_actuator_forces", dict(set=name, theta_rad=q, F_N=F), push, "N", 1e-9, "push positive")
    add("proto3_pressures", dict(set=name, theta_rad=q, F_N=F, A1_m2=A1, A2_m2=A2, p_bias_Pa=2e4, p_max_Pa=5e5),
        [list(allocate(f, A1, A2, 2e4, 5e5)[:2]) for f in push], "Pa", 1e-3)

sys.stdout.write("[\n" + ",\n".join(json.dumps(case) for case in CASES) + "\n]\n")
