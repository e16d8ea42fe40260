//! Files with bytes, written numbers and stretches changed at random.

use std::cell::Cell;
use std::fs;

use proptest::prelude::*;
use proptest::test_runner::{Config, TestRunner};

use super::{copies, fixtures, read_checked, write_anew};

/// A change to a file's bytes.
#[derive(Debug, Clone)]
enum Change {
    Byte {
        at: usize,
        value: u8,
    },
    Bytes {
        at: usize,
        value: [u8; 8],
        length: usize,
    },
    Number {
        which: usize,
        text: String,
    },
    Cut {
        at: usize,
        length: usize,
    },
    Double {
        at: usize,
        length: usize,
    },
}

impl Change {
    fn apply(&self, bytes: &mut Vec<u8>) {
        let size = bytes.len();
        if size == 0 {
            return;
        }
        match self {
            Self::Byte { at, value } => bytes[at % size] = *value,
            Self::Bytes { at, value, length } => {
                for (offset, value) in value[..*length].iter().enumerate() {
                    bytes[(at + offset) % size] = *value;
                }
            }
            Self::Number { which, text } => {
                let numbers = written_numbers(bytes);
                if let Some(range) = numbers.get(which % numbers.len().max(1)) {
                    bytes.splice(range.clone(), text.bytes());
                }
            }
            Self::Cut { at, length } => {
                let at = at % size;
                bytes.drain(at..(at + length).min(size));
            }
            Self::Double { at, length } => {
                let at = at % size;
                let part = bytes[at..(at + length).min(size)].to_vec();
                bytes.splice(at..at, part);
            }
        }
    }
}

/// Where numbers are written in the text at a file's start.
fn written_numbers(bytes: &[u8]) -> Vec<std::ops::Range<usize>> {
    let mut numbers = Vec::new();
    let mut start = None;
    for (at, byte) in bytes.iter().take(600).enumerate() {
        match (byte.is_ascii_digit(), start) {
            (true, None) => start = Some(at),
            (false, Some(from)) => {
                numbers.push(from..at);
                start = None;
            }
            _ => {}
        }
    }
    numbers
}

fn change() -> impl Strategy<Value = Change> {
    let hostile_text = prop::sample::select(vec![
        "0",
        "-1",
        "-9223372036854775808",
        "9223372036854775807",
        "18446744073709551615",
        "340282366920938463463374607431768211456",
        "1048576",
        "1099511627776",
        "1e308",
        "-1e308",
        "1e-320",
        "nan",
        "inf",
        "-inf",
        "",
        "99999",
        "%d",
        "4294967296",
        "65536",
        "(",
        "\n",
    ]);
    let hostile_bytes = prop::sample::select(vec![
        [0; 8],
        [0xff; 8],
        [0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0x7f],
        [0x7f, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff],
        [0, 0, 0xc0, 0x7f, 0, 0, 0xc0, 0x7f],
        [0, 0, 0, 0, 0, 1, 0, 0],
    ]);
    prop_oneof![
        (any::<usize>(), any::<u8>()).prop_map(|(at, value)| Change::Byte { at, value }),
        (
            any::<usize>(),
            hostile_bytes,
            prop::sample::select(vec![2, 4, 8])
        )
            .prop_map(|(at, value, length)| Change::Bytes { at, value, length }),
        (any::<usize>(), hostile_text).prop_map(|(which, text)| Change::Number {
            which,
            text: text.into()
        }),
        (any::<usize>(), 1..40usize).prop_map(|(at, length)| Change::Cut { at, length }),
        (any::<usize>(), 1..40usize).prop_map(|(at, length)| Change::Double { at, length }),
    ]
}

#[test]
fn changed_files_are_read_or_refused_and_nothing_else() {
    let read_anyway = Cell::new(0);
    let refused = Cell::new(0);
    let folder = copies();
    for original in fixtures() {
        let whole = fs::read(&original).unwrap();
        let path = folder.path().join(original.file_name().unwrap());
        let mut runner = TestRunner::new_with_rng(
            Config {
                cases: 100,
                failure_persistence: None,
                ..Config::default()
            },
            TestRunner::deterministic().new_rng(),
        );
        runner
            .run(&prop::collection::vec(change(), 1..4), |changes| {
                let mut bytes = whole.clone();
                for change in &changes {
                    change.apply(&mut bytes);
                }
                write_anew(&path, &bytes);
                match read_checked(&path) {
                    Ok(volume) => {
                        read_anyway.set(read_anyway.get() + 1);
                        let range = volume.range();
                        prop_assert!(range.min.is_finite() && range.max.is_finite());
                        prop_assert!(volume.geometry().spacing_mm().min_element() > 0.0);
                    }
                    Err(_) => refused.set(refused.get() + 1),
                }
                Ok(())
            })
            .unwrap_or_else(|failure| panic!("{}: {failure}", original.display()));
        write_anew(&path, &whole);
    }
    // Both happen, so neither branch is idle.
    let (read_anyway, refused) = (read_anyway.get(), refused.get());
    assert!(
        read_anyway > 1000 && refused > 1000,
        "{read_anyway} {refused}"
    );
}
