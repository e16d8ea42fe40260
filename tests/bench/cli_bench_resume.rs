//! `angioray bench` stopped and resumed, from outside. Without a device the tests say so and
//! pass, unless REQUIRE_OPENCL=1.
#![cfg(unix)]

use crate::cli_place;
use crate::common;

use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use cli_place::{Place, stderr};
use serde_json::Value;

/// Four volumes, so that a run has twenty units of work: many more are left than a fast device ends
/// between a reading of the journal and the signal's arrival.
fn place() -> Place {
    let place = Place::with_ball();
    place.done("phantom gaussian -o bump.nrrd --size 24");
    place.done("phantom slab -o slab.nrrd --size 24");
    place.done("phantom ramp -o ramp.nrrd --size 24");
    place
}

const VOLUMES: &str = "ball.nrrd bump.nrrd slab.nrrd ramp.nrrd";
const ROWS: usize = 100;

/// Runs a line and ends it by `signal` as soon as `units` are in the journal of `folder`; its exit
/// code and stderr.
fn stopped(place: &Place, line: &str, folder: &str, units: usize, signal: &str) -> (i32, String) {
    let mut command = place.command(line);
    command.stdout(Stdio::null()).stderr(Stdio::piped());
    let child = command.spawn().unwrap();
    let journal = place.path(folder).join("journal.jsonl");
    let began = Instant::now();
    let known = || {
        let text = std::fs::read_to_string(&journal).unwrap_or_default();
        text.lines()
            .filter(|line| line.contains("\"unit\""))
            .count()
    };
    while known() < units {
        assert!(began.elapsed() < Duration::from_secs(120), "no unit ends");
        std::thread::sleep(Duration::from_millis(2));
    }
    let kill = format!("kill -{signal} {}", child.id());
    assert!(
        Command::new("sh")
            .args(["-c", &kill])
            .status()
            .unwrap()
            .success()
    );
    let output = child.wait_with_output().unwrap();
    (output.status.code().unwrap_or(-1), stderr(&output))
}

fn rows(place: &Place, folder: &str) -> Vec<Value> {
    let results = place.json(&format!("{folder}/results.json"));
    results["rows"].as_array().unwrap().clone()
}

/// What of the rows does not depend on time.
fn lasting(rows: &[Value]) -> Vec<String> {
    let keys = [
        "volume",
        "picture",
        "traverse",
        "nodes_per_ray",
        "samples_per_ray",
        "same_bytes",
    ];
    let row = |row: &Value| keys.map(|key| row[key].to_string()).join(",");
    rows.iter().map(row).collect()
}

#[test]
fn a_stopped_run_resumes_where_it_was() {
    let Some(device) = common::device_flag() else {
        return;
    };
    let place = place();
    let line = |folder: &str| format!("bench traversals {VOLUMES} --quick -o {folder} {device}");

    let (code, messages) = stopped(&place, &line("out"), "out", 1, "TERM");
    assert_eq!(code, 75, "{messages}");
    assert!(
        messages.contains("error: stopped before the end; "),
        "{messages}"
    );
    assert!(
        messages.contains("hint: the same command resumes from there"),
        "{messages}"
    );
    let first = place.json("out/results.json");
    assert_eq!(first["finished"], false);
    let first = rows(&place, "out");
    assert!(!first.is_empty() && first.len() < ROWS, "{}", first.len());
    let csv = std::fs::read_to_string(place.path("out/results.csv")).unwrap();
    assert_eq!(csv.lines().count(), 1 + first.len());

    // Ctrl-C does the same, and what was measured stays as it was.
    let units = first.len() / 5 + 2;
    let (code, messages) = stopped(&place, &line("out"), "out", units, "INT");
    assert_eq!(code, 75, "{messages}");
    assert!(
        messages.contains("units of work were measured before"),
        "{messages}"
    );
    let second = rows(&place, "out");
    assert!(second.len() > first.len());
    assert_eq!(second[..first.len()], first[..]);

    place.done(&line("out"));
    let whole = rows(&place, "out");
    assert_eq!(whole[..second.len()], second[..]);
    assert_eq!(place.json("out/results.json")["finished"], true);
    assert!(!place.path("out/journal.jsonl").exists());

    // As a run that was never stopped; but for its times, which are its own.
    place.done(&line("other"));
    let other = rows(&place, "other");
    assert_eq!(lasting(&whole), lasting(&other));
    assert_ne!(whole, other);
}

/// Other kernels, from a folder: the embedded ones, one of them changed.
fn check_other_kernels(place: &Place, line: &str) {
    let kernels = place.path("kernels");
    crate::common::copy_kernels(&kernels);
    let refused_with_kernels = || {
        let mut command = place.command(&format!("{line} --protocol static"));
        let output = command.env("ANGIORAY_KERNELS", &kernels).output().unwrap();
        stderr(&output)
    };
    // The control: the same kernels from elsewhere are no others.
    let message = refused_with_kernels();
    assert!(message.contains("its protocol was"), "{message}");
    let changed = kernels.join("lib/volume/cubic.clh");
    let text = std::fs::read_to_string(&changed).unwrap();
    std::fs::write(&changed, text + "// another\n").unwrap();
    let message = refused_with_kernels();
    assert!(message.contains("its kernels was"), "{message}");
}

