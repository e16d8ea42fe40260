//! How words are written: in upper or lower case, colours by their names.

use crate::cli_place::{Place, pixels, stderr};

const REFERENCE: &str = "--device reference --size 8";

#[test]
fn words_are_taken_in_upper_and_lower_case() {
    let place = Place::with_ball();
    let bytes = |name: &str| std::fs::read(place.path(name)).unwrap();
    for (lower, other) in [
        ("--mode mip --view left", "--mode MIP --view Left"),
        (
            "--mode dvr --quad simpson --tf mra",
            "--mode Dvr --quad Simpson --tf MRA",
        ),
        (
            "--mode dvr --quad adaptive:1e-3",
            "--mode dvr --quad Adaptive:1E-3",
        ),
        (
            "--iso otsu --shading blinn-phong",
            "--iso OTSU --shading Blinn-Phong",
        ),
        (
            "--iso 9 --refine newton:4 --step 1",
            "--iso 9 --refine Newton:4 --step 1",
        ),
        (
            "--iso 9 --light headlight --caps off",
            "--iso 9 --light HeadLight --caps OFF",
        ),
        ("--iso 9 --carm RAO30CRA10", "--iso 9 --carm rao30cra10"),
        (
            "--iso p40 --gradient forward",
            "--iso P40 --gradient FORWARD",
        ),
        (
            "--iso 9 --traverse kd-restart",
            "--iso 9 --traverse KD-Restart",
        ),
        ("--mode mip --filter nearest", "--mode mip --filter NEAREST"),
        ("--iso 9 --color white", "--iso 9 --color White"),
    ] {
        place.done(&format!("render ball.nrrd -o a.png {lower} {REFERENCE}"));
        let reference = REFERENCE.replace("reference", "Reference");
        place.done(&format!("render ball.nrrd -o b.png {other} {reference}"));
        assert_eq!(bytes("a.png"), bytes("b.png"), "{lower}");
        // The control: what is no such word is refused in either case.
        let line = format!("render ball.nrrd -o c.png {lower}x {REFERENCE}");
        let code = place.run(&line).status.code();
        // A transfer function that is no preset is a file.
        let expected = if lower.contains("--tf") { 65 } else { 2 };
        assert_eq!(code, Some(expected), "{line}");
    }
    place.done("phantom Sphere -o s.nrrd --size 8 --type U16");
    place.done("phantom slab -o t.nrrd --size 8X8X9 --axis Z");
    place.done("phantom HardCase:Thin-Vessels -o h.nrrd");
    place.done("render ball.nrrd -o x.exr --aov Depth,VALUE --iso 9 --device reference --size 4X4");
    place.write("mode.toml", "mode = 'MIP'\nview = 'Posterior'\n");
    place.done(&format!(
        "render ball.nrrd -o m.png --scene mode.toml {REFERENCE}"
    ));
    for line in ["bench Nothing", "phantom Cube -o c.nrrd", "completion Tcsh"] {
        place.refused(line, 2);
    }
}

#[test]
fn colours_have_names() {
    let place = Place::with_ball();
    let corner = |color: &str| {
        let line = format!("render ball.nrrd -o a.png --iso 9 --background {color} {REFERENCE}");
        place.done(&line);
        pixels(&place.path("a.png"))[0].map(|channel| (channel * 255.0).round() as u8)
    };
    for (name, rgb) in [
        ("white", [255, 255, 255]),
        ("black", [0, 0, 0]),
        ("RebeccaPurple", [0x66, 0x33, 0x99]),
        ("slategrey", [0x70, 0x80, 0x90]),
        ("slategray", [0x70, 0x80, 0x90]),
        ("#fa0", [0xff, 0xaa, 0]),
        ("#102030", [0x10, 0x20, 0x30]),
        ("1,0,0.2", [255, 0, 51]),
    ] {
        assert_eq!(corner(name), rgb, "{name}");
    }
    for wrong in [
        "whitest",
        "transparent",
        "#12345",
        "#1234",
        "#ggg",
        "1,2,3",
        "rgb(1,2,3)",
    ] {
        let line = format!("render ball.nrrd -o b.png --background {wrong} {REFERENCE}");
        let message = place.refused(&line, 2);
        assert!(message.contains("is not a colour"), "{message}");
    }
}

