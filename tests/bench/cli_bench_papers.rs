//! The experiments of the field's papers from outside: what their tables say that no machine's speed
//! changes. Without a device the tests say so and pass, unless REQUIRE_OPENCL=1.

use crate::cli_place;
use crate::common;

use cli_place::Place;
use serde_json::Value;

/// What an experiment left, run on a thin vessel tree of 40³ voxels.
struct Done {
    place: Place,
    results: Value,
}

fn done(experiment: &str) -> Option<Done> {
    done_of(experiment, "vessels", "")
}

/// The same on another phantom of that size, and with flags.
fn done_of(experiment: &str, phantom: &str, flags: &str) -> Option<Done> {
    let device = common::device_flag()?;
    let place = Place::empty();
    place.done(&format!("phantom {phantom} -o tree.nrrd --size 40"));
    place.done(&format!(
        "bench {experiment} tree.nrrd --quick -o out {flags} {device}"
    ));
    let results = place.json("out/results.json");
    assert_eq!(results["experiment"], experiment);
    assert_eq!(results["failure"], Value::Null);
    Some(Done { place, results })
}

impl Done {
    fn rows(&self) -> &[Value] {
        self.results["rows"].as_array().unwrap()
    }

    /// The row of a case.
    fn case(&self, case: &str) -> &Value {
        let row = self.rows().iter().find(|row| row["way"] == case);
        row.unwrap_or_else(|| panic!("no case '{case}' in {:#}", self.results))
    }

    fn number(&self, case: &str, key: &str) -> f64 {
        self.case(case)[key].as_f64().unwrap()
    }

    /// Every time is positive, and a frame a second is its inverse.
    fn check_times(&self) {
        for row in self.rows() {
            let of = |key: &str| row[key].as_f64().unwrap();
            assert!(
                of("min_ms") > 0.0 && of("min_ms") <= of("median_ms"),
                "{row}"
            );
            assert!(of("median_ms") <= of("p95_ms"), "{row}");
            assert!((of("fps") * of("median_ms") - 1e3).abs() < 1e-6, "{row}");
        }
    }
}

/// A PNG's size and the bytes of its channels.
fn picture(place: &Place, name: &str) -> ((u32, u32), Vec<u8>) {
    let file = std::fs::File::open(place.path(name)).unwrap();
    let decoder = png::Decoder::new(std::io::BufReader::new(file));
    let mut reader = decoder.read_info().unwrap();
    let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut bytes).unwrap();
    ((info.width, info.height), bytes)
}

#[test]
fn b1_skipping_changes_nothing_and_large_steps_lose_thin_vessels() {
    let Some(done) = done("b1") else { return };
    done.check_times();
    assert_eq!(done.rows().len(), 6);
    assert_eq!(done.case("+ skipping")["same_bytes"], "yes");
    let missed = |case: &str| done.number(case, "missed_share");
    assert_eq!(missed("exact"), 0.0);
    let (fine, coarse) = (
        missed("basic: step 1"),
        missed("+ skipping, step 5 refined"),
    );
    assert!(coarse > 0.1 && coarse > 3.0 * fine, "{fine} {coarse}");
    // Refinement finds the depth, but no hit.
    assert_eq!(coarse, missed("+ skipping, step 5"));
    let depth = |case: &str| done.number(case, "depth_mean_voxels");
    assert!(depth("+ skipping, step 5 refined") < depth("+ skipping, step 5"));
    let paper = done.case("+ skipping")["paper_speedup"].as_f64().unwrap();
    assert!((paper - 24.3 / 4.4).abs() < 1e-12, "{paper}");
}

#[test]
fn b3_the_depth_is_refined_to_a_fraction_of_the_step() {
    // One surface alone: what a ray steps over is missed, and nothing lies behind it.
    let Some(done) = done_of("b3", "sphere", "") else {
        return;
    };
    for step in [1.0, 5.0] {
        let of =
            |refiner: &str| done.number(&format!("step {step}, {refiner}"), "depth_p99_voxels");
        // Unrefined hits lie up to a step behind the surface.
        assert!(of("none") > 0.5 * step && of("none") <= step * 1.001);
        assert!(of("bisection:6") < 0.25 * of("none"));
    }
}

