"""Records: the typed documents of the commands. Lengths are in mm and angles in degrees, unless a name says otherwise.

Made by python/make_records.py from the JSON Schemas; do not edit.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Dict, List, Literal, Optional

from sweetspot._record import Record, Table

if TYPE_CHECKING:
    from sweetspot._record import _Numbers


class AccuracyEntry(Record):
    """Statistics of position errors, mm."""

    mean_mm: float
    rms_mm: float
    p95_mm: float
    max_mm: float


class AccuracyQuantiles(Record):
    """Quantiles of the pose accuracy AP of simulated robots, mm. The accuracy of one robot is the mean over five
    poses.
    """

    median_mm: float
    p5_mm: float
    """5th percentile: 5 % of the robots are better."""
    p95_mm: float
    """95th percentile: 95 % of the robots are better."""
    worst_pose_mm: float
    """Median over all robots of the AP that each robot has at its worst pose."""


class AllocatedEntry(Record):
    """Tolerance of one parameter before and after the allocation."""

    parameter: str
    unit: Literal['deg/m', 'deg/Nm', '1', 'mm', 'deg']
    cost_kind: Literal['reciprocal', 'exponential', 'grades']
    before: float
    """Half width of the tolerance in the error set."""
    after: Optional[float]
    """Half width of the cheapest tolerance; null if infeasible."""
    scale: Optional[float]
    """`after` divided by `before`; null if infeasible."""
    scale_range: _Numbers
    """Least and greatest permitted scale."""
    cost_before: float
    cost: Optional[float]
    grade: Optional[str]
    """Name of the chosen grade; null for a continuous cost."""
    at_end: Optional[Literal['tightest', 'loosest']]
    """If the tolerance lies at an end of its permitted range, this end. Null if it lies between the ends."""

    _nested = {
        'scale_range': ('numbers', ''),
    }


class AllocationDocument(Record):
    """Tolerance allocation: the cheapest tolerances with which every operation stays within its limit."""

    schema: Literal['sweetspot/allocation/1']
    cell: str
    robot: str
    errors: str
    """Name of the error set."""
    model: Literal['nonlinear', 'linear', 'second-order']
    reading: Literal['signed', 'worst-case', 'statistical']
    quantity: str
    """Name of the error figure that the reading (interpretation of errors) gives, such as "worst case"."""
    registration: Literal['none', 'best-fit', 'taught']
    demanded_yield: Optional[float]
    """Required yield: share of arms with random parameter errors that must stay within each limit. Null unless
    the quantity is the yield.
    """
    status: Literal['cheapest', 'exceeded', 'infeasible']
    cost_before: float
    """Cost of the tolerances in the error set."""
    cost: Optional[float]
    """Cost of the final tolerances; null if infeasible. If the optimized tolerances give a figure above its
    limit, the program finally reduces all tolerances. This reduction increases `cost`.
    """
    lower_bound: Optional[float]
    """Proven lower bound of the cost; null if infeasible. The proof uses figures of the linear error model. A
    factor adapts each of these figures to the error model of the cell.
    """
    duality_gap: Optional[float]
    """Duality gap: relative distance of the cost from its lower bound; null if infeasible."""
    uniform: Optional[UniformEntry]
    """Uniform tightening for comparison; null if no common scale meets the limits."""
    parameters: Table[AllocatedEntry]
    fixed: List[str]
    """Names of the error parameters that the allocation does not change, because they are measured or
    correlated.
    """
    requirements: Table[AllocationRequirement]
    shortfalls: Table[ShortfallEntry]
    """Limits that figures exceed even at the tightest tolerances."""
    judgement: Optional[JudgementEntry]
    """Judgement of the tolerances by the error model of the cell; null if infeasible."""

    _nested = {
        'uniform': ('record', 'UniformEntry'),
        'parameters': ('table', 'AllocatedEntry'),
        'requirements': ('table', 'AllocationRequirement'),
        'shortfalls': ('table', 'ShortfallEntry'),
        'judgement': ('record', 'JudgementEntry'),
    }


class AllocationRequirement(Record):
    """One operation at one node with its limit. Figures are in `unit`."""

    operation: str
    node: List[int]
    unit: Literal['share', 'cost', 'mm', 'deg']
    limit: float
    before: float
    """Figure that the tolerances in the error set give."""
    after: Optional[float]
    """Figure with the cheapest tolerances, judged by the error model of the cell; null if infeasible."""
    is_binding: bool
    """Whether the figure is at its limit."""
    shadow_price: Optional[float]
    """Decrease of the cost for each unit by which the limit is raised; null if infeasible."""
    sampled: Optional[float]
    """Figure that Monte Carlo samples of the nonlinear model give; null if the node was not sampled."""


class AlternativeEntry(Record):
    """Layout of the Pareto front or of the shortlist. The shortlist contains the best layouts that differ
    clearly from each other.
    """

    file: str
    """Cell file of the layout in the folder of the search."""
    objective_value: Optional[float]
    goals: GoalsEntry
    layout: Dict[str, PlacementEntry]
    base: PlacementEntry
    attitudes: Dict[str, AttitudeEntry]

    _nested = {
        'goals': ('record', 'GoalsEntry'),
        'layout': ('named', 'PlacementEntry'),
        'base': ('record', 'PlacementEntry'),
        'attitudes': ('named', 'AttitudeEntry'),
    }


class AssumedEntry(Record):
    """Value that the cell file leaves out and that was assumed."""

    key: str
    """Key with which a cell file states this value."""
    value: str
    """Assumed value in the notation of the cell file."""


class AttitudeEntry(Record):
    """Angles of a tool attitude that the search may change, degrees."""

    bend_deg: Optional[float]
    azimuth_deg: Optional[float]
    spin_deg: Optional[float]


class BoundEntry(Record):
    """Tightest permitted tolerance of a parameter."""

    parameter: str
    unit: Literal['deg/m', 'deg/Nm', '1', 'mm', 'deg']
    tightest: float
    without: float
    """Figure that results if this parameter has no error and all others have their tightest tolerances. The unit
    is the unit of the limit.
    """


class BudgetDocument(Record):
    """Error budget: contribution of every parameter to the error at the spots."""

    schema: Literal['sweetspot/budget/1']
    cell: str
    robot: str
    errors: str
    """Name of the error set."""
    model: Literal['nonlinear', 'linear', 'second-order']
    reading: Literal['signed', 'worst-case', 'statistical']
    quantity: Literal['error', 'worst case', 'share of failures', 'rms', 'mean', 'p95', 'p99', 'tolerance cost']
    """Name of the error figure that the reading (interpretation of errors) gives, such as "worst case"."""
    registration: Literal['none', 'best-fit', 'taught']
    operations: Table[OperationBudget]

    _nested = {
        'operations': ('table', 'OperationBudget'),
    }


class CalibratedFile(Record):
    """File of measured positions from which the parameters are identified."""

    file: str
    poses: int
    """Number of measured positions."""
    before: AccuracyEntry
    """Distances of the measured positions from the positions of the nominal robot, after base and reflectors are
    fitted.
    """
    after: AccuracyEntry
    """Distances of the measured positions from the positions of the calibrated robot, after base and reflectors
    are fitted.
    """
    outliers: Table[OutlierRow]
    """Rows whose measured position is more than six standard deviations from the prediction."""

    _nested = {
        'before': ('record', 'AccuracyEntry'),
        'after': ('record', 'AccuracyEntry'),
        'outliers': ('table', 'OutlierRow'),
    }


class CalibrationDocument(Record):
    """Kinematic errors of a robot, identified from measured positions."""

    schema: Literal['sweetspot/calibration/1']
    robot: str
    sessions: Table[CalibratedFile]
    """Files from which the parameters are identified."""
    tests: Table[TestedFile]
    """Files that test the parameters, but do not serve to identify them. Base and reflectors are fitted to each
    file.
    """
    held_out: Optional[AccuracyEntry]
    """Errors of predictions for blocks of the joint space that were left out of the fit. Null if the data do not
    allow such a fit.
    """
    parameters: Table[IdentifiedParameter]
    harmonics: Table[HarmonicsEntry]
    """Periodic errors of the joints; empty if none were requested."""
    rank: int
    """Number of combinations of parameters that the data determine. After the fit, the standard deviation of
    such a combination is less than half its prior standard deviation.
    """
    unidentified: List[str]
    """Combinations of parameters that the data do not determine."""
    residual_mm: Optional[float]
    """Residual standard deviation per axis, mm. Null if a file states the parameters."""
    misfit: Optional[MisfitEntry]
    """Errors that the parameters do not explain. Null if a file states the parameters."""
    seconds: float
    """Time of the fit and of the cross-validation, s."""

    _nested = {
        'sessions': ('table', 'CalibratedFile'),
        'tests': ('table', 'TestedFile'),
        'held_out': ('record', 'AccuracyEntry'),
        'parameters': ('table', 'IdentifiedParameter'),
        'harmonics': ('table', 'HarmonicsEntry'),
        'misfit': ('record', 'MisfitEntry'),
    }


class CellYieldEntry(Record):
    """Share of sampled arms that stay within the limits of the operations at their spots (Monte Carlo, nonlinear
    model). If an operation must keep its limit at every node, the operation is judged at its worst node. An
    operation without a limit counts as within its limit. The intervals are Wilson score intervals for 95 %.
    """

    samples: int
    together: EstimateEntry
    """Share of arms that stay within the limits of all operations."""
    operations: Dict[str, EstimateEntry]
    """Share of arms that stay within the limit of one operation, for each operation with a limit."""

    _nested = {
        'together': ('record', 'EstimateEntry'),
        'operations': ('named', 'EstimateEntry'),
    }


class CheckDocument(Record):
    """Result of a check: whether a cell file is valid, and all its faults."""

    schema: Literal['sweetspot/check/1']
    valid: bool
    faults: Table[Fault]
    self_collision: Table[OwnPairEntry]
    """Pairs of the robot's solids. A pair states a reason if contact of its two solids is allowed. If self-
    collision is not checked, the list holds only pairs with the pedestal.
    """
    operations: Table[OperationOrderEntry]
    """Entries that state how a search treats each operation. Empty if the cell is not valid."""
    urdf: Optional[UrdfEntry]
    """Facts derived from a URDF; left out for a robot given by Denavit-Hartenberg rows."""

    _nested = {
        'faults': ('table', 'Fault'),
        'self_collision': ('table', 'OwnPairEntry'),
        'operations': ('table', 'OperationOrderEntry'),
        'urdf': ('record', 'UrdfEntry'),
    }


class Choices(Record):
    """Key of a cell, with the values that a sweep sets one after the other."""

    path: str
    values: List[str]


class CommandedJoint(Record):
    """Joint with the unit of its coordinate."""

    name: str
    unit: Literal['share', 'cost', 'mm', 'deg']
    passive: bool
    """Whether the joint has no actuator. Tables for people leave out passive joints."""


class ComparedFile(Record):
    """Comparison of a file of measured positions with the errors that the cell predicts. Base and reflectors are
    fitted so that the nominal arm matches the measured positions best. Vectors are in the base frame of the
    robot, mm.
    """

    file: str
    measured: AccuracyEntry
    """Statistics of the measured errors: the distances between measured and nominal positions."""
    predicted: AccuracyEntry
    """Statistics of the predicted sizes of these errors."""
    predicted_rms: bool
    """Whether the predicted sizes include the random part of the errors. Sizes that include this part are root
    mean squares.
    """
    residual: AccuracyEntry
    """Statistics of the lengths of the differences between measured and predicted errors."""
    coverage_95: Optional[float]
    """Share of the positions inside their predicted 95 % ellipsoids. Null if the errors have no random part.
    These ellipsoids assume that the random parameter errors of a robot have the same values at all poses. The
    fit of base and reflectors absorbs a part of the random errors.
    """
    coverage_95_varying: Optional[float]
    """Share of the positions inside a second set of 95 % ellipsoids. These ellipsoids assume that the random
    parameter errors change from pose to pose, as the misfit of a calibration does. Null unless the error set
    of the robot comes from measurements.
    """
    rank_correlation: Optional[float]
    """Spearman correlation of predicted and measured sizes over all positions. Null if all predicted or all
    measured sizes are equal.
    """
    spots: SpotRankingEntry
    repeats: Optional[RepeatsEntry]
    """Accuracy and repeatability of postures that were visited several times; null if there is no such posture."""
    positions: Table[ComparedPosition]

    _nested = {
        'measured': ('record', 'AccuracyEntry'),
        'predicted': ('record', 'AccuracyEntry'),
        'residual': ('record', 'AccuracyEntry'),
        'spots': ('record', 'SpotRankingEntry'),
        'repeats': ('record', 'RepeatsEntry'),
        'positions': ('table', 'ComparedPosition'),
    }


class ComparedLayout(Record):
    """One layout of a comparison. Positions are in the world frame, mm; angles are in degrees."""

    name: str
    feasible: bool
    objective_mm: Optional[float]
    """Objective if it is a length; null otherwise."""
    objective: Optional[float]
    """Objective of the layout, in `unit`; null if the layout is not feasible."""
    unit: Literal['share', 'cost', 'mm', 'deg']
    change_percent: Optional[float]
    """Change of the objective relative to the first layout, percent."""
    cycle_time: Optional[CycleTimeEntry]
    """Cycle time; left out if the layout is not feasible."""
    reasons: List[str]
    """Reasons why the layout is not feasible."""
    layout: Dict[str, PlacementEntry]
    base: PlacementEntry
    attitudes: Dict[str, AttitudeEntry]
    operations: Table[SpotEntry]

    _nested = {
        'cycle_time': ('record', 'CycleTimeEntry'),
        'layout': ('named', 'PlacementEntry'),
        'base': ('record', 'PlacementEntry'),
        'attitudes': ('named', 'AttitudeEntry'),
        'operations': ('table', 'SpotEntry'),
    }


class ComparedPosition(Record):
    """One measured position with its prediction, in the base frame of the robot."""

    row: int
    """Line of the file, counted from 1."""
    reflector: int
    """Number of the reflector, counted from 1."""
    joints: _Numbers
    """Joint coordinates: degrees, or mm for a prismatic joint."""
    nominal_mm: _Numbers
    """Position of the reflector for the nominal robot."""
    measured_mm: _Numbers
    """Measured error: the measured minus the nominal position."""
    predicted_mm: _Numbers
    """Predicted error without the part that the fit of base and reflectors absorbs."""
    predicted_size_mm: float
    """Predicted size of the error."""
    residual_mm: float
    """Length of the difference between `measured_mm` and `predicted_mm`."""
    inside_95: Optional[bool]
    """Whether the measured error is inside the predicted 95 % ellipsoid. Null if the errors have no random part."""

    _nested = {
        'joints': ('numbers', ''),
        'nominal_mm': ('numbers', ''),
        'measured_mm': ('numbers', ''),
        'predicted_mm': ('numbers', ''),
    }


class ComparisonDocument(Record):
    """Comparison of layouts; the first layout is the reference."""

    schema: Literal['sweetspot/compare/1']
    layouts: Table[ComparedLayout]

    _nested = {
        'layouts': ('table', 'ComparedLayout'),
    }


class CornerEntry(Record):
    """Misplacement, and the value of the operation at this misplacement in the unit of the objective."""

    moves: Dict[str, MoveEntry]
    value: float

    _nested = {
        'moves': ('named', 'MoveEntry'),
    }


class CorrectionDocument(Record):
    """Joint and pose commands with which a robot with known errors lands on its targets."""

    schema: Literal['sweetspot/correction/1']
    cell: str
    robot: str
    errors: str
    """Name of the error set."""
    registration: Literal['none', 'best-fit', 'taught']
    joints: Table[CommandedJoint]
    """Joints of the robot. Every list of joint coordinates has the order of this list."""
    targets: Table[CorrectionEntry]

    _nested = {
        'joints': ('table', 'CommandedJoint'),
        'targets': ('table', 'CorrectionEntry'),
    }


class CorrectionEntry(Record):
    """One target with its correction."""

    operation: str
    name: Optional[str]
    """Name of the target in the table of targets; null for a node."""
    node: Optional[List[int]]
    """Indices of the node along x and y of the surface; null for a target of a table."""
    position_mm: Optional[_Numbers]
    """Position of the target in the world frame."""
    state: Literal['corrected', 'joint-limit', 'not-converged', 'unusable']
    reason: Optional[str]
    """Reason why the target is not corrected; null if the target is corrected."""
    nominal_joints: Optional[_Numbers]
    """Joint coordinates without correction: degrees, or mm for a prismatic joint."""
    joints: Optional[_Numbers]
    """Corrected joint coordinates, the joint command: degrees, or mm for a prismatic joint."""
    command: Optional[PoseEntry]
    """Pose command for a controller without calibration: the nominal pose of the TCP at the joint command, in
    the base frame.
    """
    before_mm: Optional[float]
    """Position error of the TCP without correction."""
    before_deg: Optional[float]
    """Orientation error of the TCP without correction."""
    rest_mm: Optional[float]
    """Position error of the TCP that remains after the correction."""
    rest_deg: Optional[float]
    """Orientation error of the TCP that remains after the correction."""
    random_mm: Optional[float]
    """Root mean square of the random position error, which no correction removes; null without random errors."""
    random_deg: Optional[float]
    """Root mean square of the random orientation error; null without random errors."""
    steps: Optional[int]
    """Number of Newton steps."""

    _nested = {
        'position_mm': ('numbers', ''),
        'nominal_joints': ('numbers', ''),
        'joints': ('numbers', ''),
        'command': ('record', 'PoseEntry'),
    }


class CycleStepEntry(Record):
    """Step of a cycle."""

    phase: Literal['approach', 'dwell', 'retract', 'transfer', 'direct-move']
    operation: str
    """Operation of the step; for a move between operations, the operation before the move."""
    next: Optional[str]
    """Operation after the move; null if the step is not a move between operations."""
    time_s: float


class CycleTimeEntry(Record):
    """Least time of the operations and motions of a layout, at the maximum speeds and accelerations of the
    joints.
    """

    total_s: Optional[float]
    """Sum of the times of all steps; null if the maximum speed of a joint is not given."""
    is_cycle: bool
    """Whether the robot returns to the first operation, so that the total is the time of a cycle."""
    is_estimate: bool
    """Whether an acceleration is assumed, so that the times are estimates."""
    steps: Table[CycleStepEntry]
    """Steps in the order of execution; empty if the maximum speed of a joint is not given."""
    missing_speeds: List[str]
    """Joints whose maximum speed is missing."""

    _nested = {
        'steps': ('table', 'CycleStepEntry'),
    }


class DhEntry(Record):
    """Row of the Denavit-Hartenberg table: `Rz(theta) Tz(r) Tx(l) Rx(alpha)`."""

    kind: Literal['passive', 'revolute', 'prismatic']
    q: float
    """Actuator coordinate: degrees, or mm for a prismatic joint."""
    within_limits: bool
    theta_deg: float
    r_mm: float
    l_mm: float
    alpha_deg: float


class DiscrepancyEntry(Record):
    """Discrepancy between linear and nonlinear error in percent, as defined by eq. (9) of the seed paper. Fields
    x, y and z compare the components; r compares the lengths of the two vectors.
    """

    x: Optional[float]
    y: Optional[float]
    z: Optional[float]
    r: Optional[float]


class DisplacementEntry(Record):
    """Small displacement of the TCP."""

    position_mm: _Numbers
    size_mm: float
    rotation_deg: _Numbers

    _nested = {
        'position_mm': ('numbers', ''),
        'rotation_deg': ('numbers', ''),
    }


class EnvelopeDocument(Record):
    """Working envelope of a robot in its base frame."""

    schema: Literal['sweetspot/envelope/1']
    robot: str
    family: str
    """Name of the method that solves the inverse kinematics."""
    operation: Optional[str]
    """Operation whose attitude the tool keeps; null if the attitude does not come from an operation."""
    frame: Literal['base']
    bend_deg: float
    """Elevation of the tool axis above the horizontal."""
    step_mm: float
    """Distance between neighbouring sample points. The envelope is computed from these points."""
    size: SizeEntry
    section: SectionEntry
    plans: Table[PlanEntry]

    _nested = {
        'size': ('record', 'SizeEntry'),
        'section': ('record', 'SectionEntry'),
        'plans': ('table', 'PlanEntry'),
    }


class EnvelopeSize(Record):
    """Size of the working envelope of a robot."""

    bend_deg: float
    """Elevation of the tool axis above the horizontal."""
    step_mm: float
    """Distance between neighbouring sample points. The envelope is computed from these points."""
    size: SizeEntry

    _nested = {
        'size': ('record', 'SizeEntry'),
    }


class ErrorSetEntry(Record):
    """Error set of a robot."""

    name: str
    kind: Literal['signed', 'tolerance', 'measured']


class ErrorsDocument(Record):
    """Tolerances of a robot, with the pose accuracy (ISO 9283) that these tolerances give. Guessed tolerances
    are not a measurement of the robot.
    """

    schema: Literal['sweetspot/errors/1']
    robot: str
    name: str
    """Name of the error set, as in the TOML table that `errors --toml` prints."""
    guess: bool
    """True if the tolerances are guesses, either from a preset or from a data sheet. If false, the tolerances
    come from an error set of the robot.
    """
    source: str
    """Description of the origin of the tolerances, as in the TOML table that `errors --toml` prints."""
    origin: Literal['robot', 'preset']
    origin_name: str
    """Name of the preset, or of the error set of the robot."""
    base: Literal['fitted', 'nominal']
    """Frame to which the accuracy refers."""
    wanted_ap_mm: Optional[float]
    """Pose accuracy AP that the data sheet states; null if none is stated."""
    wanted_rp_mm: Optional[float]
    """Pose repeatability RP that the data sheet states; null if none is stated."""
    scale: float
    """Factor that multiplies the tolerances of the preset or of the robot's error set."""
    steps: int
    """Number of iterations that the program needs to find `scale`. Each iteration predicts the accuracy once."""
    ap: AccuracyQuantiles
    """Predicted pose accuracy AP from the constant errors alone."""
    ap_of_set: AccuracyQuantiles
    """Predicted pose accuracy AP from the tolerances in `parameters`. These tolerances include the random
    errors.
    """
    joint_scatter: Optional[_Numbers]
    """Standard deviations of the joint coordinates: degrees, or mm for a prismatic joint. Together they cause
    the repeatability `wanted_rp_mm`. Null if `wanted_rp_mm` is null.
    """
    cube: TestCubeEntry
    parameters: Table[SpreadEntry]
    """Tolerances that are not 0."""

    _nested = {
        'ap': ('record', 'AccuracyQuantiles'),
        'ap_of_set': ('record', 'AccuracyQuantiles'),
        'joint_scatter': ('numbers', ''),
        'cube': ('record', 'TestCubeEntry'),
        'parameters': ('table', 'SpreadEntry'),
    }


