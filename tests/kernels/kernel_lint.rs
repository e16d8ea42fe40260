//! The kernels through clang, without a device, and the order of their files.

use crate::common;

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::thread;

use angioray::gpu::{files, flatten};
use angioray::octree::Leaf;
use angioray::render::{Lanes, Variant};
use angioray::scene::{Filter, SamplingMethod, Storage};
use angioray::volume::VoxelType;

fn kernels() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("kernels")
}

fn read(path: &str) -> String {
    std::fs::read_to_string(kernels().join(path)).unwrap()
}

fn files_in(folder: &str) -> Vec<&'static str> {
    files().filter(|path| path.starts_with(folder)).collect()
}

/// `clang`, or the newest `clang-N` on the path.
fn clang() -> Option<PathBuf> {
    let mut found: Vec<(u32, PathBuf)> = Vec::new();
    for folder in std::env::split_paths(&std::env::var_os("PATH")?) {
        for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
            let name = entry.file_name();
            let Some(rest) = name.to_str().and_then(|name| name.strip_prefix("clang")) else {
                continue;
            };
            let version = match rest.strip_prefix('-') {
                Some(number) => number.parse().ok(),
                None if rest.is_empty() => Some(u32::MAX),
                None => None,
            };
            found.extend(version.map(|version| (version, entry.path())));
        }
    }
    found.into_iter().max().map(|(_, path)| path)
}

/// What a kernel is built with: the variant's options, and the switches of its own.
#[derive(Debug, Clone)]
struct Build {
    variant: String,
    switches: Vec<(String, String)>,
}

impl Build {
    /// Whether every output is wanted.
    fn has_all_outputs(&self) -> bool {
        self.switches.iter().all(|(_, value)| value != "0")
    }
}

/// What clang says of one build of a file.
struct Verdict {
    /// Errors and warnings; `None`: there are none.
    complaint: Option<String>,
    /// Variables and parameters that this build does not use, each with its place. Only what no
    /// build of a file uses is wrong: an output that is left out leaves its variables behind.
    unused: BTreeSet<String>,
}

/// Whether clang takes a build of a file, and what it says.
fn compile(clang: &Path, file: &Path, build: &Build, options: &[String]) -> (bool, String) {
    let mut command = Command::new(clang);
    command
        .args(["-x", "cl", "-Xclang", "-finclude-default-header", "-I"])
        .arg(kernels())
        .args(options)
        .args(build.variant.split_whitespace());
    for (name, value) in &build.switches {
        command.arg(format!("-D{name}={value}"));
    }
    let output = command.arg(file).output().unwrap();
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    (output.status.success(), text)
}

fn lint(clang: &Path, file: &Path, build: &Build) -> Verdict {
    let mut options: Vec<String> = ["-fsyntax-only", "-Wall", "-Wextra", "-Wundef", "-Werror"]
        .map(str::to_owned)
        .to_vec();
    options.extend(UNUSED.map(|warning| format!("-Wno-error={warning}")));
    let (taken, text) = compile(clang, file, build, &options);
    let unused = text
        .lines()
        .filter(|line| {
            UNUSED
                .iter()
                .any(|warning| line.ends_with(&format!("[-W{warning}]")))
        })
        .map(str::to_owned)
        .collect();
    Verdict {
        complaint: (!taken).then_some(text),
        unused,
    }
}

const UNUSED: [&str; 3] = [
    "unused-variable",
    "unused-but-set-variable",
    "unused-parameter",
];

/// What clang says of a file, over all its builds.
struct OfFile {
    complaints: Vec<String>,
    /// What none of its builds uses.
    never_used: BTreeSet<String>,
}

fn lint_all(clang: &Path, file: &Path, builds: &[Build]) -> OfFile {
    let mut complaints = Vec::new();
    let mut never_used: Option<BTreeSet<String>> = None;
    for build in builds {
        let Verdict { complaint, unused } = lint(clang, file, build);
        complaints.extend(complaint.map(|text| format!("{build:?}:\n{text}")));
        never_used = Some(match never_used {
            None => unused,
            Some(before) => before.intersection(&unused).cloned().collect(),
        });
    }
    OfFile {
        complaints,
        never_used: never_used.unwrap_or_default(),
    }
}

