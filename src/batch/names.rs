//! The files of a sequence: a name with a place for the frame's number.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use crate::error::{Error, Result};

/// A path whose file name has one place for a number, as in C and in ffmpeg: `%d`, or `%04d` for
/// at least four digits with zeros before; `%%` is a percent sign.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FrameNames {
    folder: PathBuf,
    before: String,
    digits: usize,
    after: String,
}

impl FrameNames {
    const MAX_DIGITS: usize = 20;

    /// Reads a pattern.
    ///
    /// # Errors
    /// No place, more than one, or something else after a percent sign (usage).
    pub fn of(pattern: &Path) -> Result<Self> {
        let wrong = |why: &str| {
            Error::usage(format!("{}: {why}", pattern.display())).hint(
                "write the frame's number as %04d in the file's name, such as frames/%04d.png",
            )
        };
        let Some(name) = pattern.file_name() else {
            return Err(wrong("this names no file"));
        };
        let Some(name) = name.to_str() else {
            return Err(wrong("the file's name is not UTF-8"));
        };
        let mut texts = vec![String::new()];
        let mut places = Vec::new();
        let mut rest = name;
        while let Some((text, after)) = rest.split_once('%') {
            let last = texts.len() - 1;
            texts[last].push_str(text);
            if let Some(after) = after.strip_prefix('%') {
                texts[last].push('%');
                rest = after;
                continue;
            }
            let digits = after.len() - after.trim_start_matches(|c: char| c.is_ascii_digit()).len();
            let (width, after) = after.split_at(digits);
            let Some(after) = after.strip_prefix('d') else {
                return Err(wrong("after % there may be d, digits and d, or another %"));
            };
            let width = match width {
                "" => Some(0),
                width if width.starts_with('0') => width.parse().ok(),
                _ => return Err(wrong("a number's width is written with a zero before it")),
            };
            match width.filter(|&width| width <= Self::MAX_DIGITS) {
                Some(width) => places.push(width),
                None => return Err(wrong("no frame number has so many digits")),
            }
            texts.push(String::new());
            rest = after;
        }
        let last = texts.len() - 1;
        texts[last].push_str(rest);
        match (&places[..], &texts[..]) {
            ([digits], [before, after]) => Ok(Self {
                folder: pattern.parent().unwrap_or(Path::new("")).to_owned(),
                before: before.clone(),
                digits: *digits,
                after: after.clone(),
            }),
            ([], _) => Err(wrong("every frame would have this name")),
            _ => Err(wrong("a frame has one number")),
        }
    }

    /// The folder that the frames lie in; empty for the working folder.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// The file of a frame.
    pub fn path(&self, frame: u32) -> PathBuf {
        self.folder.join(self.name(frame))
    }

    /// The frame whose file has this name, in whatever folder.
    pub fn frame(&self, name: &OsStr) -> Option<u32> {
        let name = name.to_str()?;
        let number = name
            .strip_prefix(&*self.before)?
            .strip_suffix(&*self.after)?;
        let frame = number.parse().ok()?;
        // Neither signs nor other widths.
        (self.name(frame) == name).then_some(frame)
    }

    fn name(&self, frame: u32) -> String {
        let Self {
            before,
            digits,
            after,
            ..
        } = self;
        format!("{before}{frame:0digits$}{after}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_those_of_printf() {
        let name = |pattern: &str, frame| {
            let names = FrameNames::of(Path::new(pattern)).unwrap();
            names.path(frame).to_str().unwrap().to_owned()
        };
        assert_eq!(name("frames/%04d.png", 7), "frames/0007.png");
        assert_eq!(name("frames/%04d.png", 12345), "frames/12345.png");
        assert_eq!(name("%d.png", 12), "12.png");
        assert_eq!(name("100%%_%02d_of_3.exr", 1), "100%_01_of_3.exr");
        assert_eq!(name("/a/%%d/b%03d", 1), "/a/%%d/b001");
        let names = FrameNames::of(Path::new("a/b/%d.png")).unwrap();
        assert_eq!(names.folder(), Path::new("a/b"));
    }

    #[test]
    fn a_frame_is_known_by_its_name() {
        let names = FrameNames::of(Path::new("f/a%03d.png")).unwrap();
        let frame = |name: &str| names.frame(OsStr::new(name));
        for number in [0, 7, 999, 1000, u32::MAX] {
            let path = names.path(number);
            assert_eq!(names.frame(path.file_name().unwrap()), Some(number));
        }
        for other in [
            "a7.png",
            "a0007.png",
            "a+07.png",
            "a007.jpg",
            "b007.png",
            "a.png",
        ] {
            assert_eq!(frame(other), None, "{other}");
        }
        assert_eq!(frame("a4294967296.png"), None);
    }

    #[test]
    fn other_patterns_are_refused_in_one_sentence() {
        for (pattern, why) in [
            ("a.png", "every frame would have this name"),
            ("%04d/a.png", "every frame would have this name"),
            ("%%.png", "every frame would have this name"),
            ("%d_%d.png", "one number"),
            ("%4d.png", "zero before"),
            ("%s.png", "after %"),
            ("%04", "after %"),
            ("%", "after %"),
            ("%021d.png", "so many digits"),
            ("%0999999999999999999999d.png", "so many digits"),
            ("..", "names no file"),
        ] {
            let error = FrameNames::of(Path::new(pattern)).unwrap_err();
            assert!(error.to_string().contains(why), "{pattern}: {error}");
            assert!(error.hint_text().is_some());
            assert_eq!(error.exit_code(), 2);
        }
    }
}
