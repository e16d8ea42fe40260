//! Scene options: flags and scene files, alone and together, to a scene and back.

use angioray::extent::{ImageSize, Range};
use angioray::options::{Resolved, SceneFile, SceneOptions, Threshold, TransferChoice};
use angioray::scene::{
    Gradient, Lens, Light, Picture, Precomputed, Projection, Reconstruction, SamplingMethod,
};
use angioray::{Content, Sphere, Subject};
use clap::Parser;
use glam::DVec3;

const SPHERE: Sphere = Sphere {
    center_world: DVec3::new(1.0, 2.0, 3.0),
    radius_mm: 10.0,
};

const SUBJECT: Subject = Subject {
    sphere: SPHERE,
    content: Content::around(SPHERE),
    spacing_mm: DVec3::ONE,
    range: Range {
        min: -100.0,
        max: 300.0,
    },
    robust_range: Range {
        min: -100.0,
        max: 300.0,
    },
    otsu: 42.5,
    suggested_iso: 120.0,
};

#[derive(Parser)]
struct Flags {
    #[command(flatten)]
    options: SceneOptions,
}

fn flags(line: &[&str]) -> SceneOptions {
    let words = std::iter::once("angioray").chain(line.iter().copied());
    match Flags::try_parse_from(words) {
        Ok(flags) => flags.options,
        Err(error) => panic!("{line:?}: {error}"),
    }
}

fn file(text: &str) -> SceneOptions {
    SceneOptions::parse(text, "scene.toml").unwrap_or_else(|error| panic!("{text}: {error}"))
}

fn refusal(text: &str) -> String {
    match SceneOptions::parse(text, "scene.toml").and_then(SceneOptions::checked) {
        Ok(_) => panic!("accepted: {text}"),
        Err(error) => {
            assert_eq!(error.exit_code(), 2, "{text}");
            error.to_string()
        }
    }
}

