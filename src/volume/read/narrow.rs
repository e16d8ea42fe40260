//! Numbers of 32 and 64 bits into single precision: counted from an offset where that saves digits.

use bytemuck::Pod;
use rayon::prelude::*;

use super::element::{Converted, Element, Endian, Loss, Scalar};
use crate::volume::Rescale;

/// Whole numbers so far apart are exact in single precision when counted from about their middle:
/// it holds all up to 2^24 on either side, and the middle is rounded by 1/32 of the width at most.
const WIDEST_WHOLE: f64 = 1.8 * 16_777_216.0;

/// A number wider than single precision.
trait Wide: Pod + Send + Sync + PartialOrd {
    fn nearest(self) -> f64;
    /// `self − offset`, rounded once to double precision.
    fn above(self, offset: f64) -> f64;
    /// The remainder that `converted`, counted from the offset, leaves.
    fn left_over(self, offset: f64, converted: f32) -> f64;
}

macro_rules! whole {
    ($($t:ty),*) => {$(
        impl Wide for $t {
            fn nearest(self) -> f64 {
                self as f64
            }

            // Offsets are whole too, and i128 holds every difference.
            fn above(self, offset: f64) -> f64 {
                (i128::from(self) - offset as i128) as f64
            }

            fn left_over(self, offset: f64, converted: f32) -> f64 {
                (i128::from(self) - offset as i128 - converted as i128) as f64
            }
        }
    )*};
}

whole!(u32, i32, u64, i64);

impl Wide for f64 {
    fn nearest(self) -> f64 {
        self
    }

    fn above(self, offset: f64) -> f64 {
        self - offset
    }

    fn left_over(self, offset: f64, converted: f32) -> f64 {
        self - offset - f64::from(converted)
    }
}

/// The voxels whose bytes, in the file's type and order, lie in `raw`. They are narrowed in place: a
/// type of 32 bits takes no more memory than its voxels, one of 64 bits the file's own size.
pub(super) fn narrow(raw: Vec<f32>, element: Element) -> Converted {
    let endian = element.endian;
    match element.scalar {
        Scalar::U32 => narrow_from::<u32>(raw, endian),
        Scalar::I32 => narrow_from::<i32>(raw, endian),
        Scalar::U64 => narrow_from::<u64>(raw, endian),
        Scalar::I64 => narrow_from::<i64>(raw, endian),
        Scalar::F64 => narrow_from::<f64>(raw, endian),
        Scalar::U8 | Scalar::I8 | Scalar::U16 | Scalar::I16 | Scalar::F16 | Scalar::F32 => {
            unreachable!("single precision holds these types")
        }
    }
}

fn narrow_from<T: Wide>(mut raw: Vec<f32>, endian: Endian) -> Converted {
    let size = size_of::<T>();
    let number = |bytes: &[u8]| -> T {
        let mut number: T = bytemuck::pod_read_unaligned(bytes);
        if endian != Endian::NATIVE {
            bytemuck::bytes_of_mut(&mut number).reverse();
        }
        number
    };
    let bytes: &mut [u8] = bytemuck::cast_slice_mut(&mut raw);
    let count = bytes.len() / size;
    let survey = (bytes.par_chunks(size << 14))
        .map(|chunk| Survey::of(chunk.chunks_exact(size).map(number)))
        .reduce(Survey::default, Survey::and);
    let rescale = survey.rescale();
    let mut loss = Loss {
        width: survey.max - survey.min,
        ..Loss::default()
    };
    for i in 0..count {
        let single = single(number(&bytes[i * size..][..size]), rescale, &mut loss);
        bytes[i * size_of::<f32>()..][..size_of::<f32>()].copy_from_slice(&single.to_ne_bytes());
    }
    raw.truncate(count);
    raw.shrink_to_fit();
    Converted {
        rescale,
        loss,
        ..raw.into()
    }
}

