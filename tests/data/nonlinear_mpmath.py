"""Reference for the nonlinear error model: python3 nonlinear_mpmath.py > nonlinear_mpmath.json

Eqs. (4)-(6) of the seed paper by plain matrix products in 60 digits: position error (m) and rotation
vector (rad) of prod(A_i + dA_i) against prod(A_i). Inputs are f64 and enter the products as they are,
with two exceptions that follow the crate: an alpha that is the f64 nearest to a multiple of pi/2
counts as that multiple, and coupled sums and theta + q, r + q are rounded to f64 before they are used.
Every number is written as text, because JSON readers do not all round to the nearest f64.

The last robots have errors of joint frames, too: x, y, z, rx, ry, rz in a frame that `joint_frames` gives
in the D-H frame before each row (translation, then roll, pitch, yaw about fixed axes).
"""

import json
import math
import random

from mpmath import atan2, cos, diag, matrix, mp, mpf, nstr, pi, sin, sqrt

mp.dps = 60
RNG = random.Random(20261)
SCALES = [1.0, 1e-3, 1e-6]  # of errors up to 1 mm and 0.5 degrees
RIGHT = math.pi / 2


def twist(alpha):
    quarters = round(alpha / RIGHT)
    return quarters * pi / 2 if alpha == quarters * RIGHT else mpf(alpha)


def link(theta, r, l, alpha):
    c, s, ca, sa = cos(theta), sin(theta), cos(alpha), sin(alpha)
    return matrix(
        [[c, -s * ca, s * sa, l * c], [s, c * ca, -c * sa, l * s], [0, sa, ca, r], [0, 0, 0, 1]]
    )


def coupled(row, values):
    total = 0.0
    for factor, value in zip(row, values):
        total += factor * value
    return total


def frame(values):
    """Trans(x, y, z) Rz Ry Rx."""
    (x, y, z, rx, ry, rz) = [mpf(v) for v in values]
    t = link(rz, 0, 0, 0) * matrix(
        [[cos(ry), 0, sin(ry), 0], [0, 1, 0, 0], [-sin(ry), 0, cos(ry), 0], [0, 0, 0, 1]]
    )
    t = t * link(mpf(0), 0, 0, rx)
    t[0, 3], t[1, 3], t[2, 3] = x, y, z
    return t


def inverse(t):
    r = t[:3, :3].T
    p = r * t[:3, 3]
    out = diag([1, 1, 1, 1])
    for i in range(3):
        out[i, 3] = -p[i]
        for j in range(3):
            out[i, j] = r[i, j]
    return out


def tip(robot, errors):
    """Rotation after the last link and position of the TCP."""
    t = diag([1, 1, 1, 1])
    for i, prismatic in enumerate(robot["prismatic"]):
        move = coupled(robot["coupling"][i], robot["q"])
        error = coupled(robot["coupling"][i], errors["dq"])
        turn, slide, dturn, dslide = (0.0, move, 0.0, error) if prismatic else (move, 0.0, error, 0.0)
        theta = mpf(robot["theta"][i] + turn) + mpf(dturn)
        r = mpf(robot["r"][i] + slide) + mpf(errors["dr"][i]) + mpf(dslide)
        l = mpf(robot["l"][i]) + mpf(errors["dl"][i])
        if "joints" in errors:
            at = frame(robot["joint_frames"][i])
            t = t * at * frame(errors["joints"][6 * i : 6 * i + 6]) * inverse(at)
        t = t * link(theta, r, l, twist(robot["alpha"][i]) + mpf(errors["dalpha"][i]))
    return t[:3, :3], (t * matrix([mpf(x) for x in robot["tool"]] + [1]))[:3]


def pose_error(robot, errors):
    n = len(robot["q"])
    nothing = {key: [0.0] * len(values) for key, values in errors.items()}
    (r0, p0), (r1, p1) = tip(robot, nothing), tip(robot, errors)
    d = r1 * r0.T
    axis = [(d[2, 1] - d[1, 2]) / 2, (d[0, 2] - d[2, 0]) / 2, (d[1, 0] - d[0, 1]) / 2]
    sine = sqrt(sum(x * x for x in axis))
    angle = atan2(sine, (d[0, 0] + d[1, 1] + d[2, 2] - 1) / 2)
    return [p1[i] - p0[i] for i in range(3)], [x * angle / sine for x in axis]


