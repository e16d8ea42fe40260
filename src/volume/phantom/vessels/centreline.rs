//! A vessel's centreline between its two ends: smooth, slightly tortuous, with given tangents.

use glam::DVec3;
use rand_pcg::Pcg64;

use super::targets::uniform_box;

/// The ends that a centreline must join.
pub(super) struct Span {
    /// The start, mm from the volume's centre.
    pub start_mm: DVec3,
    /// The end, mm from the volume's centre.
    pub end_mm: DVec3,
    /// The unit tangent at the start.
    pub start_direction: DVec3,
    /// The unit tangent at the end; an open end leaves in the direction it likes.
    pub end_direction: Option<DVec3>,
    /// The line stays in the box of these half edges; start and end lie in it.
    pub half_mm: DVec3,
    /// The customary distance of its points.
    pub step_mm: f64,
}

pub(super) struct Centreline {
    /// The points from start to end, both exact, mm.
    pub points_mm: Vec<DVec3>,
    /// The unit tangent at the end.
    pub end_direction: DVec3,
}

/// How far the line swerves, as a share of its length.
const TORTUOSITY: f64 = 0.5;
/// The end tangents' pull, as a share of the length.
const PULL: f64 = 0.9;
const MAX_PIECES: f64 = 256.0;

/// 1 along the axes in which a box has room, else 0: a flat volume's vessels lie in its plane.
pub(super) fn free_axes(half_mm: DVec3) -> DVec3 {
    DVec3::from_array(half_mm.to_array().map(|h| if h > 0.0 { 1.0 } else { 0.0 }))
}

/// A cubic Hermite curve, plus a random swerve that vanishes at the ends with its slope. Where
/// that leaves the box, both are halved until it does not; the straight chord never does.
pub(super) fn centreline(span: &Span, random: &mut Pcg64) -> Centreline {
    let chord = span.end_mm - span.start_mm;
    let length_mm = chord.length();
    let end_direction = span.end_direction.unwrap_or_else(|| {
        // Mirrored at the chord: the curve of least bending.
        let along = chord.normalize_or(span.start_direction);
        let mirrored = 2.0 * span.start_direction.dot(along) * along - span.start_direction;
        (mirrored + along).normalize_or(along)
    });
    let free = free_axes(span.half_mm);
    let bend = |random: &mut Pcg64| TORTUOSITY * length_mm * free * uniform_box(random);
    let (swerve, swing) = (bend(random), bend(random));
    let pieces = (length_mm / span.step_mm).ceil().clamp(1.0, MAX_PIECES) as usize;

    let curve = |strength: f64| -> Vec<DVec3> {
        let pull = strength * PULL * length_mm;
        (0..=pieces)
            .map(|piece| {
                let s = piece as f64 / pieces as f64;
                let (s2, rest) = (s * s, 1.0 - s);
                let rest2 = rest * rest;
                span.start_mm
                    + chord * (s2 * (3.0 - 2.0 * s))
                    + pull * (s * rest2 * span.start_direction - s2 * rest * end_direction)
                    + strength * s2 * rest2 * 4.0 * (swerve + (2.0 * s - 1.0) * 2.0 * swing)
            })
            .collect()
    };
    let inside = |points: &[DVec3]| {
        let limit = span.half_mm * (1.0 + 1e-9);
        points.iter().all(|p| p.abs().cmple(limit).all())
    };
    let mut points_mm = [1.0, 0.5, 0.25, 0.125, 0.0625]
        .into_iter()
        .map(curve)
        .find(|points| inside(points))
        .unwrap_or_else(|| curve(0.0));
    points_mm[0] = span.start_mm;
    points_mm[pieces] = span.end_mm;
    Centreline {
        points_mm,
        end_direction,
    }
}
