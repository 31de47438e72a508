#!/usr/bin/env python3
"""The kinematics of the 7-DOF arm once more, to check the library's against: prints cases for reference_cases.

    python3 tests/oracle/seven_dof.py > tests/data/seven-dof-arm.json

The arm is a product of Denavit-Hartenberg transforms in 40 digits. Its inverse is found by where the elbow may be (on
two spheres, and on the plane, cone or circle that the given joint leaves), and joint angles are read off the frames one
by one: none of the library's equations. Needs python3-mpmath. The cases are seeded; running it again gives the same file.
"""

import json
import random

from mpmath import mp, mpf, matrix, eye, sin, cos, pi, sqrt, atan2, svd_r, zeros

mp.dps = 40
random.seed(20061)
CASES = []
ALPHA = [-pi / 2, pi / 2, -pi / 2, pi / 2, -pi / 2, pi / 2, mpf(0)]


def plain(x):
    if isinstance(x, mpf):
        return float(x)
    if isinstance(x, matrix):
        rows = [[float(x[i, j]) for j in range(x.cols)] for i in range(x.rows)]
        return [row[0] for row in rows] if x.cols == 1 else rows
    if isinstance(x, (list, tuple)):
        return [plain(one) for one in x]
    if isinstance(x, dict):
        return {key: plain(one) for key, one in x.items()}
    return x


def case(quantity, inputs, value, unit, tolerance, note=""):
    CASES.append(
        {
            "id": f"oracle.{len(CASES) + 1:03d}",
            "source": "tests/oracle/seven_dof.py",
            "quantity": quantity,
            "inputs": plain(inputs),
            "value": plain(value),
            "unit": unit,
            "tolerance": tolerance,
            "note": note,
        }
    )


def near(low, high, digits=4):
    """A random number that a decimal of a few digits writes down."""
    return float(f"{random.uniform(low, high):.{digits}f}")


# ---------------------------------------------------------------------------------------------------- the arm


def row(theta, d, alpha):
    """Rz(theta) Tz(d) Rx(alpha)."""
    T = eye(4)
    s, c, sa, ca = sin(theta), cos(theta), sin(alpha), cos(alpha)
    T[0, 0], T[0, 1], T[0, 2] = c, -s * ca, s * sa
    T[1, 0], T[1, 1], T[1, 2] = s, c * ca, -c * sa
    T[2, 1], T[2, 2], T[2, 3] = sa, ca, d
    return T


def frames(theta, d3, d4):
    """Frames 0..7: the forearm is laid off along axis 5."""
    d = [0, 0, d3, 0, d4, 0, 0]
    T = [eye(4)]
    for k in range(7):
        T.append(T[-1] * row(mpf(theta[k]), mpf(d[k]), ALPHA[k]))
    return T


def position(T):
    return T[0:3, 3]


def rotation(T):
    return T[0:3, 0:3]


def cross(a, b):
    return matrix([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])


def dot(a, b):
    return sum(a[i] * b[i] for i in range(3))


def norm(a):
    return sqrt(dot(a, a))


def jacobian(theta, d3, d4):
    """By central differences: with 40 digits and steps of 1e-13 good to some 26."""
    h = mpf(10) ** -13
    J = zeros(6, 7)
    here = rotation(frames(theta, d3, d4)[7])
    for k in range(7):
        ahead, behind = [mpf(t) for t in theta], [mpf(t) for t in theta]
        ahead[k] += h
        behind[k] -= h
        A, B = frames(ahead, d3, d4)[7], frames(behind, d3, d4)[7]
        v = (position(A) - position(B)) / (2 * h)
        S = (rotation(A) - rotation(B)) / (2 * h) * here.T
        for i in range(3):
            J[i, k] = v[i]
        J[3, k], J[4, k], J[5, k] = S[2, 1], S[0, 2], S[1, 0]
    return J


def rank(J, d3, d4):
    scaled = J.copy()
    for i in range(3):
        for k in range(7):
            scaled[i, k] /= mpf(d3) + mpf(d4)
    sigma = svd_r(scaled, compute_uv=False)
    return sum(1 for i in range(len(sigma)) if sigma[i] > mpf(10) ** -9)


def determinant(a, b, c):
    return dot(a, cross(b, c))


# ------------------------------------------------------------------------------------------------- its inverse


def elbows(r, given, angle, d3, d4):
    """Points at d3 from the shoulder and d4 from the wrist, on what the given angle leaves."""
    x = dot(r, r)
    along = (d3 * d3 + x - d4 * d4) / 2  # e.r
    if given == 1:  # the plane through axis 1 whose normal is axis 2
        n, offset = matrix([-sin(angle), cos(angle), 0]), mpf(0)
    elif given == 2:  # the cone about axis 1: e.z = d3 cos(theta2)
        n, offset = matrix([0, 0, 1]), d3 * cos(angle)
    # Line of the planes e.r = along and e.n = offset, cut with the sphere |e| = d3.
    u = cross(r, n)
    g = dot(r, n)
    den = x - g * g
    a, b = (along - g * offset) / den, (offset * x - along * g) / den
    foot = a * r + b * n
    h2 = (d3 * d3 - dot(foot, foot)) / dot(u, u)
    if h2 < 0:
        return []
    return [foot + s * sqrt(h2) * u for s in (1, -1)]


