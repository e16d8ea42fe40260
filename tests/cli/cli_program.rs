//! The program from outside: exit codes, what goes where. Pictures by the reference, small.

use crate::cli_place;

use std::path::Path;
use std::process::Stdio;

use serde_json::Value;

use cli_place::{Place, stderr};

const REFERENCE: &str = "--device reference --size 16";

#[test]
fn help_and_version_go_to_stdout() {
    let place = Place::empty();
    assert_eq!(
        place.done("--version").trim(),
        concat!("angioray ", env!("CARGO_PKG_VERSION"))
    );
    for command in ["render", "bench", "info", "phantom", "devices"] {
        let help = place.done(&format!("{command} --help"));
        let (_, examples) = help.split_once("Example:").unwrap();
        assert!(examples.contains(&format!("angioray {command}")), "{help}");
        assert!(!help.contains('\u{1b}'), "{command}");
    }
    let help = place.done("render --help");
    for heading in ["Picture:", "Camera:", "Sampling:", "Output:", "Device:"] {
        assert!(help.contains(heading), "{heading}");
    }
    let bare = place.run("");
    assert_eq!(bare.status.code(), Some(2));
    assert!(bare.stdout.is_empty() && stderr(&bare).contains("Usage:"));
}

#[test]
fn a_picture_and_its_statistics() {
    let place = Place::with_ball();
    let output = place.run(&format!(
        "render ball.nrrd -o ball.exr --aov all --iso 50% --fit volume --stats ball.json {REFERENCE}"
    ));
    assert!(output.status.success(), "{}", stderr(&output));
    assert!(output.stdout.is_empty());
    assert!(!stderr(&output).contains('\u{1b}'));
    let stats = place.json("ball.json");
    assert_eq!(stats["version"], env!("CARGO_PKG_VERSION"));
    assert_eq!(stats["command"], "render");
    assert_eq!(stats["scene"]["mode"], "iso");
    assert_eq!(stats["scene"]["iso"], 100);
    let volume = stats["scene"]["volume"].as_str().unwrap();
    assert_eq!(volume, "ball.nrrd");
    assert_eq!(stats["volume"]["dims"], serde_json::json!([16, 16, 16]));
    assert_eq!(stats["volume"]["type"], "u8");
    assert_eq!(stats["volume"]["range"], serde_json::json!([0.0, 200.0]));
    assert_eq!(stats["device"]["name"], "reference");
    assert_eq!(stats["channels"][0], "R");
    assert!(
        stats["channels"]
            .as_array()
            .unwrap()
            .contains(&"depth.Z".into())
    );
    for time in ["read", "octree", "build", "upload", "render", "encode"] {
        assert!(stats["times_ms"][time].as_f64().unwrap() >= 0.0, "{time}");
    }
    assert_eq!(stats["counts"]["rays"], 256);
    // A ball of radius 0.35·16 under a bounding sphere of radius 7.5·√3 that touches the edges of
    // 16 pixels: its disc is about π·(8·5.6/13)² = 37 pixels.
    let hits = stats["counts"]["hits"].as_u64().unwrap();
    assert!((28..=48).contains(&hits), "{hits}");
    assert!(stats["counts"]["samples"].as_u64().unwrap() > hits);
    let memory = &stats["memory"];
    assert_eq!(memory["device_bytes"], 0);
    if cfg!(target_os = "linux") {
        assert!(memory["host_peak_bytes"].as_u64().unwrap() > 100_000);
    }
    // The control: with a quarter of the view, about sixteen times fewer pixels.
    place.done(&format!(
        "render ball.nrrd -o far.png --iso 50% --fit volume --zoom 0.25 --stats far.json {REFERENCE}"
    ));
    assert!(place.json("far.json")["counts"]["hits"].as_u64().unwrap() < hits / 4);
}

