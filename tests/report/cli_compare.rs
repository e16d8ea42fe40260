//! `angioray compare` from outside: its folder, its rows, its refusals. Without a device what needs
//! one says so and passes, unless REQUIRE_OPENCL=1.

use crate::cli_place;
use crate::common;

use std::fs;

use cli_place::{Place, pixels, stderr};
use serde_json::Value;

fn rows(results: &Value) -> &Vec<Value> {
    results["rows"].as_array().unwrap()
}

fn row<'a>(results: &'a Value, mode: &str, setting: &str) -> &'a Value {
    let mut rows = rows(results).iter();
    let row = rows.find(|row| row["mode"] == mode && row["setting"] == setting);
    row.unwrap_or_else(|| panic!("no row of {mode}, {setting}"))
}

/// Everything but `--modes` and what the test is about; small and quick.
const SMALL: &str = "compare ball.nrrd -o out --size 40x40 --repeats 2 --iso 100 --cache cache";

#[test]
fn every_setting_is_evaluated_timed_and_pictured() {
    let Some(device) = common::device_flag() else {
        return;
    };
    let place = Place::with_ball();
    let printed = place.done(&format!("{SMALL} --modes iso,mip,dvr {device}"));
    assert!(printed.starts_with("| mode | setting |"), "{printed}");
    let results = place.json("out/results.json");
    assert_eq!(results["command"], "compare");
    assert_eq!(results["volume"]["dims"], serde_json::json!([16, 16, 16]));
    for mode in ["iso", "mip", "dvr"] {
        let of_mode = rows(&results).iter().filter(|row| row["mode"] == mode);
        assert!(of_mode.clone().count() >= 8, "{mode}");
        for row in of_mode {
            let name = &row["setting"];
            assert_eq!(row["failure"], Value::Null, "{name}");
            assert_eq!(row["times_ms"]["repeats"], 2, "{name}");
            for clock in ["frame", "render"] {
                let spread = &row["times_ms"][clock];
                let [min, median] = ["min", "median"].map(|key| spread[key].as_f64().unwrap());
                assert!(0.0 < min && min <= median, "{name}: {spread}");
                assert!(spread["mad"].as_f64().unwrap() >= 0.0, "{name}");
            }
            let processor = &row["times_ms"]["processor"];
            let on_linux = cfg!(target_os = "linux");
            assert_eq!(
                processor.as_f64().is_some_and(|ms| ms > 0.0),
                on_linux,
                "{name}"
            );
            assert!(!row["passes"].as_array().unwrap().is_empty(), "{name}");
            assert_eq!(row["counts"]["rays"], 1600, "{name}");
            assert!(
                row["memory"]["device_bytes"].as_u64().unwrap() >= 4096,
                "{name}"
            );
            let error = &row["error"];
            for key in ["rmse", "max", "p99"] {
                assert!(
                    error["color"][key].as_f64().unwrap() >= 0.0,
                    "{name}: {key}"
                );
            }
            assert!(error["ssim"].as_f64().unwrap() <= 1.0, "{name}");
            assert!(error["flip"].as_f64().unwrap() >= 0.0, "{name}");
            assert_eq!(error["depth"].is_null(), mode != "iso", "{name}");
            assert_eq!(error["value"].is_null(), mode != "mip", "{name}");
            for file in ["png", "exr", "error_png", "error_exr"] {
                let file = row["files"][file].as_str().unwrap();
                assert!(place.path(&format!("out/{file}")).is_file(), "{file}");
            }
        }
    }
    // Exact casting misses nothing.
    let exact = &row(&results, "iso", "exact")["error"]["depth"];
    assert_eq!((&exact["missed"], &exact["extra"]), (&0.into(), &0.into()));
    assert!(exact["reference_hits"].as_u64().unwrap() > 100);
    let coarse = row(&results, "dvr", "riemann, step 1")["error"]["color"]["rmse"].as_f64();
    let fine = row(&results, "dvr", "adaptive:1e-4")["error"]["color"]["rmse"].as_f64();
    assert!(fine < coarse, "{fine:?} {coarse:?}");

    let csv = fs::read_to_string(place.path("out/results.csv")).unwrap();
    assert_eq!(csv.lines().count(), rows(&results).len() + 1);
    let page = fs::read_to_string(place.path("out/report.html")).unwrap();
    for row in rows(&results) {
        let name = row["setting"].as_str().unwrap();
        assert!(page.contains(name), "{name}");
    }
    assert!(page.contains("angioray compare ball.nrrd -o out"));
}

