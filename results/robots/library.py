"""Prints the table of the built-in arms: inverse kinematics, reach, and seconds to a first map.

    cargo build --release && python3 results/robots/library.py target/release/sweetspot

If names of robots follow the program, the table has only these robots. *Reach* is the greatest distance of
the flange from the base axis with the tool pointing down, as `sweetspot robot` prints it. For an arm with a
spherical wrist, this equals the greatest distance of the wrist centre, which most makers state. For redundant
arms and arms without a closed form, computing the envelope takes long, so these arms have no reach. *Stated*
is the reach that the source states. *s* is the time of `map` in seconds.
"""

import json
import re
import subprocess
import sys
import tempfile
import time
from pathlib import Path

NAME = "name of the model"
XACRO = "name of the package's file"
MANUAL = "technical specifications in the maker's user manual (ufactory_doc_usermanual)"
UR = "table of models in api-evangelist/universal-robots"
# Stated reach, mm, and where it is stated.
STATED = {
    "abb_irb120": (580, XACRO),
    "abb_irb1200": (900, NAME),
    "abb_irb4600": (2050, NAME),
    "abb_irb6700": (2600, NAME),
    "doosan_m1013": (1300, NAME),
    "kuka_iiwa14": (820, NAME),
    "kuka_kr10_r1100": (1100, NAME),
    "kuka_kr150_r3100_2": (3100, NAME),
    "kuka_kr6_r900": (900, NAME),
    "techman_tm5_900": (900, NAME),
    "ufactory_xarm6": (700, MANUAL),
    "ur16e": (900, UR),
    "ur20": (1750, UR),
    "ur3e": (500, UR),
}
MAKERS = {"denso": "DENSO", "motoman": "Yaskawa", "puma": "Unimation", "ufactory": "UFACTORY", "ur": "Universal Robots"}


def maker(robot, name):
    word = robot.split("_")[0]
    return MAKERS.get(re.sub(r"\d+e?$", "", word), name.split()[0])


def main(program, *names):
    program = str(Path(program).resolve())

    def ran(*arguments, folder=None):
        run = subprocess.run([program, *arguments], cwd=folder, capture_output=True, text=True, check=True)
        return run.stdout

    print("| robot | maker | axes | inverse kinematics | reach mm | stated mm | stated by | s |")
    print("|---|---|---|---|---|---|---|---|")
    for robot in json.loads(ran("robots", "--json"))["robots"]:
        name, family = robot["robot"], robot["family"]
        if names and name not in names:
            continue
        with tempfile.TemporaryDirectory() as folder:
            ran("init", name, "--out", "cell", folder=folder)
            start = time.monotonic()
            ran("map", "cell/cell.toml", folder=folder)
            seconds = time.monotonic() - start
        sheet = json.loads(ran("robot", name, "--json"))["envelope"]
        reach = f"{sheet['size']['radius_mm'][1]:.1f}" if sheet else "-"
        stated, source = STATED.get(name, ("-", "-"))
        cells = [name, maker(name, robot["name"]), robot["axes"], family, reach, stated, source]
        print("|", " | ".join(map(str, [*cells, f"{seconds:.1f}"])), "|", flush=True)


main(*sys.argv[1:])
