//! `angioray bench sparse` and `bench sparse-rays` from outside: what is lost and how many rays are cast, which no
//! machine's speed changes.

use serde_json::Value;

use crate::cli_place;
use crate::common;

use cli_place::Place;

/// An experiment's rows.
fn rows(place: &Place, line: &str) -> Option<Vec<Value>> {
    let device = common::device_flag()?;
    place.done(&format!("{line} -o out {device}"));
    let results = place.json("out/results.json");
    Some(results["rows"].as_array().unwrap().clone())
}

fn number(row: &Value, key: &str) -> f64 {
    row[key].as_f64().unwrap_or_else(|| panic!("{key}: {row}"))
}

#[test]
fn certified_loses_nothing_and_few_rays_do() {
    let place = Place::empty();
    place.done("phantom vessels --size 48 -o tree.nrrd");
    let Some(rows) = rows(&place, "bench sparse tree.nrrd --quick") else {
        return;
    };
    // Whole, three families of three, two errors, rays one by one, three from neighbours; in mip whole, two families and two
    // errors.
    assert_eq!(rows.len(), 2 * ((1 + 9 + 2 + 4) + (1 + 6 + 2)));
    let of = |mode: &str, setting: &str| {
        let rows = rows.iter().filter(|row| row["protocol"] == "static");
        let rows = rows.filter(|row| row["mode"] == mode && row["setting"] == setting);
        rows.cloned().collect::<Vec<_>>()
    };
    for row in of("iso", "certified") {
        for key in ["lost_share", "extra_share", "displaced_share"] {
            assert_eq!(number(&row, key), 0.0, "{key}: {row}");
        }
        assert!(number(&row, "rmse") < 1e-3, "{row}");
        assert!(number(&row, "rays_share") < 1.0, "{row}");
    }
    for row in of("iso", "adaptive") {
        assert_eq!(
            (number(&row, "lost"), number(&row, "extra_share")),
            (0.0, 0.0),
            "{row}"
        );
    }
    for row in of("mip", "adaptive") {
        assert!(number(&row, "rays_share") < 1.0, "{row}");
        // Encoded differences of a grey are at most about twice those of the values where it is not dark.
        assert!(
            number(&row, "rmse") < 2.0 * number(&row, "screen_error"),
            "{row}"
        );
    }
    for mode in ["iso", "mip"] {
        let whole = &of(mode, "every pixel")[0];
        assert_eq!(
            (number(whole, "rays_share"), number(whole, "ratio")),
            (1.0, 1.0)
        );
        assert!(number(whole, "hits") > 0.0);
        let (gradient, flood) = (of(mode, "gradient"), of(mode, "flood"));
        for (gradient, flood) in gradient.iter().zip(&flood) {
            assert!(
                number(flood, "lost") <= number(gradient, "lost"),
                "{flood} {gradient}"
            );
            assert!(number(flood, "rays_share") >= number(gradient, "rays_share"));
        }
        // The control: thin vessels pass between a coarse grid's rays.
        assert!(number(&gradient[2], "lost") > 0.0, "{mode}");
    }
    for row in of("iso", "from neighbours' depth") {
        assert!(number(&row, "rays_share") > 1.0, "{row}");
        assert_eq!(row["rmse"], Value::Null);
        assert!(
            number(&row, "lost") + number(&row, "displaced_share") > 0.0,
            "{row}"
        );
    }
    let page = std::fs::read_to_string(place.path("out/report.html")).unwrap();
    assert!(page.contains("lost vessel pixels over rays") && page.contains("over time, orbit"));
}

#[test]
fn a_hundred_thousand_pixels_cast_sparsely_are_the_whole_pictures() {
    let place = Place::with_ball();
    let Some(rows) = rows(
        &place,
        "bench sparse-rays ball.nrrd --rays 100000 --seed 11",
    ) else {
        return;
    };
    let [certified, unfilled] = &rows[..] else {
        panic!("{rows:?}")
    };
    assert!(number(certified, "pixels") >= 100_000.0 && number(certified, "hits") > 1000.0);
    for key in ["lost", "extra", "displaced"] {
        assert_eq!(number(certified, key), 0.0, "{certified}");
    }
    assert!(number(certified, "cast_share") < 1.0);
    assert!(number(certified, "interpolated") > 300.0, "{certified}");
    // The control.
    assert!(number(unfilled, "lost") > 0.0, "{unfilled}");
}
