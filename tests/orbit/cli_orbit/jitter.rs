//! Jitter moves with the frames, and each frame says by which it was made.

use angioray::frame::read_metadata;

use super::{common, contents, pixels, place};

/// The jitter of a picture's scene.
fn jitter(path: &std::path::Path) -> String {
    let metadata = read_metadata(path).unwrap();
    let (_, scene) = metadata.iter().find(|(key, _)| key == "scene").unwrap();
    let scene: toml::Table = scene.parse().unwrap();
    scene["jitter"].as_str().unwrap().to_owned()
}

#[test]
fn frames_are_shifted_otherwise_and_made_again_alike() {
    let Some(device) = common::device_flag() else {
        return;
    };
    let place = place();
    for (given, named) in [
        ("hash:3:10", "hash:3"),
        ("interleaved:4:10", "interleaved:4"),
    ] {
        let folder = |name: &str| format!("{}-{name}", &named[..4]);
        // Two whole turns in two frames: the same view.
        let orbit = format!(
            "orbit v.nrrd --mode dvr --step 2 --size 24 --frames 4 --degrees 1440 --jitter {given} {device}"
        );
        let whole = folder("whole");
        place.done(&format!("{orbit} -o {whole}/%d.png"));
        let path = |k: u32| place.path(&format!("{whole}/{k}.png"));
        for k in 0..4 {
            assert_eq!(jitter(&path(k)), format!("{named}:{}", 10 + k));
            let again = folder(&format!("{k}.png"));
            place.done(&format!("replay {whole}/{k}.png -o {again}"));
            let files = [path(k), place.path(&again)].map(|path| std::fs::read(path).unwrap());
            assert!(files[0] == files[1], "{given} {k}");
        }
        assert_ne!(pixels(&path(0)), pixels(&path(1)));
        assert_ne!(pixels(&path(1)), pixels(&path(2)));
        // In shards, and the rest of them by resuming.
        let parts = folder("parts");
        place.done(&format!("{orbit} -o {parts}/%d.png --shard 1/3"));
        place.done(&format!("{orbit} -o {parts}/%d.png --resume"));
        assert_eq!(contents(&place, &parts), contents(&place, &whole));
    }
    // The control: without jitter, and shifted all alike, the same view is the same picture.
    for given in ["none", "shift:0.5"] {
        let folder = &given[..4];
        place.done(&format!(
            "orbit v.nrrd --mode dvr --step 2 --size 24 --frames 2 --degrees 720 --jitter {given} {device} -o {folder}/%d.png"
        ));
        let path = |k: u32| place.path(&format!("{folder}/{k}.png"));
        assert_eq!(pixels(&path(0)), pixels(&path(1)));
    }
}
