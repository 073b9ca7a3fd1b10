"""Layouts of robot workcells with the least kinematic error.

All numbers equal those of the command `sweetspot` bit for bit. Lengths are in mm and angles in degrees, and
names state the unit. Joint coordinates of measurements are in rad, or in m for a prismatic joint. Arrays are
numpy arrays.
"""

from sweetspot._native import (
    Calibration,
    Cell,
    Errors,
    Evaluations,
    Evaluator,
    Map,
    Robot,
    Search,
    View,
    __version__,
    calibrate,
    compare,
    evaluator,
    robot,
    robots,
    schema,
)
from sweetspot import records
from sweetspot.errors import Fault, InputError, InputWarning, NoAnswerError, SweetspotError, UnreadableError

__all__ = [
    "Calibration",
    "Cell",
    "Errors",
    "Evaluations",
    "Evaluator",
    "Fault",
    "InputError",
    "InputWarning",
    "Map",
    "NoAnswerError",
    "Robot",
    "Search",
    "SweetspotError",
    "UnreadableError",
    "View",
    "__version__",
    "calibrate",
    "compare",
    "evaluator",
    "records",
    "robot",
    "robots",
    "schema",
]
