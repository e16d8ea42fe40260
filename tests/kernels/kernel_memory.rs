//! Every pass under oclgrind, which sees each access outside a buffer and each data race.

use crate::common;

use std::path::{Path, PathBuf};
use std::process::Command;
use std::thread;

use angioray::frame::Kind;
use angioray::lab::bench::aimed::{rays, target};
use angioray::octree::{Leaf, Octree};
use angioray::progress::Silent;
use angioray::render::{IndexRay, RayCaster};

/// Says to a process of this program that oclgrind watches it.
const UNDER: &str = "ANGIORAY_TEST_UNDER_OCLGRIND";

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

/// A folder for one test, with the file that makes the OpenCL loader find only oclgrind.
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
            .arg(self.path(name));
        self.run(command, &log)
    }

    /// Runs the test `name` of this program and gives what oclgrind reported.
    fn test(&self, name: &str) -> String {
        let mut command = Command::new(std::env::current_exe().unwrap());
        command
            .args([name, "--exact", "--nocapture", "--test-threads=1"])
            .env(UNDER, "1")
            .env("ANGIORAY_TEST_DEVICE", "");
        self.run(command, &self.path(&format!("{name}.log")))
    }

    fn run(&self, mut command: Command, log: &Path) -> String {
        command
            .env("OCL_ICD_VENDORS", self.path("vendors"))
            .env_remove("OCL_ICD_FILENAMES")
            .env("OCLGRIND_LOG", log)
            // It names lines of the source.
            .env("ANGIORAY_KERNEL_CACHE", "off")
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
        let messages = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.success(), "{command:?}: {messages}");
        assert!(
            messages.contains("Oclgrind"),
            "{command:?} ran elsewhere: {messages}"
        );
        std::fs::read_to_string(log).unwrap_or_default()
    }

    /// A copy of the kernels with one line changed.
    fn with_broken(mut self, file: &str, line: &str, broken: &str) -> Self {
        let copy = self.path("kernels");
        crate::common::copy_kernels(&copy);
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

/// Fewer rays and more of them, and samples of their own, of the last volume, which has several leaves: they share the casts
/// with the others.
const RAY_COUNTS: [&str; 21] = [
    "--mode iso --iso 40% --screen-error 0.5",
    "--mode mip --screen-error 0.3",
    "--mode dvr --shading none --screen-error 0.3",
    "--mode iso --iso 40% --aa 2:adaptive",
    "--mode mip --aa 2:adaptive --cue chromadepth:1 --cue halo:1,width=2 --cue contour:1",
    "--mode dvr --shading none --aa 3:adaptive",
    "--mode mip --sparse 3 --refill flood",
    "--mode iso --iso 40% --sparse 4:0.1 --cue fog:1 --cue chromadepth:1,rim=2 --cue contour:1",
    "--mode iso --iso 40% --aa 2 --ao rays=2,distance=3",
    "--mode iso --iso 40% --ao bound=0.4,distance=2 --clip-plane 1,0,0,-2",
    "--mode iso --iso 40% --shadows on --light 1,1,1 --light point:40,5,9",
    "--mode dvr --shading phong --quad midpoint --step 3 --shadows cached:4 --light 1,1,1",
    "--mode iso --iso 40% --aa 2 --ssao radius=6,samples=8",
    "--mode iso --iso 40% --sparse 4:0.1 --ssao radius=6,samples=8,thickness=2",
    "--mode dvr --dof focus=auto,aperture=2,darken=1 --dof-method lens:2",
    "--mode iso --iso 40% --aa 2 --dof focus=percentile:10,aperture=9",
    "--mode dvr --dof focus=auto,aperture=9,darken=1 --dof-method gather",
    "--mode iso --iso 40% --dof focus=auto,aperture=9 --dof-method mix",
    "--mode iso --iso 40% --step 0.7 --jitter interleaved:3",
    "--mode mip --step 1.3 --jitter hash:5 --aa 2",
    "--mode dvr --shading none --quad midpoint --jitter hash:5:2",
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
        // A build takes seconds: each mode has every third volume.
        let of_modes = MODES.iter().enumerate().filter(|(m, _)| m % 3 == v % 3);
        let counts = (MODES.len()..).zip(&RAY_COUNTS);
        let of_counts = counts.filter(|_| v + 1 == VOLUMES.len());
        for (m, mode) in of_modes.chain(of_counts) {
            // Filters take turns, but for what needs gradients, and so do all layers and none but the display's.
            let turn = (v / 3 + m / 3) % 2;
            let of_surface = ["--ao", "--ssao", "--iso 40% --shadows"];
            let needs_linear = of_surface.iter().any(|flags| mode.contains(flags));
            let filter = ["linear", "nearest"][if needs_linear { 0 } else { turn }];
            let (layers, extension) = [("--aov all", "exr"), ("", "png")][(v / 3 + m / 6) % 2];
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
    let index = "(AS_INDEX(z) * volume.ny + AS_INDEX(y)) * volume.nx + AS_INDEX(x);";
    let broken = "(AS_INDEX(z) * volume.ny + AS_INDEX(y) + volume.ny) * volume.nx + AS_INDEX(x);";
    let under = under.with_broken("lib/volume/voxels.clh", index, broken);
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
        "SCATTER(pixels.inside, hit_mm, pixels.index, t);",
        "SCATTER(pixels.inside, hit_mm, pixels.index / 2, t);",
    );
    let volume = under.phantom("noise --size 3x5x7");
    let report = under.render(&volume, SMALL, "broken.exr");
    assert!(report.contains("data race"), "{report}");
}

/// In a process of its own: rays aimed at volumes of every type of voxel that they are made of, and
/// rays of NaN.
#[test]
fn aimed_rays_under_oclgrind() {
    if std::env::var_os(UNDER).is_none() {
        return;
    }
    let device = common::device().unwrap();
    eprintln!("on {}", device.info().platform);
    let hostile = [
        0.0,
        -0.0,
        1.0,
        3.0,
        -1e-20,
        1e30,
        f32::MAX,
        f32::INFINITY,
        f32::NAN,
    ];
    let mut caster = RayCaster::new(&device, None);
    let mut hits = 0;
    for n in 0..5 {
        let target = target(7, n).unwrap();
        let octree = Octree::build(&target.volume, Leaf::new(4).unwrap(), &Silent).unwrap();
        let aimed = rays(&target, 7 + u64::from(n), 100);
        let mut given: Vec<_> = aimed
            .iter()
            .map(|ray| IndexRay::forward(ray.origin, ray.dir))
            .collect();
        given.extend((0..81).map(|i| {
            let at = |k: usize| hostile[(i * k + i / 9 + k) % hostile.len()];
            IndexRay {
                origin: [at(1), at(2), at(5)],
                dir: [at(3), at(7), at(11)],
                t: [at(4), at(13)],
            }
        }));
        let found = caster.cast(&target.volume, &octree, target.iso, target.caps, &given);
        hits += found
            .unwrap()
            .iter()
            .filter(|found| found.kind != Kind::Nothing)
            .count();
    }
    assert!(hits > 50, "{hits}");
}

#[test]
fn aimed_rays_stay_within_their_buffers() {
    let Some(under) = Under::oclgrind() else {
        return;
    };
    let report = under.test("kernel_memory::aimed_rays_under_oclgrind");
    assert!(report.is_empty(), "{report}");
    let under = under.with_broken(
        "pass/exact_surface.cl",
        "SCATTER(pixels.inside, hit_mm, pixels.index, t);",
        "SCATTER(pixels.inside, hit_mm, pixels.index + 1, t);",
    );
    let report = under.test("kernel_memory::aimed_rays_under_oclgrind");
    assert!(
        report.contains("Invalid write of size 4 at global memory"),
        "{report}"
    );
}
