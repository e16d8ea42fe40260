//! The program end to end on the OpenCL device: every mode to every format, statistics, layers,
//! what may not change a picture. Without a device these say so and pass, unless REQUIRE_OPENCL=1.

use crate::cli_place;
use crate::common;

use std::io::{Seek, SeekFrom, Write};

use cli_place::{Place, stderr};
use serde_json::Value;

const MODES: [&str; 6] = ["iso", "mip", "lmip", "minip", "mean", "dvr"];
const FORMATS: [&str; 5] = ["png", "exr", "jpg", "webp", "npy"];

/// A folder with a blob of 24³ f32 voxels, 0 to 1, and the flag that chooses the device under
/// test.
fn place() -> Option<(Place, String)> {
    let device = common::device()?;
    let place = Place::empty();
    place.done("phantom gaussian -o blob.nrrd --size 24 --type f32");
    Some((place, format!("--device {}", device.info().id)))
}

fn bytes(place: &Place, name: &str) -> Vec<u8> {
    std::fs::read(place.path(name)).unwrap()
}

/// An EXR's channels by name, rows first.
fn channels(place: &Place, name: &str) -> Vec<(String, Vec<f32>)> {
    use exr::prelude::*;
    let image = read_first_flat_layer_from_file(place.path(name)).unwrap();
    let list = image.layer_data.channel_data.list;
    list.into_iter()
        .map(|channel| {
            let FlatSamples::F32(samples) = channel.sample_data else {
                panic!("{} is not f32", channel.name)
            };
            (channel.name.to_string(), samples)
        })
        .collect()
}

fn channel(channels: &[(String, Vec<f32>)], name: &str) -> Vec<f32> {
    let found = channels.iter().find(|(n, _)| n == name);
    found
        .unwrap_or_else(|| panic!("no channel {name}"))
        .1
        .clone()
}

/// A PNG's pixels, without its metadata.
fn pixels(place: &Place, name: &str) -> Vec<u8> {
    let file = std::io::BufReader::new(std::fs::File::open(place.path(name)).unwrap());
    let mut reader = png::Decoder::new(file).read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    reader.next_frame(&mut pixels).unwrap();
    pixels
}

#[test]
fn every_mode_to_every_format() {
    let Some((place, device)) = place() else {
        return;
    };
    for mode in MODES {
        for format in FORMATS {
            let name = format!("{mode}.{format}");
            let line = format!("render blob.nrrd -o {name} --mode {mode} --size 16x12 {device}");
            let output = place.run(&line);
            assert!(output.status.success(), "{line}: {}", stderr(&output));
            assert!(output.stdout.is_empty() && !stderr(&output).contains('\u{1b}'));
            assert!(stderr(&output).contains(&format!("wrote {name}: {mode} 16x12")));
        }
        let layers = channels(&place, &format!("{mode}.exr"));
        let names: Vec<&str> = layers.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(names, ["A", "B", "G", "R"]);
        for (name, samples) in &layers {
            assert_eq!(samples.len(), 16 * 12);
            assert!(
                samples.iter().all(|v| v.is_finite() && *v >= 0.0),
                "{mode} {name}"
            );
        }
        // Something is seen in the middle, in every format alike.
        let png = pixels(&place, &format!("{mode}.png"));
        assert_eq!(png.len(), 16 * 12 * 3);
        if mode != "minip" {
            assert!(png[(6 * 16 + 8) * 3] > 20, "{mode}");
        }
        let decoded = image::open(place.path(&format!("{mode}.webp"))).unwrap();
        assert_eq!(decoded.to_rgb8().into_raw(), png, "{mode}");
        let jpeg = image::open(place.path(&format!("{mode}.jpg"))).unwrap();
        assert_eq!((jpeg.width(), jpeg.height()), (16, 12));
        // An NPY of 16·12·4 floats behind its header.
        let npy = bytes(&place, &format!("{mode}.npy"));
        assert!(npy.starts_with(b"\x93NUMPY") && npy.len() > 16 * 12 * 16);
    }
    // The control: the modes are different pictures.
    assert_ne!(pixels(&place, "mip.png"), pixels(&place, "mean.png"));
    assert_ne!(pixels(&place, "iso.png"), pixels(&place, "dvr.png"));
}

