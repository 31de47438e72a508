#!/usr/bin/env python3
"""An R-CUBE of its own, to check the library's against: prints cases for reference_cases.

    python3 tests/oracle/r_cube.py > tests/data/r-cube-further.json

Chains of homogeneous transforms in 40 digits, closed by Newton's method and differentiated by differences: none of the
closed forms of the library. Needs python3-mpmath. The cases are seeded; running it again gives the same file.
"""

import json
import random

from mpmath import mp, mpf, matrix, eye, sin, cos, pi, sqrt, findroot, asin, atan2, det

mp.dps = 40
random.seed(20181)
CASES = []


def case(quantity, inputs, value, unit, absolute=1e-12, relative=1e-9, note=""):
    def plain(x):
        if isinstance(x, mpf):
            return float(x)
        if isinstance(x, (list, tuple)):
            return [plain(one) for one in x]
        if isinstance(x, dict):
            return {key: plain(one) for key, one in x.items()}
        return x

    CASES.append(
        {
            "id": f"oracle.{len(CASES) + 1:03d}",
            "source": "tests/oracle/r_cube.py",
            "quantity": quantity,
            "inputs": plain(inputs),
            "value": plain(value),
            "unit": unit,
            "tolerance": {"abs": absolute, "rel": relative},
            "note": note,
        }
    )


def near(low, high, digits=4):
    """A random number that a decimal of a few digits writes down exactly, as the case file will."""
    return float(f"{random.uniform(low, high):.{digits}f}")


# ------------------------------------------------------------------------------------------------------ transforms


def translation(axis, length):
    H = eye(4)
    H[axis - 1, 3] = length
    return H


def rotation(axis, angle):
    H = eye(4)
    i, j = [(1, 2), (2, 0), (0, 1)][axis - 1]
    H[i, i] = H[j, j] = cos(angle)
    H[i, j], H[j, i] = -sin(angle), sin(angle)
    return H


def base(S, chain):
    if chain == 1:
        return translation(1, S) * rotation(1, -pi / 2) * rotation(3, -pi / 2)
    if chain == 2:
        return translation(2, S)
    return translation(3, S) * rotation(3, pi / 2) * rotation(1, pi / 2)


def tip(l, S, chain, q):
    """Platform point of one chain at its three angles, base axes."""
    H = (
        base(S, chain)
        * rotation(3, q[0])
        * translation(1, l[0])
        * rotation(3, -q[0])
        * rotation(1, -pi / 2)
        * rotation(3, q[1])
        * translation(1, l[1])
        * rotation(3, q[2])
        * translation(1, l[2])
    )
    return [H[i, 3] for i in range(3)]


def axes(chain):
    return [(chain - 1 + step) % 3 for step in range(3)]


def passive(l, S, chain, q1, r, sigma):
    """Passive angles that bring the chain's tip to r, by Newton from several starts; None if there are none."""
    _, b, c = axes(chain)

    def gap(q2, q3):
        at = tip(l, S, chain, (q1, q2, q3))
        return [at[b] - r[b], at[c] - r[c]]

    for q3 in (1.5, 0.7, 2.4, 0.2, 2.9):
        for q2 in (0.1, -0.9, 0.9, -2.0, 2.0, 3.0):
            try:
                found = findroot(gap, (mpf(q2), mpf(sigma * q3)), tol=1e-60, maxsteps=40)
            except (ValueError, ZeroDivisionError):
                continue
            angles = [mp.atan2(sin(one), cos(one)) for one in found]
            if angles[1] * sigma > 0 and max(abs(x) for x in gap(*angles)) < mpf(10) ** -30:
                return angles
    return None


def posture(l, S, q, sigma):
    """Platform point and the passive angles of all chains; None if they do not close."""
    l = [mpf(x) for x in l]
    r = [tip(l, mpf(S), chain, (mpf(q[chain - 1]), 0, 0))[chain - 1] for chain in (1, 2, 3)]
    angles = []
    for chain in (1, 2, 3):
        found = passive(l, mpf(S), chain, mpf(q[chain - 1]), r, sigma)
        if found is None:
            return None
        angles.append(found)
    return r, angles


def difference(f, h=mpf(10) ** -12):
    """First derivative at 0 of a function of time that gives a list; error h^4."""
    a, b, c, d = f(-2 * h), f(-h), f(h), f(2 * h)
    return [(p - 8 * q + 8 * r - s) / (12 * h) for p, q, r, s in zip(a, b, c, d)]


