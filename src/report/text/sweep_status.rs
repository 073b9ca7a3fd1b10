//! The state of a sweep.

use super::table::TextTable;
use crate::files::shown;
use crate::record::SweepStatus;
use std::fmt::Write;

/// Returns how many combinations are done, running, failed and free. Lists of the running combinations, of
/// the failed combinations and of the hosts follow.
pub fn sweep_status(status: &SweepStatus) -> String {
    let SweepStatus { combinations, done, free, running, failed, hosts, .. } = status;
    let mut out = format!(
        "{done} of {combinations} combinations done, {} running, {} failed, {free} free",
        running.len(),
        failed.len()
    );
    // Writing to a String cannot fail.
    let _ = match status.seconds_left {
        Some(left) => writeln!(out, "; about {} left", duration(left)),
        None => writeln!(out),
    };
    if !running.is_empty() {
        let mut table = TextTable::indented(2);
        table.row(["#", "host", "process", "runs for", "last heartbeat"]);
        for r in running {
            let heartbeat = format!("{} ago", duration(r.seconds_since_heartbeat));
            let [index, process] = [format!("{:04}", r.index), r.process.to_string()];
            table.row([index, shown(&r.host), process, duration(r.seconds), heartbeat]);
        }
        let _ = write!(out, "running\n{}", table.render());
    }
    if !failed.is_empty() {
        let _ = writeln!(out, "failed");
    }
    for f in failed {
        let end = if f.given_up { "; the workers have given up on this combination" } else { "" };
        let _ = writeln!(out, "  {:04}  {}{end}", f.index, shown(&f.why));
    }
    if !hosts.is_empty() {
        let mut table = TextTable::indented(1);
        table.row(["host", "done", "time"]);
        for host in hosts {
            table.row([shown(&host.host), host.combinations.len().to_string(), duration(host.seconds)]);
        }
        let _ = write!(out, "hosts\n{}", table.render());
    }
    out
}

/// Formats a duration with its two largest units, for example `2 h 05 min`.
fn duration(seconds: f64) -> String {
    let whole = seconds.max(0.0).round() as u64;
    match whole {
        0..60 => format!("{whole} s"),
        60..3600 => format!("{} min {:02} s", whole / 60, whole % 60),
        _ => format!("{} h {:02} min", whole / 3600, whole / 60 % 60),
    }
}
