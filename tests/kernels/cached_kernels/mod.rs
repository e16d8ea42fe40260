//! Built kernels are cached from run to run, and what is cached cannot spoil a picture.

use crate::common;

mod damaged;
mod ended;
mod places;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

fn copy_folder(from: &Path, to: &Path) {
    fs::create_dir_all(to).unwrap();
    for entry in fs::read_dir(from).unwrap() {
        let entry = entry.unwrap();
        let to = to.join(entry.file_name());
        if entry.file_type().unwrap().is_dir() {
            copy_folder(&entry.path(), &to);
        } else {
            fs::copy(entry.path(), to).unwrap();
        }
    }
}

/// A folder with a volume, in which pictures are rendered with kernels cached in `cached`.
struct Place {
    folder: tempfile::TempDir,
    device: String,
}

impl Place {
    fn new() -> Option<Self> {
        let device = common::device_flag()?;
        let folder = tempfile::tempdir().unwrap();
        let place = Self { folder, device };
        let output = Command::new(env!("CARGO_BIN_EXE_angioray"))
            .args(["phantom", "sphere", "--size", "12", "-o"])
            .arg(place.path("sphere.nrrd"))
            .output()
            .unwrap();
        assert!(output.status.success(), "{output:?}");
        Some(place)
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// The picture's bytes.
    fn render(&self, kernels: Option<&Path>) -> Vec<u8> {
        let picture = self.path("picture.png");
        let mut command = Command::new(env!("CARGO_BIN_EXE_angioray"));
        command
            .args(["render", "--iso", "50%", "--size", "24x24"])
            .args(self.device.split_whitespace())
            .arg(self.path("sphere.nrrd"))
            .arg("-o")
            .arg(&picture)
            .env("ANGIORAY_KERNEL_CACHE", self.path("cache"));
        if let Some(kernels) = kernels {
            command.env("ANGIORAY_KERNELS", kernels);
        }
        self.rendered(&mut command)
    }

    /// Renders a picture of few kernels that are quickly built.
    fn simple_command(&self) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_angioray"));
        command
            .args(
                "render --iso 50% --size 24x24 --lanes 1 --sampling fixed --shading none"
                    .split(' '),
            )
            .args(self.device.split_whitespace())
            .arg(self.path("sphere.nrrd"))
            .arg("-o")
            .arg(self.path("picture.png"))
            .env("ANGIORAY_KERNEL_CACHE", self.path("cache"));
        command
    }

    /// The picture's bytes.
    fn rendered(&self, command: &mut Command) -> Vec<u8> {
        let output = command.output().unwrap();
        assert!(output.status.success(), "{output:?}");
        fs::read(self.path("picture.png")).unwrap()
    }

    fn cached(&self) -> Vec<PathBuf> {
        let entries = fs::read_dir(self.path("cache")).unwrap();
        let mut paths: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).collect();
        paths.sort();
        paths
    }
}

#[test]
fn a_cached_kernel_is_the_one_that_runs() {
    let Some(place) = Place::new() else { return };
    let own = place.render(None);
    let cached = place.cached();
    assert!(cached.len() >= 3, "{cached:?}");
    assert_eq!(place.render(None), own);
    assert_eq!(place.cached(), cached);

    // Kernels that draw something else are cached elsewhere.
    let others = place.path("kernels");
    copy_folder(
        &Path::new(env!("CARGO_MANIFEST_DIR")).join("kernels"),
        &others,
    );
    let file = others.join("pass/tone_curve.cl");
    let source = fs::read_to_string(&file).unwrap();
    let broken = source.replace(
        "v.w = FLOATS(1.0f);",
        "v.w = FLOATS(1.0f); v.x = 1.0f - v.x;",
    );
    assert_ne!(broken, source);
    fs::write(&file, broken).unwrap();
    let other = place.render(Some(&others));
    assert_ne!(other, own);
    let new: Vec<PathBuf> = place.cached();
    let new: Vec<&PathBuf> = new.iter().filter(|path| !cached.contains(path)).collect();
    let [new] = new[..] else {
        panic!("one kernel differs, and {new:?} are new")
    };

    // Put in a cached kernel's place it is taken for that; a program without the kernel is built anew.
    let mut taken = 0;
    for path in &cached {
        let right = fs::read(path).unwrap();
        fs::copy(new, path).unwrap();
        let picture = place.render(None);
        if picture == other {
            taken += 1;
            fs::write(path, &right).unwrap();
        } else {
            assert!(picture == own, "{}", path.display());
        }
        assert_eq!(place.render(None), own);
    }
    assert_eq!(taken, 1);
}

#[test]
fn what_is_no_whole_kernel_is_built_anew() {
    let Some(place) = Place::new() else { return };
    let own = place.render(None);
    let path = &place.cached()[0];
    let right = fs::read(path).unwrap();
    let mut flipped = right.clone();
    *flipped.last_mut().unwrap() ^= 1;
    for wrong in [&right[..right.len() / 2], &right[..7], &[], &flipped] {
        fs::write(path, wrong).unwrap();
        assert_eq!(place.render(None), own);
        assert_ne!(fs::read(path).unwrap(), wrong, "it stays as it was");
    }
}

#[test]
fn a_folder_that_cannot_be_made_is_reported() {
    let Some(place) = Place::new() else { return };
    let file = place.path("file");
    fs::write(&file, "").unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_angioray"))
        .args(["render", "--iso", "50%", "--size", "8x8"])
        .args(place.device.split_whitespace())
        .arg(place.path("sphere.nrrd"))
        .arg("-o")
        .arg(place.path("picture.png"))
        .env("ANGIORAY_KERNEL_CACHE", file.join("below"))
        .output()
        .unwrap();
    let printed = String::from_utf8(output.stderr).unwrap();
    assert!(!output.status.success());
    assert!(
        printed.contains("make the folder") && printed.contains("'off'"),
        "{printed}"
    );
    assert!(!place.path("picture.png").exists());
}
