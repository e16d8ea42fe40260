//! What `info` prints: real voxel values, rounded numbers, a histogram that says how it is drawn.

use crate::cli_place;

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

/// One of the small volumes that other renderers have got wrong.
fn case(name: &str) -> String {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/cases");
    folder.join(name).display().to_string()
}

/// Ranks are those of the voxels, not of bins between the extremes: one voxel at 1e6 among 27,000.
#[test]
fn one_extreme_voxel_does_not_move_the_percentiles() {
    let text = Place::empty().done(&format!("info {}", case("perfspike.nrrd")));
    let ranks = "1%: 0.1276308  50%: 1.485851  99%: 7.255744  99.9%: 9.21";
    assert!(text.contains(ranks), "{text}");
}

/// Padding at -3024, 27 voxels of metal at 30000, tissue up to 88, vessels at 350.
#[test]
fn padding_and_metal_do_not_move_the_suggestion() {
    let place = Place::empty();
    let info = |line: &str| -> Value { serde_json::from_str(&place.done(line)).unwrap() };
    let found = info(&format!("info {} --json", case("padmetal.nrrd")));
    let iso = found["suggested_iso"].as_f64().unwrap();
    assert!((68.0..350.0).contains(&iso), "{iso}");
    assert_eq!(found["robust_range"], json!([-1000.0, 350.0]));
    assert_eq!(found["range"], json!([-3024.0, 30_000.0]));
    // One voxel at the end of its type, of two types.
    for (name, kind, extreme) in [("i", "MET_SHORT", 32_767), ("u", "MET_USHORT", 65_535)] {
        let voxels: Vec<u16> = (0..27_000_u32)
            .map(|i| match i {
                13_000 => extreme,
                _ if i % 50 == 0 => 300,
                _ => (i * 40_503 % 65_536 % 100) as u16,
            })
            .collect();
        let bytes: Vec<u8> = voxels.iter().flat_map(|v| v.to_le_bytes()).collect();
        std::fs::write(place.path("v.raw"), bytes).unwrap();
        let header = format!("NDims = 3\nDimSize = 30 30 30\nElementType = {kind}\n");
        place.write(
            &format!("{name}.mhd"),
            &format!("{header}ElementDataFile = v.raw\n"),
        );
        let found = info(&format!("info {name}.mhd --json"));
        let iso = found["suggested_iso"].as_f64().unwrap();
        assert!((99.0..300.0).contains(&iso), "{name}: {iso}");
        assert_eq!(found["percentiles"]["p99.9"], json!(300.0));
    }
}

/// Seven digits would make all values of a range far from zero one.
#[test]
fn values_far_from_zero_are_printed_apart() {
    let text = Place::empty().done(&format!("info {}", case("f64_off1e9.nrrd")));
    assert!(text.contains("1000000000 to 1000000102.6\n"), "{text}");
    assert!(text.contains("50%: 1000000051.3"), "{text}");
}
