"""Joint origins of public ROS packages: a second description of robots in cells/robots.

A part of a chain is `(xyz, rpy, axis)` of a joint, in m and rad, as its URDF states them. Roundings are
undone: 1.5708 and 1.571 are a quarter turn, 3.1416 is half a turn. An end named after a file is its
flange. robots.py makes poses of these chains.
"""

import math

import numpy as np

X, Y, Z = np.eye(3)
O = (0, 0, 0)
RIGHT, HALF = math.pi / 2, math.pi


def turn(axis, angle):
    """Rodrigues' formula."""
    x, y, z = axis
    k = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + math.sin(angle) * k + (1 - math.cos(angle)) * (k @ k)


def rpy(roll, pitch, yaw):
    return turn(Z, yaw) @ turn(Y, pitch) @ turn(X, roll)


def chain(*parts):
    """A serial chain of `(xyz, rpy, axis)`, axis None where nothing moves, "slide" before one that slides.

    Gives the poses of all frames at q."""

    def frames(q):
        r, p, k, all_frames = np.eye(3), np.zeros(3), 0, []
        for xyz, angles, axis, *slides in parts:
            p = p + r @ np.array(xyz)
            r = r @ rpy(*angles)
            if axis is not None:
                if slides:
                    p = p + r @ (axis * q[k])
                else:
                    r = r @ turn(axis, q[k])
                k += 1
            all_frames.append((p, r))
        return all_frames

    return frames


