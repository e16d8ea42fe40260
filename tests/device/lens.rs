//! Depth of field on the device and in the reference: against closed forms, and against each other.

use std::f64::consts::PI;

use angioray::Subject;
use angioray::extent::{Dims, ImageSize};
use angioray::frame::error::color_error;
use angioray::frame::{COC, DEPTH, Frame, Wanted};
use angioray::render::{Lanes, Options, Renderer};
use angioray::scene::{
    AntiAliasing, Camera, DofMethod, Lens, Mode, Picture, RayCount, Sampling, Scene, Traverse,
};
use angioray::volume::{PhantomKind, PhantomSpec, Volume, phantom};
use glam::DVec3;

use crate::common::{self, on_device, on_reference};

/// A block seen from its front face, whose corner lies in the middle of the picture's row: so that its edge is a straight
/// line between two pixels. It is 100 mm away.
pub fn block(lens: Lens, dof: &str) -> (Volume, Scene) {
    let block = common::volume_of([21, 2, 21], |_, _, _| 1.0_f32);
    let picture = Picture::Surface {
        iso: 0.5,
        caps: true,
        refine: Default::default(),
        color: angioray::scene::Rgb([1.0; 3]),
        phong: None,
    };
    let mut scene = common::scene(&block, 64, picture);
    scene.size = ImageSize::new(64, 1).unwrap();
    let edge = DVec3::new(20.0, 0.0, 10.0);
    scene.camera = Camera::look_at(edge - DVec3::Y * 100.0, edge, DVec3::Z, lens).unwrap();
    scene.sampling = Sampling {
        dof: DofMethod::Lens(RayCount::new(1024).unwrap()),
        ..Sampling::default()
    };
    scene.depth_of_field = Some(dof.parse().unwrap());
    (block, scene)
}

/// How far the opacities beside the block's edge are at most from those of a blur by discs of a diameter in pixels: of a disc
/// whose middle is d away from the edge, inside the block, the share 1/2 + (asin c + c √(1 − c²))/π covers it, c = 2d/diameter.
pub fn apart(frame: &Frame, diameter_px: f64) -> f64 {
    let share = |pixel: usize| {
        let inside = 32.0 - (pixel as f64 + 0.5); // the block is on the left
        let c = (2.0 * inside / diameter_px).clamp(-1.0, 1.0);
        0.5 + (c.asin() + c * (1.0 - c * c).sqrt()) / PI
    };
    let difference = |pixel: usize| (f64::from(frame.color[pixel][3]) - share(pixel)).abs();
    // Far from the edge the block ends on the other side.
    (20..44).map(difference).fold(0.0, f64::max)
}

#[test]
fn an_edge_out_of_focus_is_blurred_by_the_circle_of_confusion() {
    let Some(device) = common::device() else {
        return;
    };
    // A pixel of the row is as high as the picture: half a millimetre at the block's front.
    let fov_deg = 2.0 * (0.25_f64 / 100.0).atan().to_degrees();
    let perspective = Lens::Perspective { fov_deg };
    let parallel = Lens::Orthographic { height_mm: 0.5 };
    let tan = 2.0_f64.to_radians().tan();
    for (lens, dof, circle_px) in [
        (
            perspective,
            "focus=50,aperture=4",
            4.0 * (1.0 / 50.0 - 1.0 / 100.0) * 200.0,
        ),
        (
            perspective,
            "focus=200,aperture=8",
            8.0 * (1.0 / 200.0 - 1.0 / 100.0) * 200.0,
        ),
        (parallel, "focus=60,aperture=2deg", 2.0 * 40.0 * tan * 2.0),
        (parallel, "focus=130,aperture=2deg", 2.0 * -30.0 * tan * 2.0),
    ] {
        let (block, scene) = block(lens, dof);
        let reference = on_reference(&block, &scene);
        let frames = on_device(&device, &block, std::slice::from_ref(&scene));
        // What 256 points leave of a disc beside a straight edge, and 1024.
        for (frame, limit) in [(&reference, 0.018), (&frames[0], 0.01)] {
            let found = apart(frame, circle_px.abs());
            assert!(found < limit, "{dof}: {found}");
            // The control: a circle of another size.
            assert!(apart(frame, 1.4 * circle_px.abs()) > 0.03, "{dof}");
            let coc = f64::from(frame.plane(COC).unwrap()[30]);
            assert!((coc - circle_px).abs() < 1e-3, "{dof}: {coc}");
            assert!(frame.plane(DEPTH).unwrap()[40].is_infinite());
        }
    }
    // In focus it is as sharp as a pinhole's.
    for dof in ["focus=100,aperture=8", "focus=auto,aperture=8"] {
        let (block, scene) = block(perspective, dof);
        let frames = on_device(&device, &block, &[scene]);
        let alphas: Vec<f32> = frames[0].color.iter().map(|color| color[3]).collect();
        assert!(
            alphas[20..32].iter().all(|&a| (a - 1.0).abs() < 1e-5),
            "{alphas:?}"
        );
        assert!(alphas[32..].iter().all(|&a| a < 1e-5), "{alphas:?}");
    }
}

