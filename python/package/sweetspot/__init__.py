"""Layouts of robot workcells with the least kinematic error.

Numbers are those of the command `sweetspot`, bit for bit: lengths in mm, angles in degrees, each under a name that
states its unit. Joint coordinates of measurements are in rad or m, and arrays are those of numpy.
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
