//! Which sampling a scene has: what is wanted, what that implies, and what goes with it.

use angioray::extent::Range;
use angioray::options::{Resolved, SceneOptions};
use angioray::scene::{Emission, Jitter, Picture, QuadratureMethod, SamplingMethod};
use angioray::{Content, Sphere, Subject};
use glam::DVec3;

const SPHERE: Sphere = Sphere {
    center_world: DVec3::ZERO,
    radius_mm: 10.0,
};

const SUBJECT: Subject = Subject {
    sphere: SPHERE,
    content: Content::around(SPHERE),
    spacing_mm: DVec3::ONE,
    range: Range {
        min: 0.0,
        max: 255.0,
    },
    robust_range: Range {
        min: 0.0,
        max: 255.0,
    },
    otsu: 40.0,
    suggested_iso: 120.0,
};

fn options(text: &str) -> SceneOptions {
    SceneOptions::parse(text, "scene.toml").unwrap_or_else(|error| panic!("{text}: {error}"))
}

fn resolved(options: &SceneOptions) -> Resolved {
    let checked = options.clone().checked().unwrap();
    checked.resolve(&SUBJECT).unwrap()
}

fn method(text: &str) -> SamplingMethod {
    resolved(&options(text)).scene.sampling.method
}

fn quadrature(options: &SceneOptions) -> QuadratureMethod {
    match resolved(options).scene.picture {
        Picture::Emission(Emission { quadrature, .. }) => quadrature.method(),
        other => panic!("{other:?}"),
    }
}

#[test]
fn sampling_is_exact_unless_steps_are_wanted() {
    for exact in ["", "mode = 'mip'", "mode = 'lmip'", "sampling = 'exact'"] {
        assert_eq!(method(exact), SamplingMethod::Exact, "{exact}");
    }
    for fixed in [
        "sampling = 'fixed'",
        "step = 0.25",
        "refine = 'newton'",
        "jitter = 'hash:1'",
        "mode = 'mip'\nprobe = 'off'",
    ] {
        assert_eq!(method(fixed), SamplingMethod::Fixed, "{fixed}");
    }
}

#[test]
fn steps_beside_exact_sampling_are_reported_to_have_no_effect() {
    let reported = |text: &str| {
        let notes = resolved(&options(text)).notes;
        notes.iter().any(|note| note.contains("no effect"))
    };
    assert!(reported("sampling = 'exact'\nstep = 0.25"));
    assert!(reported("mode = 'dvr'\nquad = 'adaptive'\nstep = 0.25"));
    assert!(!reported("sampling = 'fixed'\nstep = 0.25"));
    assert!(!reported("sampling = 'exact'"));
}

#[test]
fn in_dvr_exact_sampling_is_the_adaptive_quadrature() {
    let of = |text: &str| quadrature(&options(text));
    assert_eq!(of("mode = 'dvr'"), QuadratureMethod::Simpson);
    let exact = "mode = 'dvr'\nsampling = 'exact'";
    assert_eq!(of(exact), QuadratureMethod::Adaptive);
    let contradictions = [
        ("quad = 'simpson'", "exact"),
        ("quad = 'adaptive'", "fixed"),
    ];
    for (quad, sampling) in contradictions {
        let text = format!("mode = 'dvr'\nsampling = '{sampling}'\n{quad}");
        let message = options(&text).checked().unwrap_err().to_string();
        assert!(
            message.contains("cannot be combined with 'quad'"),
            "{message}"
        );
    }
}

#[test]
fn a_flag_drops_what_of_the_file_it_rules_out() {
    let over = |flag: &str, file: &str| resolved(&options(flag).over(options(file)));
    let method = |flag, file| over(flag, file).scene.sampling.method;
    assert_eq!(
        method("step = 1", "sampling = 'exact'"),
        SamplingMethod::Fixed
    );
    assert_eq!(
        method("sampling = 'exact'", "step = 1"),
        SamplingMethod::Exact
    );
    let notes = over("sampling = 'exact'", "step = 1").notes;
    assert!(!notes.iter().any(|note| note.contains("no effect")));
    let dvr = |flag: &str, file: &str| quadrature(&options(flag).over(options(file)));
    let adaptive = "mode = 'dvr'\nquad = 'adaptive'";
    assert_eq!(
        dvr("sampling = 'fixed'", adaptive),
        QuadratureMethod::Simpson
    );
    assert_eq!(dvr("quad = 'rk4'", adaptive), QuadratureMethod::Rk4);
    let exact = "mode = 'dvr'\nsampling = 'exact'";
    assert_eq!(dvr("quad = 'rk4'", exact), QuadratureMethod::Rk4);
}

