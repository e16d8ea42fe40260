//! Emission and absorption against closed forms, fine quadrature and brute force.

use angioray::scene::{
    Intensity, Knot, Light, Phong, Picture, Reflectance, Reflection, Rgb, ShadedFrom, Shininess,
    SrgbColor, TransferFunction,
};
use angioray::volume::{Geometry, Volume};
use glam::DVec3;

use crate::common::*;

fn knot(value: f64, color: [f64; 3], opacity: f64) -> Knot {
    Knot {
        value,
        color: Rgb(color),
        opacity,
    }
}

fn transfer(knots: &[Knot], unit_length_mm: f64) -> TransferFunction {
    TransferFunction::new(knots.to_vec(), unit_length_mm).unwrap()
}

fn worst(a: [f64; 4], b: [f64; 4]) -> f64 {
    (0..4).fold(0.0, |w, c| f64::max(w, (a[c] - b[c]).abs()))
}

const COLOR: [f64; 3] = [0.9, 0.5, 0.1];

/// Through a profile along x, straight.
fn along(values: &[f64], transfer: TransferFunction) -> [f64; 4] {
    let at = |x: f64| DVec3::new(x, 0.5, 0.25);
    cast(&profile(values), dvr(transfer, None), at(-2.0), at(99.0)).color
}

/// The colour of one premultiplied constant colour behind an optical depth.
fn one_color(depth: f64) -> [f64; 4] {
    let alpha = -(-depth).exp_m1();
    [COLOR[0] * alpha, COLOR[1] * alpha, COLOR[2] * alpha, alpha]
}

#[test]
fn a_homogeneous_mediums_opacity_depends_on_the_path_length_alone() {
    let mut random = Random(4);
    for geometry in [Geometry::default(), oblique(false), oblique(true)] {
        let fog = volume([6, 5, 4], geometry, |_| 3.0);
        for opacity in [1e-6, 0.1, 0.9, 1.0 - 1e-6, 1.0] {
            for unit_mm in [1.0, 25.0, 1e-3, 1e-6, 1e-9] {
                let tf = transfer(&[knot(0.0, COLOR, opacity)], unit_mm);
                let kappa = -(1.0 - opacity.min(0.999_999)).ln() / unit_mm;
                for _ in 0..10 {
                    let (eye, toward) = random_ray(&mut random, &fog);
                    let (enter, leave) = path(&fog, eye, toward, toward);
                    let seen = cast(&fog, dvr(tf.clone(), None), eye, toward);
                    let depth = kappa * (leave - enter);
                    assert!(worst(seen.color, one_color(depth)) < 1e-9);
                    if (1e-3..10.0).contains(&depth) {
                        assert!(worst(seen.color, one_color(depth * 1.001)) > 1e-9);
                    }
                }
            }
        }
    }
}

/// ∫ −ln(1 − a u) du for u from 0 to 1.
fn depth_of_ramp(a: f64) -> f64 {
    ((1.0 - a) * (1.0 - a).ln() + a) / a
}

#[test]
fn a_ramp_of_opacity_has_its_closed_form() {
    let ramp: Vec<f64> = (0..9).map(f64::from).collect();
    for a in [0.01, 0.5, 0.99] {
        let tf = transfer(&[knot(0.0, COLOR, 0.0), knot(8.0, COLOR, a)], 2.0);
        let depth = 8.0 * depth_of_ramp(a) / 2.0;
        assert!(worst(along(&ramp, tf.clone()), one_color(depth)) < 1e-9);
        assert!(worst(along(&ramp, tf), one_color(depth * (1.0 + 1e-5))) > 1e-9);
    }
}

#[test]
fn a_narrow_spike_is_not_missed() {
    let ramp: Vec<f64> = (0..9).map(f64::from).collect();
    for width in [1e-2, 1e-5, 1e-9] {
        let tf = transfer(
            &[
                knot(4.3 - width, COLOR, 0.0),
                knot(4.3, COLOR, 0.9),
                knot(4.3 + width, COLOR, 0.0),
            ],
            width,
        );
        // The knots' own rounding widens a spike of 1e-9 by 1e-7 of itself.
        let tolerance = if width < 1e-8 { 1e-6 } else { 1e-9 };
        let expected = one_color(2.0 * depth_of_ramp(0.9));
        assert!(worst(along(&ramp, tf), expected) < tolerance, "{width}");
        assert!(expected[3] > 0.5);
    }
}

