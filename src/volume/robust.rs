//! The range of a volume's values without a few extreme voxels and without padding.

use rayon::prelude::*;

use super::histogram::{Histogram, between_class_share};
use super::percentiles::stored_at_ranks;
use super::{Volume, Voxel, VoxelType};
use crate::extent::Range;
use crate::with_voxels;

/// An end is far when it lies so many times the width of the rest beyond the rest.
const FAR: f64 = 4.0;
/// Shares of the voxels that may be extreme, tried in turn: a few at any rate, more of them only
/// beside values that have classes of their own.
const FEW: f64 = 5e-5;
const MORE: [f64; 3] = [2e-4, 1e-3, 5e-3];
/// A share is at least so many voxels.
const FEWEST: u64 = 2;
/// Values have classes when the best threshold explains this share of their variance: normal noise
/// has 0.64, uniform 0.75, two narrow peaks nearly 1.
const CLASSES: f64 = 0.8;
/// Bins of the histogram in which classes are looked for. Whole numbers of fewer values than half
/// as many say too little: noise of 0 and 1 has perfect classes.
const BINS: usize = 128;
/// Physical values below any that a CT measures: what fills a picture outside the field of view.
const PADDING_BELOW: f64 = -1024.0;
/// Padding lies apart by this share of the other values' width.
const PADDING_GAP: f64 = 0.25;

/// The stored values that stand for the volume where its whole range would show nothing: its range
/// without
///
/// - up to 0.005 % of the voxels (or two) that lie farther beyond the others, at either end, than
///   four times the others' whole width: broken voxels;
/// - up to 0.5 % of the voxels that do so beside others which have classes of their own (air and
///   tissue): metal in a CT. Where the others are mere noise, bright voxels are the subject;
/// - one value, the smallest, below −1024 and clear of all others: padding.
///
/// Most volumes have neither, and this is their whole range.
pub fn stored_robust_range(volume: &Volume) -> Range {
    let whole = volume.stored_range();
    let total = volume.dims().voxels();
    let tail = |share: f64| ((share * total as f64) as u64).max(FEWEST);
    let shares = [FEW, MORE[0], MORE[1], MORE[2]];
    if total <= 4 * tail(MORE[2]) {
        return whole;
    }
    let ranks: Vec<u64> = (shares.iter())
        .flat_map(|&share| [tail(share) + 1, total - tail(share)])
        .collect();
    let at = stored_at_ranks(volume.voxels(), &ranks);
    let mut robust = whole;
    for (ends, share) in at.chunks_exact(2).zip(shares) {
        let rest = Range {
            min: ends[0],
            max: ends[1],
        };
        let far = FAR * rest.width();
        let is_low = whole.min == robust.min && rest.min - whole.min > far;
        let is_high = whole.max == robust.max && whole.max - rest.max > far;
        let counts = share == FEW || (is_low || is_high) && has_classes(volume, rest);
        // Where all others are of one value, the few are the subject.
        if rest.width() == 0.0 || !counts {
            continue;
        }
        if is_low {
            robust.min = rest.min;
        }
        if is_high {
            robust.max = rest.max;
        }
    }
    without_padding(volume, robust, at[6])
}

impl Histogram {
    /// `bins` bins (at least one) over the range in which nearly all of `volume` lies: without a
    /// few far-away voxels and without padding, which would leave the rest a bin or two. Of most
    /// volumes that is the whole range.
    pub fn robust(volume: &Volume, bins: usize) -> Self {
        Self::within(volume, stored_robust_range(volume), bins)
    }
}

/// Whether the values within `rest` fall into classes.
fn has_classes(volume: &Volume, rest: Range) -> bool {
    let is_clear = match volume.voxels().voxel_type() {
        VoxelType::F32 => true,
        _ => rest.width() >= BINS as f64 / 2.0,
    };
    is_clear && between_class_share(&Histogram::within(volume, rest, BINS).counts) >= CLASSES
}

/// `robust` from the second smallest value on, where the smallest is padding; `low` is the value at
/// the rank that many voxels of padding reach.
fn without_padding(volume: &Volume, robust: Range, low: f64) -> Range {
    if low != robust.min || volume.rescale().physical(low) >= PADDING_BELOW {
        return robust;
    }
    let next = with_voxels!(volume.voxels(), voxels => next_above(voxels, low));
    let rest = Range {
        min: next,
        ..robust
    };
    let is_apart = next < robust.max && next - low >= PADDING_GAP * rest.width();
    if is_apart { rest } else { robust }
}

