//! Claims of workers to the combinations of a sweep. Workers share nothing but a folder.
//!
//! Claim G to combination NNNN is the file `claims/NNNN-G`. The worker that creates the file owns the
//! combination. Exclusive creation, which fails if the file exists, is atomic on local disks, on SMB, and on
//! NFS since version 3. A rename cannot decide who came first, because it replaces the target.
//!
//! The owner rewrites its claim with a growing count: the heartbeat. Another worker takes over the
//! combination if it sees no change for the time of the lease. That worker measures the time with its own
//! clock, so the clocks of hosts may differ. It then creates claim G + 1. No claim is ever removed, so at
//! most one worker takes over.

use super::{Exit, loading};
use serde::{Deserialize, Serialize};
use std::fs::File;
use std::io::{ErrorKind, Read, Write};
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Folder with the claims, inside the folder of a sweep.
pub const CLAIMS: &str = "claims";

/// Largest number of bytes read from a claim.
const MAX_BYTES: u64 = 4096;

/// State of the owner's work on the combination.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ClaimState {
    Running,
    Done,
    /// A signal has stopped the owner.
    Stopped,
    Failed,
}

/// Content of a claim: one line of JSON. The owner rewrites the file in place. A heartbeat thus succeeds even
/// if the disk is full and refuses a new file. Any text after the first line is the rest of an earlier,
/// longer line.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SweepClaim {
    pub host: String,
    pub process: u32,
    pub state: ClaimState,
    /// Number of heartbeats.
    pub beat: u64,
    /// Seconds without a heartbeat after which the combination may be taken over.
    pub lease: u16,
    /// Number of earlier owners that died.
    pub losses: u32,
    /// Seconds since the owner began, by the clock of the owner.
    pub seconds: f64,
    pub why: Option<String>,
}

impl SweepClaim {
    /// Parses the bytes of a claim; returns None if they are incomplete, because the owner died while
    /// writing.
    pub fn parse(bytes: &[u8]) -> Option<Self> {
        serde_json::from_slice(bytes.split(|b| *b == b'\n').next()?).ok()
    }

    /// Returns the process and the host of the owner, in words.
    pub fn owner(&self) -> String {
        format!("process {} on {}", self.process, crate::files::shown(&self.host))
    }
}

/// Claim of this worker.
pub struct HeldClaim {
    pub index: usize,
    path: PathBuf,
    began: Instant,
    claim: SweepClaim,
}

impl HeldClaim {
    /// Creates claim `number` to a combination. Returns None if another worker has created it.
    pub fn create(
        folder: &Path,
        index: usize,
        number: u32,
        lease: u16,
        losses: u32,
    ) -> Result<Option<Self>, Exit> {
        let path = path(folder, index, number);
        let file = match File::options().write(true).create_new(true).open(&path) {
            Err(e) if e.kind() == ErrorKind::AlreadyExists => return Ok(None),
            opened => opened.map_err(|e| loading::cannot_write(&path, &e))?,
        };
        let (host, process, state) = (host(), std::process::id(), ClaimState::Running);
        let claim = SweepClaim { host, process, state, beat: 0, lease, losses, seconds: 0.0, why: None };
        let held = Self { index, path, began: Instant::now(), claim };
        held.write(file).map_err(|e| loading::cannot_write(&held.path, &e))?;
        Ok(Some(held))
    }

    /// Writes a heartbeat.
    pub fn beat(&mut self) -> Result<(), Exit> {
        self.claim.beat += 1;
        self.claim.seconds = self.began.elapsed().as_secs_f64();
        let file = File::options().write(true).open(&self.path);
        file.and_then(|file| self.write(file)).map_err(|e| loading::cannot_write(&self.path, &e))
    }

    /// Writes the last heartbeat, with the state in which the worker leaves the combination.
    pub fn end(mut self, state: ClaimState, why: Option<String>) -> Result<(), Exit> {
        (self.claim.state, self.claim.why) = (state, why);
        self.beat()
    }

    /// Writes the claim with one call, and syncs it, because closing a file reports no error.
    fn write(&self, mut file: File) -> std::io::Result<()> {
        let mut line = serde_json::to_vec(&self.claim)?;
        line.push(b'\n');
        file.write_all(&line)?;
        file.sync_data()
    }
}

/// Returns the path of claim `number` to a combination, in the folder of a sweep.
pub fn path(folder: &Path, index: usize, number: u32) -> PathBuf {
    folder.join(CLAIMS).join(format!("{index:04}-{number}"))
}

/// Reads a claim. Returns None if the claim does not exist or cannot be read now. Each call opens the file,
/// because a network share then asks its server for changes. A cached copy thus does not hide a heartbeat.
pub fn read(folder: &Path, index: usize, number: u32) -> Option<Vec<u8>> {
    let mut bytes = Vec::new();
    let file = File::open(path(folder, index, number)).ok()?;
    file.take(MAX_BYTES).read_to_end(&mut bytes).ok()?;
    Some(bytes)
}

/// Returns the number and the bytes of the newest claim to a combination. Ignores claims before claim
/// `number`. The bytes are None if the newest claim cannot be read.
pub fn newest(folder: &Path, index: usize, mut number: u32) -> (u32, Option<Vec<u8>>) {
    let mut bytes = read(folder, index, number);
    while let Some(next) = read(folder, index, number + 1) {
        (number, bytes) = (number + 1, Some(next));
    }
    (number, bytes)
}

/// Returns the node name that Slurm gives to this host or, outside Slurm, the name of the host.
fn host() -> String {
    std::env::var("SLURMD_NODENAME").unwrap_or_else(|_| system_name())
}

#[cfg(unix)]
fn system_name() -> String {
    rustix::system::uname().nodename().to_string_lossy().into_owned()
}

#[cfg(not(unix))]
fn system_name() -> String {
    std::env::var("COMPUTERNAME").unwrap_or_else(|_| "this computer".into())
}
