//! No circle inside a module: the files and folders in it use each other in one direction.
//!
//! A use of what a module's own file re-exports counts as one of the file that defines it. The
//! module's own file (`mod.rs`) is its face and takes no part: it may use all that is in the module,
//! and its types may be used there.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use crate::sources::{Source, paths_at, sources};

/// Top-level modules that are being rebuilt and are not checked yet.
const EXCEPTED: [&str; 4] = ["gpu", "render", "scene", "options"];

/// A module's path from the crate's root, such as `["lab", "bench"]`.
type Module = Vec<String>;

/// The uses between the children of each module.
type Uses = BTreeMap<Module, BTreeMap<String, BTreeSet<String>>>;

/// The module that a file of `src` is.
fn module_of(path: &Path) -> Module {
    let inside = path.strip_prefix("src").unwrap().with_extension("");
    let mut module: Module = inside
        .iter()
        .map(|name| name.to_str().unwrap().to_owned())
        .collect();
    if matches!(
        module.last().map(String::as_str),
        Some("mod" | "lib" | "main")
    ) {
        module.pop();
    }
    module
}

/// The source without its unit tests and without whole-line comments.
fn code_of(text: &str) -> String {
    let text = text.split("#[cfg(test)]\nmod tests").next().unwrap();
    let lines = text
        .lines()
        .filter(|line| !line.trim_start().starts_with("//"));
    lines.collect::<Vec<_>>().join("\n")
}

/// The paths in `code` that begin with `crate`, `super` or `self`, from the crate's root, as a file
/// of `module` means them.
fn absolute_paths(code: &str, module: &Module) -> Vec<Vec<String>> {
    let mut found = Vec::new();
    for start in ["crate::", "super::", "self::"] {
        for (at, _) in code.match_indices(start) {
            let before = code[..at].chars().next_back();
            if before.is_some_and(|c| c.is_alphanumeric() || "_:$".contains(c)) {
                continue;
            }
            for path in paths_at(&code[at..]) {
                found.extend(absolute(&path, module));
            }
        }
    }
    found
}

/// A path from the crate's root; `None` where it leaves the crate.
fn absolute(path: &[String], module: &Module) -> Option<Vec<String>> {
    let mut from = module.clone();
    let mut rest = path;
    while let Some((first, after)) = rest.split_first() {
        match first.as_str() {
            "crate" => from.clear(),
            "self" => {}
            "super" => {
                from.pop()?;
            }
            _ => break,
        }
        rest = after;
    }
    from.extend_from_slice(rest);
    Some(from)
}

/// What a module's own file re-exports: the name there, and the whole path.
fn reexports(code: &str, module: &Module) -> Vec<(Vec<String>, Vec<String>)> {
    let mut found = Vec::new();
    for (at, _) in code.match_indices("use ") {
        let line = code[..at].rsplit('\n').next().unwrap().trim_start();
        if !line.starts_with("pub") {
            continue;
        }
        for path in paths_at(&code[at + "use ".len()..]) {
            let relative = match path[0].as_str() {
                "crate" | "super" | "self" => path,
                _ => [vec!["self".to_owned()], path].concat(),
            };
            if let Some(whole) = absolute(&relative, module) {
                let name = [module.clone(), vec![whole.last().unwrap().clone()]].concat();
                found.push((name, whole));
            }
        }
    }
    found
}

/// Adds the uses of all files between the children of their modules.
fn uses_of(files: &[(Module, String)]) -> Uses {
    let modules: BTreeSet<&Module> = files.iter().map(|(module, _)| module).collect();
    let exported: BTreeMap<Vec<String>, Vec<String>> = files
        .iter()
        .flat_map(|(module, code)| reexports(code, module))
        .collect();
    let mut uses = Uses::new();
    for (module, code) in files {
        for mut path in absolute_paths(code, module) {
            // To the file that defines it, through whatever re-exports it.
            for _ in 0..8 {
                let known = (1..=path.len()).find_map(|end| {
                    let whole = exported.get(&path[..end])?;
                    (whole[..] != path[..end]).then(|| [&whole[..], &path[end..]].concat())
                });
                match known {
                    Some(whole) => path = whole,
                    None => break,
                }
            }
            while !path.is_empty() && !modules.contains(&path) {
                path.pop();
            }
            let common = module.iter().zip(&path).take_while(|(a, b)| a == b).count();
            if let (Some(own), Some(other)) = (module.get(common), path.get(common)) {
                let of_parent = uses.entry(module[..common].to_vec()).or_default();
                let of_child = of_parent.entry(own.clone()).or_default();
                of_child.insert(other.clone());
            }
        }
    }
    uses
}