/// What CONTRACT's statistics hold, each with whether a value will do.
fn missing_in_stats(stats: &Value) -> Vec<&'static str> {
    let text = |v: &Value| v.as_str().is_some_and(|s| !s.is_empty());
    let count = |v: &Value| v.as_u64().is_some_and(|n| n > 0);
    let ms = |v: &Value| v.as_f64().is_some_and(|ms| ms >= 0.0);
    let some_ms = |v: &Value| v.as_f64().is_some_and(|ms| ms > 0.0);
    let numbers = |v: &Value, n: usize| {
        v.as_array()
            .is_some_and(|a| a.len() == n && a.iter().all(Value::is_number))
    };
    let triple = |v: &Value| numbers(v, 3);
    let matrix = |v: &Value| {
        v.as_array()
            .is_some_and(|rows| rows.len() == 3 && rows.iter().all(|row| numbers(row, 3)))
    };
    let passes = |v: &Value| {
        v.as_array().is_some_and(|passes| {
            !passes.is_empty() && passes.iter().all(|p| text(&p["name"]) && ms(&p["ms"]))
        })
    };
    // What is proven and what is occluded are of surfaces alone, and a projection has no light and is not in focus.
    let layers = match stats["scene"]["mode"].as_str() {
        Some("iso") => 20,
        Some("dvr") => 16,
        _ => 14,
    };
    let names = |v: &Value| {
        v.as_array()
            .is_some_and(|a| a.len() == layers && a.iter().all(text))
    };
    type Check<'a> = &'a dyn Fn(&Value) -> bool;
    let checks: [(&str, Check); 28] = [
        ("/version", &text),
        ("/command", &text),
        ("/scene", &Value::is_object),
        ("/scene/mode", &text),
        ("/volume/file", &text),
        ("/volume/dims", &triple),
        ("/volume/type", &text),
        ("/volume/spacing_mm", &triple),
        ("/volume/origin_mm", &triple),
        ("/volume/direction", &matrix),
        ("/volume/range", &|v| numbers(v, 2)),
        ("/volume/non_finite", &Value::is_u64),
        ("/device/name", &text),
        ("/device/platform", &text),
        ("/device/driver", &text),
        ("/channels", &names),
        ("/times_ms/read", &some_ms),
        ("/times_ms/octree", &some_ms),
        ("/times_ms/build", &some_ms),
        ("/times_ms/upload", &some_ms),
        ("/times_ms/render", &some_ms),
        ("/times_ms/encode", &some_ms),
        ("/passes", &passes),
        ("/counts/rays", &count),
        ("/counts/samples", &count),
        ("/counts/nodes", &count),
        ("/counts/hits", &count),
        ("/memory/device_bytes", &count),
    ];
    let holds = |path: &str, check: Check| stats.pointer(path).is_some_and(check);
    let missing = checks.iter().filter(|(path, check)| !holds(path, check));
    missing.map(|(path, _)| *path).collect()
}

#[test]
fn the_statistics_hold_what_is_promised() {
    let Some((place, device)) = place() else {
        return;
    };
    for mode in ["iso", "mip", "dvr"] {
        place.done(&format!(
            "render blob.nrrd -o a.exr --mode {mode} --aov all --size 32 --stats a.json {device}"
        ));
        let stats = place.json("a.json");
        assert_eq!(missing_in_stats(&stats), [""; 0], "{mode}");
        assert_eq!(stats["counts"]["rays"], 1024);
        if cfg!(target_os = "linux") {
            assert!(stats["memory"]["host_peak_bytes"].as_u64().unwrap() > 1 << 20);
        }
        let layers = channels(&place, "a.exr");
        let mut names: Vec<&str> = layers.iter().map(|(name, _)| name.as_str()).collect();
        let mut reported = stats["channels"].as_array().unwrap().clone();
        reported.sort_by_key(Value::to_string);
        names.sort_unstable();
        assert_eq!(names, reported, "{mode}");
        // The planes and the sums agree.
        for (name, key) in [("steps.N", "samples"), ("nodes.N", "nodes")] {
            let sum: f64 = channel(&layers, name).iter().map(|&n| f64::from(n)).sum();
            assert_eq!(stats["counts"][key].as_f64(), Some(sum), "{mode} {name}");
        }
    }
    // The control: without its counts it is not whole.
    let mut broken = place.json("a.json");
    broken["counts"]["samples"] = Value::from("many");
    broken["device"]["driver"] = Value::Null;
    assert_eq!(
        missing_in_stats(&broken),
        ["/device/driver", "/counts/samples"]
    );
}

