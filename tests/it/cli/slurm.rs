//! Tests `sweep --on slurm` with small scripts named sbatch and squeue, which run the tasks of a job as
//! processes.

use crate::cli::islands::assert_same;
use crate::cli::sandbox::*;
use std::io::{BufRead, BufReader};
use std::os::unix::fs::PermissionsExt;
use std::process::{Command, Stdio};
use std::time::Duration;

/// Script `sbatch` of a simulated batch system. Job N is the folder queue/N, which is removed when all tasks
/// have ended. If the file `lose-N` names a task, the task is killed before it begins. No task begins while
/// the file `wait` exists.
const SBATCH: &str = r#"#!/bin/sh
home=$(dirname "$0")/..
id=$(($(ls "$home/jobs" | wc -l) + 1))
for word in "$@"; do
  case $word in
    --array=0-*) last=${word#--array=0-} ;;
    --output=*) log=${word#--output=} ;;
    --*) ;;
    *) [ -n "$script" ] && list=$word || script=$word ;;
  esac
done
echo "$@" > "$home/jobs/$id"
mkdir "$home/queue/$id"
(
  while [ -f "$home/wait" ]; do sleep 0.05; done
  for task in $(seq 0 "$last"); do
    grep -qx "$task" "$home/lose-$id" 2>/dev/null && continue
    out=$(echo "$log" | sed "s/%a/$task/")
    SLURM_ARRAY_TASK_ID=$task SLURMD_NODENAME=n$((task % 2)) sh "$script" "$list" > "$out" 2>&1
  done
  rmdir "$home/queue/$id"
) > /dev/null 2>&1 &
echo "$id;scratch"
"#;

/// Script `squeue`, which lists the jobs and the lines of the file `held`.
const SQUEUE: &str = r#"#!/bin/sh
cd "$(dirname "$0")/.."
ls queue | sed 's/$/ None/'
cat held 2>/dev/null || true
"#;

const SCANCEL: &str = r#"#!/bin/sh
cd "$(dirname "$0")/.."
mv held "cancelled-$1"
"#;

/// Returns a sandbox with the simulated batch system.
fn cluster() -> Sandbox {
    let shop = Sandbox::new();
    for folder in ["bin", "jobs", "queue"] {
        std::fs::create_dir(shop.path(folder)).unwrap();
    }
    for (name, text) in [("bin/sbatch", SBATCH), ("bin/squeue", SQUEUE), ("bin/scancel", SCANCEL)] {
        shop.write(name, text);
        std::fs::set_permissions(shop.path(name), std::fs::Permissions::from_mode(0o755)).unwrap();
    }
    shop
}

fn submission(shop: &Sandbox, args: &[&str]) -> Command {
    let path = format!("{}:{}", shop.path("bin").display(), std::env::var("PATH").unwrap());
    let mut command = shop.command(args);
    command.env("PATH", path).stdout(Stdio::piped()).stderr(Stdio::piped());
    command
}

fn submit(shop: &Sandbox, args: &[&str]) -> RunOutput {
    ran(submission(shop, args).output().unwrap())
}

const SWEEP: [&str; 6] = [
    "sweep",
    CELL,
    "--budget",
    "60",
    "--set",
    "equipment.worktable.placement.z_mm=500,510,520,530,540,550,560",
];

fn sweep<'a>(more: &[&'a str]) -> Vec<&'a str> {
    [&SWEEP[..], more].concat()
}

/// Asserts that the folder `swept` contains the files of an undisturbed run, byte for byte.
fn assert_whole(shop: &Sandbox) {
    shop.done(&sweep(&["--out", "straight"]));
    let own = |f: &String| !f.starts_with("claims/") && !f.starts_with("slurm/");
    let files: Vec<String> = shop.files("swept").into_iter().filter(own).collect();
    assert_eq!(files, shop.files("straight"));
    for file in files {
        assert!(shop.read(&format!("swept/{file}")) == shop.read(&format!("straight/{file}")), "{file}");
    }
}