/// Another build of the same version.
fn check_other_build(place: &Place, line: &str) {
    let other = place.path("angioray-other");
    let mut bytes = std::fs::read(env!("CARGO_BIN_EXE_angioray")).unwrap();
    bytes.push(0);
    std::fs::write(&other, bytes).unwrap();
    let permissions = std::fs::metadata(env!("CARGO_BIN_EXE_angioray")).unwrap();
    std::fs::set_permissions(&other, permissions.permissions()).unwrap();
    let mut command = Command::new(&other);
    let words = line.split_whitespace();
    let output = command.args(words).current_dir(place.path("")).output();
    let messages = stderr(&output.unwrap());
    assert!(messages.contains("its program was"), "{messages}");
}

#[test]
fn what_another_run_has_left_is_refused_in_a_sentence() {
    let Some(device) = common::device_flag() else {
        return;
    };
    let place = place();
    let line = format!("bench traversals {VOLUMES} --quick -o out {device}");
    let (code, messages) = stopped(&place, &line, "out", 1, "TERM");
    assert_eq!(code, 75, "{messages}");
    let refused = |line: &str| {
        let output = place.run(&format!("{line} -o out {device}"));
        let messages = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "{line}: {messages}");
        assert!(output.stdout.is_empty());
        let (_, messages) = messages.split_once("error: ").unwrap();
        assert_eq!(messages.lines().count(), 2, "{messages}");
        assert!(
            messages.contains("\nhint: ") && messages.contains("--restart"),
            "{messages}"
        );
        messages.to_owned()
    };
    let message = refused(&format!("bench traversals {VOLUMES} --full"));
    assert!(
        message.contains("its effort was quick, this one's is full"),
        "{message}"
    );
    let message = refused(&format!("bench vessels {VOLUMES} --quick"));
    assert!(
        message.contains("its experiment was traversals"),
        "{message}"
    );
    let message = refused(&format!(
        "bench traversals {VOLUMES} --quick --protocol orbit"
    ));
    assert!(message.contains("its protocol was"), "{message}");
    // The same name, another content.
    place.done("phantom gaussian -o bump.nrrd --size 20");
    let message = refused(&format!("bench traversals {VOLUMES} --quick"));
    assert!(message.contains("its volumes was"), "{message}");
    place.done("phantom gaussian -o bump.nrrd --size 24");
    check_other_kernels(&place, &line);
    check_other_build(&place, &line);
    let begun = place.run(&format!(
        "bench convergence --quick --restart -o out {device}"
    ));
    assert!(begun.status.success(), "{}", stderr(&begun));
    assert!(!stderr(&begun).contains("resumed"));
    assert_eq!(place.json("out/results.json")["experiment"], "convergence");
}

#[test]
fn rays_that_are_stopped_resume_and_end_as_if_they_never_were() {
    let Some(device) = common::device_flag() else {
        return;
    };
    let place = Place::empty();
    let line = |folder: &str| format!("bench rays --rays 300000 -o {folder} {device}");
    let (code, messages) = stopped(&place, &line("out"), "out", 1, "TERM");
    assert_eq!(code, 75, "{messages}");
    assert!(
        messages.contains("error: stopped before the end; "),
        "{messages}"
    );
    let all = |folder: &str| {
        rows(&place, folder).pop().unwrap()["rays"]
            .as_f64()
            .unwrap()
    };
    assert!((50_000.0..300_000.0).contains(&all("out")));
    let output = place.run(&line("out"));
    let messages = stderr(&output);
    assert!(output.status.success(), "{messages}");
    assert!(messages.contains("resumed: "), "{messages}");
    assert_eq!(all("out"), 300_000.0);
    place.done(&line("other"));
    assert_eq!(rows(&place, "out"), rows(&place, "other"));
}

#[test]
fn what_an_older_run_has_found_is_not_taken_for_this_ones() {
    let Some(device) = common::device_flag() else {
        return;
    };
    let place = place();
    place.done(&format!("bench convergence -o out {device}"));
    assert!(place.path("out/report.html").exists());
    let line = format!("bench traversals {VOLUMES} --quick -o out {device}");
    let (code, messages) = stopped(&place, &line, "out", 1, "KILL");
    assert_eq!(code, -1, "{messages}");
    assert!(!place.path("out/report.html").exists());
    let results = place.path("out/results.json");
    if results.exists() {
        assert_eq!(place.json("out/results.json")["experiment"], "traversals");
    }
}

#[test]
fn a_line_torn_by_a_crash_is_measured_again() {
    let Some(device) = common::device_flag() else {
        return;
    };
    let place = place();
    let line = format!("bench traversals {VOLUMES} --quick -o out {device}");
    // No signal that could be caught.
    let (code, _) = stopped(&place, &line, "out", 3, "KILL");
    assert_eq!(code, -1);
    let path = place.path("out/journal.jsonl");
    let bytes = std::fs::read(&path).unwrap();
    std::fs::write(&path, &bytes[..bytes.len() - 7]).unwrap();
    let output = place.run(&line);
    let messages = stderr(&output);
    assert!(output.status.success(), "{messages}");
    assert!(
        messages.contains("units of work were measured before"),
        "{messages}"
    );
    assert_eq!(rows(&place, "out").len(), ROWS);
}
