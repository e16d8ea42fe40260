//! The content of pictures: the cells that can show something, and the sphere around them.

use glam::{DAffine3, DVec3};
use rayon::prelude::*;

use crate::error::Result;
use crate::render::abi::{StoredIso, stored};
use crate::render::resources::Knots;
use crate::scene::{Filter, Picture, Projection};
use crate::subject::{Content, Corners, Sphere};
use crate::volume::Volume;

use super::cells::may_cross;
use super::opacity_ranges::OpacityRanges;
use super::rows::Rows;

/// The bounds of everything that pictures, each with its filter, can show of a volume: the box, along the voxel axes, around
/// all cells that can show something, and the sphere about the box's centre around them. Where nothing can, or all of the
/// volume, they are the volume's.
///
/// A surface is shown by the cells whose values the iso value parts and, with caps, by those at or above it at
/// the volume's faces; a medium by those that hold a value that absorbs; a maximum (`mip`, `lmip`) by those
/// that exceed the lower end of the window. With the nearest filter a cell is a voxel's own box. All of the
/// volume is shown by a minimum and by a mean. Clip planes are no part of it.
///
/// # Errors
/// Not enough memory.
pub fn content(volume: &Volume, shown: &[(Picture, Filter)]) -> Result<Content> {
    let whole = Content::of(volume);
    let mut contents = Vec::new();
    for (picture, filter) in shown {
        let Some(rows) = shown_rows(volume, picture, *filter)? else {
            return Ok(whole);
        };
        contents.push(rows);
    }
    let world_from_index = volume.geometry().world_from_index();
    Ok(around(&contents, world_from_index).unwrap_or(whole))
}

/// The cells of which a picture can show something, row by row; `None`: it shows all of the volume.
fn shown_rows(volume: &Volume, picture: &Picture, filter: Filter) -> Result<Option<Rows>> {
    let rows = match picture {
        // The first cell of a row that has a corner inside has one outside, or is at the volume's face.
        Picture::Surface {
            iso, caps: true, ..
        } => {
            let iso = StoredIso::nearest(volume.rescale(), *iso);
            Rows::that_hold(volume, filter, |[_, max]| may_be_inside(max, iso))
        }
        Picture::Surface { iso, .. } => {
            let iso = StoredIso::nearest(volume.rescale(), *iso);
            match filter {
                Filter::Linear => Rows::that_hold(volume, filter, |range| may_cross(range, iso)),
                Filter::Nearest => Rows::at_steps(volume, |value| may_be_inside(value, iso)),
            }
        }
        Picture::Projection { of, window } => match of {
            Projection::Maximum | Projection::LocalMaximum { .. } => {
                let floor = stored(volume.rescale(), window.range().min);
                Rows::that_hold(volume, filter, |[_, max]| max > floor)
            }
            Projection::Minimum | Projection::Mean => return Ok(None),
        },
        Picture::Emission(emission) => {
            let knots = Knots::of(&emission.transfer, volume);
            let ranges = OpacityRanges::new(&knots);
            Rows::that_hold(volume, filter, |[min, max]| ranges.absorbs(min, max))
        }
    };
    rows.map(Some)
}

/// Whether a value may be inside a surface, as the kernels find its side.
fn may_be_inside(value: f32, iso: StoredIso) -> bool {
    value - iso.value >= -iso.error
}

/// What holds the cells of all rows; `None` where there are none.
fn around(contents: &[Rows], world_from_index: DAffine3) -> Option<Content> {
    let boxes = || contents.par_iter().flat_map(Rows::boxes);
    let join = |a: [DVec3; 2], b: [DVec3; 2]| [a[0].min(b[0]), a[1].max(b[1])];
    let [least, greatest] = boxes().reduce_with(join)?;
    let center_world = world_from_index.transform_point3((least + greatest) * 0.5);
    let in_world = |corner| world_from_index.transform_point3(corner);
    let farthest = |[least, greatest]: [DVec3; 2]| {
        let corners = Corners::between(least, greatest, in_world).0;
        let distances = corners.map(|corner| corner.distance(center_world));
        distances.into_iter().fold(0.0, f64::max)
    };
    let radius_mm = boxes().map(farthest).reduce(|| 0.0, f64::max);
    Some(Content {
        sphere: Sphere {
            center_world,
            radius_mm,
        },
        corners: Corners::between(least, greatest, in_world),
    })
}

