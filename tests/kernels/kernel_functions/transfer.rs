//! The transfer function and the absorption of an opacity.

use angioray::gpu::Args;
use angioray::scene::{Filter, TransferFunction};

use super::{Random, U8, build, common, room, run, upload, variant};

#[derive(Clone)]
struct Knots {
    values: Vec<f32>,
    colors: Vec<[f32; 4]>,
}

impl Knots {
    /// Random colours at ascending values.
    fn at(values: Vec<f32>, random: &mut Random) -> Self {
        let colors = values
            .iter()
            .map(|_| std::array::from_fn(|_| random.within(0.0, 1.0)))
            .collect();
        Self { values, colors }
    }

    /// Linear between the last knot at or below the value and the next one.
    fn color(&self, value: f32) -> [f64; 4] {
        let below = self.values.iter().rposition(|&knot| knot <= value);
        self.between(below, value)
    }

    /// The same, but of knots at one value the earlier holds: wrong.
    fn color_before_jump(&self, value: f32) -> [f64; 4] {
        let below = self.values.iter().rposition(|&knot| knot < value);
        self.between(below, value)
    }

    fn between(&self, below: Option<usize>, value: f32) -> [f64; 4] {
        let last = self.values.len() - 1;
        match below {
            None => self.colors[0].map(f64::from),
            Some(below) if below == last => self.colors[last].map(f64::from),
            Some(below) => {
                let [a, b, value] =
                    [self.values[below], self.values[below + 1], value].map(f64::from);
                let f = (value - a) / (b - a);
                std::array::from_fn(|c| {
                    let [a, b] = [self.colors[below][c], self.colors[below + 1][c]].map(f64::from);
                    a * (1.0 - f) + b * f
                })
            }
        }
    }
}

fn on_device(knots: &Knots, values: &[f32]) -> Option<Vec<[f32; 4]>> {
    let device = common::device()?;
    let pass = build("transfer", variant(U8, Filter::Linear, 8));
    let mut colors = room(&device, values.len());
    run(
        &device,
        &pass,
        Args::new()
            .value("count", &(values.len() as u32))
            .value("knots", &(knots.values.len() as u32))
            .read("knot_values", &upload(&device, &knots.values))
            .read("knot_colors", &upload(&device, &knots.colors))
            .read("values", &upload(&device, values))
            .write("colors", &mut colors),
        values.len(),
    );
    Some(colors.download(&device).unwrap())
}

fn worst(values: &[f32], got: &[[f32; 4]], expected: impl Fn(f32) -> [f64; 4]) -> f64 {
    let mut worst = 0.0_f64;
    for (&v, got) in values.iter().zip(got) {
        for (got, expected) in got.iter().zip(expected(v)) {
            worst = worst.max((f64::from(*got) - expected).abs());
        }
    }
    worst
}

/// Every knot, its neighbours in single precision, and values between, below and above all.
fn values_about(knots: &Knots, random: &mut Random) -> Vec<f32> {
    let (low, high) = (knots.values[0], knots.values[knots.values.len() - 1]);
    let mut values = vec![low - 1.0, high + 1.0, -1e30, 1e30, f32::INFINITY];
    for &knot in &knots.values {
        values.extend([knot, knot.next_down(), knot.next_up()]);
    }
    let around = || random.within(f64::from(low) - 1.0, f64::from(high) + 1.0);
    values.extend(std::iter::repeat_with(around).take(2000));
    values
}

const LIMIT: f64 = 1e-6;

#[test]
fn colours_are_linear_between_knots_and_jump_at_double_ones() {
    let mut random = Random(1);
    let jumps = vec![-3.0, -3.0, 0.0, 0.5, 0.5, 0.5, 7.0, 7.0];
    let mut many: Vec<f32> = (0..4096).map(|_| random.within(-1000.0, 3000.0)).collect();
    many.sort_by(f32::total_cmp);
    for values in [
        vec![2.0],
        vec![2.0, 2.0],
        vec![0.0, 1.0],
        jumps.clone(),
        many,
    ] {
        let knots = Knots::at(values, &mut random);
        let values = values_about(&knots, &mut random);
        let Some(got) = on_device(&knots, &values) else {
            return;
        };
        let error = worst(&values, &got, |v| knots.color(v));
        assert!(error < LIMIT, "{} knots: {error}", knots.values.len());
    }
    let knots = Knots::at(jumps, &mut random);
    let values = values_about(&knots, &mut random);
    let Some(got) = on_device(&knots, &values) else {
        return;
    };
    assert!(worst(&values, &got, |v| knots.color_before_jump(v)) > LIMIT);
    let mut moved = knots.clone();
    moved.values[3] += 0.01;
    moved.values[3] = moved.values[3].min(0.5);
    moved.colors[2][3] += 0.01;
    assert!(worst(&values, &got, |v| moved.color(v)) > LIMIT);
}

#[test]
fn absorption_keeps_the_digits_of_small_opacities() {
    let Some(device) = common::device() else {
        return;
    };
    let mut opacities: Vec<f32> = (0..=700)
        .map(|i| 10f32.powf(-7.0 + i as f32 / 100.0))
        .collect();
    opacities.extend([0.0, 0.5, 0.999, 0.999_999, 1.0f32.next_down(), 1.0]);
    let unit_length_mm = 2.5f32;
    let max = -(-TransferFunction::MAX_OPACITY).ln_1p() as f32;
    let pass = build("absorption", variant(U8, Filter::Linear, 8));
    let mut per_mm = room::<f32>(&device, opacities.len());
    run(
        &device,
        &pass,
        Args::new()
            .value("count", &(opacities.len() as u32))
            .value("unit_length_mm", &unit_length_mm)
            .value("max_absorption", &max)
            .read("opacities", &upload(&device, &opacities))
            .write("per_mm", &mut per_mm),
        opacities.len(),
    );
    let per_mm = per_mm.download(&device).unwrap();

    let expected = |opacity: f32| {
        let absorption = -(-f64::from(opacity)).ln_1p();
        absorption.min(f64::from(max)) / f64::from(unit_length_mm)
    };
    let worst = |got: &dyn Fn(usize) -> f32| {
        let error = |i: usize| {
            let expected = expected(opacities[i]);
            (f64::from(got(i)) - expected).abs() / expected.max(1e-30)
        };
        (0..opacities.len()).map(error).fold(0.0, f64::max)
    };
    let error = worst(&|i| per_mm[i]);
    assert!(error < 1e-6, "{error}");
    // What the logarithm of 1 − opacity in single precision gives is refused.
    let naive = |i: usize| (-(1.0 - opacities[i]).ln()).min(max) / unit_length_mm;
    assert!(worst(&naive) > 1e-3);
}
