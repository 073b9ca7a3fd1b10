"""Tests the package itself: import, names, and the figures that the documentation states."""

from __future__ import annotations

import subprocess
import sys

import numpy as np
import pyarrow as pa
import pytest
from conftest import CELLS, ROOT

import sweetspot as ss
from sweetspot import records


def test_the_import_takes_no_longer_than_promised() -> None:
    code = "import time; began = time.perf_counter(); import sweetspot; print(time.perf_counter() - began)"

    def seconds() -> float:
        done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
        return float(done.stdout)

    assert min(seconds() for _ in range(5)) <= 0.1


def test_the_import_needs_no_numpy() -> None:
    code = "import sys, sweetspot; sys.exit('numpy' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def test_version_and_names() -> None:
    manifest = (ROOT / "Cargo.toml").read_text()
    assert f'version = "{ss.__version__}"' in manifest
    assert all(hasattr(ss, name) for name in ss.__all__)
    documented = [name for name in ss.__all__ if not getattr(ss, name).__doc__]
    assert documented == [], "without documentation"
    assert all(getattr(records, name).__doc__ for name in dir(records) if name.endswith(("Document", "Entry")))


@pytest.mark.parametrize(("errors", "reading"), [("factory", "signed"), ("placeholder", "statistical")])
def test_a_large_map_is_small_in_arrow(errors: str, reading: str) -> None:
    cell = ss.Cell.read(CELLS / "ur_cell.toml").with_({"operation.assembly.grid": [40, 24]})
    map = cell.map("assembly", reading=reading, errors=errors, senses="own")  # type: ignore[arg-type]
    table = pa.table(map)
    # A million nodes need at most 300 MB, as the README states.
    assert table.nbytes / len(map) * 1e6 <= 300e6
    assert map.nbytes <= 1.2 * table.nbytes + 20_000
    assert np.isfinite(map["value"]).any()