/// The share of pixels where two planes differ by more than `limit`, or only one is finite.
fn share_apart(a: &[f32], b: &[f32], limit: f32) -> f64 {
    let apart = |(a, b): (&f32, &f32)| match (a.is_finite(), b.is_finite()) {
        (true, true) => (a - b).abs() > limit,
        (a, b) => a != b,
    };
    a.iter().zip(b).filter(|&pair| apart(pair)).count() as f64 / a.len() as f64
}

/// Those of a picture with all layers.
const CHANNELS: &str = "R G B A depth.Z normal.X normal.Y normal.Z value.V steps.N nodes.N cast.V kind.V \
                        certificate.V coverage.V occlusion.V occlusion_bound.V visibility.V thick.V coc.V";

#[test]
fn the_layers_are_those_of_the_reference() {
    let Some((place, device)) = place() else {
        return;
    };
    for mode in MODES {
        let line = format!("render blob.nrrd --mode {mode} --size 32 --azimuth 20 --aov all");
        place.done(&format!("{line} -o device.exr {device}"));
        place.done(&format!("{line} -o reference.exr --device reference"));
        let (ours, reference) = (
            channels(&place, "device.exr"),
            channels(&place, "reference.exr"),
        );
        for name in CHANNELS.split_whitespace() {
            // Only a surface is proven to be hit or missed, and keeps light from itself; a projection has no light and is not in focus.
            let missing = match mode {
                "iso" => &[][..],
                "dvr" => &[
                    "certificate.V",
                    "occlusion.V",
                    "occlusion_bound.V",
                    "thick.V",
                ],
                _ => &[
                    "certificate.V",
                    "occlusion.V",
                    "occlusion_bound.V",
                    "visibility.V",
                    "thick.V",
                    "coc.V",
                ],
            };
            if !missing.contains(&name) {
                let plane = channel(&ours, name);
                assert!(plane.iter().all(|v| !v.is_nan()), "{mode} {name}");
            }
        }
        assert!(channel(&ours, "cast.V").iter().all(|&v| v == 1.0), "{mode}");
        let apart =
            |name, limit| share_apart(&channel(&ours, name), &channel(&reference, name), limit);
        assert!(
            apart("kind.V", 0.5) < 0.01,
            "{mode}: {}",
            apart("kind.V", 0.5)
        );
        // A hundredth of the value range.
        assert!(
            apart("value.V", 0.01) < 0.01,
            "{mode}: {}",
            apart("value.V", 0.01)
        );
        if mode == "dvr" {
            for (name, limit) in [("depth.Z", 0.1), ("normal.X", 0.05), ("normal.Z", 0.05)] {
                assert!(apart(name, limit) < 0.01, "{name}: {}", apart(name, limit));
                assert!(
                    channel(&ours, name)
                        .iter()
                        .any(|v| v.is_finite() && *v != 0.0),
                    "{name}"
                );
            }
        }
        // Where the extremum lies is ill-conditioned on a smooth blob; a surface is not.
        if mode == "iso" {
            assert!(apart("depth.Z", 0.05) < 0.01, "{}", apart("depth.Z", 0.05));
            // The control: a twentieth of a voxel is seen.
            let moved: Vec<f32> = channel(&ours, "depth.Z").iter().map(|z| z + 0.1).collect();
            assert!(share_apart(&moved, &channel(&reference, "depth.Z"), 0.05) > 0.05);
        }
    }
}

/// A file of `tests/data/cases`.
fn case(name: &str) -> String {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/cases");
    format!("{folder}/{name}")
}