#[test]
fn b2_and_b9_sum_light_alike_whatever_is_left_out() {
    let Some(shaded) = done("b2") else { return };
    shaded.check_times();
    for case in ["unshaded", "shaded"] {
        assert!(shaded.number(case, "rmse") < 0.01, "{:#}", shaded.results);
    }
    let Some(ended) = done_of("b9", "gaussian", "") else {
        return;
    };
    assert_eq!(ended.case("ends at 0.99, octree")["same_bytes"], "yes");
    let samples = |case: &str| ended.number(case, "samples_per_ray");
    assert!(samples("ends at 0.99") < samples("to the end"));
    // Nothing is transparent, so that the octree skips nothing; rays beside the volume take none.
    assert!(samples("ends at 0.99") > 0.0);
    assert_eq!(samples("ends at 0.99, octree"), samples("ends at 0.99"));
    let paper = &ended.case("ends at 0.99, octree")["paper_fps"];
    assert_eq!(*paper, Value::Null);
    // What a ray loses by ending early.
    assert!(ended.number("ends at 0.99", "max") >= ended.number("to the end", "max"));
}

#[test]
fn b8_b13_and_b16_give_one_picture_whatever_leaf_planes_and_traversal() {
    let rows_same = |done: &Done| {
        let rows = done.rows().iter();
        rows.filter(|row| row["same_bytes"] == "yes").count()
    };
    let Some(leaves) = done("b8") else { return };
    assert_eq!((leaves.rows().len(), rows_same(&leaves)), (8, 6));
    let nodes = |leaf: u32| leaves.number(&format!("leaf {leaf}"), "nodes_per_ray");
    assert!(nodes(4) > nodes(32));
    let Some(planes) = done("b13") else { return };
    assert_eq!((planes.rows().len(), rows_same(&planes)), (12, 8));
    let Some(march) = done("b16") else { return };
    assert_eq!(planes.results["size"], Value::Null);
    assert_eq!((march.rows().len(), rows_same(&march)), (7, 5));
    let samples = |case: &str| march.number(case, "samples_per_ray");
    assert!(samples("octree, kd-restart") < 0.8 * samples("march"));
    // Rays that are not cast take none; together the two save more than either.
    assert!(samples("sparse, march") < 0.8 * samples("march"));
    let both = samples("sparse, octree, kd-restart");
    assert!(both < samples("sparse, march") && both < samples("octree, kd-restart"));
    let paper = &march.case("sparse, octree, kd-restart")["paper_speedup"];
    assert_eq!(*paper, 1.2);
}

#[test]
fn b10_uploads_no_voxel_again() {
    let Some(done) = done("b10") else { return };
    assert_eq!(done.rows().len(), 4);
    for row in done.rows() {
        let of = |key: &str| row[key].as_f64().unwrap();
        assert!(of("classify_min_ms") > 0.0, "{row}");
        // The control: with its first frame all of it goes.
        assert!(of("first_bytes") >= of("volume_bytes"), "{row}");
        // A byte a node, and what else a scene says; in a volume of 64,000 bytes.
        assert!(
            of("uploaded_bytes") > 0.0 && of("uploaded_bytes") < 0.3 * of("volume_bytes"),
            "{row}"
        );
    }
}