def uniform(n, bound):
    return [RNG.uniform(-bound, bound) for _ in range(n)]


def identity(n):
    return [[float(i == j) for j in range(n)] for i in range(n)]


def hitachi(coupling):
    return {
        "prismatic": [False] * 4,
        "theta": [RIGHT, RIGHT, -RIGHT, 0.0],
        "r": [0.75, 0.0, 0.0, 0.0],
        "l": [0.0, 0.6, 0.85, 0.4],
        "alpha": [RIGHT, 0.0, 0.0, 0.0],
        "q": uniform(4, 0.7),
        "coupling": coupling,
        "tool": [0.0, 0.0, 0.0],
    }


def random_robot(k):
    """Every second one has right angles only; every third one slides, every fourth one couples."""
    n = RNG.randint(2, 7)
    quarters = [RNG.choice([-1, 0, 0, 1, 2]) * RIGHT for _ in range(n)]
    coupling = identity(n)
    if k % 4 == 3:
        for i in range(1, n):
            coupling[i][RNG.randrange(i)] = RNG.choice([-1.0, 1.0, 0.5, -0.3])
    return {
        "prismatic": [k % 3 == 2 and RNG.random() < 0.4 for _ in range(n)],
        "theta": uniform(n, math.pi),
        "r": uniform(n, 1.0),
        "l": uniform(n, 1.0),
        "alpha": quarters if k % 2 == 0 else uniform(n, math.pi),
        "q": uniform(n, math.pi),
        "coupling": coupling,
        "tool": uniform(3, 0.3) if k % 5 else [0.0, 0.0, 0.0],
    }


def as_text(values):
    """Numbers of one field; repr reads back to the same bits."""
    return [as_text(v) if isinstance(v, list) else repr(v) for v in values]


def case(robot, scale, unscaled):
    errors = {key: [scale * x for x in values] for key, values in unscaled.items()}
    position, rotation = pose_error(robot, errors)
    return {key: as_text(values) for key, values in errors.items()} | {
        "scale": scale,
        "position": [nstr(x, 25) for x in position],
        "rotation": [nstr(x, 25) for x in rotation],
    }


def with_joint_frames(k):
    robot = random_robot(k)
    n = len(robot["q"])
    robot["joint_frames"] = [uniform(3, 0.5) + uniform(3, math.pi) for _ in range(n)]
    angle = math.radians(0.5)
    errors = {key: uniform(n, bound) for key, bound in {"dq": 1e-3, "dr": 1e-3, "dl": 1e-3, "dalpha": angle}.items()}
    errors["joints"] = [x for _ in range(n) for x in uniform(3, 1e-3) + uniform(3, angle)]
    text = {key: values if key == "prismatic" else as_text(values) for key, values in robot.items()}
    return json.dumps(text | {"cases": [case(robot, s, errors) for s in SCALES]})


def main():
    parallelogram = identity(4)
    parallelogram[2][1] = -1.0
    robots = [hitachi(identity(4)) for _ in range(3)] + [hitachi(parallelogram) for _ in range(3)]
    robots += [random_robot(k) for k in range(54)]
    lines = []
    for robot in robots:
        n = len(robot["q"])
        angle = math.radians(0.5)
        bounds = {"dq": angle, "dr": 1e-3, "dl": 1e-3, "dalpha": angle}
        errors = {key: uniform(n, bound) for key, bound in bounds.items()}
        for i, prismatic in enumerate(robot["prismatic"]):
            if prismatic:
                errors["dq"][i] = RNG.uniform(-1e-3, 1e-3)
        text = {key: values if key == "prismatic" else as_text(values) for key, values in robot.items()}
        lines.append(json.dumps(text | {"cases": [case(robot, s, errors) for s in SCALES]}))
    lines += [with_joint_frames(k) for k in range(12)]
    print("[\n" + ",\n".join(lines) + "\n]")


main()