#[test]
fn unlike_spacings_are_seen_at_a_sane_cost_or_the_cost_is_reported() {
    let Some((place, device)) = place() else {
        return;
    };
    let messages_of = |line: &str| {
        let output = place.run(line);
        assert!(output.status.success(), "{line}: {}", stderr(&output));
        stderr(&output)
    };
    // Along the slab, whose width is a ten-thousandth of its height.
    let view = format!(
        "{} --mode dvr --size 16 --ortho 0.01 --stats s.json {device}",
        case("flatx.nrrd")
    );
    let messages = messages_of(&format!("render {view} -o a.exr"));
    assert!(
        messages.contains("quad = adaptive:0.001") && messages.contains("samples per ray"),
        "{messages}"
    );
    let samples = place.json("s.json")["counts"]["samples"].as_u64().unwrap();
    assert!(samples < 100_000, "{samples}");
    let reference = view.replace(&device, "--device reference");
    place.done(&format!("render {reference} -o b.exr"));
    let (ours, reference) = (channels(&place, "a.exr"), channels(&place, "b.exr"));
    for name in ["R", "G", "B", "A"] {
        let apart = share_apart(&channel(&ours, name), &channel(&reference, name), 1e-3);
        assert_eq!(apart, 0.0, "{name}");
    }
    assert!(channel(&reference, "A").iter().any(|&a| a > 0.05));
    // Requested steps: as many as were reported, here coarse ones.
    let messages = messages_of(&format!("render {view} -o a.exr --step 10"));
    assert!(
        messages.contains("samples per ray") && messages.contains("in all"),
        "{messages}"
    );
    let stepped = place.json("s.json")["counts"]["samples"].as_u64().unwrap();
    assert!(stepped > 10 * samples, "{stepped}");
    // The control: of like spacings nothing is reported.
    let messages = messages_of(&format!(
        "render blob.nrrd --mode dvr --size 16 -o c.exr {device}"
    ));
    assert!(!messages.contains("per ray"), "{messages}");
}

#[test]
fn no_rule_shows_a_label_that_is_not_there() {
    let Some((place, device)) = place() else {
        return;
    };
    let (labels, band) = (case("mask02.nrrd"), case("band1.toml"));
    let opaque = |more: &str| {
        let line = format!("render {labels} --mode dvr --tf {band} --size 24 -o l.exr {device}");
        place.done(&format!("{line} {more}"));
        let alpha = channel(&channels(&place, "l.exr"), "A");
        alpha.iter().filter(|&&a| a > 0.0).count()
    };
    for rule in [
        "preintegrated",
        "preintegrated --homogeneity 1 --homogeneity-rule range",
        "adaptive",
    ] {
        assert_eq!(
            opaque(&format!("--filter nearest --quad {rule}")),
            0,
            "{rule}"
        );
        assert!(opaque(&format!("--quad {rule}")) > 50, "{rule}");
    }
}

#[test]
fn precomputed_gradients_report_their_cost_and_error() {
    let Some((place, device)) = place() else {
        return;
    };
    let render = |name: &str, flags: &str| {
        let line = "render blob.nrrd --iso 0.4 --size 32 --stats a.json";
        let output = place.run(&format!("{line} -o {name} {flags} {device}"));
        assert!(output.status.success(), "{}", stderr(&output));
        (stderr(&output), place.json("a.json"))
    };
    let (messages, stats) = render("a.png", "--gradient precomputed --gradient-scale 3");
    // Directions at the voxels 0, 3, … 21 and 23, three numbers of two bytes each.
    assert_eq!(stats["memory"]["gradient_bytes"], 9 * 9 * 9 * 6);
    assert!(stats["times_ms"]["gradient"].as_f64().unwrap() > 0.0);
    assert_eq!(stats["scene"]["gradient-scale"], 3);
    let note = messages
        .lines()
        .find(|l| l.starts_with("note: precomputed"));
    let note = note.unwrap_or_else(|| panic!("{messages}"));
    for part in ["0.0 MB", "mean ", "p99 ", "places of strong gradient"] {
        assert!(note.contains(part), "{note}");
    }
    // The controls: other gradients cost nothing and make another picture.
    let (messages, stats) = render("b.png", "--gradient central");
    assert_eq!(stats["memory"]["gradient_bytes"], 0);
    assert!(!messages.contains("precomputed"), "{messages}");
    assert_ne!(pixels(&place, "a.png"), pixels(&place, "b.png"));
}