/// What is wrong, of files with their whole texts: complaints, and what no file uses that includes it.
fn wrong(files: &[(String, OfFile)]) -> Vec<String> {
    let is_used = |warning: &str| {
        let library = warning.find("/lib/").zip(warning.find(".clh:"));
        let Some(path) = library.and_then(|(from, to)| warning.get(from + 1..to + 4)) else {
            return false;
        };
        let includes = format!("\"kernels/{path}\"");
        let uses = |(text, of_file): &(String, OfFile)| {
            text.contains(&includes) && !of_file.never_used.contains(warning)
        };
        files.iter().any(uses)
    };
    let complaints = files.iter().flat_map(|(_, of_file)| &of_file.complaints);
    let never_used: BTreeSet<&String> = files
        .iter()
        .flat_map(|(_, of_file)| &of_file.never_used)
        .collect();
    let never_used = never_used.into_iter().filter(|warning| !is_used(warning));
    complaints.chain(never_used).cloned().collect()
}

/// Names and values of the constants among a compiler's options.
fn constants(options: &str) -> Vec<(&str, &str)> {
    let words: Vec<&str> = options.split_whitespace().collect();
    words
        .windows(2)
        .filter(|pair| pair[0] == "-D")
        .filter_map(|pair| pair[1].split_once('='))
        .collect()
}

/// The macros that a kernel and what it includes test by `#if` and do not get from the variant:
/// its switches, each with the values it may have. `X` may be any of the constants `X_…`, where
/// there are some, else 0 or 1.
fn switches(kernel: &str, variant: &str) -> Vec<(String, Vec<String>)> {
    let given = constants(variant);
    let mut names = BTreeSet::new();
    let own: BTreeSet<&str> = kernel
        .lines()
        .filter_map(|line| line.strip_prefix("#define ")?.split([' ', '(']).next())
        .collect();
    for line in kernel
        .lines()
        .filter(|line| line.starts_with("#if ") || line.starts_with("#elif "))
    {
        let words = line.split(|c: char| !(c.is_ascii_alphanumeric() || c == '_'));
        let of_switch = |word: &&str| {
            word.starts_with(|c: char| c.is_ascii_uppercase())
                && !given.iter().any(|(name, _)| name == word)
                && !own.contains(word)
        };
        names.extend(words.filter(of_switch).map(str::to_owned));
    }
    // A kernel whose work-items are no tiles takes one number of lanes alone.
    let only = kernel
        .lines()
        .find_map(|line| line.strip_prefix("#if LANES != "));
    let values = |name: &str| {
        let prefix = format!("{name}_");
        let named: Vec<String> = given
            .iter()
            .filter(|(constant, _)| constant.starts_with(&prefix))
            .map(|(_, value)| (*value).to_owned())
            .collect();
        if name == "LANES"
            && let Some(only) = only
        {
            vec![only.to_owned()]
        } else if name == "LANES" {
            Lanes::ALL.map(|lanes| lanes.to_string()).to_vec()
        } else if named.is_empty() {
            vec!["0".to_owned(), "1".to_owned()]
        } else {
            named
        }
    };
    names
        .into_iter()
        .map(|name| (name.clone(), values(&name)))
        .collect()
}

/// Each value of each switch, once with all others at their first value and once at their last: so
/// that every branch is built, whether it stands in another's or beside it.
fn combinations(switches: &[(String, Vec<String>)]) -> Vec<Vec<(String, String)>> {
    let all = |value: fn(&[String]) -> Option<&String>| -> Vec<(String, String)> {
        let pair = |(name, values): &(String, Vec<String>)| {
            let value = value(values).expect("a switch has values");
            (name.clone(), value.clone())
        };
        switches.iter().map(pair).collect()
    };
    let mut found = BTreeSet::new();
    for base in [all(<[String]>::first), all(<[String]>::last)] {
        found.insert(base.clone());
        for (n, (_, values)) in switches.iter().enumerate() {
            for value in values {
                let mut chosen = base.clone();
                chosen[n].1 = value.clone();
                found.insert(chosen);
            }
        }
    }
    found.into_iter().collect()
}

fn variant(
    voxel: VoxelType,
    filter: Filter,
    storage: Storage,
    leaf: u32,
    wide_index: bool,
) -> String {
    let leaf = Leaf::new(leaf).unwrap();
    Variant {
        voxel,
        filter,
        leaf,
        wide_index,
        lanes: Lanes::ONE,
        storage,
    }
    .defines()
    .options()
}

