//! Every example of every command's help and every command line of the README, run: on small volumes
//! under the names that the examples use, and small pictures.

use std::fs;
use std::io::Write;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::time::Duration;

use angioray::progress::Silent;
use angioray::volume::{ReadOptions, read};
use flate2::Compression;
use flate2::write::GzEncoder;

use crate::cli_place::{Place, stderr};
use crate::common;

/// The side of the raw volumes, which their names say.
const RAW_SIDE: usize = 256;

/// The examples of a help: the lines below the heading, up to an empty one.
fn examples(help: &str) -> Vec<String> {
    let (_, after) = help.split_once("Example:\n").unwrap_or_default();
    let lines = after.lines().take_while(|line| !line.trim().is_empty());
    lines.map(|line| line.trim().to_owned()).collect()
}

/// The program's commands, as its help lists them.
fn commands(place: &Place) -> Vec<String> {
    let help = place.done("--help");
    let (_, after) = help.split_once("Commands:\n").unwrap();
    let lines = after.lines().take_while(|line| !line.is_empty());
    let names = lines.filter(|line| line.starts_with("  ") && !line.starts_with("   "));
    let names = names.map(|line| line.split_whitespace().next().unwrap().to_owned());
    names.filter(|name| name != "help").collect()
}

/// The command lines of a README: those of its blocks for a shell.
fn command_lines(readme: &str) -> Vec<&str> {
    let mut blocks = readme.split("```");
    blocks.next();
    // Every second part lies between two fences.
    let blocks = blocks
        .step_by(2)
        .filter_map(|block| block.strip_prefix("sh\n"));
    blocks
        .flat_map(str::lines)
        .filter(|line| !line.is_empty())
        .collect()
}

/// The volumes that the examples name, and what else they take for granted.
fn prepared() -> Place {
    let place = Place::empty();
    place.done("phantom vessels -o head.nrrd --size 20");
    let volume = read(&place.path("head.nrrd"), &ReadOptions::default(), &Silent).unwrap();
    let voxels = volume.voxels().bytes();
    let [nx, ny, nz] = volume.dims().array();
    let mha = format!(
        "ObjectType = Image\nNDims = 3\nDimSize = {nx} {ny} {nz}\nElementType = MET_UCHAR\n\
         ElementDataFile = LOCAL\n"
    );
    fs::write(place.path("cta.mha"), [mha.as_bytes(), voxels].concat()).unwrap();
    let nifti = [&nifti_header([nx, ny, nz])[..], voxels].concat();
    for name in ["head.nii.gz", "cta.nii.gz"] {
        write_gzip(&place.path(name), &nifti);
    }
    // A cube within nothing.
    let mut raw = vec![0_u8; RAW_SIDE.pow(3)];
    for at in 0..8_usize.pow(3) {
        let [x, y, z] = [at % 8, at / 8 % 8, at / 64].map(|c| 120 + c);
        raw[x + RAW_SIDE * (y + RAW_SIDE * z)] = 200;
    }
    fs::write(place.path("head_256x256x256_u8.raw"), &raw).unwrap();
    for name in ["head", "aneurism"] {
        write_gzip(
            &place.path(&format!("{name}_256x256x256_uint8.raw.gz")),
            &raw,
        );
    }
    fs::create_dir(place.path("archive")).unwrap();
    fs::copy(place.path("head.nrrd"), place.path("archive/head.nrrd")).unwrap();
    // What makes work small; an example's own flags win over it.
    place.write("small.toml", "size = [20, 20]\n");
    place.write(
        "few.toml",
        "size = [20, 20]\nrepeats = 1\ncache = 'cache'\n",
    );
    place.write("quick.toml", "quick = true\n");
    prepare_peer(&place);
    place
}

