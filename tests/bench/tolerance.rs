//! `--max-error`: the chosen setting keeps its bound, by the whole picture of the reference. What
//! needs a device says so and passes without one, unless REQUIRE_OPENCL=1.

use crate::cli_place;
use crate::common;

use angioray::extent::Dims;
use angioray::frame::error::{color_error, depth_error, value_error};
use angioray::frame::{Frame, Layer, Wanted, read_metadata};
use angioray::lab::tolerance::{Choice, Task, candidates, choose};
use angioray::octree::Octree;
use angioray::options::{ErrorBound, ErrorMetric, SceneOptions};
use angioray::progress::Silent;
use angioray::reference;
use angioray::render::{Options, Renderer};
use angioray::scene::Mode;
use angioray::volume::{PhantomKind, PhantomSpec, Volume, phantom};
use angioray::{Content, Sphere, Subject};
use cli_place::{Place, stderr};

const WANTED: Wanted = Wanted::DISPLAY.with([Layer::Depth, Layer::Value]);

fn vessels() -> Volume {
    let spec = PhantomSpec::new(PhantomKind::Vessels, Dims::new([40; 3]).unwrap());
    phantom(&spec).unwrap().volume
}

fn subject(volume: &Volume) -> Subject {
    let sphere = Sphere::from(volume.bounding_sphere());
    let range = volume.range();
    Subject {
        sphere,
        content: Content::around(sphere),
        spacing_mm: volume.geometry().spacing_mm(),
        range,
        robust_range: range,
        otsu: range.at(0.5),
        suggested_iso: range.at(0.5),
    }
}

fn options(text: &str) -> SceneOptions {
    let text = format!("azimuth = 30\nelevation = 20\nzoom = 1.3\n{text}");
    let options = SceneOptions::parse(&text, "scene").unwrap();
    options.checked().unwrap()
}

/// The error in the metric's own definition, of whole pictures.
fn figure(metric: ErrorMetric, reference: &Frame, frame: &Frame, volume: &Volume) -> f64 {
    let color = || color_error(reference, frame).unwrap();
    let depth = || depth_error(reference, frame, volume.geometry().smallest_spacing_mm()).unwrap();
    match metric {
        ErrorMetric::Rmse => color().rmse,
        ErrorMetric::Max => color().max,
        ErrorMetric::P99 => color().p99,
        ErrorMetric::Psnr => color().psnr_db,
        ErrorMetric::Depth if depth().missed + depth().extra > 0 => f64::INFINITY,
        ErrorMetric::Depth => depth().max.unwrap_or(0.0),
        ErrorMetric::Missed => {
            depth().missed_share().unwrap_or(0.0) + depth().extra_share().unwrap_or(0.0)
        }
        ErrorMetric::Value => {
            let range = volume.range().width();
            value_error(reference, frame, range)
                .unwrap()
                .max
                .unwrap_or(0.0)
        }
    }
}

fn task<'a>(
    volume: &'a Volume,
    subject: &'a Subject,
    options: &'a SceneOptions,
    bound: &str,
) -> Task<'a> {
    Task {
        volume,
        subject,
        options,
        bound: bound.parse().unwrap(),
        wanted: Wanted::DISPLAY,
        seed: 5,
        elsewhere: &[],
    }
}

/// Of small pictures a large share is cast by the reference, of the larger ones less than a third.
const SCENES: [(&str, &str); 5] = [
    ("mode = 'iso'\niso = '50%'\nsize = [200, 150]", "rmse:0.01"),
    ("mode = 'iso'\niso = '50%'\nsize = 96", "depth:0.05vox"),
    ("mode = 'mip'\nsize = [96, 80]", "value:2%"),
    ("mode = 'mean'\nsize = [200, 150]", "p99:1/255"),
    ("mode = 'dvr'\nsize = 96", "max:0.02"),
];

#[test]
fn the_chosen_setting_keeps_the_bound_and_coarse_ones_do_not() {
    let Some(device) = common::device() else {
        return;
    };
    let volume = vessels();
    let subject = subject(&volume);
    let octree: Octree = common::octree(&volume);
    let mut renderer = Renderer::new(&device, &volume, &octree, Options::default()).unwrap();
    for (text, bound) in SCENES {
        let options = options(text);
        let task = task(&volume, &subject, &options, bound);
        let choice = choose(&task, &mut renderer, &Silent).unwrap();
        let bound: ErrorBound = task.bound;
        assert!(choice.met, "{bound}");
        assert!(bound.is_met_by(choice.upper), "{bound}: {}", choice.upper);
        let scene = &choice.resolved.scene;
        let reference = reference::render(&volume, scene, WANTED, &Silent).unwrap();
        let error = |renderer: &mut Renderer, choice: &SceneOptions| {
            let scene = choice.resolve(&subject).unwrap().scene;
            let frame = renderer.render(&scene, WANTED).unwrap().frame;
            figure(bound.metric(), &reference, &frame, &volume)
        };
        let of_chosen = error(&mut renderer, &choice.resolved.options);
        assert!(bound.is_met_by(of_chosen), "{bound}: {of_chosen}");
        // The control: the grid's coarsest setting is found beyond the bound, and is.
        let coarsest = &choice.tried[0];
        assert!(!bound.is_met_by(coarsest.error), "{bound}");
        let options = coarsest.setting.over(&options).checked().unwrap();
        assert!(!bound.is_met_by(error(&mut renderer, &options)), "{bound}");
        assert!(choice.cost.rays > 0 && choice.cost.ms > 0.0);
    }
}

