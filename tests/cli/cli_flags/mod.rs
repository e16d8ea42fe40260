//! Flags and the scene file's keys: one name for both, in every command.

use crate::cli_place;

mod examples;
mod words;

use serde_json::Value;

use cli_place::{Place, stderr};

#[test]
fn every_flag_is_a_key_of_the_command_s_scene_file() {
    let place = Place::empty();
    let command = |name: &str| {
        let help = place.done(&format!("{name} --help"));
        let flag = |line: &str| {
            let (_, after) = line.trim_start().split_at_checked(0)?;
            let after = after.strip_prefix("-o, ").unwrap_or(after);
            let name = after.strip_prefix("--")?;
            let end = name.find(|c: char| !(c.is_ascii_lowercase() || c == '-'));
            Some(name[..end.unwrap_or(name.len())].to_owned())
        };
        let flags: Vec<String> = help.lines().filter_map(flag).collect();
        assert!(flags.contains(&"scene".to_owned()), "{name}: {flags:?}");
        flags
    };
    let mut keys: Vec<String> = [
        "render", "orbit", "compare", "replay", "bench", "info", "phantom", "devices",
    ]
    .into_iter()
    .flat_map(command)
    .filter(|flag| flag != "scene")
    .collect();
    assert!(keys.len() > 40, "{keys:?}");
    keys.sort();
    keys.dedup();
    keys.extend(["volumes", "kind", "experiment", "image", "shell"].map(str::to_owned));
    for key in keys {
        // Of a wrong type for every key: accepted as a key, refused as a value by its command.
        place.write("keys.toml", &format!("\n{key} = {{ a = 1 }}\n"));
        let refusals: Vec<String> = [
            "render",
            "orbit",
            "compare",
            "replay",
            "bench",
            "phantom",
            "info",
            "completion",
        ]
        .into_iter()
        .map(|command| place.refused(&format!("{command} --scene keys.toml"), 2))
        .collect();
        let at = |message: &String| message.starts_with("error: keys.toml:2: ");
        assert!(refusals.iter().any(at), "{key}: {refusals:?}");
        let unknown = |message: &String| message.contains("not an option of a scene");
        assert!(!refusals.iter().any(unknown), "{key}: {refusals:?}");
    }
    // The controls: keys that no command has.
    for key in ["scene", "help", "phantom", "sparsely"] {
        place.write("keys.toml", &format!("\n{key} = 1\n"));
        for command in [
            "render",
            "orbit",
            "compare",
            "replay",
            "bench",
            "info",
            "phantom",
            "devices",
            "completion",
            "man",
        ] {
            let message = place.refused(&format!("{command} --scene keys.toml"), 2);
            assert!(message.starts_with("error: keys.toml:2: "), "{message}");
        }
    }
}

#[test]
fn an_unknown_key_is_refused_with_the_nearest_one() {
    let place = Place::empty();
    for (key, hint) in [
        ("repeat", "hint: did you mean 'repeats'?"),
        ("max_error", "hint: write 'max-error'"),
        ("qqq", "hint: the options are "),
    ] {
        place.write("keys.toml", &format!("{key} = 1\n"));
        let message = place.refused("compare --scene keys.toml", 2);
        let error = format!("error: keys.toml:1: '{key}' is not an option of a scene");
        assert!(
            message.contains(&error) && message.contains(hint),
            "{message}"
        );
    }
}

#[test]
fn what_is_no_whole_number_is_refused_in_words() {
    let place = Place::empty();
    for (wrong, reported) in [
        ("1.5", "'1.5' is not a whole number of at least 0"),
        ("-1", "'-1' is not a whole number of at least 0"),
        (
            "99999999999999999999",
            "'99999999999999999999' is too large a number",
        ),
    ] {
        let message = place.refused(&format!("phantom noise -o n.nrrd --seed {wrong}"), 2);
        assert!(message.contains(reported), "{message}");
    }
    place.write("seed.toml", "seed = 2.5\n");
    let message = place.refused("phantom noise -o n.nrrd --scene seed.toml", 2);
    assert!(
        message.contains("'2.5' is not a whole number of at least 0"),
        "{message}"
    );
}

