//! sweetspot finds where in a robot workcell a precision operation has the least error. It also finds the
//! placements of worktable and conveyor that make this error least.
//!
//! # The problem
//!
//! A robot is built with small errors `e` in its link parameters, so its end effector is not exactly where
//! the controller expects it. This project grew from a 1990s journal paper on a *kinematic error mapping and
//! layout facility* (AutoCAD and AutoLISP, Hitachi PW 10-II). The author, title and year of the paper are not
//! known to us. The documentation calls it the seed paper. In the equations of the paper, `A_i` is the
//! Denavit-Hartenberg matrix of link i. The term with Hayati's fifth parameter `beta_i` (section 2.3 of the
//! paper) is in brackets. `T` is the pose of the end effector at the joint coordinates `q`, and `dT` is the
//! error of this pose:
//!
//! ```text
//! A_i  = Rz(q_i) Tz(r_i) Tx(l_i) Rx(alpha_i) [Ry(beta_i)]             (1)
//! T(q) = A_1 A_2 ... A_N                                              (2)
//! dT(q, e) = prod (A_i + dA_i) - T(q)                                 (4)-(6)
//! ```
//!
//! Errors of the base, of the tool, of joint frames and of the fixture enter the product in the same way. The
//! inverse kinematics `Q(x)` is the set of all postures within the joint limits that hold the tool at `x`
//! with the required attitude. We choose a layout `L`, which places all movable equipment. For every
//! operation `k` with weight `w_k`, we choose a node `x` of the grid `G_k(L)` on the work surface:
//!
//! ```text
//! minimize over L:   sum_k w_k  min { R |dT(q, e)|_k :  x in G_k(L),  q in Q(x),  q hits nothing }
//! such that          equipment, robot base, obstacles and keep-out boxes do not overlap in plan and height.
//! ```
//!
//! The sense `|.|_k` is the component of the error that matters for operation `k`: x, y, z, xy (parts that
//! mate in the plane), xyz, a direction, a plane or a rotation. The component is expressed in world, surface
//! or tool axes. It is measured at the TCP or at another point of the tool. The reading `R` interprets the
//! errors: as one signed sample, as a tolerance box (worst case), or as random variables ([`reading`]).
//!
//! # The flow
//!
//! Data flows one way, and a module uses only the modules above it:
//!
//! | module | purpose | from input to output |
//! |---|---|---|
//! | [`cell`] | model of the workcell | plain data, valid by construction |
//! | [`robot`] | forward kinematics | joint coordinates to frames |
//! | [`kinematic_error`] | error models | frames and a sample of errors to position and rotation error |
//! | [`calibration`] | identification | measured positions to robot errors, their covariance and rank |
//! | [`reading`] | error figures | frames and a tolerance to worst case, percentiles, yield, budget |
//! | [`allocation`] | tolerance allocation | costs of tolerances and limits to the cheapest tolerances |
//! | [`verification`] | comparison | measured positions and error set to residuals, coverage, ranks |
//! | [`reach`] | inverse kinematics | TCP pose to all postures, or to the reason for failure; envelope |
//! | [`correction`] | corrected programme | target and errors to corrected joint coordinates |
//! | [`pose_accuracy`] | test of ISO 9283 | tolerances to the accuracy that a data sheet states, and back |
//! | [`clearance`] | collision check | layout and frames to the first contact, or none |
//! | [`motion`] | motion planning | two postures to a collision-free motion, or the first contact |
//! | [`cycle_time`] | cycle time | joint vectors and speeds to the least time of a motion |
//! | [`error_map`] | error map | surface to the spot of least error, or to the whole map |
//! | [`layout`] | evaluation | **[`layout::evaluate`]: layout to evaluation** |
//! | [`region`] | feasible regions | layout to the placements at which the layout stays feasible |
//! | [`search`] | optimization | cell to the best layout found |
//! | [`proof`] | lower bound | cell to a lower bound that no layout beats |
//! | [`assess`] | assessment | layout to all its figures; comparison of layouts |
//! | [`drawing`] | content of pictures | an assessment to solids, arrows, envelope, motion |
//! | [`raster`] | pictures | a drawing to an isometric picture: PNG and SVG |
//! | [`files`] | input files | TOML, URDF and mesh files to a validated [`cell::Cell`]; file schemas |
//! | [`record`] | documents | assessments to typed documents and tables; JSON Schemas |
//! | [`report`] | output | records and drawings to JSON, CSV, Parquet, HTML, PDF, SVG, DXF, TOML, text |
//! | `cli` | command line | arguments, files, progress, exit codes |
//! | [`study`] | stable entry point | a cell file and keys to evaluations and searches |
//!
//! All these modules may also use [`units`] for conversions, `safe_text`, `geometry` for plane geometry and
//! [`pose`] for rigid transforms.
//!
//! The modules from [`cell`] to [`raster`] do all computation. They form the package `sweetspot-core`. A
//! release build optimizes this package for speed. The package `sweetspot` re-exports the modules under the
//! same names.
//!
//! `evaluate` takes a [`layout::Workcell`]: a cell with a prepared kinematic chain, inverse kinematics and
//! collision shapes (parry3d). A search prepares the workcell once and evaluates hundreds of thousands of
//! layouts.
//!
//! # What holds everywhere
//!
//! - The library computes in SI units: m and rad, as f64. Millimetres and degrees occur only in files and
//!   reports, where every name states its unit. Only [`units`] converts units.
//! - Only `cli` touches files, clock and terminal. [`study`] reads files through `cli`.
//! - A [`cell::Cell`] is valid by construction. The reader reports all faults at once. Each fault states
//!   file, line and column, what is wrong and what to do.
//! - [`layout::evaluate`] is pure and total: the same input gives the same bits. An infeasible layout gives a
//!   cost and a reason, never a panic, an `Err`, NaN or infinity.
//! - Out of reach, joint limit, unreachable orientation, not converged and collision are distinct results.
//!   The result "joint limit" names the joint, and the result "collision" names the solids.
//! - A signed sample of errors is not a tolerance: [`cell::SignedErrors`] and [`cell::Tolerance`] are two
//!   types.
//! - Errors are computed directly as small motions, never as the difference of two nearly equal numbers.
//! - Results are deterministic: the seed is explicit, every restart has its own random stream, and results
//!   are combined in a fixed order. Any number of threads gives the same bytes.
//! - The optimizer only proposes layouts; `evaluate` alone decides which layout is better.
//!
//! CONTRIBUTING.md has our rules for texts, and docs/src/glossary.md explains our words. CONTRIBUTING.md
//! also says how to add a robot, an error source, a sense, a family of inverse kinematics or an exporter.
//!
//! # Example
//!
//! [`Study`] is the stable entry point of the library. A study loads a cell, sets keys as `--set` does,
//! evaluates and searches.
//!
//! ```
//! use sweetspot::Study;
//!
//! let cells = concat!(env!("CARGO_MANIFEST_DIR"), "/cells/");
//! let study = Study::load(format!("{cells}hitachi_paper.toml"))?;
//! let drawn = study.evaluate()?;
//! assert!((drawn.objective.ok_or("not feasible")? - 3.768569).abs() < 1e-6);
//!
//! let moved = Study::load(format!("{cells}hitachi_cell.toml"))?
//!     .set("equipment.worktable.placement.x_mm", 300.0)?
//!     .set("search.budget", 200)?
//!     .search()?;
//! let best = moved.best.ok_or("no layout is feasible")?;
//! assert_eq!(best.evaluate()?.objective, moved.result.objective_value);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! [`Study`] changes only if the major version of the package changes. A document in [`record`] changes only
//! if its format version or the major version of the package changes. The other modules are documented for
//! programmers who build on them, and may change with any version. Items that serve only the command line are
//! hidden from this documentation.
//!
//! The other modules give more detail, such as the error at every node:
//!
//! ```
//! use sweetspot::{error_map, files, layout};
//!
//! // `files` reads files through a function. This function reads the shipped cells.
//! let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/cells/");
//! let mut read = |path: &str| std::fs::read(format!("{folder}{path}")).map_err(|e| e.to_string());
//! let loaded = files::load("hitachi_paper.toml", &mut read).map_err(|faults| format!("{faults:?}"))?;
//!
//! let workcell = layout::Workcell::new(loaded.cell)?;
//! let start = workcell.cell.start();
//! let map = &workcell.maps(&start)[0];
//! assert_eq!((map.count(error_map::NodeSign::Usable), map.nodes.len()), (80, 99));
//! # Ok::<(), String>(())
//! ```

#[doc(inline)]
pub use sweetspot_core::{
    allocation, assess, calibration, cell, clearance, correction, cycle_time, drawing, error_map,
    kinematic_error, layout, motion, pose, pose_accuracy, proof, raster, reach, reading, region, robot,
    search, units, verification,
};
// Internal modules that no user of the library needs.
#[doc(hidden)]
pub use sweetspot_core::{
    certificate, colours, contour, geometry, low_discrepancy, mesh, safe_text, svg_text,
};

#[doc(hidden)]
pub mod cli;
pub mod files;
pub mod record;
pub mod report;
pub mod study;

pub use study::Study;
