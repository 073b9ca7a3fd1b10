"""Types of the native module."""

from os import PathLike
from pathlib import Path
from typing import Any, Callable, Literal, Mapping, TypedDict

import numpy as np
import numpy.typing as npt
from typing_extensions import Self, Unpack, final

from sweetspot._record import Table
from sweetspot.errors import Fault
from sweetspot.records import (
    AlternativeEntry,
    BudgetDocument,
    CalibrationDocument,
    ComparisonDocument,
    IdentifiedParameter,
    MapDocument,
    OperationMapEntry,
    PlacementEntry,
    RobotSheetDocument,
    RobotsDocument,
    RobustDocument,
    SearchResult,
    SpotEntry,
    VerdictDocument,
)

__all__ = [
    "Calibration",
    "Cell",
    "Errors",
    "Evaluations",
    "Evaluator",
    "Map",
    "Robot",
    "Search",
    "View",
    "__version__",
    "arrow_stream",
    "calibrate",
    "compare",
    "evaluator",
    "robot",
    "robots",
    "schema",
]

__version__: str

_Path = str | PathLike[str]
_Packages = list[tuple[str, _Path]]
_Floats = npt.NDArray[np.float64]
_Session = tuple[npt.ArrayLike, npt.ArrayLike]

class _Question(TypedDict, total=False):
    """Flags that choose the error set and its interpretation, as in the commands."""

    errors: str | None
    model: Literal["nonlinear", "linear", "second-order"] | None
    sense: str | None
    limit: float | None
    reading: Literal["signed", "worst-case", "statistical"] | None
    quantity: Literal["rms", "mean", "p95", "p99", "yield"] | None
    registration: Literal["none", "best-fit", "taught"] | None

class _SearchFlags(_Question, total=False):
    """Flags of `sweetspot search`."""

    seed: int | None
    ideal: bool | None
    robust: bool | None
    pareto: list[str] | None
    keep: int | None
    solver: str | None
    budget: int | None
    gap: float | None
    stagnation: int | None

@final
class Cell:
    """Cell with its settings, which have been checked. A cell is immutable: `with_` returns another cell."""

    @staticmethod
    def read(path: _Path, *, packages: _Packages | None = None) -> Cell:
        """Reads a cell file and all files to which it refers."""
    @staticmethod
    def from_text(
        text: str, *, folder: _Path | None = None, name: str = "cell.toml", packages: _Packages | None = None
    ) -> Cell:
        """Reads a cell from the text of a cell file. The files to which the text refers are in `folder`."""
    def with_(self, *sets: str | Mapping[str, Any], **question: Unpack[_Question]) -> Cell:
        """Returns the cell with other settings. Each of `sets` is a text `PATH=VALUE` as after `--set`, or a dict of
        paths and values. The keywords `question` choose the errors and their interpretation."""
    def with_errors(self, errors: Errors) -> Cell:
        """Returns the cell with identified errors of the robot. If the cell states no reading (signed, worst-case or
        statistical), the default reading for these errors applies."""
    def map(
        self, operation: str | None = None, *, senses: Literal["all", "own"] = "all", **question: Unpack[_Question]
    ) -> Map:
        """Maps the error over the surface of an operation, or of all operations.

        `senses="own"` leaves out the figures in all senses except the sense of the operation. The map is then computed
        several times faster, and takes half the memory.
        """
    def search(
        self,
        *,
        time: float | None = None,
        threads: int | None = None,
        progress: Callable[[int, int, float | None], object] | None = None,
        **settings: Unpack[_SearchFlags],
    ) -> Search:
        """Searches for the layout of least error. Ctrl-C ends the search, which then returns the best layout so far.

        `time` is the limit of the computing time in seconds, and `threads` the number of threads (None: all cores).
        `progress` is called with the number of evaluations so far, the budget, and the least objective so far in the
        unit of the search (None if no layout is feasible yet).
        """
    def budget(
        self, operation: str | None = None, *, at: tuple[int, int] | None = None, **question: Unpack[_Question]
    ) -> BudgetDocument:
        """Returns the share of each parameter in the error at the spot of every operation. If `operation` is given, the
        record contains only this operation. If `at` is given, the node `at` (i, j) of the operation replaces the
        spot."""
    def robust(self, **question: Unpack[_Question]) -> RobustDocument:
        """Returns the sensitivity of every operation to misplaced equipment. The record also states the largest
        misplacement at which the operation stays feasible and within its limit."""
    def report(self, path: _Path) -> VerdictDocument:
        """Writes one HTML page about the start layout. Returns the record of the verdict, which is the answer at the
        top of the page. An existing page is replaced."""
    def view(self, *, port: int = 0, open: bool = False) -> View:
        """Serves a page on this machine on which the layout can be edited. Port 0 stands for any port that is not in
        use, and `open` opens the page in the browser."""
    def evaluator(self) -> Evaluator:
        """Returns a function from layouts to costs, which your own optimizer can call."""
    @property
    def name(self) -> str: ...
    @property
    def path(self) -> Path: ...
    @property
    def robot(self) -> Robot: ...
    @property
    def operations(self) -> list[str]:
        """Names of the operations."""
    @property
    def notes(self) -> list[str]:
        """Caveats on the interpretation of the errors."""
    @property
    def warnings(self) -> tuple[Fault, ...]:
        """Warnings about the files of the cell."""
    def _repr_html_(self) -> str: ...
    @staticmethod
    def _restored(path: Any, packages: Any, files: Any, settings: Any) -> Cell: ...

