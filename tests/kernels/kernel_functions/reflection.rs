//! The two models of reflection, under two lights.

use angioray::gpu::Args;
use angioray::scene::Filter;

use super::{Random, U8, build, common, dot, room, run, upload, variant, xyz};

/// Ambient, diffuse, specular, shininess.
const NUMBERS: [f32; 4] = [0.15, 0.7, 0.4, 24.0];
/// The lights' colours: the second's is at the eye.
const FIRST: [f32; 4] = [1.0, 0.5, 0.25, 0.0];
const SECOND: [f32; 4] = [0.0, 0.3, 0.6, 0.0];

/// As `LightFrom` is numbered in the kernels' constants.
const FROM_EYE: f32 = 0.0;
const FROM_DIRECTION: f32 = 1.0;
const FROM_POINT: f32 = 2.0;

struct Points {
    colors: Vec<[f32; 4]>,
    normals: Vec<[f32; 4]>,
    toward_eye: Vec<[f32; 4]>,
    /// The first light's, seen from the point.
    places: Vec<[f32; 4]>,
}

/// Random points; every fourth is lit by a headlight, every third of the others from a point, some by one at the
/// point itself.
fn points(random: &mut Random) -> Points {
    const COUNT: usize = 4000;
    let mut directions = |_| (0..COUNT).map(|_| random.direction()).collect::<Vec<_>>();
    let [normals, toward_eye, mut places] = std::array::from_fn(&mut directions);
    for (n, place) in places.iter_mut().enumerate() {
        let [x, y, z, _] = *place;
        *place = match n {
            n if n % 4 == 0 => [0.0, 0.0, 0.0, FROM_EYE],
            n if n % 33 == 0 => [0.0, 0.0, 0.0, FROM_POINT],
            n if n % 3 == 0 => [1e-20 * x, 1e-20 * y, 1e-20 * z, FROM_POINT],
            n if n % 3 == 1 => [70.0 * x, 70.0 * y, 70.0 * z, FROM_POINT],
            _ => [x, y, z, FROM_DIRECTION],
        };
    }
    let mut color = || [0.0; 4].map(|_: f32| random.within(0.0, 1.0));
    Points {
        colors: (0..COUNT).map(|_| color()).collect(),
        normals,
        toward_eye,
        places,
    }
}

fn on_device(points: &Points, model: u32) -> Option<Vec<[f32; 4]>> {
    let device = common::device()?;
    let count = points.colors.len();
    let pass = build("reflection", variant(U8, Filter::Linear, 8));
    let mut seen = room(&device, count);
    run(
        &device,
        &pass,
        Args::new()
            .value("count", &(count as u32))
            .value("model", &model)
            .value("numbers", &NUMBERS)
            .value("first", &FIRST)
            .value("second", &SECOND)
            .read("colors", &upload(&device, &points.colors))
            .read("normals", &upload(&device, &points.normals))
            .read("toward_eye", &upload(&device, &points.toward_eye))
            .read("places", &upload(&device, &points.places))
            .write("seen", &mut seen),
        count,
    );
    Some(seen.download(&device).unwrap())
}

/// As `Reflection` numbers them in the kernels' constants.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Model {
    None,
    Phong,
    Blinn,
}

/// The number of a constant of the kernels.
fn constant(name: &str) -> u32 {
    let options = variant(U8, Filter::Linear, 8).defines().options();
    let value = options.split(&format!("-D {name}=")).nth(1).unwrap();
    let digits = value.split(' ').next().unwrap();
    digits.parse().unwrap()
}

impl Model {
    fn number(self) -> u32 {
        constant(match self {
            Self::None => "REFLECTION_NONE",
            Self::Phong => "REFLECTION_PHONG",
            Self::Blinn => "REFLECTION_BLINN_PHONG",
        })
    }
}

/// n·l and the specular term under one light. `None`: too near where a side turns away to know which side single
/// precision sees.
fn under(
    light: [f64; 3],
    eye: [f64; 3],
    normal: [f64; 3],
    model: Model,
    two_sided: bool,
) -> Option<(f64, f64)> {
    if dot(normal, eye).abs() < 1e-5 || dot(normal, light).abs() < 1e-5 {
        return None;
    }
    let n = if two_sided && dot(normal, eye) < 0.0 {
        normal.map(|c| -c)
    } else {
        normal
    };
    let facing = dot(n, light);
    if facing <= 0.0 {
        return Some((0.0, 0.0));
    }
    let lobe = if model == Model::Phong {
        let mirrored: [f64; 3] = std::array::from_fn(|a| 2.0 * facing * n[a] - light[a]);
        dot(mirrored, eye)
    } else {
        let halfway: [f64; 3] = std::array::from_fn(|a| light[a] + eye[a]);
        dot(n, halfway) / dot(halfway, halfway).sqrt()
    };
    Some((facing, lobe.max(0.0).powf(f64::from(NUMBERS[3]))))
}

/// Phong 1975: the mirrored light against the eye. Blinn 1977: the halfway vector against the
/// normal. The sum over `lights` of the two.
fn expected(
    points: &Points,
    i: usize,
    model: Model,
    two_sided: bool,
    lights: usize,
) -> Option<[f64; 3]> {
    let color = xyz(points.colors[i]);
    if model == Model::None {
        return Some(color);
    }
    let [ambient, diffuse, specular, _] = NUMBERS.map(f64::from);
    let eye = xyz(points.toward_eye[i]);
    let place = xyz(points.places[i]);
    let far = dot(place, place).sqrt();
    let first = if far > 0.0 {
        place.map(|c| c / far)
    } else {
        eye
    };
    let mut sum = color.map(|c| c * ambient);
    for (light, tint) in [(first, FIRST), (eye, SECOND)].into_iter().take(lights) {
        let (facing, lobe) = under(light, eye, xyz(points.normals[i]), model, two_sided)?;
        let tint = xyz(tint);
        for c in 0..3 {
            sum[c] += tint[c] * (color[c] * diffuse * facing + specular * lobe);
        }
    }
    Some(sum)
}

fn worst(points: &Points, seen: &[[f32; 4]], model: Model, two_sided: bool, lights: usize) -> f64 {
    let mut worst = 0.0_f64;
    for (i, &seen) in seen.iter().enumerate() {
        if let Some(expected) = expected(points, i, model, two_sided, lights) {
            for (seen, expected) in xyz(seen).iter().zip(expected) {
                worst = worst.max((seen - expected).abs());
            }
        }
    }
    worst
}

#[test]
fn both_models_are_those_of_their_papers_and_lights_are_added() {
    let points = points(&mut Random(3));
    let limit = 2e-5;
    for model in [Model::None, Model::Phong, Model::Blinn] {
        let Some(seen) = on_device(&points, model.number()) else {
            return;
        };
        let error = worst(&points, &seen, model, true, 2);
        assert!(error < limit, "{model:?}: {error}");
        for other in [Model::None, Model::Phong, Model::Blinn] {
            assert!(other == model || worst(&points, &seen, other, true, 2) > limit);
        }
        assert!(model == Model::None || worst(&points, &seen, model, false, 2) > limit);
        assert!(model == Model::None || worst(&points, &seen, model, true, 1) > limit);
    }
}

#[test]
fn lights_are_numbered_as_the_kernels_number_them() {
    let named = [
        ("LIGHT_FROM_EYE", FROM_EYE),
        ("LIGHT_FROM_DIRECTION", FROM_DIRECTION),
        ("LIGHT_FROM_POINT", FROM_POINT),
    ];
    for (name, number) in named {
        assert_eq!(constant(name) as f32, number, "{name}");
    }
}
