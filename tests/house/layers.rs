//! No layer reaches up: every `crate::` path in `src` against ARCHITECTURE.md's table.

use std::path::Path;

use crate::sources::{paths_at, sources};

const GROUND: &[&str] = &[
    "abrupt",
    "crash",
    "error",
    "extent",
    "input",
    "cache",
    "memory",
    "number_text",
    "output",
    "progress",
    "stop",
    "subject",
];

/// The instrument, from volume to picture.
const INSTRUMENT: &[&str] = &[
    "volume",
    "scene",
    "options",
    "frame",
    "gpu",
    "octree",
    "reference",
    "render",
];

/// The ground floor of the lab: what measures with the instrument.
const MEASURE: &[&str] = &["lab::measure", "lab::report"];

/// A module and the modules, beside the ground floor's, that it may use: lists of them. The parts of
/// the lab are modules of their own here.
const MAY_USE: &[(&str, &[&[&str]])] = &[
    ("abrupt", &[]),
    ("crash", &[]),
    ("error", &[]),
    ("extent", &[]),
    ("input", &[]),
    ("cache", &[]),
    ("memory", &[]),
    ("number_text", &[]),
    ("output", &[]),
    ("progress", &[]),
    ("stop", &[]),
    ("subject", &[]),
    ("volume", &[]),
    ("scene", &[]),
    ("options", &[&["scene", "octree"]]),
    ("frame", &[]),
    ("gpu", &[]),
    ("octree", &[&["volume"]]),
    ("reference", &[&["volume", "scene", "frame"]]),
    ("batch", &[&["volume", "frame"]]),
    ("render", &[&["volume", "scene", "frame", "gpu", "octree"]]),
    ("lab::report", &[]),
    // Options only in its tests, which read its scenes.
    ("lab::hardcases", &[&["volume", "scene", "options"]]),
    ("lab::measure", &[INSTRUMENT]),
    ("lab::tolerance", &[INSTRUMENT, MEASURE]),
    ("lab::bench", &[INSTRUMENT, MEASURE, &["lab::tolerance"]]),
    ("lab::compare", &[INSTRUMENT, MEASURE, &["lab::tolerance"]]),
    (
        "cli",
        &[
            INSTRUMENT,
            MEASURE,
            &[
                "lab::hardcases",
                "lab::tolerance",
                "lab::bench",
                "lab::compare",
                "batch",
            ],
        ],
    ),
];

/// The top-level modules that a source names by a `crate::` path; macros and re-exports of the
/// crate's root (`crate::Error`, `crate::with_voxels!`) are not modules.
fn modules_named(source: &str) -> Vec<String> {
    let at = source.match_indices("crate::").map(|(at, _)| at);
    let at = at.filter(|&at| !source[..at].ends_with('$'));
    let paths = at.flat_map(|at| paths_at(&source[at..]));
    let named = paths.filter_map(|path| match &path[1..] {
        [lab, part, ..] if lab == "lab" => Some(format!("lab::{part}")),
        [module, ..] => Some(module.clone()),
        [] => None,
    });
    named
        .filter(|name| name == "lab" || MAY_USE.iter().any(|(module, _)| module == name))
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
            let is_allowed = |used: &str| allowed.iter().any(|list| list.contains(&used));
            used != module && !GROUND.contains(&used.as_str()) && !is_allowed(used)
        })
        .map(|used| format!("{module} uses {used}"))
        .collect()
}

/// The module in the table that a file below `src` is part of; none for `lib.rs`, `main.rs` and the
/// lab's list of its parts.
fn module_of(path: &Path) -> Option<String> {
    let stem = |part: &std::ffi::OsStr| {
        let stem = Path::new(part).file_stem().unwrap();
        stem.to_str().unwrap().to_owned()
    };
    let mut parts = path.iter().map(stem);
    let module = parts.next().unwrap();
    match (module.as_str(), parts.next().as_deref()) {
        ("lib" | "main", _) | ("lab", Some("mod")) => None,
        ("lab", Some(part)) => Some(format!("lab::{part}")),
        _ => Some(module),
    }
}

#[test]
fn no_layer_reaches_up() {
    let mut checked = 0;
    for source in sources("src") {
        let Some(module) = module_of(source.path.strip_prefix("src").unwrap()) else {
            continue;
        };
        let found = violations(&module, &source.text);
        assert!(found.is_empty(), "{}: {found:?}", source.path.display());
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
    assert_eq!(
        violations("lab::measure", "use crate::lab::bench::Bench;"),
        ["lab::measure uses lab::bench"]
    );
    assert_eq!(
        violations("cli", "use crate::{lab::{measure::Peer, bench}, lab};"),
        ["cli uses lab"]
    );
    assert_eq!(
        violations("render", "use crate::lab::measure::time;"),
        ["render uses lab::measure"]
    );
    assert!(
        violations(
            "render",
            "use crate::octree::Octree; use crate::error::Result;"
        )
        .is_empty()
    );
}
