//! Wrong changes on purpose. One in a kernel is tried in a process of its own, which reads its
//! kernels from a changed copy.

use std::path::Path;
use std::process::Command;

use angioray::scene::Scene;
use angioray::volume::Volume;

/// A change that a case must catch.
pub enum Mutant {
    /// In a kernel file: each text must be there exactly once, and is replaced by the other.
    Kernel {
        file: &'static str,
        changes: &'static [(&'static str, &'static str)],
    },
    /// In the scene as the device gets it.
    Scene(fn(&mut Scene)),
    /// In the volume as the device gets it.
    Volume(fn(&Volume) -> Volume),
    /// In the volume from which the device's octree is built.
    Octree(fn(&Volume) -> Volume),
}

/// One change in one kernel file.
pub const fn kernel(
    file: &'static str,
    changes: &'static [(&'static str, &'static str)],
) -> Mutant {
    Mutant::Kernel { file, changes }
}

/// Says to a process that its kernels are wrong.
const MUTANT: &str = "ANGIORAY_TEST_MUTANT";
/// What a process prints whose limits are broken.
pub const CAUGHT: &str = "limits are broken";

/// Whether this process tries a mutant.
pub fn is_mutant() -> bool {
    std::env::var_os(MUTANT).is_some()
}

/// Runs the test `name` of this program with a kernel changed, and asserts that it fails because of
/// its limits.
pub fn assert_caught(name: &str, file: &str, changes: &[(&str, &str)]) {
    let folder = tempfile::tempdir().unwrap();
    copy_with(folder.path(), file, changes);
    let output = Command::new(std::env::current_exe().unwrap())
        .args([name, "--exact", "--nocapture", "--test-threads=1"])
        .env(MUTANT, "1")
        .env("ANGIORAY_KERNELS", folder.path())
        .output()
        .unwrap();
    let printed = [output.stdout, output.stderr].concat();
    let printed = String::from_utf8_lossy(&printed);
    assert!(
        printed.contains("running 1 test"),
        "there is no test {name}: {printed}"
    );
    assert!(
        !output.status.success() && printed.contains(CAUGHT),
        "{name} does not catch {changes:?} in {file}: {printed}"
    );
    let first = printed.lines().find(|line| line.contains(CAUGHT));
    println!("caught {changes:?}: {}", first.unwrap_or_default());
}

/// A copy of the kernels with one file changed.
fn copy_with(folder: &Path, file: &str, changes: &[(&str, &str)]) {
    crate::common::copy_kernels(folder);
    let mut text = std::fs::read_to_string(folder.join(file)).unwrap();
    for (right, wrong) in changes {
        assert_eq!(text.matches(right).count(), 1, "{file}: {right}");
        text = text.replace(right, wrong);
    }
    std::fs::write(folder.join(file), text).unwrap();
}

/// Nodes that lie above the iso value taken for ones below it.
pub const NEVER_ABOVE: [(&str, &str); 1] = [(
    "skip.class == CLASS_ABOVE ? FLOATS(1.0f) : FLOATS(-1.0f)",
    "FLOATS(-1.0f)",
)];
