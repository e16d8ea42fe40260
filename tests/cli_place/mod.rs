//! The program run from outside, in a folder of its own.
#![allow(dead_code)] // each test program uses its own part

use std::fs::File;
use std::io::BufReader;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output};
use std::thread::sleep;
use std::time::{Duration, Instant};

use serde_json::Value;
use tempfile::TempDir;

const PROGRAM: &str = env!("CARGO_BIN_EXE_angioray");

/// A folder with a phantom to work in.
pub struct Place {
    folder: TempDir,
}

impl Place {
    pub fn empty() -> Self {
        Self {
            folder: tempfile::tempdir().unwrap(),
        }
    }

    /// With a ball of 16³ voxels, `ball.nrrd`: 0 outside, 200 inside.
    pub fn with_ball() -> Self {
        let place = Self::empty();
        place.done("phantom sphere -o ball.nrrd --size 16");
        place
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    pub fn write(&self, name: &str, text: &str) {
        std::fs::write(self.path(name), text).unwrap();
    }

    pub fn command(&self, line: &str) -> Command {
        let mut command = Command::new(PROGRAM);
        command
            .args(line.split_whitespace())
            .current_dir(self.folder.path());
        command
    }

    pub fn run(&self, line: &str) -> Output {
        self.command(line).output().unwrap()
    }

    /// Runs a line that must succeed; its stdout.
    pub fn done(&self, line: &str) -> String {
        let output = self.run(line);
        assert!(output.status.success(), "{line}: {}", stderr(&output));
        String::from_utf8(output.stdout).unwrap()
    }

    /// Runs a line that must fail with this exit code, one error line, nothing on stdout and no
    /// file left behind; its stderr.
    pub fn refused(&self, line: &str, code: i32) -> String {
        let before = self.files();
        let output = self.run(line);
        let messages = stderr(&output);
        assert_eq!(output.status.code(), Some(code), "{line}: {messages}");
        assert!(output.stdout.is_empty(), "{line}");
        let errors = messages
            .lines()
            .filter(|l| l.starts_with("error: "))
            .count();
        assert_eq!(errors, 1, "{line}: {messages}");
        let known = ["error: ", "hint: ", "note: "];
        let stray = messages
            .lines()
            .find(|l| !known.iter().any(|k| l.starts_with(k)));
        assert_eq!(stray, None, "{line}");
        assert!(!messages.contains('\u{1b}'), "{line}: {messages:?}");
        assert_eq!(self.files(), before, "{line}");
        messages
    }

    pub fn files(&self) -> Vec<PathBuf> {
        let entries = std::fs::read_dir(self.folder.path()).unwrap();
        let mut files: Vec<PathBuf> = entries.map(|e| e.unwrap().path()).collect();
        files.sort();
        files
    }

    pub fn json(&self, name: &str) -> Value {
        serde_json::from_str(&std::fs::read_to_string(self.path(name)).unwrap()).unwrap()
    }
}

/// The display pixels of a PNG, 0..1.
pub fn pixels(path: &Path) -> Vec<[f64; 3]> {
    let file = BufReader::new(File::open(path).unwrap());
    let mut reader = png::Decoder::new(file).read_info().unwrap();
    let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut bytes).unwrap();
    let pixels = bytes[..info.buffer_size()].chunks_exact(info.color_type.samples());
    pixels
        .map(|p| [p[0], p[1], p[2]].map(|c| f64::from(c) / 255.0))
        .collect()
}

pub fn stderr(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

/// Asks a process to end, as Ctrl-C or a scheduler does.
#[cfg(unix)]
pub fn terminate(child: &Child) {
    let mut kill = Command::new("kill");
    kill.args(["-TERM", &child.id().to_string()]);
    assert!(kill.status().unwrap().success());
}

/// Waits until a process catches SIGTERM.
#[cfg(target_os = "linux")]
pub fn wait_until_it_listens(child: &Child) {
    const SIGTERM: u64 = 15;
    let began = Instant::now();
    loop {
        let status = std::fs::read_to_string(format!("/proc/{}/status", child.id())).unwrap();
        let caught = status.lines().find_map(|line| line.strip_prefix("SigCgt:"));
        let caught = u64::from_str_radix(caught.unwrap().trim(), 16).unwrap();
        if caught >> (SIGTERM - 1) & 1 == 1 {
            return;
        }
        assert!(began.elapsed() < Duration::from_secs(60));
        sleep(Duration::from_millis(1));
    }
}
