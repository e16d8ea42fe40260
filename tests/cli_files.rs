//! The files that the program reads and writes: what is checked before the work, what is never
//! written over, what a stored scene says of its volume.

mod cli_place;

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
    let said = place.refused(
        "render ball.nrrd -o a.png --stats ball.nrrd --device reference",
        2,
    );
    assert!(said.contains("ball.nrrd"), "{said}");
    assert_eq!(std::fs::read(place.path("ball.nrrd")).unwrap(), before);
    // Nor what else is read, nor one output by the other, by whatever way.
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
        let said = place.refused(&line(volume, &format!("./sub/{data}")), 2);
        assert!(said.contains("this file is read"), "{said}");
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
        let said = place.refused(&line, 2);
        assert!(said.contains("this file is read"), "{said}");
    }
    // The control.
    place.done(&format!(
        "render a.hdr -o a.png --iso 8 --stats b.img {REFERENCE}"
    ));
}

#[test]
fn a_stored_scene_renders_from_another_folder() {
    let place = Place::with_ball();
    for folder in ["sub", "elsewhere"] {
        std::fs::create_dir(place.path(folder)).unwrap();
    }
    std::fs::rename(place.path("ball.nrrd"), place.path("sub/ball.nrrd")).unwrap();
    place.done(&format!(
        "render sub/ball.nrrd -o a.png --iso 100 {REFERENCE}"
    ));
    let metadata = angioray::frame::read_metadata(&place.path("a.png")).unwrap();
    let scene = &metadata.iter().find(|(key, _)| key == "scene").unwrap().1;
    place.write("elsewhere/a.toml", scene);
    let again = |scene: &str| {
        let line = format!("render --scene {scene} -o again.png --device reference");
        let mut command = place.command(&line);
        command.current_dir(place.path("elsewhere"));
        command.output().unwrap()
    };
    let output = again("a.toml");
    assert!(output.status.success(), "{}", stderr(&output));
    let bytes = |name: &str| std::fs::read(place.path(name)).unwrap();
    assert_eq!(bytes("elsewhere/again.png"), bytes("a.png"));
    // The control: a scene that names its volume as the command line did is relative to itself.
    let relative: String = scene
        .lines()
        .map(|line| match line.starts_with("volume = ") {
            true => "volume = 'sub/ball.nrrd'\n".to_owned(),
            false => format!("{line}\n"),
        })
        .collect();
    assert_ne!(&relative, scene);
    place.write("elsewhere/b.toml", &relative);
    assert_eq!(again("b.toml").status.code(), Some(65));
}

#[test]
fn a_missing_folder_is_said_before_the_volume_is_read() {
    let place = Place::empty();
    // The volume is missing too; what is checked first is what is said.
    let said = place.refused("render none.nrrd -o no/a.png --device reference", 74);
    assert!(said.contains("no/a.png"), "{said}");
    let said = place.refused("render none.nrrd -o a.png --device reference", 65);
    assert!(said.contains("none.nrrd"), "{said}");
}

#[cfg(target_os = "linux")]
#[test]
fn a_folder_that_takes_no_files_is_said_before_the_volume_is_read() {
    let place = Place::empty();
    for line in [
        "render none.nrrd -o /proc/a.png",
        "render none.nrrd -o a.png --stats /proc/a.json",
        "phantom sphere -o /proc/a.nrrd",
    ] {
        let said = place.refused(line, 74);
        assert!(said.contains("'/proc' takes no files"), "{said}");
        assert!(!said.contains("mkdir"), "{said}");
    }
    // The control: a missing folder has its cure.
    let said = place.refused("render none.nrrd -o no/a.png", 74);
    assert!(said.contains("mkdir -p 'no'"), "{said}");
}

#[test]
fn a_picture_too_large_for_its_format_is_refused_before_rendering() {
    let place = Place::with_ball();
    let line = |name: &str, size: &str| {
        format!("render ball.nrrd -o {name} --iso 100 --device reference --size {size} --zoom 0.01")
    };
    let said = place.refused(&line("a.webp", "16384x1"), 2);
    assert!(said.contains("16383") && said.contains("16384x1"), "{said}");
    // The controls: one less, and another format.
    place.done(&line("a.webp", "16383x1"));
    place.done(&line("a.jpg", "16384x1"));
}

#[test]
fn a_vessel_tree_s_place_is_checked_before_it_is_grown() {
    let place = Place::empty();
    std::fs::create_dir(place.path("a.tree.json")).unwrap();
    // What is checked first is what is said: this tree cannot be grown either.
    let said = place.refused("phantom vessels -o a.nrrd --size 16 --radius -1", 74);
    assert!(said.contains("a.tree.json"), "{said}");
    // The controls: another name has another tree, another kind has none.
    let said = place.refused("phantom vessels -o b.nrrd --size 16 --radius -1", 2);
    assert!(said.contains("radius"), "{said}");
    place.done("phantom sphere -o a.nrrd --size 8");
}

#[cfg(target_os = "linux")]
#[test]
fn a_stopped_command_says_so_and_leaves_no_half_of_a_file() {
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
        let said = stderr(&output);
        assert_eq!(output.status.code(), Some(75), "{line}: {said}");
        let stopped = "error: stopped before the end; no file is left half-written\nhint: ";
        assert!(said.contains(stopped), "{line}: {said}");
        assert_eq!(place.files(), before, "{line}");
    }
    // The control: what nobody stops is written.
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
fn a_link_to_stdout_whose_reader_has_gone_is_no_error() {
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
