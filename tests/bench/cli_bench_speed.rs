//! `angioray bench speed` from outside: its rows, their counters and errors, and a peer beside them; no
//! time is checked. Without a device the tests say so and pass, unless REQUIRE_OPENCL=1.

use crate::cli_place;
use crate::common;

use std::collections::BTreeSet;

use cli_place::{Place, stderr};
use serde_json::Value;

const PICTURES: [(&str, &str); 6] = [
    ("iso shaded", "exact"),
    ("iso shaded", "step 0.5"),
    ("mip", "exact"),
    ("mip", "step 0.5"),
    ("mean", "exact"),
    ("lmip", "exact"),
];

/// Draws surfaces and maxima black, in 7 ms of wall and 13 of processor time.
const BLACK_PEER: &str = r#"
echo '{"peer":"black","version":"1","device":"none","settings":[{"name":"plain","modes":["iso","mip"]}]}'
while read -r line; do
    case "$line" in
    *'"scene"'*)
        side=$(printf '%s' "$line" | sed 's/.*"size":\[\([0-9]*\),.*/\1/')
        echo '{"ready":2.5,"supported":true,"note":"black"}' ;;
    *'"color"'*)
        file=$(printf '%s' "$line" | sed 's/.*"color":"\([^"]*\)".*/\1/')
        head -c $((side * side * 16)) /dev/zero >"$file"
        echo '{"ms":7,"cpu_ms":13}' ;;
    *'"render"'*) echo '{"ms":7,"cpu_ms":13}' ;;
    *'"load"'*) echo '{"loaded":1.5}' ;;
    *'"forget"'*) echo '{}' ;;
    esac
done
"#;

fn rows(results: &Value) -> &[Value] {
    results["rows"].as_array().unwrap()
}

/// The row of a renderer in pictures of one size.
fn row<'a>(results: &'a Value, picture: &str, renderer: &str, mode: &str) -> &'a Value {
    let mut found = rows(results).iter().filter(|row| {
        row["picture"] == picture && row["renderer"] == renderer && row["mode"] == mode
    });
    let first = found.next();
    first.unwrap_or_else(|| panic!("no row of {renderer}, {mode}, {picture}"))
}

fn number(row: &Value, key: &str) -> f64 {
    row[key].as_f64().unwrap_or_else(|| panic!("{key}: {row}"))
}

fn keys(results: &Value) -> BTreeSet<&str> {
    let row = rows(results)[0].as_object().unwrap();
    row.keys().map(String::as_str).collect()
}

const KEYS: [&str; 20] = [
    "volume",
    "picture",
    "renderer",
    "mode",
    "setting",
    "frames",
    "min_ms",
    "median_ms",
    "cpu_min_ms",
    "cpu_median_ms",
    "cpu_over_cores_ms",
    "outside_cast_share",
    "samples",
    "megasamples_per_s",
    "roofline_share",
    "error",
    "of",
    "color_rmse",
    "color_max",
    "note",
];
const KEYS_BESIDE: [&str; 4] = ["peer", "peer_setting", "cpu_ratio", "wall_ratio"];

/// The rows of one picture size; sampling alone reads voxels from so many storages.
fn check_picture(results: &Value, picture: &str, storages: usize) {
    for (mode, setting) in PICTURES {
        let ours = rows(results).iter().filter(|row| {
            row["picture"] == picture && row["mode"] == mode && row["setting"] == setting
        });
        let [ours] = ours.collect::<Vec<_>>()[..] else {
            panic!("{mode}, {setting}, {picture}");
        };
        assert!(number(ours, "samples") > 0.0);
    }
    for mode in ["dvr", "dvr shaded"] {
        let row = row(results, picture, "angioray", mode);
        assert!(number(row, "color_max") <= 3.0 / 255.0, "{row}");
        assert_eq!(row["cpu_ratio"], Value::Null);
    }
    for mode in ["iso shaded", "mip"] {
        let exact = row(results, picture, "angioray", mode);
        assert!(number(exact, "error") < 1e-5, "{exact}");
        assert!(number(exact, "color_max") < 1e-2, "{exact}");
        // The control: the black picture is wrong, by the same measure.
        let black = row(results, picture, "black 1", mode);
        assert!(number(black, "color_max") > 0.5, "{black}");
        assert_eq!(black["note"], "black");
        assert_eq!(
            (number(black, "min_ms"), number(black, "cpu_median_ms")),
            (7.0, 13.0)
        );
        assert_eq!(exact["peer_setting"], "plain");
        // Both frames' ratios have one denominator, so that the ratio of medians is theirs.
        let ratio = number(exact, "median_ms") / 7.0;
        assert!(
            (number(exact, "wall_ratio") / ratio - 1.0).abs() < 1e-9,
            "{exact}"
        );
    }
    let straight = row(results, picture, "sampling alone", "straight rays");
    assert_eq!(straight["setting"], "step 1, voxels in: buffer");
    assert_eq!(number(straight, "roofline_share"), 1.0);
    assert_eq!(straight["outside_cast_share"], Value::Null);
    let sampling = rows(results)
        .iter()
        .filter(|row| row["picture"] == picture && row["renderer"] == "sampling alone");
    let sampling: Vec<&Value> = sampling.collect();
    assert_eq!(sampling.len(), storages);
    assert!(
        sampling
            .iter()
            .all(|row| row["samples"] == straight["samples"])
    );
}