@final
class Map:
    """Error map of the start layout of a cell: a table of nodes, a record and a picture."""

    def __arrow_c_stream__(self, requested_schema: object | None = None) -> object: ...
    def __getitem__(self, name: str, /) -> npt.NDArray[Any]:
        """Returns a column of the table of nodes as a numpy array, in which a missing number is NaN."""
    def __len__(self) -> int: ...
    @property
    def columns(self) -> list[str]:
        """Names of the columns."""
    @property
    def nbytes(self) -> int:
        """Memory that the nodes take, in bytes."""
    @property
    def document(self) -> MapDocument:
        """Record of `sweetspot map --json`, without the nodes."""
    @property
    def operations(self) -> Table[OperationMapEntry]: ...
    @property
    def feasible(self) -> bool: ...
    @property
    def objective(self) -> float | None: ...
    @property
    def unit(self) -> str: ...
    @property
    def svg(self) -> str:
        """Picture of the map as the text of an SVG file."""
    def _repr_html_(self) -> str: ...

@final
class Search:
    """Result of a search."""

    @property
    def objective(self) -> float | None:
        """Objective of the best layout, in `unit`; None if no layout is feasible."""
    @property
    def unit(self) -> str: ...
    @property
    def bound(self) -> float | None:
        """Proven lower bound of the objective of every layout, in `unit`; None if no bound is proven."""
    @property
    def gap(self) -> float | None:
        """Relative gap: objective of the best layout / proven lower bound - 1 (0.01 is 1 %); None if there is no
        bound."""
    @property
    def cell(self) -> Cell:
        """Cell at the best layout. Raises ValueError if no layout is feasible."""
    @property
    def cells(self) -> list[Cell]:
        """Cells at the layouts of `front`, in the same order; empty if neither `pareto` nor `keep` is used."""
    @property
    def trace(self) -> _Floats:
        """Improvements of the search, shape (n, 2): number of evaluations, and least objective so far in `unit`."""
    @property
    def document(self) -> SearchResult:
        """Record of `sweetspot search --json`."""
    @property
    def operations(self) -> Table[SpotEntry]:
        """Spots of the operations in the best layout."""
    @property
    def front(self) -> Table[AlternativeEntry] | None:
        """Layouts of the Pareto front (`pareto`) or of the shortlist (`keep`); None if neither setting is used."""
    @property
    def layout(self) -> dict[str, PlacementEntry]:
        """Placement of every piece of equipment in the best layout."""
    @property
    def ended(self) -> str:
        """Reason why the search ended, such as `interrupted`."""
    @property
    def evaluations(self) -> int:
        """Number of layouts evaluated."""
    def report(self, path: _Path) -> VerdictDocument:
        """Writes one HTML page about the result. Returns the record of the verdict, which is the answer at the top of
        the page. An existing page is replaced."""
    def _repr_html_(self) -> str: ...

