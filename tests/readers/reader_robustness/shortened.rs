//! A mapped volume that is shortened while it is read. The process that reads it ends, so that each case
//! is a process of its own: this program once more, with one test and a variable that says what to do.

use std::fs::{self, File};
use std::os::unix::process::ExitStatusExt;
use std::path::Path;
use std::process::{Command, Output};

use angioray::Error;
use angioray::progress::Silent;
use angioray::volume::{ReadOptions, end_when_shortened, read};

const VARIABLE: &str = "ANGIORAY_TEST_SHORTENED";
const SIDE: usize = 64;

fn print(error: &Error) -> String {
    format!("error: {error}\n")
}

/// What a process is to do with the volume in its working folder.
fn act(what: &str) {
    if what != "no handler" {
        end_when_shortened(print).unwrap();
        end_when_shortened(print).unwrap();
    }
    let path = Path::new("cut_64x64x64_u8.raw");
    let shorten = |path: &Path| {
        File::options()
            .write(true)
            .open(path)
            .unwrap()
            .set_len(5000)
    };
    let other = Path::new("other.raw");
    fs::copy(path, other).unwrap();
    // Mapped before it and dropped, and still mapped beside it.
    drop(read(path, &ReadOptions::default(), &Silent).unwrap());
    let raw = ReadOptions {
        raw: angioray::volume::RawLayout {
            size: "64x64x64".parse().ok(),
            element: "u8".parse().ok(),
            ..Default::default()
        },
        ..ReadOptions::default()
    };
    let beside = read(other, &raw, &Silent).unwrap();
    let volume = read(path, &ReadOptions::default(), &Silent).unwrap();
    let sum = |bytes: &[u8]| bytes.iter().map(|&b| u64::from(b)).sum::<u64>();
    match what {
        "whole" => {}
        "not mapped any more" => {
            drop(volume);
            shorten(path).unwrap();
            assert!(sum(beside.voxels().bytes()) > 0);
            return;
        }
        "another's" => {
            let file = File::open(other).unwrap();
            // SAFETY: what is read of it is what is tried.
            let map = unsafe { memmap2::Mmap::map(&file) }.unwrap();
            drop(beside);
            shorten(other).unwrap();
            assert!(sum(&map) > 0);
        }
        _ => shorten(path).unwrap(),
    }
    assert!(sum(volume.voxels().bytes()) > 0);
}

fn run(what: &str) -> Output {
    let folder = tempfile::tempdir().unwrap();
    let voxels: Vec<u8> = (0..SIDE.pow(3)).map(|n| (n / 4096) as u8 + 1).collect();
    fs::write(folder.path().join("cut_64x64x64_u8.raw"), voxels).unwrap();
    Command::new(std::env::current_exe().unwrap())
        .args([
            "--exact",
            "--nocapture",
            "reader_robustness::shortened::a_shortened_volume_ends_the_program_in_words",
        ])
        .env(VARIABLE, what)
        .current_dir(folder.path())
        .output()
        .unwrap()
}

#[test]
fn a_shortened_volume_ends_the_program_in_words() {
    if let Ok(what) = std::env::var(VARIABLE) {
        act(&what);
        return;
    }
    let cut = run("cut");
    let messages = String::from_utf8_lossy(&cut.stderr).into_owned();
    assert_eq!(cut.status.code(), Some(74), "{messages}");
    let lines: Vec<&str> = messages
        .lines()
        .filter(|l| l.starts_with("error: "))
        .collect();
    assert_eq!(lines.len(), 1, "{messages}");
    assert!(
        lines[0].contains("cut_64x64x64_u8.raw: the file was shortened"),
        "{messages}"
    );
    // The controls: what is whole, or no longer mapped, is no end; without asking, and for what is
    // another's, the signal is what it was.
    for fine in ["whole", "not mapped any more"] {
        let output = run(fine);
        assert!(output.status.success(), "{fine}: {output:?}");
    }
    for left in ["no handler", "another's"] {
        let output = run(left);
        assert_eq!(
            output.status.signal(),
            Some(libc::SIGBUS),
            "{left}: {output:?}"
        );
    }
}