#[test]
fn the_figures_are_those_of_the_pictures() {
    let Some(device) = common::device_flag() else {
        return;
    };
    let place = Place::with_ball();
    let line = SMALL.replace(" --iso 100", "");
    place.done(&format!("{line} --modes mip {device}"));
    let results = place.json("out/results.json");
    let reference = pixels(&place.path("out/pictures/mip-00-reference.png"));
    let mut wrong = 0;
    for row in rows(&results) {
        let file = row["files"]["png"].as_str().unwrap();
        let picture = pixels(&place.path(&format!("out/{file}")));
        let differences = reference.iter().zip(&picture);
        let differences = differences.flat_map(|(a, b)| (0..3).map(|c| (a[c] - b[c]).abs()));
        let max = differences.fold(0.0, f64::max);
        // Both pictures are rounded to 255 levels.
        let reported = row["error"]["color"]["max"].as_f64().unwrap();
        assert!(
            (reported - max).abs() <= 1.01 / 255.0,
            "{}: {reported} {max}",
            row["setting"]
        );
        wrong += usize::from(max > 2.0 / 255.0);
    }
    assert!(wrong > 0, "no setting was wrong: nothing was tested");
}

#[test]
fn the_reference_is_computed_once() {
    let Some(device) = common::device_flag() else {
        return;
    };
    let place = Place::with_ball();
    let line = format!("{SMALL} --modes iso {device}");
    place.done(&line);
    let cached = || fs::read_dir(place.path("cache")).unwrap().count();
    let is_reported = || {
        let page = fs::read_to_string(place.path("out/report.html")).unwrap();
        page.contains("cached by an earlier comparison")
    };
    let figures = place.json("out/results.json");
    assert_eq!((cached(), is_reported()), (1, false));
    place.done(&line);
    assert_eq!((cached(), is_reported()), (1, true));
    let again = place.json("out/results.json");
    for (a, b) in rows(&figures).iter().zip(rows(&again)) {
        assert_eq!(a["error"], b["error"], "{}", a["setting"]);
        assert_eq!(a["counts"], b["counts"], "{}", a["setting"]);
    }
    place.done(&format!("{line} --azimuth 10"));
    assert_eq!((cached(), is_reported()), (2, false));
}

#[test]
fn settings_come_from_a_file_and_from_flags() {
    let Some(device) = common::device_flag() else {
        return;
    };
    let place = Place::with_ball();
    place.write(
        "steps.toml",
        "[[setting]]\nname = 'coarse & plain'\nstep = 4\nprobe = 'off'\n\
         [[setting]]\nname = 'only mip'\nmodes = ['mip']\nsampling = 'exact'\n",
    );
    place.done(&format!(
        "{SMALL} --modes iso,mip --configs steps.toml --step 0.75 {device}"
    ));
    let results = place.json("out/results.json");
    let names: Vec<&str> = rows(&results)
        .iter()
        .map(|row| row["setting"].as_str().unwrap())
        .collect();
    assert_eq!(
        names,
        [
            "coarse & plain",
            "as given",
            "coarse & plain",
            "only mip",
            "as given"
        ]
    );
    assert_eq!(rows(&results)[0]["flags"], "--probe off --step 4");
    assert_eq!(rows(&results)[1]["flags"], "--step 0.75");
    let missed = |at: usize| {
        rows(&results)[at]["error"]["depth"]["missed"]
            .as_u64()
            .unwrap()
    };
    assert!(missed(0) > missed(1), "{} {}", missed(0), missed(1));
}

#[test]
fn an_option_applies_to_the_modes_that_it_goes_with() {
    let Some(device) = common::device_flag() else {
        return;
    };
    let place = Place::with_ball();
    place.write("one.toml", "[[setting]]\nname = 'coarse'\nstep = 4\n");
    let compare = format!(
        "compare ball.nrrd -o out --size 16x16 --repeats 1 --cache cache --configs one.toml {device}"
    );
    let scenes = |options: &str| {
        place.done(&format!("{compare} {options}"));
        place.json("out/results.json")["scenes"].clone()
    };
    let both = scenes("--modes iso,dvr --iso 150 --tf cta --ambient 0.3");
    assert_eq!(both["iso"]["iso"], 150);
    assert_eq!(both["iso"]["ambient"], 0.3);
    assert_eq!(both["iso"]["tf"], Value::Null);
    let points = both["dvr"]["tf"]["points"].as_array().unwrap().clone();
    // Unshaded, as dvr is by default.
    assert_eq!(both["dvr"]["ambient"], Value::Null);
    // The modes that are compared by default are four, dvr among them.
    let four = scenes("--tf cta");
    assert_eq!(four.as_object().unwrap().len(), 4);
    assert_eq!(four["dvr"]["tf"]["points"].as_array().unwrap(), &points);
    // The control: without it the points are others.
    assert_ne!(
        scenes("--modes dvr")["dvr"]["tf"]["points"]
            .as_array()
            .unwrap(),
        &points
    );
    let mixed = scenes("--modes mip,iso --window 450,0");
    assert_eq!(mixed["mip"]["window"], serde_json::json!([450, 0]));
    assert_eq!(mixed["iso"]["window"], Value::Null);
    // How rays are followed too: one setting more in each mode that it goes with.
    place.done(&format!(
        "{compare} --modes mip,dvr --step 0.75 --probe off"
    ));
    let given = |mode: &str| {
        let results = place.json("out/results.json");
        row(&results, mode, "as given")["flags"].clone()
    };
    assert_eq!(given("mip"), "--probe off --step 0.75");
    assert_eq!(given("dvr"), "--step 0.75");
}