#[test]
fn the_opacity_limit_is_a_kink_of_its_own() {
    let ramp: Vec<f64> = (0..9).map(f64::from).collect();
    // Opacity reaches 1 at 2, so that the limit holds from just before it to just behind.
    let tf = transfer(
        &[
            knot(0.0, COLOR, 0.0),
            knot(2.0, COLOR, 1.0),
            knot(4.0, COLOR, 0.0),
        ],
        10.0,
    );
    // Up to the limit: ∫ −ln(1 − u/2) du = 2 (1 + e ln e − e), e = 1e-6; then 2e mm of it at −ln e.
    let e = 1.0 - 0.999_999_f64;
    let rise = 2.0 * (1.0 + e * e.ln() - e) + 2.0 * e * -e.ln();
    let expected = one_color(2.0 * rise / 10.0);
    assert!(worst(along(&ramp, tf), expected) < 1e-9);
    assert!(worst(one_color(4.0 / 10.0), expected) > 1e-9);
}

#[test]
fn two_slabs_composite_front_to_back() {
    let (red, blue) = ([1.0, 0.0, 0.0], [0.0, 0.0, 1.0]);
    // Two knots at 4: a jump. Halfway along the ramp red becomes blue.
    let tf = transfer(
        &[
            knot(0.0, red, 0.3),
            knot(4.0, red, 0.3),
            knot(4.0, blue, 0.6),
            knot(8.0, blue, 0.6),
        ],
        3.0,
    );
    let ramp: Vec<f64> = (0..9).map(f64::from).collect();
    let t_red = 0.7_f64.powf(4.0 / 3.0);
    let t_blue = 0.4_f64.powf(4.0 / 3.0);
    let forward = [
        1.0 - t_red,
        0.0,
        t_red * (1.0 - t_blue),
        1.0 - t_red * t_blue,
    ];
    assert!(worst(along(&ramp, tf.clone()), forward) < 1e-9);
    let falling: Vec<f64> = ramp.iter().rev().copied().collect();
    let backward = [
        t_blue * (1.0 - t_red),
        0.0,
        1.0 - t_blue,
        1.0 - t_red * t_blue,
    ];
    assert!(worst(along(&falling, tf.clone()), backward) < 1e-9);
    assert!(worst(forward, backward) > 0.01);
    // A volume at the jump's own value takes the later point.
    let flat = along(&[4.0; 5], tf);
    assert!(worst(flat, [0.0, 0.0, 1.0 - t_blue, 1.0 - t_blue]) < 1e-9);
}

#[test]
fn a_colour_ramp_agrees_with_fine_quadrature() {
    // c = (u, 1 − u, 1/2), α = 0.8 u with u = x/8 and unit length 2, by Simpson's rule on τ's
    // closed form.
    let ramp: Vec<f64> = (0..9).map(f64::from).collect();
    let tf = transfer(
        &[
            knot(0.0, [0.0, 1.0, 0.5], 0.0),
            knot(8.0, [1.0, 0.0, 0.5], 0.8),
        ],
        2.0,
    );
    let integrand = |u: f64| {
        let k = -(1.0 - 0.8 * u).ln() / 2.0 * 8.0;
        let depth = 8.0 / 2.0 * ((1.0 - 0.8 * u) * (1.0 - 0.8 * u).ln() + 0.8 * u) / 0.8;
        let seen = k * (-depth).exp();
        [u * seen, (1.0 - u) * seen, 0.5 * seen, seen]
    };
    let mut expected = [0.0; 4];
    const N: u32 = 2000;
    for i in 0..=N {
        let weight = match i {
            0 | N => 1.0,
            i if i % 2 == 1 => 4.0,
            _ => 2.0,
        };
        let f = integrand(f64::from(i) / f64::from(N));
        for c in 0..4 {
            expected[c] += weight * f[c] / (3.0 * f64::from(N));
        }
    }
    let seen = along(&ramp, tf);
    assert!(worst(seen, expected) < 1e-9);
    assert!(worst(seen, [expected[1], expected[0], expected[2], expected[3]]) > 1e-9);
}

