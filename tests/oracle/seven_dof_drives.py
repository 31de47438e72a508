#!/usr/bin/env python3
"""Statics, balance, resolution and motors of the 7-DOF arm once more, to check the library's against: prints cases for
reference_cases.

    python3 tests/oracle/seven_dof_drives.py > tests/data/seven-dof-drives.json

In 40 digits. Torques are virtual work: the change of pose of a product of Denavit-Hartenberg transforms when one joint
moves a little, times the wrench. Weight is the change of potential energy of five points, found where they are in the
base frame. The counterweight is found by solving for the two distances at which the energy is the same in three
postures. Motors are swept over their load for the best efficiency. None of the library's equations, but for those that
define a quantity. Needs python3-mpmath. The cases are seeded; running it again gives the same file.
"""

import json
import random

from mpmath import mp, mpf, matrix, eye, sin, cos, pi, sqrt, lu_solve, findroot

mp.dps = 40
random.seed(20062)
CASES = []
ALPHA = [-pi / 2, pi / 2, -pi / 2, pi / 2, -pi / 2, pi / 2, mpf(0)]
STEP = mpf(10) ** -13  # of central differences: good to some 26 digits


def plain(x):
    if isinstance(x, mpf):
        return float(x)
    if isinstance(x, (list, tuple)):
        return [plain(one) for one in x]
    if isinstance(x, dict):
        return {key: plain(one) for key, one in x.items()}
    return x