/// With the reference looking at another volume than the device.
fn choice_with_reference_of(
    reference: &Volume,
    options: &SceneOptions,
    bound: &str,
) -> Option<Choice> {
    let device = common::device()?;
    let volume = vessels();
    let octree: Octree = common::octree(&volume);
    let mut renderer = Renderer::new(&device, &volume, &octree, Options::default()).unwrap();
    let subject = subject(&volume);
    let task = task(reference, &subject, options, bound);
    Some(choose(&task, &mut renderer, &Silent).unwrap())
}

#[test]
fn another_reference_is_noticed() {
    let options = options("mode = 'mip'\nwindow = [0, 200]\nsize = 96");
    let own = choice_with_reference_of(&vessels(), &options, "rmse:0.02");
    let Some(own) = own else { return };
    assert!(own.met);
    let mut spec = PhantomSpec::new(PhantomKind::Vessels, Dims::new([40; 3]).unwrap());
    spec.noise = 0.1;
    let noisy = phantom(&spec).unwrap().volume;
    let other = choice_with_reference_of(&noisy, &options, "rmse:0.02").unwrap();
    assert!(!other.met);
    assert!(other.estimate > 0.02, "{}", other.estimate);
}

#[test]
fn where_nothing_keeps_the_bound_the_surest_setting_is_taken_and_the_failure_reported() {
    let options = options("mode = 'iso'\niso = '50%'\nsize = 96");
    let Some(choice) = choice_with_reference_of(&vessels(), &options, "psnr:200") else {
        return;
    };
    assert!(!choice.met);
    assert_eq!(choice.setting.flags(), "--sampling exact");
    assert!(choice.estimate > 80.0 && choice.estimate < 200.0);
    // The control: what it does reach is met.
    let choice = choice_with_reference_of(&vessels(), &options, "psnr:80").unwrap();
    assert!(choice.met);
}

#[test]
fn a_bound_is_refused_where_it_decides_nothing_or_contradicts() {
    let place = Place::with_ball();
    for (line, wanted) in [
        (
            "--max-error rmse:0.01 --step 1",
            "'step' cannot be combined",
        ),
        (
            "--max-error rmse:0.01 --sampling exact",
            "'sampling' cannot be combined",
        ),
        (
            "--max-error rmse:0.01 --refine none",
            "'refine' cannot be combined",
        ),
        ("--max-error value:1% --mode iso", "only a projection shows"),
        ("--max-error depth:0.1 --mode dvr", "only a surface is hit"),
        ("--max-error rmse", "is not an error bound"),
        ("--max-error mse:1", "is not an error metric"),
    ] {
        let message = place.refused(&format!("render ball.nrrd -o x.png {line}"), 2);
        assert!(message.contains(wanted), "{line}: {message}");
    }
    place.write("both.toml", "max-error = 'rmse:0.01'\nstep = 1\n");
    let message = place.refused("render ball.nrrd -o x.png --scene both.toml", 2);
    assert!(message.contains("cannot be combined"), "{message}");
    assert!(!place.path("x.png").exists());
}

#[test]
fn the_reference_needs_no_choice() {
    let place = Place::with_ball();
    place.write("bound.toml", "max-error = 'rmse:0.01'\nsize = [16, 16]\n");
    let output = place.run("render ball.nrrd -o x.png --scene bound.toml --device reference");
    assert!(output.status.success(), "{}", stderr(&output));
    assert!(stderr(&output).contains("nothing is chosen"));
    // The control: a flag that says how rays are followed drops the file's bound.
    let output =
        place.run("render ball.nrrd -o x.png --scene bound.toml --step 1 --device reference");
    assert!(output.status.success(), "{}", stderr(&output));
    assert!(!stderr(&output).contains("nothing is chosen"));
}

#[test]
fn what_was_chosen_is_reported_and_the_stored_scene_gives_the_same_picture() {
    let Some(device) = common::device() else {
        return;
    };
    let device = format!("--device {}", device.info().id);
    let place = Place::with_ball();
    let line = format!(
        "render ball.nrrd -o a.png --size 64x64 --mode mip --max-error value:1% --stats a.json {device}"
    );
    let output = place.run(&line);
    assert!(output.status.success(), "{}", stderr(&output));
    let messages = stderr(&output);
    assert!(
        messages.contains("note: max-error value:0.01: chose --"),
        "{messages}"
    );
    let stats = place.json("a.json");
    let stats_of_bound = &stats["max_error"];
    assert_eq!(
        (&stats_of_bound["metric"], &stats_of_bound["met"]),
        (&"value".into(), &true.into())
    );
    assert!(stats_of_bound["upper"].as_f64().unwrap() <= 0.01);
    let chosen = stats_of_bound["chosen"].as_str().unwrap();
    let tried = stats_of_bound["tried"].as_array().unwrap();
    let all = candidates(Mode::Mip, 0.01, true).unwrap().concat();
    assert!((1..=all.len()).contains(&tried.len()), "{}", tried.len());
    assert!(
        tried.iter().any(|one| one["setting"] == chosen),
        "{messages}"
    );
    assert!(
        messages.contains(&format!("; {} settings tried in ", tried.len())),
        "{messages}"
    );
    assert!(messages.contains(&format!("chose {chosen}:")), "{messages}");
    assert!(stats["scene"]["max-error"].is_null());

    let metadata = read_metadata(&place.path("a.png")).unwrap();
    let (_, scene) = metadata.iter().find(|(key, _)| key == "scene").unwrap();
    place.write("stored.toml", scene);
    place.done(&format!("render -o b.png --scene stored.toml {device}"));
    let read = |name: &str| std::fs::read(place.path(name)).unwrap();
    assert!(read("a.png") == read("b.png"));
    // Nothing is chosen without a bound.
    let line = format!("render ball.nrrd -o c.png --size 64x64 --stats c.json {device}");
    place.done(&line);
    assert!(place.json("c.json")["max_error"].is_null());
}
