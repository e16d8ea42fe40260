//! The end of the process from where nothing may be done any more: from a signal's handler, or where
//! memory is short. Neither locks nor memory are needed.

/// The last words of the process and its end, with this exit code: no destructors, no handlers. Where
/// another thread is at it already this one waits for the end.
///
/// Safe inside a signal's handler.
pub fn end(last_words: &[&[u8]], code: u8) -> ! {
    #[cfg(unix)]
    {
        use std::sync::atomic::{AtomicBool, Ordering};
        static ENDING: AtomicBool = AtomicBool::new(false);
        if ENDING.swap(true, Ordering::AcqRel) {
            loop {
                // SAFETY: waits for a signal, of which the process's end is one.
                unsafe { libc::pause() };
            }
        }
        for words in last_words {
            write_to_stderr(words);
        }
        // SAFETY: ends the process and touches no memory.
        unsafe { libc::_exit(i32::from(code)) }
    }
    #[cfg(not(unix))]
    {
        let _ = (last_words, code);
        std::process::abort()
    }
}

#[cfg(unix)]
fn write_to_stderr(mut words: &[u8]) {
    while !words.is_empty() {
        // SAFETY: the bytes are there, and as many as their length.
        let written = unsafe { libc::write(2, words.as_ptr().cast(), words.len()) };
        match usize::try_from(written) {
            Ok(count) if count > 0 => words = &words[count.min(words.len())..],
            // Nobody listens.
            _ => return,
        }
    }
}

/// `number` in decimal, written into `digits`.
pub fn decimal(mut number: usize, digits: &mut [u8; 20]) -> &[u8] {
    let mut start = digits.len();
    loop {
        start -= 1;
        digits[start] = b'0' + (number % 10) as u8;
        number /= 10;
        if number == 0 {
            return &digits[start..];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_written_without_memory() {
        for number in [0, 7, 10, 4096, usize::MAX] {
            assert_eq!(decimal(number, &mut [0; 20]), number.to_string().as_bytes());
        }
    }
}