/// The [`combinations`] of switches with both filters; of what reads voxels with all outputs, also every voxel type, a leaf
/// that is no power of two, indices of 64 bits, and images.
fn builds(path: &str) -> Vec<Build> {
    let text = flatten(path).unwrap();
    let reads_voxels = read(path).contains("VOXELS");
    let mut builds = Vec::new();
    let buffer = Storage::Buffer;
    for (voxel, storage, leaf, wide_index) in [
        (VoxelType::U8, buffer, 8, false),
        (VoxelType::U16, buffer, 8, false),
        (VoxelType::I16, buffer, 8, false),
        (VoxelType::F32, buffer, 8, false),
        (VoxelType::U8, buffer, 5, false),
        (VoxelType::U8, buffer, 8, true),
        (VoxelType::I16, Storage::Image, 8, false),
        (VoxelType::F32, Storage::Image, 8, true),
        (VoxelType::U8, Storage::Filtered, 8, false),
    ] {
        let plain = voxel == VoxelType::U8 && storage == buffer && leaf == 8 && !wide_index;
        for filter in [Filter::Linear, Filter::Nearest] {
            if storage.check(SamplingMethod::Fixed, filter).is_err() {
                continue;
            }
            let variant = variant(voxel, filter, storage, leaf, wide_index);
            for switches in combinations(&switches(&text, &variant)) {
                let build = Build {
                    variant: variant.clone(),
                    switches,
                };
                if plain || (reads_voxels && build.has_all_outputs()) {
                    builds.push(build);
                }
            }
        }
    }
    builds
}

#[test]
fn every_variant_of_every_kernel_is_without_a_warning() {
    let Some(clang) = clang() else {
        common::skip("there is no clang on the path");
        return;
    };
    let paths: Vec<&str> = ["pass/", "test/"].into_iter().flat_map(files_in).collect();
    let files: Vec<(String, OfFile)> = thread::scope(|scope| {
        let workers: Vec<_> = paths
            .iter()
            .map(|path| {
                let clang = &clang;
                scope.spawn(move || lint_all(clang, &kernels().join(path), &builds(path)))
            })
            .collect();
        let found = workers.into_iter().map(|worker| worker.join().unwrap());
        let texts = paths.iter().map(|path| flatten(path).unwrap());
        texts.zip(found).collect()
    });
    let found = wrong(&files);
    assert!(
        found.is_empty(),
        "{} times: {}",
        found.len(),
        found[..found.len().min(3)].join("\n")
    );
}

/// What clang says where a file does not become code for NVIDIA's GPUs, a ray a work-item.
fn no_gpu_code(clang: &Path, file: &Path, build: &Build) -> Option<String> {
    let options = [
        "-target",
        "nvptx64-nvidia-nvcl",
        "-O1",
        "-S",
        "-o",
        "/dev/null",
    ];
    let (taken, text) = compile(clang, file, build, &options.map(str::to_owned));
    (!taken).then_some(text)
}

/// Whether clang can make code for NVIDIA's GPUs; says so where it cannot.
fn knows_gpus(clang: &Path) -> bool {
    let output = Command::new(clang).arg("-print-targets").output().unwrap();
    let knows = String::from_utf8_lossy(&output.stdout).contains("nvptx64");
    if !knows {
        common::skip("clang was built without NVPTX");
    }
    knows
}

/// From buffers and, where a device filters, from images, all outputs wanted.
#[test]
fn every_pass_becomes_code_for_gpus() {
    let Some(clang) = clang().filter(|clang| knows_gpus(clang)) else {
        return;
    };
    let of_last = |path: &str, storage| {
        let variant = variant(VoxelType::U8, Filter::Linear, storage, 8, false);
        let switches = switches(&flatten(path).unwrap(), &variant);
        let last = |(name, values): (String, Vec<String>)| {
            let value = match name.as_str() {
                "LANES" => values[0].clone(),
                _ => values.last().unwrap().clone(),
            };
            (name, value)
        };
        let switches = switches.into_iter().map(last).collect();
        Build { variant, switches }
    };
    thread::scope(|scope| {
        for path in files_in("pass/") {
            let (clang, of_last) = (&clang, &of_last);
            scope.spawn(move || {
                for storage in [Storage::Buffer, Storage::Filtered] {
                    let build = of_last(path, storage);
                    let wrong = no_gpu_code(clang, &kernels().join(path), &build);
                    assert!(wrong.is_none(), "{path}, {storage}: {}", wrong.unwrap());
                }
            });
        }
    });
}