/// How a point's colour is lit: of its place in world space, the gradient there, and the direction toward the viewer.
type Shade<'a> = &'a dyn Fn([f64; 3], DVec3, DVec3, DVec3) -> [f64; 3];

/// The contract's formulas by the midpoint rule, point by point, from the test's own field.
fn brute_force(
    volume: &Volume,
    tf: &TransferFunction,
    shade: Option<Shade>,
    (eye, toward): (DVec3, DVec3),
    steps: u32,
) -> [f64; 4] {
    let dir = (toward - eye).normalize();
    let (enter, leave) = path(volume, eye, toward, toward);
    let h = (leave - enter) / f64::from(steps);
    let mut color = [0.0; 3];
    let mut depth = 0.0_f64;
    for i in 0..steps {
        let at = eye + dir * (enter + h * (f64::from(i) + 0.5));
        let p = volume.geometry().index_from_world().transform_point3(at);
        let p = p.clamp(DVec3::ZERO, last(volume));
        let (c, opacity) = tf.at(phi(volume, p));
        let kappa = -(1.0 - opacity.min(0.999_999)).ln() / tf.unit_length_mm();
        let seen = kappa * h * (-(depth + kappa * h / 2.0)).exp();
        depth += kappa * h;
        let c = match shade {
            Some(shade) => shade(c.0, at, gradient(volume, p), -dir),
            None => c.0,
        };
        for k in 0..3 {
            color[k] += c[k] * seen;
        }
    }
    [color[0], color[1], color[2], 1.0 - (-depth).exp()]
}

fn phong_by_the_book(phong: &Phong, c: [f64; 3], n: DVec3, v: DVec3, l: DVec3) -> [f64; 3] {
    let n = if n.dot(v) < 0.0 { -n } else { n };
    let nl = n.dot(l);
    let base = match phong.reflection {
        Reflection::Phong => (2.0 * nl * n - l).dot(v),
        Reflection::BlinnPhong => n.dot((l + v).normalize()),
    };
    let s = if nl > 0.0 {
        base.max(0.0).powf(phong.shininess.get())
    } else {
        0.0
    };
    c.map(|c| {
        c * (phong.ambient.get() + phong.diffuse.get() * nl.max(0.0)) + phong.specular.get() * s
    })
}

/// White light from one direction.
fn lit_from<'a>(
    phong: &'a Phong,
    light: DVec3,
) -> impl Fn([f64; 3], DVec3, DVec3, DVec3) -> [f64; 3] + 'a {
    move |c, _, gradient, v| phong_by_the_book(phong, c, normal(gradient, v), v, light)
}

fn bumpy() -> TransferFunction {
    transfer(
        &[
            knot(2.0, [0.1, 0.2, 0.9], 0.0),
            knot(4.0, [0.9, 0.3, 0.1], 0.5),
            knot(4.5, [1.0, 1.0, 0.2], 0.05),
            knot(7.0, [0.4, 0.9, 0.6], 0.05),
            knot(7.5, [1.0, 0.9, 0.8], 0.7),
        ],
        1.5,
    )
}

#[test]
fn brute_force_converges_to_the_reference_with_the_square_of_its_step() {
    let mut random = Random(9);
    let (mut coarse, mut fine) = (0.0, 0.0);
    for case in 0..10 {
        let noise = random.noise(6, oblique(case % 2 == 0), 10.0);
        let ray = random_ray(&mut random, &noise);
        let exact = cast(&noise, dvr(bumpy(), None), ray.0, ray.1).color;
        let error = |steps: u32| worst(brute_force(&noise, &bumpy(), None, ray, steps), exact);
        coarse += error(1_000) / 10.0;
        fine += error(16_000) / 10.0;
        let mut wrong = exact;
        wrong[0] += 1e-5;
        assert!(worst(brute_force(&noise, &bumpy(), None, ray, 16_000), wrong) > 1e-6);
    }
    // Order 2 gives 256; the kinks lie at random places of the steps.
    assert!((100.0..600.0).contains(&(coarse / fine)), "{coarse} {fine}");
    assert!(fine < 1e-6);
}

