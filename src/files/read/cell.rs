//! Reader of cell files: robot, equipment, obstacles, operations, search settings.

use super::header::header;
use super::{constraints, equipment, operation, placement, plan, robot, sense, solid};
use crate::cell::*;
use crate::files::fault::{did_you_mean, listed, shown};
use crate::files::keys::cell::{cell, search};
use crate::files::keys::constraints::margins;
use crate::files::keys::equipment::{equipment as equipment_keys, obstacle};
use crate::files::keys::key::Key;
use crate::files::keys::robot::robot_in_cell;
use crate::files::keys::title_block::title_block;
use crate::files::toml::document::Library;
use crate::files::toml::reader::Table;
use crate::files::toml::tree::{Node, Value};
use crate::files::toml::value::{is_name, text, word};

/// Reads a whole cell. The result is valid only if no fault was recorded.
///
/// `stem` becomes the name of the cell if the file gives none.
pub fn read(stem: &str, root: &Node, lib: &mut Library) -> Option<Cell> {
    Table::read(root, cell::TABLE.what, &cell::TABLE, lib, |t| {
        header(t, &cell::SCHEMA)?;
        let stem = if is_name(stem) { stem } else { "cell" };
        let name = t.if_given(&cell::NAME, Table::name);
        t.if_given(&cell::SOURCE, Table::text);
        let robot = read_robot(t);
        let errors = read_error_choice(t);
        let question = read_question(t);
        let mut equipment = read_equipment(t);
        equipment::tie(t, &mut equipment);
        let keep_out = t.named(&cell::KEEP_OUT, equipment::read_keep_out);
        let senses = sense::read_all(t);
        let operations = operation::read_all(t, &equipment, &senses);
        let collision = t.boolean(&cell::COLLISION);
        let clearance = t.if_given(&cell::CLEARANCE, Table::number);
        let floor = t.number(&cell::FLOOR);
        let built = robot.as_ref().map(|(robot, ..)| robot);
        let margins = constraints::read_margins(t, built);
        let transfer = constraints::read_transfer(t, built, margins);
        let fence = constraints::read_fence(t);
        let search = read_search(t);
        let title_block = read_title_block(t);
        let ((robot, base, base_tolerance, base_support), question) = (robot?, question?);
        let mut cell = Cell {
            name: name?.unwrap_or_else(|| stem.to_string()),
            robot,
            base,
            base_tolerance,
            base_support,
            errors: errors?,
            model: question.model,
            reading: question.reading.unwrap_or(Reading::Signed),
            quantity: question.quantity,
            registration: question.registration,
            guard: question.guard,
            equipment,
            keep_out,
            operations,
            senses,
            collision: collision?,
            clearance: clearance?.unwrap_or(0.0),
            floor: floor?,
            margins: margins?,
            transfer: transfer?,
            fence: fence?,
            search: search?,
            title_block: title_block?,
            assumed: Vec::new(),
        };
        // The floor space of the base contains its pedestal.
        if let Some((section, _)) = cell.highest_pedestal() {
            cell.robot.footprint = cell.robot.footprint.joined(&section);
        }
        let stated = stated_keys(t, &cell);
        cell = cell.assuming(&stated);
        refuse_nothing_to_withstand(t, &cell);
        if question.reading.is_none() {
            cell.reading = cell.default_reading();
        }
        Some(cell)
    })
}

/// Returns which quantities the file states. [`Cell::assuming`] may assume values for the other quantities if
/// `ideal` is false.
fn stated_keys(t: &mut Table, read: &Cell) -> StatedKeys {
    let mut stated = |table: &Key, key: &Key| t.get(table).is_some_and(|n| n.value.get(key.name).is_some());
    let [turn_margin, slide_margin, singularity] =
        [margins::TURN, margins::SLIDE, margins::SINGULARITY].map(|key| stated(&cell::MARGINS, &key));
    let base_tolerance = stated(&cell::ROBOT, &robot_in_cell::BASE_TOLERANCE);
    let equipment = t.get(&cell::EQUIPMENT);
    let tolerance = |e: &Equipment| {
        let node = equipment.and_then(|all| all.value.get(&e.name));
        node.is_some_and(|node| node.value.get(equipment_keys::TOLERANCE.name).is_some())
    };
    let placement_tolerances = read.equipment.iter().map(tolerance).collect();
    let clearance = t.get(&cell::CLEARANCE).is_some();
    let settings = t.get(&cell::SEARCH).map(|node| node.value.entries().iter().map(|(key, ..)| key.as_str()));
    let search = settings.is_some_and(|keys| keys.ne([search::SEED.name]));
    StatedKeys {
        search,
        clearance,
        turn_margin,
        slide_margin,
        singularity,
        base_tolerance,
        placement_tolerances,
    }
}

