//! Worker processes of tests, and tests of shared folders on a full or read-only disk.

use crate::cli::sandbox::*;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// Worker process, which is killed when the value is dropped.
pub struct Worker(Option<Child>);

impl Worker {
    pub fn start(shop: &Sandbox, args: &[&str]) -> Self {
        Self(Some(shop.command(args).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()))
    }

    pub fn id(&self) -> u32 {
        self.0.as_ref().unwrap().id()
    }

    /// Waits for the end of the worker.
    pub fn ended(mut self) -> RunOutput {
        ran(self.0.take().unwrap().wait_with_output().unwrap())
    }

    /// Stops the worker with SIGTERM, and waits for its end.
    #[cfg(unix)]
    pub fn stopped(self) -> RunOutput {
        assert!(Command::new("kill").args(["-TERM", &self.id().to_string()]).status().unwrap().success());
        let ended = self.ended();
        assert_eq!(ended.code, Some(130), "{}", ended.err);
        ended
    }
}

impl Drop for Worker {
    fn drop(&mut self) {
        if let Some(child) = &mut self.0 {
            let _ = child.kill();
            let _ = child.wait();
        }
    }
}

/// Waits until a condition holds.
pub fn wait_until(what: &str, mut holds: impl FnMut() -> bool) {
    let clock = Instant::now();
    while !holds() {
        assert!(clock.elapsed() < Duration::from_secs(120), "{what}: waited in vain");
        std::thread::sleep(Duration::from_millis(5));
    }
}

/// Runs a script in the sandbox that mounts file systems. Returns None if the system does not let users
/// mount.
#[cfg(unix)]
fn mounted(shop: &Sandbox, script: &str) -> Option<RunOutput> {
    let mut command = Command::new("unshare");
    command.args(["-Urm", "sh", "-c", script]).current_dir(shop.dir.path()).env("SWEETSPOT_CACHE", "off");
    let ran = command.output().ok().map(ran)?;
    (ran.code != Some(77)).then_some(ran)
}

/// Asserts that a worker on the folder `share` ends with exit code 3 and a clear message if the disk is full
/// or read-only. The worker must then write nothing. `claims` is the folder of the claims inside `share`.
#[cfg(unix)]
pub fn assert_no_room_exits_3(shop: &Sandbox, share: &str, claims: &str, worker: &[&str]) {
    let files = shop.files(share);
    let command = format!("{} {}", env!("CARGO_BIN_EXE_sweetspot"), worker.join(" "));
    let mount = format!(
        "cp -r {share} kept; mount -t tmpfs -o size=1m none {share} || exit 77; cp -r kept/* {share}; rm -r kept; "
    );
    let full = format!(
        "{mount}mkdir {share}/{claims}; dd if=/dev/zero of={share}/.sweetspot-filling bs=4096 2>/dev/null; \
         {command}; code=$?; cat {share}/{claims}/* >&2; exit $code"
    );
    let Some(ran) = mounted(shop, &full) else {
        return println!("SKIPPED: this system lets no user mount a file system, so no disk can be full");
    };
    ran.no_panic();
    assert_eq!((ran.code, ran.out.as_str()), (Some(3), ""), "{}", ran.err);
    let said = format!("cannot write {share}/");
    assert!(ran.err.contains(&said) && ran.err.contains("the disk is full"), "{}", ran.err);
    let read_only = format!("{mount}mount -o remount,ro {share}; {command}");
    let ran = mounted(shop, &read_only).unwrap();
    ran.no_panic();
    assert_eq!((ran.code, ran.out.as_str()), (Some(3), ""), "{}", ran.err);
    assert!(ran.err.contains("the file system is mounted read-only"), "{}", ran.err);
    assert_eq!(shop.files(share), files);
}
