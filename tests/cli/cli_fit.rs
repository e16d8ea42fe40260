//! `--fit`: what fits the picture. Pictures by the reference, small, and where there is a device by it too.

use crate::cli_place;
use crate::common;

use cli_place::{Place, pixels, stderr};
use serde_json::Value;

/// Pixels along each side of a picture.
const SIDE: usize = 48;
const REFERENCE: &str = "--device reference --size 48";
/// A ball of 200 in 0, six voxels in radius, in a corner of 64 × 48 × 40 voxels of unlike spacings.
const BALL: &str = "ball.raw --raw-size 64x48x40 --raw-type u8 --raw-spacing 0.5,0.75,1";
/// Every mode that has a content, so that the ball is white on black.
const MODES: [&str; 4] = [
    "--mode iso --iso 100 --shading none",
    "--mode mip --window 50,200",
    "--mode lmip --lmip-threshold 100 --window 50,200",
    "--mode dvr --tf ball.toml",
];

fn place() -> Place {
    let place = Place::empty();
    let value = |at: usize| {
        let (x, y, z) = (at % 64, at / 64 % 48, at / (64 * 48));
        let from_center = [(x, 54.0), (y, 8.0), (z, 31.0)].map(|(at, of)| at as f64 - of);
        let is_inside = from_center.iter().map(|d| d * d).sum::<f64>() <= 36.0;
        if is_inside { 200 } else { 0 }
    };
    let voxels: Vec<u8> = (0..64 * 48 * 40).map(value).collect();
    std::fs::write(place.path("ball.raw"), voxels).unwrap();
    let points = "[[50, 1, 1, 1, 0.0], [200, 1, 1, 1, 0.9]]";
    let transfer = format!("unit_length_mm = 1.0\nunits = \"value\"\npoints = {points}\n");
    place.write("ball.toml", &transfer);
    place
}

/// The scene that is stored in the statistics of a picture of the ball.
fn scene(place: &Place, flags: &str) -> Value {
    place.done(&format!(
        "render {BALL} -o a.png --stats a.json {flags} {REFERENCE}"
    ));
    place.json("a.json")["scene"].clone()
}

/// Where the eye is and what it looks at.
fn eye_and_target(scene: &Value) -> [[f64; 3]; 2] {
    ["eye", "target"].map(|key| {
        let numbers = scene[key].as_array().unwrap();
        [0, 1, 2].map(|axis| numbers[axis].as_f64().unwrap())
    })
}

fn distance(scene: &Value) -> f64 {
    let [eye, target] = eye_and_target(scene);
    let squares = [0, 1, 2].map(|axis| (eye[axis] - target[axis]).powi(2));
    squares.iter().sum::<f64>().sqrt()
}

/// Of the pixels that are not black, the share of the side that they span, and whether some are at an edge.
fn seen(place: &Place, file: &str) -> (f64, bool) {
    let pixels = pixels(&place.path(file));
    let lit = (0..pixels.len()).filter(|at| pixels[*at][0] > 0.0);
    let places: Vec<[usize; 2]> = lit.map(|at| [at % SIDE, at / SIDE]).collect();
    let along = |axis: usize| {
        let places = places.iter().map(|place| place[axis]);
        let ends = places.clone().min().zip(places.max());
        ends.unwrap_or_else(|| panic!("{file} is black"))
    };
    let [x, y] = [along(0), along(1)];
    let is_cut = [x, y]
        .iter()
        .any(|(first, last)| *first == 0 || *last == SIDE - 1);
    let span = (x.1 - x.0).max(y.1 - y.0) + 1;
    (span as f64 / SIDE as f64, is_cut)
}

#[test]
fn a_ball_in_a_corner_fills_the_picture_by_its_content_alone() {
    let place = place();
    let check = |flags: &str| {
        let render = |fit: &str| {
            place.done(&format!("render {BALL} -o a.png {flags} {fit}"));
            seen(&place, "a.png")
        };
        let (span, is_cut) = render("");
        assert!(span > 0.65 && !is_cut, "{flags}: {span} {is_cut}");
        assert_eq!(render("--fit content"), (span, is_cut));
        // The controls: by the volume it is small, and what is magnified is cut.
        let (span, is_cut) = render("--fit volume");
        assert!(span < 0.3 && !is_cut, "{flags}: {span} {is_cut}");
        assert!(render("--zoom 2").1, "{flags}");
    };
    for mode in MODES {
        for seen_as in [
            "",
            "--view left",
            "--azimuth 50 --elevation 30 --filter nearest",
        ] {
            check(&format!("{mode} {seen_as} {REFERENCE}"));
        }
        if let Some(device) = common::device_flag() {
            check(&format!("{mode} --size 48 {device}"));
        }
    }
}

#[test]
fn a_mode_that_shows_all_of_the_volume_or_nothing_fits_the_volume() {
    let place = place();
    let of_volume = eye_and_target(&scene(&place, "--iso 100 --fit volume"));
    for flags in [
        "--mode minip --window 0,200",
        "--mode mean --window 0,200",
        "--iso 250",
        "--mode mip --window 200,300",
    ] {
        assert_eq!(eye_and_target(&scene(&place, flags)), of_volume, "{flags}");
    }
    // The control: what shows the ball does not.
    for mode in MODES {
        assert_ne!(eye_and_target(&scene(&place, mode)), of_volume, "{mode}");
    }
}