def second_difference(f, h=mpf(10) ** -7):
    a, b, m, c, d = f(-2 * h), f(-h), f(mpf(0)), f(h), f(2 * h)
    return [(-p + 16 * q - 30 * o + 16 * r - s) / (12 * h * h) for p, q, o, r, s in zip(a, b, m, c, d)]


def lengths():
    l1 = near(0.08, 0.16)
    return [l1, near(0.6 * l1, 0.9 * l1), near(0.9 * l1, 1.3 * l1)]


def angles(limit):
    return [near(-limit, limit) for _ in range(3)]


def reachable(sigma, limit=0.5, offset=False):
    while True:
        l = lengths()
        S = l[0] if not offset else round(l[0] * near(0.85, 1.15, 2), 5)
        q = angles(limit)
        found = posture(l, S, q, sigma)
        if found and all(abs(sin(pair[1])) > 0.1 for pair in found[1]):
            return l, S, q, found


# ------------------------------------------------------------------------------------------------------- kinematics


def kinematics():
    for k in range(14):
        sigma = -1 if k % 3 else 1
        l, S, q, (r, pairs) = reachable(sigma, offset=k % 2 == 1)
        case("forward kinematics r", {"l": l, "S": S, "q": q}, r, "m")
        # Decimal positions, so that the file holds exactly what was solved for.
        r = [float(f"{float(x):.5f}") for x in r]
        q = [asin((mpf(x) - mpf(S)) / mpf(l[0])) for x in r]
        pairs = [
            passive([mpf(x) for x in l], mpf(S), chain, q[chain - 1], [mpf(x) for x in r], sigma) for chain in (1, 2, 3)
        ]
        if any(pair is None for pair in pairs):
            continue
        case("inverse kinematics, active angles", {"l": l, "S": S, "r": r}, q, "rad")
        case(
            "inverse kinematics, passive angles [[q12,q13],[q22,q23],[q32,q33]]",
            {"l": l, "S": S, "r": r, "sigma": sigma},
            pairs,
            "rad",
            1e-10,
        )


def jacobians():
    for k in range(12):
        l = lengths()
        chain = k % 3 + 1
        q = [near(-1.2, 1.2), near(-3.0, 3.0), near(-3.0, 3.0)]
        precise = [mpf(x) for x in q]
        columns = []
        for j in range(3):
            columns.append(
                difference(lambda t: tip([mpf(x) for x in l], mpf(0), chain, [p + (t if i == j else 0) for i, p in enumerate(precise)]))
            )
        J = [[columns[j][i] for j in range(3)] for i in range(3)]
        case("chain Jacobian J_i", {"chain": chain, "l": l, "angles": q}, J, "m")
        case("det J_i", {"chain": chain, "l": l, "angles": q}, det(matrix(J)), "m^3", 1e-15)


def rates():
    for k in range(9):
        sigma = -1 if k % 4 else 1
        l, S, q, _ = reachable(sigma, 0.4)
        chain = k % 3 + 1
        qd, qdd = [near(-1.5, 1.5, 2) for _ in range(3)], [near(-1.5, 1.5, 2) for _ in range(3)]

        def moved(t):
            return [mpf(q[i]) + mpf(qd[i]) * t + mpf(qdd[i]) * t * t / 2 for i in range(3)]

        def platform(t):
            return posture(l, S, moved(t), sigma)[0]

        def joints(t):
            return [moved(t)[chain - 1]] + posture(l, S, moved(t), sigma)[1][chain - 1]

        inputs = {"chain": chain, "l": l, "q": q, "qd": qd, "qdd": qdd, "sigma": sigma}
        case("platform velocity", inputs, difference(platform), "m/s")
        case("platform acceleration", inputs, second_difference(platform), "m/s^2")
        case("chain joint velocities", inputs, difference(joints), "rad/s")
        case("chain joint accelerations", inputs, second_difference(joints), "rad/s^2", 1e-12, 1e-8)


# -------------------------------------------------------------------------------------------------------- geometry