#[test]
fn b15_stands_beside_the_papers_figures_under_both_protocols() {
    let Some(done) = done("b15") else { return };
    assert_eq!(done.rows().len(), 2 * 5);
    let row = |protocol: &str, effect: &str| {
        let mut rows = done.rows().iter();
        rows.find(|row| row["protocol"] == protocol && row["effect"] == effect)
            .unwrap()
    };
    assert_eq!(row("static", "sparse casting")["paper_fps_on"], 14.48);
    assert_eq!(row("orbit", "sparse casting")["paper_fps_on"], 16.84);
    for protocol in ["static", "orbit"] {
        let none = row(protocol, "none");
        assert!(none["fps"].as_f64().unwrap() > 0.0);
        // Thin vessels at half a voxel's steps: some are missed, most are not.
        let missed = none["missed_share"].as_f64().unwrap();
        assert!((0.0..0.5).contains(&missed), "{none}");
        assert!(none["depth_mean_voxels"].as_f64().unwrap() > 0.0);
        // Both cheaper ways lose hits; a blur and a dimmed light lose none.
        for effect in ["sparse casting", "cheaper filter"] {
            let with = row(protocol, effect);
            assert!(with["speedup"].as_f64().unwrap() > 0.0, "{with}");
            assert!(with["missed_share"].as_f64().unwrap() > missed, "{with}");
        }
        for effect in ["depth of field", "ambient occlusion"] {
            let with = row(protocol, effect);
            assert!(with["speedup"].as_f64().unwrap() > 0.0, "{with}");
            assert_eq!(with["missed_share"], none["missed_share"], "{with}");
        }
    }
    assert_eq!(row("static", "none")["repeats"], 3.0);
    assert_eq!(row("orbit", "none")["repeats"], 12.0);
    assert_eq!(done.results["protocol"], Value::Null);
    let Some(orbit) = done_of("b15", "vessels", "--protocol orbit") else {
        return;
    };
    assert_eq!(orbit.rows().len(), 5);
    assert_eq!(orbit.results["protocol"], "orbit");
}

#[test]
fn b17_counts_every_pixel_once_and_draws_them() {
    let Some(done) = done("b17") else { return };
    let sum = |key: &str| -> u64 {
        let rows = done.rows().iter();
        rows.map(|row| row[key].as_f64().unwrap() as u64).sum()
    };
    assert_eq!(sum("pixels"), 128 * 128);
    assert_eq!(
        sum("pixels"),
        sum("hits") + sum("near_misses") + sum("clear_misses")
    );
    assert!(sum("hits") > 0 && sum("near_misses") > 0 && sum("clear_misses") > 0);
    // Rays past the volume go through nothing.
    assert!(done.rows()[0]["clear_misses"].as_f64().unwrap() > 0.0);
    assert_eq!(done.rows()[0]["hits"], 0.0);
    let (size, bytes) = picture(&done.place, "out/tree-iterations.png");
    assert_eq!(size, (128, 128));
    assert_eq!(bytes.iter().min(), Some(&0));
    assert_eq!(bytes.iter().max(), Some(&255));
}

#[test]
fn b18_draws_four_pictures_of_one_volume_that_differ() {
    let Some(done) = done("b18") else { return };
    done.check_times();
    let names = ["walls", "interiors", "walls-and-interiors", "all-of-it"];
    let pictures = names.map(|name| picture(&done.place, &format!("out/tree-dvr-{name}.png")).1);
    for (at, picture) in pictures.iter().enumerate() {
        assert!(
            picture.iter().any(|&level| level > 0),
            "{} is empty",
            names[at]
        );
        assert!(pictures[..at].iter().all(|other| other != picture));
    }
    for row in done.rows() {
        assert!(row["max"].as_f64().unwrap() < 0.1, "{row}");
    }
}

#[test]
fn a_named_iso_value_is_the_one_that_is_shown() {
    let Some(device) = common::device_flag() else {
        return;
    };
    let place = Place::with_ball();
    let hits = |iso: &str| {
        let line = format!("bench b17 ball.nrrd --quick --iso {iso} -o out {device}");
        place.done(&line);
        let results = place.json("out/results.json");
        let rows = results["rows"].as_array().unwrap().clone();
        rows.iter()
            .map(|row| row["hits"].as_f64().unwrap())
            .sum::<f64>()
    };
    // Of a ball's edge, which is blurred: the higher, the smaller the surface.
    let (low, half, high) = (hits("10"), hits("50%"), hits("190"));
    assert!(
        low > half && half > high && high > 0.0,
        "{low} {half} {high}"
    );
}
