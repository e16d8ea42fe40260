//! `angioray bench effects` from outside: how far effects are from the reference's, which no machine's speed changes.

use serde_json::Value;

use crate::cli_place;
use crate::common;

use cli_place::Place;

/// The settings by mode and effect, beside the picture without it.
const SETTINGS: [(&str, &str, &[&str]); 6] = [
    (
        "iso",
        "ambient occlusion",
        &[
            "ao rays=4",
            "ao rays=16",
            "ao rays=64",
            "ao rays=256",
            "ao bound=0.1",
            "ao bound=0.05",
            "ssao samples=8",
            "ssao samples=16",
            "ssao samples=32",
            "ssao samples=64",
        ],
    ),
    ("iso", "shadows", &["shadows on"]),
    ("iso", "soft shadows", &["light-size 5"]),
    (
        "iso",
        "depth of field",
        &[
            "dof-method gather",
            "dof-method mix",
            "dof-method lens:16",
            "dof-method lens:64",
        ],
    ),
    (
        "dvr",
        "shadows",
        &[
            "shadows step=4",
            "shadows step=2",
            "shadows step=1",
            "shadows on",
            "shadows cached:128",
        ],
    ),
    (
        "dvr",
        "depth of field",
        &["dof-method gather", "dof-method lens:16"],
    ),
];

fn number(row: &Value, key: &str) -> f64 {
    row[key].as_f64().unwrap_or_else(|| panic!("{key}: {row}"))
}

/// The rows of an effect, checked to be those of its settings.
fn of_effect<'a>(rows: &mut impl Iterator<Item = &'a Value>, at: usize) -> Vec<&'a Value> {
    let (mode, effect, settings) = SETTINGS[at];
    let names = std::iter::once(&"without").chain(settings);
    let rows = names.map(|name| {
        let row = rows.next().unwrap();
        assert_eq!(
            [&row["mode"], &row["effect"], &row["setting"]],
            [mode, effect, name]
        );
        row
    });
    rows.collect()
}

/// Checks the figures of an effect that is judged by a share of light; of the picture without it the bias has this sign.
fn check_shares(rows: &[&Value], sign: f64) {
    for row in rows {
        assert_eq!(row["rmse"], Value::Null, "{row}");
        let [mean, p99, max, bias] = ["mean", "p99", "max", "bias"].map(|key| number(row, key));
        assert!(
            bias.abs() <= mean + 1e-12 && mean <= max && p99 <= max && max <= 1.0,
            "{row}"
        );
    }
    let without = rows[0];
    let apart = number(without, "bias") - sign * number(without, "mean");
    assert!(
        apart.abs() < 1e-12 && number(without, "mean") > 0.01,
        "{without}"
    );
    // What a setting is for; four rays are too few where little is occluded.
    for row in &rows[1..] {
        if row["setting"] == "ao rays=4" {
            continue;
        }
        assert!(
            number(row, "mean") < number(without, "mean"),
            "{row} {without}"
        );
    }
}

/// Checks the figures of depth of field.
fn check_colors(rows: &[&Value]) {
    for row in rows {
        assert_eq!(row["mean"], Value::Null, "{row}");
        let parts = ["in_focus_rmse", "near_rmse", "far_rmse", "beside_rmse"];
        let parts = parts.map(|key| number(row, key));
        let (least, most) = parts
            .iter()
            .fold((1.0, 0.0), |(least, most): (f64, f64), &part| {
                (least.min(part), most.max(part))
            });
        // All of them in one is a mean.
        assert!((least..=most).contains(&number(row, "rmse")), "{row}");
    }
    let rmse = |setting: &str| {
        let row = rows.iter().find(|row| row["setting"] == setting).unwrap();
        number(row, "rmse")
    };
    assert!(rmse("dof-method lens:16") < 0.5 * rmse("without"));
    assert!(rmse("dof-method gather") < rmse("without"));
}

#[test]
fn every_setting_has_its_error_and_its_time() {
    let Some(device) = common::device_flag() else {
        return;
    };
    let place = Place::empty();
    place.done("phantom vessels --size 40 -o tree.nrrd");
    place.done(&format!("bench effects tree.nrrd --quick -o out {device}"));
    let results = place.json("out/results.json");
    assert_eq!(results["failure"], Value::Null);
    let rows = results["rows"].as_array().unwrap();
    let mut rows_in_turn = rows.iter();
    let effects: Vec<Vec<&Value>> = (0..SETTINGS.len())
        .map(|at| of_effect(&mut rows_in_turn, at))
        .collect();
    assert_eq!(rows_in_turn.next(), None);
    for row in rows {
        assert!(
            number(row, "min_ms") > 0.0 && number(row, "ratio") > 0.0,
            "{row}"
        );
        assert!(number(row, "min_ms") <= number(row, "median_ms"), "{row}");
    }
    for effect in &effects {
        assert_eq!(number(effect[0], "ratio"), 1.0);
    }
    let [
        occlusion,
        shadows,
        soft,
        lens,
        shadows_in_medium,
        lens_in_medium,
    ] = &effects[..]
    else {
        panic!("{results:#}")
    };
    // Without occlusion too little of it is there, without shadows too much light.
    check_shares(occlusion, -1.0);
    for rows in [shadows, soft, shadows_in_medium] {
        check_shares(rows, 1.0);
    }
    check_colors(lens);
    check_colors(lens_in_medium);
    // More rays are nearer; a bound is kept by all but the few hits that voxels do not decide.
    let mean = |at: usize| number(occlusion[at], "mean");
    assert!(mean(2) < mean(1) && mean(3) < mean(2) && mean(4) < 0.4 * mean(1));
    assert!(number(occlusion[5], "p99") <= 0.1 && number(occlusion[6], "p99") <= 0.05);
    let findings = results["findings"].as_array().unwrap();
    let falls = findings.iter().filter_map(Value::as_str);
    assert!(
        falls
            .into_iter()
            .any(|text| text.contains("from 4 to 256 rays the mean error of ao"))
    );
    let page = std::fs::read_to_string(place.path("out/report.html")).unwrap();
    assert!(page.contains("soft shadows: mean error over time"));
}