class EstimateEntry(Record):
    """Estimated figure with its 95 % confidence interval."""

    value: float
    low: float
    high: float


class ExpectedEntry(Record):
    """Expected root mean square error of predicted positions at the operations. The expected errors assume that
    the base frame is measured again with the robot after the calibration. They leave out the part that the
    new base frame removes. They also leave out errors that the unknowns of the calibration cannot explain.
    """

    nodes: int
    """Number of nodes in the root mean square: the usable nodes of all operations."""
    before_mm: float
    """Error without a measurement, from the standard deviations of the unknowns."""
    after_mm: float
    """Error after the planned poses are measured."""
    evenly_spread_mm: float
    """Error after another set of poses is measured. This set has as many poses as the plan, spread evenly over
    the joint space.
    """
    shared_misfit_mm: float
    """Assumed standard deviation, per axis, of one part of the errors that the unknowns do not explain. This
    part is nearly the same at nearby poses.
    """
    own_misfit_mm: float
    """Assumed standard deviation, per axis, of the other part of the errors that the unknowns do not explain.
    This part is independent from pose to pose.
    """


class ExplanationDocument(Record):
    """Error calculation of one posture with all intermediate results, for a check by hand. Lengths are in mm,
    angles in degrees.
    """

    schema: Literal['sweetspot/explain/1']
    cell: str
    robot: str
    errors: str
    """Name of the error set."""
    model: Literal['nonlinear', 'linear', 'second-order']
    reading: Literal['signed', 'worst-case', 'statistical']
    quantity: Literal['error', 'worst case', 'share of failures', 'rms', 'mean', 'p95', 'p99', 'tolerance cost']
    """Name of the error figure that the reading (interpretation of errors) gives, such as "worst case"."""
    registration: Literal['none', 'best-fit', 'taught']
    name: str
    equipment: str
    sense: str
    limit: Optional[float]
    """Largest allowed error of the operation, in the unit of its sense."""
    node: Optional[List[int]]
    """Indices of the node; null if joint values were given."""
    position_mm: _Numbers
    """Position of the TCP in the world frame."""
    joints_deg: _Numbers
    """Joint coordinates: degrees, or mm for a prismatic joint."""
    base: PlacementEntry
    """Placement of the robot base in the world frame."""
    tool_axis_world: _Numbers
    tool_elevation_deg: float
    """Angle of the tool axis above the horizontal."""
    convention: str
    """Denavit-Hartenberg convention of the rows in the robot file."""
    dh: Table[DhEntry]
    """Rows of the Denavit-Hartenberg table at the posture, always in standard convention. For a file in modified
    convention, row k has l and alpha of row k + 1 of the file. The pose of frame 0 includes l and alpha of
    row 1 of the file. In the last row of this table, l and alpha are 0.
    """
    frames: Table[FrameEntry]
    """Frames of the links and of the TCP, in the base frame."""
    parameters: Table[ParameterEntry]
    linear: DisplacementEntry
    """Error of the TCP by the linear model, in the world frame."""
    second_order_correction: DisplacementEntry
    """Second-order correction of the linear model, in the world frame."""
    second_order: DisplacementEntry
    """Error of the TCP by the second-order model, in the world frame."""
    nonlinear: DisplacementEntry
    """Error of the TCP by the nonlinear model, in the world frame."""
    robot_alone_nonlinear: DisplacementEntry
    """Nonlinear error of the robot alone, in the world frame. This error ignores the registration and the errors
    of the equipment. If the operation places a picked part, the error at the pick is ignored, too.
    """
    taken_off_nonlinear: DisplacementEntry
    """Difference `robot_alone_nonlinear` minus `nonlinear`, in the world frame. The registration and the errors
    of the equipment cause this difference. If the operation places a picked part, the error at the pick
    contributes, too.
    """
    guard: PostureGuardEntry
    sense_rows: Table[SenseRowEntry]
    """Rows of the sense: weighted components of the error, with their values."""
    worst_corner: Optional[Dict[str, int]]
    """Sign of every parameter at the worst corner of the tolerance box. Null in the signed reading if the errors
    of the sample compensate each other. The program assumes such compensation if the error of a Denavit-
    Hartenberg length (r or l) exceeds the reach of the arm.
    """
    total: TotalEntry
    margin: Optional[float]
    """Limit minus the value of the operation; negative if the value exceeds the limit. If a certificate is
    required, the margin is the limit minus the upper bound of the value over all misplacements. If this bound
    is not known, the margin remains the limit minus the value. Null if the operation has no limit, or if the
    quantity is the yield.
    """
    monte_carlo: Optional[MonteCarloEntry]
    """Monte Carlo check of the posture; null unless the reading is statistical."""
    value: float
    """Value of the figure named in `quantity`; its unit is given in `unit`."""
    unit: Literal['share', 'cost', 'mm', 'deg']

    _nested = {
        'position_mm': ('numbers', ''),
        'joints_deg': ('numbers', ''),
        'base': ('record', 'PlacementEntry'),
        'tool_axis_world': ('numbers', ''),
        'dh': ('table', 'DhEntry'),
        'frames': ('table', 'FrameEntry'),
        'parameters': ('table', 'ParameterEntry'),
        'linear': ('record', 'DisplacementEntry'),
        'second_order_correction': ('record', 'DisplacementEntry'),
        'second_order': ('record', 'DisplacementEntry'),
        'nonlinear': ('record', 'DisplacementEntry'),
        'robot_alone_nonlinear': ('record', 'DisplacementEntry'),
        'taken_off_nonlinear': ('record', 'DisplacementEntry'),
        'guard': ('record', 'PostureGuardEntry'),
        'sense_rows': ('table', 'SenseRowEntry'),
        'total': ('record', 'TotalEntry'),
        'monte_carlo': ('record', 'MonteCarloEntry'),
    }