fn resolved(options: &SceneOptions) -> Resolved {
    options
        .resolve(&SUBJECT)
        .unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn thresholds_are_values_shares_or_otsu() {
    let iso = |text: &str| match resolved(&flags(&["--iso", text])).scene.picture {
        Picture::Surface { iso, .. } => iso,
        other => panic!("{other:?}"),
    };
    assert_eq!(iso("-20"), -20.0);
    assert_eq!(iso("25%"), 0.0);
    assert_eq!(iso("otsu"), 42.5);
    let default = resolved(&flags(&[]));
    assert!(matches!(default.scene.picture, Picture::Surface { iso, .. } if iso == 120.0));
    assert!(default.notes[0].starts_with("iso = 120"));
    assert!(resolved(&flags(&["--iso", "otsu"])).notes[0].contains("42.5"));
    // As typed, and no digits that only the arithmetic makes.
    let seven = resolved(&flags(&["--iso", "7%"]));
    assert_eq!(seven.notes, ["iso = 7% is -72"]);
    let third = resolved(&flags(&["--mode", "mip", "--window", "33.3%,90%"]));
    assert_eq!(third.notes, ["window = 33.3%,90% is 33.2,260"]);
    assert_ne!((0.333_f64 * 400.0 - 100.0).to_string(), "33.2");
    assert!(resolved(&flags(&["--iso", "301"])).notes[0].contains("above"));
    assert!(resolved(&flags(&["--iso", "30"])).notes.is_empty());
    let lmip = resolved(&flags(&["--mode", "lmip", "--lmip-threshold", "50%"]));
    let Picture::Projection { of, .. } = lmip.scene.picture else {
        panic!("lmip is a projection")
    };
    assert_eq!(of, Projection::LocalMaximum { threshold: 100.0 });
}

#[test]
fn a_projection_shows_the_whole_range_by_default() {
    let window = |line: &[&str]| match resolved(&flags(line)).scene.picture {
        Picture::Projection { window, .. } => (window.black(), window.white()),
        other => panic!("{other:?}"),
    };
    assert_eq!(window(&["--mode", "mip"]), (-100.0, 300.0));
    let given = ["--mode", "minip", "--window", "-50,200"];
    assert_eq!(window(&given), (-50.0, 200.0));
    let computed = ["--mode", "mean", "--window", "25%,otsu"];
    assert_eq!(window(&computed), (0.0, 42.5));
    // Upside down: the higher value is black.
    assert_eq!(
        window(&["--mode", "mip", "--window", "200,-50"]),
        (200.0, -50.0)
    );
    let empty = flags(&["--mode", "mip", "--window", "100,100"]).resolve(&SUBJECT);
    assert_eq!(empty.map_err(|e| e.exit_code()), Err(2));
    let constant = Subject {
        range: Range { min: 7.0, max: 7.0 },
        robust_range: Range { min: 7.0, max: 7.0 },
        ..SUBJECT
    };
    assert!(flags(&["--mode", "mip"]).resolve(&constant).is_ok());
}

/// Two voxels at the ends of the range do not make the defaults; shares of it are still its own.
#[test]
fn defaults_are_made_for_the_robust_range() {
    let outliers = Subject {
        range: Range {
            min: -3024.0,
            max: 30_000.0,
        },
        ..SUBJECT
    };
    let of = |line: &[&str]| flags(line).resolve(&outliers).unwrap();
    let window = |line: &[&str]| match of(line).scene.picture {
        Picture::Projection { window, .. } => (window.black(), window.white()),
        other => panic!("{other:?}"),
    };
    assert_eq!(window(&["--mode", "mip"]), (-100.0, 300.0));
    let whole = ["--mode", "mip", "--window", "0%,100%"];
    assert_eq!(window(&whole), (-3024.0, 30_000.0));
    let ends = |line: &[&str]| match of(line).scene.picture {
        Picture::Emission(emission) => {
            let knots = emission.transfer.knots();
            (knots[0].value, knots[knots.len() - 1].value)
        }
        other => panic!("{other:?}"),
    };
    assert_eq!(ends(&["--mode", "dvr", "--tf", "3dra"]), (-100.0, 300.0));
    let note =
        "the defaults cover the values -100 to 300: outliers or padding reach from -3024 to 30000";
    let is_noted = |line: &[&str]| of(line).notes.iter().any(|found| found == note);
    for line in [&["--mode", "mip"][..], &["--mode", "dvr"], &[]] {
        assert!(is_noted(line), "{line:?}");
    }
    // The controls: what needs no such default, and a volume without outliers.
    for line in [
        &whole[..],
        &["--iso", "50%"],
        &["--mode", "dvr", "--tf", "cta"],
    ] {
        assert!(!is_noted(line), "{line:?}");
    }
    assert!(resolved(&flags(&["--mode", "mip"])).notes.is_empty());
}

/// Scenes of every kind, far from the defaults.
#[rustfmt::skip]
const SCENES: [&[&str]; 13] = [
    &["head.nrrd"],
    &[
        "a/b,c.nrrd", "--iso", "33.333333333333336", "--caps", "off", "--refine", "newton:7",
        "--color", "#3366cc", "--shading", "blinn-phong", "--light", "-1,2,0.1", "--ambient", "0.3",
        "--diffuse", "0.6", "--specular", "0", "--shininess", "5", "--eye", "-1e-3,7.25,1e5",
        "--target", "0.1,0.2,0.30000000000000004", "--up", "1,1,1", "--ortho", "77.7", "--size",
        "31x17", "--step", "0.3", "--filter", "nearest", "--traverse", "kd-restart", "--skip",
        "off", "--background", "0.1,0.2,0.3", "--brightness", "-0.25", "--contrast", "1.5",
        "--gamma", "2.2", "--smooth", "0.7", "--octree-leaf", "16", "--frame", "3",
        "--non-finite", "refuse", "--raw-size", "7x8x9", "--raw-type", "i16be", "--raw-spacing",
        "0.5", "--raw-offset", "128",
    ],
    &["--mode", "mip", "--carm", "RAO 33.3 CAU 12.1", "--zoom", "1.7", "--roll", "11"],
    &["--mode", "lmip", "--lmip-threshold", "40%", "--window", "otsu,90%"],
    &["--mode", "mip", "--window", "250,-50", "--background", "white"],
    &["--mode", "minip", "--view", "superior"],
    &["--gradient", "precomputed", "--gradient-scale", "5", "--gradient-smooth", "0.7"],
    &["--mode", "dvr", "--shading", "phong", "--gradient", "fourth-order"],
    &["--clip-plane", "0.1,-2,3e-7,1e300", "--clip-plane", "-1,0,0,0.30000000000000004"],
    &["--mode", "dvr"],
    &["--mode", "dvr", "--tf", "cta", "--shading", "phong", "--termination", "0.95"],
    &["--light", "headlight@0.5", "--light", "point:1,-2,0.30000000000000004@#ffd0a0", "--light",
        "camera:-1,1,1@tomato@2", "--light", "0,0,1", "--ambient-color", "navy"],
    &["--mode", "dvr", "--shading", "blinn-phong", "--shade-from", "12.5%", "--light",
        "camera:0,0,1", "--diffuse-color", "0.3,0.2,1", "--specular-color", "#abc"],
];

#[test]
fn resolved_options_read_back_as_a_scene_file_make_the_same_scene() {
    for line in SCENES {
        let first = resolved(&flags(line));
        let text = first.options.to_toml().unwrap_or_else(|e| panic!("{e}"));
        let again = resolved(&file(&text));
        assert_eq!(again.scene, first.scene, "{text}");
        assert_eq!(again.options, first.options, "{text}");
        // The control: one digit more is another scene.
        let other = text.replace("contrast = 1", "contrast = 11");
        assert_ne!(resolved(&file(&other)).scene, first.scene, "{text}");
    }
}

#[test]
fn scene_files_take_strings_numbers_and_lists() {
    let as_text = file(
        "size = '64x32'\niso = '50'\neye = '1,2,3.5'\ncaps = 'off'\nbackground = '1,0,0.5'\nraw-size = '4x5x6'",
    );
    let as_values = file(
        "size = [64, 32]\niso = 50\neye = [1, 2, 3.5]\ncaps = false\nbackground = [1, 0, 0.5]\nraw-size = [4, 5, 6]",
    );
    assert_eq!(as_text, as_values);
    assert_eq!(as_text.camera.size, ImageSize::new(64, 32).ok());
    assert_eq!(file("size = 64").camera.size, ImageSize::new(64, 64).ok());
    let half = Some(Threshold::Percent(50.0));
    assert_eq!(file("iso = '50%'").picture.iso, half);
    assert_ne!(file("iso = 50.5"), file("iso = 50"));
    let inline = file("mode = 'dvr'\n[tf]\npoints = [[0, 0, 0, 0, 0], [1, 1, 1, 1, 0.5]]");
    assert!(matches!(
        inline.picture.tf,
        Some(TransferChoice::Written(_))
    ));
}

#[test]
fn files_named_in_a_scene_file_are_relative_to_it() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.toml");
    std::fs::write(&path, "volume = 'head.nrrd'\nmode = 'dvr'\ntf = 'own.toml'").unwrap();
    let tf = "points = [[5, 1, 1, 1, 0.5]]";
    std::fs::write(folder.path().join("own.toml"), tf).unwrap();
    let read = || SceneOptions::of_file(&SceneFile::read(&path).unwrap()).unwrap();
    let options = read().checked().unwrap();
    let volume = options.volume.volume.unwrap().0;
    assert_eq!(volume, folder.path().join("head.nrrd"));
    let Some(TransferChoice::Written(own)) = options.picture.tf else {
        panic!("the transfer function was not read")
    };
    assert_eq!(own.points[0][0], 5.0);
    // The control: a preset's name is no file.
    std::fs::write(&path, "mode = 'dvr'\ntf = 'mra'").unwrap();
    assert!(read().checked().is_ok());
    std::fs::write(&path, "mode = 'dvr'\ntf = 'none.toml'").unwrap();
    assert!(read().checked().is_err());
}

