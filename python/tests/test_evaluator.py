"""Tests the function from layouts to costs."""

from __future__ import annotations

import pickle
import threading

import numpy as np
import pytest
from conftest import CELLS, Run

import sweetspot as ss

HITACHI = CELLS / "hitachi_cell.toml"


@pytest.fixture(scope="module")
def points() -> np.ndarray:
    return np.random.default_rng(1).random((400, 7))


@pytest.mark.parametrize("name", ["hitachi_cell", "ur_cell"])
def test_costs_have_the_bits_of_the_command(name: str, command: Run) -> None:
    path = CELLS / f"{name}.toml"
    cell = ss.Cell.read(path)
    found = cell.search(seed=1, budget=2000)
    f = ss.evaluator(cell)
    best = f.from_units([[_value(found, path) for path in f.names]])
    layouts = np.vstack([best, f.start[None], np.random.default_rng(2).random((3, f.dim))])
    evaluated = f.evaluate(layouts, reasons=True)
    assert f(best)[0] == found.objective
    for k, values in enumerate(f.to_units(layouts)):
        # The command maps the layout at the starts of the ranges. The repr() of a float is exact.
        ranges = [f"{{ min = {a!r}, max = {b!r}, start = {v!r} }}" for (a, b), v in zip(f.bounds.tolist(), values.tolist())]
        sets = [word for path, range in zip(f.names, ranges) for word in ("--set", f"{path}={range}")]
        said = command("map", path, "--json", *sets)
        objective = said["objective"]
        assert np.array_equal(evaluated.objectives[k], np.nan if objective is None else objective, equal_nan=True)
        assert evaluated.reasons is not None and evaluated.reasons[k] == said["reasons"]
        assert f.cell_at(layouts[k]).map().document.objective == objective
        for place, operation in enumerate(said["operations"]):
            value = evaluated.values[k, place]
            assert np.isnan(value) or value == operation["value"]


def _value(found: ss.Search, path: str) -> float:
    """Returns the coordinate of the best layout with this path."""
    kind, name, *_, key = path.split(".")
    assert kind == "equipment"
    return float(getattr(found.layout[name], key))


def test_one_layout_and_many_are_the_same(points: np.ndarray) -> None:
    f = ss.evaluator(ss.Cell.read(HITACHI))
    costs = f(points)
    assert costs.shape == (400,) and np.isfinite(costs).all()
    assert [f(point) for point in points[:5]] == costs[:5].tolist()
    assert isinstance(f(points[0]), float)
    assert f(points.tolist()).tolist() == costs.tolist()
    assert f(np.asfortranarray(points)[::2]).tolist() == costs[::2].tolist()
    assert f(points.astype(np.float32)).shape == (400,)
    assert f(f.to_units(points), units=True).tolist() == costs.tolist()
    evaluated = f.evaluate(points)
    assert evaluated.costs.tolist() == costs.tolist() and evaluated.reasons is None
    assert (evaluated.costs[evaluated.feasible] == evaluated.objectives[evaluated.feasible]).all()
    assert f(np.empty((0, 7))).shape == (0,)
    assert pickle.loads(pickle.dumps(f))(points).tolist() == costs.tolist()


def test_threads_share_an_evaluator(points: np.ndarray) -> None:
    f = ss.evaluator(ss.Cell.read(HITACHI))
    expected, got = f(points).tolist(), []
    threads = [threading.Thread(target=lambda: got.append(f(points).tolist())) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert got == [expected] * 4


def test_wrong_layouts_are_refused(points: np.ndarray) -> None:
    f = ss.evaluator(ss.Cell.read(HITACHI))
    with pytest.raises(ValueError, match=r"\(n, 7\)"):
        f(points[:, :6])
    with pytest.raises(ValueError, match=r"\(n, 7\)"):
        f(points[None])
    points = points.copy()
    points[3, 1] = np.nan
    with pytest.raises(ValueError, match="worktable.placement.y_mm of layout 3"):
        f(points)
    with pytest.raises(ValueError, match="one layout"):
        f.cell_at(points[:1])


def test_units_and_points_convert(points: np.ndarray) -> None:
    f = ss.evaluator(ss.Cell.read(HITACHI))
    values = f.to_units(points)
    assert (values >= f.bounds[:, 0]).all() and (values <= f.bounds[:, 1]).all()
    assert f.to_units(f.from_units(values)).tolist() == values.tolist()
    assert len(f.names) == f.dim == 7 and f.unit == "mm"
    fixed = ss.Cell.read(HITACHI).with_({path: float(v) for path, v in zip(f.names, values[0])})
    assert ss.evaluator(fixed).dim == 0
    with pytest.raises(ValueError, match="no free coordinate"):
        ss.evaluator(fixed)([])