/// The control: what only processors of one kind can do.
#[test]
fn what_gpus_cannot_do_does_not_become_code_for_them() {
    let Some(clang) = clang().filter(|clang| knows_gpus(clang)) else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("wrong.cl");
    let build = Build {
        variant: String::new(),
        switches: Vec::new(),
    };
    let refused = |body: &str| {
        let text = format!("kernel void wrong(global float *v)\n{{\n{body}\n}}\n");
        std::fs::write(&file, text).unwrap();
        no_gpu_code(&clang, &file, &build)
    };
    assert_eq!(refused("    v[0] = 1.0f;"), None);
    let text = refused("    v[0] = 1.0f; __builtin_ia32_pause();").unwrap();
    assert!(text.contains("__builtin_ia32_pause"), "{text}");
}

#[test]
fn the_switches_are_read_from_the_kernels() {
    let variant = variant(VoxelType::U8, Filter::Linear, Storage::Buffer, 8, false);
    let of = |path| {
        let named = switches(&flatten(path).unwrap(), &variant).into_iter();
        let counted = named.map(|(name, values)| format!("{name}:{}", values.len()));
        counted.collect::<Vec<_>>().join(" ")
    };
    // Work-items that are no tiles of rays have one number of lanes.
    for (path, expected) in [
        (
            "pass/cast_surface.cl",
            "COUNTERS:2 JITTERED:2 LANES:3 LAYERS:2 NEAREST_MARCH:2 RAYS:4",
        ),
        (
            "pass/cast_maximum.cl",
            "COUNTERS:2 JITTERED:2 LANES:3 LAYERS:2 PROJECTION:3 RAYS:4",
        ),
        (
            "pass/cast_emission.cl",
            "COUNTERS:2 GRADIENT:4 HOMOGENEOUS:2 JITTERED:2 LANES:3 LAYERS:2 NORMALS:2 QUADRATURE:6 RAYS:4 SHADED:2 SHADOWS:4 VISIBILITY:2",
        ),
        ("pass/surface_normal.cl", "GRADIENT:4 LANES:3 RAYS:4"),
        (
            "pass/shade_surface.cl",
            "LANES:3 OCCLUSION:2 RAYS:4 SHADED:2 VISIBILITY:2",
        ),
        (
            "pass/thickness.cl",
            "CERTIFICATE:3 LANES:3 LAYERS:2 MARCHED:2 RAYS:4 SPANS:2",
        ),
        ("pass/tone_curve.cl", "LANES:3"),
        ("pass/mark_uncertain.cl", "LANES:1 SEEN:3 SURFACES:2"),
    ] {
        assert_eq!(of(path), expected, "{path}");
    }
}

#[test]
fn every_value_is_built_with_others_off_and_on() {
    let switch = |name: &str, values: &[&str]| {
        let values = values.iter().map(|&value| value.to_owned()).collect();
        (name.to_owned(), values)
    };
    let switches = [switch("A", &["0", "1"]), switch("B", &["2", "3", "4"])];
    let built: Vec<String> = combinations(&switches)
        .iter()
        .map(|chosen| format!("{}{}", chosen[0].1, chosen[1].1))
        .collect();
    assert_eq!(built, ["02", "03", "04", "12", "13", "14"]);
    let three = [&switches[..], &[switch("C", &["0", "1"])]].concat();
    assert_eq!(combinations(&three).len(), 10);
    assert_eq!(combinations(&[]).len(), 1);
}