#[test]
fn an_iso_value_outside_the_range_says_what_is_shown() {
    let Range { min, max } = SUBJECT.range;
    let notes = |text: &str| {
        let notes = resolved(&file(text)).notes.into_iter();
        let of_surface = notes.filter(|note| note.contains("no surface"));
        of_surface.collect::<Vec<String>>()
    };
    let below = notes(&format!("iso = {}", min - 1.0));
    assert!(
        below[0].contains("below") && below[0].contains("only its caps"),
        "{below:?}"
    );
    let open = notes(&format!("iso = {}\ncaps = 'off'", min - 1.0));
    assert!(
        open[0].contains("below") && open[0].contains("without caps nothing"),
        "{open:?}"
    );
    for caps in ["on", "off"] {
        let above = notes(&format!("iso = {}\ncaps = '{caps}'", max + 1.0));
        assert!(
            above[0].contains("above") && above[0].ends_with("nothing is shown"),
            "{above:?}"
        );
        // The control: the ends are values of the volume.
        assert!(notes(&format!("iso = {min}\ncaps = '{caps}'")).is_empty());
        assert!(notes(&format!("iso = {max}\ncaps = '{caps}'")).is_empty());
    }
}

#[test]
fn order_statistics_are_replaced_by_their_values() {
    // Those wanted, each once, in ascending order.
    let values = |percents: &[f64]| {
        assert_eq!(percents, [1.0, 99.5]);
        vec![7.0, 40.0]
    };
    let given = file("mode = 'lmip'\nwindow = 'p99.5,P1'\nlmip-threshold = 'p1'");
    assert!(given.resolve(&SUBJECT).is_err());
    let (options, notes) = given.measured(SUBJECT.range, values);
    assert_eq!(
        options,
        file("mode = 'lmip'\nwindow = [40, 7]\nlmip-threshold = 7")
    );
    assert_eq!(
        notes,
        ["lmip-threshold = p1 is 7", "window = p99.5,p1 is 40,7"]
    );
    assert!(options.resolve(&SUBJECT).is_ok());
    // The controls: a share of the range is not, and nothing is wanted if none is named.
    let share = file("iso = '50%'");
    let of_share = share.clone().measured(SUBJECT.range, |_| unreachable!());
    assert_eq!(of_share, (share, vec![]));
    for wrong in ["p", "p101", "p-1", "pp5", "5p", "p5%"] {
        assert!(
            refusal(&format!("iso = '{wrong}'")).contains("is not a"),
            "{wrong}"
        );
    }
}