#[test]
fn lost_tasks_are_submitted_again_and_the_table_is_the_same() {
    let shop = cluster();
    // Tasks 1 and 3 of the first job and task 0 of the second job are lost.
    shop.write("lose-1", "1\n3\n");
    shop.write("lose-2", "0\n");
    let on = ["--out", "swept", "--on", "slurm", "--chunk", "2", "--partition", "short", "--time", "1:00"];
    let ran = submit(&shop, &sweep(&on));
    assert_eq!(ran.code, Some(0), "{}", ran.err);
    for said in [
        "submitted job 1: 7 combinations in 4 tasks",
        "submitted job 2: 3 combinations in 2 tasks",
        "submitted job 3: 2 combinations in 1 task\n",
        "7 of 7 combinations done",
    ] {
        assert!(ran.err.contains(said), "no {said:?} in {}", ran.err);
    }
    assert_eq!(shop.text("swept/slurm/round-1.txt"), "0-1\n2-3\n4-5\n6\n");
    assert_eq!(shop.text("swept/slurm/round-2.txt"), "2-3\n6\n");
    assert!(shop.text("swept/slurm/job.sh").contains("#SBATCH --partition=short\n#SBATCH --time=1:00\n"));
    let status = shop.json(&["sweep", "--status", "swept"]);
    let hosts = [&status["hosts"][0], &status["hosts"][1]];
    assert_eq!(hosts.map(|host| text(&host["host"])), ["n0", "n1"]);
    assert_eq!(hosts[0]["combinations"], serde_json::json!([0, 1, 2, 3, 4, 5]));
    assert_whole(&shop);
}

/// The job continues after the command that submitted it ends. A second command waits for the end of the job.
#[test]
fn an_interrupted_command_goes_on_with_the_job() {
    let shop = cluster();
    shop.write("wait", "");
    let args = sweep(&["--out", "swept", "--on", "slurm", "--chunk", "3"]);
    let first = submission(&shop, &args).spawn().unwrap();
    while !shop.path("swept/slurm/round-1.job").exists() {
        std::thread::sleep(Duration::from_millis(20));
    }
    assert!(Command::new("kill").args(["-TERM", &first.id().to_string()]).status().unwrap().success());
    let ended = ran(first.wait_with_output().unwrap());
    assert_eq!((ended.code, ended.out.as_str()), (Some(130), ""), "{}", ended.err);
    assert!(ended.err.contains("note: the job continues; scancel ends it"), "{}", ended.err);
    assert!(ended.err.contains("next: sweetspot sweep --resume swept --on slurm"), "{}", ended.err);
    let again = ["sweep", "--resume", "swept", "--on", "slurm", "--chunk", "3"];
    let mut second = submission(&shop, &again).spawn().unwrap();
    let mut lines = BufReader::new(second.stderr.take().unwrap()).lines();
    let said = lines.find(|line| line.as_ref().unwrap().contains("job 1 of an earlier command continues"));
    std::fs::remove_file(shop.path("wait")).unwrap();
    lines.for_each(drop);
    assert_eq!(second.wait().unwrap().code(), Some(0));
    assert!(said.is_some());
    assert_eq!(shop.files("jobs"), ["1"]);
    assert_whole(&shop);
}

/// Islands are processed like the combinations of a sweep, so a lost task is submitted again.
#[test]
fn islands_are_submitted_and_merged() {
    let shop = cluster();
    shop.write("lose-1", "1\n");
    let islands = ["search", CELL, "--budget", "60", "--islands", "5"];
    let on = ["--out", "found", "--on", "slurm", "--chunk", "2", "--task-time", "1:00"];
    let ran = submit(&shop, &[&islands[..], &on, &["--dry-run"]].concat());
    assert_eq!(ran.code, Some(0), "{}", ran.err);
    assert!(ran.out.contains("#SBATCH --time=1:00\n"), "{}", ran.out);
    assert!(ran.err.contains("next: sweetspot search --resume found --on slurm"), "{}", ran.err);
    let ran = submit(&shop, &["search", "--resume", "found", "--on", "slurm", "--chunk", "2"]);
    assert_eq!(ran.code, Some(0), "{}", ran.err);
    assert!(ran.err.contains("submitted job 2: 2 combinations in 1 task\n"), "{}", ran.err);
    assert!(ran.out.contains("5 seeds"), "{}", ran.out);
    shop.done(&[&islands[..], &["--out", "straight"]].concat());
    assert_same(&shop, "found", "straight");
}

