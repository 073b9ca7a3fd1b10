"""Tests the section "Office machines" of README.md with two workers, one of which is killed."""

from __future__ import annotations

import os
import re
import signal
import threading
import time
from typing import Any

import pytest
from conftest import CELLS, ROOT

import sweetspot as ss

distributed = pytest.importorskip("dask.distributed", reason="dask is not installed")


def recipe() -> str:
    """Returns the code of the section "Office machines" of the README."""
    text = (ROOT / "python" / "README.md").read_text()
    section = text.split("## Office machines", 1)[1].split("\n## ", 1)[0]
    return "\n".join(re.findall(r"```python\n(.*?)```", section, re.DOTALL))


def test_the_recipe_survives_a_killed_worker(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(CELLS)
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster:
        with distributed.Client(cluster) as client:
            pids = list(client.run(os.getpid).values())
            assert len(set(pids)) == 2
            killed: list[float] = []

            def kill() -> None:
                # The worker is killed after the first results, while the other searches run.
                time.sleep(0.7)
                os.kill(pids[0], signal.SIGKILL)
                killed.append(time.monotonic())

            thread = threading.Thread(target=kill)
            thread.start()
            names: dict[str, Any] = {"client": client}
            exec(compile(recipe(), "README.md", "exec"), names)
            over = time.monotonic()
            thread.join()
            assert killed and killed[0] < over, "the searches ended before the worker was killed"
            assert pids[0] not in client.run(os.getpid).values()
    found = names["found"]
    assert [result.seed for result in found] == list(range(1, 9))
    cell = ss.Cell.read("hitachi_cell.toml")
    for k in (0, 7):
        expected = cell.search(seed=k + 1, budget=found[k].budget).document
        assert found[k] == expected, "a search on another machine has the same bits"
