//! Every pass under oclgrind, which sees each access outside a buffer and each data race.

mod common;

use std::path::{Path, PathBuf};
use std::process::Command;
use std::thread;

/// oclgrind's OpenCL driver, found beside the program of its package.
fn driver() -> Option<PathBuf> {
    let programs = std::env::split_paths(&std::env::var_os("PATH")?).collect::<Vec<_>>();
    let prefixes = programs
        .iter()
        .filter(|folder| folder.join("oclgrind").exists());
    prefixes
        .filter_map(|folder| folder.parent())
        .flat_map(|prefix| ["lib/oclgrind", "lib64/oclgrind", "lib"].map(|lib| prefix.join(lib)))
        .map(|folder| folder.join("liboclgrind-rt-icd.so"))
        .find(|driver| driver.exists())
}

/// A folder for one test, with the file that tells the OpenCL loader of oclgrind and nothing else.
struct Under {
    folder: tempfile::TempDir,
    kernels: Option<PathBuf>,
}

impl Under {
    fn oclgrind() -> Option<Self> {
        let Some(driver) = driver() else {
            common::skip("oclgrind is not installed");
            return None;
        };
        let folder = tempfile::tempdir().unwrap();
        std::fs::create_dir(folder.path().join("vendors")).unwrap();
        std::fs::write(
            folder.path().join("vendors/oclgrind.icd"),
            driver.to_str().unwrap(),
        )
        .unwrap();
        Some(Self {
            folder,
            kernels: None,
        })
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn phantom(&self, arguments: &str) -> PathBuf {
        let volume = self.path(&format!("{}.nrrd", arguments.replace(' ', "-")));
        let status = Command::new(env!("CARGO_BIN_EXE_angioray"))
            .arg("phantom")
            .args(arguments.split_whitespace())
            .arg("-o")
            .arg(&volume)
            .output()
            .unwrap();
        assert!(
            status.status.success(),
            "{}",
            String::from_utf8_lossy(&status.stderr)
        );
        volume
    }

    /// Renders to the file `name` and gives what oclgrind reported.
    fn render(&self, volume: &Path, arguments: &str, name: &str) -> String {
        let log = self.path(&format!("{name}.log"));
        let mut command = Command::new(env!("CARGO_BIN_EXE_angioray"));
        command
            .arg("render")
            .arg(volume)
            .args(arguments.split_whitespace())
            .arg("-o")
            .arg(self.path(name))
            .env("OCL_ICD_VENDORS", self.path("vendors"))
            .env_remove("OCL_ICD_FILENAMES")
            .env("OCLGRIND_LOG", &log)
            .env("OCLGRIND_DATA_RACES", "1")
            .env("OCLGRIND_CHECK_API", "1")
            // Optimised code of inlined structs holds an intrinsic that oclgrind 21.10 does not know.
            .env("OCLGRIND_BUILD_OPTIONS", "-cl-opt-disable")
            .env("OCLGRIND_NUM_THREADS", "1")
            .env("OCLGRIND_MAX_ERRORS", "5");
        if let Some(kernels) = &self.kernels {
            command.env("ANGIORAY_KERNELS", kernels);
        }
        let output = command.output().unwrap();
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.success(), "{arguments}: {said}");
        assert!(
            said.contains("Oclgrind"),
            "{arguments} ran elsewhere: {said}"
        );
        std::fs::read_to_string(&log).unwrap_or_default()
    }

    /// A copy of the kernels with one line changed.
    fn with_broken(mut self, file: &str, line: &str, broken: &str) -> Self {
        let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("kernels");
        let copy = self.path("kernels");
        for folder in ["lib", "pass"] {
            std::fs::create_dir_all(copy.join(folder)).unwrap();
            for entry in std::fs::read_dir(source.join(folder)).unwrap() {
                let entry = entry.unwrap();
                std::fs::copy(entry.path(), copy.join(folder).join(entry.file_name())).unwrap();
            }
        }
        let text = std::fs::read_to_string(copy.join(file)).unwrap();
        assert_eq!(text.matches(line).count(), 1, "{line}");
        std::fs::write(copy.join(file), text.replace(line, broken)).unwrap();
        self.kernels = Some(copy);
        self
    }
}

