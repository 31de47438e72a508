#!/usr/bin/env python3
"""A delta and its cable drive of its own, to check the library's against: prints cases for reference_cases.

    python3 tests/oracle/delta_capstan.py > tests/data/delta-capstan-further.json

In 40 digits: forward kinematics by Newton's method on the three spheres, rates and the equations of motion by
differences of positions and energies, responses by matrix exponentials. Needs python3-mpmath. The cases are seeded;
running it again gives the same file.
"""

import json
import random

from mpmath import (acos, arg, atan, atan2, cos, degrees, expm, expm1, findroot, hypot, log, lu_solve, matrix, mp, mpf, pi,
                    polyroots, radians, sin, sqrt, tan, tanh, zeros)

mp.dps = 40
random.seed(20151)
CASES = []
AZIMUTHS = [pi / 2, pi / 2 + 2 * pi / 3, pi / 2 + 4 * pi / 3]


def plain(x):
    if isinstance(x, mpf):
        return float(x)
    if isinstance(x, matrix):
        rows = [[float(x[r, c]) for c in range(x.cols)] for r in range(x.rows)]
        return [row[0] for row in rows] if x.cols == 1 else rows
    if isinstance(x, (list, tuple)):
        return [plain(one) for one in x]
    if isinstance(x, dict):
        return {key: plain(one) for key, one in x.items()}
    return x


def case(quantity, inputs, value, unit="", absolute=1e-12, relative=1e-9):
    CASES.append({"id": f"oracle.{len(CASES) + 1:03d}", "source": "tests/oracle/delta_capstan.py", "quantity": quantity,
                  "inputs": plain(inputs), "value": plain(value), "unit": unit,
                  "tolerance": {"abs": absolute, "rel": relative}, "note": ""})


def error(quantity, inputs, name):
    case(quantity, inputs, "error:" + name, absolute=0.0, relative=0.0)


def near(low, high, digits=4):
    """A random number that a decimal of a few digits writes down exactly, as the case file will."""
    return float(f"{random.uniform(low, high):.{digits}f}")


# ------------------------------------------------------------------------------------------------------------ the delta


class Delta:
    def __init__(self, d1, d2, d3, d4):
        self.inputs = {"d1_m": d1, "d2_m": d2, "d3_m": d3, "d4_m": d4}
        self.d2, self.d3, self.d5 = mpf(d2), mpf(d3), mpf(d1) - mpf(d4)

    def elbow(self, leg, theta):
        out = self.d5 + self.d2 * cos(theta)
        return matrix([out * cos(AZIMUTHS[leg]), out * sin(AZIMUTHS[leg]), self.d2 * sin(theta)])

    def forward(self, theta):
        """The upper point at d3 from the three elbows: Newton from high above, which falls on the upper one."""
        elbows = [self.elbow(leg, theta[leg]) for leg in range(3)]
        p = (elbows[0] + elbows[1] + elbows[2]) / 3 + matrix([0, 0, self.d3])
        for _ in range(100):
            gaps = [p - elbow for elbow in elbows]
            residual = matrix([(gap.T * gap)[0] - self.d3**2 for gap in gaps])
            step = lu_solve(2 * matrix([list(gap) for gap in gaps]), residual)
            p -= step
            if mp.norm(step) < mpf(10) ** -35:
                return p
        raise ArithmeticError("the legs do not close")

    def knees(self, leg, p):
        """Both angles at which the elbow of a leg is d3 from p, the outward one first."""
        out = p[0] * cos(AZIMUTHS[leg]) + p[1] * sin(AZIMUTHS[leg]) - self.d5
        sideways = -p[0] * sin(AZIMUTHS[leg]) + p[1] * cos(AZIMUTHS[leg])
        # The triangle of arm, forearm (as seen along the axis) and the line from the axis to p.
        away, seen = hypot(out, p[2]), sqrt(self.d3**2 - sideways**2)
        cosine = (self.d2**2 + away**2 - seen**2) / (2 * self.d2 * away)
        if abs(cosine) > 1:
            return None
        direction, opening = atan2(p[2], out), acos(cosine)
        return direction - opening, direction + opening

    def difference(self, of, theta, way):
        h = mpf(10) ** -13
        return (of([t + h * w for t, w in zip(theta, way)]) - of([t - h * w for t, w in zip(theta, way)])) / (2 * h)

    def jacobian(self, theta):
        columns = [self.difference(self.forward, theta, [j == i for i in range(3)]) for j in range(3)]
        return matrix([[columns[c][r] for c in range(3)] for r in range(3)])