def arm_constraints(qmax, l2, l3, half, clear):
    """The seven constraint values, from the law of cosines and, for the last two, from the two circles' crossing."""
    l1 = half / sin(qmax)
    dy = l1 - l1 * cos(qmax)

    def reach(x, y):
        c = (x * x + y * y - l2 * l2 - l3 * l3) / (2 * l2 * l3)
        return c * c - 1

    def slope(x, y):
        # The elbow is where circles of radius l2 about the universal joint and l3 about the tip meet; out of reach it
        # lies on their line of centres, as far along as the clamped angles put it.
        rho2 = x * x + y * y
        c = (rho2 - l2 * l2 - l3 * l3) / (2 * l2 * l3)
        if abs(c) >= 1:
            q3 = mpf(0) if c > 0 else -pi
            X, Y = y, -x
            q2 = atan2((l2 + l3 * cos(q3)) * Y, (l2 + l3 * cos(q3)) * X)
            return sin(q2 + q3)
        rho = sqrt(rho2)
        share = (l2 * l2 - l3 * l3 + rho2) / (2 * rho)
        height = sqrt(l2 * l2 - share * share)
        best = None
        for side in (1, -1):
            ex = (x * share - side * y * height) / rho
            ey = (y * share + side * x * height) / rho
            # q2 is counted from +y towards -x, so is q2 + q3; the device's elbow has q3 < 0.
            q2 = atan2(-ex, ey)
            q23 = atan2(-(x - ex), y - ey)
            if sin(q23 - q2) < 0:
                best = sin(q23)
        return best

    far, close = l1 + clear, l1 - clear
    return [
        reach(far, -clear),
        reach(far, clear),
        reach(close, mpf(0)),
        reach(far, dy + clear),
        reach(close, dy),
        slope(close, -clear),
        slope(close, dy - clear),
    ]


def geometry():
    for _ in range(10):
        qmax, l2, l3 = near(0.3, 0.7), near(0.05, 0.15), near(0.08, 0.2)
        half, clear = near(0.05, 0.07, 3), near(0.06, 0.075, 3)
        values = arm_constraints(mpf(qmax), mpf(l2), mpf(l3), mpf(half), mpf(clear))
        case(
            "constraint values g3,g4,g5,g6,g7,g8C,g8B",
            {"qmax": qmax, "l2": l2, "l3": l3, "half_workspace": half, "half_virtual": clear},
            values,
            "1",
        )
    for _ in range(3):
        l = lengths()
        half = near(0.04, 0.07, 3)
        qmax = asin(mpf(half) / mpf(l[0]))
        case("total link length", {"l": l}, sum(mpf(x) for x in l), "m")
        case("qmax from l1 and half workspace", {"l1": l[0], "half_workspace": half}, qmax, "rad")
        case("l1 cos(qmax)", {"l1": l[0], "half_workspace": half}, mpf(l[0]) * cos(qmax), "m")
        case("1/cos(qmax)^2", {"l1": l[0], "half_workspace": half}, 1 / cos(qmax) ** 2, "1")
        plies, ratio = [random.randint(1, 9) for _ in range(4)], near(0.6, 0.85, 2)
        for link in (1, 2, 3):
            R = mpf("0.00015") * sum(plies) / (1 - mpf(ratio))
            inputs = {"plies": plies, "ply_thickness": 0.00015, "ratio": ratio}
            case(f"outer radius R = 0.15e-3 n/(1-0.75) of link {link}", inputs, R, "m", 1e-12)
            case(f"inner radius r = 0.75 R of link {link}", inputs, R * mpf(ratio), "m", 1e-12)
        D = [near(0.01, 0.03) for _ in range(3)]
        rho = near(1500, 2000, 0)
        mass = 3 * sum(mpf(rho) * pi / 4 * mpf(d) ** 2 * (1 - mpf(ratio) ** 2) * mpf(x) for d, x in zip(D, l))
        case("mass of the nine links", {"l": l, "D": D, "ratio": ratio, "rho": rho}, mass, "kg")
    for _ in range(4):
        top = near(0.8, 0.95, 3)
        D, L, rho, E = near(0.5, 1.5, 2), near(0.5, 3, 2), near(0.5, 3, 2), near(0.5, 3, 2)
        best, least = None, None

        def compliance(k):
            return mpf(L) ** 3 / (12 * mpf(E) * pi / 64 * mpf(D) ** 4 * (1 - k**4))

        def inertia(k):
            m = mpf(rho) * mpf(L) * pi / 4 * mpf(D) ** 2 * (1 - k * k)
            return m * (mpf(L) ** 2 / 3 + mpf(D) ** 2 * (1 + k * k) / 16 + mpf(L) ** 2 / 4)

        low, high = mpf(0), mpf(top)
        for k in range(20001):
            ratio = low + (high - low) * k / 20000
            a = (compliance(ratio) - compliance(low)) / (compliance(high) - compliance(low))
            b = (inertia(ratio) - inertia(high)) / (inertia(low) - inertia(high))
            rms = a * a + b * b
            if least is None or rms < least:
                best, least = ratio, rms
        case(
            "d/D minimising sqrt((CS1n^2+CS2n^2)/2), CS1, CS2 normalised with eq 7.1 over the search range",
            {"D": D, "E": E, "L": L, "rho": rho, "ratio_range": [0, top]},
            best,
            "1",
            1e-4,
            0,
        )
    case("normalised value", {"value": 0.105, "min": 0.094, "max": 0.137}, mpf("0.011") / mpf("0.043"), "1")
    frequency, manipulability = [1.0, 0.8, 0.45, 0.1, 0.0], [0.0, 0.3, 0.65, 0.9, 1.0]
    for weight in (0.0, 0.3, 1.0, 8.0):
        score = [(1 - f) ** 2 + weight * (1 - m) ** 2 for f, m in zip(frequency, manipulability)]
        case(
            "1-based index of the smallest sqrt((w*^2 + weight mu*^2)/2)",
            {"omega_nn": frequency, "mu_vn": manipulability, "weight": weight},
            score.index(min(score)) + 1,
            "index",
            0,
            0,
        )
    case("difference of the largest and smallest qmax", {"qmax_max": 0.61, "qmax_min": 0.39}, mpf("0.61") - mpf("0.39"), "rad")
    case("total length of row 40 minus row 1", {"total_row1": 0.31, "total_row40": 0.39}, mpf("0.39") - mpf("0.31"), "m")


