"""Runs the notebook of the documentation cell by cell, without a notebook server."""

from __future__ import annotations

import ast
import json
import shutil
from pathlib import Path
from typing import Any

import pytest
from conftest import CELLS, ROOT


def shown(source: str, names: dict[str, Any]) -> Any:
    """Runs the source of a cell as a notebook does, and returns the value of its last expression."""
    tree = ast.parse(source)
    last = tree.body.pop() if isinstance(tree.body[-1], ast.Expr) else None
    exec(compile(tree, "cell", "exec"), names)
    return eval(compile(ast.Expression(last.value), "cell", "eval"), names) if last else None


def test_the_notebook_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for part in ("cells", "tests/data/ipa_ur10"):
        shutil.copytree(ROOT / part, tmp_path / part)
    monkeypatch.chdir(tmp_path / CELLS.name)
    notebook = json.loads((ROOT / "python" / "first_steps.ipynb").read_text())
    names: dict[str, Any] = {"__name__": "__main__"}
    values = []
    for cell in notebook["cells"]:
        if cell["cell_type"] == "code":
            assert not cell["outputs"], "the notebook is kept without outputs"
            values.append(shown("".join(cell["source"]), names))
    for value in values:
        assert not hasattr(value, "_repr_html_") or value._repr_html_()
    objective, bound, gap = values[-3]
    assert objective > 0 and (bound is None or bound <= objective) and (gap is None or gap >= 0)
    sorted_nodes = values[4]
    assert sorted_nodes.height > 0 and sorted_nodes["p95_mm"].is_sorted()
    assert Path("report.html").stat().st_size > 100_000