#[test]
fn quiet_prints_nothing_but_errors() {
    let place = Place::with_ball();
    let line = format!("render ball.nrrd -o a.png {REFERENCE}");
    for (quiet, is_quiet) in [
        (line.clone(), false),
        (format!("{line} --quiet"), true),
        (format!("--quiet {line}"), true),
        (format!("{line} --quiet=off"), false),
    ] {
        let output = place.run(&quiet);
        assert!(output.status.success(), "{quiet}");
        assert_eq!(
            stderr(&output).is_empty(),
            is_quiet,
            "{quiet}: {}",
            stderr(&output)
        );
    }
    place.write("quiet.toml", "quiet = true\n");
    let by_file = place.run(&format!("{line} --scene quiet.toml"));
    assert!(by_file.status.success() && by_file.stderr.is_empty());
    let over_file = place.run(&format!("{line} --scene quiet.toml --quiet=off"));
    assert!(!over_file.stderr.is_empty());
    for command in ["phantom sphere -o q.nrrd --size 8", "man", "info ball.nrrd"] {
        let output = place.run(&format!("{command} --quiet"));
        assert!(
            output.status.success() && output.stderr.is_empty(),
            "{command}"
        );
    }
    // The control: an error is printed.
    let message = place.refused("render ball.nrrd -o a.png --quiet --mode x", 2);
    assert!(message.starts_with("error: "), "{message}");
    let message = place.refused("render none.nrrd -o a.png --quiet --device reference", 65);
    assert!(message.contains("none.nrrd"), "{message}");
}

#[test]
fn completions_and_the_manual_hold_every_command_and_option() {
    let place = Place::empty();
    let man = place.done("man");
    let bash = place.done("completion bash");
    // A hyphen in a manual is written so that it stays an ASCII hyphen.
    let in_man = |flag: &str| man.contains(&flag.replace('-', "\\-"));
    let mut flags = 0;
    for command in [
        "render", "orbit", "compare", "replay", "bench", "info", "phantom",
    ] {
        assert!(man.contains(&format!(".SH ANGIORAY {}", command.to_uppercase())));
        let help = place.done(&format!("{command} --help"));
        // An option stands at its line's beginning, after its short name where it has one.
        let options = help.lines().filter_map(|line| {
            let (spec, _) = line
                .trim_start()
                .split_once(' ')
                .unwrap_or((line.trim_start(), ""));
            let spec = match spec {
                "-o," | "-h," => line.trim_start().split(' ').nth(1)?,
                spec => spec,
            };
            spec.starts_with("--").then_some(spec)
        });
        for word in options {
            let end = word.find(|c: char| !(c.is_ascii_lowercase() || c == '-'));
            let flag = &word[..end.unwrap_or(word.len())];
            assert!(in_man(flag) && bash.contains(flag), "{command} {flag}");
            flags += 1;
        }
    }
    assert!(flags > 100 && man.starts_with(".ie"), "{flags}");
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let script = place.done(&format!("completion {shell}"));
        assert!(
            script.contains("lmip-threshold") && script.contains("replay"),
            "{shell}"
        );
    }
    // The control: what is no option is in neither.
    assert!(!in_man("--nothing-of-it") && !bash.contains("--nothing-of-it"));
    if let Some(offered) = completed_by_bash(&bash, "angioray re") {
        assert_eq!(offered, ["render", "replay"]);
    }
    if let Some(offered) = completed_by_bash(&bash, "angioray render --lmip") {
        assert_eq!(offered, ["--lmip-threshold"]);
    }
}

/// What bash offers at the end of a line, sorted as it offers it; nothing where there is no bash.
fn completed_by_bash(script: &str, line: &str) -> Option<Vec<String>> {
    let words: Vec<&str> = line.split(' ').collect();
    let ask = format!(
        "{script}\nCOMP_WORDS=({line}); COMP_CWORD={}\n\
         _angioray angioray '{}' '{}'\nprintf '%s\\n' \"${{COMPREPLY[@]}}\"",
        words.len() - 1,
        words[words.len() - 1],
        words[words.len() - 2],
    );
    let output = std::process::Command::new("bash")
        .args(["-c", &ask])
        .output()
        .ok()?;
    let offered = String::from_utf8(output.stdout).unwrap();
    Some(offered.lines().map(str::to_owned).collect())
}