#[test]
fn the_stats_scene_and_the_picture_s_metadata_render_the_same_picture_again() {
    let place = Place::with_ball();
    for (name, flags) in [
        ("iso", "--iso 100 --azimuth 40 --shading blinn-phong"),
        ("dvr", "--mode dvr --carm RAO20 --background #102030"),
        ("mip", "--mode mip --window 10%,90%"),
        (
            "clip",
            "--clip-plane -1,0.3,0,8.1 --clip-plane 0,1e-3,0,-0.006",
        ),
    ] {
        place.done(&format!(
            "render ball.nrrd -o {name}.png {flags} {REFERENCE}"
        ));
        let metadata = angioray::frame::read_metadata(&place.path(&format!("{name}.png"))).unwrap();
        let scene = metadata.iter().find(|(key, _)| key == "scene").unwrap();
        place.write("again.toml", &scene.1);
        place.done("render --scene again.toml -o again.png --device reference");
        place.done(
            "render --scene again.toml -o other.png --device reference --zoom 1.3 --view left",
        );
        let bytes = |name: &str| std::fs::read(place.path(name)).unwrap();
        assert_eq!(bytes("again.png"), bytes(&format!("{name}.png")), "{name}");
        // The control: a flag over the scene makes another picture.
        assert_ne!(bytes("other.png"), bytes("again.png"), "{name}");
    }
}

#[test]
fn an_iso_value_outside_the_range_shows_what_the_note_says() {
    let place = Place::with_ball();
    // The ball's values are 0 to 200.
    for (flags, side, hits) in [
        ("--iso -5", "below", true),
        ("--iso -5 --caps off", "below", false),
        ("--iso 205", "above", false),
        ("--iso 205 --caps off", "above", false),
    ] {
        let output = place.run(&format!(
            "render ball.nrrd -o a.png {flags} --stats a.json {REFERENCE}"
        ));
        let messages = stderr(&output);
        let note = format!("lies {side} the volume's values, 0 to 200: there is no surface");
        assert!(messages.contains(&note), "{flags}: {messages}");
        assert_eq!(
            messages.contains("only its caps are shown"),
            hits,
            "{flags}: {messages}"
        );
        assert_eq!(
            messages.contains("nothing is shown"),
            !hits,
            "{flags}: {messages}"
        );
        let shown = place.json("a.json")["counts"]["hits"].as_u64().unwrap();
        assert_eq!(shown > 0, hits, "{flags}: {shown}");
    }
}

#[test]
fn the_certificate_is_of_surfaces_alone() {
    let place = Place::with_ball();
    let render = |flags: &str| {
        let line = format!("render ball.nrrd -o a.exr --stats a.json {flags} {REFERENCE}");
        let output = place.run(&line);
        assert!(output.status.success(), "{flags}: {}", stderr(&output));
        let channels = place.json("a.json")["channels"].clone();
        let has_layer = channels
            .as_array()
            .unwrap()
            .contains(&"certificate.V".into());
        (has_layer, stderr(&output).contains("certificate: "))
    };
    assert_eq!(render("--iso 100 --aov all"), (true, true));
    assert_eq!(render("--iso 100 --aov certificate"), (true, true));
    // Fixed steps prove nothing that could be reported.
    assert_eq!(render("--iso 100 --aov all --step 1"), (true, false));
    for mode in ["mip", "lmip", "minip", "mean", "dvr"] {
        assert_eq!(render(&format!("--mode {mode} --aov all")), (false, false));
        let message = place.refused(
            &format!("render ball.nrrd -o b.exr --mode {mode} --aov depth,certificate {REFERENCE}"),
            2,
        );
        let reason = format!("the layer 'certificate' cannot be combined with mode '{mode}'");
        assert!(message.contains(&reason), "{message}");
    }
    // A scene file's layer goes with its mode.
    place.write(
        "iso.toml",
        "mode = 'iso'\niso = 100\naov = 'certificate,depth'\n",
    );
    assert_eq!(render("--scene iso.toml"), (true, true));
    assert_eq!(render("--scene iso.toml --mode mip"), (false, false));
}