def refusals():
    l = [0.1117, 0.0741, 0.1218]
    straight = [0.1, 0.04, 0.06]
    for quantity, inputs, error in (
        ("inverse kinematics, active angles", {"l": l, "S": 0.1117, "r": [0.23, 0.11, 0.11]}, "unreachable_active"),
        ("inverse kinematics, active angles", {"l": [0.1, -0.07, 0.12], "S": 0.1, "r": [0.1, 0.1, 0.1]}, "bad_length"),
        (
            "inverse kinematics, passive angles [[q12,q13],[q22,q23],[q32,q33]]",
            {"l": [0.1117, 0.0741, 0.03], "S": 0.1117, "r": [0.11, 0.11, 0.11], "sigma": -1},
            "unreachable_passive",
        ),
        (
            "inverse kinematics, passive angles [[q12,q13],[q22,q23],[q32,q33]]",
            {"l": l, "S": 0.1117, "r": [0.11, 0.11, 0.11], "sigma": 0},
            "invalid_argument",
        ),
        ("forward kinematics r", {"l": [0.0, 0.07, 0.12], "S": 0.1, "q": [0, 0, 0]}, "bad_length"),
        ("chain Jacobian J_i", {"chain": 4, "l": l, "angles": [0, 0, -1]}, "invalid_argument"),
        ("chain joint velocities", {"chain": 1, "l": straight, "q": [0, 0, 0], "qd": [1, 1, 1], "qdd": [0, 0, 0], "sigma": -1}, "singular"),
        ("chain joint accelerations", {"chain": 2, "l": straight, "q": [0, 0, 0], "qd": [1, 1, 1], "qdd": [0, 0, 0], "sigma": -1}, "singular"),
        ("qmax from l1 and half workspace", {"l1": 0.05, "half_workspace": 0.06}, "unreachable_active"),
        ("constraint values g3,g4,g5,g6,g7,g8C,g8B", {"qmax": 0.5, "l2": 0, "l3": 0.1, "half_workspace": 0.06, "half_virtual": 0.065}, "bad_length"),
        ("outer radius R = 0.15e-3 n/(1-0.75) of link 1", {"plies": [0, 0, 0, 0], "ply_thickness": 0.00015, "ratio": 0.75}, "bad_laminate"),
        ("outer radius R = 0.15e-3 n/(1-0.75) of link 1", {"plies": [4, -1, 2, 2], "ply_thickness": 0.00015, "ratio": 0.75}, "bad_laminate"),
        ("mass of the nine links", {"l": l, "D": [0.03, 0.024, 0.0144], "ratio": 1.0, "rho": 1910.0}, "bad_section"),
    ):
        case(quantity, inputs, "error:" + error, "", 0, 0)


kinematics()
jacobians()
rates()
geometry()
refusals()
print("[\n" + ",\n".join(" " + json.dumps(one) for one in CASES) + "\n]")
