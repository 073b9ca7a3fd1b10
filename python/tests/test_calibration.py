"""Tests the calibration from arrays against the command, which reads a table of the same measurements."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import polars as pl
import pytest
from conftest import CELLS, ROOT, Run, measured

import sweetspot as ss


def test_arrays_give_the_parameters_of_the_command(tmp_path: Path, command: Run) -> None:
    joints, poses, lines = measured("A", 150)
    table = tmp_path / "measured.csv"
    table.write_text("\n".join(lines) + "\n")
    said = command("calibrate", "ur10", table, "--json")
    made = ss.calibrate(ss.robot("ur10"), q=joints, measured=poses, unit="mm")
    parameters = made.parameters
    assert [p.name for p in parameters] == [p["name"] for p in said["parameters"]]
    for ours, theirs in zip(parameters, said["parameters"]):
        assert ours.value == pytest.approx(theirs["value"], abs=1e-6)
        assert ours.sigma == pytest.approx(theirs["sigma"], rel=1e-6)
    assert made.residual_mm == pytest.approx(said["residual_mm"], rel=1e-6)
    assert made.covariance.shape == (len(parameters), len(parameters))
    metres = poses.copy()
    metres[:, :3, 3] /= 1000
    again = ss.calibrate(ss.robot("ur10"), joints, metres)
    assert [p.value for p in again.parameters] == pytest.approx([p.value for p in parameters], abs=1e-6)
    assert pl.DataFrame(parameters).height == len(parameters)


def test_identified_errors_go_into_a_cell() -> None:
    joints, poses, _ = measured("A", 150)
    made = ss.calibrate(ss.robot("ur10"), joints, poses[:, :3, 3], unit="mm", test=(joints[:50], poses[:50]))
    assert made.document.tests[0].poses == 50 and made.errors.name == "measured"
    cell = ss.Cell.read(CELLS / "ur_cell.toml").with_({"robot.from": "robots/ur10.toml"})
    calibrated = cell.with_errors(made.errors)
    map = calibrated.map("assembly", reading="statistical", quantity="p95")
    assert map.operations[0].errors == "measured" and np.nanmin(map["p95_mm"]) > 0
    assert calibrated.robot.errors[-1] == "measured" or "measured" in calibrated.robot.errors
    assert made.errors.toml == str(made.errors) and made.errors.toml.startswith("[errors.measured]")


def test_sessions_give_the_parameters_of_the_command_with_several_files(tmp_path: Path, command: Run) -> None:
    joints, poses, lines = measured("A", 240)
    files, q, xyz = [tmp_path / "a.csv", tmp_path / "b.csv"], [], []
    for k, file in enumerate(files):
        file.write_text("\n".join([lines[0], *lines[1 + k :: 2]]) + "\n")
        q.append(joints[k::2])
        xyz.append(poses[k::2])
    said = command("calibrate", "ur10", *files, "--json")
    robot = ss.robot("ur10")
    made = ss.calibrate(robot, q, xyz, unit="mm", test=[(q[0], xyz[0]), (q[1], xyz[1])])
    for ours, theirs in zip(made.parameters, said["parameters"]):
        assert (ours.name, ours.value) == (theirs["name"], pytest.approx(theirs["value"], abs=1e-6))
    assert [s.poses for s in made.document.sessions] == [120, 120]
    assert [t.file for t in made.document.tests] == ["test 1", "test 2"]
    # Every session has a different frame of the instrument.
    xyz[1] = xyz[1].copy()
    xyz[1][:, :3, 3] += [100, -50, 20]
    moved = ss.calibrate(robot, q, xyz, unit="mm")
    assert moved.residual_mm == pytest.approx(made.residual_mm, rel=1e-6)
    assert ss.calibrate(robot, np.vstack(q), np.vstack(xyz), unit="mm").residual_mm > 10
    with pytest.raises(TypeError, match="2 sessions, but measured has 1"):
        ss.calibrate(robot, q, xyz[:1], unit="mm")
    with pytest.raises(TypeError, match=r"measured 2: .*\(120, 3\)"):
        ss.calibrate(robot, q, [xyz[0], xyz[1][:50]], unit="mm")


def test_wrong_arrays_are_refused() -> None:
    robot = ss.robot("ur10")
    joints, poses, _ = measured("A", 150)
    with pytest.raises(TypeError, match=r"\(n, 6\)"):
        ss.calibrate(robot, joints[:, :5], poses)
    with pytest.raises(TypeError, match=r"\(150, 3\) or \(150, 4, 4\)"):
        ss.calibrate(robot, joints, poses[:, :3, :3])
    with pytest.raises(ValueError, match="row 2 of q"):
        ss.calibrate(robot, np.where(np.arange(150)[:, None] == 2, np.nan, joints), poses)
    with pytest.raises(ss.InputError, match="cannot determine"):
        ss.calibrate(robot, joints[:3], poses[:3])
    with pytest.raises(ValueError, match="unit"):
        ss.calibrate(robot, joints, poses, unit="inch")  # type: ignore[arg-type]