def case(quantity, inputs, value, unit, tolerance, note=""):
    CASES.append(
        {
            "id": f"oracle.{len(CASES) + 1:03d}",
            "source": "tests/oracle/seven_dof_drives.py",
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


def wrist(theta, d3, d4):
    return frames(theta, d3, d4)[7]


def moved(theta, k, by):
    other = [mpf(t) for t in theta]
    other[k] += by
    return other


def holding_torques(theta, force, moment, d3, d4):
    """Torques that hold a wrench of the environment on the wrist: minus its work per joint angle."""
    here = wrist(theta, d3, d4)
    torques = []
    for k in range(7):
        ahead, behind = wrist(moved(theta, k, STEP), d3, d4), wrist(moved(theta, k, -STEP), d3, d4)
        work = sum(force[i] * (ahead[i, 3] - behind[i, 3]) for i in range(3)) / (2 * STEP)
        spin = (ahead[0:3, 0:3] - behind[0:3, 0:3]) / (2 * STEP) * here[0:3, 0:3].T
        omega = [spin[2, 1], spin[0, 2], spin[1, 0]]
        torques.append(-work - sum(moment[i] * omega[i] for i in range(3)))
    return torques


def turned(C, m, frame):
    """A moment in base components."""
    if frame == "base":
        return [mpf(x) for x in m]
    if frame == "tool":
        return [sum(C[i, j] * mpf(m[j]) for j in range(3)) for i in range(3)]
    return [sum(C[j, i] * mpf(m[j]) for j in range(3)) for i in range(3)]


def statics():
    for n in range(24):
        degrees = n % 2 == 0
        theta = [near(-170, 170, 1) for _ in range(7)] if degrees else [near(-3, 3) for _ in range(7)]
        angles = [mpf(t) * pi / 180 for t in theta] if degrees else theta
        d3, d4 = near(0.15, 0.4, 3), near(0.15, 0.4, 3)
        F, M = [near(-10, 10, 2) for _ in range(3)], [near(-0.5, 0.5, 3) for _ in range(3)]
        frame = ("base", "tool", "published")[n % 3]
        m = turned(wrist(angles, d3, d4), M, frame)
        torques = holding_torques(angles, [mpf(x) for x in F], m, d3, d4)
        inputs = {"theta_deg" if degrees else "theta_rad": theta, "F_N": F, "M_Nm": M, "moment_frame": frame}
        inputs.update({"d3_m": d3, "d4_m": d4})
        if n % 4 < 2:
            case("joint_torques", inputs, torques, "N m", 1e-11)
        else:
            joints = sorted(random.sample(range(1, 8), 4))
            case("abs_joint_torques", {**inputs, "joints": joints}, [abs(torques[j - 1]) for j in joints], "N m", 1e-11)


# -------------------------------------------------------------------------------------------------- balance

NAMES = ["m1_kg", "m3_kg", "m4_kg", "mL_kg", "mc_kg", "l1_m", "l2_m", "l3_m", "l4_m", "d1_m", "d2_m", "d3_m", "d4_m"]
PRINTED = [0.210, 0.160, 0.170, 0.120, 0.570, 0.250, -0.045, 0.130, 0.190, 0.250, 0.100, 0.065, 0.045]


def stage():
    return {name: float(f"{value * random.uniform(0.7, 1.3):.4f}") for name, value in zip(NAMES, PRINTED)}


def masses(s, theta, l3=None, d4=None):
    """The moving masses and where they are in the base frame."""
    T = frames(list(theta) + [0] * (7 - len(theta)), s["l1_m"], s["d1_m"])
    upper, fore = T[2][0:3, 2], T[4][0:3, 2]
    l3 = mpf(s["l3_m"]) if l3 is None else l3
    d4 = mpf(s["d4_m"]) if d4 is None else d4
    elbow = upper * mpf(s["l1_m"])
    return [
        (mpf(s["m1_kg"]), upper * mpf(s["l2_m"])),
        (mpf(s["m3_kg"]), elbow - upper * mpf(s["l4_m"]) - fore * mpf(s["d2_m"])),
        (mpf(s["m4_kg"]), elbow + fore * mpf(s["d3_m"])),
        (mpf(s["mL_kg"]), elbow + fore * mpf(s["d1_m"])),
        (mpf(s["mc_kg"]), -upper * l3 - fore * d4),
    ]


def mass_centre(bodies):
    total = sum(m for m, _ in bodies)
    return [sum(m * p[i] for m, p in bodies) / total for i in range(3)]


def energy(s, theta, g, l3=None, d4=None):
    return g * sum(m * p[2] for m, p in masses(s, theta, l3, d4))


def balance():
    for n in range(10):
        s = stage()
        total = sum(mpf(s[name]) for name in NAMES[:5])
        # Straight up and bent by a right angle, the mass centre shows both residuals.
        up = mass_centre(masses(s, [0, 0, 0, 0]))[2] * total
        bent = mass_centre(masses(s, [0, 0, 0, pi / 2]))
        A, B = bent[2] * total, bent[0] * total
        assert abs(A + B - up) < mpf(10) ** -35
        case("balance_residuals", s, [A, B], "kg m", 1e-14)
        if n % 2 == 0:
            case("balance_residual_over_mc_l3", s, A / (mpf(s["mc_kg"]) * mpf(s["l3_m"])), "-", 1e-13)
        else:
            case("balance_residual_over_mL_d1", s, B / (mpf(s["mL_kg"]) * mpf(s["d1_m"])), "-", 1e-13)
        theta = [near(-3, 3) for _ in range(7)]
        case("mass_centre", {"theta_rad": theta, **s}, mass_centre(masses(s, theta[:4])), "m", 1e-13)
        g = near(1.6, 9.9, 3)
        torque = []
        for k in range(4):
            ahead, behind = energy(s, moved(theta[:4], k, STEP), g), energy(s, moved(theta[:4], k, -STEP), g)
            torque.append((ahead - behind) / (2 * STEP))
        case("gravity_torque", {"theta_rad": theta, "g_mps2": g, **s}, torque, "N m", 1e-12)
        # The same energy in three postures: two linear equations in l3 and d4.
        postures = [[0, mpf("0.3"), mpf("0.2"), mpf("0.9")], [0, mpf("1.1"), mpf("-0.4"), mpf("2.0")], [0, mpf("2.0"), 1, 1]]
        base = [energy(s, q, 1, mpf(0), mpf(0)) for q in postures]
        by_l3 = [energy(s, q, 1, mpf(1), mpf(0)) - e for q, e in zip(postures, base)]
        by_d4 = [energy(s, q, 1, mpf(0), mpf(1)) - e for q, e in zip(postures, base)]
        M = matrix([[by_l3[i] - by_l3[2], by_d4[i] - by_d4[2]] for i in range(2)])
        x = lu_solve(M, matrix([base[2] - base[i] for i in range(2)]))
        case("balancing_counterweight", s, {"l3_m": x[0], "d4_m": x[1]}, "m", 1e-13)


# ----------------------------------------------------------------------------------------------- resolution


def resolution():
    for n in range(14):
        count = 4 if n % 3 == 0 else 7
        theta = [near(-150, 150, 1) for _ in range(count)]
        joint, step = random.randint(1, 4), near(0.001, 0.1, 5)
        d3, d4 = near(0.15, 0.4, 3), near(0.15, 0.4, 3)
        angles = [mpf(t) * pi / 180 for t in theta] + [mpf(0)] * (7 - count)
        here, there = wrist(angles, d3, d4), wrist(moved(angles, joint - 1, mpf(step) * pi / 180), d3, d4)
        distance = sqrt(sum((there[i, 3] - here[i, 3]) ** 2 for i in range(3)))
        inputs = {"theta_deg": theta, "joint": joint, "step_deg": step, "d3_m": d3, "d4_m": d4}
        case("translational_resolution", inputs, distance, "m", 1e-14)
    for n in range(6):
        counts, ratio = random.choice([500, 512, 1000, 1024, 2048, 5000]), near(1, 25, 3)
        case("joint_step_deg", {"counts": counts, "ratio": ratio}, mpf(360) / (mpf(counts) * mpf(ratio)), "deg", 1e-15)


# --------------------------------------------------------------------------------------------------- motors


def motors():
    for n in range(6):
        U, R = near(6, 60, 1), near(0.3, 20, 3)
        kt, J, I0 = near(0.004, 0.1, 5), near(1e-7, 2e-5, 9), near(0.01, 0.1, 4) * U / R / 5
        I0 = float(f"{I0:.5f}")
        inputs = {"U_V": U, "R_ohm": R, "kt_Nm_per_A": kt, "J_kgm2": J, "I0_A": I0}
        u, r, k, j, i0 = (mpf(x) for x in (U, R, kt, J, I0))
        rpm = 30 / pi

        def torque(speed):  # of the shaft, with friction k I0, at a speed [rad/s]
            return k * ((u - k * speed) / r - i0)

        def still(speed):
            return k * (u - k * speed) / r

        case("stall_torque", inputs, still(0), "N m", 1e-13)
        case("speed_constant", inputs, rpm / k, "rpm/V", 1e-10)
        free = findroot(torque, u / k)
        case("no_load_speed", inputs, free * rpm, "rpm", 1e-9)
        gradient = (still(0) - still(1)) ** -1 * rpm / 1000
        case("speed_torque_gradient", inputs, gradient, "rpm/mNm", 1e-9)
        # The time in which the speed would be reached if it went on rising as at first.
        case("mechanical_time_constant", inputs, (u / k) / (still(0) / j), "s", 1e-14)
        # Best share of the power over all currents, by golden section.
        low, high = i0, u / r
        golden = (sqrt(mpf(5)) - 1) / 2

        def efficiency(current):
            return k * (current - i0) * ((u - r * current) / k) / (u * current)

        for _ in range(200):
            a, b = high - golden * (high - low), low + golden * (high - low)
            if efficiency(a) > efficiency(b):
                high = b
            else:
                low = a
        case("max_efficiency", inputs, efficiency((low + high) / 2), "-", 1e-14)
    for n in range(5):
        Q, i, eta = near(0.01, 6, 4), near(1, 25, 3), near(0.5, 1, 3)
        case("motor_torque", {"Q_Nm": Q, "ratio": i, "efficiency": eta}, mpf(Q) / mpf(i) / mpf(eta), "N m", 1e-14)
        case("output_torque", {"M_Nm": Q, "ratio": i, "efficiency": eta}, mpf(Q) * mpf(i) * mpf(eta), "N m", 1e-12)
    for num, den in ((3249, 169), (27, 5), (57, 13), (185193, 2197)):
        case("reduction", {"num": num, "den": den}, mpf(num) / mpf(den), "-", 1e-12)
    case("motor_torque", {"Q_Nm": 1.0, "ratio": 0, "efficiency": 1.0}, "error:invalid_argument", "N m", 0)
    case("output_torque", {"M_Nm": 1.0, "ratio": 10, "efficiency": -0.5}, "error:invalid_argument", "N m", 0)
    case("reduction", {"num": 27, "den": 0}, "error:invalid_argument", "-", 0)


def rest():
    for x in (0.25, 3.0, 12.5):
        # One pound force is 0.45359237 kg x 9.80665 m/s^2, one foot 0.3048 m, by definition.
        lbf = mpf("0.45359237") * mpf("9.80665")
        case("newton_of_lbf", {"lbf": x}, mpf(x) * lbf, "N", 1e-12)
        case("newtonmetre_of_lbf_ft", {"lbf_ft": x}, mpf(x) * lbf * mpf("0.3048"), "N m", 1e-12)
        case("metre_of_foot", {"ft": x}, mpf(x) * mpf("0.3048"), "m", 1e-12)
    for n in range(3):
        m, x, g = near(0.1, 2, 3), near(0.001, 0.01, 5), near(9.7, 9.9, 3)
        inputs = {"mass_kg": m, "deflection_m": x, "g_mps2": g}
        case("stiffness", inputs, mpf(m) * mpf(g) / mpf(x), "N/m", 1e-9)


statics()
balance()
resolution()
motors()
rest()
print("[")
print(",\n".join(json.dumps(one) for one in CASES))
print("]")