def wrapped(angle):
    return atan2(sin(angle), cos(angle))


def random_delta():
    while True:
        d1, d2, d4 = near(0.03, 0.2), near(0.04, 0.2), near(0.01, 0.12)
        d3 = near(1.3 * d2, 2.8 * d2)
        if d3 > abs(d1 - d4) + 0.6 * d2:
            return Delta(d1, d2, d3, d4)


def lumped(delta, theta, masses):
    """The energies of the delta with its forearms as points at both ends."""
    share = masses["mass_split"]
    platform = masses["m4_kg"] + masses["m_payload_kg"] + sum((1 - share) * m for m in masses["m3_kg"])

    def potential(angles):
        height = delta.forward(angles)[2]
        energy = platform * masses["g_m_s2"] * height
        for angle, forearm in zip(angles, masses["m3_kg"]):
            centroid = masses["c_x_m"] * sin(angle) - masses["c_n_m"] * cos(angle)
            energy += masses["g_m_s2"] * (masses["m2_kg"] * centroid + share * forearm * delta.d2 * sin(angle))
        return energy

    def mass(angles):
        J = delta.jacobian(angles)
        M = platform * J.T * J
        for leg, forearm in enumerate(masses["m3_kg"]):
            M[leg, leg] += (masses["I2_kgm2"] + masses["I_motor_kgm2"] * masses["k_g"] ** 2
                            + share * forearm * delta.d2**2)
        return M

    return potential, mass


def add_delta(delta):
    theta = [near(-0.6, 1.3) for _ in range(3)]
    angles = [mpf(t) for t in theta]
    p, J = delta.forward(angles), delta.jacobian(angles)
    at = {**delta.inputs, "theta_rad": theta}
    rate, acceleration = [near(-3, 3) for _ in range(3)], [near(-40, 40) for _ in range(3)]
    w, a = matrix(rate), matrix(acceleration)
    Jdot = delta.difference(delta.jacobian, angles, [mpf(x) for x in rate])
    case("delta.fk", at, p, "m")
    case("delta.jacobian", at, J, "m/rad", 1e-10)
    moving = {**at, "theta_dot_rad_s": rate}
    case("delta.jacobian_dot", moving, Jdot, "m/(rad s)", 1e-9)
    case("delta.velocity", moving, J * w, "m/s", 1e-9)
    case("delta.acceleration", {**moving, "theta_ddot_rad_s2": acceleration}, Jdot * w + J * a, "m/s^2", 1e-8)
    torque = near(0.1, 3)
    case("delta.axis_force", {**at, "tau_max_Nm": torque},
         [torque / max(abs(J[k, j]) for j in range(3)) for k in range(3)], "N", 1e-9)
    # A position that a case file writes in decimals, near where the legs are.
    point = [float(f"{float(x):.5f}") for x in p]
    roots = [delta.knees(leg, [mpf(x) for x in point]) for leg in range(3)]
    case("delta.ik", {**delta.inputs, "p_m": point}, [wrapped(r[0]) for r in roots], "rad", 1e-10)
    case("delta.ik_other_branch", {**delta.inputs, "p_m": point}, [wrapped(r[1]) for r in roots], "rad", 1e-10)

    masses = {"m2_kg": near(0.02, 0.3), "m3_kg": [near(0.01, 0.1) for _ in range(3)], "m4_kg": near(0.02, 0.3),
              "m_payload_kg": near(0, 0.3), "c_x_m": near(0.01, 0.08), "c_n_m": near(-0.01, 0.01),
              "I2_kgm2": near(1e-5, 1e-3, 7), "I_motor_kgm2": near(1e-7, 1e-5, 9), "k_g": near(5, 30, 3),
              "mass_split": near(0.4, 0.8), "g_m_s2": random.choice([9.80665, 9.81, 1.62])}
    potential, mass = lumped(delta, angles, {k: [mpf(x) for x in v] if isinstance(v, list) else mpf(v)
                                             for k, v in masses.items()})
    M = mass(angles)
    gravity = -matrix([delta.difference(potential, angles, [j == i for i in range(3)]) for j in range(3)])
    # Lagrange's equations: what is not M qddot is Mdot qdot less half the gradient of qdot' M qdot.
    turning = delta.difference(mass, angles, [mpf(x) for x in rate]) * w
    for j in range(3):
        turning[j] -= (w.T * delta.difference(mass, angles, [j == i for i in range(3)]) * w)[0] / 2
    push = [near(-20, 20, 2) for _ in range(3)]
    case("delta.mass_matrix", {**at, **masses}, M, "kg m^2", 1e-11)
    case("delta.gravity_torque", {**at, **masses}, gravity, "N m", 1e-10)
    case("delta.inverse_dynamics", {**moving, **masses, "theta_ddot_rad_s2": acceleration, "f_ext_N": push},
         M * a + turning - gravity - J.T * matrix(push), "N m", 1e-9)


