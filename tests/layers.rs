//! No layer reaches up: every `crate::` path in `src` against ARCHITECTURE.md's table.

use std::fs;
use std::path::{Path, PathBuf};

const GROUND: &[&str] = &[
    "abrupt",
    "crash",
    "error",
    "extent",
    "input",
    "kept",
    "memory",
    "number_text",
    "output",
    "progress",
    "stop",
    "subject",
];

/// A module and the modules, beside the ground floor's, that it may use.
const MAY_USE: &[(&str, &[&str])] = &[
    ("abrupt", &[]),
    ("crash", &[]),
    ("error", &[]),
    ("extent", &[]),
    ("input", &[]),
    ("kept", &[]),
    ("memory", &[]),
    ("number_text", &[]),
    ("output", &[]),
    ("progress", &[]),
    ("stop", &[]),
    ("subject", &[]),
    ("volume", &[]),
    ("scene", &[]),
    ("options", &["scene"]),
    ("frame", &[]),
    ("gpu", &[]),
    ("octree", &["volume"]),
    ("hardcases", &["volume", "scene", "options"]),
    ("reference", &["volume", "scene", "frame"]),
    ("render", &["volume", "scene", "frame", "gpu", "octree"]),
    ("report", &["frame"]),
    (
        "measure",
        &[
            "volume",
            "scene",
            "options",
            "frame",
            "gpu",
            "octree",
            "hardcases",
            "reference",
            "render",
            "report",
        ],
    ),
    (
        "tolerance",
        &[
            "volume",
            "scene",
            "options",
            "frame",
            "gpu",
            "octree",
            "hardcases",
            "reference",
            "render",
            "report",
            "measure",
        ],
    ),
    (
        "bench",
        &[
            "volume",
            "scene",
            "options",
            "frame",
            "gpu",
            "octree",
            "hardcases",
            "reference",
            "render",
            "report",
            "measure",
            "tolerance",
        ],
    ),
    (
        "compare",
        &[
            "volume",
            "scene",
            "options",
            "frame",
            "gpu",
            "octree",
            "hardcases",
            "reference",
            "render",
            "report",
            "measure",
            "tolerance",
        ],
    ),
    (
        "batch",
        &[
            "volume",
            "scene",
            "frame",
            "gpu",
            "octree",
            "hardcases",
            "reference",
            "render",
            "report",
            "measure",
            "tolerance",
        ],
    ),
    (
        "cli",
        &[
            "volume",
            "scene",
            "options",
            "frame",
            "gpu",
            "octree",
            "reference",
            "render",
            "hardcases",
            "report",
            "measure",
            "tolerance",
            "bench",
            "compare",
            "batch",
        ],
    ),
];

fn rust_files(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            rust_files(&path, found);
        } else if path.extension().is_some_and(|e| e == "rs") {
            found.push(path);
        }
    }
}

/// The top-level modules that a source names by a `crate::` path; macros and re-exports of the
/// crate's root (`crate::Error`, `crate::with_voxels!`) are not modules.
fn modules_named(source: &str) -> Vec<String> {
    let mut named = Vec::new();
    for (at, _) in source.match_indices("crate::") {
        if source[..at].ends_with('$') {
            continue;
        }
        let rest = &source[at + "crate::".len()..];
        if let Some(list) = rest.strip_prefix('{') {
            let list = list.split('}').next().unwrap();
            named.extend(
                list.split(',')
                    .filter_map(|item| item.split("::").next())
                    .map(str::to_owned),
            );
        } else {
            named.push(
                rest.split(|c: char| !(c.is_alphanumeric() || c == '_'))
                    .next()
                    .unwrap()
                    .to_owned(),
            );
        }
    }
    named
        .into_iter()
        .map(|name| name.trim().to_owned())
        .filter(|name| MAY_USE.iter().any(|(module, _)| module == name))
        .collect()
}

/// `module uses other`, for each use that the table does not allow.
fn violations(module: &str, source: &str) -> Vec<String> {
    let (_, allowed) = MAY_USE
        .iter()
        .find(|(name, _)| *name == module)
        .unwrap_or_else(|| panic!("the module {module} has no layer"));
    modules_named(source)
        .into_iter()
        .filter(|used| {
            used != module && !GROUND.contains(&used.as_str()) && !allowed.contains(&used.as_str())
        })
        .map(|used| format!("{module} uses {used}"))
        .collect()
}

#[test]
fn no_layer_reaches_up() {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut files = Vec::new();
    rust_files(&src, &mut files);
    let mut checked = 0;
    for path in files {
        let first = path
            .strip_prefix(&src)
            .unwrap()
            .components()
            .next()
            .unwrap();
        let module = Path::new(first.as_os_str())
            .file_stem()
            .unwrap()
            .to_str()
            .unwrap()
            .to_owned();
        if module == "lib" || module == "main" {
            continue;
        }
        let found = violations(&module, &fs::read_to_string(&path).unwrap());
        assert!(found.is_empty(), "{}: {found:?}", path.display());
        checked += 1;
    }
    assert!(checked > 40, "only {checked} files were found");
}

#[test]
fn the_check_sees_a_layer_that_reaches_up() {
    assert_eq!(
        violations("gpu", "use crate::volume::Volume;"),
        ["gpu uses volume"]
    );
    assert_eq!(
        violations("reference", "fn f(o: &crate::octree::Octree) {}"),
        ["reference uses octree"]
    );
    assert_eq!(
        violations("scene", "use crate::{error::Error, volume::Volume};"),
        ["scene uses volume"]
    );
    assert!(
        violations(
            "render",
            "use crate::octree::Octree; use crate::error::Result;"
        )
        .is_empty()
    );
}