class ExtrapolatedEntry(Record):
    """Usable nodes at which a joint is outside the range that the measurements for the calibration cover."""

    nodes: int
    """Number of usable nodes at which a joint is outside its measured range."""
    joints: List[str]
    """Names of the joints that are outside their measured range at one or more usable nodes."""
    spot: bool
    """Whether a joint is outside its measured range at the spot."""


class FactEntry(Record):
    """Key figure of the verdict, with its description."""

    label: str
    value: Optional[float]
    """Value of the figure, not rounded for display."""
    text: str
    note: str
    mood: Literal['good', 'bad', 'plain']


class FailedCombination(Record):
    """Combination that its last worker did not finish. The next free worker takes over the combination, unless
    the combination is given up.
    """

    index: int
    host: Optional[str]
    """Host of the last worker; null if no worker of `sweep --claim` is known."""
    process: Optional[int]
    why: str
    given_up: bool
    """Whether the combination is given up, because too many workers have died while they processed it. No worker
    of `sweep --claim` takes over such a combination.
    """


class Fault(Record):
    """Fault in one file: where it is, what is wrong and what to do. Lines and columns count from 1. A setting on
    the command line has no position in a file. If the fault is in such a setting, `file` holds the setting as
    typed, and line and column are zero.
    """

    severity: Literal['error', 'warning']
    file: str
    line: int
    column: int
    message: str
    help: str


class FrameEntry(Record):
    """Origin and axes of a frame, expressed in the base frame."""

    name: str
    origin_mm: _Numbers
    x_axis: _Numbers
    y_axis: _Numbers
    z_axis: _Numbers

    _nested = {
        'origin_mm': ('numbers', ''),
        'x_axis': ('numbers', ''),
        'y_axis': ('numbers', ''),
        'z_axis': ('numbers', ''),
    }


class GoalsEntry(Record):
    """Value of every goal of a layout."""

    error: float
    """Objective, in the unit of the document."""
    clearance_mm: float
    joint_limits_percent: float
    """Least distance of a joint from its nearer limit, in percent of half the range of the joint."""
    singularity: float
    """Least singular value of the Jacobian, with lengths divided by the arm's reach."""
    travel_deg: float
    footprint_m2: float
    time_s: Optional[float]
    """Least time of the motions and the operations; absent if the maximum speed of a joint is not given."""
    cost: Optional[float]
    """Cost of the cheapest tolerances that meet every limit; absent if the search does not price tolerances."""


class GuardEntry(Record):
    """Check of the approximate error models against the nonlinear model over the usable nodes."""

    threshold_percent: float
    linear: ModelGuardEntry
    second_order: ModelGuardEntry
    trusted: bool
    """Whether the discrepancy of the chosen error model is within the threshold at every usable node."""

    _nested = {
        'linear': ('record', 'ModelGuardEntry'),
        'second_order': ('record', 'ModelGuardEntry'),
    }


class HarmonicsEntry(Record):
    """Periodic error of one joint: the sum of `cos_deg[k] cos((k + 1) q)` and `sin_deg[k] sin((k + 1) q)` over
    all k.
    """

    joint: str
    prior_deg: float
    """Prior standard deviation of the coefficients of the highest order. The fit estimates this value together
    with the coefficients. All orders above 4 have equal prior standard deviations. The orders 1 to 4 have
    twice the prior standard deviation of the higher orders.
    """
    rms_deg: float
    """Root mean square of the identified error over one revolution of the joint."""
    cos_deg: _Numbers
    sin_deg: _Numbers

    _nested = {
        'cos_deg': ('numbers', ''),
        'sin_deg': ('numbers', ''),
    }


class HashedFile(Record):
    """File and its SHA-256 in hexadecimal."""

    path: str
    """Path of the file. The path of an input is relative to the folder of the cell file. The path of an output
    is relative to the result folder.
    """
    sha256: str


class HostWork(Record):
    """Combinations that the workers of one host have finished."""

    host: str
    combinations: List[int]
    seconds: float
    """Sum of the times of all combinations of the host."""


class IdentifiedParameter(Record):
    """Identified parameter of the robot."""

    name: str
    """Name such as dq2 or dl3, or "q2 carries link 3" for an elastic term."""
    value: float
    unit: str
    """Unit of the values: mm, deg, or deg/m for an elastic term."""
    prior: Optional[float]
    """Standard deviation before the measurement. Null if a file states the parameter."""
    sigma: Optional[float]
    """Standard deviation after the measurement. Null if a file states the parameter."""
    identified: bool
    """Whether `sigma` is less than half of `prior`. True if a file states the parameter."""


class IslandEntry(Record):
    """Island: one of several searches that differ only in the seed."""

    seed: int
    is_best: bool
    """Whether this island found the best layout: the layout with the least objective. If several islands are
    equally good, the first of them counts as the best.
    """
    least_value: Optional[float]
    """Least objective found, in `unit`; null if no layout is feasible and within every limit."""
    evaluations: int
    """Number of layouts evaluated."""
    feasible: int
    """Number of evaluated layouts that are feasible and within every limit."""
    ended: Literal['done', 'gap', 'stagnation', 'interrupted', 'time-limit', 'diverged', 'nothing-to-search']
    """Reason why the search ended."""


class JointEntry(Record):
    """One joint of the robot."""

    name: str
    unit: Literal['share', 'cost', 'mm', 'deg']


class JointSheet(Record):
    """Joint of a robot with its Denavit-Hartenberg row."""

    name: str
    kind: Literal['passive', 'revolute', 'prismatic']
    theta_deg: float
    r_mm: float
    l_mm: float
    alpha_deg: float
    limits: _Numbers
    """Least and greatest coordinate, in `unit`."""
    unit: Literal['share', 'cost', 'mm', 'deg']
    max_velocity: Optional[float]
    """Maximum speed, in `unit` per s; null if the robot file states none."""
    max_acceleration: Optional[float]
    """Maximum acceleration, in `unit` per s^2; null if the robot file states none."""

    _nested = {
        'limits': ('numbers', ''),
    }


class JudgementEntry(Record):
    """Judgement of the tolerances by the error model of the cell."""

    missed_percent: float
    """Largest excess of a figure over its limit after the first round, percent; negative if all figures are
    below their limits. A round uses the linear error model to find tolerances. The error model of the cell
    then judges these tolerances.
    """
    rounds: int
    """Index of the round that gave the solution; the first round has the index 0. Each round multiplies every
    figure of the linear error model by a factor. At the tolerances of the previous round, the product equals
    the figure of the error model of the cell.
    """
    sampled_rounds: int
    """Number of further allocations that were necessary because Monte Carlo samples exceeded a limit."""
    excess_percent: float
    """Largest excess of a figure over its limit at the final tolerances, percent; negative if all figures are
    below their limits.
    """
    programs: int
    """Number of convex optimization problems (cone programs) in the round that gave the solution."""


class LargestEntry(Record):
    """Largest misplacement at which the operation stays feasible and within its limit."""

    most: float
    ended: Any
    """Reason why a misplacement larger than `most` is not allowed; null if every checked misplacement is
    allowed.
    """


class LostEntry(Record):
    """Misplacement at which the operation cannot be done, with the reason."""

    moves: Dict[str, MoveEntry]
    status: Literal['out-of-reach', 'joint-limit', 'attitude', 'not-converged', 'collision', 'singular', 'approach', 'retract', 'unjudged', 'ok']
    reason: str

    _nested = {
        'moves': ('named', 'MoveEntry'),
    }


class ManifestDocument(Record):
    """Manifest of a result folder, `manifest.json`. A folder with a manifest is complete."""

    schema: Literal['sweetspot/manifest/1']
    program: str
    version: str
    """Version of the program."""
    command: Optional[List[str]]
    """Command line that makes the folder, in a form for human readers. Programs read `settings` instead."""
    plan: Optional[str]
    """Name of the plan file of a sweep; absent in other manifests. A manifest with a plan has no `command`."""
    cell: Optional[str]
    seed: Optional[int]
    settings: Optional[Table[Setting]]
    """Keys of the cell file whose values come from the command line. The inputs and these settings together
    reproduce the cell.
    """
    resolved: Optional[ResolvedSettings]
    """Settings that result when flags, cell file and defaults are merged."""
    inputs: Table[HashedFile]
    """Files that were read, the cell file first."""
    outputs: Table[HashedFile]
    """Files that were written."""
    sha256: Optional[str]
    """Hexadecimal SHA-256 of all bytes before the comma in front of this key. The program adds this key to the
    text when it writes the manifest.
    """

    _nested = {
        'settings': ('table', 'Setting'),
        'resolved': ('record', 'ResolvedSettings'),
        'inputs': ('table', 'HashedFile'),
        'outputs': ('table', 'HashedFile'),
    }


class MapDocument(Record):
    """Error map of one layout: every node of every operation. Positions are in the world frame, mm; angles are
    in degrees.
    """

    schema: Literal['sweetspot/map/1']
    cell: str
    robot: str
    joints: Table[JointEntry]
    """Names and units of the joints, in the order of `joints_deg`."""
    feasible: bool
    """Whether the layout can be used: nothing overlaps, every operation has a spot and no motion is blocked."""
    objective_mm: Optional[float]
    """Objective if it is a length; null otherwise."""
    objective: Optional[float]
    """Objective of the layout, in `unit`; null if the layout is not feasible."""
    unit: Literal['share', 'cost', 'mm', 'deg']
    notes: List[str]
    """Caveats on the interpretation of the errors."""
    overlaps: List[str]
    """Pairs of objects whose floor spaces overlap, or are nearer to each other than the clearance that the cell
    requires.
    """
    cell_yield: Optional[CellYieldEntry]
    """Overall yield: share of sampled arms that stay within the limits of all operations. The entry also states
    the yield of each operation alone. Present if the reading is statistical, every operation has a spot, and
    at least one operation has a limit.
    """
    assumed: Table[AssumedEntry]
    """Values that the cell file leaves out and that were assumed."""
    certified: Any
    """Whether the layout certainly works at every misplacement within its placement tolerances: true, or the
    reason why not. Null if no placement has a tolerance, or if `ideal` in the table `[search]` is true.
    """
    reasons: List[str]
    """Reasons why the layout is not feasible."""
    transfers: Optional[Table[TransferEntry]]
    """Motions between consecutive operations; empty if an overlap, a missing spot or a blocked motion prevents
    these motions. Left out if the cell does not check motions.
    """
    cycle_time: Optional[CycleTimeEntry]
    """Cycle time of the layout; left out if the layout is not feasible."""
    layout: Dict[str, PlacementEntry]
    """Placements by the name of the equipment. Obstacles are left out, because a layout does not place them."""
    operations: Table[OperationMapEntry]
    measured: Optional[Table[ComparedFile]]
    """Comparison of measured positions with the predicted errors, one entry for each file. Left out without
    `--measured`.
    """

    _nested = {
        'joints': ('table', 'JointEntry'),
        'cell_yield': ('record', 'CellYieldEntry'),
        'assumed': ('table', 'AssumedEntry'),
        'transfers': ('table', 'TransferEntry'),
        'cycle_time': ('record', 'CycleTimeEntry'),
        'layout': ('named', 'PlacementEntry'),
        'operations': ('table', 'OperationMapEntry'),
        'measured': ('table', 'ComparedFile'),
    }