#[cfg(test)]
mod tests {
    use glam::{DMat3, DQuat};

    use super::*;
    use crate::extent::{Dims, Range};
    use crate::scene::{Emission, Knot, Refine, Rgb, SrgbColor, TransferFunction, Window};
    use crate::volume::{Geometry, NonFinite, Rescale, Voxels};

    const ISO: f64 = 127.5;
    const CALIBRATION: Rescale = Rescale {
        slope: 0.5,
        intercept: 20.0,
    };
    /// Rows shorter and longer than a block of cells, and axes with one voxel.
    const SIZES: [[u64; 3]; 7] = [
        [9, 10, 11],
        [150, 5, 4],
        [1, 20, 9],
        [70, 1, 6],
        [13, 1, 1],
        [1, 1, 1],
        [64, 3, 2],
    ];

    fn surface(caps: bool) -> Picture {
        Picture::Surface {
            iso: ISO,
            caps,
            refine: Refine::default(),
            color: SrgbColor::IVORY.linear(),
            phong: None,
        }
    }

    fn projection(of: Projection) -> Picture {
        let window = Window::new(ISO, 160.0).unwrap();
        Picture::Projection { of, window }
    }

    /// Absorbs from 100 to 118, and above 127.5.
    fn medium() -> Picture {
        let points = [
            (100.0, 0.0),
            (110.0, 0.4),
            (118.0, 0.0),
            (ISO, 0.0),
            (140.0, 0.3),
        ];
        let knots = points.map(|(value, opacity)| Knot {
            value,
            color: Rgb([1.0; 3]),
            opacity,
        });
        let transfer = TransferFunction::new(knots.to_vec(), 1.0).unwrap();
        Picture::Emission(Emission::of(transfer))
    }

    /// Every picture with a content of its own.
    fn pictures() -> [Picture; 5] {
        let lmip = Projection::LocalMaximum { threshold: 130.0 };
        let maximum = projection(Projection::Maximum);
        [
            surface(true),
            surface(false),
            maximum,
            projection(lmip),
            medium(),
        ]
    }

    fn oblique() -> Geometry {
        let turn = DQuat::from_scaled_axis(DVec3::new(0.3, -0.8, 0.5));
        let spacing_mm = DVec3::new(0.5, 2.0, 1.3);
        Geometry::new(
            DVec3::new(40.0, -7.0, 3.0),
            DMat3::from_quat(turn),
            spacing_mm,
        )
        .unwrap()
    }

    fn volume(dims: [u64; 3], voxels: impl Into<Voxels>) -> Volume {
        let dims = Dims::new(dims).unwrap();
        Volume::new(
            dims,
            voxels.into(),
            oblique(),
            CALIBRATION,
            NonFinite::Replace,
        )
        .unwrap()
    }

    /// Stored values, most from 0 to 59, those of one voxel in `one_in` from 160 to 255.
    fn sparse(dims: [u64; 3], one_in: u64, seed: u64) -> Vec<u8> {
        let hash = |i: u64| (i + 1 + seed * 7919).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 32;
        let value = |i: u64| match hash(hash(i)) % one_in {
            0 => (160 + hash(i + 977) % 96) as u8,
            _ => (hash(i) % 60) as u8,
        };
        (0..dims.iter().product()).map(value).collect()
    }

    /// A cell's values: between its corners, or a voxel's own; and those beside it where a surface may end.
    struct Cell {
        values: Range,
        at_face: bool,
        /// With the nearest filter: the least value of the voxels that share a face with it.
        least_beside: Option<f64>,
    }

