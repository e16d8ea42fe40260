//! `angioray bench pareto` from outside: the grid's figures that no machine's speed changes, and what
//! the front promises. Without a device the tests say so and pass, unless REQUIRE_OPENCL=1.

use crate::cli_place;
use crate::common;

use cli_place::Place;
use serde_json::Value;

/// Figures of the settings of a mode.
struct Setting {
    name: String,
    ms: f64,
    error: f64,
    on_front: bool,
}

fn settings(results: &Value, mode: &str) -> Vec<Setting> {
    let rows = results["rows"].as_array().unwrap().iter();
    rows.filter(|row| row["mode"] == mode)
        .map(|row| Setting {
            name: row["setting"].as_str().unwrap().to_owned(),
            ms: row["median_ms"].as_f64().unwrap(),
            error: row["error"].as_f64().unwrap(),
            on_front: row["on_front"] == "yes",
        })
        .collect()
}

fn error_of(settings: &[Setting], name: &str) -> f64 {
    let setting = settings.iter().find(|one| one.name == name);
    setting
        .unwrap_or_else(|| panic!("no setting '{name}'"))
        .error
}

#[test]
fn the_grid_is_evaluated_and_nothing_clearly_beats_its_front() {
    let Some(device) = common::device() else {
        return;
    };
    let place = Place::empty();
    place.done("phantom vessels -o tree.nrrd --size 32");
    let id = &device.info().id;
    place.done(&format!(
        "bench pareto tree.nrrd --quick -o out --device {id}"
    ));
    let results = place.json("out/results.json");
    for mode in ["iso", "mip", "dvr"] {
        let settings = settings(&results, mode);
        assert!(settings.len() > 15, "{mode}: {}", settings.len());
        let front: Vec<&Setting> = settings.iter().filter(|one| one.on_front).collect();
        assert!(!front.is_empty(), "{mode}");
        for one in &front {
            // Twice the noise within which times are equal.
            let beaten = |other: &&Setting| other.error <= one.error && other.ms * 1.22 < one.ms;
            let by = settings.iter().find(beaten);
            assert!(by.is_none(), "{mode}: {} by {}", one.name, by.unwrap().name);
        }
    }
    let iso = settings(&results, "iso");
    // At a tangent a hair decides: at most a pixel.
    let exact = error_of(&iso, "exact");
    assert!(exact <= error_of(&iso, "step 0.25, plain, regula-falsi:5"));
    let coarse = error_of(&iso, "step 2, plain, regula-falsi:5");
    let fine = error_of(&iso, "step 0.25, plain, regula-falsi:5");
    assert!(
        coarse > 2.0 * fine && coarse > 5.0 * exact,
        "{coarse} {fine} {exact}"
    );
    // Ways of skipping change no picture, so no error.
    for traversal in [
        "uniform",
        "kd-restart",
        "hierarchical",
        "revelles",
        "no skipping",
    ] {
        assert_eq!(
            error_of(&iso, &format!("exact, {traversal}")),
            exact,
            "{traversal}"
        );
    }
    let mip = settings(&results, "mip");
    assert!(error_of(&mip, "exact") < 1e-6, "a share of the range");
    assert!(error_of(&mip, "step 0.5, nearest") > error_of(&mip, "step 0.5"));
    let dvr = settings(&results, "dvr");
    for row in results["rows"].as_array().unwrap() {
        // 0 to 1, as everywhere.
        let rmse = row["color_rmse"].as_f64().unwrap();
        assert!((0.0..1.0).contains(&rmse), "{row}");
        if row["mode"] == "dvr" {
            assert_eq!(row["error"], row["color_rmse"]);
        }
    }
    assert!(error_of(&dvr, "adaptive:1e-4") < error_of(&dvr, "step 1, riemann"));
}
