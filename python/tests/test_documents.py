"""Tests that every number of a record has the same bits as in the document of the command."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import polars as pl
import pyarrow as pa
import pytest
from conftest import CELLS, ROOT, Run

import sweetspot as ss
from sweetspot import records

HITACHI = CELLS / "hitachi_cell.toml"
SMALL = ["hitachi_cell", "hitachi_paper", "scara_cell"]


def without(document: Any, *keys: str) -> Any:
    """Returns a document without the given keys, at any depth."""
    if isinstance(document, dict):
        return {k: without(v, *keys) for k, v in document.items() if k not in keys}
    return [without(v, *keys) for v in document] if isinstance(document, list) else document


@pytest.mark.parametrize("name", SMALL)
def test_maps(name: str, command: Run) -> None:
    said = command("map", CELLS / f"{name}.toml", "--json")
    map = ss.Cell.read(CELLS / f"{name}.toml").map()
    assert map.document.to_dict() == without(said, "nodes")
    nodes = [node for operation in said["operations"] for node in operation["nodes"]]
    assert len(map) == len(nodes)
    expected = {
        "x_mm": [node["position_mm"][0] for node in nodes],
        "value": [node["value"] for node in nodes],
        "error_z_mm": [node["error_mm"] and node["error_mm"][2] for node in nodes],
        "q1_deg": [node["joints_deg"] and node["joints_deg"][0] for node in nodes],
        "worst_xyz_mm": [node["worst_mm"] and node["worst_mm"]["xyz"] for node in nodes],
    }
    for column, values in expected.items():
        assert np.array_equal(map[column], np.array(values, dtype=float), equal_nan=True), column
    assert map["status"].tolist() == [node["status"] for node in nodes]


def test_the_map_of_one_operation_has_its_own_figures(command: Run) -> None:
    flags = ("--reading", "statistical", "--quantity", "p95")
    said = command("map", HITACHI, "--json", *flags)["operations"][0]
    cell = ss.Cell.read(HITACHI)
    for senses in ("all", "own"):
        map = cell.map("assembly", reading="statistical", quantity="p95", senses=senses)  # type: ignore[arg-type]
        own = [node["p95_mm"] and node["p95_mm"][said["sense"]] for node in said["nodes"]]
        assert np.array_equal(map["p95_mm"], np.array(own, dtype=float), equal_nan=True)
        assert (f"p95_{said['sense']}_mm" in map.columns) == (senses == "all")
        assert [o.name for o in map.operations] == ["assembly"]


def test_searches(command: Run, tmp_path: Any) -> None:
    flags = ["--seed", 3, "--budget", 3000, "--keep", 3]
    said = command("search", HITACHI, "--json", *flags, "--out", tmp_path / "found", "--progress", "none")
    search = ss.Cell.read(HITACHI).search(seed=3, budget=3000, keep=3)
    assert search.document.to_dict() == without(said, "seconds")
    assert (search.objective, search.bound) == (said["objective_value"], said["bound"])
    assert search.gap is not None and np.isclose(search.gap * 100, said["gap_percent"])
    assert search.trace.tolist() == said["trace"]
    # The cells at the layouts have the bits of the files that the command writes.
    best = ss.Cell.read(tmp_path / "found" / "best.toml")
    assert search.cell.map().document.to_dict() == without(best.map().document.to_dict(), "cell") | {
        "cell": search.cell.name
    }
    assert len(search.cells) == len(said["front"])
    # This search starts at the best layout of another search, with settings that no layout file states.
    ranged = search.cell.with_({"equipment.worktable.placement.x_mm": {"min": -900, "max": 900}, "guard_percent": 2})
    again = ranged.search(seed=1, budget=200)
    assert again.cell.map().objective == again.objective and ss.evaluator(again.cell).dim == 0


def test_other_questions(command: Run) -> None:
    cell = ss.Cell.read(HITACHI)
    statistical = ("--reading", "statistical")
    assert cell.budget(reading="statistical").to_dict() == command("budget", HITACHI, "--json", *statistical)
    at = command("budget", HITACHI, "--json", "--operation", "assembly", "--at", "5,4")
    assert cell.budget("assembly", at=(5, 4)).to_dict() == at
    assert cell.robust(limit=25).to_dict() == command("robust", HITACHI, "--json", "--limit", 25)
    ideal = CELLS / "hitachi_ideal.toml"
    compared = ss.compare(cell, ss.Cell.read(ideal), names=["hitachi_cell", "hitachi_ideal"])
    assert compared.to_dict() == command("compare", HITACHI, ideal, "--json")
    assert ss.robots().to_dict() == command("robots", "--json")
    assert ss.robot("ur10e").sheet().to_dict() == command("robot", "ur10e", "--json")


def test_a_urdf_is_a_robot_whose_guesses_are_told(command: Run) -> None:
    path = ROOT / "tests" / "data" / "own_arm.urdf"
    with pytest.warns(ss.InputWarning) as told:
        robot = ss.robot(path)
    assert robot.sheet().to_dict() == command("robot", path, "--json") and robot.errors == ["guess"]
    messages = "\n".join(str(warning.message) for warning in told)
    assert "angles are rounded right angles" in messages and "preset medium" in messages
    assert "base.stl" in messages and "--package own_arm=DIR" in messages
    with pytest.raises(ss.UnreadableError):
        ss.robot("no_such_arm.urdf")


def test_questions_without_an_answer() -> None:
    cell = ss.Cell.read(HITACHI)
    with pytest.raises(ss.InputError, match="no node"):
        cell.budget("assembly", at=(99, 99))
    map = cell.map("assembly")
    blocked = next(k for k, status in enumerate(map["status"]) if status != "ok")
    with pytest.raises(ss.NoAnswerError, match="cannot be used"):
        cell.budget("assembly", at=(int(map["i"][blocked]), int(map["j"][blocked])))
    with pytest.raises(ValueError, match="ambiguous"):
        cell.budget(at=(0, 0))
    with pytest.raises(ss.InputError, match="ur10e|did you mean"):
        ss.robot("ur10ee")


@pytest.mark.parametrize("kind", ["cell", "robot", "map", "search-result"])
def test_schemas(kind: str, command: Run) -> None:
    assert ss.schema(kind) == command("schema", kind)
    with pytest.raises(ValueError, match=f"did you mean {kind}"):
        ss.schema(kind + "p")


def test_records_are_typed_tables() -> None:
    budget = ss.Cell.read(HITACHI).budget("assembly", reading="statistical")
    operation = budget.operations[0]
    assert isinstance(operation, records.OperationBudget) and operation.position_mm.dtype == np.float64
    frame = pl.DataFrame(operation.parameters)
    assert frame.height == len(operation.parameters) and frame.columns[0] == "parameter"
    assert frame.columns == pa.table(operation.parameters).column_names
    again = records.BudgetDocument.from_json(budget.to_json())
    assert again == budget and json.loads(budget.to_json()) == budget.to_dict()
    assert again != ss.Cell.read(HITACHI).budget("picking", reading="statistical")
    nested = pl.DataFrame(ss.Cell.read(HITACHI).search(budget=300).operations)
    assert {"name", "position_mm", "error_mm"} <= set(nested.columns)


def test_every_table_is_taken_by_polars_and_pyarrow(command: Run) -> None:
    cell = ss.Cell.read(HITACHI)
    map = cell.map()
    frame, table = pl.DataFrame(map), pa.table(map)
    assert frame.columns == table.column_names == map.columns and frame.height == len(map)
    usable = frame.filter(pl.col("status") == "ok").sort("value")
    said = command("map", HITACHI, "--json")
    assert usable.height == sum(o["counts"]["ok"] for o in said["operations"])
    assert usable["value"][0] == np.nanmin(map["value"][map["status"] == "ok"])
    evaluations = ss.evaluator(cell).evaluate(np.full((3, 7), 0.5), reasons=True)
    assert pl.DataFrame(evaluations)["cost"].to_list() == evaluations.costs.tolist()
    assert pl.DataFrame(ss.robots().robots).height == len(ss.robots().robots)
    with pytest.raises(KeyError, match="did you mean value"):
        map["valeu"]


def test_the_classes_are_those_of_the_schemas() -> None:
    import subprocess
    import sys

    maker = ROOT / "python" / "make_records.py"
    done = subprocess.run([sys.executable, str(maker), "--check"], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