    impl Cell {
        /// By definition, in double precision.
        fn shows(&self, picture: &Picture) -> bool {
            let Range { min, max } = self.values;
            match picture {
                Picture::Surface { caps, .. } => {
                    let least = self.least_beside.unwrap_or(min);
                    let is_parted = max >= ISO && least < ISO;
                    is_parted || *caps && self.at_face && max >= ISO
                }
                Picture::Projection { .. } => max > ISO,
                Picture::Emission(_) => max > 100.0 && min < 118.0 || max > ISO,
            }
        }
    }

    /// Where a cell of `n` voxels begins and ends, and the voxels that it touches, along an axis.
    fn along(n: usize, at: usize, filter: Filter) -> ([f64; 2], [usize; 2]) {
        let last = n as f64 - 1.0;
        let at_f64 = at as f64;
        match filter {
            _ if n == 1 => ([-0.5, 0.5], [0, 0]),
            Filter::Linear => ([at_f64, at_f64 + 1.0], [at, at + 1]),
            Filter::Nearest => (
                [(at_f64 - 0.5).max(0.0), (at_f64 + 0.5).min(last)],
                [at, at],
            ),
        }
    }

    /// The corners (index space) of every cell that shows something.
    fn shown_corners(volume: &Volume, picture: &Picture, filter: Filter) -> Vec<DVec3> {
        let n = volume.dims().array().map(|n| n as usize);
        let value = |[x, y, z]: [usize; 3]| {
            let stored = volume.voxels().stored((z * n[1] + y) * n[0] + x);
            volume.rescale().physical(stored)
        };
        let cells = match filter {
            Filter::Linear => n.map(|n| (n - 1).max(1)),
            Filter::Nearest => n,
        };
        let mut corners = Vec::new();
        for cell in 0..cells.iter().product() {
            let at = [
                cell % cells[0],
                cell / cells[0] % cells[1],
                cell / (cells[0] * cells[1]),
            ];
            let axes = [0, 1, 2].map(|axis| along(n[axis], at[axis], filter));
            let corner = |c: usize| [0, 1, 2].map(|axis| axes[axis].1[c >> axis & 1]);
            let values = (0..8).map(|c| value(corner(c)));
            let beside = (0..6).filter_map(|side| {
                let mut beside = at;
                let axis = side / 2;
                let moved = beside[axis].checked_add_signed([-1, 1][side % 2]);
                beside[axis] = moved.filter(|moved| *moved < n[axis])?;
                Some(value(beside))
            });
            let cell = Cell {
                values: Range {
                    min: values.clone().fold(f64::INFINITY, f64::min),
                    max: values.fold(f64::NEG_INFINITY, f64::max),
                },
                at_face: (0..3).any(|axis| at[axis] == 0 || at[axis] + 1 == cells[axis]),
                least_beside: (filter == Filter::Nearest)
                    .then(|| beside.fold(f64::INFINITY, f64::min)),
            };
            if cell.shows(picture) {
                let place = |c: usize| [0, 1, 2].map(|axis| axes[axis].0[c >> axis & 1]);
                corners.extend((0..8).map(|c| DVec3::from_array(place(c))));
            }
        }
        corners
    }

    /// The sphere about the middle of the corners' box that just holds them; the volume's around none.
    fn sphere_of(volume: &Volume, corners: &[DVec3]) -> Sphere {
        let Some(&first) = corners.first() else {
            return volume.bounding_sphere().into();
        };
        let least = corners.iter().fold(first, |a, b| a.min(*b));
        let greatest = corners.iter().fold(first, |a, b| a.max(*b));
        let world_from_index = volume.geometry().world_from_index();
        let center_world = world_from_index.transform_point3((least + greatest) / 2.0);
        let corners = corners
            .iter()
            .map(|p| world_from_index.transform_point3(*p));
        Sphere {
            center_world,
            radius_mm: corners
                .map(|p| p.distance(center_world))
                .fold(0.0, f64::max),
        }
    }

    fn same(a: Sphere, b: Sphere) -> bool {
        a.center_world.distance(b.center_world) < 1e-9 && (a.radius_mm - b.radius_mm).abs() < 1e-9
    }

