//! `angioray orbit`: every frame is what `render` makes, in pictures, animations and shards; stopped
//! and gone on with.

mod cli_place;
mod common;

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use angioray::frame::read_metadata;
use cli_place::{Place, stderr};
use image::AnimationDecoder;

const REFERENCE: &str = "--device reference";

/// A folder with vessels of 24³ voxels, which look different from every side.
fn place() -> Place {
    let place = Place::empty();
    place.done("phantom vessels -o v.nrrd --size 24 --seed 2");
    place
}

/// A folder's files by name.
fn contents(place: &Place, folder: &str) -> BTreeMap<String, Vec<u8>> {
    let entries = fs::read_dir(place.path(folder)).unwrap();
    let file = |entry: fs::DirEntry| {
        let name = entry.file_name().into_string().unwrap();
        (name, fs::read(entry.path()).unwrap())
    };
    entries.map(|entry| file(entry.unwrap())).collect()
}

fn names(numbers: &[u32]) -> Vec<String> {
    numbers.iter().map(|k| format!("{k:02}.png")).collect()
}

/// A picture's RGB bytes.
fn pixels(path: &Path) -> Vec<u8> {
    let file = std::io::BufReader::new(fs::File::open(path).unwrap());
    let mut reader = png::Decoder::new(file).read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    reader.next_frame(&mut pixels).unwrap();
    reader.finish().unwrap();
    pixels
}

/// Mean and greatest difference of two pictures, in levels.
fn apart(a: &[u8], b: &[u8]) -> (f64, u8) {
    assert_eq!(a.len(), b.len());
    let differences = || a.iter().zip(b).map(|(a, b)| a.abs_diff(*b));
    let sum: f64 = differences().map(f64::from).sum();
    (sum / a.len() as f64, differences().max().unwrap())
}

/// Made again, those named in `again`.
fn every_frame_is_a_rendering(device: &str, again: &[u32]) {
    let place = place();
    let scene = "v.nrrd --iso 70 --size 24x20 --elevation 15";
    place.done(&format!(
        "orbit {scene} -o f/%02d.png --frames 5 --axis z {device}"
    ));
    let frames = contents(&place, "f");
    assert_eq!(
        frames.keys().cloned().collect::<Vec<_>>(),
        names(&[0, 1, 2, 3, 4])
    );
    for &k in again {
        let name = format!("{k:02}.png");
        // Its own scene makes it again, byte for byte.
        let metadata = read_metadata(&place.path(&format!("f/{name}"))).unwrap();
        let (_, own) = metadata.iter().find(|(key, _)| key == "scene").unwrap();
        place.write("own.toml", own);
        place.done(&format!("render --scene own.toml -o own.png {device}"));
        assert_eq!(
            fs::read(place.path("own.png")).unwrap(),
            frames[&name],
            "{k}"
        );
        // And it is seen from where it should be.
        let named = format!("render {scene} --azimuth {} -o named.png {device}", 72 * k);
        place.done(&named);
        let (mean, _) = apart(
            &pixels(&place.path("named.png")),
            &pixels(&place.path(&format!("f/{name}"))),
        );
        assert!(mean < 0.05, "{k}: {mean}");
        // The control: from ten degrees farther it is another picture.
        place.done(&format!(
            "render {scene} --azimuth {} -o farther.png {device}",
            72 * k + 10
        ));
        let (mean, _) = apart(
            &pixels(&place.path("farther.png")),
            &pixels(&place.path(&format!("f/{name}"))),
        );
        assert!(mean > 1.0, "{k}: {mean}");
    }
    // A whole turn is the first frame again: frame 1 of 2 that make two turns.
    place.done(&format!(
        "orbit {scene} -o closed/%02d.png --frames 2 --degrees 720 --axis z {device}"
    ));
    let closed = contents(&place, "closed");
    assert_eq!(closed["00.png"], frames["00.png"]);
    assert_eq!(closed["01.png"], frames["00.png"]);
    assert_ne!(frames["01.png"], frames["00.png"]);
}

#[test]
fn every_frame_is_a_rendering_by_the_reference() {
    every_frame_is_a_rendering(REFERENCE, &[0, 1, 2, 3, 4]);
}

#[test]
fn every_frame_is_a_rendering_on_the_device() {
    if let Some(device) = common::device() {
        every_frame_is_a_rendering(&format!("--device {}", device.info().id), &[3]);
    }
}

