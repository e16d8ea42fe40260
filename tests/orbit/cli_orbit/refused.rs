//! What makes no orbit is refused, before any work.

use super::{REFERENCE, place};

// long: the table of cases.
#[test]
fn orbits_that_make_no_sense_are_refused() {
    let place = place();
    place.write("1.png", "iso = 70\n");
    place.write("busy", "");
    for (line, code, reason) in [
        ("-o %02d.png", 2, "--frames"),
        ("--frames 3 -o a.png", 2, "every frame would have this name"),
        ("--frames 3 -o a%s.png", 2, "after %"),
        (
            "--frames 3 -o %d/a.png",
            2,
            "every frame would have this name",
        ),
        ("--frames 3 -o %d%d.png", 2, "one number"),
        ("--frames 3 -o %d.tga", 2, ".tga"),
        ("--frames 0 -o %d.png", 2, "an orbit of 0 frames"),
        // At once: not after a look at every frame's file.
        (
            "--frames 4000000000 -o %d.png",
            2,
            "an orbit of 4000000000 frames",
        ),
        ("--frames -1 -o %d.png", 2, "--frames"),
        ("--frames 3 -o %d.png --degrees far", 2, "--degrees"),
        ("--frames 3 -o %d.png --axis w", 2, "is not an axis"),
        ("--frames 3 -o %d.png --axis 0,0,0", 2, "is not an axis"),
        ("--frames 3 -o %d.png --shard 3/3", 2, "counts from 0"),
        ("--frames 3 -o %d.png --shard auto", 2, "environment"),
        (
            "--frames 3 -o %d.png --fps 10",
            2,
            "'--fps' is for animations",
        ),
        ("--frames 3 -o a.gif --fps 60", 2, "at most 50"),
        ("--frames 3 -o a.gif --fps 0", 2, "frames per second"),
        (
            "--frames 3 -o a.apng --shard 0/2",
            2,
            "'--shard' cannot be combined",
        ),
        ("--frames 3 -o a.apng --aov depth", 2, "--aov"),
        ("--frames 3 -o a.apng --bit-depth 16", 2, "--bit-depth 16"),
        ("--frames 3 -o a.gif --bit-depth 16", 2, "--bit-depth 16"),
        (
            "--frames 3 -o %d.png --shard 0/2 --stats s.json",
            2,
            "every shard would write",
        ),
        (
            "--frames 3 -o %d.jpg --resume",
            2,
            "'--resume' cannot be used",
        ),
        (
            "--frames 3 -o %d.webp --resume",
            2,
            "'--resume' cannot be used",
        ),
        ("--frames 3 -o %d.png --scene 1.png", 2, "this file is read"),
        (
            "--frames 3 -o %d.png --stats 2.png",
            2,
            "where the statistics go",
        ),
        ("--frames 3 -o a.gif --stats a.gif", 2, "a file each"),
        ("--frames 3 -o busy/%d.png", 74, "is not a folder"),
        ("--frames 3 -o busy/more/%d.png", 74, "is not a folder"),
        ("--frames 3 -o none/a.gif", 74, "does not exist"),
    ] {
        let message = place.refused(&format!("orbit v.nrrd {line} {REFERENCE}"), code);
        assert!(message.contains(reason), "{line}: {message}");
    }
    // Before the volume is looked for, and whatever the file is called by.
    let message = place.refused(
        &format!("orbit none.nrrd --frames 0 -o %d.png {REFERENCE}"),
        2,
    );
    assert!(message.contains("an orbit of 0 frames"), "{message}");
    #[cfg(unix)]
    {
        std::fs::create_dir(place.path("f")).unwrap();
        std::os::unix::fs::symlink("../v.nrrd", place.path("f/2.png")).unwrap();
        let line =
            |frames| format!("orbit v.nrrd --size 8 --frames {frames} -o f/%d.png {REFERENCE}");
        let message = place.refused(&line(3), 2);
        assert!(
            message.contains("writing frame 2 would replace it"),
            "{message}"
        );
        // The control: without that frame nothing is replaced.
        place.done(&line(2));
    }
    place.refused(
        &format!("orbit none.nrrd --frames 3 -o f/%d.png {REFERENCE}"),
        65,
    );
}
