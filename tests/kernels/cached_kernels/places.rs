//! Where kernels are cached, where the driver builds, and what is reported where neither can be.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use super::Place;

fn stderr_of(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// Runs it; what it printed on stderr, the picture being there.
fn done(place: &Place, command: &mut Command) -> String {
    let output = command.output().unwrap();
    assert!(output.status.success(), "{output:?}");
    assert!(place.path("picture.png").exists());
    fs::remove_file(place.path("picture.png")).unwrap();
    stderr_of(&output)
}

/// The folder in quotes that begins like this.
fn named<'a>(messages: &'a str, start: &str) -> Option<&'a Path> {
    let mut quoted = messages.split('\'').filter(|part| part.contains(start));
    quoted.next().map(Path::new)
}

#[test]
fn where_no_folder_can_be_written_a_private_one_is_used_and_named() {
    let Some(place) = Place::new() else { return };
    let file = place.path("file");
    fs::write(&file, "").unwrap();
    let homeless = |cache: &Path| {
        let mut command = place.simple_command();
        command
            .env_remove("ANGIORAY_KERNEL_CACHE")
            .env_remove("POCL_CACHE_DIR")
            .env("HOME", &file)
            .env("XDG_CACHE_HOME", cache);
        command
    };
    for nowhere in [&file, &file.join("below")] {
        let printed = done(&place, &mut homeless(nowhere));
        let note = printed.lines().find(|line| line.contains("not cached"));
        let note = note.unwrap_or_else(|| panic!("{printed}"));
        assert!(
            note.starts_with("note: ") && note.contains("ANGIORAY_KERNEL_CACHE"),
            "{note}"
        );
        let folder = named(note, "angioray-driver-").unwrap();
        assert!(folder.is_absolute() && !folder.exists(), "{note}");
    }
    // The control: where there is a folder nothing is reported, and kernels are cached in it.
    let cache = place.path("cache");
    let printed = done(&place, &mut homeless(&cache));
    assert!(!printed.contains("not cached"), "{printed}");
    assert!(fs::read_dir(cache.join("angioray")).unwrap().count() > 0);
}

#[test]
fn an_empty_name_keeps_no_kernels() {
    let Some(place) = Place::new() else { return };
    let render = |name: &str| {
        let mut command = place.simple_command();
        command.env("ANGIORAY_KERNEL_CACHE", name);
        command.env("XDG_CACHE_HOME", place.path("cache"));
        command.current_dir(place.path(""));
        let printed = done(&place, &mut command);
        assert!(!printed.contains("note: kernels"), "{printed}");
    };
    let files = || {
        let entries = fs::read_dir(place.path("")).unwrap();
        let mut names: Vec<_> = entries.map(|entry| entry.unwrap().file_name()).collect();
        names.sort();
        names
    };
    let before = files();
    render("");
    render("off");
    assert_eq!(files(), before);
    // The control: a name is a folder's.
    render("kernels");
    assert!(place.path("kernels").is_dir());
}
