//! Drivers that fail or never end while they build: the program says so, and can be stopped.

use std::fs;
use std::io::{BufRead, BufReader, Read};
use std::path::Path;
use std::process::{Command, Stdio};

use angioray::extent::ImageSize;
use angioray::gpu::{Args, Buffer, Pass, Timings};
use angioray::octree::Leaf;
use angioray::render::{Lanes, Variant};
use angioray::scene::{Filter, Storage};
use angioray::volume::VoxelType;

use super::{Place, common};

/// Whether the device under test is PoCL's, which links what it builds by `ld`.
fn links() -> bool {
    common::device().is_some_and(|device| device.info().platform.contains("Portable Computing"))
}

/// A folder of programs with `ld` as this script; without one if there is none.
fn programs(place: &Place, ld: Option<&str>) -> std::path::PathBuf {
    let folder = place.path("programs");
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir(&folder).unwrap();
    if let Some(script) = ld {
        use std::os::unix::fs::PermissionsExt;
        let path = folder.join("ld");
        fs::write(&path, format!("#!/bin/sh\n{script}\n")).unwrap();
        fs::set_permissions(path, fs::Permissions::from_mode(0o755)).unwrap();
    }
    folder
}

#[cfg(unix)]
#[test]
fn a_driver_that_ends_while_it_builds_is_reported() {
    let Some(place) = Place::new() else { return };
    if !links() {
        return common::skip("this driver needs no 'ld'");
    }
    let without = |command: &mut Command, path: &Path| command.env("PATH", path).output().unwrap();
    for (ld, words) in [
        (None, "install binutils"),
        (Some("echo out of luck >&2; exit 3"), "out of luck"),
    ] {
        let output = without(&mut place.simple_command(), &programs(&place, ld));
        let printed = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(74), "{printed}");
        assert_eq!(
            printed
                .lines()
                .filter(|line| line.starts_with("error: "))
                .count(),
            1,
            "{printed}"
        );
        for part in ["the driver of '", "kernels/pass/", "SIGABRT", words] {
            assert!(printed.contains(part), "{part}: {printed}");
        }
        assert!(!place.path("picture.png").exists());
        assert_eq!(place.cached().len(), 0);
    }
    // The control: with the linker all goes well. And what is cached needs none: nothing is left for the
    // first launch to build.
    let own = place.rendered(&mut place.simple_command());
    let output = without(&mut place.simple_command(), &programs(&place, None));
    assert!(output.status.success(), "{output:?}");
    assert_eq!(fs::read(place.path("picture.png")).unwrap(), own);
}

#[cfg(unix)]
#[test]
fn building_reports_progress_and_ends_on_request() {
    let Some(place) = Place::new() else { return };
    if !links() {
        return common::skip("this driver needs no 'ld'");
    }
    // A linker that never ends: without being stopped, neither does the test.
    let path = programs(
        &place,
        Some(&format!(
            "echo $$ >> {}; exec sleep 1000",
            place.path("linkers").display()
        )),
    );
    let path = format!("{}:{}", path.display(), std::env::var("PATH").unwrap());
    let mut child = Command::new(env!("CARGO_BIN_EXE_angioray"))
        .args("orbit --frames 2 --iso 50% --size 24x24 --lanes 1".split(' '))
        .args(place.device.split_whitespace())
        .arg(place.path("sphere.nrrd"))
        .arg("-o")
        .arg(place.path("frames/%d.png"))
        .env("ANGIORAY_KERNEL_CACHE", place.path("cache"))
        .env("PATH", path)
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut printed = BufReader::new(child.stderr.take().unwrap());
    let mut line = String::new();
    while !line.contains("building kernels 0 of ") {
        line.clear();
        assert!(
            printed.read_line(&mut line).unwrap() > 0,
            "it ended by itself"
        );
    }
    while !place.path("linkers").exists() {
        assert_eq!(child.try_wait().unwrap(), None, "it ended by itself");
        std::thread::sleep(std::time::Duration::from_millis(10));
    }
    let pid = child.id().to_string();
    let sent = Command::new("kill").args(["-TERM", &pid]).status();
    assert!(sent.unwrap().success());
    let status = child.wait().unwrap();
    let mut rest = String::new();
    printed.read_to_string(&mut rest).unwrap();
    assert_eq!(status.code(), Some(75), "{rest}");
    assert!(
        rest.contains("error: stopped early: 0 of 2 frames"),
        "{rest}"
    );
    assert_eq!(place.cached().len(), 0);
    // Nothing that it started is left: neither builders nor their linkers.
    let linkers = fs::read_to_string(place.path("linkers")).unwrap();
    for pid in linkers.split_whitespace() {
        let command = fs::read_to_string(format!("/proc/{pid}/cmdline"));
        assert!(
            !command.is_ok_and(|command| command.contains("sleep")),
            "{pid}"
        );
    }
}

#[test]
fn all_is_built_before_the_first_launch() {
    let Some(device) = common::device() else {
        return;
    };
    let variant = Variant {
        voxel: VoxelType::U8,
        filter: Filter::Linear,
        leaf: Leaf::default(),
        wide_index: false,
        lanes: Lanes::ONE,
        storage: Storage::Buffer,
    };
    // Constants that no program was ever built with.
    let unique = |place: u32| {
        let now = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH);
        let defines = variant
            .defines()
            .with("NEVER_BEFORE", now.unwrap().as_nanos());
        let defines = defines.with("PLACE", place);
        Pass::new("test", "abi", defines, [1, 1])
    };
    let passes = [unique(0), unique(1)];
    let mut layout = Buffer::<u32>::new(&device, "layout", 4096).unwrap();
    let mut launched = |passes: &[std::sync::Arc<Pass>]| {
        let mut timings = Timings::default();
        for pass in passes {
            let args = Args::new().write("layout", &mut layout);
            let size = ImageSize::new(1, 1).unwrap();
            timings.add(pass.launch(&device, args, size, Some([1, 1])).unwrap());
        }
        timings
    };
    assert_eq!(device.built_kernels(), 0);
    // A pass that is launched twice is built once.
    let timings = launched(&[passes[0].clone(), passes[1].clone(), passes[0].clone()]);
    assert_eq!(device.built_kernels(), 0);
    let times = timings.finish(&device).unwrap();
    assert_eq!(times.passes.len(), 3);
    assert!(times.build_ms > 0.0);
    assert_eq!(device.built_kernels(), 2);
    assert_eq!(launched(&passes).finish(&device).unwrap().build_ms, 0.0);
    assert_eq!(device.built_kernels(), 2);
    // What is announced is built with the first launch, before which nothing is.
    let mut timings = launched(&passes);
    let args = Args::new().write(
        "layout",
        &mut Buffer::<u32>::new(&device, "layout", 4096).unwrap(),
    );
    let announced = unique(3).launch(&device, args, ImageSize::new(1, 1).unwrap(), Some([1, 1]));
    timings.announce(&announced.unwrap());
    assert_eq!(device.built_kernels(), 2);
    timings.start(&device).unwrap();
    assert_eq!(device.built_kernels(), 3);
    assert_eq!(timings.finish(&device).unwrap().passes.len(), 2);
    // The control: what was not requested is built at the end.
    launched(&[unique(2)]).finish(&device).unwrap();
    assert_eq!(device.built_kernels(), 4);
}