#[test]
fn percentiles_are_order_statistics_of_the_voxels() {
    let place = Place::empty();
    // Ten voxels, one of them far from the others.
    std::fs::write(place.path("ten.raw"), [1, 2, 3, 4, 5, 6, 7, 8, 9, 250]).unwrap();
    let raw = "ten.raw --raw-size 10x1x1 --raw-type u8";
    let window = |ends: &str| {
        let line = format!("render {raw} -o a.png --mode mip --window {ends} --stats a.json");
        let output = place.run(&format!("{line} {REFERENCE}"));
        let messages = stderr(&output);
        assert!(output.status.success(), "{messages}");
        (place.json("a.json")["scene"]["window"].clone(), messages)
    };
    let (ends, messages) = window("p10,p90");
    assert_eq!(ends, serde_json::json!([1, 9]));
    assert!(
        messages.contains("note: window = p10,p90 is 1,9\n"),
        "{messages}"
    );
    assert_eq!(window("p90.1,p10.1").0, serde_json::json!([250, 2]));
    assert_eq!(window("p0,p100").0, serde_json::json!([1, 250]));
    // A share of the value range is something else: 90 % of 1 to 250.
    assert_eq!(window("0%,90%").0, serde_json::json!([1, 225.1]));
    let shown = |flags: &str, key: &str| {
        let line = format!("render {raw} -o a.png {flags} --stats a.json {REFERENCE}");
        place.done(&line);
        place.json("a.json")["scene"][key].clone()
    };
    assert_eq!(shown("--iso p50", "iso"), 5);
    assert_eq!(
        shown("--mode lmip --lmip-threshold p70", "lmip-threshold"),
        7
    );
    place.write("p.toml", "iso = 'p20'\n");
    assert_eq!(shown("--scene p.toml", "iso"), 2);
    // A window without a width says so.
    let message = place.refused(
        &format!("render {raw} -o b.png --mode mip --window p1,p2 {REFERENCE}"),
        2,
    );
    assert!(message.contains("the window 1,1 is empty"), "{message}");
}

#[test]
fn defaults_chosen_for_the_user_are_reported_in_one_line() {
    let place = Place::with_ball();
    let notes = |flags: &str| {
        let line = format!("render ball.nrrd -o a.png {flags} {REFERENCE}");
        let text = stderr(&place.run(&line));
        text.lines().filter(|l| l.starts_with("note: ")).count()
    };
    assert_eq!(notes(""), 1);
    assert_eq!(notes("--iso 70"), 0);
    assert_eq!(notes("--iso otsu"), 1);
    assert_eq!(notes("--mode dvr"), 1);
    assert_eq!(notes("--mode dvr --tf mra"), 0);
}

// long: the table of cases.
#[test]
fn wrong_usage_is_exit_2() {
    let place = Place::with_ball();
    place.write("bad.toml", "mode = 'mip'\nlight = 'lamp'\n");
    place.write("stray.toml", "mode = 'iso'\n\ncaps-lock = true\n");
    let planes = "[1, 0, 0, 9], ".repeat(65);
    place.write("planes.toml", &format!("clip-plane = [{planes}]\n"));
    place.write("nonsense.toml", "mode = 'mip'\ncaps = true\n");
    for (line, reason) in [
        ("render ball.nrrd -o a.png --frobnicate", "--frobnicate"),
        ("render ball.nrrd -o a.png --ssao", "--ssao"),
        ("frobnicate", "frobnicate"),
        ("render ball.nrrd", "--output"),
        ("render -o a.png --device reference", "no volume"),
        ("render ball.nrrd -o a.tga --device reference", "a.tga"),
        ("render ball.nrrd -o a.png --size 0x5", "--size"),
        (
            "render ball.nrrd -o a.png --tf cta --device reference",
            "'tf' cannot be combined with",
        ),
        (
            "render ball.nrrd -o a.png --mode mip --caps on",
            "'caps' cannot be combined with",
        ),
        (
            "render ball.nrrd -o a.png --eye 1,2,3 --view left",
            "cannot be combined",
        ),
        (
            "render ball.nrrd -o a.png --aov depth --device reference",
            "--aov",
        ),
        (
            "render ball.nrrd -o a.exr --aov colour --device reference",
            "colour",
        ),
        (
            "render ball.nrrd -o a.png --quality 50 --device reference",
            "--quality",
        ),
        (
            "render ball.nrrd -o a.jpg --bit-depth 16 --device reference",
            "--bit-depth",
        ),
        (
            "render ball.nrrd -o a.png --octree-leaf 64 --device reference",
            "octree-leaf",
        ),
        (
            "render ball.nrrd -o a.png --work-group 8x8 --device reference",
            "--work-group",
        ),
        (
            "render ball.nrrd -o a.png --scene bad.toml --device reference",
            "bad.toml:2",
        ),
        (
            "render ball.nrrd -o a.png --scene stray.toml --device reference",
            "stray.toml:3",
        ),
        (
            "render ball.nrrd -o a.png --scene nonsense.toml",
            "'caps' cannot be combined with",
        ),
        (
            "render ball.nrrd -o ball.png --stats ball.png --device reference",
            "a file each",
        ),
        (
            "render ball.nrrd -o a.png --clip-plane 1,2,3",
            "'1,2,3' is not a clip plane",
        ),
        (
            "render ball.nrrd -o a.png --clip-plane 0,-0,0,3",
            "has no direction",
        ),
        (
            "render ball.nrrd -o a.png --clip-plane inf,0,0,3",
            "is not a clip plane",
        ),
        (
            "render ball.nrrd -o a.png --scene planes.toml",
            "65 clip planes: there may be at most 64",
        ),
        (
            "render ball.nrrd -o a.png --light headlight --light 1,0,0 --light 0,1,0 --light 0,0,1 --light 1,1,1",
            "5 lights: there may be at most 4",
        ),
        (
            "render ball.nrrd -o a.png --light camera:0,0,0",
            "a light at 0,0,0 has no direction",
        ),
        (
            "render ball.nrrd -o a.png --shading none --light point:1,2,3",
            "without shading",
        ),
        ("info", "no volume"),
        ("info ball.nrrd --mode mip", "--mode"),
        ("phantom cube -o a.nrrd", "cube"),
        ("phantom sphere -o a.tif", "a.tif"),
        ("phantom sphere -o a.nrrd --size 4x4", "--size"),
        ("phantom sphere -o a.nrrd --type i8", "--type"),
    ] {
        let message = place.refused(line, 2);
        assert!(message.contains(reason), "{line}: {message}");
    }
}