/// Slurm holds a task forever if a node failed to start it.
#[test]
fn held_tasks_are_cancelled_and_submitted_again() {
    let shop = cluster();
    shop.write("lose-1", "1\n");
    shop.write("held", "1 launch failed requeued held\n");
    let ran = submit(&shop, &sweep(&["--out", "swept", "--on", "slurm", "--chunk", "5"]));
    assert_eq!(ran.code, Some(0), "{}", ran.err);
    assert!(
        ran.err.contains("a compute node failed to start tasks of job 1; these tasks are cancelled"),
        "{}",
        ran.err
    );
    assert!(ran.err.contains("submitted job 2: 2 combinations in 1 task\n"), "{}", ran.err);
    assert!(shop.path("cancelled-1").exists());
    assert_whole(&shop);
}

#[test]
fn after_three_retries_the_missing_combinations_are_named() {
    let shop = cluster();
    (1..=5).for_each(|job| shop.write(&format!("lose-{job}"), "0\n"));
    let ran = submit(&shop, &sweep(&["--out", "swept", "--on", "slurm", "--chunk", "6"]));
    assert_eq!((ran.code, ran.out.as_str()), (Some(4), ""), "{}", ran.err);
    assert_eq!(shop.files("jobs").len(), 4, "one submission and three retries");
    assert!(ran.err.contains("6 combinations still missing after 3 retries"), "{}", ran.err);
    assert!(ran.err.contains("  0003: no task has begun it"), "{}", ran.err);
    (5..=9).for_each(|job| drop(std::fs::remove_file(shop.path(&format!("lose-{job}")))));
    let ran = submit(&shop, &["sweep", "--resume", "swept", "--on", "slurm", "--chunk", "6"]);
    assert_eq!(ran.code, Some(0), "{}", ran.err);
    assert_whole(&shop);
}

/// A dry run prepares all files but submits no job. The real run keeps a script that the user has edited.
#[test]
fn a_dry_run_shows_the_script_and_an_edited_script_is_kept() {
    let shop = cluster();
    let on = ["--out", "swept", "--on", "slurm", "--cpus", "2", "--max-array", "2", "--dry-run"];
    let ran = submit(&shop, &sweep(&on));
    assert_eq!(ran.code, Some(0), "{}", ran.err);
    assert_eq!(ran.out, shop.text("swept/slurm/job.sh"));
    assert!(
        ran.out.starts_with("#!/bin/sh\n#SBATCH ") && ran.out.contains("--cpus-per-task=2\n"),
        "{}",
        ran.out
    );
    assert!(ran.err.contains("combination 0 is processed here to measure its time"), "{}", ran.err);
    assert!(ran.err.contains("sbatch --parsable --array=0-0 "), "{}", ran.err);
    assert!(shop.files("jobs").is_empty());
    assert_eq!(shop.text("swept/slurm/round-1.txt"), "1-6\n", "a task takes about a minute");
    // An array has at most two tasks here, so the job becomes several arrays.
    submit(&shop, &[&["sweep", "--resume", "swept", "--chunk", "1"][..], &on[2..]].concat());
    assert_eq!(shop.text("swept/slurm/round-1.txt"), "1-3\n4-6\n");
    let edited = ran.out.replace("#SBATCH --job-name=sweetspot\n", "#SBATCH --job-name=mine\n");
    shop.write("swept/slurm/job.sh", &edited);
    let ran = submit(&shop, &["sweep", "--resume", "swept", "--on", "slurm", "--chunk", "3"]);
    assert_eq!(ran.code, Some(0), "{}", ran.err);
    assert!(ran.err.contains("slurm/job.sh is kept"), "{}", ran.err);
    assert_eq!(shop.text("swept/slurm/job.sh"), edited);
    assert_whole(&shop);
}

#[test]
fn a_machine_without_slurm_says_so_and_exits_3() {
    let shop = Sandbox::new();
    let mut command = shop.command(&sweep(&["--out", "swept", "--on", "slurm", "--chunk", "9"]));
    let ran = ran(command.env("PATH", "/nowhere").output().unwrap());
    assert_eq!((ran.code, ran.out.as_str()), (Some(3), ""), "{}", ran.err);
    assert!(ran.err.contains("cannot submit a job: sbatch: no such file"), "{}", ran.err);
    for wrong in [&["--time", "soon"][..], &["--partition", "a\nb"], &["--chunk", "0"], &["--claim", "x"]] {
        let ran = shop.run(&[&sweep(&["--on", "slurm"])[..], wrong].concat());
        assert_eq!((ran.code, ran.out.as_str()), (Some(2), ""), "{wrong:?}: {}", ran.err);
    }
    assert_eq!(shop.run(&sweep(&["--dry-run"])).code, Some(2));
}
