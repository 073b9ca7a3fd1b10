//! `sweep --status`: the state of a sweep, from the files of its folder.

use crate::cli::commands::suggest;
use crate::cli::json_text::line;
use crate::cli::output::path_word;
use crate::cli::shared_work::MAX_LOSSES;
use crate::cli::sweep::{StoredRow, continuing, row, stored_plan};
use crate::cli::sweep_claims::{CLAIMS, ClaimState, SweepClaim, newest, path};
use crate::cli::{Exit, output};
use crate::record::{FailedCombination, HostWork, RunningCombination, SWEEP_STATUS_SCHEMA, SweepStatus};
use crate::report;
use crate::units::rounded;
use std::path::Path;
use std::time::SystemTime;

/// Runs `sweetspot sweep --status`.
pub fn status(folder: &Path, as_json: bool) -> Result<Exit, Exit> {
    let status = state(folder, stored_plan(folder)?.combinations);
    output::data(&if as_json { line(&status)? } else { report::text::sweep_status(&status) })?;
    let word = path_word(folder);
    match (status.complete, status.running.is_empty()) {
        (true, _) => output::talk(&format!("the table is {word}/table.csv")),
        // A worker of `--claim` does not begin a combination that was given up.
        (false, true) if status.free == 0 && status.failed.iter().all(|failed| failed.given_up) => {
            suggest(&continuing(&stored_plan(folder)?, folder, "--resume"));
        }
        (false, true) => suggest(&format!("sweep --claim {word}")),
        (false, false) => suggest(&format!("sweep --status {word}")),
    }
    Ok(Exit::Done)
}

/// Returns the state of a sweep with this number of combinations.
pub fn state(folder: &Path, combinations: usize) -> SweepStatus {
    let now = server_time(folder);
    let mut status = SweepStatus {
        schema: SWEEP_STATUS_SCHEMA.into(),
        combinations,
        done: 0,
        free: 0,
        running: Vec::new(),
        failed: Vec::new(),
        seconds_left: None,
        hosts: Vec::new(),
        complete: folder.join("manifest.json").is_file(),
    };
    (0..combinations).for_each(|index| note(&mut status, folder, index, now));
    status.with_estimate()
}

/// Adds one combination to the state.
fn note(status: &mut SweepStatus, folder: &Path, index: usize, now: SystemTime) {
    let row = row(folder, index);
    let (number, bytes) = newest(folder, index, 1);
    let claim = bytes.as_deref().and_then(SweepClaim::parse);
    if matches!(row, StoredRow::Whole(_)) {
        status.done += 1;
        return claim.into_iter().for_each(|claim| credit(status, index, claim));
    }
    let age = age(folder, index, number, now);
    let mut given_up = false;
    let why = match (&row, &claim) {
        (StoredRow::Damaged(why), _) => why.clone(),
        (_, None) if bytes.is_none() => {
            status.free += 1;
            return;
        }
        (_, None) => "the worker died before it wrote its name".into(),
        (_, Some(claim)) => match claim.state {
            ClaimState::Running if age <= f64::from(claim.lease) => {
                let SweepClaim { host, process, seconds, .. } = claim.clone();
                let seconds = rounded(seconds, 3);
                let seconds_since_heartbeat = rounded(age, 3);
                status.running.push(RunningCombination {
                    index,
                    host,
                    process,
                    seconds,
                    seconds_since_heartbeat,
                });
                return;
            }
            ClaimState::Running => {
                given_up = claim.losses >= MAX_LOSSES - 1;
                format!("{} has shown no heartbeat for {age:.0} s", claim.owner())
            }
            ClaimState::Stopped => format!("{} was stopped", claim.owner()),
            ClaimState::Done => format!("the files of {} are missing", claim.owner()),
            ClaimState::Failed => {
                format!("{} failed: {}", claim.owner(), claim.why.clone().unwrap_or_default())
            }
        },
    };
    let (host, process) = claim.map(|claim| (claim.host, claim.process)).unzip();
    status.failed.push(FailedCombination { index, host, process, why, given_up });
}

/// Adds a finished combination to the work of the host that processed it.
fn credit(status: &mut SweepStatus, index: usize, claim: SweepClaim) {
    let known = status.hosts.iter().position(|host| host.host == claim.host);
    let k = known.unwrap_or_else(|| {
        status.hosts.push(HostWork { host: claim.host, combinations: Vec::new(), seconds: 0.0 });
        status.hosts.len() - 1
    });
    if let Some(host) = status.hosts.get_mut(k) {
        host.combinations.push(index);
        host.seconds = rounded(host.seconds + claim.seconds, 3);
    }
}

/// Returns the time since the last heartbeat of a claim, s; 0 if the claim cannot be read.
fn age(folder: &Path, index: usize, number: u32, now: SystemTime) -> f64 {
    let beaten = path(folder, index, number).metadata().and_then(|about| about.modified());
    beaten.ok().and_then(|at| now.duration_since(at).ok()).map_or(0.0, |age| age.as_secs_f64())
}

/// Returns the current time by the clock of the file server, which also dates the heartbeats. Reads this time
/// from the date of a new temporary file. Returns the time of this host if the folder cannot be written.
fn server_time(folder: &Path) -> SystemTime {
    let new = tempfile::tempfile_in(folder.join(CLAIMS));
    let date = new.and_then(|file| file.metadata()).and_then(|about| about.modified());
    date.unwrap_or_else(|_| SystemTime::now())
}