/// What a terminal would act upon in a text that consists of lines.
fn obeyed(text: &str) -> Vec<char> {
    let acts = |c: &char| {
        (c.is_control() && *c != '\n')
            || ('\u{202a}'..='\u{202e}').contains(c)
            || ('\u{2066}'..='\u{2069}').contains(c)
    };
    text.chars().filter(acts).collect()
}

const FORGED: &str = "x\nerror: forged\u{1b}[31m\u{9b}\u{202e}\r\u{7}";
const SHOWN: &str = "x\\nerror: forged\\u{1b}[31m\\u{9b}\\u{202e}\\r\\u{7}";

fn case(name: &str) -> String {
    let cases = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/cases");
    cases.join(name).display().to_string()
}

/// An archive whose members' names a terminal would act upon.
fn write_forged_archive(place: &Place, name: &str) {
    let npz = std::fs::File::create(place.path(name)).unwrap();
    let mut npz = zip::ZipWriter::new(npz);
    for name in ["a\u{1b}[31m\u{202e}.npy", "b\nerror: c.npy"] {
        let options = zip::write::SimpleFileOptions::default();
        npz.start_file(name, options).unwrap();
    }
    npz.finish().unwrap();
}

#[test]
fn no_input_reaches_the_terminal_raw() {
    let place = Place::with_ball();
    let printed = |arguments: &[&str], code: i32| {
        let output = place.command("").args(arguments).output().unwrap();
        let [out, err] = [&output.stdout, &output.stderr].map(|text| String::from_utf8_lossy(text));
        assert_eq!(output.status.code(), Some(code), "{arguments:?}: {err}");
        assert_eq!(
            (obeyed(&out), obeyed(&err)),
            (vec![], vec![]),
            "{arguments:?}: {err:?}"
        );
        let errors = err
            .lines()
            .filter(|line| line.starts_with("error:"))
            .count();
        assert_eq!(errors, usize::from(code != 0), "{arguments:?}: {err}");
        format!("{out}{err}")
    };
    // Fields, keys and values of files.
    let units = printed(&["info", &case("esc-units.nrrd")], 0);
    assert!(
        units.contains("mm\\u{1b}[31mRED\\u{1b}]0;owned\\u{7}"),
        "{units}"
    );
    let render = |more: &[&str]| {
        let line = [&["render", "ball.nrrd", "-o", "a.png"], more].concat();
        printed(&line, 2)
    };
    let size = render(&["--scene", &case("esc-scene.toml")]);
    assert!(size.contains("\\u{1b}[31mx"), "{size}");
    let tf = render(&["--mode", "dvr", "--tf", &case("esc-tf.toml")]);
    assert!(tf.contains("\\u{1b}[31mx\\u{1b}]0;owned\\u{7}"), "{tf}");
    place.write("key.toml", "\"a\\u001b[31m\\nerror: b\" = 1\n");
    let key = render(&["--scene", "key.toml"]);
    assert!(key.contains("a\\u{1b}[31m\\nerror: b"), "{key}");
    // Members of an archive.
    write_forged_archive(&place, "a.npz");
    printed(&["info", "a.npz"], 65);
    // Names of files, there and not there.
    std::fs::copy(place.path("ball.nrrd"), place.path(FORGED)).unwrap();
    assert!(printed(&["info", FORGED], 0).contains(&format!("file           {SHOWN}\n")));
    let missing = format!("no{FORGED}");
    assert!(printed(&["info", &missing], 65).contains(SHOWN));
    // Arguments, which the parser quotes.
    for wrong in [
        &["render", "ball.nrrd", "--mode", FORGED][..],
        &["render", "ball.nrrd", "--size", FORGED],
        &["render", "ball.nrrd", &format!("--{FORGED}")],
        &["bench", FORGED],
        &[FORGED],
    ] {
        assert!(printed(wrong, 2).contains(SHOWN), "{wrong:?}");
    }
}

