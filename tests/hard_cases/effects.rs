//! Light and lens: cases 28 and 33, of edges before what lies far behind them, and of planes.

use std::f64::consts::PI;

use angioray::Subject;
use angioray::frame::{COC, Frame, KIND, Kind, OCCLUSION, Wanted};
use angioray::lab::hardcases::{FAR_SLOPE, HardCase, PLANE_Y};
use angioray::octree::{Leaf, Octree};
use angioray::options::SceneOptions;
use angioray::progress::Silent;
use angioray::reference;
use angioray::render::{Options, Renderer};
use angioray::scene::{DofMethod, Picture, Scene};
use angioray::volume::Volume;

use crate::common;
use crate::limits::{BLURRED, NOT_SMEARED, OCCLUDED_PLANE};
use crate::mutant::{CAUGHT, Mutant, assert_caught, is_mutant, kernel};
use crate::trial::{Seen, check, is, near, resolved};

pub const CASES: &[&str] = &[
    "focused-edge",
    "ball-before-plane",
    "tilted-plane",
    "blurred-edge",
];

/// The first channel of the sheet's light and of the plate's: the light comes along the view axis.
fn brightness(scene: &Scene) -> [f64; 2] {
    let Picture::Surface {
        color,
        phong: Some(phong),
        ..
    } = &scene.picture
    else {
        panic!("a lit surface");
    };
    let facing = |cosine: f64| color.0[0] * (phong.ambient.get() + phong.diffuse.get() * cosine);
    [facing(1.0), facing(FAR_SLOPE.y)]
}

/// Of the sheet's light and the plate's in a row of pixels the sheet's share, where its edge is blurred by discs of this diameter
/// in pixels: 1 to the edge in the picture's middle and 0 beyond it where there is none.
fn share_of_sheet(width: usize, pixel: usize, diameter_px: f64) -> f64 {
    let inside = width as f64 / 2.0 - ((pixel % width) as f64 + 0.5);
    let c = (2.0 * inside / diameter_px).clamp(-1.0, 1.0);
    0.5 + (c.asin() + c * (1.0 - c * c).sqrt()) / PI
}

/// The diameter of the sheet's circles of confusion, pixels.
fn sheets_circle_px(scene: &Scene) -> f64 {
    let dof = scene.depth_of_field.unwrap();
    let focus_mm = dof.focus.distance_mm(&[], scene.size).unwrap();
    let circle = dof.circle_px(&scene.camera, scene.size, focus_mm, 50.0);
    circle.abs().max(1e-6)
}

/// Lines where the light is not that of sheet and plate beside each other.
fn beside_each_other(seen: &Seen, diameter_px: f64, limit: f64) -> Vec<String> {
    let [sheet, plate] = brightness(seen.scene);
    let width = seen.scene.size.width() as usize;
    let pixels = (0..seen.pixels()).flat_map(|pixel| {
        let share = share_of_sheet(width, pixel, diameter_px);
        let expected = plate + share * (sheet - plate);
        let found = f64::from(seen.frame.color[pixel][0]);
        let what = format!("the light of pixel {pixel}");
        let opaque = near(
            &format!("the alpha of pixel {pixel}"),
            seen.alpha(pixel),
            1.0,
            limit,
        );
        [near(&what, found, expected, limit), opaque].concat()
    });
    pixels.collect()
}

#[test]
fn focused_edge() {
    fn expected(seen: &Seen) -> Vec<String> {
        let kinds = seen.frame.plane(KIND).unwrap();
        let circles = seen.frame.plane(COC).unwrap();
        let sheet = |kind: u32| kind == Kind::Cap as u32;
        let blurred = kinds.iter().zip(circles);
        let blurred = blurred.filter(|(kind, circle)| !sheet(**kind) && **circle > 5.0);
        let half = seen.pixels() / 2;
        [
            is("half of the picture is blurred", blurred.count() == half),
            is(
                "half of it is the sheet",
                kinds.iter().filter(|kind| sheet(**kind)).count() == half,
            ),
            beside_each_other(seen, 1e-6, NOT_SMEARED),
        ]
        .concat()
    }
    // The whole picture blurred, as it was before surfaces were told apart.
    let mixed = |scene: &mut Scene| scene.sampling.dof = DofMethod::Mix;
    check(
        "effects::focused_edge",
        "focused-edge",
        expected,
        &[
            Mutant::Scene(mixed),
            // What the sheet hides of the plate left out, of which pixels beside the edge see a part.
            kernel(
                "pass/gather_blur.cl",
                &[("if (ANY(shows_hidden))", "if (0)")],
            ),
        ],
    );
}