class MapNode(Record):
    """One node of a map. Vectors are in the world frame, mm or degrees. A node without a posture has no errors."""

    i: int
    """Index of the node along x of the surface."""
    j: int
    """Index of the node along y of the surface."""
    position_mm: _Numbers
    """Target position of the TCP."""
    status: Literal['out-of-reach', 'joint-limit', 'attitude', 'not-converged', 'collision', 'singular', 'approach', 'retract', 'unjudged', 'ok']
    reason: str
    """Reason why the node cannot be used; empty if the node is usable."""
    joints_deg: Optional[_Numbers]
    """Joint coordinates: degrees, or mm for a prismatic joint."""
    error_mm: Optional[_Numbers]
    """Error of the TCP according to the model of the cell."""
    error_sense_mm: Optional[float]
    """Error that the operation's sense measures; null if this sense measures an angle."""
    error_sense_deg: Optional[float]
    """Error that the operation's sense measures; null if this sense measures a length."""
    value: Optional[float]
    """Figure that the search minimizes, evaluated at this node, in the `unit` of the document."""
    touched: Optional[bool]
    """Whether the robot touched the node to teach the surface frame. Such a node cannot be the spot."""
    rotation_deg: Optional[_Numbers]
    """Rotation error of the TCP as a rotation vector."""
    linear_error_mm: Optional[_Numbers]
    nonlinear_error_mm: Optional[_Numbers]
    discrepancy_percent: Optional[DiscrepancyEntry]
    linear_off_percent: Optional[float]
    """Length of the difference between linear and nonlinear error, in percent of the nonlinear error."""
    second_order_off_percent: Optional[float]
    """Length of the difference between second-order and nonlinear error, in percent of the nonlinear error."""
    worst_mm: Optional[Dict[str, float]]
    worst_linear_mm: Optional[Dict[str, float]]
    rms_mm: Optional[Dict[str, float]]
    mean_mm: Optional[Dict[str, float]]
    p95_mm: Optional[Dict[str, float]]
    p99_mm: Optional[Dict[str, float]]
    worst_deg: Optional[Dict[str, float]]
    rms_deg: Optional[Dict[str, float]]
    mean_deg: Optional[Dict[str, float]]
    p95_deg: Optional[Dict[str, float]]
    p99_deg: Optional[Dict[str, float]]
    yield_: Optional[float]
    """Yield: share of arms whose error does not exceed the limit of the operation. The parameter errors of these
    arms are random, with distributions that follow from the error set.
    """

    _nested = {
        'position_mm': ('numbers', ''),
        'joints_deg': ('numbers', ''),
        'error_mm': ('numbers', ''),
        'rotation_deg': ('numbers', ''),
        'linear_error_mm': ('numbers', ''),
        'nonlinear_error_mm': ('numbers', ''),
        'discrepancy_percent': ('record', 'DiscrepancyEntry'),
    }


class MeasuredSpotEntry(Record):
    """Spot (a commanded position), with the errors of the poses at this position."""

    position_mm: _Numbers
    """Mean position of the reflector for the nominal robot, in the base frame."""
    positions: int
    """Number of measured positions."""
    measured_mm: float
    """Mean size of the measured errors."""
    predicted_mm: float
    """Mean of the predicted sizes."""

    _nested = {
        'position_mm': ('numbers', ''),
    }


class MeasuringPlanDocument(Record):
    """Poses to be measured for a calibration that serves the operations of a cell."""

    schema: Literal['sweetspot/measuring-plan/1']
    cell: str
    robot: str
    poses: Table[PlannedPoseEntry]
    """Poses in the layout of the cell file, the most informative first."""
    expected: ExpectedEntry
    tried: TriedEntry
    unknowns: int
    """Number of unknowns of the calibration, including the unknowns of base and reflector."""
    reflector_mm: _Numbers
    """Position of the reflector in the frame of the mechanical interface."""
    tracker_mm: Optional[_Numbers]
    """Position of the instrument in the world frame; null if visibility was not checked."""
    seed: int

    _nested = {
        'poses': ('table', 'PlannedPoseEntry'),
        'expected': ('record', 'ExpectedEntry'),
        'tried': ('record', 'TriedEntry'),
        'reflector_mm': ('numbers', ''),
        'tracker_mm': ('numbers', ''),
    }


class MisfitEntry(Record):
    """Standard deviations of the errors that the parameters do not explain."""

    joints: _Numbers
    """Standard deviation of the error of every joint: degrees, or mm for a prismatic joint."""
    position_mm: float
    """Standard deviation per axis of the unexplained position error that no joint causes, mm."""

    _nested = {
        'joints': ('numbers', ''),
    }


class MisplacedOperation(Record):
    """One operation of a layout whose equipment may be misplaced."""

    name: str
    equipment: str
    sense: str
    limit: Optional[float]
    """Largest allowed error of the operation, in the unit of its sense."""
    refined: Optional[RefinedEntry]
    robustness: Optional[RobustnessEntry]

    _nested = {
        'refined': ('record', 'RefinedEntry'),
        'robustness': ('record', 'RobustnessEntry'),
    }


class ModelGuardEntry(Record):
    """Discrepancy between one error model and the nonlinear model."""

    most_percent: float
    nodes_above: int
    """Number of usable nodes at which the discrepancy of the model exceeds the threshold."""


class MonteCarloEntry(Record):
    """Monte Carlo check of the first-order figures at a spot. The samples use the nonlinear model. RMS, mean and
    percentiles are in the unit of the sense.
    """

    samples: int
    unit: Literal['share', 'cost', 'mm', 'deg']
    rms: EstimateEntry
    mean: EstimateEntry
    p95: EstimateEntry
    p99: EstimateEntry
    yield_: Optional[EstimateEntry]
    """Share of samples within the limit; null if the operation has no limit."""
    share_above_first_order_p95: EstimateEntry
    first_order_holds: Optional[bool]
    """Whether the samples confirm the first-order figures. If the samples contradict the first-order figures,
    the figures of the samples replace them. The value and the margin of the operation then also come from the
    samples. However, the value remains a first-order figure if the search is robust, or if the value combines
    several nodes.
    """

    _nested = {
        'rms': ('record', 'EstimateEntry'),
        'mean': ('record', 'EstimateEntry'),
        'p95': ('record', 'EstimateEntry'),
        'p99': ('record', 'EstimateEntry'),
        'yield': ('record', 'EstimateEntry'),
        'share_above_first_order_p95': ('record', 'EstimateEntry'),
    }


class MotionEntry(Record):
    """Small motion per unit of a parameter."""

    kind: Literal['turn', 'slide']
    axis: Literal['x', 'y', 'z']
    """Axis of `frame` along or about which the motion happens: x, y or z."""
    frame: str
    factor: float
    """Amount of the motion per unit of the parameter. For an elastic parameter, the amount is a lever in m or a
    torque in N m.
    """
    axis_base: _Numbers
    lever_base_mm: _Numbers
    """Vector from the origin of `frame` to the TCP, in the base frame."""

    _nested = {
        'axis_base': ('numbers', ''),
        'lever_base_mm': ('numbers', ''),
    }


class MoveEntry(Record):
    """Misplacement of one piece of equipment or of the robot base, mm and degrees."""

    x_mm: Optional[float]
    y_mm: Optional[float]
    z_mm: Optional[float]
    yaw_deg: Optional[float]


class OperationBudget(Record):
    """Error budget of one operation at one node. Positions are in the world frame, mm; angles are in degrees."""

    name: str
    equipment: str
    sense: str
    limit: Optional[float]
    """Largest allowed error of the operation, in the unit of its sense."""
    node: Optional[List[int]]
    position_mm: _Numbers
    joints_deg: _Numbers
    """Joint coordinates: degrees, or mm for a prismatic joint."""
    worst_linear_exact: Optional[bool]
    """Whether the linear worst case is exact; otherwise it is an upper bound. Null in the signed reading if the
    errors of the sample compensate each other. The program assumes such compensation if the error of a
    Denavit-Hartenberg length (r or l) exceeds the reach of the arm.
    """
    total: TotalEntry
    margin: Optional[float]
    """Limit minus the error figure that the reading gives; negative if the error exceeds the limit. If a
    certificate is required, a known upper bound of this figure over all misplacements replaces the figure.
    Null if the operation has no limit, or if the quantity is the yield.
    """
    monte_carlo: Optional[MonteCarloEntry]
    """Monte Carlo check of the posture; null unless the reading is statistical."""
    parameters: Table[ShareEntry]
    """Shares of the parameters, the largest first."""
    tighten: Table[TightenEntry]
    """Gains from halving the tolerances of the parameters with the largest shares. The list is empty if
    `worst_linear_exact` is null.
    """
    linear_worst: Optional[float]
    """Worst case of the error by the linear model, in the unit of the sense; null if `worst_linear_exact` is
    null.
    """
    linear_rms: Optional[float]
    """Root mean square deviation of the error from its mean, by the linear model, in the unit of the sense. Null
    if `worst_linear_exact` is null.
    """

    _nested = {
        'position_mm': ('numbers', ''),
        'joints_deg': ('numbers', ''),
        'total': ('record', 'TotalEntry'),
        'monte_carlo': ('record', 'MonteCarloEntry'),
        'parameters': ('table', 'ShareEntry'),
        'tighten': ('table', 'TightenEntry'),
    }


class OperationMapEntry(Record):
    """Error map of one operation."""

    name: str
    equipment: str
    sense: str
    """Name of the sense that the operation states."""
    senses: Table[SenseEntry]
    """Senses in which the errors of every node are reported."""
    model: Literal['nonlinear', 'linear', 'second-order']
    errors: str
    """Name of the error set."""
    reading: Literal['signed', 'worst-case', 'statistical']
    quantity: Literal['error', 'worst case', 'share of failures', 'rms', 'mean', 'p95', 'p99', 'tolerance cost']
    """Name of the figure that the search minimizes."""
    registration: Literal['none', 'best-fit', 'taught']
    limit: Optional[float]
    """Largest allowed error of the operation, in the unit of its sense."""
    margin: Optional[float]
    """Limit minus the value of the operation; negative if the value exceeds the limit. If `worst` is known, the
    margin is the limit minus `worst`, unless the objective is a tolerance cost. Null if the operation has no
    limit or no value, or if the quantity is the yield.
    """
    over: Literal['best', 'max', 'mean', 'p95']
    value: Optional[float]
    """Value of the operation: the values of its nodes, combined by the rule that the field `over` states. The
    rule `best` gives the value of the best node.
    """
    worst: Optional[float]
    """Upper bound of the value at all misplacements within the placement tolerances. Null if the layout is not
    certified, or if no bound is known.
    """
    counts: StatusCounts
    guard: GuardEntry
    extrapolated: Optional[ExtrapolatedEntry]
    """Usable nodes at which a joint is outside the range of the measured postures; left out if there are none."""
    monte_carlo: Optional[MonteCarloEntry]
    """Monte Carlo check of the spot; null unless the reading is statistical."""
    best: Optional[MapNode]
    """Spot: the usable node with the least value; null if no node is usable. For an operation that happens at
    every node, the spot is the node with the greatest value. For such an operation, the spot is null if any
    node is unusable.
    """
    refined: Optional[RefinedEntry]
    """Best spot between the nodes of the grid; null if the program computed no such spot."""

    _nested = {
        'senses': ('table', 'SenseEntry'),
        'counts': ('record', 'StatusCounts'),
        'guard': ('record', 'GuardEntry'),
        'extrapolated': ('record', 'ExtrapolatedEntry'),
        'monte_carlo': ('record', 'MonteCarloEntry'),
        'best': ('record', 'MapNode'),
        'refined': ('record', 'RefinedEntry'),
    }


class OperationOrderEntry(Record):
    """Statement of how a search treats the postures of an operation."""

    name: str
    judges: str
    """Word that states what the search skips. With "ranked-nodes", it skips nodes. With "bounded-postures", it
    skips postures. With "spin-families", it skips groups of postures that differ in the last joint alone.
    With "every-posture", it skips nothing. A node, posture or group is skipped if its lower bound exceeds the
    best value found.
    """
    why: Optional[str]
    """Reason why the search judges every posture; null if the search skips some postures."""
    why_no_field: Optional[str]
    """Reason why no value field can be computed for the operation; null if one can be computed. A value field is
    a table of lower bounds of the operation's value at a node. The bounds hold in every layout, and a search
    uses them to exclude nodes.
    """


