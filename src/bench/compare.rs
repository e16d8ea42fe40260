//! Whether two pictures are the same to the last bit.

use crate::frame::Frame;

/// All planes of a picture but the counters, which tell how it was made.
pub fn same_picture(a: &Frame, b: &Frame) -> bool {
    fn same<T: bytemuck::NoUninit>(a: Option<&[T]>, b: Option<&[T]>) -> bool {
        a.map(bytemuck::cast_slice::<T, u8>) == b.map(bytemuck::cast_slice::<T, u8>)
    }
    same(Some(&a.color), Some(&b.color))
        && same(a.display.as_deref(), b.display.as_deref())
        && same(a.depth.as_deref(), b.depth.as_deref())
        && same(a.normal.as_deref(), b.normal.as_deref())
        && same(a.value.as_deref(), b.value.as_deref())
        && same(a.kind.as_deref(), b.kind.as_deref())
        && same(a.certificate.as_deref(), b.certificate.as_deref())
}