#[test]
fn a_flag_wins_over_the_file() {
    let scene = "mode = 'iso'\niso = 10\ncaps = false\nstep = 0.25\nview = 'left'\nfov = 50\n";
    let merged = flags(&["--iso", "20", "--view", "right"]).over(file(scene));
    assert_eq!(merged.picture.iso, Some(Threshold::Value(20.0)));
    assert_eq!(merged.sampling.step, file(scene).sampling.step);
    assert!(resolved(&merged).scene.camera.eye_world().x < 0.0);
    // What a flag rules out in the file goes with it.
    let mip = flags(&["--mode", "mip"]).over(file(scene));
    assert_eq!(resolved(&mip).scene.picture.mode().name(), "mip");
    let eye = flags(&["--eye", "9,9,9"]).over(file(scene));
    assert_eq!(resolved(&eye).scene.camera.eye_world(), DVec3::splat(9.0));
    let ortho = flags(&["--ortho", "5"]).over(file(scene));
    let lens = resolved(&ortho).scene.camera.lens();
    assert_eq!(lens, Lens::Orthographic { height_mm: 5.0 });
    for line in SCENES {
        let whole = resolved(&flags(line)).options;
        for mode in ["iso", "mip", "lmip", "minip", "mean", "dvr"] {
            let other = flags(&["--mode", mode, "--view", "left"]).over(whole.clone());
            assert_eq!(resolved(&other).scene.picture.mode().name(), mode);
        }
    }
    // The control: within one source the same is nonsense.
    assert!(file("mode = 'mip'\niso = 10").checked().is_err());
}

#[test]
fn nonsense_is_refused_with_a_reason() {
    for (text, reason) in [
        (
            "mode = 'iso'\ntf = 'cta'",
            "'tf' cannot be combined with mode 'iso'",
        ),
        ("tf = 'cta'", "'tf' cannot be combined with mode 'iso'"),
        (
            "mode = 'mip'\ncaps = true",
            "'caps' cannot be combined with mode 'mip'",
        ),
        (
            "mode = 'mip'\nlmip-threshold = 4",
            "cannot be combined with mode 'mip'",
        ),
        ("mode = 'mean'\nshading = 'phong'", "no surface to light"),
        (
            "mode = 'dvr'\nwindow = '1,2'",
            "'window' cannot be combined with",
        ),
        ("mode = 'dvr'\nlight = 'headlight'", "without shading"),
        ("shading = 'none'\nspecular = 0.5", "without shading"),
        ("fov = 30\northo = 100", "cannot be combined"),
        ("eye = [1, 2, 3]\nview = 'left'", "cannot be combined"),
        ("eye = [1, 2, 3]\ncarm = 'LAO 3'", "cannot be combined"),
        ("carm = 'LAO 10'\nazimuth = 10", "cannot be combined"),
        (
            "mode = 'mip'\nrecon = 'adaptive'",
            "only a surface has a hit at which to change the filter",
        ),
        ("sampling = 'exact'\nrecon = 'adaptive'", "takes no samples"),
        ("sampling = 'exact'\njitter = 'hash:1'", "need none"),
        (
            "mode = 'dvr'\nquad = 'adaptive'\njitter = 'interleaved:4'",
            "need none",
        ),
        (
            "recon = 'adaptive'\nfilter = 'nearest'",
            "of which every sample already is",
        ),
        ("recon = 'adaptive'\nprobe = 'on'", "no slope"),
        ("up = [0, 1, 0]", "'up' can only be given with 'eye'"),
        ("eye = [0, 2e12, 0]", "'eye' is too far away"),
    ] {
        let message = refusal(text);
        assert!(message.contains(reason), "{text}: {message}");
    }
    // The controls: the same keys where they mean something.
    for text in [
        "mode = 'dvr'\ntf = 'cta'",
        "mode = 'iso'\ncaps = true",
        "mode = 'lmip'\nlmip-threshold = 4",
        "mode = 'dvr'\nshading = 'phong'\nlight = 'headlight'",
        "sampling = 'fixed'\nrecon = 'adaptive'\nprobe = 'off'",
        "sampling = 'exact'\njitter = 'none'",
        "mode = 'dvr'\nquad = 'simpson'\njitter = 'interleaved:4'",
        "recon = 'full'\nfilter = 'nearest'\nprobe = 'on'",
        "carm = 'LAO 10'\nview = 'anterior'",
        "eye = [1, 2, 3]\nzoom = 2\nroll = 10\nazimuth = 5",
        "eye = [0, 1e12, 0]",
    ] {
        assert!(file(text).checked().is_ok(), "{text}");
    }
}