#[test]
fn shards_together_are_the_whole() {
    let place = place();
    let orbit = format!("orbit v.nrrd --iso 70 --size 16 --frames 7 {REFERENCE}");
    place.done(&format!("{orbit} -o whole/%02d.png"));
    let mut made = Vec::new();
    for shard in 0..3 {
        place.done(&format!("{orbit} -o parts/%02d.png --shard {shard}/3"));
        made.push(contents(&place, "parts").len());
    }
    assert_eq!(made, [3, 5, 7]);
    assert_eq!(contents(&place, "parts"), contents(&place, "whole"));

    let by_slurm = |id: &str| {
        let mut command = place.command(&format!("{orbit} -o auto/%02d.png --shard auto"));
        command.env("SLURM_ARRAY_TASK_ID", id);
        command.env("SLURM_ARRAY_TASK_MIN", "4");
        command.env("SLURM_ARRAY_TASK_COUNT", "3");
        command.output().unwrap()
    };
    let output = by_slurm("5");
    assert!(output.status.success(), "{}", stderr(&output));
    assert!(stderr(&output).contains("shard 1/3 by SLURM_ARRAY_TASK_ID"));
    let auto: Vec<String> = contents(&place, "auto").into_keys().collect();
    assert_eq!(auto, names(&[1, 4]));
    // The control: a task beyond the array is refused.
    assert_eq!(by_slurm("9").status.code(), Some(2));
}

#[test]
fn resuming_makes_what_is_missing_torn_or_of_another_scene() {
    let place = place();
    for (extension, layers) in [("png", ""), ("exr", "--aov depth")] {
        let line = |folder: &str, iso: u32| {
            format!(
                "orbit v.nrrd --iso {iso} --size 16 --frames 8 {layers} \
                 -o {folder}/%02d.{extension} {REFERENCE}"
            )
        };
        let (whole, part) = (format!("{extension}-whole"), format!("{extension}-part"));
        place.done(&line(&whole, 70));
        place.done(&line(&part, 70));
        let path = |k: u32| place.path(&format!("{part}/{k:02}.{extension}"));
        let kept = |k: u32| fs::metadata(path(k)).unwrap().modified().unwrap();
        let before: Vec<_> = [0, 4, 7].map(kept).into();
        // Missing; without its end; with a byte of its picture changed; empty; another scene's.
        fs::remove_file(path(1)).unwrap();
        let bytes = fs::read(path(2)).unwrap();
        fs::write(path(2), &bytes[..bytes.len() - 20]).unwrap();
        let mut bytes = fs::read(path(3)).unwrap();
        let at = bytes.len() - 40;
        bytes[at] ^= 0x55;
        if extension == "png" {
            fs::write(path(3), &bytes).unwrap();
        } else {
            // An EXR has no check sums: cut within its pixels instead.
            fs::write(path(3), &bytes[..at]).unwrap();
        }
        fs::write(path(5), "").unwrap();
        place.done(&line("other", 90));
        fs::copy(place.path(&format!("other/06.{extension}")), path(6)).unwrap();

        let output = place.run(&format!("{} --resume", line(&part, 70)));
        let said = stderr(&output);
        assert!(output.status.success(), "{said}");
        assert!(said.contains(": 5 frames, 3 were there"), "{said}");
        assert_eq!(contents(&place, &part), contents(&place, &whole));
        assert_eq!(before, [0, 4, 7].map(kept));
        // Nothing is left to do; of another scene, or coded otherwise, all is.
        let said = stderr(&place.run(&format!("{} --resume", line(&part, 70))));
        assert!(said.contains("nothing to do, 8 were there"), "{said}");
        let said = stderr(&place.run(&format!("{} --resume --zoom 2", line(&part, 70))));
        assert!(said.contains(": 8 frames, iso"), "{said}");
    }
    let eight = "orbit v.nrrd --iso 70 --size 16 --frames 8";
    let said = stderr(&place.run(&format!(
        "{eight} -o png-whole/%02d.png --bit-depth 16 --resume {REFERENCE}"
    )));
    assert!(said.contains(": 8 frames, iso"), "{said}");
    // Without --resume frames are made anew.
    let said = stderr(&place.run(&format!("{eight} -o png-part/%02d.png {REFERENCE}")));
    assert!(said.contains(": 8 frames, iso"), "{said}");
}

#[cfg(unix)]
fn terminate(child: &Child) {
    let mut kill = Command::new("kill");
    kill.args(["-TERM", &child.id().to_string()]);
    assert!(kill.status().unwrap().success());
}

