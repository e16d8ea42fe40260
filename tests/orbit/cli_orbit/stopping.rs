//! Stopped by signals, and resumed.
#![cfg(unix)]

use std::fs;
use std::process::{Command, Output, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use angioray::frame::read_metadata;

use super::{REFERENCE, common, contents, names, pixels, place};
use crate::cli_place::{Place, stderr, terminate};

/// Waits until a folder's files satisfy.
fn wait_for(place: &Place, folder: &str, satisfied: impl Fn(&[String]) -> bool) {
    let began = Instant::now();
    loop {
        let names: Vec<String> = fs::read_dir(place.path(folder))
            .into_iter()
            .flatten()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        if satisfied(&names) {
            return;
        }
        assert!(began.elapsed() < Duration::from_secs(60), "{names:?}");
        sleep(Duration::from_millis(2));
    }
}

#[test]
fn a_stopped_orbit_leaves_whole_frames_and_is_resumed() {
    let place = place();
    let line = |folder: &str| {
        format!("orbit v.nrrd --iso 70 --size 48 --frames 60 -o {folder}/%02d.png {REFERENCE}")
    };
    let mut command = place.command(&line("f"));
    let child = command.stderr(Stdio::piped()).spawn().unwrap();
    wait_for(&place, "f", |names| {
        names.iter().filter(|n| n.ends_with(".png")).count() >= 3
    });
    terminate(&child);
    let output = child.wait_with_output().unwrap();
    let messages = stderr(&output);
    assert_eq!(output.status.code(), Some(75), "{messages}");
    assert!(
        messages.contains("stopped early: ") && messages.contains("--resume"),
        "{messages}"
    );
    let stopped = contents(&place, "f");
    assert!((3..60).contains(&stopped.len()), "{}", stopped.len());
    // In order, each of them whole.
    let numbers: Vec<u32> = (0..stopped.len() as u32).collect();
    assert_eq!(stopped.keys().cloned().collect::<Vec<_>>(), names(&numbers));
    for name in stopped.keys() {
        assert_eq!(pixels(&place.path(&format!("f/{name}"))).len(), 48 * 48 * 3);
    }
    assert!(
        messages.contains(&format!("{} of 60 frames", stopped.len())),
        "{messages}"
    );

    let messages = stderr(&place.run(&format!("{} --resume", line("f"))));
    let (made, kept) = (60 - stopped.len(), stopped.len());
    let counted = format!(": {made} frames, {kept} existed");
    assert!(messages.contains(&counted), "{messages}");
    place.done(&line("whole"));
    assert_eq!(contents(&place, "f"), contents(&place, "whole"));
}

#[test]
fn a_stopped_animation_keeps_its_frames_and_is_resumed_to_the_same_bytes() {
    let place = place();
    fs::create_dir(place.path("f")).unwrap();
    let has_ffmpeg = Command::new("ffmpeg").arg("-version").output().is_ok();
    let formats = ["gif", "apng", "mp4", "webm"];
    for format in formats.into_iter().take(if has_ffmpeg { 4 } else { 2 }) {
        let line = |name: &str| {
            format!("orbit v.nrrd --iso 70 --size 48 --frames 40 -o {name}.{format} {REFERENCE}")
        };
        let frames = format!("f/a.{format}.frames");
        let output = stopped(&place, &line("f/a"), &frames, |names| {
            names.iter().filter(|name| name.ends_with(".png")).count() >= 3
        });
        let messages = stderr(&output);
        assert_eq!(output.status.code(), Some(75), "{messages}");
        let made = contents(&place, &frames).len();
        assert!((3..40).contains(&made), "{made}");
        let counted =
            format!("stopped early: {made} of 40 frames are finished and saved in {frames}");
        assert!(
            messages.contains(&counted) && messages.contains("--resume"),
            "{messages}"
        );
        let names = |folder: &str| -> Vec<_> {
            let entries = fs::read_dir(place.path(folder)).unwrap();
            entries.map(|entry| entry.unwrap().file_name()).collect()
        };
        assert_eq!(names("f"), [format!("a.{format}.frames").as_str()]);

        // A frame that is torn is made again.
        fs::write(place.path(&format!("{frames}/000001.png")), "torn").unwrap();
        let messages = stderr(&place.run(&format!("{} --resume", line("f/a"))));
        let counted = format!(": {} frames, {} existed", 41 - made, made - 1);
        assert!(messages.contains(&counted), "{messages}");
        assert_eq!(names("f"), [format!("a.{format}").as_str()]);
        place.done(&line("whole"));
        let bytes = |name: &str| fs::read(place.path(&format!("{name}.{format}"))).unwrap();
        assert!(bytes("f/a") == bytes("whole"), "{format}");
        fs::remove_file(place.path(&format!("f/a.{format}"))).unwrap();
    }
}

#[test]
fn finished_frames_of_an_animation_are_joined_and_others_are_made_anew() {
    let place = place();
    let line = |zoom: u32| {
        format!("orbit v.nrrd --iso 70 --size 16 --frames 4 --zoom {zoom} -o a.gif {REFERENCE}")
    };
    let keep = |zoom: u32| {
        let pictures = line(zoom).replace("a.gif", "a.gif.frames/%06d.png");
        place.done(&pictures);
    };
    place.done(&line(1));
    let right = fs::read(place.path("a.gif")).unwrap();
    keep(1);
    let messages = stderr(&place.run(&format!("{} --resume", line(1))));
    assert!(
        messages.contains("wrote a.gif of 4 existing frames"),
        "{messages}"
    );
    assert!(fs::read(place.path("a.gif")).unwrap() == right);
    assert!(!place.path("a.gif.frames").exists());
    // Of another scene, and without --resume; what else lies in the folder stays.
    for (zoom, resume) in [(2, "--resume"), (1, "")] {
        keep(zoom);
        fs::write(place.path("a.gif.frames/notes.txt"), "mine").unwrap();
        let messages = stderr(&place.run(&format!("{} {resume}", line(1))));
        assert!(messages.contains(": 4 frames, iso"), "{messages}");
        assert!(fs::read(place.path("a.gif")).unwrap() == right);
        let left: Vec<_> = contents(&place, "a.gif.frames").into_keys().collect();
        assert_eq!(left, ["notes.txt"]);
    }
}

/// Stopped by a signal once a folder's files satisfy.
fn stopped(
    place: &Place,
    line: &str,
    folder: &str,
    satisfied: impl Fn(&[String]) -> bool,
) -> Output {
    let mut command = place.command(line);
    let child = command.stderr(Stdio::piped()).spawn().unwrap();
    wait_for(place, folder, satisfied);
    terminate(&child);
    child.wait_with_output().unwrap()
}

#[test]
fn a_stopped_orbit_reports_what_it_made() {
    let place = place();
    let line = format!(
        "orbit v.nrrd --iso 70 --size 48 --frames 60 -o f/%02d.png --stats s.json {REFERENCE}"
    );
    let output = stopped(&place, &line, "f", |names| {
        names.iter().any(|name| name.ends_with(".png"))
    });
    assert_eq!(output.status.code(), Some(75), "{}", stderr(&output));
    let made = contents(&place, "f").len();
    let stats = place.json("s.json");
    assert_eq!(stats["frames"].as_array().unwrap().len(), made);
    assert!((1..60).contains(&made), "{made}");
}

#[test]
fn an_orbit_under_an_error_bound_is_resumed_with_the_flags_that_were_chosen() {
    let Some(device) = common::device_flag() else {
        return;
    };
    let place = place();
    let orbit = "orbit v.nrrd --mode mean --window 0,60 --size 24 --frames 400 -o f/%03d.png";
    let line = format!("{orbit} --max-error max:0.03 {device}");
    let output = stopped(&place, &line, "f", |names| {
        names.iter().filter(|n| n.ends_with(".png")).count() >= 2
    });
    let messages = stderr(&output);
    assert_eq!(output.status.code(), Some(75), "{messages}");
    let (_, hint) = messages.split_once("--resume, and with ").unwrap();
    let (flags, _) = hint.split_once(" instead of --max-error").unwrap();
    let made = contents(&place, "f").len();
    let metadata = read_metadata(&place.path("f/000.png")).unwrap();

    let messages = stderr(&place.run(&format!("{orbit} {flags} --resume {device}")));
    let counted = format!(": {} frames, {made} existed", 400 - made);
    assert!(messages.contains(&counted), "{flags}: {messages}");
    assert_eq!(read_metadata(&place.path("f/000.png")).unwrap(), metadata);
}

#[test]
fn a_second_signal_ends_it_at_once_with_the_same_status() {
    // One frame takes the reference longer than this test is patient.
    let place = place();
    let orbit = format!("orbit v.nrrd --mode mean --size 2000 --frames 3 {REFERENCE}");
    for (output, code) in [("f/%d.png", 75), ("f/%d.jpg", 1), ("f/a.apng", 75)] {
        let _ = fs::remove_dir_all(place.path("f"));
        let animation = output.ends_with(".apng");
        if animation {
            fs::create_dir(place.path("f")).unwrap();
        }
        let mut command = place.command(&format!("{orbit} -o {output}"));
        let mut child = command.stderr(Stdio::piped()).spawn().unwrap();
        // The folder is made, or the animation begun, when signals are listened to.
        let folder = place.path("f");
        let began = Instant::now();
        while !folder.exists() || animation && fs::read_dir(&folder).unwrap().next().is_none() {
            assert!(began.elapsed() < Duration::from_secs(60));
            sleep(Duration::from_millis(2));
        }
        terminate(&child);
        sleep(Duration::from_millis(300));
        // The control: the first one waits for the frame in work.
        assert!(child.try_wait().unwrap().is_none(), "{output}");
        terminate(&child);
        let ended = child.wait_with_output().unwrap();
        assert_eq!(ended.status.code(), Some(code), "{output}");
        let messages = stderr(&ended);
        let lines: Vec<&str> = messages.lines().collect();
        assert_eq!(lines.len(), 2, "{output}: {messages}");
        assert!(
            lines[0].starts_with("note: stopping after the current frame"),
            "{messages}"
        );
        assert!(lines[1].starts_with("error: stopped at once"), "{messages}");
        // Neither pictures nor what was to become one.
        let mut there: Vec<_> = fs::read_dir(&folder).unwrap().collect();
        there.retain(|entry| entry.as_ref().is_ok_and(|entry| entry.path().is_file()));
        assert!(there.is_empty(), "{output}: {there:?}");
    }
}
