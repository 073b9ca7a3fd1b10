"""Tests cells: reading, settings, faults and pickles."""

from __future__ import annotations

import pickle
from pathlib import Path

import numpy as np
import pytest
from conftest import CELLS, ROOT, Run

import sweetspot as ss

HITACHI = CELLS / "hitachi_cell.toml"


def test_a_cell_is_read_from_a_file_and_from_text() -> None:
    read = ss.Cell.read(HITACHI)
    text = ss.Cell.from_text(HITACHI.read_text(), folder=CELLS)
    assert read.operations == text.operations == ["assembly", "picking"]
    assert read.map().objective == text.map().objective
    assert read.robot.name == "Hitachi PW 10-II"


@pytest.mark.parametrize("file", sorted(p.name for p in (ROOT / "tests" / "broken").glob("*.toml"))[::12])
def test_faults_are_those_of_the_command(file: str, command: Run) -> None:
    path = ROOT / "tests" / "broken" / file
    said = command("check", path, "--json")
    try:
        ss.Cell.read(path)
        faults: tuple[ss.Fault, ...] = ()
    except ss.InputError as error:
        faults = error.faults
        assert (error.file, error.line, error.message) in [(f.file, f.line, f.message) for f in faults]
        assert error.message in str(error) and error.help in str(error)
    if said["valid"]:
        assert not faults
    else:
        fields = ("severity", "file", "line", "column", "message", "help")
        told = [{name: getattr(fault, name) for name in fields} for fault in faults]
        # Only the preparation of the cell detects that the robot cannot attain an attitude.
        assert told == said["faults"] or all(f["line"] == 1 for f in said["faults"])


def test_all_faults_come_in_one_pass() -> None:
    text = HITACHI.read_text().replace("[search]", "[search]\nsede = 1\nbudgte = 2\n", 1)
    assert "sede" in text
    with pytest.raises(ss.InputError) as caught:
        ss.Cell.from_text(text, folder=CELLS)
    lines = text.splitlines()
    assert [lines[fault.line - 1].split(" ")[0] for fault in caught.value.faults] == ["sede", "budgte"]
    assert "seed" in caught.value.help and caught.value.column == 1


def test_a_missing_file_is_told_from_a_wrong_one() -> None:
    with pytest.raises(ss.UnreadableError, match="no such file"):
        ss.Cell.read(CELLS / "none.toml")


def test_settings_are_those_of_the_command(command: Run) -> None:
    said = command("map", HITACHI, "--json", "--set", "clearance_mm=20", "--limit", 12, "--reading", "statistical")
    cell = ss.Cell.read(HITACHI)
    for changed in (
        cell.with_({"clearance_mm": 20}, limit=12, reading="statistical"),
        cell.with_("clearance_mm=20").with_(reading="statistical").with_(limit=12),
        cell.with_({"clearance_mm": np.float64(20.0)}, reading="signed").with_(reading="statistical", limit=12),
    ):
        document = changed.map().document
        assert (document.objective, document.operations[0].margin) == (
            said["objective"],
            said["operations"][0]["margin"],
        )
    assert cell.map().objective != said["objective"], "the cell itself does not change"


def test_wrong_settings_are_refused_where_they_stand() -> None:
    cell = ss.Cell.read(HITACHI)
    with pytest.raises(ss.InputError) as caught:
        cell.with_({"clearence_mm": 10})
    assert caught.value.file.startswith("--set clearence_mm") and caught.value.line == 0
    assert "clearance_mm" in caught.value.help
    with pytest.raises(TypeError, match="did you mean reading"):
        cell.map(redaing="signed")  # type: ignore[call-arg]
    with pytest.raises(ss.InputError, match="assembly"):
        cell.map("asembly")
    with pytest.raises(TypeError, match="NoneType"):
        cell.with_({"clearance_mm": None})
    with pytest.raises(ValueError, match="one value"):
        cell.with_("clearance_mm=1,2")


def test_lists_and_tables_are_settings() -> None:
    cell = ss.Cell.read(HITACHI).with_({"operation.assembly.grid": [3, 2]})
    assert len(cell.map("assembly")) == 12
    ranged = cell.with_({"equipment.worktable.placement.x_mm": {"min": 0, "max": 900, "start": 450}})
    assert ss.evaluator(ranged).bounds[0].tolist() == [0.0, 900.0]


def test_a_pickled_cell_needs_no_files(tmp_path: Path) -> None:
    copy = tmp_path / "cells"
    for folder in ("", "robots", "equipment"):
        (copy / folder).mkdir(exist_ok=True)
        for file in (CELLS / folder).glob("*.*"):
            (copy / folder / file.name).write_bytes(file.read_bytes())
    cell = ss.Cell.read(copy / "hitachi_cell.toml").with_(limit=30)
    objective, pickled = cell.map().objective, pickle.dumps(cell)
    for file in copy.rglob("*.*"):
        file.unlink()
    assert pickle.loads(pickled).map().objective == objective
