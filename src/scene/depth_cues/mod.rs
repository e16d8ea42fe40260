//! Depth cues: what a picture's colours tell of how far away things are.

mod cue;
mod range;

pub use cue::{Chromadepth, DepthCue, Edge, Ramp, StepCount, WidthPx};
pub use range::DepthRange;

use super::quantities::{RimPower, Share};
use crate::error::{Error, Result};
use crate::extent::ImageSize;

/// The depth cues of a picture, over the depth of what each ray shows: a surface's hit, the place of an extremum, the mean of a
/// medium. A ray that shows nothing, or no depth, has none.
///
/// d is the share of the way from near to far, 0 to 1, C the colour (linear light, premultiplied), Y its luminance (Rec. 709).
/// Chromadepth makes C + w·(Y·ramp(d) − C), w its strength, times (1 − |n·v|)^P where it is confined to the rim of things, n
/// the normal, v toward the viewer; in N steps d is the middle of its step. Fog multiplies that, opacity included, by 1 − S·d.
/// These two are of each ray.
///
/// Halo and contour are of the picture's pixels, whose depths are those of the rays through their centres. A halo multiplies
/// the light of a pixel by 1 − S·h, h the greatest of (1 − r/(W + 1))·min(1, 5·Δ), r ≤ W the distance in pixels of another
/// one and Δ how much nearer that is, as a share of the range. A contour multiplies it by 1 − S·e, e the greatest of
/// min(1, 50·(δ₀ − 4·max(|δ₁|, |δ₂|))), where that is above 0, over the eight directions from the pixel: on the rim of
/// something that goes on behind it. δ₀ is the second difference of the depths W ahead, here and W behind, as a share of the
/// range, δ₁ and δ₂ those of the depths up to 2W and from W to 3W behind; nothing is infinitely far away, and outside the
/// picture all goes on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DepthCues {
    /// The share of what is farthest that fog takes.
    pub fog: Share,
    /// Colours by depth.
    pub chromadepth: Option<Chromadepth>,
    /// The share of the light that halos take, and how many pixels around something near they reach.
    pub halo: Option<(Share, WidthPx)>,
    /// The share of the light that contours take, and how many pixels wide they are.
    pub contour: Option<(Share, WidthPx)>,
    /// Between which depths near is told from far.
    pub range: DepthRange,
}

impl DepthCues {
    /// What a halo darkens by with the depth, as a share of the range: it is full where something is a fifth of it nearer.
    pub const HALO_SLOPE: u32 = 5;
    /// What a contour darkens by with the second difference of depths, as a share of the range.
    pub const CONTOUR_SLOPE: u32 = 50;
    /// How many times what bends behind it something has to bend to have a contour.
    pub const CONTOUR_EXCESS: u32 = 4;
    /// The rows of a picture for which a halo has one pixel.
    const HALO_ROWS: u32 = 85;
    /// The rows of a picture for which a contour has one pixel.
    const CONTOUR_ROWS: u32 = 700;

    /// The cues that are asked for, widths filled in.
    ///
    /// # Errors
    /// Usage: two of one kind.
    pub fn filled_in(cues: &[DepthCue], size: ImageSize) -> Result<Vec<DepthCue>> {
        for (place, cue) in cues.iter().enumerate() {
            if cues[..place].iter().any(|other| other.kind() == cue.kind()) {
                let kind = cue.kind();
                return Err(Error::usage(format!(
                    "the depth cue '{kind}' is given twice"
                )));
            }
        }
        let wide = |edge: Edge, rows| Edge {
            width: edge.width.or(Some(WidthPx::of_rows(size, rows))),
            ..edge
        };
        let filled = |cue: &DepthCue| match *cue {
            DepthCue::Halo(edge) => DepthCue::Halo(wide(edge, Self::HALO_ROWS)),
            DepthCue::Contour(edge) => DepthCue::Contour(wide(edge, Self::CONTOUR_ROWS)),
            other => other,
        };
        Ok(cues.iter().map(filled).collect())
    }

    /// The cues of a picture of this size.
    ///
    /// # Errors
    /// As [`DepthCues::filled_in`].
    pub fn new(cues: &[DepthCue], range: DepthRange, size: ImageSize) -> Result<Self> {
        let mut all = Self {
            fog: Share::NONE,
            chromadepth: None,
            halo: None,
            contour: None,
            range,
        };
        let drawn = |edge: Edge| edge.width.map(|width| (edge.strength, width));
        for cue in Self::filled_in(cues, size)? {
            match cue {
                DepthCue::Fog(share) => all.fog = share,
                DepthCue::Chromadepth(colors) => all.chromadepth = Some(colors),
                DepthCue::Halo(edge) => all.halo = drawn(edge),
                DepthCue::Contour(edge) => all.contour = drawn(edge),
            }
        }
        Ok(all)
    }

    /// Whether the colours of single rays depend on their depths.
    pub fn tints(&self) -> bool {
        self.fog != Share::NONE || self.chromadepth.is_some()
    }