#[test]
fn an_option_that_goes_with_no_compared_mode_is_refused() {
    let place = Place::with_ball();
    for (options, wanted) in [
        (
            "--modes mip,iso --tf cta",
            "'tf' cannot be combined with any mode that is compared: mip, iso",
        ),
        (
            "--modes iso --tf cta",
            "'tf' cannot be combined with mode 'iso'",
        ),
        (
            "--modes mip,minip --iso 3",
            "'iso' cannot be combined with any mode",
        ),
        ("--modes dvr --ambient 0.3", "'ambient' has no effect"),
        (
            "--modes iso,dvr --window 0,9",
            "'window' cannot be combined with any mode",
        ),
        (
            "--modes dvr,mean --probe off",
            "'probe' cannot be combined with any mode",
        ),
    ] {
        let message = place.refused(&format!("compare ball.nrrd -o out {options}"), 2);
        assert!(message.contains(wanted), "{options}: {message}");
    }
}

#[test]
fn what_is_done_before_a_failure_stays() {
    let Some(device) = common::device_flag() else {
        return;
    };
    let place = Place::with_ball();
    fs::create_dir_all(place.path("out/pictures/mip-02-step-2.png")).unwrap();
    let output = place.run(&format!("{SMALL} --modes iso,mip {device}"));
    assert_eq!(output.status.code(), Some(74));
    assert!(
        stderr(&output).contains("mip-02-step-2.png"),
        "{}",
        stderr(&output)
    );
    let results = place.json("out/results.json");
    let timed = |mode: &str| {
        let rows = rows(&results).iter().filter(|row| row["mode"] == mode);
        let repeats = rows.map(|row| row["times_ms"]["repeats"].as_u64().unwrap());
        repeats.collect::<Vec<_>>()
    };
    assert_eq!(timed("iso"), [2; 8]);
    // Compared with the reference, but not timed yet.
    assert_eq!(timed("mip"), [0]);
}

#[test]
fn wrong_usage_is_refused_before_the_work() {
    let place = Place::with_ball();
    place.write("bad.toml", "[[setting]]\nname = 'a'\niso = 3\n");
    place.write("taken", "");
    for (line, code, wanted) in [
        (
            "compare ball.nrrd",
            2,
            "no folder for the comparison was named",
        ),
        ("compare -o out", 2, "no volume was named"),
        (
            "compare ball.nrrd -o out --mode iso --modes mip",
            2,
            "'--modes' and '--mode' cannot be combined",
        ),
        (
            "compare ball.nrrd -o out --modes iso,iso",
            2,
            "'iso' is named twice",
        ),
        (
            "compare ball.nrrd -o out --modes iso,x",
            2,
            "'x' is not a mode",
        ),
        (
            "compare ball.nrrd -o out --repeats 0",
            2,
            "is not a whole number of at least 1",
        ),
        (
            "compare ball.nrrd -o out --configs bad.toml",
            2,
            "'iso' changes what is shown",
        ),
        (
            "compare ball.nrrd -o out --configs none.toml",
            65,
            "none.toml",
        ),
        (
            "compare ball.nrrd -o out --device reference",
            2,
            "cannot be compared",
        ),
    ] {
        let message = place.refused(line, code);
        assert!(message.contains(wanted), "{line}: {message}");
    }
    let Some(device) = common::device_flag() else {
        return;
    };
    let message = place.refused(&format!("compare ball.nrrd -o taken {device}"), 74);
    assert!(message.contains("is not a folder"), "{message}");
}

#[test]
fn the_help_has_an_example() {
    let help = Place::empty().done("compare --help");
    let (_, examples) = help.split_once("Example:").unwrap();
    assert!(
        examples.contains("angioray compare head.nrrd -o head"),
        "{help}"
    );
}