@final
class Evaluator:
    """Function from layouts to costs.

    A layout is given as a point of the unit cube or, with `units=True`, by its free coordinates in mm and degrees.
    """

    @property
    def dim(self) -> int:
        """Number of free coordinates."""
    @property
    def names(self) -> list[str]:
        """Path of every free coordinate in the cell file, in the form that `Cell.with_` accepts."""
    @property
    def unit(self) -> str:
        """Unit of the costs."""
    @property
    def bounds(self) -> _Floats:
        """Least and greatest value of every free coordinate in mm or degrees, shape (dim, 2)."""
    @property
    def start(self) -> _Floats:
        """Point of the unit cube for the start layout."""
    @property
    def cell(self) -> Cell:
        """Cell whose layouts are evaluated."""
    def __call__(self, /, layouts: npt.ArrayLike, *, units: bool = False) -> Any:
        """Returns the costs (n,) of layouts (n, dim), or the cost of one layout (dim,).

        The cost of a layout within every limit is its objective, in `unit`. A layout that misses a limit costs more
        than 100 w, and an infeasible layout costs at least 1000 w. The cost of an infeasible layout increases with
        its distance from feasibility.

        The weight w depends on the objective. For `sum`, w is the sum of the weights of the operations. For `max`, w
        is the largest of these weights. For `lexicographic`, w is 1. For `tolerance-cost`, w is the cost of the
        tightest tolerances. If the objective is an error, the multiples of w are in m or rad, and are converted to
        `unit`. If `unit` is mm and w is 2, for example, 100 w is 200 m = 200 000 mm.
        """
    def evaluate(self, layouts: npt.ArrayLike, *, units: bool = False, reasons: bool = False) -> Evaluations:
        """Evaluates layouts: costs, objectives, values of the operations and, if `reasons` is True, the reasons why a
        layout is not feasible."""
    def to_units(self, points: npt.ArrayLike) -> _Floats:
        """Returns the coordinates in mm and degrees of the layouts at points of the unit cube."""
    def from_units(self, layouts: npt.ArrayLike) -> _Floats:
        """Returns the points of the unit cube for layouts in mm and degrees, which must be inside the bounds."""
    def cell_at(self, layout: npt.ArrayLike, *, units: bool = False) -> Cell:
        """Returns the cell at one layout."""

@final
class Evaluations:
    """Evaluations of n layouts."""

    @property
    def costs(self) -> _Floats:
        """Costs in `unit`, shape (n,)."""
    @property
    def objectives(self) -> _Floats:
        """Objectives in `unit`, shape (n,); NaN for a layout that is not feasible."""
    @property
    def feasible(self) -> npt.NDArray[np.bool_]:
        """Whether each layout is feasible and within every limit, shape (n,)."""
    @property
    def values(self) -> _Floats:
        """Value of every operation at its spot in `unit`, shape (n, operations); NaN if the operation has no spot."""
    @property
    def reasons(self) -> list[list[str]] | None:
        """Reasons why each layout is not feasible; None unless `reasons=True`."""
    @property
    def operations(self) -> list[str]:
        """Names of the operations."""
    @property
    def unit(self) -> str: ...
    def __arrow_c_stream__(self, requested_schema: object | None = None) -> object: ...
    def __len__(self) -> int: ...