    fn content_of(volume: &Volume, picture: &Picture, filter: Filter) -> Sphere {
        content(volume, &[(picture.clone(), filter)])
            .unwrap()
            .sphere
    }

    #[test]
    fn the_sphere_is_around_the_cells_that_show_something() {
        let (mut compared, mut smaller, mut by_other_cells) = (0, 0, 0);
        for dims in SIZES {
            let count: u64 = dims.iter().product();
            for (part, seed) in [
                (3, 1),
                (count / 20, 2),
                (count / 5, 3),
                (count / 5, 4),
                (count, 5),
            ] {
                let stored = sparse(dims, part.max(1), seed);
                let as_i16: Vec<i16> = stored.iter().map(|v| i16::from(*v)).collect();
                let as_f32: Vec<f32> = stored.iter().map(|v| f32::from(*v)).collect();
                for volume in [
                    volume(dims, stored),
                    volume(dims, as_i16),
                    volume(dims, as_f32),
                ] {
                    for (picture, filter) in pictures().iter().flat_map(|picture| {
                        [Filter::Linear, Filter::Nearest].map(|filter| (picture, filter))
                    }) {
                        let found = content_of(&volume, picture, filter);
                        let corners = shown_corners(&volume, picture, filter);
                        let expected = sphere_of(&volume, &corners);
                        assert!(
                            same(found, expected),
                            "{dims:?} {seed} {filter:?} {picture:?}: {found:?} {expected:?}"
                        );
                        compared += 1;
                        smaller += u32::from(found.radius_mm < 0.9 * volume.bounding_sphere().1);
                        // The control: the cells of the other filter.
                        let other = match filter {
                            Filter::Linear => Filter::Nearest,
                            Filter::Nearest => Filter::Linear,
                        };
                        let corners = shown_corners(&volume, picture, other);
                        by_other_cells += u32::from(!same(found, sphere_of(&volume, &corners)));
                    }
                }
            }
        }
        assert!(compared == 1050 && smaller > 200, "{smaller} of {compared}");
        assert!(by_other_cells > 500, "{by_other_cells} of {compared}");
    }

    /// One voxel, in the middle or at a corner: its box with the nearest filter, and the cells around it.
    #[test]
    fn a_single_voxel_is_a_sphere_of_its_cells() {
        let dims = [9, 8, 7];
        let alone = |[x, y, z]: [usize; 3]| {
            let mut stored = vec![0_u8; 9 * 8 * 7];
            stored[(z * 8 + y) * 9 + x] = 255;
            volume(dims, stored)
        };
        let spacing_mm = oblique().spacing_mm();
        let at =
            |volume: &Volume, p: DVec3| volume.geometry().world_from_index().transform_point3(p);
        for picture in pictures() {
            let middle = alone([4, 3, 5]);
            let linear = content_of(&middle, &picture, Filter::Linear);
            let center_world = at(&middle, DVec3::new(4.0, 3.0, 5.0));
            let around = |radius_mm| Sphere {
                center_world,
                radius_mm,
            };
            assert!(same(linear, around(spacing_mm.length())), "{picture:?}");
            // The box's corners are those of the cells; of a voxel elsewhere they are others.
            let corners = |volume: &Volume| {
                let shown = [(picture.clone(), Filter::Linear)];
                content(volume, &shown).unwrap().corners
            };
            let [least, greatest] = [-1.0, 1.0].map(|aside| DVec3::new(4.0, 3.0, 5.0) + aside);
            let cells = Corners::between(least, greatest, |p| at(&middle, p));
            assert_eq!(corners(&middle), cells, "{picture:?}");
            assert_ne!(corners(&alone([3, 3, 5])), cells);
            let nearest = content_of(&middle, &picture, Filter::Nearest);
            assert!(
                same(nearest, around(spacing_mm.length() / 2.0)),
                "{picture:?}"
            );
            // The control: the other filter's.
            assert!(!same(nearest, linear));
            let corner = alone([8, 0, 6]);
            let linear = content_of(&corner, &picture, Filter::Linear);
            let expected = Sphere {
                center_world: at(&corner, DVec3::new(7.5, 0.5, 5.5)),
                radius_mm: spacing_mm.length() / 2.0,
            };
            assert!(same(linear, expected), "{picture:?}");
        }
    }