/// The properties that decide how numbers are stored.
#[derive(Debug, Clone, Copy)]
struct Survey {
    /// The minimum of the finite numbers.
    min: f64,
    max: f64,
    /// Whether single precision holds all numbers exactly.
    fits: bool,
    /// Whether all numbers are whole.
    whole: bool,
}

impl Default for Survey {
    fn default() -> Self {
        Self {
            min: f64::INFINITY,
            max: f64::NEG_INFINITY,
            fits: true,
            whole: true,
        }
    }
}

impl Survey {
    fn of<T: Wide>(numbers: impl Iterator<Item = T>) -> Self {
        let mut survey = Self::default();
        for number in numbers {
            let near = number.nearest();
            if near.is_finite() {
                survey.min = survey.min.min(near);
                survey.max = survey.max.max(near);
                survey.fits &= number.left_over(0.0, near as f32) == 0.0;
                survey.whole &= near.fract() == 0.0;
            }
        }
        survey
    }

    fn and(self, other: Self) -> Self {
        Self {
            min: self.min.min(other.min),
            max: self.max.max(other.max),
            fits: self.fits && other.fits,
            whole: self.whole && other.whole,
        }
    }

    /// The offset, about the range's middle, which leaves the smallest differences. It has few
    /// digits, whole ones for whole numbers, and is used only where something is lost without and
    /// where every difference from it is exact in double precision: of whole numbers that single
    /// precision then holds, and of any numbers within a factor of 2 (Sterbenz 1974). Elsewhere it
    /// would save a bit of the largest and cost many of the smallest.
    fn rescale(self) -> Rescale {
        let Self { min, max, .. } = self;
        let near_each_other = min > 0.0 && max <= 2.0 * min || max < 0.0 && min >= 2.0 * max;
        let is_exact = near_each_other || self.whole && max - min <= WIDEST_WHOLE;
        if self.fits || !is_exact {
            return Rescale::IDENTITY;
        }
        let unit = ((max - min).log2().floor() - 4.0).exp2();
        let unit = if self.whole { unit.max(1.0) } else { unit };
        let middle = f64::midpoint(min, max);
        let rounded = (middle / unit).round() * unit;
        Rescale {
            slope: 1.0,
            // A range of one value has no unit.
            intercept: if rounded.is_finite() { rounded } else { middle },
        }
    }
}

