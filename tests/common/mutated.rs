//! Kernels that are wrong on purpose: a test is tried with them in a process of its own, which reads its kernels from a
//! changed copy.

use std::path::Path;
use std::process::Command;

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