#[test]
fn light_that_means_nothing_is_refused_with_a_reason() {
    for (text, reason) in [
        ("mode = 'dvr'\nspecular-color = 'red'", "without shading"),
        ("mode = 'mip'\nambient-color = 'red'", "no surface to light"),
        ("shade-from = 3", "only a medium has points"),
        ("mode = 'dvr'\nshade-from = 3", "without shading"),
        (
            "light = ['1,0,0', '0,1,0', '0,0,1', 'headlight', 'point:1,2,3']",
            "5 lights: there may be at most 4",
        ),
        (
            "mode = 'dvr'\nshading = 'phong'\nshade-from = 3\ngradient = 'precomputed'",
            "of which only the direction is stored",
        ),
    ] {
        let message = refusal(text);
        assert!(message.contains(reason), "{text}: {message}");
    }
    // The controls: the same keys where they mean something.
    for text in [
        "mode = 'dvr'\nshading = 'phong'\nshade-from = 3",
        "mode = 'dvr'\nshading = 'phong'\nshade-from = 0\ngradient = 'precomputed'",
        "light = ['1,0,0', '0,1,0', '0,0,1', 'headlight']",
    ] {
        assert!(file(text).checked().is_ok(), "{text}");
    }
}

#[test]
fn a_wrong_scene_file_is_refused_with_its_line() {
    let inline_tf = "mode = 'dvr'\n[tf]\npoints = [\n [0, 0, 0, 0, 0],\n [1, 0, 0, 0, 2],\n]";
    for (text, place) in [
        ("mode = 'mip'\n\nwindow = 'x'", "scene.toml:3: "),
        (
            "size = 9\nmood = 'dark'",
            "scene.toml:2: 'mood' is not an option",
        ),
        ("raw_size = '4x4x4'", "scene.toml:1: 'raw_size'"),
        ("step = 0", "scene.toml:1: "),
        ("fov = 180", "scene.toml:1: "),
        ("a = = 3", "scene.toml:1: "),
        ("\n\niso = [1, 2]", "scene.toml:3: "),
        ("\ntf = 7", "scene.toml:2: "),
        ("eye = [1, nan, 3]", "scene.toml:1: "),
        ("background = [0, 0, 2]", "scene.toml:1: "),
        (inline_tf, "scene.toml:5: "),
    ] {
        let message = refusal(text);
        assert!(message.starts_with(place), "{text}: {message}");
        assert!(!message.contains('\n'), "{message}");
    }
}