#[test]
fn an_inverted_window_is_the_negative_on_device_and_reference() {
    let Some((place, device)) = place() else {
        return;
    };
    for (mode, sampling) in [
        ("mip", ""),
        ("mip", "--step 0.5"),
        ("minip", ""),
        ("minip", "--step 0.5"),
        ("mean", "--step 0.5"),
        ("lmip", ""),
    ] {
        let render = |name: &str, flags: &str| {
            place.done(&format!(
                "render blob.nrrd -o {name} --mode {mode} {sampling} --size 24 {flags}"
            ));
        };
        // Eight bits of the device and of the reference, and of both the other way round. The ends lie
        // within the values, so that much is black and white alike.
        let (ends, inverted) = ("--window 0.2,0.7", "--window 0.7,0.2");
        render("up.png", &format!("{ends} {device}"));
        render("down.png", &format!("{inverted} {device}"));
        render("true.png", &format!("{inverted} --device reference"));
        render("hit.exr", &format!("{inverted} {device} --aov kind,value"));
        let hit = channel(&channels(&place, "hit.exr"), "kind.V");
        let [up, down, reference] =
            ["up.png", "down.png", "true.png"].map(|name| pixels(&place, name));
        let mut greys = 0;
        for (at, hit) in hit.iter().enumerate() {
            let [up, down, reference] =
                [&up, &down, &reference].map(|plane| i32::from(plane[3 * at]));
            assert!(
                (down - reference).abs() <= 1,
                "{mode} {sampling} {at}: {down} {reference}"
            );
            if *hit > 0.0 {
                assert!(
                    (up + down - 255).abs() <= 1,
                    "{mode} {sampling} {at}: {up} {down}"
                );
                greys += i32::from((1..255).contains(&down));
            } else {
                assert_eq!((up, down), (0, 0), "{mode} {sampling} {at}");
            }
        }
        assert!(greys > 8 || mode == "minip", "{mode} {sampling}: {greys}");
        // The control: the picture is not its own negative.
        assert_ne!(up, down, "{mode}");
        // What is seen stays what it is.
        render("other.exr", &format!("{ends} {device} --aov value"));
        let value = |name: &str| channel(&channels(&place, name), "value.V");
        assert_eq!(value("hit.exr"), value("other.exr"), "{mode}");
    }
}

#[test]
fn a_replayed_picture_is_the_same_bytes_on_the_device() {
    let Some((place, device)) = place() else {
        return;
    };
    for (name, flags) in [
        ("iso.exr", "--iso 40% --aov all"),
        ("mip.png", "--mode mip --step 0.5 --window 90%,p30"),
        ("dvr.png", "--mode dvr --shading phong --bit-depth 16"),
        (
            "lit.png",
            "--iso 40% --light camera:-1,1,1@ivory@0.7 --light point:20,-30,40@#8040ff --specular-color gold",
        ),
        (
            "fog.png",
            "--mode dvr --shading blinn-phong --shade-from 5% --light 0,0,1 --light headlight@0.3",
        ),
    ] {
        place.done(&format!(
            "render blob.nrrd -o {name} --size 40x24 {flags} {device}"
        ));
        // On the device that the picture names.
        place.done(&format!("replay {name} -o again-{name}"));
        assert_eq!(
            bytes(&place, name),
            bytes(&place, &format!("again-{name}")),
            "{name}"
        );
        // The control: the reference is another device.
        place.done(&format!("replay {name} -o true-{name} --device reference"));
        assert_ne!(
            bytes(&place, name),
            bytes(&place, &format!("true-{name}")),
            "{name}"
        );
    }
}

