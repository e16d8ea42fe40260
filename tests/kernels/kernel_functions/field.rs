//! The field between voxel centres and its slope.

use angioray::gpu::{Args, Element};
use angioray::render::Variant;
use angioray::scene::Filter;
use angioray::volume::VoxelType;

use super::{Random, build, common, dot, room, run, upload, variant, xyz};

struct Grid<T> {
    size: [u32; 3],
    voxels: Vec<T>,
}

struct Seen {
    values: Vec<f32>,
    /// Value and slope, found together.
    with_slope: Vec<[f32; 2]>,
}

impl<T: Element + Into<f64>> Grid<T> {
    fn new(size: [u32; 3], mut voxel: impl FnMut() -> T) -> Self {
        let count = size.iter().product::<u32>() as usize;
        let voxels = std::iter::repeat_with(&mut voxel).take(count).collect();
        Self { size, voxels }
    }

    fn voxel(&self, [x, y, z]: [u32; 3]) -> f64 {
        let [nx, ny, _] = self.size;
        self.voxels[((z * ny + y) * nx + x) as usize].into()
    }

    /// The lowest corner of the cell of a point; the last cell holds the far face too.
    fn cell(&self, p: [f64; 3]) -> [u32; 3] {
        std::array::from_fn(|a| (p[a].max(0.0) as u32).min(self.size[a].max(2) - 2))
    }

    /// The eight corners of a cell and, for a point anywhere, their weights.
    fn corners(&self, cell: [u32; 3], p: [f64; 3]) -> [(f64, f64); 8] {
        std::array::from_fn(|corner| {
            let up: [u32; 3] = std::array::from_fn(|a| (corner as u32 >> a) & 1);
            let at = std::array::from_fn(|a| (cell[a] + up[a]).min(self.size[a] - 1));
            let weight = |a: usize| {
                let f = p[a] - f64::from(cell[a]);
                if up[a] == 1 { f } else { 1.0 - f }
            };
            (self.voxel(at), weight(0) * weight(1) * weight(2))
        })
    }

    /// The trilinear polynomial of `cell`.
    fn trilinear(&self, cell: [u32; 3], p: [f64; 3]) -> f64 {
        self.corners(cell, p)
            .iter()
            .map(|(v, weight)| v * weight)
            .sum()
    }

    /// The central difference of that polynomial along `dir`.
    fn slope(&self, cell: [u32; 3], p: [f64; 3], dir: [f64; 3]) -> f64 {
        let h = 1e-3;
        let at = |h: f64| self.trilinear(cell, std::array::from_fn(|a| p[a] + h * dir[a]));
        (at(h) - at(-h)) / (2.0 * h)
    }

    fn on_device(&self, variant: Variant, points: &[[f32; 4]], dirs: &[[f32; 4]]) -> Option<Seen> {
        let device = common::device()?;
        let pass = build("field", variant);
        let [nx, ny, nz] = self.size;
        let mut values = room(&device, points.len());
        let mut with_slope = room(&device, points.len());
        run(
            &device,
            &pass,
            Args::new()
                .value("count", &(points.len() as u32))
                .value("size", &[nx, ny, nz, 0])
                .read("voxels", &upload(&device, &self.voxels))
                .read("points", &upload(&device, points))
                .read("dirs", &upload(&device, dirs))
                .write("values", &mut values)
                .write("with_slope", &mut with_slope),
            points.len(),
        );
        Some(Seen {
            values: values.download(&device).unwrap(),
            with_slope: with_slope.download(&device).unwrap(),
        })
    }
}

/// Points of the domain: anywhere, and in the faces of cells to the last bit.
fn points(size: [u32; 3], count: usize, random: &mut Random) -> Vec<[f32; 4]> {
    let mut coordinate = |n: u32| {
        let (low, high) = if n == 1 {
            (-0.5, 0.5)
        } else {
            (0.0, f64::from(n - 1))
        };
        let anywhere = random.within(low, high);
        let face = anywhere.round();
        let at = match random.below(6) {
            0 => face,
            1 => face.next_down(),
            2 => face.next_up(),
            _ => anywhere,
        };
        at.clamp(low as f32, high as f32)
    };
    let mut point = || {
        [
            coordinate(size[0]),
            coordinate(size[1]),
            coordinate(size[2]),
            0.0,
        ]
    };
    std::iter::repeat_with(&mut point).take(count).collect()
}

const SIZES: [[u32; 3]; 5] = [[5, 4, 3], [2, 2, 2], [1, 4, 3], [4, 1, 1], [1, 1, 1]];