#[test]
fn every_number_with_a_domain_refuses_what_is_outside() {
    for (flag, inside, outside) in [
        ("iso", "50%", ["101%", "nan", "1e39"]),
        ("fov", "0.1", ["1e-9", "180", "nan"]),
        ("ortho", "1", ["1e-13", "-1", "inf"]),
        ("zoom", "3", ["0", "-1", "1e9"]),
        ("step", "1", ["0", "1e-9", "101"]),
        ("termination", "1", ["0", "1.1", "nan"]),
        ("gamma", "2.2", ["0", "-1", "11"]),
        ("contrast", "0", ["-1", "101", "x"]),
        ("brightness", "-1", ["-2", "2", ""]),
        ("shininess", "1", ["0", "-3", "1e6"]),
        ("smooth", "0", ["-1", "nan", "1e9"]),
        ("azimuth", "-360", ["nan", "inf", "1e9"]),
        ("light", "0,-1,0", ["0,0,0", "1,2", "lamp"]),
        (
            "light",
            "point:0,0,0@red@0",
            ["camera:0,0,0", "point:1,2,inf", "headlight@-1"],
        ),
        (
            "light",
            "camera:1,2,3@2",
            ["headlight@", "headlight@2@red", "sun:1,2,3"],
        ),
        ("specular-color", "white", ["2,0,0", "nocolour", "1"]),
        ("shade-from", "20%", ["101%", "-1", "p5"]),
        ("raw-spacing", "0.5", ["0", "1,2", "-1,1,1"]),
        ("color", "#A0b1c2", ["#12345", "1,1", "#gggggg"]),
        ("size", "640x480", ["0", "4x", "70000x70000"]),
        ("mode", "minip", ["mip2", "", "xray"]),
        ("refine", "illinois:3", ["newton:0", "secant", "none:3"]),
        ("window", "otsu,90%", ["5", "0,1e39", ""]),
    ] {
        let accepted = |value: &str| {
            let flag_takes = Flags::try_parse_from(["angioray", &format!("--{flag}={value}")]);
            let key_takes = SceneOptions::parse(&format!("{flag} = '{value}'"), "scene.toml");
            assert_eq!(flag_takes.is_ok(), key_takes.is_ok(), "{flag} {value}");
            flag_takes.is_ok()
        };
        assert!(accepted(inside), "{flag} {inside}");
        for value in outside {
            assert!(!accepted(value), "{flag} {value}");
        }
    }
}

#[test]
fn lights_come_as_one_list_from_the_flags_or_from_the_file() {
    let two = "light = ['point:1,2,3@0.5', 'camera:0,1,1@#f00']";
    let of_file = resolved(&file(two)).scene.lights;
    let as_flags = ["--light", "point:1,2,3@0.5", "--light", "camera:0,1,1@#f00"];
    assert_eq!(of_file, resolved(&flags(&as_flags)).scene.lights);
    assert_eq!(of_file.len(), 2);
    // Flags win over the file as a whole.
    let over = flags(&["--light", "headlight"]).over(file(two));
    assert_eq!(resolved(&over).scene.lights, [Light::HEADLIGHT]);
    assert_eq!(resolved(&file("")).scene.lights, [Light::HEADLIGHT]);
    // A light alone is stored as it always was.
    let stored = |text: &str| resolved(&file(text)).options.to_toml().unwrap();
    assert!(stored("light = '1,-2,0.5'").contains("light = [1, -2, 0.5]\n"));
    assert!(stored("").contains("light = \"headlight\"\n"));
}

#[test]
fn a_share_to_shade_from_is_one_of_the_range_in_a_voxel() {
    let shaded_from = |text: &str| {
        let text = format!("mode = 'dvr'\nshading = 'phong'\n{text}");
        match resolved(&file(&text)).scene.picture {
            Picture::Emission(medium) => medium.shaded_from.get(),
            _ => f64::NAN,
        }
    };
    let spacing_mm = SUBJECT.spacing_mm.min_element();
    let expected = 0.1 * SUBJECT.range.width() / spacing_mm;
    assert!((shaded_from("shade-from = '10%'") - expected).abs() < 1e-9 * expected);
    assert_eq!(shaded_from("shade-from = 7.5"), 7.5);
    assert_eq!(shaded_from(""), 0.0);
}

#[test]
fn what_a_gradient_lacks_gives_way_to_a_flag() {
    let text = "mode = 'dvr'\nshading = 'phong'\n";
    let weighed = flags(&["--shade-from", "3"]);
    let weighed = weighed.over(file(&format!("{text}gradient = 'precomputed'")));
    assert!(weighed.picture.gradient.is_none());
    let stored = flags(&["--gradient", "precomputed"]);
    let stored = stored.over(file(&format!("{text}shade-from = 3")));
    assert!(stored.picture.shade_from.is_none());
    // The control: another gradient goes with it.
    let forward = flags(&["--gradient", "forward"]).over(file(&format!("{text}shade-from = 3")));
    assert!(forward.picture.shade_from.is_some());
}