class OperationReadings(Record):
    """Results of one operation under every reading and registration."""

    name: str
    equipment: str
    sense: str
    limit: Optional[float]
    """Largest allowed error of the operation, in the unit of its sense."""
    readings: Table[ReadingEntry]

    _nested = {
        'readings': ('table', 'ReadingEntry'),
    }


class OutlierRow(Record):
    """Outlier: measured position that is more than six standard deviations from the prediction."""

    row: int
    """Line of the file, counted from 1."""
    distance_mm: float
    """Distance between the measured and the predicted position, mm."""


class OwnPairEntry(Record):
    """Pair of the robot's solids."""

    a: str
    b: str
    allowed: Optional[str]
    """Reason why contact of the two solids is allowed; null if contact counts as a collision."""


class ParameterEntry(Record):
    """Effect of one parameter. Vectors with `base` in their names are in the base frame. The terms
    `linear_term_mm` and `linear_term_deg` of the linear model are in the world frame.
    """

    parameter: str
    unit: Literal['deg/m', 'deg/Nm', '1', 'mm', 'deg']
    value: float
    """Value of the parameter in the explained sample: the signed sample or the worst corner."""
    signed: float
    plus_minus: float
    standard_deviation: float
    motions: Table[MotionEntry]
    effect_base_mm_per_unit: _Numbers
    taken_off_base_mm_per_unit: _Numbers
    """Displacement that is subtracted from `effect_base_mm_per_unit`, in the base frame. The registration
    removes a part of the effect. If the operation places a picked part, the effect at the pick is subtracted,
    too.
    """
    linear_term_mm: _Numbers
    linear_term_deg: _Numbers

    _nested = {
        'motions': ('table', 'MotionEntry'),
        'effect_base_mm_per_unit': ('numbers', ''),
        'taken_off_base_mm_per_unit': ('numbers', ''),
        'linear_term_mm': ('numbers', ''),
        'linear_term_deg': ('numbers', ''),
    }


class PlacementEntry(Record):
    """Pose of a piece of equipment or of the robot base in the world frame, mm and degrees."""

    x_mm: float
    y_mm: float
    z_mm: float
    yaw_deg: float


class PlanEntry(Record):
    """Horizontal section of a working envelope."""

    height_mm: float
    area_m2: float
    outlines: Table[PlanOutline]

    _nested = {
        'outlines': ('table', 'PlanOutline'),
    }


class PlanOutline(Record):
    """Closed line in a horizontal section. Outer lines run counterclockwise, holes clockwise."""

    hole: bool
    x_mm: _Numbers
    y_mm: _Numbers

    _nested = {
        'x_mm': ('numbers', ''),
        'y_mm': ('numbers', ''),
    }


class PlannedPoseEntry(Record):
    """Pose to be measured."""

    pose: int
    """Number of the pose, counted from 1."""
    joints: _Numbers
    """Joint coordinates: degrees, or mm for a prismatic joint."""
    reflector_mm: _Numbers
    """Nominal position of the reflector in the world frame."""

    _nested = {
        'joints': ('numbers', ''),
        'reflector_mm': ('numbers', ''),
    }


class PoseEntry(Record):
    """Pose: position, and roll, pitch and yaw about the fixed axes x, y and z."""

    position_mm: _Numbers
    rpy_deg: _Numbers

    _nested = {
        'position_mm': ('numbers', ''),
        'rpy_deg': ('numbers', ''),
    }


class PostureGuardEntry(Record):
    """Discrepancies of the linear and the second-order model at a posture. A discrepancy is the length of the
    difference between two position errors. One error comes from the linear or the second-order model, and the
    other error comes from the nonlinear model. The discrepancy is in percent of the length of the nonlinear
    position error.
    """

    threshold_percent: float
    linear_off_percent: float
    second_order_off_percent: float
    off_percent: float
    """Discrepancy between the chosen error model and the nonlinear model, percent."""
    trusted: bool


class ProgressLine(Record):
    """Progress line that `search --progress json` prints on stderr once per second."""

    schema: Literal['sweetspot/progress/1']
    evaluations: int
    """Number of layouts evaluated so far."""
    budget: int
    best: Optional[float]
    """Objective of the best feasible layout so far, in `unit`; null if no layout is feasible yet."""
    bound: Optional[float]
    """Proven lower bound of the objective, in `unit`; null if no bound is known."""
    unit: Literal['share', 'cost', 'mm', 'deg']
    gap: Optional[float]
    """Relative difference between `best` and `bound`: `best / bound - 1`. Null unless both are known and the
    bound is positive.
    """
    feasible_share: float
    """Share of the evaluated layouts that are feasible and within every limit."""
    evaluations_per_second: float
    """Evaluation rate of this process."""
    seconds: float
    """Time since the start of this process."""
    seconds_left: Optional[float]
    """Estimated time until the budget is used up; null if the rate is not known yet."""


class ProofEntry(Record):
    """Lower bounds that hold for every layout of a cell."""

    covers: Literal['everything', 'part', 'nothing', 'infeasible']
    """Operations that the bound covers: all, some or none. The value `infeasible` means that no layout is
    feasible.
    """
    operations: Table[ProvenOperation]

    _nested = {
        'operations': ('table', 'ProvenOperation'),
    }


class ProvenOperation(Record):
    """Lower bound of one operation."""

    name: str
    bound: Optional[float]
    """Lower bound of the value of the operation at any spot in any layout, in `unit`."""
    unit: Literal['share', 'cost', 'mm', 'deg']
    """Unit of the operation's sense."""
    why_not: Optional[str]
    """Reason why there is no bound."""
    boxes: int
    """Number of boxes of joint coordinates that the branch-and-bound method examined."""


class ReadingEntry(Record):
    """Result of one operation under one reading and one registration."""

    reading: Literal['signed', 'worst-case', 'statistical']
    quantity: Literal['error', 'worst case', 'share of failures', 'rms', 'mean', 'p95', 'p99', 'tolerance cost']
    """Name of the error figure that `reading` gives, such as "worst case"."""
    registration: Literal['none', 'best-fit', 'taught']
    unit: Literal['share', 'cost', 'mm', 'deg']
    node: Optional[List[int]]
    """Node with the least value; null if no node can be used."""
    position_mm: Optional[_Numbers]
    value: Optional[float]
    at_signed_choice: Optional[float]
    """Value under `reading` and `registration`, at the posture that the signed reading chooses with the same
    registration.
    """
    at_unregistered_choice: Optional[float]
    """Value under `reading` and `registration`, at the posture that `reading` chooses without registration."""
    ratio: Optional[float]
    """Regret of the signed reading: `at_signed_choice` divided by `value`."""
    moved_mm: Optional[float]
    """Distance between the best node under `reading` and the best node under the signed reading."""
    reason: Optional[str]
    """Reason why no node can be used."""

    _nested = {
        'position_mm': ('numbers', ''),
    }


class ReadingsDocument(Record):
    """Results for the layout of the cell file under every reading and registration. Positions are in the world
    frame, mm.
    """

    schema: Literal['sweetspot/readings/1']
    cell: str
    robot: str
    errors: str
    """Name of the error set."""
    model: Literal['nonlinear', 'linear', 'second-order']
    operations: Table[OperationReadings]
    largest_regret: Optional[RegretEntry]
    """Largest regret over all operations, readings and registrations. The regret of an entry in `readings` is
    its `at_signed_choice` divided by its `value`. Null if no regret is known, for example if the signed
    reading has no spot.
    """
    findings: List[str]
    """Findings in sentences."""

    _nested = {
        'operations': ('table', 'OperationReadings'),
        'largest_regret': ('record', 'RegretEntry'),
    }


class RefinedEntry(Record):
    """Best spot between the nodes of the grid, mm and degrees."""

    position_mm: _Numbers
    """Position of the TCP in the world frame."""
    on_surface_mm: _Numbers
    """Coordinates x and y of the spot in the frame of the equipment."""
    joints_deg: _Numbers
    """Joint coordinates: degrees, or mm for a prismatic joint."""
    value: float
    """Value of the operation at the refined spot, in the unit of the objective."""
    worst_value: Optional[float]
    """Certified upper bound of the value over all misplacements within the placement tolerances, in the unit of
    the objective. Absent if the layout need not withstand misplacements, or if no bound is known.
    """
    node_value: float
    """Value of the operation at the best node, in the unit of the objective."""
    node_on_surface_mm: _Numbers
    gain_percent: float

    _nested = {
        'position_mm': ('numbers', ''),
        'on_surface_mm': ('numbers', ''),
        'joints_deg': ('numbers', ''),
        'node_on_surface_mm': ('numbers', ''),
    }


class RegionEntry(Record):
    """Region in the world frame in which a piece of equipment or the robot base may stand. All other pieces keep
    their placements. An operation that happens at one node keeps its spot and branch. An operation that
    happens at every node uses the best posture of each node. Everywhere in the region, the layout works at
    every misplacement within the placement tolerances. The objective grows by at most the percentage
    `indifference_percent` of the cell file.
    """

    equipment: str
    """Name of the equipment, or `robot base`."""
    outline_mm: List[List[float]]
    """Closed rings of points (x, y) in plan, for the z and yaw of the layout. A point is inside if it lies in an
    odd number of rings. If the search moves the piece along one axis only, the only ring is a line of two
    points. The list is empty if the search moves the piece along neither axis.
    """
    rim_mm: float
    """Width of a band along the outline. In this band, the result does not distinguish inside from outside."""
    z_mm: _Numbers
    """Least and greatest z, at the x, y and yaw of the layout."""
    yaw_deg: _Numbers
    """Least and greatest yaw, at the x, y and z of the layout."""
    room_mm: Optional[float]
    """Largest distance by which the piece may be displaced in every direction in plan. Null if the search does
    not displace the piece in plan.
    """
    room_deg: Optional[float]
    """Largest angle by which the piece may be rotated in either direction. Null if the search does not rotate
    the piece.
    """
    ends_with: str
    """Reason why `room_mm` is not larger. If `room_mm` is null, the reason applies to `room_deg`."""

    _nested = {
        'z_mm': ('numbers', ''),
        'yaw_deg': ('numbers', ''),
    }


class RegretEntry(Record):
    """Largest regret (`ratio`), and the operation, reading and registration to which it belongs. A regret
    compares the values at two spots: the choice of the signed reading, and the best spot under `reading`.
    """

    operation: str
    reading: Literal['signed', 'worst-case', 'statistical']
    quantity: Literal['error', 'worst case', 'share of failures', 'rms', 'mean', 'p95', 'p99', 'tolerance cost']
    registration: Literal['none', 'best-fit', 'taught']
    ratio: float
    """Regret: value under `reading` at the spot of the signed reading, divided by the least value under
    `reading`.
    """


class RemediesDocument(Record):
    """Answer to the question whether to calibrate a measured robot, to move the equipment, or to do both."""

    schema: Literal['sweetspot/remedies/1']
    cell: str
    robot: str
    errors: str
    """Name of the error set."""
    quantity: Literal['error', 'worst case', 'share of failures', 'rms', 'mean', 'p95', 'p99', 'tolerance cost']
    """Name of the figure by which the remedies are compared."""
    unit: Literal['share', 'cost', 'mm', 'deg']
    """Unit of the values."""
    seed: int
    """Seed of the two searches, one without calibration and one after calibration."""
    evaluations: int
    """Total number of layouts that the two searches evaluated."""
    remedies: Table[RemedyEntry]
    """One entry for each remedy: as-drawn, calibrated, moved, both."""
    advised: List[Literal['as-drawn', 'calibrated', 'moved', 'both']]
    """Advised remedies, each of which is sufficient without the others. Empty if no remedy gives a feasible
    layout within every limit.
    """
    advice: str
    """Advice in words."""

    _nested = {
        'remedies': ('table', 'RemedyEntry'),
    }


class RemedyEntry(Record):
    """One remedy with its layout. Positions are in the world frame, mm; angles are in degrees."""

    remedy: Literal['as-drawn', 'calibrated', 'moved', 'both']
    feasible: bool
    objective: Optional[float]
    """Objective in the unit of the document; null if the layout is not feasible."""
    gain_percent: Optional[float]
    """Reduction of the objective compared with the remedy `as-drawn` (layout as drawn, no calibration), percent."""
    within_limits: Optional[bool]
    """Whether every operation stays within its limit; null if no operation has a limit."""
    reasons: List[str]
    """Reasons why the layout is not feasible."""
    layout: Dict[str, PlacementEntry]
    base: PlacementEntry
    attitudes: Dict[str, AttitudeEntry]
    operations: Table[SpotEntry]

    _nested = {
        'layout': ('named', 'PlacementEntry'),
        'base': ('record', 'PlacementEntry'),
        'attitudes': ('named', 'AttitudeEntry'),
        'operations': ('table', 'SpotEntry'),
    }


class RepeatedPostureEntry(Record):
    """One posture that was visited several times."""

    row: int
    """Line number of the first visit in the file, counted from 1."""
    visits: int
    position_mm: _Numbers
    """Position of the reflector for the nominal robot, in the base frame."""
    ap_mm: float
    """Distance of the barycentre of the measured positions from the command position."""
    rp_mm: float
    """Mean distance of the measured positions from the barycentre, plus three standard deviations."""

    _nested = {
        'position_mm': ('numbers', ''),
    }