    /// Whether what is seen beside a pixel decides its light.
    pub fn draws_edges(&self) -> bool {
        self.halo.is_some() || self.contour.is_some()
    }

    /// The exponent of the mask that confines colours to the rim of things, for which normals are needed.
    pub fn rim(&self) -> Option<RimPower> {
        self.chromadepth.and_then(|colors| colors.rim)
    }

    /// The colour of a ray (linear light, premultiplied) by fog and chromadepth: of the depth in mm of what it shows, whose
    /// normal has this cosine with the ray.
    pub fn tinted(&self, color: [f64; 4], depth_mm: f64, cosine: f64) -> [f64; 4] {
        if depth_mm == f64::INFINITY {
            return color;
        }
        let share = self.range.share(depth_mm);
        let [r, g, b, a] = color;
        let tinted = match self.chromadepth {
            None => [r, g, b],
            Some(colors) => {
                let mask = (colors.rim).map_or(1.0, |power| {
                    (1.0 - cosine.abs()).clamp(0.0, 1.0).powf(power.get())
                });
                let weight = colors.strength.get() * mask;
                let light = 0.2126 * r + 0.7152 * g + 0.0722 * b;
                let ramp = colors.ramp.color(colors.stepped(share));
                let mixed =
                    |channel: f64, of_depth: f64| channel + weight * (light * of_depth - channel);
                [mixed(r, ramp[0]), mixed(g, ramp[1]), mixed(b, ramp[2])]
            }
        };
        let kept = 1.0 - self.fog.get() * share;
        let [r, g, b] = tinted;
        [r, g, b, a].map(|channel| channel * kept)
    }

    /// The share of a pixel's light that halos and contours keep, by the depths in mm of the pixels so many columns and rows
    /// beside it; `None`: outside the picture, +∞: nothing is seen.
    pub fn kept(&self, depth_mm: impl Fn(i64, i64) -> Option<f64>) -> f64 {
        let here = depth_mm(0, 0).unwrap_or(f64::INFINITY);
        if here == f64::INFINITY {
            return 1.0;
        }
        let width_mm = self.range.far_mm() - self.range.near_mm();
        let mut kept = 1.0;
        if let Some((strength, width)) = self.halo {
            let reach = i64::from(width.get());
            let beside = (-reach..=reach).flat_map(|y| (-reach..=reach).map(move |x| (x, y)));
            let dark = beside.fold(0.0, |dark: f64, (x, y)| {
                let distance = ((x * x + y * y) as f64).sqrt();
                let nearer_mm = here - depth_mm(x, y).unwrap_or(f64::INFINITY);
                let share = (f64::from(Self::HALO_SLOPE) * nearer_mm / width_mm).clamp(0.0, 1.0);
                dark.max((1.0 - distance / (reach + 1) as f64).max(0.0) * share)
            });
            kept *= 1.0 - strength.get() * dark;
        }
        if let Some((strength, width)) = self.contour {
            let w = i64::from(width.get());
            let darkness = |bend_mm: f64| {
                (f64::from(Self::CONTOUR_SLOPE) * bend_mm / width_mm).clamp(0.0, 1.0)
            };
            let dark = DIRECTIONS.iter().fold(0.0, |dark: f64, (x, y)| {
                let at = |steps: i64| depth_mm(steps * w * x, steps * w * y);
                let bend = |steps: i64| match (at(steps - 1), at(steps), at(steps + 1)) {
                    (Some(a), Some(b), Some(c)) if b < f64::INFINITY => a + c - 2.0 * b,
                    (Some(_), Some(_), Some(_)) => f64::INFINITY,
                    _ => 0.0,
                };
                let behind = bend(-1).abs().max(bend(-2).abs());
                match behind < f64::INFINITY {
                    true => dark.max(darkness(bend(0) - f64::from(Self::CONTOUR_EXCESS) * behind)),
                    false => dark,
                }
            });
            kept *= 1.0 - strength.get() * dark;
        }
        kept
    }
}

/// The eight directions from a pixel, in columns and rows.
const DIRECTIONS: [(i64, i64); 8] = [
    (1, 0),
    (1, 1),
    (0, 1),
    (-1, 1),
    (-1, 0),
    (-1, -1),
    (0, -1),
    (1, -1),
];

#[cfg(test)]
mod tests {
    use super::*;

    fn cues(texts: &[&str]) -> DepthCues {
        let cues: Vec<DepthCue> = texts.iter().map(|text| text.parse().unwrap()).collect();
        let range = DepthRange::new(100.0, 200.0).unwrap();
        DepthCues::new(&cues, range, ImageSize::new(64, 64).unwrap()).unwrap()
    }