/// Whether `to` is used by `from`, directly or not.
fn reaches(graph: &BTreeMap<String, BTreeSet<String>>, from: &str, to: &str) -> bool {
    let (mut seen, mut open) = (BTreeSet::new(), vec![from]);
    while let Some(one) = open.pop() {
        for next in graph.get(one).into_iter().flatten() {
            if next == to {
                return true;
            }
            if seen.insert(next) {
                open.push(next);
            }
        }
    }
    false
}

/// The circles, one line for each of their uses.
fn circles(files: &[(Module, String)]) -> Vec<String> {
    let mut found = Vec::new();
    for (parent, graph) in uses_of(files) {
        for (child, used) in &graph {
            for other in used {
                if reaches(&graph, other, child) {
                    let parent = parent.join("::");
                    found.push(format!(
                        "in {parent}: {child} uses {other} and is used by it"
                    ));
                }
            }
        }
    }
    found
}

fn files_of(sources: Vec<Source>) -> Vec<(Module, String)> {
    let sources = sources.into_iter();
    sources
        .map(|source| (module_of(&source.path), code_of(&source.text)))
        .collect()
}

#[test]
fn the_files_of_a_module_use_each_other_in_one_direction() {
    let files = files_of(sources("src"));
    assert!(files.len() > 100, "only {} files were found", files.len());
    let uses: usize = uses_of(&files).values().map(BTreeMap::len).sum();
    assert!(uses > 100, "only {uses} files that use others were found");
    let found: Vec<String> = circles(&files)
        .into_iter()
        .filter(|circle| {
            let is_in = |module: &&str| circle.starts_with(&format!("in {module}"));
            !EXCEPTED.iter().any(is_in)
        })
        .collect();
    assert!(found.is_empty(), "{}", found.join("\n"));
}

/// Files of a made-up crate.
fn made_up(files: &[(&str, &str)]) -> Vec<(Module, String)> {
    let source = |(path, text): &(&str, &str)| Source {
        path: path.into(),
        text: (*text).to_owned(),
    };
    files_of(files.iter().map(source).collect())
}

#[test]
fn the_check_sees_a_circle() {
    let face = ("src/a/mod.rs", "mod b;\nmod c;\npub use c::{C, D};\n");
    // Directly, by a path in the code, and through what the module's file re-exports.
    for back in [
        "use super::b::B;",
        "fn f() { super::b::g() }",
        "use crate::a::{b::B, other};",
    ] {
        let files = [face, ("src/a/b.rs", "use super::D;"), ("src/a/c.rs", back)];
        let found = circles(&made_up(&files));
        assert_eq!(found.len(), 2, "{back}: {found:?}");
        assert_eq!(found[0], "in a: b uses c and is used by it");
    }
    // Of three, one of them a folder.
    let files = [
        ("src/a/mod.rs", "mod b;"),
        ("src/a/b.rs", "use super::c::deep::X;"),
        ("src/a/c/mod.rs", "mod deep;"),
        ("src/a/c/deep.rs", "use super::super::d;"),
        ("src/a/d.rs", "use crate::a::b;"),
    ];
    assert_eq!(circles(&made_up(&files)).len(), 3);
}

#[test]
fn one_direction_the_modules_own_file_and_unit_tests_make_no_circle() {
    let files = [
        ("src/a/mod.rs", "mod b;\nmod c;\nuse b::B;\npub struct A;"),
        ("src/a/b.rs", "use super::A;\nuse super::c::C;"),
        (
            "src/a/c.rs",
            "use super::A;\n// use super::b::B;\n#[cfg(test)]\nmod tests {\n    use super::super::b::B;\n}",
        ),
    ];
    assert_eq!(circles(&made_up(&files)), [] as [String; 0]);
}
