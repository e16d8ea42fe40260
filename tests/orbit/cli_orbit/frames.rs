//! Every frame is what `render` makes, in shards and under an error bound too.

use angioray::frame::read_metadata;

use super::{REFERENCE, apart, common, contents, names, pixels, place};
use crate::cli_place::stderr;

/// Made again, those named in `again`.
fn every_frame_is_a_rendering(device: &str, again: &[u32]) {
    let place = place();
    let scene = "v.nrrd --iso 70 --size 24x20 --elevation 15";
    place.done(&format!(
        "orbit {scene} -o f/%02d.png --frames 5 --axis z {device}"
    ));
    let frames = contents(&place, "f");
    assert_eq!(
        frames.keys().cloned().collect::<Vec<_>>(),
        names(&[0, 1, 2, 3, 4])
    );
    for &k in again {
        let name = format!("{k:02}.png");
        // Its own scene makes it again, pixel for pixel.
        let metadata = read_metadata(&place.path(&format!("f/{name}"))).unwrap();
        let (_, own) = metadata.iter().find(|(key, _)| key == "scene").unwrap();
        place.write("own.toml", own);
        place.done(&format!("render --scene own.toml -o own.png {device}"));
        let [rendered, frame] = ["own.png".into(), format!("f/{name}")].map(|n| place.path(&n));
        assert_eq!(pixels(&rendered), pixels(&frame), "{k}");
        // What a rendering says of itself the frame says too.
        for pair in read_metadata(&rendered).unwrap() {
            assert!(metadata.contains(&pair), "{k}: {pair:?}");
        }
        // And it is seen from where it should be.
        let named = format!("render {scene} --azimuth {} -o named.png {device}", 72 * k);
        place.done(&named);
        let (mean, _) = apart(
            &pixels(&place.path("named.png")),
            &pixels(&place.path(&format!("f/{name}"))),
        );
        assert!(mean < 0.05, "{k}: {mean}");
        // The control: from ten degrees farther it is another picture.
        place.done(&format!(
            "render {scene} --azimuth {} -o farther.png {device}",
            72 * k + 10
        ));
        let (mean, _) = apart(
            &pixels(&place.path("farther.png")),
            &pixels(&place.path(&format!("f/{name}"))),
        );
        assert!(mean > 1.0, "{k}: {mean}");
    }
    // A whole turn is the first frame again: frame 1 of 2 that make two turns.
    place.done(&format!(
        "orbit {scene} -o closed/%02d.png --frames 2 --degrees 720 --axis z {device}"
    ));
    let closed = contents(&place, "closed");
    assert_eq!(closed["00.png"], frames["00.png"]);
    assert_eq!(closed["01.png"], frames["00.png"]);
    assert_ne!(frames["01.png"], frames["00.png"]);
}

#[test]
fn every_frame_is_a_rendering_by_the_reference() {
    every_frame_is_a_rendering(REFERENCE, &[0, 1, 2, 3, 4]);
}

#[test]
fn every_frame_is_a_rendering_on_the_device() {
    if let Some(device) = common::device_flag() {
        every_frame_is_a_rendering(&device, &[3]);
    }
}

#[test]
fn shards_together_are_the_whole() {
    let place = place();
    let orbit = format!("orbit v.nrrd --iso 70 --size 16 --frames 7 {REFERENCE}");
    place.done(&format!("{orbit} -o whole/%02d.png"));
    let mut made = Vec::new();
    for shard in 0..3 {
        place.done(&format!("{orbit} -o parts/%02d.png --shard {shard}/3"));
        made.push(contents(&place, "parts").len());
    }
    assert_eq!(made, [3, 5, 7]);
    assert_eq!(contents(&place, "parts"), contents(&place, "whole"));

    let by_slurm = |id: &str| {
        let mut command = place.command(&format!("{orbit} -o auto/%02d.png --shard auto"));
        command.env("SLURM_ARRAY_TASK_ID", id);
        command.env("SLURM_ARRAY_TASK_MIN", "4");
        command.env("SLURM_ARRAY_TASK_COUNT", "3");
        command.output().unwrap()
    };
    let output = by_slurm("5");
    assert!(output.status.success(), "{}", stderr(&output));
    assert!(stderr(&output).contains("shard 1/3 by SLURM_ARRAY_TASK_ID"));
    let auto: Vec<String> = contents(&place, "auto").into_keys().collect();
    assert_eq!(auto, names(&[1, 4]));
    // The control: a task beyond the array is refused.
    assert_eq!(by_slurm("9").status.code(), Some(2));

    // A batch script is one process, however many tasks its job may start.
    let mut command = place.command(&format!("{orbit} -o script/%02d.png --shard auto"));
    let command = command.env("SLURM_PROCID", "0").env("SLURM_NTASKS", "8");
    let output = command.output().unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("srun"), "{}", stderr(&output));
    assert!(!place.path("script").exists());
}

#[test]
fn an_error_bound_chooses_one_setting_for_the_whole_orbit() {
    let Some(device) = common::device_flag() else {
        return;
    };
    let place = place();
    let orbit = "orbit v.nrrd --mode mean --window 0,60 --size 24 --frames 5";
    place.done(&format!(
        "{orbit} --max-error max:0.03 -o f/%02d.png --stats s.json {device}"
    ));
    place.done(&format!("{orbit} -o reference/%02d.png {REFERENCE}"));
    place.done(&format!("{orbit} -o coarse/%02d.png --step 8 {device}"));
    let stats = place.json("s.json");
    assert_eq!(stats["max_error"]["met"], true);
    assert_eq!(stats["max_error"]["verified"]["views"], 4);
    let how = |k: u32| {
        let metadata = read_metadata(&place.path(&format!("f/{k:02}.png"))).unwrap();
        let (_, scene) = metadata.iter().find(|(key, _)| key == "scene").unwrap();
        let mut scene: toml::Table = scene.parse().unwrap();
        scene.retain(|key, _| key != "eye" && key != "up");
        scene
    };
    let mut coarse_max = 0;
    for k in 0..5 {
        assert_eq!(how(k), how(0));
        let of = |folder: &str| pixels(&place.path(&format!("{folder}/{k:02}.png")));
        let (_, max) = apart(&of("f"), &of("reference"));
        // Both rounded to levels.
        assert!(f64::from(max) <= 0.03 * 255.0 + 1.0, "{k}: {max}");
        coarse_max = coarse_max.max(apart(&of("coarse"), &of("reference")).1);
    }
    // The control: there are settings that do not keep it.
    assert!(f64::from(coarse_max) > 0.03 * 255.0 + 1.0, "{coarse_max}");
    for flag in ["--resume", "--shard 0/2"] {
        let line = format!("{orbit} --max-error max:0.03 -o f/%02d.png {flag} {device}");
        let messages = stderr(&place.run(&line));
        assert!(messages.contains("cannot be combined"), "{messages}");
    }
}
