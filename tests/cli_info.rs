//! What `info` prints: real voxel values, rounded numbers, a histogram that says how it is drawn.

mod cli_place;

use cli_place::Place;
use serde_json::{Value, json};

/// 100 voxels: 60 of 0, 39 of 17, 1 of 200; with an origin of -1e-9 and a value range that has a
/// tail in binary.
fn place() -> Place {
    let place = Place::empty();
    let voxels: Vec<u8> = [(60, 0), (39, 17), (1, 200)]
        .into_iter()
        .flat_map(|(count, value)| vec![value; count])
        .collect();
    std::fs::write(place.path("a.raw"), voxels).unwrap();
    let header = "NDims = 3\nDimSize = 10 5 2\nElementType = MET_UCHAR\n";
    let rest = "Offset = -1e-9 12.3456789 7\nElementDataFile = a.raw\n";
    place.write("a.mhd", &format!("{header}{rest}"));
    let floats: Vec<u8> = [0.0_f32, 563.2, 0.1, 0.2]
        .iter()
        .flat_map(|v| v.to_le_bytes())
        .collect();
    std::fs::write(place.path("f_4x1x1_f32.raw"), floats).unwrap();
    place
}

#[test]
fn percentiles_of_whole_numbers_are_values_that_occur() {
    let place = place();
    let percentiles = |line: &str| -> Value {
        let info: Value = serde_json::from_str(&place.done(line)).unwrap();
        info["percentiles"].clone()
    };
    assert_eq!(
        percentiles("info a.mhd --json"),
        json!({"p1": 0.0, "p50": 0.0, "p99": 17.0, "p99.9": 200.0})
    );
    // The control: of smoothed values, which are no whole numbers, other ones.
    assert_ne!(
        percentiles("info a.mhd --json --smooth 1")["p99"],
        json!(17.0)
    );
    let text = place.done("info a.mhd");
    assert!(
        text.contains("1%: 0  50%: 0  99%: 17  99.9%: 200"),
        "{text}"
    );
}

#[test]
fn numbers_are_rounded_and_the_bars_explained() {
    let place = place();
    let text = place.done("info a.mhd");
    let row = |text: &str, name: &str| {
        let line = text.lines().find(|line| line.starts_with(name));
        line.unwrap_or_else(|| panic!("{name}: {text}"))[name.len()..]
            .trim()
            .to_owned()
    };
    assert_eq!(row(&text, "origin"), "0 12.34568 7 mm (LPS)");
    assert_eq!(row(&text, "x axis"), "1 0 0");
    let (_, chart) = text.split_once("the bars are logarithmic\n").unwrap();
    assert!(chart.contains('█'));
    let floats = place.done("info f_4x1x1_f32.raw");
    assert_eq!(row(&floats, "values"), "0 to 563.2");
    // The control: JSON keeps every digit.
    let json = place.done("info f_4x1x1_f32.raw --json");
    assert!(json.contains("563.2000"), "{json}");
    let json: Value = serde_json::from_str(&place.done("info a.mhd --json")).unwrap();
    assert_eq!(json["origin_mm"][0], json!(-1e-9));
}

/// Ranks are those of the voxels, not of bins between the extremes: one voxel at 1e6 among 27,000.
#[test]
fn one_extreme_voxel_does_not_move_the_percentiles() {
    let spike = "tests/data/cases/perfspike.nrrd";
    let spike = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join(spike);
    let place = Place::empty();
    let text = place.done(&format!("info {}", spike.display()));
    assert!(
        text.contains("1%: 0.1276308  50%: 1.485851  99%: 7.255744  99.9%: 9.213"),
        "{text}"
    );
}
