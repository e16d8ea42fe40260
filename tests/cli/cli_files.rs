//! The files that the program reads and writes: what is checked before the work, what is never
//! written over, what a stored scene says of its volume.

use crate::cli_place;

#[cfg(unix)]
use std::process::Stdio;

use cli_place::{Place, stderr};
#[cfg(target_os = "linux")]
use cli_place::{terminate, wait_until_it_listens};

const REFERENCE: &str = "--device reference --size 16";

#[test]
fn a_volume_is_never_written_over() {
    let place = Place::with_ball();
    let before = std::fs::read(place.path("ball.nrrd")).unwrap();
    let message = place.refused(
        "render ball.nrrd -o a.png --stats ball.nrrd --device reference",
        2,
    );
    assert!(message.contains("ball.nrrd"), "{message}");
    assert_eq!(std::fs::read(place.path("ball.nrrd")).unwrap(), before);
    // Nor what else is read, nor one output by the other, by whatever path.
    place.write("own.toml", "points = [[1, 1, 1, 1, 0.5]]\n");
    std::fs::create_dir(place.path("sub")).unwrap();
    for line in [
        "render ball.nrrd -o a.png --stats sub/../own.toml --mode dvr --tf own.toml",
        "render ball.nrrd -o a.png --stats ./a.png",
        "render ball.nrrd -o sub/a.png --stats sub/../sub/a.png",
    ] {
        place.refused(&format!("{line} {REFERENCE}"), 2);
    }
    // The control: other files are fine.
    place.done(&format!(
        "render ball.nrrd -o a.png --stats sub/a.json --mode dvr --tf own.toml {REFERENCE}"
    ));
}

/// 4³ voxels in a file of their own, and the header that names it.
fn detached(place: &Place) {
    std::fs::create_dir(place.path("sub")).unwrap();
    std::fs::write(place.path("sub/voxels.raw"), [7; 64]).unwrap();
    std::fs::write(place.path("sub/slab1.raw"), [7; 32]).unwrap();
    std::fs::write(place.path("sub/slab2.raw"), [9; 32]).unwrap();
    let nrrd = "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 4 4 4\nencoding: raw\n";
    place.write("sub/a.nhdr", &format!("{nrrd}data file: voxels.raw\n"));
    let numbered = format!("{nrrd}data file: slab%d.raw 1 2 1\n");
    place.write("sub/b.nhdr", &numbered);
    place.write(
        "sub/a.mhd",
        "NDims = 3\nDimSize = 4 4 4\nElementType = MET_UCHAR\nElementDataFile = voxels.raw\n",
    );
}

#[test]
fn a_header_s_data_files_are_never_written_over() {
    let place = Place::empty();
    detached(&place);
    let line = |volume: &str, stats: &str| {
        format!("render sub/{volume} -o a.png --iso 8 --stats {stats} {REFERENCE}")
    };
    for (volume, data) in [
        ("a.nhdr", "voxels.raw"),
        ("a.mhd", "voxels.raw"),
        ("b.nhdr", "slab1.raw"),
        ("b.nhdr", "slab2.raw"),
    ] {
        let message = place.refused(&line(volume, &format!("./sub/{data}")), 2);
        assert!(message.contains("this file is read"), "{message}");
    }
    assert_eq!(
        std::fs::read(place.path("sub/voxels.raw")).unwrap(),
        [7; 64]
    );
    // The control: files that another header names are fine.
    place.done(&line("a.nhdr", "sub/slab1.raw"));
}

#[test]
fn both_halves_of_a_nifti_pair_are_the_volume() {
    let place = Place::empty();
    let mut header = vec![0; 348];
    header[..4].copy_from_slice(&348_i32.to_le_bytes());
    for (axis, size) in [3_i16, 4, 4, 4].into_iter().enumerate() {
        header[40 + 2 * axis..][..2].copy_from_slice(&size.to_le_bytes());
    }
    header[70] = 2; // u8
    header[72] = 8;
    for axis in 0..4 {
        header[76 + 4 * axis..][..4].copy_from_slice(&1_f32.to_le_bytes());
    }
    header[344..].copy_from_slice(b"ni1\0");
    std::fs::write(place.path("a.hdr"), header).unwrap();
    std::fs::write(place.path("a.img"), [7; 64]).unwrap();
    for (volume, stats) in [("a.hdr", "a.img"), ("a.img", "a.hdr")] {
        let line = format!("render {volume} -o a.png --iso 8 --stats {stats} {REFERENCE}");
        let message = place.refused(&line, 2);
        assert!(message.contains("this file is read"), "{message}");
    }
    // The control.
    place.done(&format!(
        "render a.hdr -o a.png --iso 8 --stats b.img {REFERENCE}"
    ));
}