    #[test]
    fn what_shows_nothing_or_everything_is_the_whole_volume() {
        let whole = |volume: &Volume| Sphere::from(volume.bounding_sphere());
        let dims = [12, 5, 6];
        let dark = volume(dims, vec![3_u8; 360]);
        let mut stored = vec![3_u8; 360];
        stored[200] = 250;
        let lit = volume(dims, stored.clone());
        for filter in [Filter::Linear, Filter::Nearest] {
            for picture in pictures() {
                assert_eq!(content_of(&dark, &picture, filter), whole(&dark));
                // The control: one voxel is seen.
                assert_ne!(content_of(&lit, &picture, filter), whole(&lit));
            }
            for of in [Projection::Minimum, Projection::Mean] {
                assert_eq!(content_of(&lit, &projection(of), filter), whole(&lit));
            }
            // All of it inside: caps, and without them nothing.
            let inside = volume(dims, vec![250_u8; 360]);
            for caps in [true, false] {
                assert_eq!(content_of(&inside, &surface(caps), filter), whole(&inside));
            }
            // Inside but for a voxel: without caps what is around that.
            let hollow = volume(dims, stored.iter().map(|v| 255 - v).collect::<Vec<u8>>());
            let capped = content_of(&hollow, &surface(true), filter);
            let open = content_of(&hollow, &surface(false), filter);
            assert_eq!(capped, whole(&hollow));
            assert!(open.radius_mm < 0.7 * capped.radius_mm);
        }
    }

    /// Values that are no numbers are those of the smallest value.
    #[test]
    fn values_that_are_no_numbers_show_nothing() {
        let dims = [40, 6, 5];
        let stored: Vec<f32> = sparse(dims, 300, 9).into_iter().map(f32::from).collect();
        let min = stored.iter().copied().fold(f32::INFINITY, f32::min);
        let mut broken = stored.clone();
        let mut mended = stored;
        for at in [0, 7, 39, 600, 1199] {
            broken[at] = [f32::NAN, f32::INFINITY][at % 2];
            mended[at] = min;
        }
        let (broken, mended) = (volume(dims, broken), volume(dims, mended));
        assert_eq!(broken.non_finite(), 5);
        for picture in pictures() {
            let of = |volume| content_of(volume, &picture, Filter::Linear);
            assert_eq!(of(&broken), of(&mended), "{picture:?}");
            // The control: it is not the volume's.
            assert!(
                of(&broken).radius_mm < broken.bounding_sphere().1,
                "{picture:?}"
            );
        }
    }

    #[test]
    fn several_pictures_share_the_sphere_around_all_their_contents() {
        let dims = [30, 20, 10];
        let mut stored = vec![0_u8; 6000];
        // 115 absorbs and is no surface; 150 is inside.
        (stored[5 * 30 + 4], stored[(8 * 20 + 17) * 30 + 27]) = (190, 255);
        let volume = volume(dims, stored);
        let shown = [(surface(true), Filter::Nearest), (medium(), Filter::Linear)];
        let corners: Vec<DVec3> = shown
            .iter()
            .flat_map(|(picture, filter)| shown_corners(&volume, picture, *filter))
            .collect();
        let both = content(&volume, &shown).unwrap().sphere;
        assert!(same(both, sphere_of(&volume, &corners)));
        // The control: one alone is another.
        let alone = content_of(&volume, &shown[0].0, shown[0].1);
        assert!(alone.radius_mm < 0.5 * both.radius_mm);
        // With one that shows all of the volume it is the volume's.
        let mean = (projection(Projection::Mean), Filter::Linear);
        let all = content(&volume, &[shown[0].clone(), mean]).unwrap().sphere;
        assert_eq!(all, volume.bounding_sphere().into());
    }
}
