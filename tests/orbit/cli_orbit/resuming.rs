//! Going on with what is there, and only with what would be made again.

use std::fs;

use super::{REFERENCE, common, contents, place};
use crate::cli_place::stderr;

#[test]
fn resuming_makes_what_is_missing_torn_or_of_another_scene() {
    let place = place();
    for (extension, layers) in [("png", ""), ("exr", "--aov depth")] {
        let line = |folder: &str, iso: u32| {
            format!(
                "orbit v.nrrd --iso {iso} --size 16 --frames 8 {layers} \
                 -o {folder}/%02d.{extension} {REFERENCE}"
            )
        };
        let (whole, part) = (format!("{extension}-whole"), format!("{extension}-part"));
        place.done(&line(&whole, 70));
        place.done(&line(&part, 70));
        let path = |k: u32| place.path(&format!("{part}/{k:02}.{extension}"));
        let modified = |k: u32| fs::metadata(path(k)).unwrap().modified().unwrap();
        let before: Vec<_> = [0, 4, 7].map(modified).into();
        // Missing; without its end; with a byte of its picture changed; empty; another scene's.
        fs::remove_file(path(1)).unwrap();
        let bytes = fs::read(path(2)).unwrap();
        fs::write(path(2), &bytes[..bytes.len() - 20]).unwrap();
        let mut bytes = fs::read(path(3)).unwrap();
        let at = bytes.len() - 40;
        bytes[at] ^= 0x55;
        if extension == "png" {
            fs::write(path(3), &bytes).unwrap();
        } else {
            // An EXR has no check sums: cut within its pixels instead.
            fs::write(path(3), &bytes[..at]).unwrap();
        }
        fs::write(path(5), "").unwrap();
        place.done(&line("other", 90));
        fs::copy(place.path(&format!("other/06.{extension}")), path(6)).unwrap();

        let output = place.run(&format!("{} --resume", line(&part, 70)));
        let messages = stderr(&output);
        assert!(output.status.success(), "{messages}");
        assert!(messages.contains(": 5 frames, 3 existed"), "{messages}");
        assert_eq!(contents(&place, &part), contents(&place, &whole));
        assert_eq!(before, [0, 4, 7].map(modified));
        // Nothing is left to do; of another scene, or coded otherwise, all is.
        let messages = stderr(&place.run(&format!("{} --resume", line(&part, 70))));
        assert!(messages.contains("nothing to do, 8 existed"), "{messages}");
        let messages = stderr(&place.run(&format!("{} --resume --zoom 2", line(&part, 70))));
        assert!(messages.contains(": 8 frames, iso"), "{messages}");
    }
    let eight = "orbit v.nrrd --iso 70 --size 16 --frames 8";
    let messages = stderr(&place.run(&format!(
        "{eight} -o png-whole/%02d.png --bit-depth 16 --resume {REFERENCE}"
    )));
    assert!(messages.contains(": 8 frames, iso"), "{messages}");
    // Without --resume frames are made anew.
    let messages = stderr(&place.run(&format!("{eight} -o png-part/%02d.png {REFERENCE}")));
    assert!(messages.contains(": 8 frames, iso"), "{messages}");
}

#[test]
fn frames_of_another_volume_under_its_name_are_made_again() {
    let place = place();
    let line =
        format!("orbit v.nrrd --iso 70 --size 8 --frames 3 -o f/%d.png --resume {REFERENCE}");
    place.done(&line);
    let made = contents(&place, "f");
    // The control: written anew, but the same.
    place.done("phantom vessels -o v.nrrd --size 24 --seed 2");
    let messages = stderr(&place.run(&line));
    assert!(messages.contains("nothing to do, 3 existed"), "{messages}");
    place.done("phantom vessels -o v.nrrd --size 24 --seed 3");
    let messages = stderr(&place.run(&line));
    assert!(messages.contains(": 3 frames, iso"), "{messages}");
    assert_ne!(contents(&place, "f"), made);
}

#[test]
fn frames_by_another_device_are_made_again() {
    let Some(device) = common::device_flag() else {
        return;
    };
    let place = place();
    for extension in ["png", "exr"] {
        let line = |device: &str| {
            format!(
                "orbit v.nrrd --iso 70 --shading none --size 8 --frames 2 -o {extension}/%d.{extension} \
                 --resume {device}"
            )
        };
        place.done(&line(REFERENCE));
        let messages = stderr(&place.run(&line(&device)));
        assert!(messages.contains(": 2 frames, iso"), "{messages}");
        // The control.
        let messages = stderr(&place.run(&line(&device)));
        assert!(messages.contains("nothing to do, 2 existed"), "{messages}");
    }
}