/// The smallest voxel value above `low`; infinity if there is none.
fn next_above<T: Voxel>(voxels: &[T], low: f64) -> f64 {
    let chunk = |voxels: &[T]| {
        let above = voxels.iter().map(|&v| v.into()).filter(|&v: &f64| v > low);
        above.fold(f64::INFINITY, f64::min)
    };
    (voxels.par_chunks(1 << 16))
        .map(chunk)
        .reduce(|| f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::super::{Geometry, NonFinite, Rescale, Voxels};
    use super::*;
    use crate::extent::Dims;

    fn robust(voxels: impl Into<Voxels>) -> (f64, f64) {
        let voxels = voxels.into();
        let dims = Dims::new([voxels.len() as u64, 1, 1]).unwrap();
        let (geometry, rescale) = (Geometry::default(), Rescale::IDENTITY);
        let volume = Volume::new(dims, voxels, geometry, rescale, NonFinite::Refuse).unwrap();
        let Range { min, max } = stored_robust_range(&volume);
        (min, max)
    }

    /// Multiples of an odd number modulo 2^16: every value below `below` about equally often.
    fn noise(count: u32, below: u32) -> impl Iterator<Item = i16> {
        (0..count).map(move |i| ((i * 40_503 % 65_536) * below / 65_536) as i16)
    }

    #[test]
    fn one_or_two_extreme_voxels_are_left_out_at_either_end() {
        let mut voxels: Vec<i16> = noise(20_000, 200).collect();
        assert_eq!(robust(voxels.clone()), (0.0, 199.0));
        voxels[77] = 32_767;
        voxels[78] = -32_768;
        assert_eq!(robust(voxels.clone()), (0.0, 199.0));
        let unsigned: Vec<u16> = voxels
            .iter()
            .map(|&v| if v == 32_767 { 65_535 } else { v.max(0) as u16 })
            .collect();
        assert_eq!(robust(unsigned), (0.0, 199.0));
        let floats: Vec<f32> = voxels.iter().map(|&v| f32::from(v) * 0.5).collect();
        assert_eq!(robust(floats), (0.0, 99.5));
        // The control: what lies but a few widths away, or is more than a few voxels, stays.
        voxels[77] = 900;
        voxels[78] = 0;
        assert_eq!(robust(voxels.clone()), (0.0, 900.0));
        voxels[100..140].fill(32_767);
        assert_eq!(robust(voxels), (0.0, 32_767.0));
    }

    #[test]
    fn metal_beside_tissue_is_left_out_and_vessels_in_noise_are_not() {
        // Air and tissue, as wide as its noise.
        let mut body: Vec<i16> = noise(20_000, 60).collect();
        body[..9000].fill(-1000);
        body[10_000..10_060].fill(30_000);
        assert_eq!(robust(body.clone()), (-1000.0, 59.0));
        // The control: as many bright voxels beside noise alone are the subject.
        body.rotate_left(9000);
        body.truncate(11_000);
        assert_eq!(robust(body), (0.0, 30_000.0));
        // Few values say too little: background of 0 and 1.
        let mut rotational: Vec<u8> = noise(20_000, 2).map(|v| v as u8).collect();
        rotational[100..150].fill(255);
        assert_eq!(robust(rotational), (0.0, 255.0));
        // A few bright voxels in nothing at all.
        let mut sparse = vec![0_u8; 20_000];
        sparse[7] = 255;
        assert_eq!(robust(sparse), (0.0, 255.0));
    }

    #[test]
    fn padding_is_left_out_where_no_ct_measures() {
        let mut body: Vec<i16> = noise(20_000, 1500).map(|v| v - 1000).collect();
        body[..5000].fill(-3024);
        assert_eq!(robust(body.clone()), (-1000.0, 499.0));
        // The controls: a masked background, and a low value that is not apart.
        let masked: Vec<i16> = body
            .iter()
            .map(|&v| if v == -3024 { -1024 } else { v + 900 })
            .collect();
        assert_eq!(robust(masked).0, -1024.0);
        let near: Vec<i16> = body
            .iter()
            .map(|&v| if v == -3024 { -1200 } else { v })
            .collect();
        assert_eq!(robust(near).0, -1200.0);
    }
}