#[test]
fn clang_refuses_what_is_wrong() {
    let Some(clang) = clang() else {
        common::skip("there is no clang on the path");
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("wrong.cl");
    let variant = variant(VoxelType::U8, Filter::Linear, Storage::Buffer, 8, false);
    let build = |variant: &str| Build {
        variant: variant.to_owned(),
        switches: Vec::new(),
    };
    let found = |body: &str, variant: &str| {
        let text = format!(
            "#include \"lib/abi.clh\"\nkernel void wrong(global float *v)\n{{\n{body}\n}}\n"
        );
        std::fs::write(&file, &text).unwrap();
        wrong(&[(text, lint_all(&clang, &file, &[build(variant)]))])
    };
    let refused = |body: &str, variant: &str, by: &str| {
        let found = found(body, variant);
        assert!(
            found.iter().any(|text| text.contains(by)),
            "{by}: {found:?}"
        );
    };
    assert!(found("    v[0] = LEAF;", &variant).is_empty());
    refused(
        "    v[0] = 1.0f;",
        &variant.replace(" -D LEAF=8u", ""),
        "LEAF, the edge of a finest node",
    );
    refused(
        "    uint unused = 1u;\n    v[0] = 1.0f;",
        &variant,
        "unused",
    );
    refused("    v[0] = \"text\";", &variant, "incompatible");
    refused("#if SWITCH\n    v[0] = 1.0f;\n#endif", &variant, "SWITCH");
    refused(
        "    v[0] = lerp_of_nothing(v[1]);",
        &variant,
        "lerp_of_nothing",
    );
}

#[test]
fn what_any_file_uses_of_the_library_is_used() {
    let warning =
        "/somewhere/kernels/lib/ray/a.clh:3:5: warning: unused parameter 'x' [-Wunused-parameter]";
    let including = |is_unused: bool| {
        let never_used = is_unused.then(|| warning.to_owned()).into_iter().collect();
        let of_file = OfFile {
            complaints: Vec::new(),
            never_used,
        };
        ("#line 1 \"kernels/lib/ray/a.clh\"\n".to_owned(), of_file)
    };
    assert!(wrong(&[including(true), including(false)]).is_empty());
    assert_eq!(wrong(&[including(true), including(true)]), [warning]);
    // A file that does not include it does not use it.
    let mut other = including(false);
    other.0.clear();
    assert_eq!(wrong(&[including(true), other]), [warning]);
}

/// What is wrong with the order of one kernel file, as text.
fn disorder(path: &str, text: &str) -> Option<String> {
    let kernel_names: Vec<&str> = text
        .lines()
        .filter_map(|line| line.split_once("kernel void "))
        .map(|(_, rest)| rest.split('(').next().unwrap_or(rest))
        .collect();
    let own = Path::new(path).file_stem().and_then(|stem| stem.to_str());
    let includes_outside_lib = text
        .lines()
        .filter(|line| line.starts_with("#include"))
        .any(|line| !line.starts_with("#include \"lib/"));
    let problem = if !text.starts_with("// ") {
        "does not begin with a comment that says what it is"
    } else if includes_outside_lib {
        "includes something that is not in lib"
    } else if path.starts_with("lib/") {
        if !kernel_names.is_empty() {
            "is in lib and has a kernel"
        } else if !text.lines().any(|line| line == "#pragma once") {
            "does not say #pragma once"
        } else {
            return None;
        }
    } else if kernel_names.len() != 1 || Some(kernel_names[0]) != own {
        "does not have one kernel of its own name and no other"
    } else {
        return None;
    };
    Some(format!("{path} {problem}"))
}

#[test]
fn every_kernel_file_keeps_the_order() {
    let found: Vec<String> = files()
        .filter_map(|path| disorder(path, &read(path)))
        .collect();
    assert!(found.is_empty(), "{found:?}");
}

#[test]
fn disorder_is_seen() {
    let good = "// One.\n#include \"lib/ray/interval.clh\"\nkernel void one(uint n)\n{\n}\n";
    assert_eq!(disorder("pass/one.cl", good), None);
    assert!(disorder("pass/two.cl", good).is_some());
    assert!(disorder("lib/one.clh", good).is_some());
    assert!(disorder("pass/one.cl", &good[8..]).is_some());
    assert!(disorder("pass/one.cl", &format!("{good}kernel void more()\n")).is_some());
    assert!(
        disorder(
            "pass/one.cl",
            &good.replace("lib/ray/interval.clh", "pass/ray.cl")
        )
        .is_some()
    );
    let lib = "// Lib.\n#pragma once\n#include \"lib/abi.clh\"\n";
    assert_eq!(disorder("lib/one.clh", lib), None);
    assert!(disorder("lib/one.clh", &lib.replace("#pragma once\n", "")).is_some());
}