#[test]
fn what_is_resolved_reads_back_as_the_same_scene() {
    for text in [
        "",
        "step = 0.25",
        "jitter = 'hash:1'",
        "mode = 'mean'\njitter = 'interleaved:16:3'",
        "mode = 'dvr'\njitter = 'shift:0.1'",
        "mode = 'dvr'",
        "mode = 'dvr'\nquad = 'adaptive:1e-4'",
        "mode = 'mean'\nsampling = 'fixed'",
    ] {
        let first = resolved(&options(text));
        let again = resolved(&options(&first.options.to_toml().unwrap()));
        assert_eq!(again.scene, first.scene, "{text}");
        assert_eq!(again.options, first.options, "{text}");
    }
}

/// A picture carries its scene with every default filled in: in another mode its sampling is not
/// that picture's.
#[test]
fn a_stored_scene_in_another_mode_is_sampled_as_that_mode_is() {
    let stored = |text: &str| resolved(&options(text)).options.to_toml().unwrap();
    let over = |flag: &str, file: &str| resolved(&options(flag).over(options(file)));
    let of_dvr = stored("mode = 'dvr'");
    let iso = over("mode = 'iso'", &of_dvr).scene;
    assert_eq!(iso.sampling.method, SamplingMethod::Exact);
    let dvr = options("mode = 'dvr'").over(options(&stored("mode = 'iso'")));
    assert_eq!(quadrature(&dvr), QuadratureMethod::Simpson);
    // Between two surfaces it stays.
    let of_fixed = stored("mode = 'mip'\nstep = 0.25");
    let iso = over("mode = 'iso'", &of_fixed).scene;
    assert_eq!(iso.sampling.method, SamplingMethod::Fixed);
    // Homogeneous leaves take steps; exact sampling has none.
    let of_adaptive = stored("mode = 'dvr'\nquad = 'adaptive'");
    let leaves = options("homogeneity = 0.1").over(options(&of_adaptive));
    assert_eq!(quadrature(&leaves), QuadratureMethod::Simpson);
    let of_leaves = stored("mode = 'dvr'\nhomogeneity = 0.1");
    let exact = options("sampling = 'exact'").over(options(&of_leaves));
    assert_eq!(quadrature(&exact), QuadratureMethod::Adaptive);
}

#[test]
fn jitter_is_stored_with_its_frame_and_gives_way_to_sampling_without_steps() {
    let stored = |text: &str| resolved(&options(text)).options.to_toml().unwrap();
    for (text, written) in [
        ("jitter = 'hash:7'", "jitter = \"hash:7:0\""),
        (
            "mode = 'dvr'\njitter = 'interleaved:4:9'",
            "jitter = \"interleaved:4:9\"",
        ),
        ("sampling = 'fixed'", "jitter = \"none\""),
    ] {
        assert!(stored(text).contains(written), "{}", stored(text));
    }
    assert!(!stored("sampling = 'exact'").contains("jitter"));
    // A film's frames, from a number on.
    let first = resolved(&options("jitter = 'hash:7:2'"));
    let later = first.frames_later(5);
    let jitter = Jitter::Hash { seed: 7, frame: 7 };
    assert_eq!(later.scene.sampling.jitter, jitter);
    assert_eq!(later.options.sampling.jitter, Some(jitter));
    assert_eq!(first.frames_later(0), first);
    // Flags over what is stored.
    let over = |flag: &str, file: &str| {
        let all = options(flag).over(options(&stored(file)));
        resolved(&all).scene.sampling.jitter
    };
    let dvr = "mode = 'dvr'\njitter = 'hash:7'";
    for (flag, file) in [
        ("sampling = 'exact'", "jitter = 'hash:7'"),
        ("screen-error = 0.1", "jitter = 'hash:7'"),
        ("quad = 'adaptive'", dvr),
        ("sampling = 'exact'", dvr),
        ("mode = 'mip'", dvr),
        ("jitter = 'none'", dvr),
    ] {
        assert_eq!(over(flag, file), Jitter::None, "{flag} {file}");
    }
    let kept = Jitter::Hash { seed: 7, frame: 0 };
    for (flag, file) in [
        ("mode = 'mip'", "jitter = 'hash:7'"),
        ("step = 2", dvr),
        ("jitter = 'hash:7'", ""),
        ("jitter = 'hash:7'", "mode = 'dvr'\nquad = 'adaptive'"),
        ("jitter = 'hash:7'", "screen-error = 0.1"),
    ] {
        assert_eq!(over(flag, file), kept, "{flag} {file}");
    }
}
