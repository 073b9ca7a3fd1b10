"""Flange poses of the robots in cells/robots, without Denavit-Hartenberg rows: writes robots.json.

Each robot is described a second time, by the joint origins of its maker's or a public ROS package
(translation, roll-pitch-yaw, axis), by points and axes read off its drawing in the zero posture, or by
plane trigonometry. The joint origins of most are in urdf_chains.py. From the robot files only joint
limits and home are read, to choose the postures.

    python3 tests/data/robots.py        (numpy, Python 3.11)
"""

import json
import math
import tomllib
from pathlib import Path

import numpy as np
from urdf_chains import CHAINS, O, RIGHT, X, Y, Z, chain, rpy, turn

ROBOTS = Path(__file__).parent.parent.parent / "cells" / "robots"
POSES = 20
SEED = 20260


def deg(*angles):
    return [math.radians(a) for a in angles]


def last(frames):
    return lambda q: frames(q)[-1]


# frankaemika/franka_ros, franka_description/robots/panda_arm.xacro; flange: link 8.
PANDA = chain(
    ((0, 0, 0.333), O, Z),
    (O, (-RIGHT, 0, 0), Z),
    ((0, -0.316, 0), (RIGHT, 0, 0), Z),
    ((0.0825, 0, 0), (RIGHT, 0, 0), Z),
    ((-0.0825, 0.384, 0), (-RIGHT, 0, 0), Z),
    (O, (RIGHT, 0, 0), Z),
    ((0.088, 0, 0), (RIGHT, 0, 0), Z),
    ((0, 0, 0.107), O, None),
)

# ros-industrial/abb_experimental, abb_irb140_support/urdf/irb140t_6_81_macro.xacro; flange: tool0.
IRB140 = chain(
    ((0, 0, 0.104), O, Z),
    ((0.07, 0, 0.248), O, Y),
    ((0, 0, 0.360), O, Y),
    ((0.380, 0, 0), O, X),
    (O, O, Y),
    ((0.065, 0, 0), O, X),
    (O, (0, RIGHT, 0), None),
)

# ros-industrial/kuka_experimental, kuka_kr6_support/urdf/kr6r900sixx_macro.xacro; flange: tool0.
KR6 = chain(
    ((0, 0, 0.400), O, -Z),
    ((0.025, 0, 0), O, Y),
    ((0.455, 0, 0), O, Y),
    ((0, 0, 0.035), O, -X),
    ((0.420, 0, 0), O, Y),
    ((0.080, 0, 0), O, -X),
    (O, (0, RIGHT, 0), None),
)

# FANUC-CORPORATION/fanuc_description, crx10ia_urdf_macro.xacro; flange: as tool0 of ros-industrial/fanuc,
# fanuc_crx10ia_support/urdf/crx10ial_macro.xacro.
CRX10IA = chain(
    ((0, 0, 0.245), O, Z),
    (O, O, Y),
    ((0, 0, 0.540), O, -Y),
    (O, O, -X),
    ((0.540, 0, 0), O, -Y),
    ((0, -0.150, 0), O, -X),
    ((0.160, 0, 0), O, None),
    (O, (math.pi, -RIGHT, 0), None),
)

# youbot/youbot-ros-pkg, youbot_description/urdf/youbot_arm/arm.urdf.xacro, from the upright posture: the
# first origin without the 24 mm to axis 1, the last 113.6 mm (see the robot file); axes 1 and 5 upward.
YOUBOT = chain(
    ((0, 0, 0.096), O, Z),
    ((0.033, 0, 0.019), O, Y),
    ((0, 0, 0.155), O, Y),
    ((0, 0, 0.135), O, Y),
    ((0, 0, 0.1136), O, Z),
)


def universal(d1, a2, a3, d4, d5, d6):
    """Universal_Robots_ROS2_Description, config/*/default_kinematics.yaml (commit 2221ec0), in the frame
    `base`; tool0 is the frame of wrist 3. Its angles of 1.570796327 are right angles here, and its
    offsets below 1e-10 m are 0."""
    return chain(
        ((0, 0, d1), O, Z),
        (O, (RIGHT, 0, 0), Z),
        ((a2, 0, 0), O, Z),
        ((a3, 0, d4), O, Z),
        ((0, -d5, 0), (RIGHT, 0, 0), Z),
        ((0, d6, 0), (RIGHT, math.pi, math.pi), Z),
    )


# Points and axes of Corke and Armstrong-Helouvry's PUMA in its zero posture: upper arm along x, forearm
# up, shoulder offset towards -y; flange offset of Fu, Gonzalez and Lee.
PUMA_ARM = (
    (O, O, -Y),
    ((0.4318, 0, 0), O, -Y),
    ((0.0203, -0.15005, 0), O, Z),
    ((0, 0, 0.4318), O, -Y),
    (O, O, Z),
    ((0, 0, 0.05625), O, None),
)
PUMA = chain(((0, 0, 26.45 * 0.0254), O, Z), *PUMA_ARM)
TRACK = chain((O, O, Y, "slide"), ((0, 0, 0.25 + 26.45 * 0.0254), O, Z), *PUMA_ARM)