/// The bytes of a file.
fn bytes(place: &Place, name: &str) -> Vec<u8> {
    std::fs::read(place.path(name)).unwrap()
}

/// Pictures of a ball of every kind, beside it: the names, by the reference.
fn pictures(place: &Place) -> [&'static str; 3] {
    for (name, flags) in [
        ("iso.png", "--iso 100 --azimuth 40 --bit-depth 16"),
        ("mip.exr", "--mode mip --window 90%,p10 --aov depth,value"),
        ("dvr.png", "--mode dvr --tf cta --background white"),
    ] {
        place.done(&format!("render ball.nrrd -o {name} {flags} {REFERENCE}"));
    }
    ["iso.png", "mip.exr", "dvr.png"]
}

#[test]
fn a_replayed_picture_is_the_same_bytes() {
    let place = Place::with_ball();
    for name in pictures(&place) {
        let metadata = angioray::frame::read_metadata(&place.path(name)).unwrap();
        let text = |key: &str| &metadata.iter().find(|(k, _)| k == key).unwrap().1;
        assert!(text("scene").contains("volume = \"ball.nrrd\"\n"), "{name}");
        assert_eq!(
            (text("content").len(), text("device").as_str()),
            (64, "reference")
        );
        // On what rendered it, unless something else is requested.
        place.done(&format!("replay {name} -o again-{name}"));
        assert_eq!(
            bytes(&place, name),
            bytes(&place, &format!("again-{name}")),
            "{name}"
        );
        // From the scene alone, as a file of options.
        let (_, extension) = name.split_once('.').unwrap();
        let same = match extension {
            "exr" => "--aov depth,value",
            _ if name == "iso.png" => "--bit-depth 16",
            _ => "",
        };
        place.done(&format!(
            "render --scene {name} -o scene.{extension} {same} --device reference"
        ));
        assert_eq!(
            bytes(&place, name),
            bytes(&place, &format!("scene.{extension}")),
            "{name}"
        );
        // The control: a flag wins over the picture's scene.
        place.done(&format!(
            "render --scene {name} -o other.{extension} {same} --device reference --zoom 1.3"
        ));
        assert_ne!(
            bytes(&place, name),
            bytes(&place, &format!("other.{extension}")),
            "{name}"
        );
    }
    place.done("replay iso.png -o eight.png --bit-depth 8");
    assert_ne!(bytes(&place, "eight.png"), bytes(&place, "iso.png"));
    place.done("orbit ball.nrrd -o f%d.png --frames 3 --iso 100 --size 8 --device reference");
    place.done("replay f2.png -o again.png");
    assert_eq!(bytes(&place, "again.png"), bytes(&place, "f2.png"));
    // Never over what is read.
    place.refused("replay iso.png -o iso.png", 2);
    place.refused("replay iso.png -o ball.nrrd", 2);
}