class RepeatsEntry(Record):
    """Pose accuracy AP and pose repeatability RP of positions, as ISO 9283 defines them."""

    largest_ap_mm: float
    """Largest pose accuracy of a posture."""
    largest_rp_mm: float
    """Largest pose repeatability of a posture."""
    least_visits: int
    """Number of visits to the repeated posture that was visited least often."""
    enough_visits: bool
    """Whether every repeated posture was visited as often as the standard demands."""
    postures: Table[RepeatedPostureEntry]

    _nested = {
        'postures': ('table', 'RepeatedPostureEntry'),
    }


class RequirementEntry(Record):
    """Limit of an operation and the margin to it, in the unit of the objective."""

    limit: float
    """Largest allowed value of the operation. If the objective is a tolerance cost, this limit is the cost of
    the tightest tolerances. A value above this cost means that the error exceeds its limit even at the
    tightest tolerances.
    """
    margin: float
    """Limit minus the value of the operation; negative if the value exceeds the limit. If `worst` of `SpotEntry`
    is known, the margin is the limit minus `worst`, unless the objective is a tolerance cost.
    """
    met: bool
    """Whether the limit is met. An error limit counts as missed if the layout must withstand misplacements but
    `worst` of `SpotEntry` is null.
    """


class ResolvedMargins(Record):
    """Margins of all postures."""

    joint_deg: float
    """Least distance from the limits of revolute joints, degrees."""
    joint_mm: float
    """Least distance from the limits of prismatic joints, mm."""
    singularity: float
    """Least allowed value of the smallest singular value of the Jacobian, with lengths divided by the reach."""


class ResolvedOperation(Record):
    """Sense and limit of an operation."""

    name: str
    sense: str
    unit: Literal['share', 'cost', 'mm', 'deg']
    limit: Optional[float]
    """Largest allowed error of the operation, in `unit`."""


class ResolvedSettings(Record):
    """Settings that result when flags, cell file and defaults are merged."""

    errors: str
    """Name of the error set."""
    model: Literal['nonlinear', 'linear', 'second-order']
    reading: Literal['signed', 'worst-case', 'statistical']
    quantity: Literal['yield', 'rms', 'mean', 'p95', 'p99']
    """Statistic that is minimized in the statistical reading."""
    registration: Literal['none', 'best-fit', 'taught']
    guard_percent: float
    """Largest deviation from the nonlinear model at which reports trust a simpler model, % of the error."""
    collision: bool
    """Whether collisions of the robot and overlaps of equipment are checked."""
    clearance_mm: float
    margins: ResolvedMargins
    base_tolerance: ResolvedTolerance
    placement_tolerances: Dict[str, ResolvedTolerance]
    """Placement tolerances by the name of the equipment."""
    operations: Table[ResolvedOperation]
    objective: Literal['lexicographic', 'tolerance-cost', 'sum', 'max']
    indifference: float
    """Relative difference up to which two objectives count as equally good. The lexicographic objective divides
    values into steps of this relative width. Values in the same step count as equally good.
    """
    solver: Literal['cma-es', 'particle-swarm', 'simulated-annealing']
    seed: int
    budget: int
    """Largest number of layouts to evaluate."""
    ideal: bool
    """Whether every piece is assumed to stand exactly at its placement, so that placement tolerances are
    ignored.
    """
    robust: bool
    """Whether the worst case over the placement tolerances is minimized."""
    gap: Optional[float]
    """Relative gap to the proven lower bound. The search ends when the best layout reaches this gap."""
    stagnation: Optional[int]
    """Number of evaluations without a better layout after which a search ends."""
    pareto: List[Literal['error', 'clearance', 'joint-limits', 'singularity', 'travel', 'footprint', 'time', 'cost']]
    """Goals of a Pareto search; empty for a search that minimizes only the objective."""
    keep: int
    """Number of layouts to keep; 0 if the cell states none."""

    _nested = {
        'margins': ('record', 'ResolvedMargins'),
        'base_tolerance': ('record', 'ResolvedTolerance'),
        'placement_tolerances': ('named', 'ResolvedTolerance'),
        'operations': ('table', 'ResolvedOperation'),
    }


class ResolvedTolerance(Record):
    """Half widths of a placement tolerance, mm and degrees."""

    x_mm: float
    y_mm: float
    z_mm: float
    yaw_deg: float


class RobotEntry(Record):
    """Robot of the library."""

    robot: str
    """Name in the library. Cell files use this name to refer to the robot."""
    name: str
    axes: int
    family: str
    """Name of the method that solves the inverse kinematics."""
    reach_mm: float
    error_sets: int
    source: str
    """Source of the numbers of the robot."""


class RobotSheetDocument(Record):
    """Data sheet of a robot."""

    schema: Literal['sweetspot/robot-sheet/1']
    name: str
    source: str
    """Source of the numbers of the robot."""
    family: str
    """Name of the method that solves the inverse kinematics."""
    convention: str
    """Denavit-Hartenberg convention of the rows."""
    joints: Table[JointSheet]
    coupling: List[List[float]]
    """Rows of the matrix that converts actuator coordinates to Denavit-Hartenberg coordinates."""
    tool: ToolSheet
    reach_mm: float
    home: _Numbers
    """Home posture: degrees, or mm for a prismatic joint."""
    home_position_mm: _Numbers
    """Position of the TCP in the home posture, in the base frame."""
    solids: List[str]
    """Names of the solids of the links."""
    errors: Table[ErrorSetEntry]
    envelope: Optional[EnvelopeSize]
    """Size of the working envelope; null for a redundant arm and for an arm with numeric inverse kinematics. The
    command `sweetspot envelope` computes the envelope of such an arm.
    """

    _nested = {
        'joints': ('table', 'JointSheet'),
        'tool': ('record', 'ToolSheet'),
        'home': ('numbers', ''),
        'home_position_mm': ('numbers', ''),
        'errors': ('table', 'ErrorSetEntry'),
        'envelope': ('record', 'EnvelopeSize'),
    }


class RobotsDocument(Record):
    """Robots of the library."""

    schema: Literal['sweetspot/robots/1']
    robots: Table[RobotEntry]

    _nested = {
        'robots': ('table', 'RobotEntry'),
    }


class RobustDocument(Record):
    """Effect of misplaced equipment on the layout of the cell file."""

    schema: Literal['sweetspot/robust/1']
    cell: str
    robot: str
    errors: str
    """Name of the error set."""
    quantity: Literal['error', 'worst case', 'share of failures', 'rms', 'mean', 'p95', 'p99', 'tolerance cost']
    """Name of the figure that the search minimizes."""
    unit: Literal['share', 'cost', 'mm', 'deg']
    feasible: bool
    holds: bool
    """Whether every operation stays feasible and within its limit over the placement tolerances."""
    reasons: List[str]
    layout: Dict[str, PlacementEntry]
    base: PlacementEntry
    operations: Table[MisplacedOperation]

    _nested = {
        'layout': ('named', 'PlacementEntry'),
        'base': ('record', 'PlacementEntry'),
        'operations': ('table', 'MisplacedOperation'),
    }


class RobustnessEntry(Record):
    """Effect of misplacement on one operation."""

    value: float
    """Value of the operation without misplacement, in the unit of the objective."""
    tolerance: Dict[str, MoveEntry]
    """Placement tolerances (half widths) of the robot base and of the equipment on which the operation depends.
    Empty if none of these placements has a tolerance.
    """
    corners: int
    """Number of evaluated corners of the tolerance boxes. These boxes span the placement tolerances of the robot
    base and of all equipment, also of equipment that `tolerance` does not list.
    """
    worst: Optional[CornerEntry]
    """Evaluated corner of the tolerance boxes at which the operation has its greatest value. Null if `tolerance`
    is empty, or if the operation cannot be done at any corner.
    """
    lost: Table[LostEntry]
    """Evaluated corners of the tolerance boxes at which the operation cannot be done."""
    gradient: Table[SlopeEntry]
    """Change of the value of the operation per mm or degree of each coordinate. The four coordinates of the
    equipment under the operation come first. The other coordinates with a placement tolerance (see
    `tolerance`) follow.
    """
    largest_times_tolerance: Optional[LargestEntry]
    """Largest multiple of the tolerances at which the operation stays feasible and within its limit. Null if no
    placement has a tolerance.
    """
    largest_in_plan_mm: LargestEntry
    """Largest distance by which the equipment under the operation may be displaced in every horizontal
    direction. A displacement is allowed if the operation stays feasible and within its limit.
    """
    largest_yaw_deg: LargestEntry
    """Largest angle by which the equipment under the operation may be rotated about the vertical in both
    directions. A rotation is allowed if the operation stays feasible and within its limit.
    """
    holds: bool
    """Whether the operation stays feasible and within its limit over the tolerances."""

    _nested = {
        'tolerance': ('named', 'MoveEntry'),
        'worst': ('record', 'CornerEntry'),
        'lost': ('table', 'LostEntry'),
        'gradient': ('table', 'SlopeEntry'),
        'largest_times_tolerance': ('record', 'LargestEntry'),
        'largest_in_plan_mm': ('record', 'LargestEntry'),
        'largest_yaw_deg': ('record', 'LargestEntry'),
    }


class RunnerUpEntry(Record):
    """Runner-up: the next best layout or node."""

    kind: Literal['layout', 'node']
    value: float
    """Objective of the runner-up, in the `unit` of the verdict. If the runner-up is a node, one operation moves
    to this node, and all other operations keep their spots.
    """
    text: str
    note: str


class RunningCombination(Record):
    """Combination that a worker processes."""

    index: int
    host: str
    process: int
    seconds: float
    """Time from the start of the combination to the last heartbeat of the worker."""
    seconds_since_heartbeat: float
    """Time since the last heartbeat, by the clock of the file server."""


class SearchResult(Record):
    """Result of a search: the best layout found, the layout before the search and the proven bound. Positions
    are in the world frame, mm; angles are in degrees. The document is the same, byte for byte, for every
    number of threads.
    """

    schema: Literal['sweetspot/search/1']
    status: Literal['found', 'none']
    objective_mm: Optional[float]
    """Objective of the best layout; null if the objective is not a length or the layout is not feasible."""
    objective_value: Optional[float]
    """Objective of the best layout, in `unit`; null if no layout is feasible."""
    unit: Literal['share', 'cost', 'mm', 'deg']
    gain_percent: Optional[float]
    """Reduction of the objective from the layout before the search to the best layout, percent."""
    bound: Optional[float]
    """Proven lower bound of the objective of every layout, in `unit`."""
    gap_percent: Optional[float]
    """Gap: excess of the objective of the best layout over the bound, in percent of the bound."""
    proof: ProofEntry
    evaluations: int
    """Number of layouts evaluated."""
    feasible: int
    """Number of evaluated layouts that are feasible and within every limit."""
    ended: Literal['done', 'gap', 'stagnation', 'interrupted', 'time-limit', 'diverged', 'nothing-to-search']
    """Reason why the search ended."""
    cell: str
    robot: str
    errors: str
    """Name of the error set."""
    model: Literal['nonlinear', 'linear', 'second-order']
    reading: Literal['signed', 'worst-case', 'statistical']
    quantity: Literal['error', 'worst case', 'share of failures', 'rms', 'mean', 'p95', 'p99', 'tolerance cost']
    """Name of the figure that the search minimizes."""
    registration: Literal['none', 'best-fit', 'taught']
    notes: List[str]
    """Caveats on the interpretation of the errors."""
    objective: Literal['lexicographic', 'tolerance-cost', 'sum', 'max']
    solver: Literal['cma-es', 'particle-swarm', 'simulated-annealing']
    seed: int
    """Seed of the random numbers; for several islands, the seed of the first island."""
    budget: int
    """Largest number of layouts to evaluate; for several islands, the largest number for each island."""
    robust: bool
    """Whether the worst case over the placement tolerances was minimized."""
    pareto: Optional[List[Literal['error', 'clearance', 'joint-limits', 'singularity', 'travel', 'footprint', 'time', 'cost']]]
    """Goals of a Pareto search; null for a search that minimizes only the objective."""
    keep: Optional[int]
    """Number of layouts to keep; null if the cell states none."""
    ideal: bool
    """Whether every piece is assumed to stand exactly at its placement, so that placement tolerances are
    ignored.
    """
    assumed: Table[AssumedEntry]
    """Values that the cell file leaves out and that were assumed."""
    certified: Any
    """Whether the best layout certainly works at every misplacement within its placement tolerances: true, or
    the reason why not. Null if no placement has a tolerance, or if `ideal` in the table `[search]` is true.
    """
    least_value: Optional[float]
    """Least objective found, in `unit`. Layouts count as equally good if their objectives exceed the least
    objective by at most `indifference_percent` (cell file). Among these layouts, the search chooses one with
    nearly the largest room. The room of a layout is the least `room_mm` of its pieces. Null if no layout is
    feasible and within every limit.
    """
    regions: Table[RegionEntry]
    """One region for each piece that the search places. The piece may stand anywhere in its region."""
    whole_cell: Optional[TurnEntry]
    """Angles by which equipment may rotate as one body about the base axis. Equipment takes part in this
    rotation if its x, y and yaw have ranges. At these angles, the objective grows by at most the percentage
    `indifference_percent` of the cell file. Null if the layout is infeasible or misses a limit, or if
    equipment under an operation does not take part.
    """
    reasons: List[str]
    """Reasons why the best layout is not feasible."""
    goals: Optional[GoalsEntry]
    """Goals of the best layout; null if that layout is not feasible."""
    layout: Dict[str, PlacementEntry]
    base: PlacementEntry
    attitudes: Dict[str, AttitudeEntry]
    operations: Table[SpotEntry]
    cell_yield: Optional[CellYieldEntry]
    """Overall yield: share of sampled arms that stay within the limits of all operations. Present if the reading
    is statistical, every operation has a spot, and at least one operation has a limit.
    """
    cycle_time: Optional[CycleTimeEntry]
    """Cycle time of the best layout; left out if that layout is not feasible."""
    start: StartEntry
    front: Optional[Table[AlternativeEntry]]
    """Pareto front or shortlist of layouts; null if the cell requests neither."""
    trace: List[List[float]]
    """Improvements of the best layout during the search: the number of evaluations so far, and the objective in
    `unit`.
    """
    islands: Optional[Table[IslandEntry]]
    """Searches that were merged into this result. Their seeds are consecutive numbers. Present for `search
    --islands`.
    """
    seconds: Optional[float]
    """Duration of the search, s; left out in `search.json`."""

    _nested = {
        'proof': ('record', 'ProofEntry'),
        'assumed': ('table', 'AssumedEntry'),
        'regions': ('table', 'RegionEntry'),
        'whole_cell': ('record', 'TurnEntry'),
        'goals': ('record', 'GoalsEntry'),
        'layout': ('named', 'PlacementEntry'),
        'base': ('record', 'PlacementEntry'),
        'attitudes': ('named', 'AttitudeEntry'),
        'operations': ('table', 'SpotEntry'),
        'cell_yield': ('record', 'CellYieldEntry'),
        'cycle_time': ('record', 'CycleTimeEntry'),
        'start': ('record', 'StartEntry'),
        'front': ('table', 'AlternativeEntry'),
        'islands': ('table', 'IslandEntry'),
    }


