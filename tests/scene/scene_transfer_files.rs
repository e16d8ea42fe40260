//! Transfer function files and presets.

use angioray::extent::Range;
use angioray::scene::{TransferFile, TransferUnits, linear_from_srgb};

const RANGE: Range = Range {
    min: -50.0,
    max: 150.0,
};

#[test]
fn a_file_is_srgb_in_and_linear_light_out() {
    let text = "unit_length_mm = 2.0\npoints = [[10, 0.5, 0.0, 1.0, 0.25], [20, 1, 1, 1, 1]]";
    let file = TransferFile::parse(text, "a.toml").unwrap();
    assert_eq!(file.units, TransferUnits::Value);
    let transfer = file.transfer_function(RANGE).unwrap();
    assert_eq!(transfer.unit_length_mm(), 2.0);
    let knot = transfer.knots()[0];
    assert_eq!((knot.value, knot.opacity), (10.0, 0.25));
    assert_eq!(knot.color.0, [linear_from_srgb(0.5), 0.0, 1.0]);
    // Half-way in sRGB is 21 % of the light, not half of it.
    assert!((knot.color.0[0] - 0.214_041).abs() < 1e-6);
}

#[test]
fn values_can_be_shares_of_the_range() {
    let shares = "units = 'range'\npoints = [[0.25, 0, 0, 0, 0], [0.5, 1, 1, 1, 0.1]]";
    let values = "points = [[0, 0, 0, 0, 0], [50, 1, 1, 1, 0.1]]";
    let of = |text: &str| {
        let file = TransferFile::parse(text, "a.toml").unwrap();
        file.in_values(RANGE)
    };
    assert_eq!(of(shares), of(values));
    // The control: without units they are values.
    let unlabelled = shares.replace("units = 'range'\n", "");
    assert_ne!(of(&unlabelled), of(values));
}

#[test]
fn every_preset_is_a_transfer_function_with_gentle_opacity() {
    let mut presets: Vec<&str> = TransferFile::presets().collect();
    presets.sort_unstable();
    assert_eq!(presets, ["3dra", "cta", "mra"]);
    assert!(presets.contains(&TransferFile::DEFAULT_PRESET));
    for preset in presets {
        let file = TransferFile::named(preset).unwrap();
        let transfer = file.transfer_function(RANGE).unwrap();
        let knots = transfer.knots();
        assert_eq!(knots[0].opacity, 0.0, "{preset}: what is below is clear");
        assert!(knots.iter().all(|k| k.opacity <= 0.8), "{preset}");
        let rises = knots
            .windows(2)
            .all(|pair| pair[0].opacity <= pair[1].opacity);
        assert!(rises, "{preset}");
    }
    // In Hounsfield units: water and muscle clear, contrast medium and bone not.
    let cta = TransferFile::named("cta").unwrap();
    let cta = cta.transfer_function(RANGE).unwrap();
    assert_eq!((cta.at(0.0).1, cta.at(60.0).1), (0.0, 0.0));
    assert!(cta.at(300.0).1 > 0.1 && cta.at(1200.0).1 > cta.at(300.0).1);
}

#[test]
fn a_wrong_file_is_refused_with_its_line() {
    let zero = "[0, 0, 0, 0, 0]";
    for (text, place, why) in [
        (
            format!("points = [\n {zero},\n [5, 0, 0, 1.5, 0],\n]"),
            "a.toml:3: ",
            "1.5",
        ),
        (
            format!("points = [\n {zero},\n [-5, 0, 0, 1, 0],\n]"),
            "a.toml:3: ",
            "ascend",
        ),
        (
            "points = [\n [9, 0, 0, 0]]".into(),
            "a.toml:2: ",
            "five numbers",
        ),
        (
            "points = [[nan, 0, 0, 0, 0]]".into(),
            "a.toml:1: ",
            "finite",
        ),
        ("points = []".into(), "a.toml:1: ", "1 to"),
        ("# nothing\n".into(), "a.toml", "points"),
        (
            format!("unit_length_mm = 0\npoints = [{zero}]"),
            "a.toml:1: ",
            "positive",
        ),
        (
            format!("points = [{zero}]\nopacity = 3"),
            "a.toml:2: ",
            "opacity",
        ),
        (
            format!("points = [{zero}]\nunits = 'HU'"),
            "a.toml:2: ",
            "HU",
        ),
        (
            "points = [[0, 0, 0, 0, 'x']]".into(),
            "a.toml:1: ",
            "string",
        ),
        ("points = ".into(), "a.toml:1: ", ""),
    ] {
        let Err(error) = TransferFile::parse(&text, "a.toml") else {
            panic!("accepted: {text}")
        };
        let message = error.to_string();
        assert_eq!(error.exit_code(), 2, "{message}");
        assert!(
            message.starts_with(place) && message.contains(why),
            "{text}: {message}"
        );
    }
    let missing = TransferFile::named("no/such.toml").unwrap_err();
    assert_eq!(missing.exit_code(), 65);
    assert!(missing.to_string().contains("no/such.toml"));
    assert!(missing.hint_text().is_some_and(|hint| hint.contains("cta")));
}