/// Waits until a folder's files satisfy.
#[cfg(unix)]
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

#[cfg(unix)]
#[test]
fn a_stopped_orbit_leaves_whole_frames_and_is_gone_on_with() {
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
    let said = stderr(&output);
    assert_eq!(output.status.code(), Some(75), "{said}");
    assert!(
        said.contains("stopped early: ") && said.contains("--resume"),
        "{said}"
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
        said.contains(&format!("{} of 60 frames", stopped.len())),
        "{said}"
    );

    let said = stderr(&place.run(&format!("{} --resume", line("f"))));
    let (made, kept) = (60 - stopped.len(), stopped.len());
    let counted = format!(": {made} frames, {kept} were there");
    assert!(said.contains(&counted), "{said}");
    place.done(&line("whole"));
    assert_eq!(contents(&place, "f"), contents(&place, "whole"));
}

#[cfg(unix)]
#[test]
fn a_stopped_animation_leaves_nothing() {
    let place = place();
    fs::create_dir(place.path("f")).unwrap();
    let line = format!("orbit v.nrrd --iso 70 --size 48 --frames 400 -o f/a.apng {REFERENCE}");
    let child = place.command(&line).stderr(Stdio::piped()).spawn().unwrap();
    wait_for(&place, "f", |names| !names.is_empty());
    terminate(&child);
    let output = child.wait_with_output().unwrap();
    let said = stderr(&output);
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(
        said.contains("was not written") && said.contains("hint: "),
        "{said}"
    );
    assert!(contents(&place, "f").is_empty());
}

#[test]
fn animations_hold_the_frames_of_the_pictures() {
    let place = place();
    let orbit =
        format!("orbit v.nrrd --iso 70 --color #f08030 --size 31x23 --frames 6 {REFERENCE}");
    place.done(&format!("{orbit} -o f/%02d.png"));
    let frame = |k: usize| pixels(&place.path(&format!("f/{k:02}.png")));
    let frames: Vec<Vec<u8>> = (0..6).map(frame).collect();
    // The control of what follows: the frames are well apart.
    for k in 1..6 {
        assert!(apart(&frames[k], &frames[k - 1]).0 > 2.0);
    }

    place.done(&format!("{orbit} -o a.apng --fps 12.5"));
    let file = fs::File::open(place.path("a.apng")).unwrap();
    let mut reader = png::Decoder::new(std::io::BufReader::new(file))
        .read_info()
        .unwrap();
    let control = *reader.info().animation_control().unwrap();
    assert_eq!((control.num_frames, control.num_plays), (6, 0));
    for (k, frame) in frames.iter().enumerate() {
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut pixels).unwrap();
        assert!(&pixels == frame, "{k}");
        let shown = reader.info().frame_control().unwrap();
        let seconds = f64::from(shown.delay_num) / f64::from(shown.delay_den);
        assert!((seconds - 0.08).abs() < 1e-9, "{seconds}");
    }
    let metadata = read_metadata(&place.path("a.apng")).unwrap();
    let of_frame_0 = read_metadata(&place.path("f/00.png")).unwrap();
    assert_eq!(metadata, of_frame_0);

    place.done(&format!("{orbit} -o a.gif --fps 25"));
    let file = std::io::BufReader::new(fs::File::open(place.path("a.gif")).unwrap());
    let decoder = image::codecs::gif::GifDecoder::new(file).unwrap();
    let decoded = decoder.into_frames().collect_frames().unwrap();
    assert_eq!(decoded.len(), 6);
    for (k, shown) in decoded.iter().enumerate() {
        assert_eq!(shown.delay().numer_denom_ms(), (40, 1));
        let rgb = image::DynamicImage::from(shown.buffer().clone()).into_rgb8();
        let (mean, most) = apart(&rgb.into_raw(), &frames[k]);
        assert!(mean < 1.0 && most < 32, "{k}: {mean} {most}");
    }
}