def add_delta_errors():
    published = {"d1_m": 0.08, "d2_m": 0.08, "d3_m": 0.16, "d4_m": 0.055}
    window = {"theta_min_deg": -36, "theta_max_deg": 84}
    error("delta.ik", {**published, "p_m": [0, 0, 0.5]}, "unreachable")
    error("delta.ik", {**published, "p_m": [0, 0.025, 0]}, "unreachable")
    error("delta.ik", {**published, **window, "p_m": [0, 0, 0.237]}, "joint_limit")
    error("delta.ik", {**published, **window, "p_m": [0, 0, 0.5]}, "unreachable")
    error("delta.ik", {"d1_m": 0.08, "d2_m": 0.1, "d3_m": 0.1, "d4_m": 0.06, "p_m": [0, 0.02, 0]}, "degenerate")
    error("delta.fk", {"d1_m": 0.05, "d2_m": 0.1, "d3_m": 0.2, "d4_m": 0.05, "theta_rad": [float(pi / 2)] * 3}, "degenerate")
    error("delta.fk", {"d1_m": 0.2, "d2_m": 0.2, "d3_m": 0.2, "d4_m": 0.05, "theta_rad": [0, 0, 0]}, "unreachable")
    error("delta.fk", {**published, **window, "theta_rad": [1.5, 0, 0]}, "joint_limit")
    # Forearms in a plane: arms up at the sine of 0.8, and flat with the arms in line.
    flat = {"d1_m": 0.1, "d2_m": 0.1, "d3_m": 0.12, "d4_m": 0.04, "p_m": [0, 0, 0.08]}
    for quantity in ("delta.jacobian", "delta.axis_force"):
        error(quantity, {**flat, "tau_max_Nm": 1}, "singular")
        error(quantity, {**flat, "d3_m": 0.16, "p_m": [0, 0, 0], "tau_max_Nm": 1}, "singular")
    # Both ends of the window belong to it.
    delta = Delta(0.08, 0.08, 0.16, 0.055)
    for corner in ((-36, -36, -36), (84, 84, 84), (-36, 84, 84), (-36, -36, 84)):
        theta = [float(radians(x)) for x in corner]
        case("delta.fk", {**published, **window, "theta_rad": theta}, delta.forward([mpf(t) for t in theta]), "m")


# ------------------------------------------------------------------------------------------------------------ the drive