#[test]
fn shaded_emission_agrees_with_brute_force() {
    let mut random = Random(10);
    let distant = DVec3::new(0.3, -0.8, 0.5).normalize();
    for case in 0..8 {
        let noise = random.noise(5, oblique(case % 2 == 0), 10.0);
        let phong = Phong {
            reflection: [Reflection::Phong, Reflection::BlinnPhong][case % 2],
            shininess: Shininess::new(12.0).unwrap(),
            ..Phong::default()
        };
        let ray = random_ray(&mut random, &noise);
        let mut scene = scene(dvr(bumpy(), Some(phong)));
        let mut light = -(ray.1 - ray.0).normalize();
        if case >= 4 {
            scene.lights = vec![Light::distant(distant).unwrap()];
            light = distant;
        }
        let exact = cast_scene(&noise, &scene, ray.0, ray.1).color;
        let error = |steps: u32| {
            let shade = lit_from(&phong, light);
            worst(
                brute_force(&noise, &bumpy(), Some(&shade), ray, steps),
                exact,
            )
        };
        // With a distant light the shading jumps where a surface turns away: order 1 there.
        let limit = if case >= 4 { 2e-5 } else { 1e-6 };
        assert!(error(30_000) < limit, "{case}: {}", error(30_000));
        let unlit = cast(&noise, dvr(bumpy(), None), ray.0, ray.1).color;
        assert!(worst(unlit, exact) > 1e-3);
    }
}

/// A point among the voxels and a distant light, of two colours, on a material with colours, where gradients of less
/// than `from` are shaded in part.
#[test]
fn several_lights_and_small_gradients_agree_with_brute_force() {
    let mut random = Random(12);
    let distant = DVec3::new(0.3, -0.8, 0.5).normalize();
    let (warm, cold, tint) = ([1.0, 0.5, 0.25], [0.0, 0.5, 2.0], [1.0, 0.25, 0.5]);
    for case in 0..8 {
        let noise = random.noise(5, oblique(case % 2 == 0), 10.0);
        let phong = Phong {
            shininess: Shininess::new(12.0).unwrap(),
            diffuse_color: Rgb(tint),
            ..Phong::default()
        };
        let ray = random_ray(&mut random, &noise);
        let inside = random.point(DVec3::ZERO, last(&noise));
        let point = noise.geometry().world_from_index().transform_point3(inside);
        let from = [0.0, 3.0][case / 4];
        let shade = |c: [f64; 3], at: DVec3, gradient: DVec3, v: DVec3| {
            let n = normal(gradient, v);
            let white = |l: DVec3, c| phong_by_the_book(&phong, c, n, v, l);
            let tinted = std::array::from_fn(|k| c[k] * tint[k]);
            let unlit: [f64; 3] = tinted.map(|c| c * phong.ambient.get());
            let (near, far) = (
                white((point - at).normalize(), tinted),
                white(distant, tinted),
            );
            let share = if from > 0.0 {
                (gradient.length() / from).min(1.0)
            } else {
                1.0
            };
            std::array::from_fn(|k| {
                let light = warm[k] * (near[k] - unlit[k]) + cold[k] * (far[k] - unlit[k]);
                let shaded = c[k] * phong.ambient.get() + light;
                share * shaded + (1.0 - share) * c[k]
            })
        };
        let mut scene = scene(dvr(bumpy(), Some(phong)));
        let light = |light: Light, [r, g, b]: [f64; 3], intensity: f64| Light {
            color: linear_color([r / intensity, g / intensity, b / intensity]),
            intensity: Intensity::new(intensity).unwrap(),
            ..light
        };
        scene.lights = vec![
            light(Light::point(point).unwrap(), warm, 1.0),
            light(Light::distant(distant).unwrap(), cold, 2.0),
        ];
        if let Picture::Emission(medium) = &mut scene.picture {
            medium.shaded_from = ShadedFrom::new(from).unwrap();
        }
        let exact = cast_scene(&noise, &scene, ray.0, ray.1).color;
        let off = worst(
            brute_force(&noise, &bumpy(), Some(&shade), ray, 30_000),
            exact,
        );
        assert!(off < 3e-5, "{case}: {off}");
        // The control: white lights, and all shaded.
        let one = lit_from(&phong, distant);
        assert!(worst(brute_force(&noise, &bumpy(), Some(&one), ray, 3000), exact) > 1e-3);
    }
}

/// An sRGB colour whose linear light is near these channels.
fn linear_color(linear: [f64; 3]) -> SrgbColor {
    let [r, g, b] = Rgb(linear).to_srgb();
    format!("{r},{g},{b}").parse().unwrap()
}