#[test]
fn one_scene_file_serves_several_commands() {
    let place = Place::empty();
    std::fs::create_dir(place.path("scenes")).unwrap();
    // Files are relative to the scene file.
    place.write(
        "scenes/all.toml",
        "kind = 'slab'\nspacing = 0.5\ntype = 'f32'\nthickness = 2\naxis = 'x'\nseed = 3\n\
         noise = 0.01\ngzip = true\noutput = '../slab.nrrd'\nsize = [12, 10, 8]\n\
         volume = '../slab.nrrd'\njson = true\n",
    );
    let info = |line: &str| {
        let text = place.done(line);
        serde_json::from_str::<Value>(&text).unwrap_or_else(|_| panic!("{line}: {text}"))
    };
    place.done("phantom --scene scenes/all.toml");
    let slab = info("info --scene scenes/all.toml");
    assert_eq!(slab["dims"], serde_json::json!([12, 10, 8]));
    assert_eq!(slab["spacing_mm"], serde_json::json!([0.5, 0.5, 0.5]));
    assert_eq!(slab["type"], "f32");
    let header =
        String::from_utf8_lossy(&std::fs::read(place.path("slab.nrrd")).unwrap()).into_owned();
    assert!(header.contains("encoding: gzip"));
    // A flag wins; another kind drops what belongs to the file's.
    place.done("phantom ramp --scene scenes/all.toml -o ramp.nrrd --size 6 --gzip=off");
    assert_eq!(
        info("info ramp.nrrd --json")["dims"],
        serde_json::json!([6, 6, 6])
    );
    let text = place.done("info --scene scenes/all.toml ramp.nrrd --json=off");
    assert!(text.contains("6x6x6 f32"), "{text}");

    place.write(
        "render.toml",
        "volume = 'slab.nrrd'\noutput = 'slab.exr'\nstats = 'slab.json'\naov = 'all'\n\
         device = 'reference'\nsize = [9, 7]\nmode = 'mip'\n",
    );
    place.done("info --scene render.toml");
    place.done("render --scene render.toml");
    let stats = place.json("slab.json");
    assert_eq!(stats["device"]["name"], "reference");
    assert_eq!(stats["counts"]["rays"], 63);
    // Nothing of where the picture goes is part of the scene.
    for key in ["output", "stats", "aov", "device"] {
        assert!(stats["scene"].get(key).is_none(), "{key}");
    }
    // A picture without layers drops the file's, which by themselves do not fit.
    place.done("render --scene render.toml -o slab.png --stats png.json --mode minip");
    assert_eq!(place.json("png.json")["scene"]["mode"], "minip");
    place.refused("render --scene render.toml -o again.png --aov all", 2);
    place.write(
        "work.toml",
        "work-group = [4, 4]\nquality = 50\nbit-depth = 16\n",
    );
    place.done("render slab.nrrd -o w.exr --size 4 --scene work.toml --device reference");
    place.write("work.toml", "work-group = [4, 4]\ndevice = 'reference'\n");
    place.refused("render slab.nrrd -o w2.exr --size 4 --scene work.toml", 2);
}

#[test]
fn a_negative_number_reaches_its_flag() {
    let place = Place::with_ball();
    let refusal = |command: &str, flag: &str| {
        stderr(&place.run(&format!("{command} {flag} -1 --device reference")))
    };
    let render = "render ball.nrrd -o a.png";
    for flag in [
        "--size",
        "--fov",
        "--ortho",
        "--zoom",
        "--termination",
        "--ambient",
        "--diffuse",
        "--specular",
        "--shininess",
        "--step",
        "--contrast",
        "--gamma",
        "--frame",
        "--smooth",
        "--raw-size",
        "--raw-spacing",
        "--raw-offset",
        "--octree-leaf",
        "--bit-depth",
        "--quality",
        "--work-group",
        "--color",
        "--background",
        "--clip-plane",
        "--gradient-scale",
        "--gradient-smooth",
    ] {
        let message = refusal(render, flag);
        assert!(
            message.contains("-1") && !message.contains("unexpected"),
            "{message}"
        );
    }
    for flag in [
        "--size",
        "--spacing",
        "--seed",
        "--radius",
        "--tip-radius",
        "--noise",
    ] {
        let line = format!("phantom vessels -o v.nrrd {flag} -1");
        let message = place.refused(&line, 2);
        assert!(!message.contains("unexpected"), "{message}");
    }
    assert!(refusal(render, "--zoom").contains("a zoom of -1 is out of its domain"));
    // The control: where no number belongs it is unexpected.
    assert!(refusal(render, "--skip").contains("unexpected"));
}
