"""Compares three optimizers of other projects, run on the evaluator of the Python package, with the search of
sweetspot.

    pip install ./python cma optuna nevergrad && python results/optimisers/run.py

This command writes results.json and the tables of README.md beside this file. `--quick` runs one seed of each
optimizer as a quick test, and prints the tables. `--speed` measures only the speed of the evaluator.
"""

from __future__ import annotations

import argparse
import importlib.metadata
import json
import statistics
import subprocess
import sys
import time
import warnings
from pathlib import Path
from typing import Any, Callable

import numpy as np

import sweetspot as ss

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
CELLS = ["hitachi_cell", "ur_cell"]
BUDGET = 10_000
# Optuna's sampler takes several ms for each trial, and slows down with the number of trials.
OPTUNA_BUDGET = 1_000
SEEDS = range(1, 6)
LAYOUTS = 100_000
PRIMES = np.array([2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37], dtype=float)


class Run:
    """Improvements of one optimizer: number of layouts, seconds and cost at each."""

    def __init__(self, f: ss.Evaluator, budget: int) -> None:
        self.f, self.left, self.count, self.best = f, budget, 0, np.inf
        self.trace: list[tuple[int, float, float]] = []
        self.began = time.perf_counter()

    def __call__(self, points: Any) -> np.ndarray:
        costs = np.atleast_1d(self.f(np.atleast_2d(points)))
        now = time.perf_counter() - self.began
        for k, cost in enumerate(costs):
            if cost < self.best:
                self.best = float(cost)
                self.trace.append((self.count + k + 1, now, self.best))
        self.count += len(costs)
        self.left -= len(costs)
        return costs


def pycma(run: Run, seed: int) -> None:
    import cma

    restart = 0
    while run.left > 0:
        start = run.f.start if restart == 0 else np.random.default_rng([seed, restart]).random(run.f.dim)
        options = {"bounds": [0, 1], "seed": seed + 1000 * restart, "verbose": -9, "maxfevals": run.left}
        options["popsize"] = 4 + int(3 * np.log(run.f.dim)) if restart == 0 else 16
        strategy = cma.CMAEvolutionStrategy(start, 0.3, options)
        while not strategy.stop() and run.left > 0:
            points = strategy.ask()
            strategy.tell(points, run(points).tolist())
        restart += 1


def optuna(run: Run, seed: int) -> None:
    import optuna

    optuna.logging.set_verbosity(optuna.logging.ERROR)
    study = optuna.create_study(sampler=optuna.samplers.TPESampler(seed=seed))
    names = [f"x{k}" for k in range(run.f.dim)]
    study.enqueue_trial(dict(zip(names, run.f.start)))
    study.optimize(lambda trial: float(run([trial.suggest_float(n, 0, 1) for n in names])[0]), n_trials=run.left)


def nevergrad(run: Run, seed: int) -> None:
    import nevergrad as ng

    space = ng.p.Array(init=run.f.start).set_bounds(0, 1).set_mutation(sigma=0.2)
    space.random_state.seed(seed)
    workers = 16
    # NGOpt, the usual choice, fails with the present numpy.
    optimiser = ng.optimizers.TwoPointsDE(space, budget=run.left, num_workers=workers)
    while run.left > 0:
        asked = [optimiser.ask() for _ in range(min(workers, run.left))]
        for candidate, cost in zip(asked, run([candidate.value for candidate in asked])):
            optimiser.tell(candidate, float(cost))


OPTIMISERS: dict[str, tuple[Callable[[Run, int], None], int]] = {
    "pycma": (pycma, BUDGET),
    "nevergrad": (nevergrad, BUDGET),
    "optuna": (optuna, OPTUNA_BUDGET),
}
PACKAGES = {"pycma": "cma", "nevergrad": "nevergrad", "optuna": "optuna"}


