//! `--jitter` and `--check-sampling` from outside.

use serde_json::Value;

use crate::cli_place::{Place, stderr};
use crate::common;

/// Vessels thinner than a coarse step.
fn place() -> Place {
    let place = Place::empty();
    place.done("phantom vessels -o v.nrrd --size 32 --seed 2");
    place
}

/// The line about the sampling, and the statistics' part.
fn checked(place: &Place, line: &str) -> (String, Value) {
    let output = place.run(&format!("{line} --check-sampling -o c.png --stats c.json"));
    let messages = stderr(&output);
    assert!(output.status.success(), "{line}: {messages}");
    let mut lines = messages
        .lines()
        .filter(|line| line.starts_with("sampling: "));
    let found = lines.next().unwrap_or_else(|| panic!("{messages}"));
    assert_eq!(lines.next(), None);
    (
        found.to_owned(),
        place.json("c.json")["sampling_check"].clone(),
    )
}

#[test]
fn a_coarse_step_is_found_and_a_finer_one_advised_that_will_do() {
    let Some(device) = common::device_flag() else {
        return;
    };
    let place = place();
    for mode in ["iso", "mip", "dvr --shading phong"] {
        let line = format!("render v.nrrd --mode {mode} --size 48 {device}");
        let (found, figures) = checked(&place, &format!("{line} --step 3"));
        let number = |figures: &Value, key: &str| figures[key].as_f64().unwrap();
        assert_eq!(number(&figures, "step"), 3.0);
        assert!(number(&figures, "share") > number(&figures, "limit"));
        let finer = number(&figures, "advised_step");
        assert!(finer < 3.0 && number(&figures, "advised_share") <= number(&figures, "limit"));
        assert!(found.contains(&format!(": use step {finer}")), "{found}");
        // With the step that is advised there is nothing to find.
        let (found, figures) = checked(&place, &format!("{line} --step {finer}"));
        assert!(found.ends_with(&format!("step {finer} will do")), "{found}");
        assert_eq!(figures["advised_step"], finer);
        // The picture is the one that it would be without the check.
        place.done(&format!("{line} --step {finer} -o plain.png"));
        let files = ["c.png", "plain.png"].map(|name| std::fs::read(place.path(name)).unwrap());
        assert!(files[0] == files[1], "{mode}");
    }
    // Not asked for, it is not there.
    place.done(&format!(
        "render v.nrrd --step 1 --size 8 -o p.png --stats p.json {device}"
    ));
    assert_eq!(place.json("p.json")["sampling_check"], Value::Null);
}

#[test]
fn where_nothing_is_sampled_at_steps_there_is_nothing_to_check() {
    let place = place();
    let refused = |line: &str, sentence: &str| {
        let message = place.refused(&format!("render v.nrrd -o x.png --size 8 {line}"), 2);
        assert!(message.contains(sentence), "{line}: {message}");
    };
    refused(
        "--check-sampling --device reference",
        "the reference takes no samples",
    );
    let Some(device) = common::device_flag() else {
        return;
    };
    for (line, sentence) in [
        (
            "--check-sampling",
            "exact sampling takes no samples at steps",
        ),
        (
            "--check-sampling --mode mip --sampling exact",
            "exact sampling takes no samples",
        ),
        (
            "--check-sampling --mode dvr --quad adaptive",
            "quad adaptive takes no samples",
        ),
        (
            "--check-sampling --max-error rmse:0.1",
            "cannot be combined",
        ),
        ("--jitter hash:1 --sampling exact", "need none"),
        (
            "--jitter hash:1 --mode dvr --quad adaptive:0.01",
            "need none",
        ),
        ("--jitter interleaved:17", "must be from 2 to 16"),
        ("--jitter blue", "is not a jitter"),
    ] {
        refused(&format!("{line} {device}"), sentence);
    }
}

#[test]
fn a_jittered_picture_is_replayed_and_the_reference_knows_no_jitter() {
    let Some(device) = common::device_flag() else {
        return;
    };
    let place = place();
    let line = "render v.nrrd --mode mip --step 2 --size 24";
    for jitter in ["interleaved:3", "hash:9:4", "shift:0.7"] {
        place.done(&format!("{line} --jitter {jitter} -o a.png {device}"));
        place.done("replay a.png -o b.png");
        let read = |name: &str| std::fs::read(place.path(name)).unwrap();
        assert!(read("a.png") == read("b.png"), "{jitter}");
        // The control: without it another picture.
        place.done(&format!("{line} -o c.png {device}"));
        assert!(
            crate::cli_place::pixels(&place.path("a.png"))
                != crate::cli_place::pixels(&place.path("c.png"))
        );
    }
    let by_reference = |more: &str, name: &str| {
        place.done(&format!("{line} {more} -o {name} --device reference"));
        crate::cli_place::pixels(&place.path(name))
    };
    assert_eq!(
        by_reference("", "d.png"),
        by_reference("--jitter hash:1", "e.png")
    );
}

/// An error bound chooses among steps and exact sampling alike: jitter goes with those that have samples.
#[test]
fn an_error_bound_takes_jitter_along() {
    let Some(device) = common::device_flag() else {
        return;
    };
    let place = place();
    for (mode, bound) in [
        ("iso", "missed:0.5"),
        ("iso", "missed:0"),
        ("dvr", "rmse:1e-6"),
    ] {
        place.done(&format!(
            "render v.nrrd --mode {mode} --size 24 --jitter hash:1 --max-error {bound} -o m.png --stats m.json {device}"
        ));
        let scene = &place.json("m.json")["scene"];
        let exact = scene["sampling"] == "exact";
        let expected = if exact {
            Value::Null
        } else {
            "hash:1:0".into()
        };
        assert_eq!(scene["jitter"], expected, "{mode} {bound}");
    }
}