    #[test]
    fn a_kind_is_given_once_and_widths_follow_the_height() {
        let parsed = ["halo:1", "contour:1"].map(|text| text.parse::<DepthCue>().unwrap());
        let size = ImageSize::new(100, 1400).unwrap();
        let filled = DepthCues::filled_in(&parsed, size).unwrap();
        let texts: Vec<String> = filled.iter().map(DepthCue::to_string).collect();
        assert_eq!(texts, ["halo:1,width=16", "contour:1,width=2"]);
        let twice = [parsed[0], parsed[0]];
        let refused = DepthCues::filled_in(&twice, size).unwrap_err().to_string();
        assert!(refused.contains("'halo' is given twice"), "{refused}");
    }

    #[test]
    fn fog_and_colours_follow_the_depth() {
        let white = [1.0; 4];
        let fog = cues(&["fog:0.8"]);
        assert_eq!(fog.tinted(white, 50.0, 0.0), white);
        assert!((fog.tinted(white, 150.0, 0.0)[3] - 0.6).abs() < 1e-12);
        assert!((fog.tinted(white, 900.0, 0.0)[0] - 0.2).abs() < 1e-12);
        // Where nothing is seen there is nothing to fade.
        assert_eq!(fog.tinted([0.0; 4], f64::INFINITY, 0.0), [0.0; 4]);

        let colors = cues(&["chromadepth:1"]);
        let green = colors.tinted([0.5, 0.5, 0.5, 1.0], 150.0, 0.0);
        assert!((green[1] - 0.5).abs() < 1e-12 && green[0].abs() < 1e-12 && green[3] == 1.0);
        // Two steps: the middles of the nearer and of the farther half.
        let two = cues(&["chromadepth:1,steps=2"]);
        let yellow = two.tinted(white, 149.0, 0.0);
        assert!((yellow[0] - 1.0).abs() < 1e-12 && (yellow[1] - 1.0).abs() < 1e-12);
        assert_eq!(two.tinted(white, 101.0, 0.0), yellow);
        assert_ne!(two.tinted(white, 151.0, 0.0), yellow);
        // At the rim alone: what is faced keeps its colour.
        let rim = cues(&["chromadepth:1,rim=2"]);
        assert_eq!(rim.tinted(white, 100.0, -1.0), white);
        let [r, g, b, a] = rim.tinted(white, 100.0, 0.0);
        assert!((r - 1.0).abs() < 1e-12 && g.abs() < 1e-12 && b.abs() < 1e-12 && a == 1.0);
    }

    /// A row of pixels: something near up to column 0, something far from column 1 on, nothing from column 9 on.
    fn row(column: i64, reach: i64) -> impl Fn(i64, i64) -> Option<f64> {
        move |x, _| match column + x {
            at if at < -reach => None,
            at if at <= 0 => Some(110.0),
            at if at <= 8 => Some(150.0),
            _ => Some(f64::INFINITY),
        }
    }

    #[test]
    fn halos_fall_off_around_what_is_nearer() {
        let halo = cues(&["halo:0.5,width=4"]);
        for (column, distance) in [(1, 1.0), (2, 2.0), (4, 4.0)] {
            let expected = 1.0 - 0.5 * (1.0 - distance / 5.0);
            assert!((halo.kept(row(column, 40)) - expected).abs() < 1e-12);
        }
        // What is near has none, what is farther away than their width neither, and nothing stays nothing.
        for column in [0, 5, 8, 9] {
            assert_eq!(halo.kept(row(column, 40)), 1.0, "{column}");
        }
        // Depths that differ by less than a fifth of the range: a part of it.
        let some = halo.kept(|x, _| Some(if x < 0 { 140.0 } else { 150.0 }));
        assert!((some - (1.0 - 0.5 * 0.8 * 0.5)).abs() < 1e-12);
    }

    #[test]
    fn contours_are_on_the_nearer_side_of_a_gap() {
        let contour = cues(&["contour:1,width=1"]);
        for (column, kept) in [(-1, 1.0), (0, 0.0), (1, 1.0), (7, 1.0), (8, 0.0), (9, 1.0)] {
            assert_eq!(contour.kept(row(column, 40)), kept, "{column}");
        }
        // What is less than four pixels wide is not drawn over.
        let thin = |wide: i64| {
            let at = move |x: i64| {
                Some(if (0..wide).contains(&x) {
                    110.0
                } else {
                    f64::INFINITY
                })
            };
            (0..wide).map(move |column| contour.kept(move |x, _| at(column + x)))
        };
        assert!(thin(3).all(|kept| kept == 1.0));
        assert_eq!(thin(4).collect::<Vec<f64>>(), [0.0, 1.0, 1.0, 0.0]);
        // Slanted planes have none, whatever their slope, nor has the picture's own edge.
        assert_eq!(
            contour.kept(|x, y| Some(150.0 + 9.0 * x as f64 - 3.0 * y as f64)),
            1.0
        );
        assert_eq!(contour.kept(row(0, 0)), 1.0);
        assert_eq!(contour.kept(row(0, 1)), 0.0);
        assert_eq!(
            contour.kept(|x, y| (x >= 0 && y >= 0).then_some(150.0)),
            1.0
        );
    }
}