class SectionEntry(Record):
    """Vertical section of a working envelope."""

    azimuth_deg: float
    area_m2: float
    outlines: Table[SectionOutline]

    _nested = {
        'outlines': ('table', 'SectionOutline'),
    }


class SectionOutline(Record):
    """Closed line in a vertical section. Outer lines run counterclockwise, holes clockwise."""

    hole: bool
    r_mm: _Numbers
    z_mm: _Numbers

    _nested = {
        'r_mm': ('numbers', ''),
        'z_mm': ('numbers', ''),
    }


class SenseEntry(Record):
    """Sense: the error component that matters to an operation, with its unit."""

    name: str
    unit: Literal['share', 'cost', 'mm', 'deg']


class SenseRowEntry(Record):
    """Row of a sense: a direction or an axis, with the error along or about it."""

    kind: Literal['position', 'rotation']
    direction_base: _Numbers
    """Direction in the base frame. The length of the vector is the weight."""
    value: float

    _nested = {
        'direction_base': ('numbers', ''),
    }


class Setting(Record):
    """Key of a cell with its value, stated on the command line."""

    path: str
    """Dotted path, as in TOML: `equipment.worktable.placement.z_mm`."""
    value: str
    """Value, as in TOML; a text may be written without quotes."""
    flag: Optional[str]
    """Flag that states the setting, as typed: `--limit 5`; None for `--set`."""


class ShareEntry(Record):
    """Share of one parameter in the error."""

    parameter: str
    unit: Literal['deg/m', 'deg/Nm', '1', 'mm', 'deg']
    signed: float
    plus_minus: float
    linear_term_mm: _Numbers
    """Linear position error of the TCP that the parameter causes, in the world frame. In the signed reading, the
    parameter has its signed value. In any other reading, the parameter deviates from its mean by the half
    width of its tolerance.
    """
    alone: float
    """Linear error that the operation's sense measures if this parameter is at its tolerance and all other
    parameters are 0.
    """
    share_of_worst: Optional[float]
    """Share of the parameter in the linear worst case, from 0 to 1; null if `worst_linear_exact` of the
    operation is null.
    """
    share_of_variance: Optional[float]
    """Share of the parameter in the linear variance, from 0 to 1; null if `worst_linear_exact` of the operation
    is null.
    """

    _nested = {
        'linear_term_mm': ('numbers', ''),
    }


class ShortfallEntry(Record):
    """Limit that a figure exceeds even at the tightest tolerances."""

    operation: str
    node: List[int]
    unit: Literal['share', 'cost', 'mm', 'deg']
    limit: float
    least: float
    """Least figure that the permitted tolerances give."""
    excess: float
    """`least` minus `limit`."""
    in_the_way: Table[BoundEntry]
    """Tightest permitted tolerances: one for each parameter whose error makes `least` larger. The list is sorted
    by `without`, the least value first.
    """

    _nested = {
        'in_the_way': ('table', 'BoundEntry'),
    }


class SizeEntry(Record):
    """Size of a working envelope in the base frame."""

    volume_m3: float
    volume_error_m3: float
    """Estimated error of the volume: the difference from a second volume. The second volume is computed with
    twice the distance between the sample points.
    """
    rotationally_symmetric: bool
    radius_mm: Optional[_Numbers]
    """Least and greatest distance from the vertical axis through the base; null if nothing is reached."""
    height_mm: Optional[_Numbers]
    """Least and greatest height above the origin of the base; null if nothing is reached."""
    extent_within_mm: Optional[float]
    """Bound of the error of `radius_mm` and `height_mm`. Parts of the envelope that are narrower than the
    distance between the sample points may be missed.
    """

    _nested = {
        'radius_mm': ('numbers', ''),
        'height_mm': ('numbers', ''),
    }


class SlopeEntry(Record):
    """Change of the value of an operation per mm or degree of one coordinate."""

    of: str
    """Name of the equipment, or "robot base"."""
    number: str
    """Text that names the coordinate: `x_mm`, `y_mm`, `z_mm` or `yaw_deg`."""
    value: Optional[float]
    """Change of the value of the operation, in the unit of the objective, per mm or degree of the coordinate.
    Null if a small change of the coordinate puts the operation out of reach.
    """
    per: Literal['share', 'cost', 'mm', 'deg']
    """Unit of the coordinate."""


class SpotEntry(Record):
    """One operation of a layout: its spot and the errors at the spot. Positions are in the world frame, mm;
    angles are in degrees.
    """

    name: str
    equipment: str
    sense: str
    place: str
    """Description of the nodes at which the operation may happen."""
    over: Literal['best', 'max', 'mean', 'p95']
    value: Optional[float]
    """Value of the operation, in the unit of the objective."""
    worst: Optional[float]
    """Upper bound of the value at all misplacements within the placement tolerances. Null if the layout is not
    certified, or if no bound is known.
    """
    requirement: Optional[RequirementEntry]
    """Limit and margin; null if the operation has no limit or no spot."""
    node: Optional[List[int]]
    """Indices of the spot's node along the x and y axes of the surface."""
    position_mm: Optional[_Numbers]
    joints_deg: Optional[_Numbers]
    """Joint coordinates: degrees, or mm for a prismatic joint."""
    refined: Optional[RefinedEntry]
    """Best spot between the nodes of the grid; null if the program computed no such spot."""
    robustness: Optional[RobustnessEntry]
    """Effect of misplacement on the operation; null if the effect was not computed."""
    error_mm: Optional[_Numbers]
    error_sense_mm: Optional[float]
    error_sense_deg: Optional[float]
    error_by_sense_mm: Dict[str, Optional[float]]
    worst_mm: Dict[str, Optional[float]]
    rms_mm: Dict[str, Optional[float]]
    p95_mm: Dict[str, Optional[float]]
    yield_: Optional[float]
    guard: GuardEntry
    monte_carlo: Optional[MonteCarloEntry]
    counts: StatusCounts

    _nested = {
        'requirement': ('record', 'RequirementEntry'),
        'position_mm': ('numbers', ''),
        'joints_deg': ('numbers', ''),
        'refined': ('record', 'RefinedEntry'),
        'robustness': ('record', 'RobustnessEntry'),
        'error_mm': ('numbers', ''),
        'guard': ('record', 'GuardEntry'),
        'monte_carlo': ('record', 'MonteCarloEntry'),
        'counts': ('record', 'StatusCounts'),
    }


class SpotRankingEntry(Record):
    """Spots of a file, ranked by their errors. A spot is a commanded position. The error of a spot is the mean
    error of its poses.
    """

    count: int
    """Number of spots."""
    rank_correlation: Optional[float]
    """Spearman correlation of predicted and measured errors over the spots. Null if all predicted or all
    measured errors are equal.
    """
    predicted_best: MeasuredSpotEntry
    """Spot with the least predicted error."""
    mean_mm: float
    """Mean of the measured errors of all spots."""
    least_mm: float
    """Least measured error over all spots."""
    greatest_mm: float
    """Greatest measured error over all spots."""

    _nested = {
        'predicted_best': ('record', 'MeasuredSpotEntry'),
    }


class SpreadEntry(Record):
    """Tolerance of one parameter."""

    name: str
    plus_minus: float
    """Half width of the tolerance, in `unit`."""
    unit: str
    """Unit of the half width, for example mm or deg."""
    distribution: str
    sigmas: Optional[float]
    """Half width as a number of standard deviations; null unless the distribution is normal."""


class StartEntry(Record):
    """Layout from which the search started."""

    objective_mm: Optional[float]
    objective_value: Optional[float]
    reasons: List[str]
    layout: Dict[str, PlacementEntry]
    base: PlacementEntry
    attitudes: Dict[str, AttitudeEntry]
    operations: Table[SpotEntry]
    cell_yield: Optional[CellYieldEntry]
    """Overall yield: share of sampled arms that stay within the limits of all operations. Present if the reading
    is statistical, every operation has a spot, and at least one operation has a limit.
    """
    cycle_time: Optional[CycleTimeEntry]
    """Cycle time; left out if the layout is not feasible."""

    _nested = {
        'layout': ('named', 'PlacementEntry'),
        'base': ('record', 'PlacementEntry'),
        'attitudes': ('named', 'AttitudeEntry'),
        'operations': ('table', 'SpotEntry'),
        'cell_yield': ('record', 'CellYieldEntry'),
        'cycle_time': ('record', 'CycleTimeEntry'),
    }


class StatusCounts(Record):
    """Numbers of nodes by status. Each of the last three fields is left out if no node has the status that the
    field counts.
    """

    ok: int
    out_of_reach: int
    joint_limit: int
    collision: int
    attitude: int
    not_converged: int
    unjudged: int
    singular: Optional[int]
    approach: Optional[int]
    retract: Optional[int]


class SweepGroup(Record):
    """Value of a `--set` option, and the best row with that value."""

    path: str
    value: Any
    combinations: int
    """Number of combinations with this value of the option."""
    feasible: int
    best: Optional[int]
    """Index of the feasible row with the least objective among the rows with this value. Null if none of these
    rows is feasible, or if their objectives have different units.
    """
    objective: Optional[float]


class SweepPlan(Record):
    """Plan of a sweep, `plan.json`. A combination takes one value of every `--set` option. Plans with equal
    fields give files with equal bytes.
    """

    schema: Literal['sweetspot/sweep-plan/1']
    version: str
    """Version of the program."""
    cell: str
    """Path of the cell file."""
    packages: List[List[Any]]
    """Name and folder of each ROS package that the option `--package` gives."""
    search: bool
    """Whether a search runs for every combination. If false, the layout of the cell file is mapped."""
    sets: Table[Choices]
    island_flags: Optional[Table[Setting]]
    """Flags of the command `search --islands`. This command is run as a sweep: each seed gives one combination,
    and each combination is one search. The flags apply to all searches, and `sets` contains the seeds. Left
    out in the plan of the command `sweep`.
    """
    seed: Optional[int]
    """Seed of every combination; null means the seed of the cell."""
    budget: Optional[int]
    solver: Optional[Literal['cma-es', 'particle-swarm', 'simulated-annealing']]
    combinations: int
    inputs: Table[HashedFile]
    """Hashes of the files that the combinations read; empty until the program has read these files."""
    sha256: Optional[str]
    """Hexadecimal SHA-256 of all bytes before the comma in front of this key. The program adds this key to the
    text when it writes the file.
    """

    _nested = {
        'sets': ('table', 'Choices'),
        'island_flags': ('table', 'Setting'),
        'inputs': ('table', 'HashedFile'),
    }