#[test]
fn blurred_edge() {
    fn expected(seen: &Seen) -> Vec<String> {
        let diameter_px = sheets_circle_px(seen.scene);
        let wide = is(
            "the circles are as wide as the scene's name says",
            match seen.name {
                "narrow-lit" => diameter_px < 0.01,
                "infinity-lit" => (diameter_px - 16.0).abs() < 1e-6,
                _ => (diameter_px - 64.0 / 9.0).abs() < 1e-6,
            },
        );
        [wide, beside_each_other(seen, diameter_px, BLURRED)].concat()
    }
    const PASS: &str = "pass/gather_blur.cl";
    check(
        "effects::blurred_edge",
        "blurred-edge",
        expected,
        &[
            // Smaller discs.
            kernel(
                "lib/ray/blur.clh",
                &[(
                    "0.5f * fabs(circle) + (0.5f - distance)",
                    "0.35f * fabs(circle) + (0.5f - distance)",
                )],
            ),
            // What lies behind a pixel in focus smeared over it.
            kernel(
                PASS,
                &[(
                    "gives *= tile->focused ? share_in_focus : share;",
                    "gives *= share;",
                )],
            ),
            kernel(PASS, &[("if (ANY(shows_hidden))", "if (0)")]),
        ],
    );
}

/// Whether each pixel shows what lies so far along y or farther, by its depth.
fn is_beyond(seen: &Seen, y_mm: f64) -> Vec<bool> {
    let beyond = |pixel: usize| {
        let (ray, depth_mm) = (seen.ray(pixel), seen.depth_mm(pixel));
        depth_mm.is_finite() && ray.origin_world.y + depth_mm * ray.dir_world.y > y_mm
    };
    (0..seen.pixels()).map(beyond).collect()
}

/// The number of pixels of a square's picture that are in a plane and no more than two pixels from what is not.
fn beside_others(width: usize, in_plane: &[bool]) -> usize {
    let is_beside = |pixel: &usize| {
        let (x, y) = (pixel % width, pixel / width);
        let around = |at: usize| at.saturating_sub(2)..=(at + 2).min(width - 1);
        let mut others = around(y).flat_map(|y| around(x).map(move |x| y * width + x));
        in_plane[*pixel] && others.any(|other| !in_plane[other])
    };
    (0..in_plane.len()).filter(is_beside).count()
}

/// Lines where a pixel that is to have no occlusion has some.
fn unoccluded(seen: &Seen, which: impl Fn(usize) -> bool) -> Vec<String> {
    let occlusion = seen.frame.plane(OCCLUSION).unwrap();
    let pixels = (0..seen.pixels()).filter(|&pixel| which(pixel));
    let of = |pixel| {
        let what = format!("the occlusion of pixel {pixel}");
        near(&what, f64::from(occlusion[pixel]), 0.0, OCCLUDED_PLANE)
    };
    pixels.flat_map(of).collect()
}

#[test]
fn ball_before_plane() {
    fn expected(seen: &Seen) -> Vec<String> {
        let in_plane = is_beyond(seen, PLANE_Y - 1.0);
        let beside = beside_others(seen.scene.size.width() as usize, &in_plane);
        [
            is("there is a silhouette", beside > 50),
            unoccluded(seen, |pixel| in_plane[pixel]),
        ]
        .concat()
    }
    const PASS: &str = "pass/screen_occlusion.cl";
    check(
        "effects::ball_before_plane",
        "ball-before-plane",
        expected,
        &[
            // Occlusion that ends nowhere: a halo.
            kernel(
                PASS,
                &[(
                    "FLOATS(-around->radius_mm * around->radius_mm)",
                    "FLOATS(-1e6f)",
                )],
            ),
            // What does not reach into the sphere around the point counts all the same.
            kernel(PASS, &[("seen = seen & within > 0.0f & to > from;", "")]),
        ],
    );
}

#[test]
fn tilted_plane() {
    fn expected(seen: &Seen) -> Vec<String> {
        let hit = |pixel: usize| seen.kind(pixel) != 0;
        [
            is("the plane is seen", seen.hits() > 50),
            unoccluded(seen, hit),
        ]
        .concat()
    }
    const SECTION: &str = "lib/light/section.clh";
    check(
        "effects::tilted_plane",
        "tilted-plane",
        expected,
        &[
            // Every plane taken to lie across the view axis.
            kernel(
                SECTION,
                &[(
                    "about.normal = along_axes(normal, axes)",
                    "about.normal.x = about.normal.y = FLOATS(0.0f); about.normal.z = FLOATS(-1.0f)",
                )],
            ),
            // Its slope along the picture's rows forgotten.
            kernel(
                SECTION,
                &[(
                    "section.column_nu = about.normal.x * shorter",
                    "section.column_nu = FLOATS(0.0f)",
                )],
            ),
        ],
    );
}

/// A case's volume and the first of its scenes.
fn first_of(name: &str) -> (Volume, Scene) {
    let (case, _) = HardCase::named(name).unwrap();
    let volume = case.volume(0).unwrap().volume;
    let (_, scene) = resolved(case, &volume).remove(0);
    (volume, scene)
}