/// Neither how rays are followed nor what is cut away changes the sphere.
#[test]
fn the_camera_is_the_same_for_every_leaf_traversal_and_device() {
    let place = place();
    for mode in MODES {
        let expected = eye_and_target(&scene(&place, mode));
        let by_reference = [
            "--octree-leaf 8",
            "--octree-leaf 32 --traverse uniform",
            "--skip off",
            "--clip-plane 1,0,0,27",
        ];
        let by_reference = by_reference.map(|flags| format!("{flags} --device reference"));
        for flags in by_reference.into_iter().chain(common::device_flag()) {
            place.done(&format!(
                "render {BALL} -o a.png --stats a.json --size 48 {mode} {flags}"
            ));
            let found = eye_and_target(&place.json("a.json")["scene"]);
            assert_eq!(found, expected, "{flags}");
        }
        // The control: another field has other cells.
        let nearest = scene(&place, &format!("{mode} --filter nearest"));
        assert_ne!(eye_and_target(&nearest), expected, "{mode}");
    }
}

#[test]
fn the_frames_of_an_orbit_share_their_target_and_distance() {
    let place = place();
    let iso = "--mode iso --iso 100";
    place.done(&format!(
        "orbit {BALL} -o f%d.png --frames 4 {iso} --elevation 20 {REFERENCE}"
    ));
    let first = scene(&place, &format!("{iso} --elevation 20"));
    let mut eyes = Vec::new();
    for frame in 0..4 {
        let metadata = angioray::frame::read_metadata(&place.path(&format!("f{frame}.png")));
        let metadata = metadata.unwrap();
        let (_, text) = metadata.iter().find(|(key, _)| key == "scene").unwrap();
        let of_frame = serde_json::to_value(text.parse::<toml::Table>().unwrap()).unwrap();
        let [eye, target] = eye_and_target(&of_frame);
        assert_eq!(target, eye_and_target(&first)[1], "{frame}");
        assert!(
            (distance(&of_frame) - distance(&first)).abs() < 1e-9,
            "{frame}"
        );
        assert!(of_frame.get("fit").is_none(), "{text}");
        let (span, is_cut) = seen(&place, &format!("f{frame}.png"));
        assert!(span > 0.65 && !is_cut, "{frame}: {span} {is_cut}");
        eyes.push(eye);
    }
    // The control: they are seen from four places.
    assert!(eyes.windows(2).all(|pair| pair[0] != pair[1]), "{eyes:?}");
}

#[test]
fn the_modes_of_a_comparison_are_seen_from_one_place() {
    let Some(device) = common::device_flag() else {
        return;
    };
    let place = place();
    // A second thing that only a maximum shows, in the opposite corner.
    let mut voxels = std::fs::read(place.path("ball.raw")).unwrap();
    voxels[(3 * 48 + 40) * 64 + 5] = 80;
    std::fs::write(place.path("ball.raw"), voxels).unwrap();
    place.write("one.toml", "[[setting]]\nname = 'coarse'\nstep = 2\n");
    let flags = "--configs one.toml --iso 100 --window 50,200";
    place.done(&format!(
        "compare {BALL} -o out --modes iso,mip --size 16 --repeats 1 --cache off {flags} {device}"
    ));
    let scenes = &place.json("out/results.json")["scenes"];
    let [iso, mip] = ["iso", "mip"].map(|mode| eye_and_target(&scenes[mode]));
    assert_eq!(iso, mip);
    let alone = |flags: &str| eye_and_target(&scene(&place, flags));
    assert_eq!(mip, alone("--mode mip --window 50,200"));
    // The control: alone the surface is seen from elsewhere.
    assert_ne!(iso, alone("--mode iso --iso 100"));
}

#[test]
fn a_picture_stores_its_camera_and_a_flag_frames_it_anew() {
    let place = place();
    let iso = "--mode iso --iso 100 --azimuth 30";
    place.done(&format!("render {BALL} -o a.png {iso} {REFERENCE}"));
    let pictures = |line: &str| {
        place.done(&format!("render -o b.png {line} --device reference"));
        pixels(&place.path("b.png"))
    };
    let stored = pixels(&place.path("a.png"));
    assert_eq!(pictures("--scene a.png"), stored);
    // Another iso value leaves the camera where it is.
    place.done("render --scene a.png --iso 30 -o b.png --stats b.json --device reference");
    let kept = place.json("b.json")["scene"].clone();
    assert_eq!(eye_and_target(&kept), eye_and_target(&scene(&place, iso)));
    // A flag frames it anew, which forgets from where it was seen.
    let framed = pictures("--scene a.png --fit volume --azimuth 30");
    let flags = format!("{iso} --fit volume");
    place.done(&format!("render {BALL} -o c.png {flags} {REFERENCE}"));
    assert_eq!(framed, pixels(&place.path("c.png")));
    // The control.
    assert_ne!(framed, stored);
}

#[test]
fn a_fit_beside_an_eye_is_refused() {
    let place = place();
    let refused =
        |flags: &str| place.refused(&format!("render {BALL} -o b.png {flags} {REFERENCE}"), 2);
    for fit in ["content", "volume"] {
        let message = refused(&format!("--eye 1,2,-300 --fit {fit}"));
        assert!(
            message.contains("error: 'eye' and 'fit' cannot be combined"),
            "{message}"
        );
    }
    let message = refused("--fit sphere");
    assert!(message.contains("volume, content"), "{message}");
    // The controls: each alone, and what is framed and turned.
    for flags in [
        "--eye 1,2,-300",
        "--fit volume",
        "--fit content --target 1,2,3 --roll 5",
    ] {
        let line = format!("render {BALL} -o a.png --iso 100 {flags} {REFERENCE}");
        let output = place.run(&line);
        assert!(output.status.success(), "{line}: {}", stderr(&output));
    }
}