/// So that tests may build unoptimised what they hold against truth (`scripts/test.sh`).
#[test]
fn kernels_that_are_not_optimised_make_the_same_bits() {
    let Some((place, device)) = place() else {
        return;
    };
    const OPTIONS: &str = "ANGIORAY_KERNEL_OPTIONS";
    for flags in [
        "--mode iso --ao rays=16,distance=4 --dof focus=auto,aperture=1 --aa 2",
        "--mode iso --sampling fixed --shadows on --light camera:-1,1,1 --cue fog:0.5",
        "--mode iso --ssao radius=4 --sparse 4 --cue chromadepth:1,rim=2 --cue halo:1",
        "--mode mip --cue chromadepth:1",
        "--mode lmip --sampling fixed",
        "--mode mean",
        "--mode dvr --shading phong --shadows on --light camera:-1,1,1",
        "--mode dvr --quad adaptive --screen-error 0.05",
    ] {
        let line = |name: &str, more: &str| {
            format!(
                "render blob.nrrd -o {name} --size 40x24 --view left --aov all {flags} {more} {device}"
            )
        };
        let mut optimised = place.command(&line("a.npy", ""));
        let mut plain = place.command(&line("b.npy", ""));
        for command in [
            optimised.env_remove(OPTIONS),
            plain.env(OPTIONS, "-cl-opt-disable"),
        ] {
            assert!(command.status().unwrap().success(), "{flags}");
        }
        assert_eq!(bytes(&place, "a.npy"), bytes(&place, "b.npy"), "{flags}");
        // The control: another picture is not the same bytes.
        place.done(&line("b.npy", "--azimuth 5"));
        assert_ne!(bytes(&place, "a.npy"), bytes(&place, "b.npy"), "{flags}");
    }
}