/// Value against the trilinear polynomial, slope against its central difference, both on the scale
/// of the voxels; and the value never outside the range of its corners.
fn check_linear<T: Element + Into<f64>>(voxel: VoxelType, mut draw: impl FnMut(&mut Random) -> T) {
    let mut random = Random(4);
    let variant = variant(voxel, Filter::Linear, 8);
    for size in SIZES {
        let grid = Grid::new(size, || draw(&mut random));
        let points = points(size, 20_000, &mut random);
        let dirs: Vec<[f32; 4]> = points.iter().map(|_| random.direction()).collect();
        let Some(seen) = grid.on_device(variant, &points, &dirs) else {
            return;
        };
        let (mut worst_value, mut worst_slope, mut worst_moved) = (0.0_f64, 0.0_f64, 0.0_f64);
        for (i, (&p, &dir)) in points.iter().zip(&dirs).enumerate() {
            let (p, dir) = (xyz(p), xyz(dir));
            let cell = grid.cell(p);
            let corners = grid.corners(cell, p).map(|(v, _)| v);
            let low = corners.iter().copied().fold(f64::INFINITY, f64::min);
            let high = corners.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            let scale = low.abs().max(high.abs()).max(1e-30);
            let [value, slope] = seen.with_slope[i].map(f64::from);
            assert_eq!(seen.values[i], seen.with_slope[i][0]);
            assert!(
                (low..=high).contains(&value),
                "{size:?}: {value:e} is outside [{low:e}, {high:e}] at {p:?} of {corners:?}"
            );
            worst_value = worst_value.max((value - grid.trilinear(cell, p)).abs() / scale);
            worst_slope = worst_slope.max((slope - grid.slope(cell, p, dir)).abs() / scale);
            let moved = p.map(|c| c + 1e-4);
            worst_moved = worst_moved.max((value - grid.trilinear(cell, moved)).abs() / scale);
        }
        assert!(worst_value < 1e-6, "{size:?}: {worst_value:e}");
        assert!(worst_slope < 3e-6, "{size:?}: {worst_slope:e}");
        // A ten-thousandth of a voxel beside the point, and the slope's absence, are seen.
        assert!(
            size == [1, 1, 1] || worst_moved > 1e-6,
            "{size:?}: {worst_moved:e}"
        );
        let flat = points.iter().zip(&dirs).all(|(&p, &dir)| {
            let (p, dir) = (xyz(p), xyz(dir));
            grid.slope(grid.cell(p), p, dir).abs() < 3e-6
        });
        assert_eq!(flat, size == [1, 1, 1]);
    }
}

#[test]
fn trilinear_of_u8() {
    check_linear(VoxelType::U8, |random| random.below(256) as u8);
}

#[test]
fn trilinear_of_i16() {
    check_linear(VoxelType::I16, |random| random.bits() as i16);
}

#[test]
fn trilinear_of_u16() {
    check_linear(VoxelType::U16, |random| random.bits() as u16);
}

/// Values of very different sizes and both signs beside each other.
#[test]
fn trilinear_of_f32() {
    check_linear(VoxelType::F32, |random| {
        let size = 10f64.powi(random.below(9) as i32 - 4);
        random.within(-size, size)
    });
}

#[test]
fn nearest_takes_the_nearest_voxel_and_has_no_slope() {
    let mut random = Random(5);
    let variant = variant(VoxelType::U16, Filter::Nearest, 8);
    for size in SIZES {
        let mut next = 0u16;
        // Each voxel its own value: the value identifies the voxel.
        let grid = Grid::new(size, || {
            next += 1;
            next - 1
        });
        let points = points(size, 5_000, &mut random);
        let dirs: Vec<[f32; 4]> = points.iter().map(|_| random.direction()).collect();
        let Some(seen) = grid.on_device(variant, &points, &dirs) else {
            return;
        };
        let [nx, ny, _] = size;
        let mut farther = 0;
        for (i, &p) in points.iter().enumerate() {
            let at = seen.values[i] as u32;
            let voxel = [at % nx, at / nx % ny, at / nx / ny].map(f64::from);
            let p = xyz(p);
            let near = (0..3).all(|a| (p[a] - voxel[a]).abs() <= 0.5 + 1e-6);
            assert!(near, "{size:?}: {voxel:?} is not nearest to {p:?}");
            farther += usize::from((0..3).any(|a| (p[a] - voxel[a] - 0.4).abs() > 0.5));
            assert_eq!(seen.with_slope[i], [seen.values[i], 0.0]);
        }
        // The same against points moved by 0.4 voxels fails.
        assert!(farther > 100);
    }
}

#[test]
fn the_counterpart_is_linear_along_edges() {
    let grid = Grid::<u8>::new([2, 2, 2], {
        let mut voxels = [0, 10, 20, 30, 40, 50, 60, 70].into_iter();
        move || voxels.next().unwrap()
    });
    assert_eq!(grid.trilinear([0; 3], [0.25, 0.5, 0.75]), 2.5 + 10.0 + 30.0);
    let slope = grid.slope([0; 3], [0.5; 3], [1.0, 2.0, -1.0]);
    assert!((slope - dot([10.0, 20.0, 40.0], [1.0, 2.0, -1.0])).abs() < 1e-9);
}