/// NIfTI-1 of bytes, with its voxels behind it.
fn nifti_header(dims: [u32; 3]) -> [u8; 352] {
    let mut header = [0; 352];
    header[..4].copy_from_slice(&348_i32.to_le_bytes());
    let sides = [3].into_iter().chain(dims).chain([1; 4]);
    for (at, side) in sides.enumerate() {
        header[40 + 2 * at..][..2].copy_from_slice(&(side as i16).to_le_bytes());
        header[76 + 4 * at..][..4].copy_from_slice(&1_f32.to_le_bytes());
    }
    // Bytes, eight bits each.
    header[70..72].copy_from_slice(&2_i16.to_le_bytes());
    header[72..74].copy_from_slice(&8_i16.to_le_bytes());
    header[108..112].copy_from_slice(&352_f32.to_le_bytes());
    header[344..348].copy_from_slice(b"n+1\0");
    header
}

fn write_gzip(path: &Path, bytes: &[u8]) {
    let mut gzip = GzEncoder::new(fs::File::create(path).unwrap(), Compression::fast());
    gzip.write_all(bytes).unwrap();
    gzip.finish().unwrap();
}

/// A peer where the examples have VTK's: it says what it is, and that it draws no mode.
fn prepare_peer(place: &Place) {
    for folder in ["target/peers-venv/bin", "scripts/peers"] {
        fs::create_dir_all(place.path(folder)).unwrap();
    }
    place.write("scripts/peers/vtk_peer.py", "");
    let python = place.path("target/peers-venv/bin/python");
    let script = "#!/bin/sh\n\
        echo '{\"peer\":\"fake\",\"version\":\"1\",\"device\":\"none\",\"settings\":[{\"name\":\"a\",\"modes\":[]}]}'\n\
        while read -r line; do case \"$line\" in\n\
        *'\"load\"'*) echo '{\"loaded\":1}' ;;\n\
        *'\"scene\"'*) echo '{\"supported\":false,\"why\":\"it draws nothing\"}' ;;\n\
        *) echo '{}' ;;\nesac; done\n";
    fs::write(&python, script).unwrap();
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        fs::set_permissions(&python, fs::Permissions::from_mode(0o755)).unwrap();
    }
}

/// Runs an example: that it succeeds and leaves what its `-o` names.
///
/// # Errors
/// What it printed, where it does not.
fn run(place: &Place, example: &str) -> Result<(), String> {
    let mut words = shlex::split(example).ok_or("no shell takes it")?;
    let mut array = false;
    if words[0] == "sbatch" {
        // Slurm starts what is wrapped, once for each task of the array.
        let at = words.iter().position(|word| word == "--wrap");
        let wrapped = at
            .and_then(|at| words.get(at + 1))
            .ok_or("nothing is wrapped")?;
        words = shlex::split(wrapped).ok_or("no shell takes it")?;
        array = true;
    }
    if words[0] != "angioray" {
        return Err(format!("{example}: not angioray"));
    }
    let has = |words: &[String], flag: &str| words.iter().any(|word| word == flag);
    let small = match words[1].as_str() {
        "render" | "orbit" => Some("small.toml"),
        "compare" => Some("few.toml"),
        "bench" if !has(&words, "--full") => Some("quick.toml"),
        _ => None,
    };
    if let Some(file) = small.filter(|_| !has(&words, "--scene")) {
        words.extend(["--scene".to_owned(), file.to_owned()]);
    }
    let mut command = place.command("");
    command.args(&words[1..]);
    if array {
        command
            .env("SLURM_ARRAY_TASK_ID", "3")
            .env("SLURM_ARRAY_TASK_COUNT", "8");
    }
    let named = words
        .iter()
        .position(|word| word == "-o")
        .map(|at| &words[at + 1]);
    let output = match named {
        Some(folder) if words[1] == "bench" => stopped_when_measured(command, &place.path(folder)),
        _ => command.output().unwrap(),
    };
    let messages = stderr(&output);
    let resumable = words[1] == "bench" && output.status.code() == Some(75);
    if !output.status.success() && !resumable {
        let excused = example.contains(".mp4") && messages.contains("ffmpeg") && !has_ffmpeg();
        return if excused {
            Ok(())
        } else {
            Err(format!("{example}: {messages}"))
        };
    }
    let number = if array { "0003" } else { "0000" };
    match named.map(|name| place.path(&name.replace("%04d", number))) {
        Some(path) if !path.exists() => Err(format!("{example}: no {}", path.display())),
        _ => Ok(()),
    }
}