#[test]
fn clip_planes_come_as_one_list_from_the_flags_or_from_the_file() {
    let two = "clip-plane = [[1, 0, 0, -2.5], '0,-2,0,7']";
    let of_file = resolved(&file(two)).scene.clip_planes;
    let as_flags = ["--clip-plane", "1,0,0,-2.5", "--clip-plane", "0,-2,0,7"];
    assert_eq!(of_file, resolved(&flags(&as_flags)).scene.clip_planes);
    assert_eq!(of_file.len(), 2);
    assert_eq!(of_file[1].normal_world(), DVec3::new(0.0, -2.0, 0.0));
    // Flags win over the file as a whole.
    let over = flags(&["--clip-plane", "0,0,1,3"]).over(file(two));
    let over = resolved(&over).scene.clip_planes;
    assert_eq!(over.len(), 1);
    assert_eq!(over[0].offset(), 3.0);
    assert!(resolved(&file("")).scene.clip_planes.is_empty());
    // The stored scene has them as lists of numbers.
    let text = resolved(&file(two)).options.to_toml().unwrap();
    assert!(
        text.contains("clip-plane = [[1, 0, 0, -2.5], [0, -2, 0, 7]]"),
        "{text}"
    );
    for wrong in [
        "clip-plane = [1, 0, 0, 5]",
        "clip-plane = [[1, 0, 0]]",
        "clip-plane = [[0, 0, 0, 1]]",
        "clip-plane = [[nan, 0, 0, 1]]",
        "clip-plane = 7",
    ] {
        assert!(refusal(wrong).contains("scene.toml:1"), "{wrong}");
    }
    // A plane that keeps nothing is noted: the volume is a ball of 10 mm about 1,2,3.
    let notes = |plane: &str| resolved(&flags(&["--iso", "1", "--clip-plane", plane])).notes;
    assert_eq!(
        notes("0,0,-2,-14.01"),
        ["clip-plane = 0,0,-2,-14.01 keeps nothing of the volume"]
    );
    assert!(notes("0,0,-2,-13.99").is_empty());
}

#[test]
fn gradients_belong_to_normals_and_their_numbers_to_precomputed_ones() {
    let gradient = |line: &[&str]| resolved(&flags(line)).scene.gradient;
    assert_eq!(gradient(&[]), Gradient::Central);
    let precomputed = |scale, sigma| Gradient::Precomputed(Precomputed::new(scale, sigma).unwrap());
    assert_eq!(
        gradient(&["--gradient", "precomputed"]),
        precomputed(2, 0.0)
    );
    let line = ["--gradient", "precomputed", "--gradient-scale", "8"];
    assert_eq!(gradient(&line), precomputed(8, 0.0));
    let unshaded = ["--shading", "none", "--gradient", "forward"];
    assert_eq!(gradient(&unshaded), Gradient::Forward);
    for (wrong, reason) in [
        (
            "gradient-scale = 3",
            "'gradient-scale' cannot be combined with gradient 'central'",
        ),
        (
            "gradient = 'forward'\ngradient-smooth = 1",
            "only precomputed gradients are smoothed",
        ),
        (
            "mode = 'mip'\ngradient = 'central'",
            "a projection has no normals",
        ),
        ("mode = 'dvr'\ngradient = 'forward'", "without shading"),
        (
            "gradient = 'sobel'",
            "central, forward, fourth-order, precomputed",
        ),
        (
            "gradient = 'precomputed'\ngradient-scale = 9",
            "from 1 to 8",
        ),
        (
            "gradient = 'precomputed'\ngradient-scale = 0",
            "from 1 to 8",
        ),
        (
            "gradient = 'precomputed'\ngradient-smooth = -1",
            "from 0 to 100 voxels",
        ),
    ] {
        let message = refusal(wrong);
        assert!(message.contains(reason), "{wrong}: {message}");
    }
    // A flag drops what of the file it rules out, and nothing else.
    let of_file = "gradient = 'precomputed'\ngradient-scale = 4";
    let over = |line: &[&str], text: &str| resolved(&flags(line).over(file(text))).scene.gradient;
    assert_eq!(over(&[], of_file), precomputed(4, 0.0));
    assert_eq!(over(&["--gradient", "forward"], of_file), Gradient::Forward);
    assert_eq!(
        over(&["--gradient-scale", "3"], of_file),
        precomputed(3, 0.0)
    );
    assert_eq!(over(&["--mode", "mip"], of_file), Gradient::Central);
    assert_eq!(over(&["--mode", "dvr"], of_file), Gradient::Central);
    let shaded = ["--mode", "dvr", "--shading", "phong"];
    assert_eq!(over(&shaded, of_file), precomputed(4, 0.0));
    assert_eq!(over(&["--shading", "none"], of_file), precomputed(4, 0.0));
    let stray = flags(&["--iso", "1"]).over(file("mode = 'mip'\ngradient = 'forward'"));
    assert!(stray.checked().is_err());
}

