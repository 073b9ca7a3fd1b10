"""Runs every command of the tutorial as a newcomer would, and prints how long each takes.

    python3 results/tutorial/transcript.py

This command clones the committed files and installs the program with `cargo install --path .` into a scratch
folder, as the tutorial says. If the path of the program is given as an argument, the installation is skipped.
Commands and files are read from docs/src/tutorial.md. A command that fails ends the run.
"""

import os
import re
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
BLOCK = re.compile(r"^```(\w+)(\S*)\n(.*?)^```", re.MULTILINE | re.DOTALL)


def timed(command, folder, path, shown=None):
    """Runs a command line, prints its row (with `shown` as the command), and returns its seconds."""
    began = time.perf_counter()
    run = subprocess.run(
        command, shell=True, cwd=folder, env={**os.environ, "PATH": path}, capture_output=True, text=True
    )
    seconds = time.perf_counter() - began
    print(f"| `{shown or command}` | {run.returncode} | {seconds:.1f} |", flush=True)
    if run.returncode != 0:
        sys.exit(run.stderr)
    return seconds


def main(program=None):
    with tempfile.TemporaryDirectory() as scratch:
        folder, tools = Path(scratch, "sweetspot"), Path(scratch, "tools")
        subprocess.run(["git", "clone", "--quiet", ROOT, folder], check=True)
        path = os.environ["PATH"]
        print("| command | exit code | s |\n|---|---|---|")
        if program:
            path = f"{Path(program).resolve().parent}:{path}"
        else:
            install = "cargo install --path ."
            timed(f"{install} --quiet --locked --root {tools}", folder, path, install)
            path = f"{tools / 'bin'}:{path}"
        total = 0.0
        for language, options, text in BLOCK.findall((ROOT / "docs/src/tutorial.md").read_text()):
            name = re.search(r"file=([^,]+)", options)
            if name:
                Path(folder, name[1]).write_text(text)
            if language == "console":
                commands = [line[2:] for line in text.splitlines() if line.startswith("$ ")]
                total += sum(timed(command, folder, path) for command in commands)
        print(f"\nAll commands after the installation: {total:.1f} s")


main(*sys.argv[1:])
