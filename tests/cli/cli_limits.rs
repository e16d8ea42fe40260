//! The program where something has no end or runs out: endless files, files that are shortened while they
//! are read, memory that is refused. It ends with a sentence and its code, never with a signal.
#![cfg(unix)]

use crate::cli_place;

use std::fs::File;
use std::os::unix::process::ExitStatusExt;
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

use cli_place::{Place, stderr};

const REFERENCE: &str = "--device reference --size 16";

#[test]
fn texts_without_an_end_are_refused() {
    let place = Place::with_ball();
    let made = Command::new("mkfifo").arg(place.path("pipe")).status();
    assert!(made.unwrap().success());
    place.write("long.toml", &"# nothing\n".repeat(110_000));
    for (file, word) in [
        ("/dev/zero", "1024 KiB"),
        ("long.toml", "1024 KiB"),
        ("pipe", "writes to it"),
    ] {
        for line in [
            format!("render ball.nrrd -o a.png --scene {file} {REFERENCE}"),
            format!("info ball.nrrd --scene {file}"),
            format!("render ball.nrrd -o a.png --mode dvr --tf {file} {REFERENCE}"),
            format!("compare ball.nrrd -o out --configs {file} --device reference"),
        ] {
            let message = place.refused(&line, 65);
            assert!(
                message.contains(word) && message.contains(file),
                "{line}: {message}"
            );
        }
    }
    for volume in ["/dev/zero", "pipe"] {
        let message = place.refused(&format!("info {volume}"), 65);
        assert!(message.contains("regular file"), "{message}");
    }
    // The control: a text of the allowed length.
    place.write("fine.toml", &"# nothing\n".repeat(100_000));
    place.done(&format!(
        "render ball.nrrd -o a.png --scene fine.toml {REFERENCE}"
    ));
    let settings = "[[setting]]\nname = \"x\"\n".repeat(257);
    place.write("many.toml", &settings);
    let message = place.refused(
        "compare ball.nrrd -o out --configs many.toml --device reference",
        2,
    );
    assert!(message.contains("256"), "{message}");
}

/// Runs the program until `file` is among what it has mapped.
#[cfg(target_os = "linux")]
fn until_mapped(command: &mut Command, file: &str) -> std::process::Child {
    let child = command
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let began = Instant::now();
    let maps = format!("/proc/{}/maps", child.id());
    while !std::fs::read_to_string(&maps).is_ok_and(|maps| maps.contains(file)) {
        assert!(began.elapsed() < Duration::from_secs(60), "never mapped");
        std::thread::sleep(Duration::from_micros(200));
    }
    child
}

#[cfg(target_os = "linux")]
#[test]
fn a_volume_that_is_shortened_while_it_is_read_ends_the_program_in_words() {
    let place = Place::empty();
    let name = "sparse_1024x1024x1024_u8.raw";
    let file = File::create(place.path(name)).unwrap();
    file.set_len(1 << 30).unwrap();
    let child = until_mapped(&mut place.command(&format!("info {name}")), name);
    file.set_len(4096).unwrap();
    let output = child.wait_with_output().unwrap();
    let messages = stderr(&output);
    assert_eq!(output.status.code(), Some(74), "{messages}");
    assert!(
        messages.contains(&format!("error: {name}: the file was shortened")),
        "{messages}"
    );
    assert!(messages.contains("hint: "), "{messages}");
    assert!(output.stdout.is_empty());
}

/// Runs with at most so many KiB of address space.
fn limited(place: &Place, kib: u64, line: &str) -> Output {
    let program = env!("CARGO_BIN_EXE_angioray");
    Command::new("sh")
        .args(["-c", &format!("ulimit -v {kib}; exec {program} {line}")])
        .current_dir(place.path("."))
        .env("RAYON_NUM_THREADS", "2")
        .output()
        .unwrap()
}

/// From where the program can be started at all up to where the line works: in steps, so that the memory
/// runs out in every phase. Gives how often it ran out.
#[cfg(target_os = "linux")]
fn starved(place: &Place, line: &str, step: u64) -> u32 {
    let mut kib = 8 << 10;
    // A loader that cannot map the program's libraries is not the program's fault.
    while !limited(place, kib, "--version").status.success() {
        kib += step;
        assert!(kib < 1 << 20, "the program needs a GiB for its version");
    }
    let mut short = 0;
    loop {
        let output = limited(place, kib, line);
        let messages = stderr(&output);
        if output.status.success() {
            return short;
        }
        assert_eq!(
            output.status.signal(),
            None,
            "{line}, {kib} KiB: {messages}"
        );
        assert_eq!(
            output.status.code(),
            Some(74),
            "{line}, {kib} KiB: {messages}"
        );
        assert!(
            messages.contains("error: "),
            "{line}, {kib} KiB: {messages}"
        );
        short += 1;
        kib += step;
        assert!(kib < 2 << 20, "{line}: {messages}");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn memory_that_runs_out_ends_the_program_in_words() {
    let place = Place::empty();
    place.done("phantom sphere -o ball.nrrd --size 160 --type f32 --gzip");
    for line in [
        "info ball.nrrd".to_owned(),
        "info ball.nrrd --smooth 2".to_owned(),
        "render ball.nrrd -o a.png --mode mip --device reference --size 256".to_owned(),
    ] {
        let short = starved(&place, &line, 6 << 10);
        assert!(short > 2, "{line}: {short}");
    }
}
