//! `angioray bench b4` and `bench check-sampling` from outside: banding by jitter, and the verdicts on steps.

use serde_json::Value;

use crate::cli_place;
use crate::common;

use cli_place::Place;

fn number(row: &Value, key: &str) -> f64 {
    row[key].as_f64().unwrap_or_else(|| panic!("{key}: {row}"))
}

#[test]
fn b4_bands_become_grain_and_the_mean_stays() {
    let Some(device) = common::device_flag() else {
        return;
    };
    let place = Place::empty();
    place.done("phantom gaussian -o blob.nrrd --size 40");
    place.done(&format!("bench b4 blob.nrrd --quick -o out {device}"));
    let results = place.json("out/results.json");
    let rows = results["rows"].as_array().unwrap();
    assert_eq!(rows.len(), 5 * 6);
    for case in rows.chunks(6) {
        let [none, two, four, eight, sixteen, hash] = case else {
            panic!("{case:?}")
        };
        assert_eq!(none["way"], "none");
        // Without jitter neighbours are alike: the control.
        assert!(number(none, "correlation") > 0.5, "{none}");
        for jittered in [two, four, eight, sixteen, hash] {
            let key = "correlation";
            assert!(
                number(jittered, key) < number(none, key) - 0.2,
                "{jittered}"
            );
        }
        for jittered in [four, eight, hash] {
            let key = "coarse_share";
            assert!(number(jittered, key) < number(none, key), "{jittered}");
            // Grain for bands: pixels are about as far off, and the picture is no brighter.
            assert!(
                number(jittered, "rmse") < 1.3 * number(none, "rmse") + 1e-3,
                "{jittered}"
            );
            let moved = number(jittered, "mean") - number(none, "mean");
            assert!(
                moved.abs() < 0.25 * number(none, "rmse") + 1e-3,
                "{jittered} {none}"
            );
        }
    }
    let page = std::fs::read_to_string(place.path("out/report.html")).unwrap();
    assert!(page.contains("interleaved:4") && page.contains("the reference"));
}

#[test]
fn most_verdicts_on_steps_are_right() {
    let Some(device) = common::device_flag() else {
        return;
    };
    let place = Place::empty();
    place.done(&format!("bench check-sampling --quick -o out {device}"));
    let results = place.json("out/results.json");
    assert_eq!(results["failure"], Value::Null);
    let rows = results["rows"].as_array().unwrap();
    let all = rows.last().unwrap();
    assert_eq!(all["mode"], "all");
    let of = |key| number(all, key);
    assert_eq!(of("coarse") + of("fine"), of("scenes"));
    assert_eq!(of("found") + of("missed"), of("coarse"));
    assert!(of("coarse") > 2.0 && of("fine") > 3.0, "{all}");
    assert!(of("found") > of("missed"), "{all}");
}
