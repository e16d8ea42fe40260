//! Voxels spread over several files: lists and numbered names.

use std::collections::VecDeque;
use std::io::{self, BufReader, Read};
use std::path::{Path, PathBuf};

use super::payload::Payload;
use crate::error::{Error, Result};

/// The most files of one volume.
const MAX_FILES: u64 = 1 << 16;

/// The longest that the names of numbered files are, all together, in bytes.
const LONGEST_NAMES: usize = 1 << 23;

/// Where a header says its voxels are.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum DataFiles {
    /// The data follow the header in the same file.
    Attached,
    /// The data are in files beside the header, one after the other.
    Files(Vec<String>),
}

/// `NAME%03d.raw FIRST LAST STEP …`: the numbered names; `None` when the text has another form.
///
/// # Errors
/// The numbers make no sequence, or an absurdly long one.
pub(super) fn numbered(text: &str) -> Result<Option<Vec<String>>> {
    let words: Vec<&str> = text.split_whitespace().collect();
    let Some((pattern, range)) = words.split_first() else {
        return Ok(None);
    };
    if !pattern.contains('%') || range.len() < 3 {
        return Ok(None);
    }
    let numbers: Vec<i64> = range.iter().filter_map(|word| word.parse().ok()).collect();
    let &[first, last, step, ..] = &numbers[..] else {
        return Ok(None);
    };
    let wrong = |why: &str| Error::input(format!("the data files '{text}': {why}"));
    let distance = i128::from(last) - i128::from(first);
    if step == 0 || distance.signum() * i128::from(step).signum() < 0 {
        return Err(wrong("this step never arrives"));
    }
    let count = distance / i128::from(step) + 1;
    if count > i128::from(MAX_FILES) {
        return Err(wrong("too many files"));
    }
    let mut names = Vec::new();
    let mut bytes = 0;
    for k in 0..count {
        let name = formatted(pattern, i128::from(first) + k * i128::from(step))
            .ok_or_else(|| wrong("a number's place is written %d or, with leading zeros, %03d"))?;
        bytes += name.len();
        if bytes > LONGEST_NAMES {
            return Err(wrong("their names are too long"));
        }
        names.push(name);
    }
    Ok(Some(names))
}

/// C's printf with one integer: `%d`, `%i`, `%u`, each with a width, `%%`.
fn formatted(pattern: &str, number: i128) -> Option<String> {
    const WIDEST: usize = 20;
    let mut out = String::new();
    let mut rest = pattern;
    while let Some((before, after)) = rest.split_once('%') {
        out.push_str(before);
        if let Some(after) = after.strip_prefix('%') {
            out.push('%');
            rest = after;
            continue;
        }
        let end = after.find(|c: char| !c.is_ascii_digit())?;
        let (width, after) = after.split_at(end);
        let after = after.strip_prefix(['d', 'i', 'u'])?;
        let columns = if width.is_empty() {
            0
        } else {
            width.parse().ok().filter(|&columns| columns <= WIDEST)?
        };
        if width.starts_with('0') {
            out.push_str(&format!("{number:0columns$}"));
        } else {
            out.push_str(&format!("{number:columns$}"));
        }
        rest = after;
    }
    out.push_str(rest);
    Some(out)
}

/// Opens one data file up to its voxels, decoders included.
pub(super) type OpenPayload = Box<dyn FnMut(&Path) -> Result<Payload>>;

/// The files' voxels in one: a single file as it is (so that it can be mapped), several one after
/// the other, each with an equal share of the `total` bytes.
///
/// # Errors
/// No file, or a total that cannot be shared; a single file that cannot be opened. The other
/// files' errors come while reading.
pub(super) fn joined(
    header: &Path,
    names: &[String],
    total: u64,
    mut open: OpenPayload,
) -> Result<Payload> {
    let folder = header.parent().unwrap_or(Path::new(""));
    if let [name] = names {
        let path = folder.join(name);
        return open(&path).map_err(|error| error.at(path.display()));
    }
    let count = names.len() as u64;
    if count == 0 || count > MAX_FILES || !total.is_multiple_of(count) {
        return Err(Error::input(format!(
            "{total} bytes of voxels announced in {count} data files: they cannot have equal parts"
        )));
    }
    Ok(Payload::Stream {
        reader: Box::new(BufReader::new(Joined {
            files: names.iter().map(|name| folder.join(name)).collect(),
            share: total / count,
            open,
            current: None,
        })),
        max_bytes: total,
    })
}

struct Joined {
    files: VecDeque<PathBuf>,
    share: u64,
    open: OpenPayload,
    current: Option<Part>,
}

struct Part {
    path: PathBuf,
    reader: Box<dyn Read>,
    left: u64,
}

impl Joined {
    fn next_part(&mut self) -> io::Result<Option<Part>> {
        let Some(path) = self.files.pop_front() else {
            return Ok(None);
        };
        let payload = (self.open)(&path)
            .map_err(|error| io::Error::other(error.at(path.display()).to_string()))?;
        let (reader, max_bytes) = payload.into_reader();
        if max_bytes < self.share {
            return Err(io::Error::other(format!(
                "{}: cannot hold more than {max_bytes} bytes of its share of {}",
                path.display(),
                self.share
            )));
        }
        Ok(Some(Part {
            reader,
            path,
            left: self.share,
        }))
    }
}

impl Read for Joined {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        if self.current.as_ref().is_none_or(|part| part.left == 0) {
            self.current = self.next_part()?;
        }
        let Some(part) = &mut self.current else {
            return Ok(0);
        };
        let wanted = part.left.min(buffer.len() as u64) as usize;
        if wanted == 0 {
            return Ok(0);
        }
        let count = part
            .reader
            .read(&mut buffer[..wanted])
            .map_err(|cause| io::Error::other(format!("{}: {cause}", part.path.display())))?;
        if count == 0 {
            return Err(io::Error::other(format!(
                "{}: ends {} bytes before its share of {}",
                part.path.display(),
                part.left,
                self.share
            )));
        }
        part.left -= count as u64;
        Ok(count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbered_names_follow_printf() {
        let names = numbered("s%03d_%d.raw 8 12 2").unwrap().unwrap();
        assert_eq!(names, ["s008_8.raw", "s010_10.raw", "s012_12.raw"]);
        assert_eq!(numbered("s%d 3 1 -1 2").unwrap().unwrap().len(), 3);
        assert_eq!(numbered("my file.raw").unwrap(), None);
        for bad in [
            "s%d 1 9 0",
            "s%d 1 9 -1",
            "s%d 0 9223372036854775807 1",
            "s%n 1 2 1",
            "s%999999999d 1 2 1",
            "s% 1 2 1",
        ] {
            assert!(numbered(bad).is_err(), "{bad}");
        }
        // Few bytes that would be gigabytes of names: by a long name, and by a widened number.
        let many = |pattern: &str| numbered(&format!("{pattern} 1 65536 1"));
        assert!(many(&format!("{}%d", "s".repeat(1000))).is_err());
        assert!(many(&"%20d".repeat(100)).is_err());
        assert_eq!(many("slice%d").unwrap().unwrap().len(), 1 << 16);
    }
}
