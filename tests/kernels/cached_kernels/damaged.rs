//! Damaged files never decide what is drawn, and never have to be removed by a person.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Output;

use super::Place;

/// Damages a file's bytes.
type Damage = fn(&mut Vec<u8>);

const DAMAGES: [(&str, Damage); 4] = [
    ("cut in half", |bytes| bytes.truncate(bytes.len() / 2)),
    ("empty", Vec::clear),
    ("zero", |bytes| bytes.fill(0)),
    ("flipped behind its head", |bytes| {
        let head = bytes.len().min(64);
        bytes[head..].iter_mut().for_each(|byte| *byte ^= 0x5a);
    }),
];

fn damage(files: &[PathBuf], how: Damage) {
    for path in files {
        let mut bytes = fs::read(path).unwrap();
        how(&mut bytes);
        fs::write(path, bytes).unwrap();
    }
}

fn stderr_of(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

#[test]
fn the_driver_leaves_nothing_that_could_be_damaged_and_uses_nothing_that_is() {
    let Some(place) = Place::new() else { return };
    let (temporary, drivers) = (place.path("temporary"), place.path("drivers"));
    fs::create_dir(&temporary).unwrap();
    fs::create_dir(&drivers).unwrap();
    fs::write(drivers.join("file"), "damaged").unwrap();
    let names = |folder: &Path| {
        let entries = fs::read_dir(folder).unwrap();
        let names = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap());
        names.collect::<Vec<String>>()
    };
    // What a process left that has ended.
    let left = temporary.join("angioray-driver-0");
    fs::create_dir(&left).unwrap();
    fs::write(left.join("held"), "").unwrap();
    let own = place.rendered(&mut place.simple_command());
    for kernels in ["cache", "elsewhere", "off"] {
        let mut command = place.simple_command();
        let kernels = if kernels == "off" {
            kernels.into()
        } else {
            place.path(kernels)
        };
        command
            .env("POCL_CACHE_DIR", &drivers)
            .env("TMPDIR", &temporary)
            .env("ANGIORAY_KERNEL_CACHE", &kernels);
        assert_eq!(place.rendered(&mut command), own, "{}", kernels.display());
        assert_eq!(names(&temporary), [""; 0], "{}", kernels.display());
        assert_eq!(names(&drivers), ["file"], "{}", kernels.display());
    }
}

#[test]
fn cached_kernels_may_be_damaged() {
    let Some(place) = Place::new() else { return };
    let render = || place.rendered(&mut place.simple_command());
    let own = render();
    let cached = place.cached();
    for (name, how) in DAMAGES {
        damage(&cached, how);
        assert_eq!(render(), own, "{name}");
        assert_eq!(place.cached(), cached, "{name}");
    }
    // The control: whole they are taken as they are.
    let whole: Vec<Vec<u8>> = cached.iter().map(|path| fs::read(path).unwrap()).collect();
    assert_eq!(render(), own);
    let after: Vec<Vec<u8>> = cached.iter().map(|path| fs::read(path).unwrap()).collect();
    assert!(whole == after);
}

/// A cached kernel that is complete, but whose code does not run: as where another processor has this one's name.
fn with_other_code(cached: &[u8]) -> Option<Vec<u8>> {
    let binary = &cached[blake3::OUT_LEN..];
    let library = binary.windows(4).position(|bytes| bytes == b"\x7fELF")?;
    let mut binary = binary.to_vec();
    // Of its program: what it is loaded by stays.
    let end = (library + 0x2000).min(binary.len());
    binary[(library + 0x1000).min(end)..end].fill(0x06);
    let digest = blake3::hash(&binary);
    Some([digest.as_bytes(), &binary[..]].concat())
}

#[cfg(target_arch = "x86_64")]
#[test]
fn a_cached_kernel_that_ends_the_process_is_reported_and_removed() {
    let Some(place) = Place::new() else { return };
    let own = place.rendered(&mut place.simple_command());
    fs::remove_file(place.path("picture.png")).unwrap();
    for path in place.cached() {
        let Some(other) = with_other_code(&fs::read(&path).unwrap()) else {
            return crate::common::skip("this driver's binaries hold no machine code");
        };
        fs::write(&path, other).unwrap();
    }
    let output = place.simple_command().output().unwrap();
    let printed = stderr_of(&output);
    assert_eq!(output.status.code(), Some(74), "{output:?}");
    assert_eq!(printed.matches("error: ").count(), 1, "{printed}");
    for part in ["SIG", "the device", "the same command builds them again"] {
        assert!(printed.contains(part), "{printed}");
    }
    assert!(place.cached().is_empty());
    assert!(!place.path("picture.png").exists());
    assert_eq!(place.rendered(&mut place.simple_command()), own);
}

#[cfg(unix)]
#[test]
fn what_is_no_file_in_a_kernels_place_is_not_waited_for() {
    use std::os::unix::net::UnixListener;
    let Some(place) = Place::new() else { return };
    let render = || place.rendered(&mut place.simple_command());
    let own = render();
    let cached = place.cached();
    let [pipe, socket, device, ..] = &cached[..] else {
        panic!("{cached:?}")
    };
    cached
        .iter()
        .for_each(|path| fs::remove_file(path).unwrap());
    let mode = rustix::fs::Mode::RWXU;
    rustix::fs::mkfifoat(rustix::fs::CWD, pipe, mode).unwrap();
    let _listening = UnixListener::bind(socket).unwrap();
    std::os::unix::fs::symlink("/dev/zero", device).unwrap();
    assert_eq!(render(), own);
    for path in [pipe, socket, device] {
        assert!(
            path.symlink_metadata().unwrap().is_file(),
            "{}",
            path.display()
        );
    }
    // A folder stays, and nothing is cached there.
    fs::remove_file(pipe).unwrap();
    fs::create_dir(pipe).unwrap();
    assert_eq!(render(), own);
    assert!(pipe.is_dir());
}