/// Runs an experiment that keeps what it measures in a folder, up to its first unit of work there: it
/// could be resumed from it, and the rest of it, which may take hours, is more of the same.
fn stopped_when_measured(mut command: Command, folder: &Path) -> Output {
    // Of another experiment, to whose name the example before it went.
    let _ = fs::remove_dir_all(folder);
    let mut child = command
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let journal = folder.join("journal.jsonl");
    let is_measured = || {
        let text = fs::read_to_string(&journal).unwrap_or_default();
        text.lines().any(|line| line.contains("\"unit\""))
    };
    while child.try_wait().unwrap().is_none() && !is_measured() {
        std::thread::sleep(Duration::from_millis(5));
    }
    if cfg!(unix) {
        let kill = format!("kill -TERM {} 2>/dev/null", child.id());
        let _ = Command::new("sh").args(["-c", &kill]).status();
    }
    child.wait_with_output().unwrap()
}

fn has_ffmpeg() -> bool {
    Command::new("ffmpeg").arg("-version").output().is_ok()
}

/// Every example of a command's help.
fn run_help(place: &Place, command: &str) {
    let help = place.done(&format!("{command} --help"));
    if let Some((_, after)) = help.split_once("A file of settings, for --configs:\n") {
        place.write("steps.toml", after);
    }
    let examples = examples(&help);
    assert!(!examples.is_empty(), "{command}: {help}");
    for example in examples {
        run(place, &example).unwrap();
    }
}

#[test]
fn every_example_of_every_help_runs() {
    if common::device().is_none() {
        return;
    }
    let place = prepared();
    let commands = commands(&place);
    // Those first whose pictures others take up.
    let mut order = vec!["render", "orbit"];
    order.extend(commands.iter().map(String::as_str));
    order.retain(|command| *command != "bench");
    assert!(order.len() > 10, "{order:?}");
    run_help(&place, "");
    for (at, command) in order.iter().enumerate() {
        if !order[..at].contains(command) {
            run_help(&place, command);
        }
    }
}

#[test]
fn every_example_of_bench_runs() {
    if common::device().is_none() {
        return;
    }
    run_help(&prepared(), "bench");
}

#[test]
fn every_command_line_of_the_readme_runs() {
    if common::device().is_none() {
        return;
    }
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let readme = fs::read_to_string(root.join("README.md")).unwrap();
    let lines = command_lines(&readme);
    assert!(lines.len() > 12, "{lines:?}");
    let place = prepared();
    for line in lines {
        match line.strip_prefix("scripts/") {
            // These set up, build and test all of the repository.
            Some(script) => {
                let script = root.join("scripts").join(script.split(' ').next().unwrap());
                let checked = Command::new("bash")
                    .arg("-n")
                    .arg(&script)
                    .status()
                    .unwrap();
                assert!(checked.success(), "{}", script.display());
            }
            None => run(&place, line).unwrap(),
        }
    }
}

#[test]
fn a_wrong_example_is_caught() {
    let place = Place::with_ball();
    place.write("small.toml", "size = [8, 8]\n");
    let reference = "--device reference";
    run(
        &place,
        &format!("angioray render ball.nrrd -o a.png {reference} # fine"),
    )
    .unwrap();
    for wrong in [
        "angioray render ball.nrrd -o b.png --modee mip",
        "angioray render ball.nrrd -o b.png --tf cta",
        "angioray render bell.nrrd -o b.png",
        "angioray renders ball.nrrd -o b.png",
        "angioroy render ball.nrrd -o b.png",
        "sbatch --wrap 'angioray render ball.nrrd -o b.png --mode miip'",
    ] {
        let error = run(&place, &format!("{wrong} {reference}")).unwrap_err();
        assert!(!place.path("b.png").exists(), "{error}");
    }
    // One that says nothing of its own, as a README's block of another language.
    assert_eq!(
        command_lines("```toml\na = 1\n```\n\n```sh\nangioray x\n```\n"),
        ["angioray x"]
    );
    assert_eq!(
        examples("Example:\n  angioray a\n  angioray b\n\nmore\n"),
        ["angioray a", "angioray b"]
    );
}