def arm_from_elbow(e, r, d3, d4, shoulder_sign):
    """theta1..theta4 read off the elbow; with the shoulder turned over by half a turn, if asked."""
    across = sqrt(e[0] ** 2 + e[1] ** 2)
    t1, t2 = atan2(shoulder_sign * e[1], shoulder_sign * e[0]), atan2(shoulder_sign * across, e[2])
    return arm_from_shoulder(t1, t2, r, d3, d4)


def arm_from_shoulder(t1, t2, r, d3, d4):
    T2 = row(t1, mpf(0), ALPHA[0]) * row(t2, mpf(0), ALPHA[1])
    f = (r - position(T2) - d3 * rotation(T2)[0:3, 2]) / d4  # forearm
    g = rotation(T2).T * f  # = (c3 s4, s3 s4, c4)
    result = []
    for sign in (1, -1):
        t3 = atan2(sign * g[1], sign * g[0])
        t4 = atan2(sign * sqrt(g[0] ** 2 + g[1] ** 2), g[2])
        result.append([t1, t2, t3, t4])
    return result


def arm_all(r, given, angle, d3, d4):
    solutions = []
    if given in (1, 2):
        for e in elbows(r, given, angle, d3, d4):
            candidates = [arm for s in (1, -1) for arm in arm_from_elbow(e, r, d3, d4, s)]
            # Of the two readings of the shoulder one has the angle that was given.
            solutions += [arm for arm in candidates if abs(sin((arm[given - 1] - angle) / 2)) < mpf(10) ** -20]
        return solutions
    # theta3: n = d3 z + d4 Rz(theta3) Ry(theta4) z is turned by theta2 about y, which keeps its y, then by theta1.
    c4 = (dot(r, r) - d3**2 - d4**2) / (2 * d3 * d4)
    for s4 in (sqrt(1 - c4**2), -sqrt(1 - c4**2)):
        n = matrix([d4 * cos(angle) * s4, d4 * sin(angle) * s4, d3 + d4 * c4])
        out2 = r[0] ** 2 + r[1] ** 2 - n[1] ** 2
        if out2 < 0:
            continue
        for out in (sqrt(out2), -sqrt(out2)):  # x of Ry(theta2) n
            t2 = atan2(out, r[2]) - atan2(n[0], n[2])
            t1 = atan2(r[1], r[0]) - atan2(n[1], out)
            solutions.append([t1, t2, angle, atan2(s4, c4)])
    return solutions


def full_all(r, C, given, angle, d3, d4):
    solutions = []
    for arm in arm_all(r, given, angle, d3, d4):
        H = rotation(frames(arm + [0, 0, 0], d3, d4)[4])
        M = H.T * C
        for sign in (1, -1):
            across = sign * sqrt(M[0, 2] ** 2 + M[1, 2] ** 2)
            t6 = atan2(across, M[2, 2])
            t5 = atan2(M[1, 2] / across, M[0, 2] / across)
            E = rotation(row(t5, mpf(0), ALPHA[4]) * row(t6, mpf(0), ALPHA[5]))
            R = E.T * M  # Rz(theta7)
            solutions.append(arm + [t5, t6, atan2(R[1, 0], R[0, 0])])
    return solutions


# -------------------------------------------------------------------------------------------------- the cases


def lengths(n):
    return (0.25, 0.25) if n % 4 == 0 else (near(0.12, 0.6), near(0.12, 0.6))


def regular_angles():
    while True:
        theta = [near(-3.1, 3.1) for _ in range(7)]
        clear = [abs(sin(theta[1])), abs(cos(theta[2])), abs(sin(theta[2])), abs(sin(theta[3])), abs(sin(theta[5]))]
        if min(clear) > 0.15:
            return theta


def forward():
    for n in range(12):
        d3, d4 = lengths(n)
        theta = [near(-3.1, 3.1) for _ in range(7)]
        T = frames(theta, d3, d4)[7]
        size = {"d3_m": d3, "d4_m": d4}
        case("wrist_position", {"theta_rad": theta, **size}, position(T), "m", 1e-13)
        case("orientation", {"theta_rad": theta}, rotation(T), "-", 1e-13)
        J = jacobian(theta, d3, d4)
        case("jacobian", {"theta_rad": theta, **size}, J, "m/rad and -", 1e-13)
        column = [J[0:3, k] for k in range(4)]
        minors = [determinant(column[1], column[2], column[3]), determinant(column[0], column[2], column[3])]
        case("position_minors", {"theta_rad": theta, **size}, minors, "m^3", 1e-15)
        G = sum((c * c.T for c in column), zeros(3, 3))
        g = determinant(G[0:3, 0], G[0:3, 1], G[0:3, 2])
        case("position_manipulability", {"theta_rad": theta, **size}, sqrt(abs(g)), "m^3", 1e-13)
    degrees = [near(-170, 170, 1) for _ in range(4)]
    T = frames([t * pi / 180 for t in map(mpf, map(str, degrees))] + [0, 0, 0], 0.31, 0.22)[7]
    case("wrist_position", {"theta_deg": degrees, "d3_m": 0.31, "d4_m": 0.22}, position(T), "m", 1e-13)