#[test]
fn videos_hold_the_frames_of_the_pictures() {
    let place = place();
    let orbit =
        format!("orbit v.nrrd --iso 70 --color #f08030 --size 95x71 --frames 6 {REFERENCE}");
    if Command::new("ffmpeg").arg("-version").output().is_err() {
        eprintln!("skipped: there is no ffmpeg");
        return;
    }
    place.done(&format!("{orbit} -o f/%02d.png"));
    for name in ["a.mp4", "a.webm"] {
        place.done(&format!("{orbit} -o {name} --fps 10"));
        let decoded = Command::new("ffmpeg")
            .args(["-loglevel", "error", "-i"])
            .arg(place.path(name))
            .args(["-vf", "scale=in_color_matrix=bt709", "-pix_fmt", "rgb24"])
            .args(["-f", "rawvideo", "-"])
            .output()
            .unwrap();
        assert_eq!(stderr(&decoded), "");
        // The sides are made even.
        let size = 96 * 72 * 3;
        assert_eq!(decoded.stdout.len(), 6 * size, "{name}");
        for k in 0..6 {
            let shown = &decoded.stdout[k * size..][..size];
            let rows = shown.chunks_exact(96 * 3).take(71);
            let shown: Vec<u8> = rows.flat_map(|row| &row[..95 * 3]).copied().collect();
            let frame = |k: usize| pixels(&place.path(&format!("f/{k:02}.png")));
            let (mean, _) = apart(&shown, &frame(k));
            let (other, _) = apart(&shown, &frame((k + 1) % 6));
            assert!(
                mean < 2.0 && other > 2.0 * mean,
                "{name} {k}: {mean} {other}"
            );
        }
    }
}

#[test]
fn without_ffmpeg_a_video_is_refused_before_any_work() {
    let place = place();
    let run = |name: &str| {
        let line = format!("orbit v.nrrd --iso 70 --size 16 --frames 2 -o {name} {REFERENCE}");
        place.command(&line).env("PATH", "").output().unwrap()
    };
    for name in ["a.mp4", "a.webm"] {
        let output = run(name);
        let said = stderr(&output);
        assert_eq!(output.status.code(), Some(1), "{said}");
        assert!(
            said.contains("ffmpeg") && said.contains("hint: install it"),
            "{said}"
        );
        assert!(!place.path(name).exists());
    }
    // The control: what needs no ffmpeg is written.
    assert!(run("a.gif").status.success());
}

#[test]
fn orbits_that_make_no_sense_are_refused() {
    let place = place();
    place.write("1.png", "iso = 70\n");
    place.write("busy", "");
    for (line, code, reason) in [
        ("-o %02d.png", 2, "--frames"),
        ("--frames 3 -o a.png", 2, "every frame would have this name"),
        ("--frames 3 -o a%s.png", 2, "after %"),
        (
            "--frames 3 -o %d/a.png",
            2,
            "every frame would have this name",
        ),
        ("--frames 3 -o %d%d.png", 2, "one number"),
        ("--frames 3 -o %d.tga", 2, ".tga"),
        ("--frames 0 -o %d.png", 2, "an orbit of 0 frames"),
        ("--frames -1 -o %d.png", 2, "--frames"),
        ("--frames 3 -o %d.png --degrees far", 2, "--degrees"),
        ("--frames 3 -o %d.png --axis w", 2, "is not an axis"),
        ("--frames 3 -o %d.png --axis 0,0,0", 2, "is not an axis"),
        ("--frames 3 -o %d.png --shard 3/3", 2, "counts from 0"),
        ("--frames 3 -o %d.png --shard auto", 2, "environment"),
        (
            "--frames 3 -o %d.png --fps 10",
            2,
            "'--fps' is for animations",
        ),
        ("--frames 3 -o a.gif --fps 60", 2, "at most 50"),
        ("--frames 3 -o a.gif --fps 0", 2, "frames per second"),
        ("--frames 3 -o a.gif --resume", 2, "'--resume' does not go"),
        (
            "--frames 3 -o a.apng --shard 0/2",
            2,
            "'--shard' does not go",
        ),
        ("--frames 3 -o a.apng --aov depth", 2, "--aov"),
        ("--frames 3 -o %d.jpg --resume", 2, "'--resume' does not go"),
        (
            "--frames 3 -o %d.webp --resume",
            2,
            "'--resume' does not go",
        ),
        ("--frames 3 -o %d.png --scene 1.png", 2, "this file is read"),
        (
            "--frames 3 -o %d.png --stats 2.png",
            2,
            "where the statistics go",
        ),
        ("--frames 3 -o a.gif --stats a.gif", 2, "a file each"),
        ("--frames 3 -o busy/%d.png", 1, "is not a folder"),
        ("--frames 3 -o busy/more/%d.png", 1, "is not a folder"),
        ("--frames 3 -o none/a.gif", 1, "no folder"),
    ] {
        let said = place.refused(&format!("orbit v.nrrd {line} {REFERENCE}"), code);
        assert!(said.contains(reason), "{line}: {said}");
    }
    place.refused(
        &format!("orbit none.nrrd --frames 3 -o f/%d.png {REFERENCE}"),
        1,
    );
}