/// Settings that define how the errors of a cell are modelled and interpreted.
struct Question {
    model: Model,
    /// Reading that the file states; None if the kind of the error sets decides the reading.
    reading: Option<Reading>,
    quantity: Quantity,
    registration: Registration,
    guard: f64,
}

fn read_question(t: &mut Table) -> Option<Question> {
    let model = t.word(&cell::MODEL);
    let reading = t.if_given(&cell::READING, Table::word);
    let quantity = t.word(&cell::QUANTITY);
    let registration = t.word(&cell::REGISTRATION);
    let guard = t.number(&cell::GUARD);
    Some(Question {
        model: model?,
        reading: reading?,
        quantity: quantity?,
        registration: registration?,
        guard: guard?,
    })
}

type Based = (Robot, [Coordinate; 4], PlacementTolerance, BaseSupport);

fn read_robot(t: &mut Table) -> Option<Based> {
    t.table(&cell::ROBOT, |t| {
        let origin = [(); 4].map(|()| Coordinate::Fixed(0.0));
        let base = t.table_or(&robot_in_cell::BASE, origin, placement::read);
        let exact = PlacementTolerance::default();
        let tolerance = t.table_or(&robot_in_cell::BASE_TOLERANCE, exact, placement::read_tolerance);
        let support = read_support(t);
        let robot = robot::read(t)?;
        let (base, support) = (base?, support?.unwrap_or(BaseSupport::Pedestal(robot.footprint)));
        Some((robot, base, tolerance?, support))
    })
}

/// Reads `pedestal`: true, false or the cross-section of the pedestal. Some(None) stands for a pedestal as
/// large as the footprint.
fn read_support(t: &mut Table) -> Option<Option<BaseSupport>> {
    let key = robot_in_cell::PEDESTAL;
    let Some(node) = t.get(&key) else { return Some(None) };
    if let Value::Boolean(stands) = node.value {
        return Some((!stands).then_some(BaseSupport::Hung));
    }
    t.table(&key, solid::read_rectangle).map(|section| Some(BaseSupport::Pedestal(section)))
}

/// Records a fault if `robust` and `ideal` are both true. Also records a fault if `robust` is true but no
/// placement has a tolerance.
fn refuse_nothing_to_withstand(t: &mut Table, read: &Cell) {
    if let Some(node) = t.get(&cell::SEARCH).and_then(|settings| settings.value.get(search::ROBUST.name))
        && read.search.robust
    {
        let (at, ideal) = (node.at, read.search.ideal);
        if ideal {
            let help = "remove one of them: an ideal layout need not withstand misplacements";
            t.error(at, "`robust` and `ideal` exclude each other", help);
        } else if !read.has_placement_tolerance() {
            let help = "add placement_tolerance = { x_mm = 2, y_mm = 2 } to a piece of equipment";
            t.error(at, "`robust` is set, but no placement has a tolerance", help);
        }
    }
}

/// Reads `errors = "NAME"` and returns the index of that error set of the robot.
///
/// The name is looked up among the entries of the file, which include error sets that could not be read.
fn read_error_choice(t: &mut Table) -> Option<usize> {
    let node = t.get(&cell::ERRORS)?;
    let name = text(node, cell::ERRORS.name, t.lib)?;
    let robot = t.get(&cell::ROBOT)?;
    let sets = robot.value.get("errors")?.value.entries();
    let found = sets.iter().position(|(k, ..)| *k == name);
    if found.is_none() && !robot.value.is_partial() {
        let names = || sets.iter().map(|(k, ..)| k.as_str());
        let help = match did_you_mean(&name, names()) {
            Some(near) => format!("did you mean \"{}\"?", shown(near)),
            None => format!("the robot has: {}", listed(names())),
        };
        t.error(node.at, format!("the robot has no error set `{}`", shown(&name)), help);
    }
    found
}