def inverse():
    for n in range(9):
        d3, d4 = lengths(n)
        theta = regular_angles()
        T = frames(theta, d3, d4)[7]
        r = matrix([mpf(float(v)) for v in position(T)])
        C = matrix(plain(rotation(T)))
        for given in (1, 2, 3):
            angle = mpf(theta[given - 1])
            inputs = {"r_m": r, "given": given, "theta_rad": angle, "d3_m": d3, "d4_m": d4}
            arms = arm_all(r, given, angle, mpf(d3), mpf(d4))
            assert len(arms) == 4, (given, len(arms))
            for arm in arms:
                assert norm(position(frames(arm + [0, 0, 0], d3, d4)[7]) - r) < mpf(10) ** -25
            case("ik_arm_all", inputs, arms, "rad", 1e-12, "unordered set of (theta1..theta4), modulo 2 pi")
            whole = full_all(r, C, given, angle, mpf(d3), mpf(d4))
            case("ik_full_all", {**inputs, "C": C}, whole, "rad", 1e-12, "unordered set of 7-vectors, modulo 2 pi")


def ranks():
    half, quarter = ("0", "pi"), ("pi/2", "-pi/2")
    value = {"0": 0, "pi": 180, "pi/2": 90, "-pi/2": -90}
    sets = [
        ({3: half}, 5),
        ({1: half, 2: quarter}, 5),
        ({5: half, 4: quarter}, 5),
        ({1: half, 5: half}, 5),
        ({1: half}, 6),
        ({5: half}, 6),
        ({}, 6),
    ]
    for joints, expected in sets:
        for pick in (0, 1):
            theta = [near(20, 70, 0) for _ in range(7)]
            for joint, values in joints.items():
                theta[joint] = value[values[pick]]
            d3, d4 = near(0.2, 0.5), near(0.1, 0.19)
            found = rank(jacobian([mpf(t) * pi / 180 for t in theta], d3, d4), d3, d4)
            assert found == expected, (joints, found)
            case("jacobian_rank", {"theta_deg": theta, "d3_m": d3, "d4_m": d4}, found, "-", 0)


def refusals():
    size = {"d3_m": 0.3, "d4_m": 0.2}
    for r, given, angle, more, name in (
        ([0.3, 0.3, 0.3], 1, 0.1, size, "unreachable"),
        ([0.05, 0.02, 0.01], 2, 0.5, size, "unreachable"),
        ([0.3, 0.4, 0.0], 3, 0.0, size, "singular_elbow"),
        ([0.125, 0.0, 0.0], 1, 0.0, {"d3_m": 0.375, "d4_m": 0.25}, "singular_elbow"),
        ([0.0, 0.0, 0.0], 3, 0.3, {"d3_m": 0.2, "d4_m": 0.2}, "singular_elbow"),
        ([0.1, 0.2, 0.3], 2, 0.0, size, "theta1_undefined"),
        ([0.0, 0.0, 0.35], 2, 1.0, size, "theta1_undefined"),
        ([0.0, 0.0, 0.35], 3, 0.4, size, "theta1_undefined"),
        ([0.0, 0.25, 0.0], 1, 0.0, size, "theta2_undefined"),
        ([0.1, 0.3, 0.0], 1, 0.0, size, "no_solution_for_theta1"),
        ([0.1, 0.0, 0.4], 2, 1.5, size, "no_solution_for_theta2"),
        ([0.05, 0.0, 0.4], 3, 1.5, size, "no_solution_for_theta3"),
        ([0.1, 0.2, 0.3], 1, 0.0, {"d3_m": 0.0, "d4_m": 0.2}, "invalid_argument"),
        ([0.1, 0.2, 0.3], 1, 0.0, {"d3_m": 0.3, "d4_m": -0.2}, "invalid_argument"),
        ([0.1, None, 0.3], 1, 0.0, size, "invalid_argument"),
        ([0.1, 0.2, 0.3], 1, 0.2, {**size, "C": [[1, 0, 0], [0, 1, 0], [0, 0, -1]]}, "invalid_argument"),
        ([0.1, 0.2, 0.3], 1, 0.2, {**size, "C": [[1, 0, 0], [0, 1, 0.01], [0, 0, 1]]}, "invalid_argument"),
    ):
        case("ik_error", {"r_m": r, "given": given, "theta_rad": angle, **more}, name, "-", 0)
    theta = [0.4, 0.9, -0.3, 1.2, 0.5, 0, 0.6]  # theta6 = 0
    T = frames(theta, 0.3, 0.2)[7]
    inputs = {"r_m": position(T), "C": rotation(T), "given": 1, "theta_rad": 0.4, **size}
    case("ik_error", inputs, "singular_wrist", "-", 0)


forward()
inverse()
ranks()
refusals()
print("[\n" + ",\n".join(" " + json.dumps(one) for one in CASES) + "\n]")