# The Stanford arm with the boom upright: shoulder 412 mm high, boom 154 mm aside.
STANFORD = chain(
    ((0, 0, 0.412), O, Z),
    ((0, 0.154, 0), O, Y),
    (O, O, Z, "slide"),
    (O, O, Z),
    (O, O, X),
    (O, O, Z),
    ((0, 0, 0.150), (0, 0, -RIGHT), None),
)


def cobra(q):
    """Two bars in the plane, a quill that goes down, a roll about the downward axis."""
    a, b = q[0], q[0] + q[1]
    x = 0.325 * math.cos(a) + 0.275 * math.cos(b)
    y = 0.325 * math.sin(a) + 0.275 * math.sin(b)
    return np.array([x, y, 0.387 - q[2]]), rpy(math.pi, 0, b) @ turn(Z, q[3])


def irb460(q):
    """A parallelogram: the two arms keep their own angle to the floor; the flange looks down."""
    yaw, lower, upper, _, roll = q
    out = 0.260 + 0.945 * math.sin(lower) + 1.025 * math.cos(upper) + 0.225
    up = 0.745 + 0.945 * math.cos(lower) - 1.025 * math.sin(upper) - 0.2515
    return np.array([out * math.cos(yaw), out * math.sin(yaw), up]), rpy(0, math.pi, yaw) @ turn(Z, roll)


def hitachi(relative):
    """The seed paper's arm: elevations of upper arm (from the vertical), forearm and tool."""

    def pose(q):
        yaw, upper = q[0] + RIGHT, q[1] + RIGHT
        fore = q[2] + (q[1] if relative else 0)
        tool = fore + q[3]
        out = 0.600 * math.cos(upper) + 0.850 * math.cos(fore) + 0.400 * math.cos(tool)
        up = 0.750 + 0.600 * math.sin(upper) + 0.850 * math.sin(fore) + 0.400 * math.sin(tool)
        radial = np.array([math.cos(yaw), math.sin(yaw), 0])
        x = math.cos(tool) * radial + math.sin(tool) * Z
        y = -math.sin(tool) * radial + math.cos(tool) * Z
        return out * radial + up * Z, np.column_stack([x, y, np.cross(x, y)])

    return pose


POSE = {
    "abb_irb140": last(IRB140),
    "abb_irb460": irb460,
    "adept_cobra_s600": cobra,
    "fanuc_crx10ia": last(CRX10IA),
    "franka_panda": last(PANDA),
    "hitachi_pw10": hitachi(True),
    "hitachi_pw10_parallelogram": hitachi(False),
    "kuka_kr6_r900": last(KR6),
    "kuka_youbot": last(YOUBOT),
    "puma560": last(PUMA),
    "puma560_on_track": last(TRACK),
    "stanford_arm": last(STANFORD),
    **{name: last(frames) for name, frames in CHAINS.items()},
    "ur3e": last(universal(0.15185, -0.24355, -0.2132, 0.13105, 0.08535, 0.0921)),
    "ur5e": last(universal(0.1625, -0.425, -0.3922, 0.1333, 0.0997, 0.0996)),
    "ur10": last(universal(0.1273, -0.612, -0.5723, 0.163941, 0.1157, 0.0922)),
    "ur10e": last(universal(0.1807, -0.6127, -0.57155, 0.17415, 0.11985, 0.11655)),
    "ur16e": last(universal(0.1807, -0.4784, -0.36, 0.17415, 0.11985, 0.11655)),
    "ur20": last(universal(0.2363, -0.862, -0.7287, 0.201, 0.1593, 0.1543)),
}

# Where the frames of the rows are, too: of a robot with modified rows they are those of its URDF.
FRAMES = {"franka_panda": lambda q: PANDA(q)[:7]}


def robot_file(name):
    text = tomllib.loads((ROBOTS / f"{name}.toml").read_text())
    under = robot_file(Path(text.pop("from")).stem) if "from" in text else {}
    return under | text


def limits(joint):
    """In rad or m."""
    if joint.get("kind") == "passive":
        return 0.0, 0.0
    if joint.get("kind") == "prismatic":
        return tuple(v / 1000 for v in joint["limits_mm"])
    return tuple(map(math.radians, joint["limits_deg"]))


def home(file, ranges):
    if "home" not in file:
        return [0.0 if low <= 0 <= high else (low + high) / 2 for low, high in ranges]
    slides = [joint.get("kind") == "prismatic" for joint in file["joint"]]
    return [v / 1000 if s else math.radians(v) for v, s in zip(file["home"], slides)]


def poses(name):
    # A seed of its own: a new robot leaves the postures of the others alone.
    rng = np.random.default_rng([SEED, *name.encode()])
    file = robot_file(name)
    ranges = [limits(joint) for joint in file["joint"]]
    low, high = np.array(ranges).T
    for q in [home(file, ranges), *rng.uniform(low, high, (POSES, len(ranges)))]:
        q = [float(v) for v in q]
        p, r = POSE[name](q)
        pose = {"q": q, "p": p.tolist(), "r": r.ravel().tolist()}
        if name in FRAMES:
            pose["frames"] = [f[0].tolist() for f in FRAMES[name](q)]
        yield json.dumps(pose)


def main():
    lines = ['"%s": [\n%s\n]' % (name, ",\n".join(poses(name))) for name in sorted(POSE)]
    path = Path(__file__).with_name("robots.json")
    path.write_text("{\n%s\n}\n" % ",\n".join(lines))


main()