#[test]
fn json_is_the_same_value_without_what_a_terminal_obeys() {
    let place = Place::with_ball();
    std::fs::copy(place.path("ball.nrrd"), place.path(FORGED)).unwrap();
    let output = place.command("info --json").arg(FORGED).output().unwrap();
    let text = String::from_utf8(output.stdout).unwrap();
    assert_eq!(obeyed(&text), []);
    let info: Value = serde_json::from_str(&text).unwrap();
    assert_eq!(info["file"], FORGED);
    // Statistics too, whose file may be a terminal.
    let line = "render -o a.png --size 8 --iso 100 --device reference --stats s.json";
    let output = place.command(line).arg(FORGED).output().unwrap();
    assert!(output.status.success(), "{output:?}");
    let text = std::fs::read_to_string(place.path("s.json")).unwrap();
    assert_eq!(obeyed(&text), []);
    assert_eq!(place.json("s.json")["volume"]["file"], FORGED);
}

#[test]
fn unusable_inputs_are_exit_65_and_failed_outputs_74() {
    let place = Place::with_ball();
    place.write("noise.nrrd", "NRRD0004\nthis is no header\n");
    for (line, code, reason) in [
        (
            "render none.nrrd -o a.png --device reference",
            65,
            "none.nrrd",
        ),
        (
            "render noise.nrrd -o a.png --device reference",
            65,
            "noise.nrrd",
        ),
        (
            "render ball.nrrd -o no/such/a.png --device reference",
            74,
            "no/such",
        ),
        (
            "render ball.nrrd -o a.png --stats no/such/a.json --device reference",
            74,
            "no/such",
        ),
        (
            "render ball.nrrd -o a.png --scene none.toml --device reference",
            65,
            "none.toml",
        ),
        (
            "render ball.nrrd -o a.png --mode dvr --tf none.toml --device reference",
            65,
            "none.toml",
        ),
        ("phantom sphere -o no/such/a.nrrd", 74, "no/such"),
        ("info none.nrrd", 65, "none.nrrd"),
        (
            "render none.nrrd -o a.png/ --device reference",
            74,
            "a.png/",
        ),
    ] {
        let message = place.refused(line, code);
        assert!(message.contains(reason), "{line}: {message}");
    }
}

