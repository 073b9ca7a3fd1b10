"""Tests long work: Ctrl-C, progress, and the interpreter lock."""

from __future__ import annotations

import os
import signal
import threading
import time
from typing import Iterator

import numpy as np
import pytest
from conftest import CELLS

import sweetspot as ss

UR = CELLS / "ur_cell.toml"


@pytest.fixture(autouse=True)
def _sigint_raises() -> Iterator[None]:
    """Restores the default handling of SIGINT, because a shell starts background jobs with SIGINT ignored."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


def interrupt_after(seconds: float) -> threading.Timer:
    timer = threading.Timer(seconds, lambda: os.kill(os.getpid(), signal.SIGINT))
    timer.start()
    return timer


def test_ctrl_c_ends_a_search_with_what_was_found() -> None:
    cell = ss.Cell.read(UR)
    seen: list[tuple[int, int, float | None]] = []

    def tell(*progress: object) -> None:
        seen.append(progress)  # type: ignore[arg-type]
        if len(seen) == 4:
            os.kill(os.getpid(), signal.SIGINT)

    search = cell.search(seed=1, budget=10_000_000, time=300, progress=tell)
    assert search.ended == "interrupted" and search.evaluations >= seen[-1][0] > 0
    assert search.objective is not None and search.cell.map().objective == search.objective
    assert seen[0][1] == 10_000_000


def test_a_time_limit_ends_a_search() -> None:
    began = time.monotonic()
    search = ss.Cell.read(UR).search(budget=10_000_000, time=1.0)
    assert search.ended == "time-limit" and time.monotonic() - began < 60
    with pytest.raises(ValueError, match="seconds"):
        ss.Cell.read(UR).search(time=-1.0)


def test_an_exception_of_progress_is_an_exception() -> None:
    def tell(*_: object) -> None:
        raise RuntimeError("no display")

    with pytest.raises(RuntimeError, match="no display"):
        ss.Cell.read(UR).search(budget=10_000_000, progress=tell)


def test_ctrl_c_ends_an_evaluation() -> None:
    f = ss.evaluator(ss.Cell.read(UR))
    timer = interrupt_after(0.5)
    began = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        f(np.random.default_rng(1).random((10_000_000, f.dim)))
    timer.join()
    assert time.monotonic() - began < 60


def test_other_threads_run_meanwhile() -> None:
    f = ss.evaluator(ss.Cell.read(UR))
    points = np.random.default_rng(1).random((4000, f.dim))
    ticks, over = [0], threading.Event()

    def count() -> None:
        while not over.is_set():
            ticks[0] += 1
            time.sleep(0.001)

    thread = threading.Thread(target=count)
    thread.start()
    began = ticks[0]
    f(points)
    counted = ticks[0] - began
    over.set()
    thread.join()
    # If the lock were held, the other thread would not count at all.
    assert counted > 10


def test_threads_do_not_change_a_result() -> None:
    cell = ss.Cell.read(CELLS / "hitachi_cell.toml")
    one, two = (cell.search(seed=2, budget=2000, threads=count) for count in (1, 2))
    assert one.document == two.document
