//! How far rays go on behind their hits, against closed forms and the reference.

use angioray::Subject;
use angioray::extent::{Dims, ImageSize};
use angioray::frame::{Frame, KIND, Layer, THICK, Wanted};
use angioray::render::{Lanes, Options, Renderer};
use angioray::scene::{
    AntiAliasing, ClipPlane, Filter, Mode, Picture, Sampling, SamplingMethod, Scene, ScreenError,
    Sparse, Traverse,
};
use angioray::volume::{PhantomKind, PhantomSpec, Volume, phantom};
use glam::DVec3;

use crate::common::{self, on_device, on_reference};
use crate::slab::thick_cases;

#[test]
fn slabs_are_as_thick_as_they_are_along_the_ray() {
    let Some(device) = common::device() else {
        return;
    };
    for case in thick_cases() {
        for method in [SamplingMethod::Exact, SamplingMethod::Fixed] {
            let mut scene = case.scene.clone();
            scene.sampling.method = method;
            let frames = on_device(&device, &case.volume, &[scene]);
            let thick_mm = f64::from(frames[0].plane(THICK).unwrap()[0]);
            let off = thick_mm - case.thick_mm;
            assert!(off.abs() < 2e-3, "{}, {method}: {off}", case.name);
        }
    }
}

fn vessels() -> Volume {
    let dims = Dims::new([48; 3]).unwrap();
    phantom(&PhantomSpec::new(PhantomKind::Vessels, dims))
        .unwrap()
        .volume
}

fn scene(volume: &Volume) -> Scene {
    let picture = Picture::of_mode(Mode::Iso, &Subject::of(volume)).unwrap();
    let mut scene = common::scene(volume, 96, picture);
    scene.sampling = Sampling::default();
    scene
}

/// The share of pixels that both hit whose thicknesses differ by more than a limit.
fn share_apart(reference: &Frame, frame: &Frame, limit_mm: f32) -> f64 {
    let kinds = reference.plane(KIND).unwrap().iter();
    let hit = kinds
        .zip(frame.plane(KIND).unwrap())
        .map(|(a, b)| a * b != 0);
    let thick = reference.plane(THICK).unwrap().iter();
    let both: Vec<f32> = (thick.zip(frame.plane(THICK).unwrap()).zip(hit))
        .filter_map(|((a, b), hit)| hit.then_some((a - b).abs()))
        .collect();
    assert!(both.len() > 300, "{} pixels", both.len());
    both.iter().filter(|apart| **apart > limit_mm).count() as f64 / both.len() as f64
}

#[test]
fn it_is_the_references() {
    let Some(device) = common::device() else {
        return;
    };
    let volume = vessels();
    let (center, radius_mm) = volume.bounding_sphere();
    let mut clipped = scene(&volume);
    clipped.clip_planes = vec![ClipPlane::new(DVec3::Y, -center.y + 0.2 * radius_mm).unwrap()];
    let mut nearest = scene(&volume);
    nearest.sampling.filter = Filter::Nearest;
    for scene in [scene(&volume), clipped, nearest] {
        let reference = on_reference(&volume, &scene);
        let frame = &on_device(&device, &volume, std::slice::from_ref(&scene))[0];
        let apart = share_apart(&reference, frame, 2e-3);
        assert!(apart < 0.002, "{apart}");
        // The control: from a little aside it is another.
        let mut aside = scene.clone();
        aside.camera = common::camera(&volume, common::OBLIQUE + DVec3::X * 0.02);
        assert!(share_apart(&reference, &on_reference(&volume, &aside), 2e-3) > 0.5);
    }
}

#[test]
fn nothing_changes_a_bit_of_it() {
    let Some(device) = common::device() else {
        return;
    };
    let volume = vessels();
    let octree = common::octree(&volume);
    let base = scene(&volume);
    let render = |scene: &Scene, lanes| {
        let options = Options {
            lanes,
            ..Options::default()
        };
        let mut renderer = Renderer::new(&device, &volume, &octree, options).unwrap();
        let wanted = Wanted::NONE.with([Layer::Thick]);
        let frame = renderer.render(scene, wanted).unwrap().frame;
        frame.plane(THICK).unwrap().to_vec()
    };
    let plain = render(&base, None);
    assert!(plain.iter().any(|mm| *mm > 0.0));
    for lanes in Lanes::ALL {
        assert!(render(&base, Some(lanes)) == plain, "{lanes:?}");
    }
    for traverse in Traverse::ALL {
        let mut scene = base.clone();
        scene.sampling.traverse = traverse;
        assert!(render(&scene, None) == plain, "{traverse:?}");
    }
    let mut everything = base.clone();
    everything.sampling.skip = false;
    assert!(render(&everything, None) == plain);
    let mut many = base.clone();
    many.anti_aliasing = AntiAliasing::new(2, false).unwrap();
    assert!(render(&many, None) == plain);
    let mut certified = base.clone();
    let error = ScreenError::new(0.0).unwrap();
    certified.sparse = Some(Sparse::new(None, None, Some(error), Mode::Iso).unwrap());
    assert!(render(&certified, None) == plain);
    // The control: another picture.
    let mut larger = base;
    larger.size = ImageSize::new(97, 96).unwrap();
    assert!(render(&larger, None) != plain);
}