def capstan(d1, d2, d4, d6, d8, T_u, k_r, mu, theta6):
    """Every name of the capstan, or the name of an error."""
    tan30, theta6 = tan(pi / 6), radians(theta6)
    d3 = d1 - 3 * d2 / (8 * tan30)
    if d3 <= 0:
        return "invalid_argument"

    def groove(theta1):
        theta2 = atan(cos(theta1) * tan30)
        d5 = d1 - 7 * d2 / (8 * tan30) + d4 / sin(theta2)
        return theta2, d5, hypot(d5 - d4 * sin(theta2), d4 * cos(theta2) * sin(theta1))

    theta1 = findroot(lambda t: t - atan(d2 / (pi * groove(t)[2])), atan(d2 / (pi * d3)))
    theta2, d5, contact = groove(theta1)
    d7 = d6 + d4
    if 2 * d8 < d5 + d7:
        return "invalid_argument"
    if contact > d1:
        return "not_seated"
    theta3, theta4, k_g = atan(d2 / (pi * d5)), acos((d5 + d7) / (2 * d8)), d7 / d5
    theta5 = 2 * pi * k_r - 2 * theta4
    q = mu * theta5 / sin(theta2)
    F_u = T_u / (d5 * cos(theta3))
    F_p, F_l = F_u / tanh(q / 2), 2 * F_u / expm1(q)
    F_bx, F_by = 2 * cos(theta3) * sin(theta4) * F_p, (d5 + d7) * T_u / (d5 * d8)
    d9, d10 = theta5 * hypot(d5 / 2, d2 / (2 * pi)), theta6 * hypot(d7 / 2, k_g * d2 / (2 * pi))
    d11 = 2 * d8 * sin(theta4) / cos(theta3)
    names = dict(d3=d3, d5=d5, d7=d7, d9=d9, d10=d10, d11=d11, d12=d9 + d10 + d11,
                 d13=(theta5 + k_g * (theta6 - 2 * theta4)) * d2 / (2 * pi) + 2 * sin(theta4) / pi * d2 * d8 / d5,
                 d14=(theta5 + k_g * theta6) * d2 / (2 * pi), F_u=F_u, F_p=F_p, F_l=F_l, F_h=F_p + F_u, F_bx=F_bx, F_by=F_by,
                 F_bz=2 * sin(theta3) * F_u, F_br=hypot(F_bx, F_by), T_o=k_g * T_u, k_g=k_g, d8_min=(d5 + d7) / 2)
    for name, angle in zip(("theta1", "theta2", "theta3", "theta4", "theta5"), (theta1, theta2, theta3, theta4, theta5)):
        names[name] = degrees(angle)
    return names, d5 * cos(theta3) * tanh(q / 2) * k_g


def add_capstan(wraps):
    while True:
        a = {"d1_m": near(0.006, 0.025, 5), "d2_m": near(0.0006, 0.002, 5), "d4_m": near(0.0004, 0.0018, 5),
             "d6_m": near(0.06, 0.3), "T_u_Nm": near(0.01, 0.4), "k_r": wraps, "mu": near(0.05, 0.3, 3),
             "theta6_deg": near(40, 180, 1)}
        a["d8_m"] = float(f"{(a['d1_m'] + a['d6_m']) / 2 + a['d4_m'] + random.uniform(-0.0005, 0.03):.5f}")
        answer = capstan(*[mpf(a[key]) for key in ("d1_m", "d2_m", "d4_m", "d6_m", "d8_m", "T_u_Nm", "k_r", "mu",
                                                  "theta6_deg")])
        if isinstance(answer, str):
            if sum(one["value"] == "error:" + answer for one in CASES) < 6:
                error("capstan.F_p", a, answer)
            continue
        names, slip_per_preload = answer
        for name, value in names.items():
            case("capstan." + name, a, value, absolute=1e-13)
        preload = float(f"{float(names['F_p']) * random.uniform(0.5, 2):.3f}")
        case("capstan.torque_limit", {**a, "F_p_N": preload}, slip_per_preload * preload, "N m")
        offset = near(-20, 20, 2)
        per_radian = hypot(names["d7"] / 2, names["k_g"] * mpf(a["d2_m"]) / (2 * pi))
        one, other = (names["d12"] / 2 + sign * radians(mpf(offset)) * per_radian for sign in (1, -1))
        case("cable.equivalent_length", {**a, "offset_deg": offset}, 1 / (1 / one + 1 / other), "m")
        return