/// Reads the equipment, then the obstacles. Records a fault if an obstacle has the name of a piece of
/// equipment.
fn read_equipment(t: &mut Table) -> Vec<Equipment> {
    let taken = t.get(&cell::EQUIPMENT);
    let mut all = t.named(&cell::EQUIPMENT, |name, t| equipment::read(name, t, Role::Equipment));
    let mut drawn = Vec::new();
    all.extend(t.named(&cell::OBSTACLE, |name, t| {
        if taken.is_some_and(|taken| taken.value.get(name).is_some()) {
            let message = format!("the name `{}` is already used by a piece of equipment", shown(name));
            t.error(t.at, message, "give the obstacle a different name");
        }
        if t.get(&obstacle::PLAN).is_some() {
            drawn.extend(plan::read(name, t)?);
            return None;
        }
        equipment::read(name, t, Role::Obstacle)
    }));
    // The bodies of plans come last, so that all other pieces keep the order of the file.
    all.extend(drawn);
    all
}

fn read_search(t: &mut Table) -> Option<SearchSettings> {
    t.table_or(&cell::SEARCH, SearchSettings::default(), |t| {
        let (solver, objective) = (t.word(&search::SOLVER), t.word(&search::OBJECTIVE));
        let indifference = t.number(&search::INDIFFERENCE);
        let (budget, seed) = (t.whole(&search::BUDGET), t.whole(&search::SEED));
        let (ideal, robust) = (t.boolean(&search::IDEAL), t.boolean(&search::ROBUST));
        let mm = t.if_given(&search::RESOLUTION_MM, Table::number);
        let deg = t.if_given(&search::RESOLUTION_DEG, Table::number);
        let gap = t.if_given(&search::GAP, Table::number);
        let stagnation = t.if_given(&search::STAGNATION, Table::whole);
        let (pareto, keep) = (read_pareto(t), t.if_given(&search::KEEP, Table::whole));
        let usual = if ideal? { Resolution::IDEAL } else { Resolution::BUILDABLE };
        Some(SearchSettings {
            resolution: Resolution { mm: mm?.unwrap_or(usual.mm), deg: deg?.unwrap_or(usual.deg) },
            solver: solver?,
            objective: objective?,
            indifference: indifference?,
            budget: budget?,
            seed: seed?,
            ideal: ideal?,
            robust: robust?,
            gap: gap?,
            stagnation: stagnation?,
            pareto: pareto?,
            keep: keep?.unwrap_or(0) as usize,
        })
    })
}

fn read_title_block(t: &mut Table) -> Option<TitleBlock> {
    t.table_or(&cell::TITLE_BLOCK, TitleBlock::default(), |t| {
        let [owner, title, number, revision, date, author, approved_by, general_tolerance] = [
            title_block::OWNER,
            title_block::TITLE,
            title_block::NUMBER,
            title_block::REVISION,
            title_block::DATE,
            title_block::AUTHOR,
            title_block::APPROVED_BY,
            title_block::GENERAL_TOLERANCE,
        ]
        .map(|key| t.if_given(&key, Table::name));
        let projection = t.word(&title_block::PROJECTION);
        Some(TitleBlock {
            owner: owner?,
            title: title?,
            number: number?,
            revision: revision?,
            date: date?,
            author: author?,
            approved_by: approved_by?,
            general_tolerance: general_tolerance?,
            projection: projection?,
        })
    })
}

/// Reads `pareto = ["error", "clearance"]`: at least two goals, each once.
fn read_pareto(t: &mut Table) -> Option<Goals> {
    let Some(node) = t.get(&search::PARETO) else { return Some(Goals::default()) };
    let named = t.items(&search::PARETO)?.iter().map(|item| word(item, search::PARETO.name, t.lib));
    let named: Option<Vec<Goal>> = named.collect::<Vec<_>>().into_iter().collect();
    let goals = Goals::of(&named?);
    if goals.is_none() {
        let help = format!("the goals are: {}", listed(Goal::ALL.map(Goal::name)));
        t.error(node.at, "`pareto` must not name a goal twice", help);
    }
    goals
}
