//! Memory that may not be there. What grows with a volume or a picture is allocated here, so that the
//! answer no is an error and not the end; for all else the program has an [`Allocator`] that ends it
//! with a sentence.

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::fmt::Display;

use rayon::prelude::*;

use crate::abrupt;
use crate::error::{Error, ErrorKind, Result};

/// An empty vector with room for `len` elements: filling it allocates no more memory. `what` says what
/// it is for (`the octree`).
///
/// # Errors
/// Resource: the memory is not there.
pub fn room<T>(len: usize, what: impl Display) -> Result<Vec<T>> {
    let mut elements = Vec::new();
    make_room(&mut elements, len, what)?;
    Ok(elements)
}

/// Makes room in `elements` for `more` than there are.
///
/// # Errors
/// As [`room`].
pub fn make_room<T>(elements: &mut Vec<T>, more: usize, what: impl Display) -> Result<()> {
    may_fail(|| elements.try_reserve_exact(more)).map_err(|_| {
        let bytes = (elements.len() as u128 + more as u128) * size_of::<T>() as u128;
        Error::resource(format!("not enough memory for {what}: {bytes} bytes"))
    })
}

/// A vector of `len` elements, each `value`.
///
/// # Errors
/// As [`room`].
pub fn filled<T: Clone>(len: usize, value: T, what: impl Display) -> Result<Vec<T>> {
    let mut elements = room(len, what)?;
    elements.resize(len, value);
    Ok(elements)
}

/// The elements, made by all threads, in their order.
///
/// # Errors
/// As [`room`].
pub fn collected<T: Send>(
    elements: impl IndexedParallelIterator<Item = T>,
    what: impl Display,
) -> Result<Vec<T>> {
    let mut all = room(elements.len(), what)?;
    elements.collect_into_vec(&mut all);
    Ok(all)
}

thread_local! {
    /// Whether this thread can handle a refused request for memory.
    static MAY_FAIL: Cell<bool> = const { Cell::new(false) };
}

fn may_fail<T>(request: impl FnOnce() -> T) -> T {
    MAY_FAIL.set(true);
    let answer = request();
    MAY_FAIL.set(false);
    answer
}

/// The system's allocator, but that a refused request that is not turned into an error ends the process
/// with a sentence and the exit code of a resource that failed, not with a signal.
///
/// For the program alone: a library leaves such things to the program that uses it.
pub struct Allocator;

// SAFETY: every request goes to the system's allocator unchanged.
unsafe impl GlobalAlloc for Allocator {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        // SAFETY: the caller's own promise.
        answered(unsafe { System.alloc(layout) }, layout.size())
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        // SAFETY: the caller's own promise.
        answered(unsafe { System.alloc_zeroed(layout) }, layout.size())
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: the caller's own promise.
        unsafe { System.dealloc(pointer, layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        // SAFETY: the caller's own promise.
        answered(unsafe { System.realloc(pointer, layout, size) }, size)
    }
}

#[inline]
fn answered(pointer: *mut u8, bytes: usize) -> *mut u8 {
    if pointer.is_null() {
        refused(bytes);
    }
    pointer
}

#[cold]
fn refused(bytes: usize) {
    if MAY_FAIL.try_with(Cell::get).unwrap_or(false) {
        return;
    }
    let mut digits = [0; 20];
    let last_words: [&[u8]; 4] = [
        b"error: out of memory: ",
        abrupt::decimal(bytes, &mut digits),
        b" bytes more were requested and refused\n",
        b"hint: give the program more memory, or choose a smaller picture or volume\n",
    ];
    abrupt::end(&last_words, ErrorKind::Resource.exit_code())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn memory_that_is_not_there_is_an_error_and_memory_that_is_there_is_held() {
        let refused = room::<u64>(usize::MAX / 16, "a test").unwrap_err();
        assert_eq!(refused.kind(), ErrorKind::Resource);
        assert!(refused.to_string().contains("a test"), "{refused}");
        // More bytes than can be counted.
        assert!(room::<u64>(usize::MAX, "a test").is_err());
        let mut elements = room::<u32>(1000, "a test").unwrap();
        let place = elements.as_ptr();
        elements.resize(1000, 7);
        assert_eq!(elements.as_ptr(), place);
        assert_eq!(filled(3, 7_u8, "a test").unwrap(), [7, 7, 7]);
        let squares = collected((0..100_usize).into_par_iter().map(|n| n * n), "a test").unwrap();
        assert!(
            squares
                .iter()
                .enumerate()
                .all(|(n, &square)| square == n * n)
        );
    }
}