#[test]
fn what_may_not_change_a_picture_does_not() {
    let Some((place, device)) = place() else {
        return;
    };
    for mode in ["iso", "mip", "dvr"] {
        let render = |name: &str, flags: &str| {
            place.done(&format!(
                "render blob.nrrd -o {name} --mode {mode} --size 40x24 --view left {flags} {device}"
            ));
        };
        for name in ["a.png", "b.png", "a.exr", "b.exr"] {
            let layers = if name.ends_with("exr") {
                "--aov all"
            } else {
                ""
            };
            render(name, layers);
        }
        assert_eq!(bytes(&place, "a.png"), bytes(&place, "b.png"), "{mode}");
        assert_eq!(bytes(&place, "a.exr"), bytes(&place, "b.exr"), "{mode}");
        render("b.png", "--work-group 4x4");
        assert_eq!(bytes(&place, "a.png"), bytes(&place, "b.png"), "{mode}");
        for flags in [
            "--octree-leaf 5",
            "--traverse kd-restart",
            "--traverse uniform",
            "--skip off",
        ] {
            render("b.png", flags);
            // The metadata says what was requested.
            assert_ne!(
                bytes(&place, "a.png"),
                bytes(&place, "b.png"),
                "{mode} {flags}"
            );
            assert_eq!(
                pixels(&place, "a.png"),
                pixels(&place, "b.png"),
                "{mode} {flags}"
            );
        }
        // The control: what may change the picture does.
        render("b.png", "--filter nearest");
        assert_ne!(pixels(&place, "a.png"), pixels(&place, "b.png"), "{mode}");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn without_an_opencl_library_all_but_the_device_works() {
    let place = Place::empty();
    place.done("phantom sphere -o ball.nrrd --size 8");
    // An empty file ends the dynamic linker's search.
    std::fs::create_dir(place.path("lib")).unwrap();
    for name in ["libOpenCL.so", "libOpenCL.so.1"] {
        place.write(&format!("lib/{name}"), "");
    }
    let without = |line: &str| {
        let mut command = place.command(line);
        command.env("LD_LIBRARY_PATH", place.path("lib"));
        command.output().unwrap()
    };
    for line in [
        "--help",
        "info ball.nrrd",
        "phantom ramp -o ramp.nrrd --size 8",
        "render ball.nrrd -o a.png --size 8 --device reference",
    ] {
        assert!(without(line).status.success(), "{line}");
    }
    for line in ["render ball.nrrd -o b.png", "devices"] {
        let output = without(line);
        let messages = stderr(&output);
        assert_eq!(output.status.code(), Some(3), "{line}: {messages}");
        assert_eq!(messages.matches("error: ").count(), 1, "{messages}");
        assert!(messages.contains("install"), "{messages}");
        assert!(output.stdout.is_empty() && !place.path("b.png").exists());
    }
    // The control: with the library the same line works or finds no device, for another reason.
    if common::device().is_some() {
        place.done("render ball.nrrd -o b.png --size 8");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_large_volume_takes_little_memory_beyond_its_file() {
    let Some((place, device)) = place() else {
        return;
    };
    const VOXELS: u64 = 512 * 512 * 512;
    let name = "large_512x512x512_u8.raw";
    let mut file = std::fs::File::create(place.path(name)).unwrap();
    file.set_len(VOXELS).unwrap();
    for z in 100..400 {
        for y in 250..262 {
            let at = (z * 512 + y) * 512 + 240;
            file.seek(SeekFrom::Start(at)).unwrap();
            file.write_all(&[200; 24]).unwrap();
        }
    }
    drop(file);
    place.done(&format!(
        "render {name} -o large.png --iso 100 --size 1024 --stats large.json {device}"
    ));
    let stats = place.json("large.json");
    let peak = stats["memory"]["host_peak_bytes"].as_u64().unwrap();
    assert!(peak - VOXELS <= 1 << 30, "{peak}");
    // The control: the volume was there and was seen.
    assert!(peak > VOXELS / 8);
    assert!(stats["counts"]["hits"].as_u64().unwrap() > 1000);
}

/// Rendered by a device of 1 GiB, where the driver can be limited to that.
fn by_a_small_device(place: &Place, line: &str) -> std::process::Output {
    let mut command = place.command(line);
    command.env("POCL_MEMORY_LIMIT", "1");
    command.env("ANGIORAY_KERNEL_CACHE", place.path("kernels"));
    command.output().unwrap()
}

#[test]
fn a_device_that_is_too_small_is_reported_before_reading_and_building() {
    let Some((place, device)) = place() else {
        return;
    };
    if !common::device().is_some_and(|d| d.info().platform.contains("Portable Computing")) {
        return common::skip("this driver's memory cannot be limited");
    }
    // 2 GiB announced and none of it there: a reader sees damage.
    let header = "NRRD0004\ntype: float\ndimension: 3\nsizes: 1024 1024 512\nencoding: gzip\nendian: little\n\n";
    place.write("large.nrrd", &format!("{header}no gzip"));
    let line = format!("render large.nrrd -o a.png --iso 1 {device}");
    let output = by_a_small_device(&place, &line);
    let messages = stderr(&output);
    assert_eq!(output.status.code(), Some(74), "{messages}");
    for part in [
        "error: large.nrrd: 1024x1024x512",
        "2147483648 bytes",
        "the device '",
    ] {
        assert!(messages.contains(part), "{part}: {messages}");
    }
    // A picture that fits in no device: the volume is read by then, but nothing is built.
    let line = format!("render blob.nrrd -o a.png --mode mip --size 8000 {device}");
    let output = by_a_small_device(&place, &line);
    let messages = stderr(&output);
    assert_eq!(output.status.code(), Some(74), "{messages}");
    assert!(
        messages.contains("8000x8000 pixels") && messages.contains("smaller --size"),
        "{messages}"
    );
    assert_eq!(std::fs::read_dir(place.path("kernels")).unwrap().count(), 0);
    assert!(!place.path("a.png").exists());
    // The controls: what needs no device meets the damage, and what is small is rendered.
    let line = "render large.nrrd -o a.png --iso 1 --device reference";
    let output = by_a_small_device(&place, line);
    assert_eq!(output.status.code(), Some(65), "{}", stderr(&output));
    let line = format!("render blob.nrrd -o a.png --mode mip --size 8 {device}");
    let output = by_a_small_device(&place, &line);
    assert!(output.status.success(), "{}", stderr(&output));
    assert!(std::fs::read_dir(place.path("kernels")).unwrap().count() > 0);
}