def study(name: str, seeds: range) -> dict[str, Any]:
    """Runs every optimizer on a cell, and finds when each run came within 1 % of the least cost of all runs."""
    cell = ss.Cell.read(ROOT / "cells" / f"{name}.toml")
    runs: dict[str, list[list[tuple[int, float, float]]]] = {}
    for kind, (optimise, budget) in OPTIMISERS.items():
        for seed in seeds:
            run = Run(ss.evaluator(cell), budget)
            optimise(run, seed)
            runs.setdefault(kind, []).append(run.trace)
            print(f"{name} {kind} seed {seed}: {run.best} after {run.count} layouts", file=sys.stderr)
    searches = [cell.search(seed=seed, budget=BUDGET) for seed in seeds]
    least = [s.document.least_value for s in searches if s.document.least_value is not None]
    optimum = min([*least, *(trace[-1][2] for traces in runs.values() for trace in traces)])
    target = 1.01 * optimum
    rows = {kind: [first(trace, target) for trace in traces] for kind, traces in runs.items()}
    # The search of sweetspot ends at the target. The seconds include the proof and the assessment.
    bound = searches[0].bound
    assert bound is not None, f"{name} has no bound"
    ours = []
    for seed in seeds:
        began = time.perf_counter()
        search = cell.search(seed=seed, budget=BUDGET, gap=target / bound - 1)
        seconds = time.perf_counter() - began
        hit = first([(int(n), seconds, value) for n, value in search.trace], target)
        ours.append(hit)
        print(f"{name} sweetspot seed {seed}: {search.document.least_value}", file=sys.stderr)
    rows = {"sweetspot": ours, **rows}
    return {"cell": name, "variables": ss.evaluator(cell).dim, "optimum": optimum, "bound": bound, "rows": rows}


def first(trace: list[tuple[int, float, float]], target: float) -> tuple[int, float] | None:
    return next(((count, seconds) for count, seconds, cost in trace if cost <= target), None)


def speed(name: str) -> dict[str, Any]:
    """Returns layouts per second of the Python evaluator and of the Rust bench on the same layouts."""
    f = ss.evaluator(ss.Cell.read(ROOT / "cells" / f"{name}.toml"))
    points = np.modf(np.arange(1, LAYOUTS + 1)[:, None] * np.sqrt(PRIMES[: f.dim]))[0]
    best, costs = np.inf, np.empty(0)
    for _ in range(5):
        began = time.perf_counter()
        costs = f(points)
        best = min(best, time.perf_counter() - began)
    words = ["cargo", "bench", "--quiet", "--bench", "evaluator", "--", f"cells/{name}.toml"]
    done = subprocess.run(words, cwd=ROOT, capture_output=True, text=True, check=True)
    rust = json.loads(done.stdout.strip().splitlines()[-1])
    # The costs are added in the order of the layouts, as in the bench.
    same = sum(costs.tolist()) == rust["sum"]
    return {"cell": name, "python": round(LAYOUTS / best), "rust": rust["layouts_per_s"], "same_bits": same}


def tables(results: dict[str, Any]) -> str:
    lines = ["| cell | variables | optimum | optimizer | layouts to 1 % | seconds to 1 % | reached 1 % |", "|---|---|---|---|---|---|---|"]
    for entry in results["studies"]:
        for kind, hits in entry["rows"].items():
            found = [hit for hit in hits if hit]
            # Median over all seeds. A seed that did not reach the target counts as the slowest.
            is_known = len(found) * 2 > len(hits)
            middle = lambda k: statistics.median_high([hit[k] if hit else float("inf") for hit in hits])  # noqa: E731
            layouts, seconds = (str(middle(0)), f"{middle(1):.2f}") if is_known else ("-", "-")
            lines.append(
                f"| {entry['cell']} | {entry['variables']} | {entry['optimum']:.6f} | {kind} | {layouts} | {seconds} "
                f"| {len(found)} of {len(hits)} |"
            )
    lines += ["", "| cell | Rust bench, layouts/s | Python evaluator, layouts/s | share | same bits |", "|---|---|---|---|---|"]
    for entry in results["speeds"]:
        share = entry["python"] / entry["rust"]
        same = "yes" if entry["same_bits"] else "no"
        lines.append(f"| {entry['cell']} | {entry['rust']:.0f} | {entry['python']} | {share:.2f} | {same} |")
    return "\n".join(lines) + "\n"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="one seed, and no file is written")
    parser.add_argument("--speed", action="store_true", help="measure the evaluator alone, and write no file")
    options = parser.parse_args()
    warnings.filterwarnings("ignore", module="(cma|optuna|nevergrad).*")
    seeds = SEEDS[:1] if options.quick else SEEDS
    versions = {kind: importlib.metadata.version(package) for kind, package in PACKAGES.items()} if not options.speed else {}
    results = {
        "versions": {"sweetspot": ss.__version__, **versions},
        "studies": [] if options.speed else [study(name, seeds) for name in CELLS],
        "speeds": [speed(name) for name in CELLS],
    }
    text = tables(results)
    print(text)
    if options.quick or options.speed:
        return
    (HERE / "results.json").write_text(json.dumps(results, indent=1) + "\n")
    readme = HERE / "README.md"
    head, _, rest = readme.read_text().partition("<!-- tables -->\n")
    tail = rest.partition("<!-- end of the tables -->\n")[2]
    readme.write_text(f"{head}<!-- tables -->\n{text}<!-- end of the tables -->\n{tail}")


if __name__ == "__main__":
    main()