CHAINS = {
    # ros-industrial/abb_experimental @ 20b9cf86, abb_irb120_support/urdf/irb120_3_58_macro.xacro; flange: tool0.
    "abb_irb120": chain(
        (O, O, Z),
        ((0, 0, 0.29), O, Y),
        ((0, 0, 0.27), O, Y),
        ((0, 0, 0.07), O, X),
        ((0.302, 0, 0), O, Y),
        ((0.072, 0, 0), O, X),
        (O, (0, RIGHT, 0), None),
    ),
    # ros-industrial/abb_experimental @ 20b9cf86, abb_irb1200_support/urdf/irb1200_5_90_macro.xacro; tool0.
    "abb_irb1200": chain(
        ((0, 0, 0.3991), O, Z),
        (O, O, Y),
        ((0, 0, 0.448), O, Y),
        ((0, 0, 0.042), O, X),
        ((0.451, 0, 0), O, Y),
        ((0.082, 0, 0), O, X),
        (O, (0, RIGHT, 0), None),
    ),
    # ros-industrial/abb_experimental @ 20b9cf86, abb_irb4600_support/urdf/irb4600_60_205_macro.xacro; tool0.
    "abb_irb4600": chain(
        ((0, 0, 0.495), O, Z),
        ((0.175, 0, 0), O, Y),
        ((0, 0, 0.9), O, Y),
        ((0, 0, 0.175), O, X),
        ((0.96, 0, 0), O, Y),
        ((0.135, 0, 0), O, X),
        (O, (0, RIGHT, 0), None),
    ),
    # ros-industrial/abb_experimental @ 20b9cf86, abb_irb6700_support/urdf/irb6700_200_260_macro.xacro; tool0.
    "abb_irb6700": chain(
        ((0, 0, 0.78), O, Z),
        ((0.32, 0, 0), O, Y),
        ((0, 0, 1.125), O, Y),
        ((0, 0, 0.2), O, X),
        ((1.1425, 0, 0), O, Y),
        ((0.2, 0, 0), O, X),
        (O, (0, RIGHT, 0), None),
    ),
    # CNR-STIIMA-IRAS/comau-experimental @ 35a4f1e5, comau_ns16arc_support/urdf/comau_ns16arc.urdf; Flange.
    "comau_ns16": chain(
        ((0, 0, 0.251), (-HALF, 0, 0), Z),
        ((0.3, 0.101, -0.349), (-RIGHT, 0, HALF), Z),
        ((0, 0.7, 0), (HALF, 0, RIGHT), Z),
        ((0.238, 0.185, -0.101), (-RIGHT, 0, RIGHT), Z),
        ((0, 0, -0.386), (-RIGHT, RIGHT, 0), Z),
        ((0.106, 0, 0), (RIGHT, 0, -RIGHT), Z),
        ((0, 0, -0.014), (HALF, 0, HALF), None),
    ),
    # DENSORobot/denso_robot_ros @ 0bd656cd, denso_robot_descriptions/vs060_description/vs060.urdf; J6.
    "denso_vs060": chain(
        ((0, 0, 0.1815), O, Z),
        ((0, 0, 0.1635), O, Y),
        ((0, 0, 0.305), O, Y),
        ((-0.01, 0, 0.1645), O, Z),
        ((0, 0, 0.1355), O, Y),
        ((0, 0, 0.07), O, Z),
    ),
    # DoosanRobotics/doosan-robot2 @ ec924254, dsr_description2/urdf/m1013.urdf; link_6.
    "doosan_m1013": chain(
        ((0, 0, 0.1525), O, Z),
        ((0, 0.0345, 0), (0, -RIGHT, -RIGHT), Z),
        ((0.62, 0, 0), (0, 0, RIGHT), Z),
        ((0, -0.559, 0), (RIGHT, 0, 0), Z),
        (O, (-RIGHT, 0, 0), Z),
        ((0, -0.121, 0), (RIGHT, 0, 0), Z),
    ),
    # ros-industrial/fanuc @ 8fee5e30, fanuc_lrmate200id_support/urdf/lrmate200id_macro.xacro; tool0.
    "fanuc_lrmate200id": chain(
        ((0, 0, 0.33), O, Z),
        ((0.05, 0, 0), O, Y),
        ((0, 0, 0.33), O, -Y),
        ((0, 0, 0.035), O, -X),
        ((0.335, 0, 0), O, -Y),
        ((0.08, 0, 0), O, -X),
        (O, (HALF, -RIGHT, 0), None),
    ),
    # ros-industrial/fanuc @ 8fee5e30, fanuc_m20ia_support/urdf/m20ia_macro.xacro; tool0.
    "fanuc_m20ia": chain(
        ((0, 0, 0.525), O, Z),
        ((0.15, 0, 0), O, Y),
        ((0, 0, 0.79), O, -Y),
        ((0, 0, 0.25), O, -X),
        ((0.835, 0, 0), O, -Y),
        ((0.1, 0, 0), O, -X),
        (O, (HALF, -RIGHT, 0), None),
    ),
    # ros-industrial/fanuc_experimental @ 39929f69, fanuc_r2000ic_support/urdf/r2000ic165f_macro.xacro; tool0.
    "fanuc_r2000ic_165f": chain(
        ((0, 0, 0.67), O, Z),
        ((0.312, 0, 0), O, Y),
        ((0, 0, 1.075), O, -Y),
        ((0, 0, 0.225), O, -X),
        ((1.28, 0, 0), O, -Y),
        ((0.215, 0, 0), O, -X),
        (O, (HALF, -RIGHT, 0), None),
    ),
    # Kawasaki-Robotics/khi_robot @ 57200db5, khi_rs_description/urdf/rs007n_macro.xacro; link6.
    "kawasaki_rs007n": chain(
        ((0, 0, 0.36), O, -Z),
        (O, (0, -RIGHT, 0), Z),
        ((0.355, 0, 0), O, -Z),
        ((0.0925, 0, 0), (0, RIGHT, 0), Z),
        ((0, 0, 0.2825), (0, -RIGHT, 0), -Z),
        ((0.078, 0, 0), (0, RIGHT, 0), Z),
    ),
    # Kinovarobotics/ros_kortex @ 6cd75d45, kortex_description/arms/gen3/7dof, gen3_macro.xacro; end_effector_link.
    "kinova_gen3": chain(
        ((0, 0, 0.15643), (HALF, 0, 0), Z),
        ((0, 0.005375, -0.12838), (RIGHT, 0, 0), Z),
        ((0, -0.21038, -0.006375), (-RIGHT, 0, 0), Z),
        ((0, 0.006375, -0.21038), (RIGHT, 0, 0), Z),
        ((0, -0.20843, -0.006375), (-RIGHT, 0, 0), Z),
        ((0, 0.00017505, -0.10593), (RIGHT, 0, 0), Z),
        ((0, -0.10593, -0.00017505), (-RIGHT, 0, 0), Z),
        ((0, 0, -0.061525), (HALF, 0, 0), None),
    ),
    # IFL-CAMP/iiwa_stack @ 44f9d13c, iiwa_description/urdf/iiwa14.xacro; iiwa_link_ee.
    "kuka_iiwa14": chain(
        ((0, 0, 0.1575), O, Z),
        ((0, 0, 0.2025), (RIGHT, 0, HALF), Z),
        ((0, 0.2045, 0), (RIGHT, 0, HALF), Z),
        ((0, 0, 0.2155), (RIGHT, 0, 0), Z),
        ((0, 0.1845, 0), (-RIGHT, HALF, 0), Z),
        ((0, 0, 0.2155), (RIGHT, 0, 0), Z),
        ((0, 0.081, 0), (-RIGHT, HALF, 0), Z),
        ((0, 0, 0.045), O, None),
    ),
    # ros-industrial/kuka_experimental @ e78bbd15, kuka_kr10_support/urdf/kr10r1100sixx_macro.xacro; tool0.
    "kuka_kr10_r1100": chain(
        ((0, 0, 0.4), O, -Z),
        ((0.025, 0, 0), O, Y),
        ((0.56, 0, 0), O, Y),
        ((0, 0, 0.035), O, -X),
        ((0.515, 0, 0), O, Y),
        ((0.08, 0, 0), O, -X),
        (O, (0, RIGHT, 0), None),
    ),
    # ros-industrial/kuka_experimental @ e78bbd15, kuka_kr150_support/urdf/kr150r3100_2_macro.xacro; tool0.
    "kuka_kr150_r3100_2": chain(
        ((0, 0, 0.645), O, -Z),
        ((0.33, 0, 0), O, Y),
        ((1.35, 0, 0), O, Y),
        ((1.42, 0, 0.115), O, -X),
        (O, O, Y),
        ((0.215, 0, 0), O, -X),
        (O, (0, RIGHT, 0), None),
    ),
    # ros-industrial/kuka_experimental @ e78bbd15, kuka_kr16_support/urdf/kr16_2_macro.xacro; tool0.
    "kuka_kr16_2": chain(
        ((0, 0, 0.675), O, -Z),
        ((0.26, 0, 0), O, Y),
        ((0.68, 0, 0), O, Y),
        ((0.67, 0, -0.035), O, -X),
        (O, O, Y),
        (O, O, -X),
        ((0.158, 0, 0), O, None),
        (O, (0, RIGHT, 0), None),
    ),
    # ros-industrial/motoman @ 433be15f, motoman_gp12_support/urdf/gp12_macro.xacro; tool0.
    "motoman_gp12": chain(
        ((0, 0, 0.45), O, Z),
        ((0.155, 0, 0), O, Y),
        ((0, 0, 0.614), O, -Y),
        ((0.64, 0, 0.2), O, -X),
        (O, O, -Y),
        (O, O, -X),
        ((0.1, 0, 0), (HALF, -RIGHT, 0), None),
    ),
    # ros-industrial/motoman @ 433be15f, motoman_gp25_support/urdf/gp25_macro.xacro; tool0.
    "motoman_gp25": chain(
        ((0, 0, 0.505), O, Z),
        ((0.15, 0, 0), O, Y),
        ((0, 0, 0.76), O, -Y),
        ((0, 0, 0.2), O, -X),
        ((0.795, 0, 0), O, -Y),
        (O, O, -X),
        ((0.1, 0, 0), (HALF, -RIGHT, 0), None),
    ),
    # ros-industrial/motoman @ 433be15f, motoman_gp8_support/urdf/gp8_macro.xacro; tool0.
    "motoman_gp8": chain(
        ((0, 0, 0.33), O, Z),
        ((0.04, 0, 0), O, Y),
        ((0, 0, 0.345), O, -Y),
        ((0.34, 0, 0.04), O, -X),
        (O, O, -Y),
        (O, O, -X),
        ((0.08, 0, 0), (HALF, -RIGHT, 0), None),
    ),
    # ros-industrial/staubli_experimental @ 256a71ac, staubli_tx2_60_support/urdf/tx2_60_macro.xacro; tool0.
    "staubli_tx2_60": chain(
        ((0, 0, 0.375), O, Z),
        (O, O, Y),
        ((0, 0.02, 0.29), O, Y),
        (O, O, Z),
        ((0, 0, 0.31), O, Y),
        ((0, 0, 0.07), O, Z),
        (O, (0, -RIGHT, 0), None),
        (O, (0, RIGHT, 0), None),
    ),
    # ros-industrial/staubli_experimental @ 256a71ac, staubli_tx2_90_support/urdf/tx2_90_macro.xacro; tool0.
    "staubli_tx2_90": chain(
        ((0, 0, 0.478), O, Z),
        ((0.05, 0, 0), O, Y),
        ((0, 0.05, 0.425), O, Y),
        (O, O, Z),
        ((0, 0, 0.425), O, Y),
        ((0, 0, 0.1), O, Z),
        (O, (0, -RIGHT, 0), None),
        (O, (0, RIGHT, 0), None),
    ),
    # TechmanRobotInc/tmr_ros2 @ 684faab3, tm_description/urdf/tm5-900-nominal.urdf; flange.
    "techman_tm5_900": chain(
        ((0, 0, 0.1452), O, Z),
        (O, (-RIGHT, -RIGHT, 0), Z),
        ((0.429, 0, 0), O, Z),
        ((0.4115, 0, -0.1223), (0, 0, RIGHT), Z),
        ((0, -0.106, 0), (RIGHT, 0, 0), Z),
        ((0, -0.11315, 0), (RIGHT, 0, 0), Z),
    ),
    # xArm-Developer/xarm_ros2 @ 3654ba7b, xarm_description/urdf/xarm6/xarm6_robot_macro.xacro; link_eef.
    "ufactory_xarm6": chain(
        ((0, 0, 0.267), O, Z),
        (O, (-RIGHT, 0, 0), Z),
        ((0.0535, -0.2845, 0), O, Z),
        ((0.0775, 0.3425, 0), (-RIGHT, 0, 0), Z),
        (O, (RIGHT, 0, 0), Z),
        ((0.076, 0.097, 0), (-RIGHT, 0, 0), Z),
    ),
}