pub fn vessels(mode: Mode, dof: &str) -> (Volume, Scene) {
    let dims = Dims::new([48; 3]).unwrap();
    let volume = phantom(&PhantomSpec::new(PhantomKind::Vessels, dims))
        .unwrap()
        .volume;
    let picture = Picture::of_mode(mode, &Subject::of(&volume)).unwrap();
    let mut scene = common::scene(&volume, 48, picture);
    scene.sampling = Sampling {
        dof: DofMethod::Lens(RayCount::new(256).unwrap()),
        ..Sampling::default()
    };
    scene.depth_of_field = Some(dof.parse().unwrap());
    (volume, scene)
}

#[test]
fn many_points_of_the_lens_see_what_the_reference_does() {
    let Some(device) = common::device() else {
        return;
    };
    for mode in [Mode::Iso, Mode::Dvr] {
        for dof in [
            "focus=auto,aperture=12",
            "focus=percentile:10,aperture=8,darken=0.7",
        ] {
            let (volume, mut scene) = vessels(mode, dof);
            if mode == Mode::Iso {
                scene.anti_aliasing = AntiAliasing::new(2, false).unwrap();
            }
            let reference = on_reference(&volume, &scene);
            let frames = on_device(&device, &volume, std::slice::from_ref(&scene));
            let error = color_error(&reference, &frames[0]).unwrap();
            assert!(error.rmse < 0.012, "{mode} {dof}: {error:?}");
            let circles = reference
                .plane(COC)
                .unwrap()
                .iter()
                .zip(frames[0].plane(COC).unwrap());
            let seen = circles.zip(
                reference
                    .plane(DEPTH)
                    .unwrap()
                    .iter()
                    .zip(frames[0].plane(DEPTH).unwrap()),
            );
            for ((a, b), _) in seen.filter(|(_, (a, b))| a.is_finite() && b.is_finite()) {
                assert!((a - b).abs() < 0.05, "{mode} {dof}: {a} {b}");
            }
            // The control: the pinhole's picture is another.
            let pinhole = Scene {
                depth_of_field: None,
                ..scene
            };
            let frames = on_device(&device, &volume, &[pinhole]);
            let without = color_error(&reference, &frames[0]).unwrap();
            assert!(
                without.rmse > 4.0 * error.rmse,
                "{mode} {dof}: {without:?} {error:?}"
            );
        }
    }
}

#[test]
fn nothing_else_changes_a_bit_and_layers_are_the_pinholes() {
    let Some(device) = common::device() else {
        return;
    };
    let (volume, mut scene) = vessels(Mode::Iso, "focus=auto,aperture=12");
    scene.sampling.dof = DofMethod::Lens(RayCount::new(8).unwrap());
    let octree = common::octree(&volume);
    let render = |scene: &Scene, lanes| {
        let options = Options {
            lanes,
            ..Options::default()
        };
        let mut renderer = Renderer::new(&device, &volume, &octree, options).unwrap();
        renderer.render(scene, Wanted::ALL).unwrap()
    };
    let plain = render(&scene, None);
    assert!(plain.focus_mm.is_some_and(|mm| mm > 0.0));
    for lanes in Lanes::ALL {
        let other = render(&scene, Some(lanes));
        assert_eq!(other.frame.color, plain.frame.color, "{lanes:?}");
        assert_eq!(other.frame.plane(COC), plain.frame.plane(COC), "{lanes:?}");
    }
    for traverse in Traverse::ALL {
        let mut other = scene.clone();
        other.sampling.traverse = traverse;
        assert_eq!(
            render(&other, None).frame.color,
            plain.frame.color,
            "{traverse:?}"
        );
    }
    let pinhole = render(
        &Scene {
            depth_of_field: None,
            ..scene.clone()
        },
        None,
    );
    assert_eq!(pinhole.frame.plane(DEPTH), plain.frame.plane(DEPTH));
    assert_eq!(pinhole.focus_mm, None);
    assert_ne!(pinhole.frame.color, plain.frame.color);
    // Where nothing is seen nothing can be in focus.
    let mut at_nothing = scene.clone();
    at_nothing.depth_of_field = Some("focus=pixel:0:0,aperture=2".parse().unwrap());
    let mut renderer = Renderer::new(&device, &volume, &octree, Options::default()).unwrap();
    let refused = renderer
        .render(&at_nothing, Wanted::NONE)
        .err()
        .unwrap()
        .to_string();
    assert!(
        refused.contains("nothing is seen in pixel 0:0"),
        "{refused}"
    );
}