#[test]
fn a_replay_finds_its_volume_by_path_beside_the_picture_and_in_the_working_folder() {
    let place = Place::with_ball();
    for folder in ["sub", "moved", "work", "far"] {
        std::fs::create_dir(place.path(folder)).unwrap();
    }
    std::fs::copy(place.path("ball.nrrd"), place.path("sub/ball.nrrd")).unwrap();
    std::fs::remove_file(place.path("ball.nrrd")).unwrap();
    place.done(&format!(
        "render sub/ball.nrrd -o sub/a.png --iso 100 {REFERENCE}"
    ));
    let picture = bytes(&place, "sub/a.png");
    let replay = |folder: &str, line: &str| {
        let mut command = place.command(line);
        command.current_dir(place.path(folder));
        command.output().unwrap()
    };
    let done = |folder: &str, line: &str| {
        let output = replay(folder, line);
        assert!(output.status.success(), "{line}: {}", stderr(&output));
        assert_eq!(bytes(&place, &format!("{folder}/b.png")), picture, "{line}");
        std::fs::remove_file(place.path(&format!("{folder}/b.png"))).unwrap();
    };
    // Where the picture says; then beside the picture, wherever that is.
    done(".", "replay sub/a.png -o b.png");
    done("far", "replay ../sub/a.png -o b.png");
    std::fs::rename(place.path("sub/a.png"), place.path("moved/a.png")).unwrap();
    // Nowhere, then in the working folder.
    std::fs::rename(place.path("sub/ball.nrrd"), place.path("far/ball.nrrd")).unwrap();
    let output = replay("work", "replay ../moved/a.png -o b.png");
    let messages = stderr(&output);
    assert_eq!(output.status.code(), Some(65), "{messages}");
    assert!(
        messages.contains("its volume was not found") && messages.contains("--volume"),
        "{messages}"
    );
    done("far", "replay ../moved/a.png -o b.png");
    // Where the flag places it; the picture then names that place too.
    let output = replay(
        "work",
        "replay ../moved/a.png -o b.png --volume ../far/ball.nrrd",
    );
    assert!(output.status.success(), "{}", stderr(&output));
    let metadata = angioray::frame::read_metadata(&place.path("work/b.png")).unwrap();
    let scene = &metadata.iter().find(|(key, _)| key == "scene").unwrap().1;
    assert!(scene.contains("volume = \"../far/ball.nrrd\""), "{scene}");
    // Another volume of its name is not taken for it, and does not hide it.
    place.done("phantom ramp -o other.nrrd --size 16");
    std::fs::copy(place.path("other.nrrd"), place.path("work/ball.nrrd")).unwrap();
    let output = replay("work", "replay ../moved/a.png -o c.png");
    let messages = stderr(&output);
    assert_eq!(output.status.code(), Some(65), "{messages}");
    assert!(messages.contains("not the volume that"), "{messages}");
    assert!(!place.path("work/c.png").exists());
    std::fs::copy(place.path("far/ball.nrrd"), place.path("moved/ball.nrrd")).unwrap();
    std::fs::remove_file(place.path("work/b.png")).unwrap();
    done("work", "replay ../moved/a.png -o b.png");
    let output = replay("work", "replay ../moved/a.png -o c.png --volume ball.nrrd");
    assert_eq!(output.status.code(), Some(65), "{}", stderr(&output));
    // As a scene the picture's volume is found likewise.
    std::fs::remove_file(place.path("work/ball.nrrd")).unwrap();
    let output = replay(
        "work",
        "render --scene ../moved/a.png -o d.png --device reference",
    );
    assert!(output.status.success(), "{}", stderr(&output));
}

#[test]
fn info_prints_the_scene_that_a_picture_carries() {
    let place = Place::with_ball();
    for name in pictures(&place) {
        let metadata = angioray::frame::read_metadata(&place.path(name)).unwrap();
        let scene = &metadata.iter().find(|(key, _)| key == "scene").unwrap().1;
        let printed = place.done(&format!("info {name}"));
        assert!(printed.ends_with(scene.as_str()), "{printed}");
        assert!(printed.contains("made by angioray") && printed.contains("on reference"));
        // What is printed is itself a scene file.
        place.write("printed.toml", &printed);
        place.done("info --scene printed.toml");
        let json: serde_json::Value =
            serde_json::from_str(&place.done(&format!("info {name} --json"))).unwrap();
        assert_eq!(json["scene"]["volume"], "ball.nrrd");
        assert_eq!(json["version"], env!("CARGO_PKG_VERSION"));
        assert_eq!(json["content"].as_str().unwrap().len(), 64);
    }
    // The control: of a volume it prints what that is.
    assert!(place.done("info ball.nrrd").contains("16x16x16"));
}

