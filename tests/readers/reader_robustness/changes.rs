//! Changes to a file's bytes, drawn at random: to single bytes, to numbers, words and lines as they are
//! written, and to the numbers of binary headers.

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

/// Where changes come from: the same for the same number.
pub struct Rng(Pcg64);

impl Rng {
    pub fn of(number: u64) -> Self {
        Self(Pcg64::seed_from_u64(number))
    }

    /// 0 to n − 1.
    pub fn below(&mut self, n: usize) -> usize {
        self.0.random_range(0..n.max(1))
    }

    pub fn one_in(&mut self, n: usize) -> bool {
        self.below(n) == 0
    }

    pub fn byte(&mut self) -> u8 {
        self.0.random()
    }

    pub fn any_of<'a, T: ?Sized>(&mut self, choices: &[&'a T]) -> &'a T {
        choices[self.below(choices.len())]
    }
}

const HOSTILE_NUMBERS: [&str; 26] = [
    "0",
    "-0",
    "-1",
    "-9223372036854775808",
    "9223372036854775807",
    "18446744073709551615",
    "340282366920938463463374607431768211456",
    "2147483648",
    "1048576",
    "1099511627776",
    "1e308",
    "-1e308",
    "1e-320",
    "1e999",
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
    "\u{1b}[31m",
    "LIST",
];

const HOSTILE_BYTES: [[u8; 8]; 8] = [
    [0; 8],
    [0xff; 8],
    [0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0x7f],
    [0x7f, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff],
    [0, 0, 0xc0, 0x7f, 0, 0, 0xc0, 0x7f],
    [0, 0, 0x80, 0x7f, 0, 0, 0x80, 0xff],
    [0, 0, 0, 0, 0, 1, 0, 0],
    [1, 0, 0, 0, 0, 0, 0, 0],
];

/// So far into a file reach most changes: what stands behind is voxels.
const HEADER: usize = 700;

/// Changes `bytes` once. `words` are put in the place of others.
pub fn change(bytes: &mut Vec<u8>, words: &[String], rng: &mut Rng) {
    let size = bytes.len();
    if size == 0 {
        bytes.push(rng.byte());
        return;
    }
    let range = if rng.one_in(8) {
        size
    } else {
        size.min(HEADER)
    };
    let at = rng.below(range);
    let end = (at + 1 + rng.below(40)).min(size);
    match rng.below(11) {
        0 => bytes[at] = rng.byte(),
        1 => bytes[at] ^= 1 << rng.below(8),
        2 | 3 => {
            let value = HOSTILE_BYTES[rng.below(HOSTILE_BYTES.len())];
            // Binary headers keep their numbers at multiples of two.
            let at = at & !1;
            let length = [2, 4, 8][rng.below(3)];
            for (byte, value) in bytes[at..].iter_mut().zip(&value[..length]) {
                *byte = *value;
            }
        }
        4 | 5 => replace_part(
            bytes,
            range,
            |b| b.is_ascii_digit(),
            rng,
            |rng| rng.any_of(&HOSTILE_NUMBERS).to_owned(),
        ),
        6 => replace_part(
            bytes,
            range,
            |b| !b.is_ascii_whitespace(),
            rng,
            |rng| {
                words
                    .get(rng.below(words.len()))
                    .cloned()
                    .unwrap_or_default()
            },
        ),
        7 => drop(bytes.drain(at..end)),
        8 => {
            let part = bytes[at..end].to_vec();
            let to = rng.below(range);
            bytes.splice(to..to, part);
        }
        9 => change_line(bytes, rng),
        _ => {
            // Much of the same: long names, long lists.
            let part = bytes[at..end].repeat(1 + rng.below(200));
            bytes.splice(at..at, part);
        }
    }
}

/// Puts another text in the place of a run of bytes that are all of a kind.
fn replace_part(
    bytes: &mut Vec<u8>,
    range: usize,
    kind: impl Fn(u8) -> bool,
    rng: &mut Rng,
    text: impl Fn(&mut Rng) -> String,
) {
    let of_kind = |at: usize| kind(bytes[at]);
    let starts: Vec<usize> = (0..range)
        .filter(|&at| of_kind(at) && (at == 0 || !of_kind(at - 1)))
        .collect();
    let Some(&start) = starts.get(rng.below(starts.len())) else {
        return;
    };
    let length = bytes[start..].iter().take_while(|&&b| kind(b)).count();
    bytes.splice(start..start + length, text(rng).into_bytes());
}

/// Leaves a line out, doubles it, or puts it elsewhere.
fn change_line(bytes: &mut Vec<u8>, rng: &mut Rng) {
    let head = bytes.len().min(HEADER);
    let mut lines: Vec<Vec<u8>> = bytes[..head]
        .split_inclusive(|&b| b == b'\n')
        .map(<[u8]>::to_vec)
        .collect();
    let line = lines.remove(rng.below(lines.len()));
    for _ in 0..rng.below(3) {
        lines.insert(rng.below(lines.len() + 1), line.clone());
    }
    bytes.splice(..head, lines.concat());
}