/// Each in one sentence that names both; what is right beside it is taken.
#[test]
fn what_dvr_averages_and_sums_belongs_to_it_alone() {
    for (wrong, reason) in [
        (
            "mode = 'iso'\nquad = 'rk4'",
            "'quad' cannot be combined with mode 'iso'",
        ),
        (
            "mode = 'mip'\nquad = 'adaptive'",
            "'quad' cannot be combined with mode 'mip'",
        ),
        ("quad = 'simpson'", "only dvr sums light along the ray"),
        (
            "mode = 'dvr'\nquad = 'simpson:1e-3'",
            ":BOUND is adaptive's alone",
        ),
        (
            "mode = 'dvr'\nquad = 'adaptive:1'",
            "an error from 1e-5 to 0.1",
        ),
        (
            "mode = 'mean'\nhomogeneity = 0.1",
            "'homogeneity' cannot be combined with mode 'mean'",
        ),
        (
            "mode = 'dvr'\nhomogeneity = 0.1\nshading = 'phong'",
            "'homogeneity' cannot be combined with shading",
        ),
        (
            "mode = 'dvr'\nhomogeneity = 0.1\nquad = 'adaptive'",
            "'homogeneity' cannot be combined with quad 'adaptive'",
        ),
        (
            "mode = 'dvr'\nhomogeneity-rule = 'range'",
            "no effect without 'homogeneity'",
        ),
        ("mode = 'dvr'\nhomogeneity = 0", "above 0 and at most 1"),
        ("mode = 'dvr'\nhomogeneity = 1.5", "above 0 and at most 1"),
        ("mode = 'dvr'\nhomogeneity-rule = 'paper'", "optical, range"),
        ("clip-plane = [[0, 0, 0, 1]]", "has no direction"),
    ] {
        let message = refusal(wrong);
        assert!(message.contains(reason), "{wrong}: {message}");
        assert!(!message.contains('\n'), "{wrong}: {message}");
    }
    for right in [
        "mode = 'dvr'\nquad = 'adaptive:1e-3'\nshading = 'phong'",
        "mode = 'dvr'\nhomogeneity = 1\nquad = 'preintegrated'",
        "mode = 'dvr'\nhomogeneity = 0.1\nhomogeneity-rule = 'range'",
    ] {
        assert!(file(right).checked().is_ok(), "{right}");
    }
    // Of a flag and the file, the flag wins.
    let quad = |line: &[&str], text: &str| {
        let options = flags(line).over(file(text)).checked().unwrap();
        (options.picture.quad, options.picture.homogeneity.is_some())
    };
    let averaged = "mode = 'dvr'\nhomogeneity = 0.1";
    let adaptive = "adaptive:0.001".parse().ok();
    assert_eq!(quad(&["--quad", "adaptive"], averaged), (adaptive, false));
    let (quadrature, is_averaged) =
        quad(&["--homogeneity", "0.1"], "mode = 'dvr'\nquad = 'adaptive'");
    assert!(quadrature.is_none() && is_averaged);
}

#[test]
fn there_are_64_clip_planes_at_most() {
    let planes = |count: usize| {
        let plane = ["--clip-plane", "0,0,1,5"];
        flags(&plane.repeat(count)).checked()
    };
    assert!(planes(64).is_ok());
    let error = planes(65).map(|_| ()).unwrap_err();
    assert_eq!(error.exit_code(), 2);
    assert_eq!(error.to_string(), "65 clip planes: there may be at most 64");
}

#[test]
fn the_filter_at_hits_alone_implies_steps_without_a_probe_and_gives_way_to_exact_sampling() {
    let resolved = |text: &str| file(text).resolve(&SUBJECT).unwrap();
    let adaptive = resolved("recon = 'adaptive'");
    let sampling = adaptive.scene.sampling;
    assert_eq!(sampling.method, SamplingMethod::Fixed);
    assert_eq!(sampling.recon, Reconstruction::Adaptive);
    assert!(!sampling.probe);
    let toml = adaptive.options.to_toml().unwrap();
    assert!(toml.contains("recon = \"adaptive\""), "{toml}");
    assert_eq!(resolved(&toml).scene, adaptive.scene);
    // The controls: without it there is a probe, and other modes do not speak of it.
    assert!(resolved("sampling = 'fixed'").scene.sampling.probe);
    let mip = resolved("mode = 'mip'\nsampling = 'fixed'");
    assert!(!mip.options.to_toml().unwrap().contains("recon"));
    let exact = file("sampling = 'exact'").over(file("recon = 'adaptive'"));
    assert_eq!(
        resolved(&exact.to_toml().unwrap()).scene.sampling.method,
        SamplingMethod::Exact
    );
}