#[test]
fn the_statistics_hold_every_frame() {
    let Some(device) = common::device() else {
        return;
    };
    let place = place();
    place.write(
        "orbit.toml",
        "frames = 5\ndegrees = 180\naxis = [0, 0, 2]\nshard = '1/2'\n",
    );
    place.done(&format!(
        "orbit v.nrrd --scene orbit.toml --iso 70 --size 24 -o f/%02d.png --stats s.json --device {}",
        device.info().id
    ));
    let stats = place.json("s.json");
    assert_eq!(stats["command"], "orbit");
    assert_eq!(stats["orbit"]["frames"], 5);
    assert_eq!(stats["orbit"]["axis"], serde_json::json!([0.0, 0.0, 1.0]));
    assert_eq!(stats["orbit"]["shard"], "1/2");
    let frames = stats["frames"].as_array().unwrap();
    let indices: Vec<_> = frames
        .iter()
        .map(|f| f["index"].as_u64().unwrap())
        .collect();
    assert_eq!(indices, [1, 3]);
    assert_eq!(frames[1]["degrees"], 108.0);
    for key in ["render_ms", "read_back_ms", "encode_ms"] {
        let all = key.trim_end_matches("_ms");
        let sum: f64 = frames.iter().map(|f| f[key].as_f64().unwrap()).sum();
        assert!(sum > 0.0, "{key}");
        assert!(
            (stats["times_ms"][all].as_f64().unwrap() - sum).abs() < 1e-6,
            "{key}"
        );
    }
    for key in ["rays", "samples", "nodes", "hits"] {
        let sum: u64 = frames
            .iter()
            .map(|f| f["counts"][key].as_u64().unwrap())
            .sum();
        assert_eq!(stats["counts"][key], sum, "{key}");
        assert!(sum > 0, "{key}");
    }
    // The scene is that of the first frame of all.
    place.done(&format!(
        "render v.nrrd --iso 70 --size 24 -o a.png --stats a.json --device {}",
        device.info().id
    ));
    assert_eq!(stats["scene"], place.json("a.json")["scene"]);
    assert_ne!(frames[0]["counts"], place.json("a.json")["counts"]);
}

#[test]
fn an_error_bound_chooses_one_setting_for_the_whole_orbit() {
    let Some(device) = common::device() else {
        return;
    };
    let place = place();
    let device = format!("--device {}", device.info().id);
    let orbit = "orbit v.nrrd --mode mean --window 0,60 --size 24 --frames 5";
    place.done(&format!(
        "{orbit} --max-error max:0.03 -o f/%02d.png --stats s.json {device}"
    ));
    place.done(&format!("{orbit} -o truth/%02d.png {REFERENCE}"));
    place.done(&format!("{orbit} -o coarse/%02d.png --step 8 {device}"));
    let stats = place.json("s.json");
    assert_eq!(stats["max_error"]["met"], true);
    assert_eq!(stats["max_error"]["verified"]["views"], 4);
    let how = |k: u32| {
        let metadata = read_metadata(&place.path(&format!("f/{k:02}.png"))).unwrap();
        let (_, scene) = metadata.iter().find(|(key, _)| key == "scene").unwrap();
        let mut scene: toml::Table = scene.parse().unwrap();
        scene.retain(|key, _| key != "eye" && key != "up");
        scene
    };
    let mut coarse_most = 0;
    for k in 0..5 {
        assert_eq!(how(k), how(0));
        let of = |folder: &str| pixels(&place.path(&format!("{folder}/{k:02}.png")));
        let (_, most) = apart(&of("f"), &of("truth"));
        // Both rounded to levels.
        assert!(f64::from(most) <= 0.03 * 255.0 + 1.0, "{k}: {most}");
        coarse_most = coarse_most.max(apart(&of("coarse"), &of("truth")).1);
    }
    // The control: there are settings that do not keep it.
    assert!(f64::from(coarse_most) > 0.03 * 255.0 + 1.0, "{coarse_most}");
    for flag in ["--resume", "--shard 0/2"] {
        let line = format!("{orbit} --max-error max:0.03 -o f/%02d.png {flag} {device}");
        let said = stderr(&place.run(&line));
        assert!(said.contains("exclude each other"), "{said}");
    }
}