#[test]
fn a_gaussian_blob_agrees_with_brute_force() {
    let blob = volume([17, 17, 17], Geometry::default(), |p| {
        10.0 * (-p.distance_squared(DVec3::splat(8.0)) / 18.0).exp()
    });
    let mut random = Random(6);
    for _ in 0..4 {
        let ray = random_ray(&mut random, &blob);
        let exact = cast(&blob, dvr(bumpy(), None), ray.0, ray.1).color;
        assert!(worst(brute_force(&blob, &bumpy(), None, ray, 30_000), exact) < 1e-6);
    }
}

#[test]
fn the_nearest_filter_composites_the_voxels_boxes() {
    let tf = transfer(&[knot(0.0, [0.0; 3], 0.0), knot(10.0, [1.0; 3], 0.5)], 1.0);
    let at = |x: f64| DVec3::new(x, 0.5, 0.25);
    let mut scene = scene(dvr(tf, None));
    scene.sampling.filter = angioray::scene::Filter::Nearest;
    let steps = profile(&[2.0, 8.0, 4.0]);
    let seen = cast_scene(&steps, &scene, at(-1.0), at(9.0)).color;
    let (mut light, mut through) = (0.0, 1.0);
    for (value, length) in [(2.0, 0.5), (8.0, 1.0), (4.0, 0.5)] {
        let t = (1.0 - value / 20.0_f64).powf(length);
        light += through * (1.0 - t) * value / 10.0;
        through *= t;
    }
    assert!(worst(seen, [light, light, light, 1.0 - through]) < 1e-10);
    scene.sampling.filter = angioray::scene::Filter::Linear;
    let linear = cast_scene(&steps, &scene, at(-1.0), at(9.0)).color;
    assert!(worst(linear, [light, light, light, 1.0 - through]) > 1e-4);
}

#[test]
fn sharp_highlights_between_the_nodes_are_found() {
    let mut random = Random(31);
    let phong = Phong {
        shininess: Shininess::new(400.0).unwrap(),
        specular: Reflectance::new(1.0).unwrap(),
        ..Phong::default()
    };
    for _ in 0..40 {
        let noise = random.noise(4, oblique(false), 10.0);
        let ray = random_ray(&mut random, &noise);
        let scene = scene(dvr(bumpy(), Some(phong)));
        let exact = cast_scene(&noise, &scene, ray.0, ray.1).color;
        let light = -(ray.1 - ray.0).normalize();
        let shade = lit_from(&phong, light);
        let brute = |steps: u32| brute_force(&noise, &bumpy(), Some(&shade), ray, steps);
        let off = worst(brute(10_000), exact);
        assert!(off < 1e-6, "{off}");
        assert!(worst(brute(100), exact) > 1e-6);
    }
}

#[test]
fn a_normal_that_turns_abruptly_is_resolved() {
    // ∇Φ = (2 (x − c), δ, 0): in the middle plane it swings from −x to +x within w = δ/2 of c.
    let (c, delta) = (2.375, 2.0_f64.powi(-16));
    let swing = volume([6, 5, 5], Geometry::default(), |p| {
        (p.x - c).powi(2) + delta * p.y
    });
    let phong = Phong {
        ambient: Reflectance::new(0.0).unwrap(),
        diffuse: Reflectance::new(1.0).unwrap(),
        specular: Reflectance::new(0.0).unwrap(),
        ..Phong::default()
    };
    let tf = transfer(&[knot(0.0, [1.0; 3], 0.5)], 1.0);
    let at = |x: f64| DVec3::new(x, 2.0, 2.0);
    let seen = cast(&swing, dvr(tf, Some(phong)), at(-1.0), at(9.0)).color;
    // ∫ 1 − |u|/√(u² + w²) du = 2w is missing from the light of an always facing surface.
    let kappa = 2.0_f64.ln();
    let facing = 1.0 - (-5.0 * kappa).exp();
    let missing = delta * kappa * (-kappa * c).exp();
    assert!(
        (seen[0] - (facing - missing)).abs() < 1e-8,
        "{} {missing}",
        seen[0] - facing
    );
    assert!((seen[0] - facing).abs() > 1e-6);
}
