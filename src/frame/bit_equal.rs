//! Whether two pictures are the same to the last bit.

use bytemuck::{NoUninit, cast_slice};

use super::Frame;

impl Frame {
    /// Whether all planes are those of `other`, bit by bit; but the counters, which say how a picture
    /// was made.
    pub fn bit_equal(&self, other: &Self) -> bool {
        fn same<T: NoUninit>(a: Option<&[T]>, b: Option<&[T]>) -> bool {
            a.map(cast_slice::<T, u8>) == b.map(cast_slice::<T, u8>)
        }
        same(Some(&self.color), Some(&other.color))
            && same(self.display.as_deref(), other.display.as_deref())
            && same(self.depth.as_deref(), other.depth.as_deref())
            && same(self.normal.as_deref(), other.normal.as_deref())
            && same(self.value.as_deref(), other.value.as_deref())
            && same(self.kind.as_deref(), other.kind.as_deref())
            && same(self.certificate.as_deref(), other.certificate.as_deref())
    }
}
