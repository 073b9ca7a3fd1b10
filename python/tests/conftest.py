"""Paths, and the program with which the package is compared."""

from __future__ import annotations

import gzip
import json
import os
import subprocess
from pathlib import Path
from typing import Any, Callable

import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[2]
CELLS = ROOT / "cells"
PROGRAM = Path(os.environ.get("PROGRAM", ROOT / "target" / "debug" / "sweetspot")).absolute()

Run = Callable[..., Any]


@pytest.fixture(scope="session")
def command() -> Run:
    """Runs the program and returns the JSON document that it prints."""
    if not PROGRAM.is_file():
        pytest.fail(f"{PROGRAM} is missing: run cargo build, or name another with PROGRAM=...")

    def run(*arguments: object) -> Any:
        words = [str(PROGRAM), *map(str, arguments)]
        done = subprocess.run(words, capture_output=True, text=True, check=False)
        assert done.stdout, done.stderr
        return json.loads(done.stdout)

    return run


def measured(series: str, count: int) -> tuple[np.ndarray, np.ndarray, list[str]]:
    """Returns joints (rad) and poses (mm, 4 x 4) of a measured UR10, and the lines of the table."""
    with gzip.open(ROOT / "tests" / "data" / "ipa_ur10" / f"{series}.csv.gz", "rt") as file:
        lines = file.read().splitlines()
    step = (len(lines) - 1) // count
    kept = lines[1::step][:count]
    numbers = np.array([[float(v.replace(",", ".")) for v in line.split(";")] for line in kept])
    columns = lines[0].split(";")
    joints = numbers[:, columns.index("shoulder_pan_joint") :][:, :6]
    start = columns.index("measurement_x")
    x, angles = numbers[:, start : start + 3], np.radians(numbers[:, start + 3 : start + 6])
    poses = np.tile(np.eye(4), (count, 1, 1))
    poses[:, :3, 3] = x
    for k, (rx, ry, rz) in enumerate(angles):
        (cx, sx), (cy, sy), (cz, sz) = ((np.cos(a), np.sin(a)) for a in (rx, ry, rz))
        turn_x = np.array([[1, 0, 0], [0, cx, -sx], [0, sx, cx]])
        turn_y = np.array([[cy, 0, sy], [0, 1, 0], [-sy, 0, cy]])
        turn_z = np.array([[cz, -sz, 0], [sz, cz, 0], [0, 0, 1]])
        poses[k, :3, :3] = turn_x @ turn_y @ turn_z
    return joints, poses, [lines[0], *kept]