@final
class Robot:
    """Robot: chain, limits, tool and error sets."""

    @property
    def name(self) -> str: ...
    @property
    def joints(self) -> list[str]:
        """Names of the joints."""
    @property
    def errors(self) -> list[str]:
        """Names of the error sets."""
    def sheet(self) -> RobotSheetDocument:
        """Returns the data sheet of the robot, which is the record of `sweetspot robot --json`."""

@final
class Errors:
    """Error set of a robot: the table `errors.NAME` of a robot file."""

    @property
    def name(self) -> str: ...
    @property
    def toml(self) -> str:
        """Text of the table `errors.NAME` for a robot file."""

@final
class Calibration:
    """Identified errors of a robot, with their uncertainty."""

    @property
    def errors(self) -> Errors:
        """Identified errors, for `Cell.with_errors`."""
    @property
    def document(self) -> CalibrationDocument:
        """Record of `sweetspot calibrate --json`."""
    @property
    def parameters(self) -> Table[IdentifiedParameter]:
        """Table of the identified parameters."""
    @property
    def covariance(self) -> _Floats:
        """Covariance matrix of the unknowns in products of their units (m, rad, rad/m); harmonics are in the last rows
        and columns."""
    @property
    def residual_mm(self) -> float | None:
        """Residual standard deviation per axis, in mm."""

@final
class View:
    """Server of a page on this machine on which a layout can be edited.

    The server ends at `stop`, at the end of the `with` block, or with the process.
    """

    @property
    def url(self) -> str:
        """Address of the page. It contains the secret that admits a browser."""
    def stop(self) -> None:
        """Ends the server."""
    def __enter__(self) -> Self: ...
    def __exit__(self, *_exception: Any) -> None: ...
    def _repr_html_(self) -> str: ...

def arrow_stream(names: list[str], columns: list[list[Any]]) -> object:
    """Returns columns of Python values as the capsule of an Arrow stream, for `sweetspot.records.Table`.

    A column is a list of texts, of numbers, of flags, or of lists of numbers; None is a missing value.
    """

def calibrate(
    robot: Robot,
    q: npt.ArrayLike | list[_Floats],
    measured: npt.ArrayLike | list[_Floats],
    *,
    unit: Literal["m", "mm"] = "m",
    sigma: float | None = None,
    test: _Session | list[_Session] | None = None,
    elastic: bool = False,
    harmonics: int | None = None,
) -> Calibration:
    """Identifies the kinematic errors of a robot from measured positions of its tool.

    `q` contains the joint coordinates (n, axes) in rad (m for a prismatic joint). `measured` contains the positions (n,
    3) or the poses (n, 4, 4) of one reflector in the frame of the instrument, in `unit`. `sigma` is the standard
    deviation of the instrument per axis, in `unit`. `test` is a pair (q, measured) that is not part of the fit.

    `elastic` adds the deflection of the joints by the weight of the links. `harmonics` is the largest order of the
    periodic errors of the revolute joints; None adds no periodic errors.

    For several sessions with different frames of the instrument or different tools, `q` and `measured` are lists with
    one array per session. `test` may be a list of pairs (q, measured).
    """

def compare(*layouts: Cell | Search, names: list[str] | None = None) -> ComparisonDocument:
    """Compares the start layouts of cells and the best layouts of searches. The first layout is the reference."""

def evaluator(cell: Cell) -> Evaluator:
    """Returns a function from layouts to costs, which your own optimizer can call."""

def robot(name: _Path, *, packages: _Packages | None = None) -> Robot:
    """Returns a built-in robot by its name, or reads a robot file or a URDF."""

def robots() -> RobotsDocument:
    """Returns the list of built-in robots, which is the record of `sweetspot robots --json`."""

def schema(kind: str = "cell") -> dict[str, Any]:
    """Returns the JSON Schema of a kind of file or document, such as `cell` or `map`, as a dict."""
