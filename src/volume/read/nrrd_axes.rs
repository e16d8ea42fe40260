//! What the axes of an NRRD array are: space or frames, and where they lie in the world.

use glam::{DMat3, DVec3};

use super::array::refuse_components;
use super::nrrd::Fields;
use super::text::{exactly, number, numbers};
use crate::error::{Error, Result};
use crate::volume::Geometry;

/// The array's axes, the first fastest.
pub(super) struct Axes {
    /// The sizes, without axes of one entry that are not space.
    pub(super) sizes: Vec<u64>,
    /// The axis that counts frames.
    pub(super) frame_axis: Option<usize>,
    /// The header's axes that are the volume's: at most three.
    space_axes: Vec<usize>,
    /// The header's axis directions; `none` where an axis is not space.
    directions: Option<Vec<Option<Vec<f64>>>>,
}

/// The most axes: NRRD's own limit.
const MAX_AXES: usize = 16;

/// Kinds of axes whose entries are one voxel's components rather than voxels.
fn is_colour(kind: &str) -> bool {
    kind.ends_with("-color")
}

/// Kinds of axes that run through space or say nothing of themselves.
fn is_domain(kind: &str) -> bool {
    matches!(kind, "domain" | "space" | "???" | "none" | "unknown")
}

/// Whether a direction leads anywhere in space. With four components the last is time.
fn is_spatial(direction: &[f64]) -> bool {
    direction.len() != 4 || direction[..3].iter().any(|&component| component != 0.0)
}

/// The kind of each axis, in lower case, if the header gives it.
fn kinds_of(fields: &Fields, dimension: usize) -> Result<Option<Vec<String>>> {
    let kinds: Option<Vec<String>> = fields.get("kinds").map(|kinds| {
        kinds
            .split_whitespace()
            .map(str::to_ascii_lowercase)
            .collect()
    });
    match kinds {
        Some(kinds) if kinds.len() != dimension => Err(Error::input(format!(
            "the NRRD header has {} kinds for {dimension} axes",
            kinds.len()
        ))),
        kinds => Ok(kinds),
    }
}

/// The direction of each axis, `None` for one that is not space, where the header says so.
fn directions_of(fields: &Fields, dimension: usize) -> Result<Option<Vec<Option<Vec<f64>>>>> {
    let directions = fields.get("spacedirections").map(vectors).transpose()?;
    match directions {
        Some(directions) if directions.len() != dimension => Err(Error::input(format!(
            "the NRRD header has {} space directions for {dimension} axes",
            directions.len()
        ))),
        directions => Ok(directions),
    }
}

/// Refuses axes whose entries are the components of colours or vectors.
fn check_components(
    sizes: &[u64],
    kinds: Option<&[String]>,
    has_directions: bool,
    frame_axis: Option<usize>,
) -> Result<()> {
    let kind = |axis: usize| kinds.map_or("", |kinds| &kinds[axis]);
    if let Some(axis) = (0..sizes.len()).find(|&axis| is_colour(kind(axis))) {
        return Err(refuse_components(sizes[axis], None));
    }
    if let Some(axis) = frame_axis
        && matches!(sizes[axis], 3 | 4)
        && (kind(axis).contains("vector") || kind(axis).contains("normal"))
    {
        return Err(refuse_components(sizes[axis], None));
    }
    // Without any word on its axes, few entries first are components: no series is so thin.
    if !has_directions && kinds.is_none() && sizes.len() == 4 && matches!(sizes[0], 3 | 4) {
        return Err(refuse_components(sizes[0], None));
    }
    Ok(())
}

impl Axes {
    pub(super) fn parse(fields: &Fields) -> Result<Self> {
        let dimension: usize = number("dimension", fields.need("dimension")?)?;
        if !(1..=MAX_AXES).contains(&dimension) {
            return Err(Error::input(format!("an NRRD array of {dimension} axes")));
        }
        let sizes: Vec<u64> = exactly("sizes", fields.need("sizes")?, dimension)?;
        let kinds = kinds_of(fields, dimension)?;
        let directions = directions_of(fields, dimension)?;

        let mut space_axes: Vec<usize> = (0..dimension)
            .filter(|&axis| match (&directions, &kinds) {
                (Some(directions), _) => directions[axis].as_deref().is_some_and(is_spatial),
                (None, Some(kinds)) => is_domain(&kinds[axis]),
                (None, None) => true,
            })
            .collect();
        // A fourth axis through space is time, as ITK writes series.
        space_axes.truncate(3);
        let others: Vec<usize> = (0..dimension)
            .filter(|axis| !space_axes.contains(axis) && sizes[*axis] != 1)
            .collect();
        let frame_axis = match others[..] {
            [] => None,
            [axis] => Some(axis),
            _ => {
                return Err(Error::input(format!(
                    "of the NRRD array's {dimension} axes {} are not space: only one may be",
                    others.len()
                )));
            }
        };
        if space_axes.is_empty() {
            return Err(Error::input("no axis of the NRRD array runs through space"));
        }
        check_components(&sizes, kinds.as_deref(), directions.is_some(), frame_axis)?;

        let remaining: Vec<usize> = (0..dimension)
            .filter(|axis| space_axes.contains(axis) || frame_axis == Some(*axis))
            .collect();
        Ok(Self {
            sizes: remaining.iter().map(|&axis| sizes[axis]).collect(),
            frame_axis: frame_axis.and_then(|axis| {
                remaining
                    .iter()
                    .position(|&remaining_axis| remaining_axis == axis)
            }),
            space_axes,
            directions,
        })
    }