#[test]
fn without_a_driver_all_but_the_device_works() {
    let place = Place::with_ball();
    std::fs::create_dir(place.path("vendors")).unwrap();
    let without = |line: &str| {
        let mut command = place.command(line);
        for variable in ["OCL_ICD_VENDORS", "OPENCL_VENDOR_PATH"] {
            command.env(variable, place.path("vendors"));
        }
        command.output().unwrap()
    };
    for line in [
        "--help",
        "info ball.nrrd",
        "phantom ramp -o ramp.nrrd --size 8",
        "render ball.nrrd -o a.png --size 16 --device reference",
        "replay a.png -o again.png",
        "info a.png",
        "completion bash",
        "man",
        "render -h",
    ] {
        assert!(without(line).status.success(), "{line}");
    }
    for line in ["render ball.nrrd -o b.png", "devices"] {
        let output = without(line);
        let messages = stderr(&output);
        assert_eq!(output.status.code(), Some(3), "{line}: {messages}");
        assert!(
            messages.starts_with("error: ") && messages.contains("hint: "),
            "{messages}"
        );
        assert!(output.stdout.is_empty());
        assert!(!place.path("b.png").exists());
    }
}

#[test]
fn info_says_what_the_volume_is() {
    let place = Place::empty();
    place.done("phantom ramp -o ramp.nrrd --size 9x5x3 --spacing 0.5,1,2 --type i16");
    let info: Value = serde_json::from_str(&place.done("info ramp.nrrd --json")).unwrap();
    assert_eq!(info["dims"], serde_json::json!([9, 5, 3]));
    assert_eq!(info["spacing_mm"], serde_json::json!([0.5, 1.0, 2.0]));
    assert_eq!(info["type"], "i16");
    assert_eq!(info["size_mm"], serde_json::json!([4.0, 4.0, 4.0]));
    assert_eq!(info["bytes"], 9 * 5 * 3 * 2);
    assert_eq!(info["non_finite"], 0);
    let share = info["octree"]["share_of_volume"].as_f64().unwrap();
    let bytes = info["octree"]["bytes"].as_f64().unwrap();
    assert!((share - bytes / 270.0).abs() < 1e-9);
    let text = place.done("info ramp.nrrd");
    for word in [
        "9x5x3 i16",
        "0.5",
        "suggested iso",
        "otsu",
        "octree",
        "% of the volume",
    ] {
        assert!(text.contains(word), "{word}: {text}");
    }
    // The control: another leaf, another tree.
    let coarser = place.done("info ramp.nrrd --json --octree-leaf 8");
    let coarser: Value = serde_json::from_str(&coarser).unwrap();
    assert_ne!(coarser["octree"], info["octree"]);
}

#[test]
fn phantoms_are_seeded_and_vessels_bring_their_tree() {
    let place = Place::empty();
    place.done("phantom vessels -o a.nrrd --size 24 --seed 3");
    place.done("phantom vessels -o b.nrrd --size 24 --seed 3");
    place.done("phantom vessels -o c.nrrd --size 24 --seed 4");
    let bytes = |name: &str| std::fs::read(place.path(name)).unwrap();
    assert_eq!(bytes("a.nrrd"), bytes("b.nrrd"));
    assert_ne!(bytes("a.nrrd"), bytes("c.nrrd"));
    let tree = place.json("a.tree.json");
    assert!(!tree["segments"].as_array().unwrap().is_empty());
    assert_eq!(tree["seed"], 3);
    assert!(place.done("phantom sphere -o s.nrrd --size 8").is_empty());
    assert!(!place.path("s.tree.json").exists());
}

#[test]
fn a_closed_pipe_is_no_error() {
    let place = Place::with_ball();
    for line in ["info ball.nrrd", "info ball.nrrd --json", "render --help"] {
        let mut child = place
            .command(line)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        // Closed before anything is written, or at the latest before it is read.
        drop(child.stdout.take());
        let output = child.wait_with_output().unwrap();
        assert!(output.status.success(), "{line}: {}", stderr(&output));
        assert_eq!(stderr(&output), "", "{line}");
    }
    // The control: a full disk is one.
    if Path::new("/dev/full").exists() {
        let full = std::fs::File::create("/dev/full").unwrap();
        let output = place
            .command("info ball.nrrd")
            .stdout(full)
            .output()
            .unwrap();
        assert_eq!(output.status.code(), Some(74));
        assert!(stderr(&output).starts_with("error: "));
    }
}
