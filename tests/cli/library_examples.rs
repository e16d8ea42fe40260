//! The programs under `examples`, as a user of the library runs them.

use std::path::PathBuf;
use std::process::{Command, Output};

use crate::cli_place::Place;
use crate::common;

/// A built example; `None`, with a message, where this run built none.
fn example(name: &str) -> Option<PathBuf> {
    // Beside the folder of the test programs.
    let test = std::env::current_exe().unwrap();
    let folder = test.parent().unwrap().parent().unwrap().join("examples");
    let path = folder.join(format!("{name}{}", std::env::consts::EXE_SUFFIX));
    if path.exists() {
        return Some(path);
    }
    assert!(
        std::env::var_os("REQUIRE_EXAMPLES").is_none(),
        "there is no {}: build it with cargo build --examples",
        path.display()
    );
    common::skip("the examples are not built: cargo build --examples");
    None
}

/// Runs an example in a folder with a volume.
fn run(name: &str, arguments: &[&str]) -> Option<(Place, Output)> {
    common::device()?;
    let path = example(name)?;
    let place = Place::empty();
    place.done("phantom vessels -o head.nrrd --size 32");
    let output = Command::new(path)
        .args(arguments)
        .current_dir(place.path(""))
        .output()
        .unwrap();
    Some((place, output))
}

fn text(output: &Output) -> String {
    let all = [output.stdout.as_slice(), &output.stderr].concat();
    String::from_utf8(all).unwrap()
}

#[test]
fn render_mip_saves_a_picture() {
    let Some((place, output)) = run("render_mip", &["head.nrrd", "head.png"]) else {
        return;
    };
    assert!(output.status.success(), "{}", text(&output));
    let picture = angioray::frame::read_display(&place.path("head.png")).unwrap();
    let display = picture.display.unwrap();
    assert!(display.iter().any(|pixel| pixel[0] > 0.5));
    // The control: without a volume it says how it is used.
    let (_, output) = run("render_mip", &[]).unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output).contains("usage"), "{}", text(&output));
}

#[test]
fn save_layers_saves_what_is_proven() {
    let Some((place, output)) = run("save_layers", &["head.nrrd", "head.exr"]) else {
        return;
    };
    let printed = text(&output);
    assert!(output.status.success(), "{printed}");
    assert!(printed.contains("of 262144 pixels hit"), "{printed}");
    let bytes = std::fs::read(place.path("head.exr")).unwrap();
    let holds = |name: &[u8]| bytes.windows(name.len()).any(|window| window == name);
    assert!(holds(b"certificate") && holds(b"depth"));
    assert!(!holds(b"steps"));
}

#[test]
fn reference_error_reports_a_smaller_error_for_a_smaller_step() {
    let Some((_, output)) = run("reference_error", &["head.nrrd"]) else {
        return;
    };
    let printed = text(&output);
    assert!(output.status.success(), "{printed}");
    let rmse = |line: &str| -> f64 {
        let (_, rest) = line.split_once("rmse ").unwrap();
        rest.split(',').next().unwrap().parse().unwrap()
    };
    let errors: Vec<f64> = printed.lines().map(rmse).collect();
    assert!(
        errors.len() == 2 && errors[1] < errors[0] / 4.0,
        "{printed}"
    );
}
