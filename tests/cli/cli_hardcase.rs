//! `angioray phantom hardcase:NAME`: the volume, its scenes, and what is refused.

use crate::cli_place;

use cli_place::{Place, stderr};

#[test]
fn every_case_is_listed_in_the_help() {
    let help = Place::empty().done("phantom --help");
    for name in ["hardcase:NAME", "tangent", "tf-spike", "clip-planes"] {
        assert!(help.contains(name), "{name}: {help}");
    }
}

#[test]
fn a_case_writes_its_volume_and_its_scenes_and_they_render() {
    let place = Place::empty();
    let messages = stderr(&place.run("phantom hardcase:thin-bright-sheet -o sheet.nrrd"));
    assert!(messages.contains("wrote sheet.nrrd: 33"), "{messages}");
    assert!(messages.contains("and 1 more scenes"), "{messages}");
    let names: Vec<String> = place
        .files()
        .iter()
        .map(|path| path.file_name().unwrap().to_string_lossy().into_owned())
        .collect();
    assert_eq!(
        names,
        [
            "sheet.nrrd",
            "sheet.whole-adaptive.toml",
            "sheet.x-adaptive.toml"
        ]
    );
    for scene in ["x-adaptive", "whole-adaptive"] {
        place.done(&format!(
            "render sheet.nrrd --scene sheet.{scene}.toml -o {scene}.png --device reference"
        ));
        assert!(place.path(&format!("{scene}.png")).exists());
    }
    // The same bytes again; and the scene is part of the answer.
    place.done("phantom hardcase:thin-bright-sheet -o again.nrrd");
    let bytes = |name: &str| std::fs::read(place.path(name)).unwrap();
    assert_eq!(bytes("again.nrrd"), bytes("sheet.nrrd"));
    assert_ne!(bytes("x-adaptive.png"), bytes("whole-adaptive.png"));
}

#[test]
fn a_case_of_one_scene_writes_one_file_beside_the_volume() {
    let place = Place::empty();
    place.done("phantom hardcase:wide-index -o one.nrrd");
    assert!(place.path("one.toml").exists());
    assert_eq!(place.files().len(), 2);
    place.done("render one.nrrd --scene one.toml -o one.png --device reference");
}

#[test]
fn members_are_chosen_by_name() {
    let place = Place::empty();
    place.done("phantom hardcase:types.i8 -o i8.nrrd");
    place.done("phantom hardcase:types -o first.nrrd");
    let bytes = |name: &str| std::fs::read(place.path(name)).unwrap();
    assert_ne!(bytes("i8.nrrd"), bytes("first.nrrd"));
    assert!(place.done("info i8.nrrd").contains("i8"));
}

#[test]
fn what_there_is_not_is_refused_with_what_there_is() {
    let place = Place::empty();
    for (name, hints) in [
        (
            "hardcase:tangents",
            &["no hard case 'tangents'", "tangent, "][..],
        ),
        ("hardcase:", &["no hard case ''", "tf-spike"]),
        ("hardcase:types.u64", &["has no 'u64'", "i8"]),
        ("hardcase:tangent.1", &["it is one volume: write tangent"]),
    ] {
        let message = place.refused(&format!("phantom {name} -o v.nrrd"), 2);
        for hint in hints {
            assert!(message.contains(hint), "{name}: {message}");
        }
    }
    // What only made-up phantoms have.
    for flag in ["--size 9", "--seed 3", "--type f32"] {
        let message = place.refused(&format!("phantom hardcase:tangent -o v.nrrd {flag}"), 2);
        assert!(message.contains("hard case"), "{message}");
    }
}

/// No volume without its scenes: where one of them cannot be written nothing is.
#[test]
fn nothing_is_written_where_a_scene_cannot_be() {
    let place = Place::empty();
    std::fs::create_dir(place.path("v.toml")).unwrap();
    let before = place.files();
    let output = place.run("phantom hardcase:wide-index -o v.nrrd");
    assert!(!output.status.success());
    assert!(stderr(&output).contains("v.toml"), "{}", stderr(&output));
    assert_eq!(place.files(), before);
    // The control: without the folder in its place all is written.
    std::fs::remove_dir(place.path("v.toml")).unwrap();
    place.done("phantom hardcase:wide-index -o v.nrrd");
    assert_eq!(place.files().len(), 2);
}
