//! The two models of reflection.

use angioray::gpu::Args;
use angioray::scene::Filter;

use super::{Random, U8, build, common, dot, room, run, upload, variant, xyz};

/// Ambient, diffuse, specular, shininess.
const NUMBERS: [f32; 4] = [0.15, 0.7, 0.4, 24.0];

struct Points {
    colors: Vec<[f32; 4]>,
    normals: Vec<[f32; 4]>,
    toward_eye: Vec<[f32; 4]>,
    toward_light: Vec<[f32; 4]>,
}

/// Random points; every fourth is lit by a headlight.
fn points(random: &mut Random) -> Points {
    const COUNT: usize = 4000;
    let mut directions = |_| (0..COUNT).map(|_| random.direction()).collect::<Vec<_>>();
    let [normals, toward_eye, mut toward_light] = std::array::from_fn(&mut directions);
    for light in toward_light.iter_mut().step_by(4) {
        *light = [0.0, 0.0, 0.0, 1.0];
    }
    let mut color = || [0.0; 4].map(|_: f32| random.within(0.0, 1.0));
    Points {
        colors: (0..COUNT).map(|_| color()).collect(),
        normals,
        toward_eye,
        toward_light,
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
            .read("colors", &upload(&device, &points.colors))
            .read("normals", &upload(&device, &points.normals))
            .read("toward_eye", &upload(&device, &points.toward_eye))
            .read("toward_light", &upload(&device, &points.toward_light))
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

impl Model {
    fn number(self) -> u32 {
        let name = match self {
            Self::None => "REFLECTION_NONE",
            Self::Phong => "REFLECTION_PHONG",
            Self::Blinn => "REFLECTION_BLINN_PHONG",
        };
        let options = variant(U8, Filter::Linear, 8).defines().options();
        let value = options.split(&format!("-D {name}=")).nth(1).unwrap();
        let digits = value.split(' ').next().unwrap();
        digits.parse().unwrap()
    }
}

/// Phong 1975: the mirrored light against the eye. Blinn 1977: the halfway vector against the
/// normal. `None`: too near where a side turns away to know which side single precision sees.
fn expected(points: &Points, i: usize, model: Model, two_sided: bool) -> Option<[f64; 3]> {
    let color = xyz(points.colors[i]);
    if model == Model::None {
        return Some(color);
    }
    let [ambient, diffuse, specular, shininess] = NUMBERS.map(f64::from);
    let eye = xyz(points.toward_eye[i]);
    let mut n = xyz(points.normals[i]);
    let headlight = points.toward_light[i][3] > 0.0;
    let light = if headlight {
        eye
    } else {
        xyz(points.toward_light[i])
    };
    if dot(n, eye).abs() < 1e-5 || dot(n, light).abs() < 1e-5 {
        return None;
    }
    if two_sided && dot(n, eye) < 0.0 {
        n = n.map(|c| -c);
    }
    let facing = dot(n, light);
    if facing <= 0.0 {
        return Some(color.map(|c| c * ambient));
    }
    let lobe = if model == Model::Phong {
        let mirrored: [f64; 3] = std::array::from_fn(|a| 2.0 * facing * n[a] - light[a]);
        dot(mirrored, eye)
    } else {
        let halfway: [f64; 3] = std::array::from_fn(|a| light[a] + eye[a]);
        dot(n, halfway) / dot(halfway, halfway).sqrt()
    };
    let shine = specular * lobe.max(0.0).powf(shininess);
    Some(color.map(|c| c * (ambient + diffuse * facing) + shine))
}

fn worst(points: &Points, seen: &[[f32; 4]], model: Model, two_sided: bool) -> f64 {
    let mut worst = 0.0_f64;
    for (i, &seen) in seen.iter().enumerate() {
        if let Some(expected) = expected(points, i, model, two_sided) {
            for (seen, expected) in xyz(seen).iter().zip(expected) {
                worst = worst.max((seen - expected).abs());
            }
        }
    }
    worst
}

#[test]
fn both_models_are_those_of_their_papers() {
    let points = points(&mut Random(3));
    let limit = 2e-5;
    for model in [Model::None, Model::Phong, Model::Blinn] {
        let Some(seen) = on_device(&points, model.number()) else {
            return;
        };
        let error = worst(&points, &seen, model, true);
        assert!(error < limit, "{model:?}: {error}");
        for other in [Model::None, Model::Phong, Model::Blinn] {
            assert!(other == model || worst(&points, &seen, other, true) > limit);
        }
        assert!(model == Model::None || worst(&points, &seen, model, false) > limit);
    }
}
