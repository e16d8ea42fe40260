//! How much memory a thread holds: every allocation of this program is counted.

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

/// Counts what each thread holds, and the most it has held since the count began.
struct Counting;

thread_local! {
    static HELD: Cell<isize> = const { Cell::new(0) };
    static MAX: Cell<isize> = const { Cell::new(0) };
}

fn count(bytes: isize) {
    // A thread that is ending has no counters any more; it no longer reads volumes either.
    let _ = HELD.try_with(|held| {
        held.set(held.get() + bytes);
        let _ = MAX.try_with(|max| max.set(max.get().max(held.get())));
    });
}

// SAFETY: every call goes to the system's allocator unchanged; counting does not allocate.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count(layout.size() as isize);
        // SAFETY: the caller promises what the system's allocator asks of a layout.
        unsafe { System.alloc(layout) }
    }
    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        count(layout.size() as isize);
        // SAFETY: the caller promises what the system's allocator asks of a layout.
        unsafe { System.alloc_zeroed(layout) }
    }
    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        count(-(layout.size() as isize));
        // SAFETY: the pointer is one that this allocator gave for this layout, as the caller promises.
        unsafe { System.dealloc(pointer, layout) }
    }
    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        count(size as isize - layout.size() as isize);
        // SAFETY: the pointer is one that this allocator gave for this layout, as the caller promises.
        unsafe { System.realloc(pointer, layout, size) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// The most bytes this thread held during `work`, beyond those it held before.
pub fn max_held<T>(work: impl FnOnce() -> T) -> (T, isize) {
    let before = HELD.get();
    MAX.set(before);
    let done = work();
    (done, MAX.get() - before)
}

#[test]
fn the_memory_count_sees_an_allocation() {
    let (block, held) = max_held(|| vec![1u8; 3 << 20]);
    assert_eq!(block.len(), 3 << 20);
    assert!(held >= 3 << 20);
}
