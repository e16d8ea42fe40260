//! The program's allocator where the system refuses memory. It ends the process, so that this program runs
//! once more for it.

use std::alloc::{GlobalAlloc, Layout};
use std::process::Command;

use angioray::memory::{Allocator, room};

const VARIABLE: &str = "ANGIORAY_TEST_REFUSED";

/// More than any address space has.
const ABSURD: usize = 1 << 62;

#[test]
fn refused_memory_ends_the_program_in_words_unless_it_is_an_error() {
    if std::env::var(VARIABLE).is_ok() {
        // SAFETY: the layout has a size.
        let block = unsafe { Allocator.alloc(Layout::from_size_align(ABSURD, 8).unwrap()) };
        assert!(block.is_null());
        return;
    }
    let output = Command::new(std::env::current_exe().unwrap())
        .args(["--exact", "--nocapture"])
        .arg("reader_robustness::refused::refused_memory_ends_the_program_in_words_unless_it_is_an_error")
        .env(VARIABLE, "1")
        .output()
        .unwrap();
    let messages = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(74), "{messages}");
    assert!(
        messages.contains("error: out of memory: 4611686018427387904 bytes"),
        "{messages}"
    );
    assert!(messages.contains("\nhint: "), "{messages}");
    // The control: what grows with a volume is an error, and the program continues.
    assert_eq!(room::<u8>(ABSURD, "it").unwrap_err().exit_code(), 74);
    let layout = Layout::from_size_align(64, 8).unwrap();
    // SAFETY: the layout has a size, and the block is given back as it was allocated.
    unsafe {
        let block = Allocator.alloc(layout);
        assert!(!block.is_null());
        Allocator.dealloc(block, layout);
    }
}