    /// The volume's place in mm, LPS. Spaces other than the anatomical three are taken as they are,
    /// as ITK does.
    pub(super) fn geometry(&self, fields: &Fields, notes: &mut Vec<String>) -> Result<Geometry> {
        note_units(fields, notes);
        let mut columns = [DVec3::X, DVec3::Y, DVec3::Z];
        let mut spacing_mm = DVec3::ONE;
        let mut origin = DVec3::ZERO;
        let space = fields.get("space").unwrap_or("");
        if let Some(directions) = &self.directions {
            for (index, &axis) in self.space_axes.iter().enumerate() {
                let Some(vector) = &directions[axis] else {
                    continue;
                };
                let vector = first_three("space directions", vector)?;
                spacing_mm[index] = vector.length();
                columns[index] = vector;
            }
            // A flat image's missing axis stands upright on the others.
            if self.space_axes.len() == 2 {
                columns[2] = columns[0].cross(columns[1]);
            }
        } else if let Some(text) = fields.get("spacings") {
            let spacings: Vec<f64> = numbers("spacings", text)?;
            for (index, &axis) in self.space_axes.iter().enumerate() {
                let spacing = spacings.get(axis).copied().ok_or_else(|| {
                    Error::input(format!("the NRRD header's 'spacings: {text}' are too few"))
                })?;
                // NaN is NRRD's word for unknown.
                if !spacing.is_nan() {
                    spacing_mm[index] = spacing;
                }
            }
        }
        if let Some(text) = fields.get("spaceorigin") {
            origin = match &vectors(text)?[..] {
                [Some(vector)] => first_three("space origin", vector)?,
                _ => {
                    return Err(Error::input(format!(
                        "the NRRD header's 'space origin: {text}' is not one vector"
                    )));
                }
            };
        }
        let lps = DMat3::from_diagonal(lps_signs(space));
        let direction = lps * DMat3::from_cols(columns[0], columns[1], columns[2]);
        Geometry::of_signed_spacing(lps * origin, direction, spacing_mm)
    }
}

/// The signs that take a space's axes to left, posterior, superior.
fn lps_signs(space: &str) -> DVec3 {
    let space = space.to_ascii_lowercase();
    let name = space.strip_suffix("-time").unwrap_or(&space);
    match name {
        "right-anterior-superior" | "ras" | "rast" => DVec3::new(-1.0, -1.0, 1.0),
        "left-anterior-superior" | "las" | "last" => DVec3::new(1.0, -1.0, 1.0),
        _ => DVec3::ONE,
    }
}

/// A vector's components in space: time may stand behind them, and flat images have two.
fn first_three(field: &str, vector: &[f64]) -> Result<DVec3> {
    match *vector {
        [x, y] => Ok(DVec3::new(x, y, 0.0)),
        [x, y, z] | [x, y, z, _] => Ok(DVec3::new(x, y, z)),
        _ => Err(Error::input(format!(
            "the NRRD header's '{field}' have {} components",
            vector.len()
        ))),
    }
}

/// `(1,0,0) none (0, 1, 0)`.
fn vectors(text: &str) -> Result<Vec<Option<Vec<f64>>>> {
    let wrong = || Error::input(format!("the NRRD header's '{text}' are not vectors"));
    let mut found = Vec::new();
    let mut rest = text.trim();
    while !rest.is_empty() {
        if let Some(inside) = rest.strip_prefix('(') {
            let (inside, after) = inside.split_once(')').ok_or_else(wrong)?;
            let vector = inside
                .split(',')
                .map(|component| component.trim().parse().map_err(|_| wrong()))
                .collect::<Result<Vec<f64>>>()?;
            // Some writers say `none` in numbers.
            let is_none = vector.iter().all(|component| component.is_nan());
            found.push((!is_none).then_some(vector));
            rest = after.trim_start();
        } else {
            let rest_after_none = rest.strip_prefix("none").ok_or_else(wrong)?;
            found.push(None);
            rest = rest_after_none.trim_start();
        }
        if found.len() > MAX_AXES {
            return Err(wrong());
        }
    }
    Ok(found)
}

/// Lengths are taken as mm whatever the header calls them, as ITK does; a note says so.
fn note_units(fields: &Fields, notes: &mut Vec<String>) {
    let Some(text) = fields.get("spaceunits") else {
        return;
    };
    let known = [
        "mm",
        "millimeter",
        "millimeters",
        "millimetre",
        "",
        "???",
        "none",
        "s",
    ];
    if let Some(unit) = text
        .split(|c: char| c == '"' || c.is_whitespace())
        .find(|unit| !known.contains(&unit.to_ascii_lowercase().as_str()))
    {
        notes.push(format!("the header's lengths in '{unit}' are taken as mm"));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn vectors_parse_with_blanks_and_none() {
        assert_eq!(
            vectors("none (nan,nan,nan) (1, 0,-2.5) (0,1e1,0)").unwrap(),
            [
                None,
                None,
                Some(vec![1.0, 0.0, -2.5]),
                Some(vec![0.0, 10.0, 0.0])
            ]
        );
        for bad in ["(1,0", "1 0 0", "(a,b,c)", "()"] {
            assert!(vectors(bad).is_err(), "{bad}");
        }
    }
}
