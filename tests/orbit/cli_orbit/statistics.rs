//! `--stats` of an orbit.

use super::{REFERENCE, common, place};
use crate::cli_place::stderr;

#[test]
fn the_statistics_hold_every_frame() {
    let Some(device) = common::device_flag() else {
        return;
    };
    let place = place();
    place.write(
        "orbit.toml",
        "frames = 5\ndegrees = 180\naxis = [0, 0, 2]\nshard = '1/2'\n",
    );
    place.done(&format!(
        "orbit v.nrrd --scene orbit.toml --iso 70 --size 24 -o f/%02d.png --stats s%d.json {device}"
    ));
    let stats = place.json("s1.json");
    assert_eq!(stats["command"], "orbit");
    assert_eq!(stats["orbit"]["frames"], 5);
    assert_eq!(stats["orbit"]["axis"], serde_json::json!([0.0, 0.0, 1.0]));
    assert_eq!(stats["orbit"]["shard"], "1/2");
    let frames = stats["frames"].as_array().unwrap();
    let indices: Vec<_> = frames
        .iter()
        .map(|f| f["index"].as_u64().unwrap())
        .collect();
    assert_eq!(indices, [1, 3]);
    assert_eq!(frames[1]["degrees"], 108.0);
    for key in ["render_ms", "read_back_ms", "encode_ms"] {
        let all = key.trim_end_matches("_ms");
        let sum: f64 = frames.iter().map(|f| f[key].as_f64().unwrap()).sum();
        assert!(sum > 0.0, "{key}");
        assert!(
            (stats["times_ms"][all].as_f64().unwrap() - sum).abs() < 1e-6,
            "{key}"
        );
    }
    for key in ["rays", "samples", "nodes", "hits"] {
        let sum: u64 = frames
            .iter()
            .map(|f| f["counts"][key].as_u64().unwrap())
            .sum();
        assert_eq!(stats["counts"][key], sum, "{key}");
        assert!(sum > 0, "{key}");
    }
    // The scene is that of the first frame of all.
    place.done(&format!(
        "render v.nrrd --iso 70 --size 24 -o a.png --stats a.json {device}"
    ));
    assert_eq!(stats["scene"], place.json("a.json")["scene"]);
    assert_ne!(frames[0]["counts"], place.json("a.json")["counts"]);
}

#[test]
fn they_are_written_where_nothing_was_made_too() {
    let place = place();
    let orbit = format!("orbit v.nrrd --iso 70 --size 8 -o f/%d.png {REFERENCE}");
    place.done(&format!("{orbit} --frames 2 --stats s.json"));
    assert_eq!(place.json("s.json")["orbit"]["kept"], 0);
    assert_eq!(place.json("s.json")["frames"][1]["index"], 1);
    let messages = stderr(&place.run(&format!("{orbit} --frames 2 --resume --stats s.json")));
    assert!(messages.contains("nothing to do, 2 existed"), "{messages}");
    let stats = place.json("s.json");
    assert_eq!(stats["orbit"]["kept"], 2);
    assert_eq!(stats["frames"], serde_json::json!([]));
    assert_eq!(stats["counts"]["rays"], 0);
    assert_eq!(stats["device"]["name"], "reference");
    // A shard without a frame.
    place.done(&format!(
        "{orbit} --frames 2 --shard 5/6 --stats part-%02d.json"
    ));
    let stats = place.json("part-05.json");
    assert_eq!(stats["orbit"]["shard"], "5/6");
    assert_eq!(stats["frames"], serde_json::json!([]));
}