class SweepRow(Record):
    """Result of one combination, `NNNN.json`, where NNNN is the index with at least four digits. Positions are
    in the world frame, mm; angles are in degrees.
    """

    index: int
    set: Dict[str, Any]
    """Values of the `--set` options. The key of each value is the path that the option states. A value is parsed
    as JSON if possible; otherwise it is text.
    """
    feasible: bool
    objective: Optional[float]
    """Objective of the layout in `unit`; null if the layout is not feasible."""
    unit: Literal['share', 'cost', 'mm', 'deg']
    bound: Optional[float]
    """Proven lower bound of the objective of every layout; null if no bound is known or no search ran."""
    gap_percent: Optional[float]
    evaluations: int
    """Number of layouts evaluated."""
    feasible_evaluations: int
    """Number of evaluated layouts that are feasible and, if a search ran, within every limit."""
    operations: Table[SweepSpot]
    layout: Dict[str, PlacementEntry]
    reasons: List[str]
    """Reasons why the layout is not feasible."""
    files: Table[HashedFile]
    """Files of the combination with their hashes: the cell file with this layout as fixed placements, and the
    file with the settings. Empty if the layout is not feasible. For an island of a search, the only file is
    NNNN.island.json.
    """
    sha256: Optional[str]
    """Hexadecimal SHA-256 of all bytes before the comma in front of this key. The program adds this key to the
    text when it writes the file.
    """

    _nested = {
        'operations': ('table', 'SweepSpot'),
        'layout': ('named', 'PlacementEntry'),
        'files': ('table', 'HashedFile'),
    }


class SweepSpot(Record):
    """One operation in the result of a combination: its spot, error and limit."""

    name: str
    value: Optional[float]
    """Value of the operation, in the unit of the objective; null if the operation has no spot."""
    position_mm: Optional[_Numbers]
    error: Optional[float]
    """Error that the operation's sense measures, in `error_unit`."""
    limit: Optional[float]
    """Largest allowed error of the operation, in `error_unit`."""
    error_unit: Literal['share', 'cost', 'mm', 'deg']
    limit_met: Optional[bool]
    """Whether the limit is met; null if the operation has no limit or no spot. The limit counts as missed if
    `requirement` is `not-guaranteed`.
    """
    requirement: Literal['not-guaranteed', 'none', 'met', 'missed']
    """State of the limit: `met`, `missed`, `not-guaranteed`, or `none` (no limit or no spot). The state `not-
    guaranteed` means that the limit is met without misplacement, but is not proven to be met for all
    misplacements.
    """

    _nested = {
        'position_mm': ('numbers', ''),
    }


class SweepStatus(Record):
    """State of a sweep, which `sweep --status` prints."""

    schema: Literal['sweetspot/sweep-status/1']
    combinations: int
    done: int
    free: int
    """Number of combinations that no worker has begun."""
    running: Table[RunningCombination]
    failed: Table[FailedCombination]
    seconds_left: Optional[float]
    """Estimated time until the last combination is done, if the running workers continue. Null if no worker is
    running, or if no worker has finished a combination.
    """
    hosts: Table[HostWork]
    """Work that each host has done. Only workers of `sweep --claim` record this information."""
    complete: bool
    """Whether the tables and the manifest of the sweep are written."""

    _nested = {
        'running': ('table', 'RunningCombination'),
        'failed': ('table', 'FailedCombination'),
        'hosts': ('table', 'HostWork'),
    }


class SweepTable(Record):
    """Table of a sweep, `table.json`."""

    schema: Literal['sweetspot/sweep/1']
    mode: Literal['search', 'map']
    combinations: int
    feasible: int
    best: Optional[int]
    """Index of the feasible row with the least objective. Null if no row is feasible, or if feasible rows have
    objectives in different units.
    """
    best_of: Table[SweepGroup]
    """Best row for every value of every `--set` option."""
    rows: Table[SweepRow]

    _nested = {
        'best_of': ('table', 'SweepGroup'),
        'rows': ('table', 'SweepRow'),
    }


class TestCubeEntry(Record):
    """Test cube of ISO 9283. Positions are in the base frame."""

    edge_mm: float
    is_standard: bool
    """Whether ISO 9283 names a cube of this size."""
    centre_mm: _Numbers
    bend_deg: float
    """Elevation of the tool axis."""
    spin_deg: Optional[float]
    """Spin of the tool, equal at all five poses; null if the spin is free."""
    poses: Table[TestPoseEntry]
    """The poses P1 to P5."""

    _nested = {
        'centre_mm': ('numbers', ''),
        'poses': ('table', 'TestPoseEntry'),
    }


class TestPoseEntry(Record):
    """Pose in the test cube at which the accuracy is predicted."""

    position_mm: _Numbers
    joints: _Numbers
    """Joint coordinates: degrees, or mm for a prismatic joint."""
    ap_mm: float
    """Median of the pose accuracy AP of all simulated robots at this pose."""

    _nested = {
        'position_mm': ('numbers', ''),
        'joints': ('numbers', ''),
    }


class TestedFile(Record):
    """File of measured positions that serve to test the parameters, but not to identify them."""

    file: str
    poses: int
    """Number of measured positions."""
    before: AccuracyEntry
    """Distances of the measured positions from the positions of the nominal robot, after base and reflectors are
    fitted.
    """
    after: AccuracyEntry
    """Distances of the measured positions from the positions of the calibrated robot, after base and reflectors
    are fitted.
    """
    coverage_95: float
    """Share of the positions inside their predicted 95 % ellipsoids."""
    outliers: Table[OutlierRow]
    """Rows whose measured position is more than six standard deviations from the prediction."""

    _nested = {
        'before': ('record', 'AccuracyEntry'),
        'after': ('record', 'AccuracyEntry'),
        'outliers': ('table', 'OutlierRow'),
    }


class TightenEntry(Record):
    """Gain from halving the tolerances of the parameters in `halved`. In the statistical reading, the fields
    `of` and `to` hold the first-order quantity before and after the halving. In any other reading, they hold
    the worst case before and after the halving.
    """

    halved: List[str]
    of: float
    to: float
    unit: Literal['share', 'cost', 'mm', 'deg']
    cut_percent: float


class ToolSheet(Record):
    """Tool of a robot."""

    position_mm: _Numbers
    """Position of the TCP in the frame of the last Denavit-Hartenberg row."""
    axis: _Numbers
    """Unit vector of the tool axis in the frame of the TCP."""

    _nested = {
        'position_mm': ('numbers', ''),
        'axis': ('numbers', ''),
    }


class TotalEntry(Record):
    """Error figures of a posture, for the component of the error that matters for the operation (its sense).
    Worst case and statistics are null in the signed reading if the errors of the sample compensate each
    other. The program assumes such compensation if the error of a Denavit-Hartenberg length (r or l) exceeds
    the reach of the arm.
    """

    unit: Literal['share', 'cost', 'mm', 'deg']
    error: float
    worst_linear: Optional[float]
    worst: Optional[float]
    rms: Optional[float]
    mean: Optional[float]
    p95: Optional[float]
    p99: Optional[float]
    yield_: Optional[float]
    """Yield: share of arms whose error does not exceed the limit. The parameter errors of the arms are random
    and follow the tolerances.
    """


class TransferEntry(Record):
    """Collision-free joint motion from one operation to the next."""

    from_: str
    to: str
    way: str
    travel_deg: float
    """Sum over all straight moves of the motion, degrees. Each move contributes the travel of the joint that
    travels farthest in this move. The sum is a measure of the transfer time.
    """
    joints_deg: List[List[float]]
    """Joint vectors along the motion, which is a straight line in joint space from each vector to the next."""


class TriedEntry(Record):
    """Numbers of postures that were examined for the plan: usable, colliding, and hidden from the tracker."""

    candidates: int
    """Number of usable postures. The poses of the plan were chosen from these postures."""
    colliding: int
    """Number of postures at which the robot touches an object or is nearer to an object than the clearance that
    the cell requires.
    """
    hidden: int
    """Number of collision-free postures at which the tracker does not see the reflector."""


class TurnEntry(Record):
    """Rotation of equipment as one body about the base axis (the vertical line through the origin of the robot
    base). Equipment takes part in this rotation if the search varies its x, y and yaw over ranges. Carried
    equipment rotates only with its carrier.
    """

    turn_deg: _Numbers
    """Least and greatest angle of the rotation."""
    ends_with: str
    """Reason why the equipment cannot rotate farther in the direction with the smaller allowed rotation. If both
    directions allow equal rotations, the reason belongs to the negative direction.
    """

    _nested = {
        'turn_deg': ('numbers', ''),
    }


class UniformEntry(Record):
    """Uniform tightening: the loosest common scale of all tolerances with which every limit is met. Where this
    scale lies outside the range of a tolerance, the nearest end of the range applies. A tolerance with grades
    gets the loosest grade that is at least as tight as the scale.
    """

    scale: float
    cost: float
    saving_percent: float
    """Saving of the cheapest tolerances compared with the uniform tightening, percent."""


class UrdfEntry(Record):
    """Denavit-Hartenberg rows derived from a URDF, and the unused elements of the file."""

    file: str
    base_link: str
    tip_link: str
    base_to_frame_0: PoseEntry
    rows: Table[UrdfRow]
    last_frame_to_tip: PoseEntry
    ignored: Dict[str, int]
    """Number of unused elements of each kind in the file."""

    _nested = {
        'base_to_frame_0': ('record', 'PoseEntry'),
        'rows': ('table', 'UrdfRow'),
        'last_frame_to_tip': ('record', 'PoseEntry'),
    }


class UrdfRow(Record):
    """Denavit-Hartenberg row of a joint of a URDF."""

    joint: str
    theta_deg: float
    r_mm: float
    l_mm: float
    alpha_deg: float
    passive: bool


class VerdictDocument(Record):
    """Verdict of a report. Lengths are in mm and angles in degrees, rounded to 1e-9 as in search.json."""

    schema: Literal['sweetspot/report/1']
    of: Literal['search', 'layout']
    cell: str
    robot: str
    answer: Literal['yes', 'no']
    headline: str
    feasible: bool
    ended: Optional[Literal['done', 'gap', 'stagnation', 'interrupted', 'time-limit', 'diverged', 'nothing-to-search']]
    """Reason why the search ended; null if no search ran."""
    unit: Literal['share', 'cost', 'mm', 'deg']
    quantity: Literal['error', 'worst case', 'share of failures', 'rms', 'mean', 'p95', 'p99', 'tolerance cost']
    """Name of the figure that the search minimizes."""
    objective: Literal['lexicographic', 'tolerance-cost', 'sum', 'max']
    objective_value: Optional[float]
    start_value: Optional[float]
    gain_percent: Optional[float]
    bound: Optional[float]
    gap_percent: Optional[float]
    requirement: Literal['not-guaranteed', 'none', 'met', 'missed']
    runner_up: Optional[RunnerUpEntry]
    facts: Table[FactEntry]
    cell_yield: Optional[CellYieldEntry]
    """Overall yield: share of sampled arms that stay within the limits of all operations. Present if the reading
    is statistical, every operation has a spot, and at least one operation has a limit.
    """
    placements: Table[VerdictPlacement]
    """Placements of the equipment and of the robot base; empty if the layout is not feasible."""
    operations: Table[VerdictSpot]
    whole_cell: Optional[TurnEntry]
    """Angles by which equipment may rotate as one body about the base axis. Equipment takes part in this
    rotation if its x, y and yaw have ranges. At these angles, the layout stays within every limit. Null if
    the layout is infeasible or misses a limit, or if equipment under an operation does not take part.
    """
    reasons: List[str]
    """Reasons why the answer is no."""

    _nested = {
        'runner_up': ('record', 'RunnerUpEntry'),
        'facts': ('table', 'FactEntry'),
        'cell_yield': ('record', 'CellYieldEntry'),
        'placements': ('table', 'VerdictPlacement'),
        'operations': ('table', 'VerdictSpot'),
        'whole_cell': ('record', 'TurnEntry'),
    }


class VerdictPlacement(Record):
    """Placement of a piece of equipment, seen from the robot base, and the room to displace and rotate the
    piece.
    """

    equipment: str
    at: PlacementEntry
    """Placement in the frame of the robot base; the placement of the robot base itself is in the world frame."""
    room_mm: Optional[float]
    """Largest distance by which the piece may be displaced in every direction in plan. Null if the distance is
    not known.
    """
    room_deg: Optional[float]
    """Largest angle by which the piece may be rotated in either direction; null if the angle is not known."""
    ends_with: Optional[str]
    """Reason why the room is not larger; null if the room is not known."""

    _nested = {
        'at': ('record', 'PlacementEntry'),
    }


class VerdictSpot(Record):
    """Spot of an operation."""

    name: str
    equipment: str
    sense: str
    node: Optional[List[int]]
    position_mm: Optional[_Numbers]
    value: Optional[float]
    limit: Optional[float]
    margin: Optional[float]
    """Limit minus the value of the operation; negative if the value exceeds the limit. If `worst` is known, the
    margin is the limit minus `worst`, unless the objective is a tolerance cost.
    """
    worst: Optional[float]
    """Upper bound of the value at all misplacements within the placement tolerances. Null if the layout is not
    certified, or if no bound is known.
    """
    requirement: Literal['not-guaranteed', 'none', 'met', 'missed']
    """Whether the operation meets its limit."""
    text: str
    """Sentence that states spot, value and position."""

    _nested = {
        'position_mm': ('numbers', ''),
    }