#[test]
fn what_carries_no_scene_is_refused_in_one_sentence() {
    let place = Place::with_ball();
    // A picture of another program, a picture that carries nothing, a file that is neither.
    let file = std::fs::File::create(place.path("bare.png")).unwrap();
    let mut encoder = png::Encoder::new(file, 1, 1);
    encoder.set_color(png::ColorType::Grayscale);
    encoder
        .write_header()
        .unwrap()
        .write_image_data(&[7])
        .unwrap();
    place.done(&format!("render ball.nrrd -o a.jpg --iso 9 {REFERENCE}"));
    std::fs::write(place.path("latin.toml"), b"# na\xefve\niso = 9\n").unwrap();
    place.done(&format!(
        "render ball.nrrd -o whole.png --iso 9 {REFERENCE}"
    ));
    let whole = bytes(&place, "whole.png");
    std::fs::write(place.path("cut.png"), &whole[..whole.len() / 2]).unwrap();
    for (file, as_scene, as_image) in [
        ("bare.png", "carries no scene", "carries no scene"),
        ("a.jpg", "not a scene", "not a picture that carries a scene"),
        (
            "latin.toml",
            "TOML in UTF-8",
            "not a picture that carries a scene",
        ),
        (
            "ball.nrrd",
            "not a scene",
            "not a picture that carries a scene",
        ),
        ("cut.png", "not a readable PNG", "not a readable PNG"),
        ("none.png", "none.png", "none.png"),
    ] {
        let message = place.refused(&format!("render ball.nrrd -o b.png --scene {file}"), 65);
        assert!(
            message.contains(as_scene) && message.contains(file),
            "{message}"
        );
        let message = place.refused(&format!("replay {file} -o b.png"), 65);
        assert!(
            message.contains(as_image) && message.contains(file),
            "{message}"
        );
    }
    let message = place.refused("info bare.png", 65);
    assert!(message.contains("carries no scene"), "{message}");
    let message = place.refused("replay -o b.png", 2);
    assert!(message.contains("no picture was named"), "{message}");
    // The control.
    place.done("replay whole.png -o b.png");
}

#[cfg(unix)]
#[test]
fn a_scene_is_read_from_a_pipe_too() {
    let place = Place::with_ball();
    let line = format!("render ball.nrrd -o a.png --scene /dev/stdin {REFERENCE}");
    let mut child = place
        .command(&line)
        .stdin(std::process::Stdio::piped())
        .stderr(std::process::Stdio::null())
        .spawn()
        .unwrap();
    use std::io::Write;
    child
        .stdin
        .take()
        .unwrap()
        .write_all(b"iso = 100\nazimuth = 3\n")
        .unwrap();
    assert!(child.wait().unwrap().success());
    assert!(place.done("info a.png").contains("iso = 100"));
}

#[test]
fn a_missing_folder_is_reported_before_the_volume_is_read() {
    let place = Place::empty();
    // The volume is missing too; what is checked first is what is reported.
    let message = place.refused("render none.nrrd -o no/a.png --device reference", 74);
    assert!(message.contains("no/a.png"), "{message}");
    let message = place.refused("render none.nrrd -o a.png --device reference", 65);
    assert!(message.contains("none.nrrd"), "{message}");
}

#[cfg(target_os = "linux")]
#[test]
fn a_folder_that_takes_no_files_is_reported_before_the_volume_is_read() {
    let place = Place::empty();
    for line in [
        "render none.nrrd -o /proc/a.png",
        "render none.nrrd -o a.png --stats /proc/a.json",
        "phantom sphere -o /proc/a.nrrd",
    ] {
        let message = place.refused(line, 74);
        assert!(message.contains("'/proc' takes no files"), "{message}");
        assert!(!message.contains("mkdir"), "{message}");
    }
    // The control: a missing folder has its cure.
    let message = place.refused("render none.nrrd -o no/a.png", 74);
    assert!(message.contains("mkdir -p 'no'"), "{message}");
}

#[test]
fn a_picture_too_large_for_its_format_is_refused_before_rendering() {
    let place = Place::with_ball();
    let line = |name: &str, size: &str| {
        format!("render ball.nrrd -o {name} --iso 100 --device reference --size {size} --zoom 0.01")
    };
    let message = place.refused(&line("a.webp", "16384x1"), 2);
    assert!(
        message.contains("16383") && message.contains("16384x1"),
        "{message}"
    );
    // The controls: one less, and another format.
    place.done(&line("a.webp", "16383x1"));
    place.done(&line("a.jpg", "16384x1"));
}