def held(A, B, C, period, count):
    """Samples of the response to a step that is held over each period."""
    n = A.rows
    block = zeros(n + 1)
    block[:n, :n], block[:n, n] = A, B
    E = expm(block * period)
    x, samples = zeros(n, 1), []
    for _ in range(count):
        samples.append((C * x)[0])
        x = E[:n, :n] * x + E[:n, n]
    return samples


def add_current_loop():
    R, L, P, I = near(0.1, 8), near(2e-5, 2e-3, 7), random.randrange(50, 900), random.randrange(10, 500)
    loop = {"R_ohm": R, "L_H": L, "KP_ohm": P / 256, "KI_ohm_s": I * 1e4 / 256}
    a, b, c = mpf(loop["KP_ohm"]) / L, mpf(loop["KI_ohm_s"]) / L, (mpf(loop["KP_ohm"]) + R) / L
    case("current_loop.gain_si.P", {"P_epos": P}, loop["KP_ohm"], "ohm")
    case("current_loop.gain_si.I", {"I_epos": I}, loop["KI_ohm_s"], "ohm/s")
    for drop in (3.0, 6.0):
        G = mpf(10) ** (-mpf(drop) / 10)
        roots = polyroots([G, G * (c * c - 2 * b) - a * a, (G - 1) * b * b], maxsteps=200, extraprec=200)
        u = max(root.real for root in roots if abs(root.imag) < mpf(10) ** -20 * abs(root) and root.real > 0)
        case("current_loop.bandwidth", {**loop, "drop_dB": drop}, sqrt(u) / (2 * pi), "Hz")
    samples = held(matrix([[0, 1], [-b, -c]]), matrix([0, 1]), matrix([[b, a]]), mpf("1e-4"), 400)
    sampled = {**loop, "sample_period_s": 1e-4}
    case("current_loop.step.samples", {**sampled, "count": 8}, samples[:8], absolute=1e-10)
    first = lambda level: next(i for i, y in enumerate(samples) if y >= level)
    case("current_loop.step.rise_samples", sampled, first(0.9) - first(0.1), "samples")
    case("current_loop.step.time_constant_samples", sampled, first(0.632), "samples")
    case("current_loop.step.settling_samples", sampled,
         1 + max(i for i, y in enumerate(samples) if abs(y - 1) > mpf("0.02")), "samples")
    case("current_loop.step.overshoot", sampled, max(0, 100 * (max(samples) - 1)), "percent", 1e-8)