/// The pixels of the sheet whose light is not the pinhole's to the bit, and those of the plate whose light is.
fn bits_changed(volume: &Volume, scene: &Scene) -> Option<[usize; 2]> {
    let device = common::device()?;
    let octree = Octree::build(volume, Leaf::default(), &Silent).unwrap();
    let mut renderer = Renderer::new(&device, volume, &octree, Options::default()).unwrap();
    let mut render = |scene: &Scene| renderer.render(scene, Wanted::ALL).unwrap().frame;
    let pinhole = Scene {
        depth_of_field: None,
        ..scene.clone()
    };
    let (sharp, blurred) = (render(&pinhole), render(scene));
    let bits = |frame: &Frame, pixel: usize| frame.color[pixel].map(f32::to_bits);
    let kinds = sharp.plane(KIND).unwrap().iter().enumerate();
    let (mut of_sheet, mut of_plate) = (0, 0);
    for (pixel, kind) in kinds {
        let same = bits(&sharp, pixel) == bits(&blurred, pixel);
        match *kind == Kind::Cap as u32 {
            true => of_sheet += usize::from(!same),
            false => of_plate += usize::from(same),
        }
    }
    Some([of_sheet, of_plate])
}

#[test]
fn a_sheet_in_focus_keeps_the_pinholes_bits() {
    let (volume, scene) = first_of("focused-edge");
    let Some([changed, kept]) = bits_changed(&volume, &scene) else {
        return;
    };
    assert_eq!(changed, 0, "{CAUGHT}: {changed} pixels of the sheet");
    if is_mutant() {
        return;
    }
    // The controls: the plate out of focus does not keep them, nor does the sheet where the focus lies behind it.
    assert!(kept * 10 < scene.size.pixels(), "{kept}");
    let mut behind = scene.clone();
    behind.depth_of_field = Some("focus=80,aperture=8".parse().unwrap());
    assert!(bits_changed(&volume, &behind).unwrap()[0] > 0);
    // What is in focus gathered like all else, and what lies behind it smeared over it.
    assert_caught(
        "effects::a_sheet_in_focus_keeps_the_pinholes_bits",
        "pass/gather_blur.cl",
        &[
            (
                "if (!ANY(!tile->focused | by_seen.before_own + by_hidden.before_own > 0.0f))",
                "if (0)",
            ),
            (
                "Mask kept = tile->focused & nearer == 0.0f;",
                "Mask kept = NO_LANE;",
            ),
            (
                "gives *= tile->focused ? share_in_focus : share;",
                "gives *= share;",
            ),
        ],
    );
}

/// Why a scene file with this depth of field, of a picture of nothing but its corners, is refused by device and reference.
fn refusals(volume: &Volume, toml: &str) -> Vec<String> {
    let options = match SceneOptions::parse(toml, "the case") {
        Ok(options) => options,
        Err(error) => return vec![error.to_string()],
    };
    let scene = options.resolve(&Subject::of(volume)).unwrap().scene;
    let by_reference = reference::render(volume, &scene, Wanted::NONE, &Silent);
    let mut refused: Vec<String> = by_reference.err().iter().map(ToString::to_string).collect();
    if let Some(device) = common::device() {
        let octree = Octree::build(volume, Leaf::default(), &Silent).unwrap();
        let mut renderer = Renderer::new(&device, volume, &octree, Options::default()).unwrap();
        let by_device = renderer.render(&scene, Wanted::NONE);
        refused.extend(by_device.err().iter().map(ToString::to_string));
    }
    refused
}

#[test]
fn a_lens_without_width_and_a_focus_on_nothing_are_refused() {
    let (case, _) = HardCase::named("blurred-edge").unwrap();
    let volume = case.volume(0).unwrap().volume;
    let scenes = case.scenes(&volume);
    // So wide that the corners look past the volume.
    let wide = |dof: &str| {
        let lines = scenes[0].toml.lines();
        let kept = lines.filter(|line| !line.starts_with("dof") && !line.starts_with("fov"));
        let kept = kept.collect::<Vec<_>>().join("\n");
        format!("{kept}\nfov = 60.0\ndof = '{dof}'\n")
    };
    for (dof, sentence) in [
        (
            "focus=50,aperture=0",
            "a distance of 0 is out of its domain",
        ),
        ("focus=0,aperture=8", "a distance of 0 is out of its domain"),
        (
            "focus=pixel:0:0,aperture=8",
            "nothing is seen in pixel 0:0, which is to be in focus",
        ),
    ] {
        let refused = refusals(&volume, &wide(dof));
        assert!(!refused.is_empty(), "{dof}");
        assert!(
            refused.iter().all(|why| why.contains(sentence)),
            "{dof}: {refused:?}"
        );
    }
    // The controls: hardly any width, and a pixel in which something is seen.
    for dof in ["focus=50,aperture=1e-6", "focus=pixel:31:4,aperture=8"] {
        assert_eq!(refusals(&volume, &wide(dof)), Vec::<String>::new(), "{dof}");
    }
}