#[test]
fn a_vessel_tree_s_place_is_checked_before_it_is_grown() {
    let place = Place::empty();
    std::fs::create_dir(place.path("a.tree.json")).unwrap();
    // What is checked first is what is reported: this tree cannot be grown either.
    let message = place.refused("phantom vessels -o a.nrrd --size 16 --radius -1", 74);
    assert!(message.contains("a.tree.json"), "{message}");
    // The controls: another name has another tree, another kind has none.
    let message = place.refused("phantom vessels -o b.nrrd --size 16 --radius -1", 2);
    assert!(message.contains("radius"), "{message}");
    place.done("phantom sphere -o a.nrrd --size 8");
}

#[cfg(target_os = "linux")]
#[test]
fn a_stopped_command_reports_it_and_leaves_no_half_of_a_file() {
    let place = Place::with_ball();
    // Each takes longer than this test is patient.
    let reference = "--device reference --mode mean --size 3000";
    let lines = [
        format!("render ball.nrrd -o a.png {reference}"),
        format!("render ball.nrrd -o a.exr --stats s.json {reference}"),
        "phantom vessels -o v.nrrd --size 400".to_owned(),
    ];
    for line in &lines {
        let before = place.files();
        let child = place.command(line).stderr(Stdio::piped()).spawn().unwrap();
        wait_until_it_listens(&child);
        terminate(&child);
        let output = child.wait_with_output().unwrap();
        let messages = stderr(&output);
        assert_eq!(output.status.code(), Some(75), "{line}: {messages}");
        let stopped = "error: stopped before the end; no file is left half-written\nhint: ";
        assert!(messages.contains(stopped), "{line}: {messages}");
        assert_eq!(place.files(), before, "{line}");
    }
    // The control: without a stop it is written.
    place.done(&format!("render ball.nrrd -o a.png {REFERENCE}"));
}

/// Killed where it cannot put anything in order, while it writes an animation.
#[cfg(unix)]
#[test]
fn what_a_killed_run_left_is_removed_by_the_next() {
    let place = Place::with_ball();
    std::fs::create_dir(place.path("f")).unwrap();
    let unfinished = || {
        let entries = std::fs::read_dir(place.path("f")).unwrap();
        let names = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap());
        names
            .filter(|name| name.starts_with(".unfinished-"))
            .count()
    };
    let animation = "orbit ball.nrrd -o f/a.gif --frames 3 --mode mean --size 3000";
    let mut run = place.command(&format!("{animation} --device reference"));
    let mut child = run.stderr(Stdio::null()).spawn().unwrap();
    let began = std::time::Instant::now();
    while unfinished() == 0 {
        assert!(began.elapsed().as_secs() < 60);
        std::thread::sleep(std::time::Duration::from_millis(2));
    }
    // The control: one that is at work keeps its own.
    place.done(&format!("render ball.nrrd -o f/a.png {REFERENCE}"));
    assert_eq!(unfinished(), 1);
    child.kill().unwrap();
    child.wait().unwrap();
    assert_eq!(unfinished(), 1);
    place.done(&format!("render ball.nrrd -o f/a.png {REFERENCE}"));
    assert_eq!(unfinished(), 0);
}

#[cfg(target_os = "linux")]
#[test]
fn a_link_to_stdout_whose_reader_has_ended_is_no_error() {
    let place = Place::with_ball();
    let link = |name: &str, device: &str| {
        std::os::unix::fs::symlink(device, place.path(name)).unwrap();
    };
    link("out.png", "/dev/stdout");
    let line = format!("render ball.nrrd -o out.png {REFERENCE}");
    let mut run = place.command(&line);
    let mut child = run
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert!(output.status.success(), "{}", stderr(&output));
    // The controls: one that reads gets the picture; a device that takes nothing is an error.
    let output = place.run(&line);
    assert!(output.status.success() && output.stdout.starts_with(b"\x89PNG"));
    link("full.png", "/dev/full");
    let output = place.run(&format!("render ball.nrrd -o full.png {REFERENCE}"));
    assert_eq!(output.status.code(), Some(74), "{}", stderr(&output));
}