def add_actuator():
    a = {"J1_kgm2": near(1e-6, 6e-6, 9), "b1_Nms_rad": near(2e-4, 15e-4, 7), "r1_m": near(0.0035, 0.01, 6),
         "J2_kgm2": near(1e-4, 6e-4, 7), "r2_m": near(0.05, 0.1), "r_o_m": near(0.06, 0.1), "k_o_N_m": near(1e7, 2e8, 0),
         "c_o_Ns_m": random.choice([0.0, 5.0, 80.0]), "k1_N_m": near(5e4, 3e5, 0), "kt_Nm_A": near(0.01, 0.06)}
    v = {key: mpf(value) for key, value in a.items()}
    m1, c1, m2 = v["J1_kgm2"] / v["r1_m"] ** 2, v["b1_Nms_rad"] / v["r1_m"] ** 2, v["J2_kgm2"] / v["r2_m"] ** 2
    lever = v["r_o_m"] / v["r2_m"]
    k1, k2, c2 = v["k1_N_m"], lever**2 * v["k_o_N_m"], lever**2 * v["c_o_Ns_m"]

    def outputs(s):
        """Tip force, motor angle and sector angle per current, from the two equations of motion."""
        force = v["kt_Nm_A"] / v["r1_m"]
        z = lu_solve(matrix([[m1 * s * s + c1 * s + k1, -k1], [-k1, m2 * s * s + c2 * s + k1 + k2]]), matrix([force, 0]))
        return (k2 + c2 * s) / lever * z[1], z[0] / v["r1_m"], z[1] / v["r2_m"]

    static = [x.real if hasattr(x, "real") else x for x in outputs(mpf(0))]
    case("actuator.dc_gain", a, static)
    case("actuator.static_force", {**a, "current_A": 0.7}, mpf("0.7") * static[0], "N")
    for frequency in (3.0, 137.0, 900.0):
        for output in range(3):
            response = outputs(2j * pi * frequency)[output]
            case("actuator.frf", {**a, "frequency_Hz": frequency, "output": output}, [abs(response), arg(response)])
    gain = lambda f: log(abs(outputs(2j * pi * f)[0]))
    coarse = max(range(5, 1990, 5), key=gain)
    if 5 < coarse < 1985:
        slope = lambda f: (gain(f + mpf("1e-9")) - gain(f - mpf("1e-9"))) / mpf("2e-9")
        peak = findroot(slope, (coarse - 5, coarse + 5), solver="anderson", tol=1e-25)
        case("actuator.resonance_frequency", {**a, "f_max_Hz": 2000.0}, peak, "Hz", 1e-5)
        case("actuator.resonance_peak", {**a, "f_max_Hz": 2000.0}, 20 * (gain(peak) - log(static[0])) / log(mpf(10)), "dB")
        edge = lambda f: gain(f) - log(static[0]) + mpf("0.15") * log(mpf(10))
        above = next(f for f in range(int(peak) + 1, 2000) if edge(f) < 0)
        case("actuator.bandwidth", {**a, "f_max_Hz": 2000.0, "drop_dB": 3.0},
             findroot(edge, (above - 1, above), solver="anderson"), "Hz", 1e-6)
    A = matrix([[0, 1, 0, 0], [-k1 / m1, -c1 / m1, k1 / m1, 0], [0, 0, 0, 1], [k1 / m2, 0, -(k1 + k2) / m2, -c2 / m2]])
    B = matrix([0, v["kt_Nm_A"] / (v["r1_m"] * m1), 0, 0])
    for period in (1 / 420, 1e-4):
        forces = held(A, 1.5 * B, matrix([[0, 0, k2 / lever, c2 / lever]]), mpf(period), 10)
        case("actuator.step.force", {**a, "current_A": 1.5, "sample_period_s": period, "count": 10}, forces, "N", 1e-8)


def add_flexure():
    f = {"l1_m": near(0.02, 0.1), "l2_m": near(0.005, 0.04), "w_m": near(0.002, 0.01), "h_m": near(0.001, 0.004, 5),
         "E_Pa": near(5e10, 2.1e11, 0)}
    l1, l2, w, h, E = (mpf(f[key]) for key in ("l1_m", "l2_m", "w_m", "h_m", "E_Pa"))
    F, EI = near(1, 40, 2), E * w * h**3 / 12
    # The clamped end bends by M/EI; integrate twice, then go straight on.
    slope = lambda x: -mp.quad(lambda s: F * (l1 + l2 - s) / EI, [0, min(x, l1)])
    sag = lambda x: mp.quad(slope, [0, min(x, l1)]) + (slope(l1) * (x - l1) if x > l1 else 0)
    case("flexure.stiffness", f, -F / sag(l1 + l2), "N/m")
    case("flexure.bending_stress", {**f, "F_N": F}, F * (l1 + l2) / (w * h**2 / 6), "Pa")
    for share in (0.4, 1.0, 1.3):
        x = float(f"{float(l1) * share:.6f}")
        if x > l1 + l2:
            continue
        at = {**f, "F_N": F, "x_m": x}
        case("flexure.deflection", at, sag(mpf(x)), "m", 1e-15)
        case("flexure.slope", at, slope(mpf(x)), "rad", 1e-14)
        case("flexure.moment_magnitude", at, F * (l1 + l2 - mpf(x)), "N m")
    error("flexure.deflection", {**f, "F_N": F, "x_m": float(l1 + l2) + 0.001}, "invalid_argument")
    error("flexure.stiffness", {**f, "h_m": 0}, "invalid_argument")


for _ in range(10):
    add_delta(random_delta())
add_delta_errors()
for turns in (1, 2, 3, 4.5):
    add_capstan(turns)
for _ in range(4):
    add_current_loop()
    add_actuator()
    add_flexure()
print("[\n" + ",\n".join(json.dumps(one) for one in CASES) + "\n]")