/// How many samples rows take, against each other.
fn check_samples(results: &Value) {
    // Four times the rays take four times the samples; of the cells visited that holds too.
    for (renderer, mode) in [("sampling alone", "straight rays"), ("angioray", "mean")] {
        let of = |picture| number(row(results, picture, renderer, mode), "samples");
        let ratio = of("256x256") / of("128x128");
        assert!((ratio / 4.0 - 1.0).abs() < 0.02, "{mode}: {ratio}");
    }
    // The control: of other counts it does not. A straight ray passes more cells than voxels' lengths.
    let samples = |renderer, mode| number(row(results, "256x256", renderer, mode), "samples");
    assert!(samples("angioray", "mean") > 1.2 * samples("sampling alone", "straight rays"));
    assert!(samples("angioray", "iso shaded") < 0.5 * samples("angioray", "mean"));
}

#[test]
fn every_mode_is_timed_counted_and_evaluated_beside_sampling_alone_and_a_peer() {
    let Some(device) = common::device() else {
        return;
    };
    let storages = if common::has_images(&device).is_ok() {
        3
    } else {
        1
    };
    let device = format!("--device {}", device.info().id);
    let place = Place::with_ball();
    place.write("black.sh", BLACK_PEER);
    let mut command = place.command(&format!(
        "bench speed ball.nrrd --iso 50% --quick --frames 2 -o out {device}"
    ));
    let output = command.args(["--peer", "sh black.sh"]).output().unwrap();
    assert!(output.status.success(), "{}", stderr(&output));
    let results = place.json("out/results.json");
    assert_eq!(results["experiment"], "speed");
    assert_eq!(results["run"]["frames"], "2");
    assert_eq!(results["run"]["peer"], "sh black.sh");
    assert!(KEYS.iter().all(|key| keys(&results).contains(key)));
    assert!(KEYS_BESIDE.iter().all(|key| keys(&results).contains(key)));
    for picture in ["128x128", "256x256"] {
        check_picture(&results, picture, storages);
    }
    assert!(rows(&results).iter().all(|row| row["frames"] == 2.0));
    check_samples(&results);

    // Without the peer; what was built then is found again.
    let line = format!("bench speed ball.nrrd --iso 50% --quick --frames 1 -o alone {device}");
    let printed = place.done(&line);
    assert!(printed.contains("scripts/peers/setup.sh"), "{printed}");
    let alone = place.json("alone/results.json");
    assert_eq!(keys(&alone), BTreeSet::from(KEYS));
    for (with, without) in rows(&results)
        .iter()
        .filter(|row| row["renderer"] != "black 1")
        .zip(rows(&alone))
    {
        assert_eq!(with["samples"], without["samples"]);
        assert_eq!(with["color_max"], without["color_max"]);
        assert_eq!(without["frames"], 1.0);
    }
}

#[test]
fn a_peer_that_does_not_start_is_reported_before_the_work() {
    let Some(device) = common::device_flag() else {
        return;
    };
    let place = Place::with_ball();
    let output = place.run(&format!(
        "bench speed ball.nrrd --quick --peer false {device}"
    ));
    assert_eq!(output.status.code(), Some(1));
    assert!(output.stdout.is_empty());
    assert!(stderr(&output).contains("false"), "{}", stderr(&output));
}