/// A number as it is stored, with what that loses.
fn single<T: Wide>(number: T, rescale: Rescale, loss: &mut Loss) -> f32 {
    let single = number.above(rescale.intercept) as f32;
    let lost = number.left_over(rescale.intercept, single).abs();
    if lost == 0.0 || !number.nearest().is_finite() {
        return single;
    }
    loss.changed += 1;
    if single.is_infinite() {
        loss.clamped += 1;
        return f32::MAX.copysign(single);
    }
    loss.largest = loss.largest.max(lost);
    single
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The stored numbers, how to read them, and what they lost.
    fn narrowed<T: Wide>(numbers: &[T], scalar: Scalar) -> (Vec<f64>, Rescale, Loss) {
        let mut raw = vec![0.0_f32; size_of_val(numbers) / 4];
        let bytes: &mut [u8] = bytemuck::cast_slice_mut(&mut raw);
        bytes.copy_from_slice(bytemuck::cast_slice(numbers));
        let converted = narrow(raw, Element::native(scalar));
        let stored = (0..numbers.len())
            .map(|i| converted.voxels.stored(i))
            .collect();
        (stored, converted.rescale, converted.loss)
    }

    #[test]
    fn whole_numbers_far_from_zero_are_stored_to_the_last_digit() {
        let check = |(stored, rescale, loss): (Vec<f64>, Rescale, Loss), values: &[i128]| {
            assert_eq!((loss.changed, loss.largest), (0, 0.0));
            let physical = stored.iter().map(|&v| rescale.physical(v) as i128);
            assert_eq!(physical.collect::<Vec<_>>(), values);
            assert_ne!(rescale, Rescale::IDENTITY);
        };
        check(
            narrowed(&[16_777_216_i32, 16_777_217, -5], Scalar::I32),
            &[16_777_216, 16_777_217, -5],
        );
        check(
            narrowed(&[4_000_000_001_u32, 4_000_000_100], Scalar::U32),
            &[4_000_000_001, 4_000_000_100],
        );
        check(
            narrowed(&[-1_000_000_000_001_i64, -999_999_999_999], Scalar::I64),
            &[-1_000_000_000_001, -999_999_999_999],
        );
        check(
            narrowed(&[1_000_000_007_u64, 1_000_000_060], Scalar::U64),
            &[1_000_000_007, 1_000_000_060],
        );
        // The control: what single precision holds is left alone.
        let (stored, rescale, _) = narrowed(&[7_i32, -3_000_000], Scalar::I32);
        assert_eq!(
            (stored, rescale),
            (vec![7.0, -3_000_000.0], Rescale::IDENTITY)
        );
    }

    #[test]
    fn doubles_far_from_zero_lose_no_more_than_those_near_it() {
        let near: Vec<f64> = (0..200).map(|i| f64::from(i) * 0.57).collect();
        for offset in [1e6, 1e9, -1e9] {
            let far: Vec<f64> = near.iter().map(|v| v + offset).collect();
            let (stored, rescale, loss) = narrowed(&far, Scalar::F64);
            assert!(loss.largest <= loss.width * 2_f64.powi(-24), "{loss:?}");
            for (&stored, &far) in stored.iter().zip(&far) {
                assert!((rescale.physical(stored) - far).abs() <= loss.largest + 1e-7);
            }
            // The control: single precision alone has steps of 64 there.
            let alone = far.iter().map(|&v| (f64::from(v as f32) - v).abs());
            assert!(alone.fold(0.0, f64::max) > 1000.0 * loss.largest);
        }
    }

    #[test]
    fn what_is_lost_is_counted_and_measured() {
        let (_, rescale, loss) = narrowed(&[0.1, 100.0, 0.5], Scalar::F64);
        assert_eq!(
            (loss.changed, loss.clamped, rescale),
            (1, 0, Rescale::IDENTITY)
        );
        assert_eq!(loss.largest, f64::from(0.1_f32) - 0.1);
        assert_eq!(loss.width, 100.0 - 0.1);
        // The largest whole numbers round up to a power of two just outside their type.
        assert_eq!(narrowed(&[u64::MAX, 0], Scalar::U64).2.changed, 1);
        assert_eq!(narrowed(&[i64::MAX, i64::MIN], Scalar::I64).2.changed, 1);
        assert_eq!(narrowed(&[i64::MIN, 0], Scalar::I64).2.changed, 0);
    }

    #[test]
    fn doubles_beyond_single_precision_are_clamped_and_infinities_stay() {
        let numbers = [1e300, -1e300, f64::INFINITY, 0.5, f64::NAN];
        let (stored, _, loss) = narrowed(&numbers, Scalar::F64);
        let largest = f64::from(f32::MAX);
        assert_eq!(stored[..4], [largest, -largest, f64::INFINITY, 0.5]);
        assert!(stored[4].is_nan());
        assert_eq!((loss.changed, loss.clamped, loss.largest), (2, 2, 0.0));
    }

    #[test]
    fn the_other_byte_order_is_the_same_numbers() {
        let element = |endian| Element {
            scalar: Scalar::F64,
            endian,
        };
        let raw = |bytes: [u8; 8]| bytemuck::pod_read_unaligned::<[f32; 2]>(&bytes).to_vec();
        for (bytes, endian) in [
            (1.5_f64.to_le_bytes(), Endian::Little),
            (1.5_f64.to_be_bytes(), Endian::Big),
        ] {
            let converted = narrow(raw(bytes), element(endian));
            assert_eq!(converted.voxels.stored(0), 1.5);
        }
    }
}