const MODES: [&str; 22] = [
    "--mode iso --iso 40% --shading phong",
    "--mode iso --iso 40% --shading none --refine newton:4 --traverse kd-restart",
    "--mode iso --iso 40% --clip-plane -0.3,1,0.2,-1 --clip-plane 1,0,0,-0.2",
    "--mode iso --iso 40% --sampling fixed --traverse distance",
    "--mode mip",
    "--mode minip --traverse uniform",
    "--mode mean",
    "--mode lmip --lmip-threshold 40%",
    "--mode mip --sampling fixed --traverse revelles",
    "--mode mean --sampling fixed",
    "--mode lmip --lmip-threshold 40% --sampling fixed",
    "--mode dvr --shading blinn-phong",
    "--mode dvr --shading none --skip off",
    "--mode iso --iso 40% --gradient precomputed --gradient-scale 3",
    "--mode iso --iso 40% --gradient fourth-order",
    "--mode dvr --shading phong --gradient precomputed --gradient-scale 8 --gradient-smooth 1",
    "--mode mip --clip-plane -0.3,1,0.2,-1",
    "--mode dvr --quad riemann --traverse uniform",
    "--mode dvr --quad romberg --homogeneity 0.5",
    "--mode dvr --quad rk4 --homogeneity 0.5 --homogeneity-rule range --skip off",
    "--mode dvr --quad preintegrated --shading phong",
    "--mode dvr --quad adaptive:0.01 --shading phong",
];

/// No work-group divides the picture, no leaf the volumes.
const VIEW: &str = "--size 13x11 --octree-leaf 4 --azimuth 30 --elevation 20";

/// One voxel, a plane, a sheet, odd sizes, and one of many leaves.
const VOLUMES: [&str; 6] = [
    "noise --size 1x1x1",
    "noise --size 1x9x7",
    "noise --size 9x7x1 --type f32",
    "noise --size 3x5x7",
    "noise --size 3x5x7 --type f32",
    "sphere --size 19x18x17",
];

#[test]
fn no_pass_reads_or_writes_outside_its_buffers_or_races() {
    let Some(under) = Under::oclgrind() else {
        return;
    };
    let mut jobs = Vec::new();
    for (v, volume) in VOLUMES.iter().enumerate() {
        let path = under.phantom(volume);
        for (m, mode) in MODES.iter().enumerate() {
            // Filters take turns, and so do all layers and none but the display's.
            let filter = ["linear", "nearest"][(v + m) % 2];
            let (layers, extension) = [("--aov all", "exr"), ("", "png")][(v / 2 + m) % 2];
            let arguments = format!("{mode} --filter {filter} {layers} {VIEW}");
            jobs.push((path.clone(), arguments, format!("{v}-{m}.{extension}")));
        }
    }
    let threads = thread::available_parallelism().map_or(1, usize::from);
    thread::scope(|scope| {
        for part in jobs.chunks(jobs.len().div_ceil(threads)) {
            let under = &under;
            scope.spawn(move || {
                for (volume, arguments, name) in part {
                    let report = under.render(volume, arguments, name);
                    assert!(
                        report.is_empty(),
                        "{} {arguments}: {report}",
                        volume.display()
                    );
                }
            });
        }
    });
}

const SMALL: &str = "--mode iso --iso 40% --size 6x5 --aov all --octree-leaf 4";

#[test]
fn a_read_beside_the_volume_is_reported() {
    let Some(under) = Under::oclgrind() else {
        return;
    };
    let index = "((INDEX)z * volume.ny + y) * volume.nx + x]";
    let broken = "((INDEX)z * volume.ny + y + volume.ny) * volume.nx + x]";
    let under = under.with_broken("lib/field.clh", index, broken);
    let volume = under.phantom("noise --size 3x5x7");
    let report = under.render(&volume, SMALL, "broken.exr");
    assert!(
        report.contains("Invalid read of size 1 at global memory"),
        "{report}"
    );
}

#[test]
fn a_write_by_two_work_items_is_reported() {
    let Some(under) = Under::oclgrind() else {
        return;
    };
    let under = under.with_broken(
        "pass/exact_surface.cl",
        "    hit_mm[pixel] =",
        "    hit_mm[pixel / 2u] =",
    );
    let volume = under.phantom("noise --size 3x5x7");
    let report = under.render(&volume, SMALL, "broken.exr");
    assert!(report.contains("data race"), "{report}");
}
