//! Everything that is printed: data to stdout, messages to stderr. A reader that has closed its end is no
//! error.
//!
//! What is printed quotes file names, headers and scene files, which may contain anything. Characters
//! that a terminal obeys (escape sequences, line breaks, changes of the reading direction) are therefore
//! shown escaped, here and nowhere else, so that no input moves the cursor or writes a line of ours.

use std::fmt::{self, Display, Write as _};
use std::io::{self, BufWriter, ErrorKind, Write};
use std::sync::OnceLock;

use serde::Serialize;
use serde_json::ser::{Formatter, PrettyFormatter, Serializer};

use crate::error::{Error, Result};

/// Writes data for programs to stdout as it is: for a format that has no control characters, or escapes
/// them. When its reader closes the pipe the rest is not wanted, which is fine.
pub fn to_stdout(data: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<()> {
    let mut out = BufWriter::new(io::stdout().lock());
    match data(&mut out).and_then(|()| out.flush()) {
        Err(cause) if cause.kind() != ErrorKind::BrokenPipe => Err(Error::resource(format!(
            "cannot write to the standard output: {cause}"
        ))),
        _ => {
            // What is left in the buffer has no reader.
            let _ = out.into_parts();
            Ok(())
        }
    }
}

/// Writes a JSON document for programs to stdout. Control characters and changes of the reading
/// direction in its strings are written as `\uXXXX`, which a reader turns back into the same string.
pub fn json_to_stdout(document: &impl Serialize) -> Result<()> {
    to_stdout(|out| {
        write_json(out, document)?;
        writeln!(out)
    })
}

/// Writes text for people to stdout, line by line.
pub fn lines_to_stdout(text: impl FnOnce(&mut Lines) -> io::Result<()>) -> Result<()> {
    to_stdout(|out| text(&mut Lines(out)))
}

/// Takes text for people, a line at a time.
pub struct Lines<'a>(&'a mut dyn Write);

impl Lines<'_> {
    /// Prints one line; a line break in `text` is shown as `\n`.
    pub fn line(&mut self, text: impl Display) -> io::Result<()> {
        writeln!(self.0, "{}", on_one_line(text))
    }

    /// Prints text that consists of lines, such as a help page.
    pub fn block(&mut self, text: impl Display) -> io::Result<()> {
        let text = text.to_string();
        text.lines().try_for_each(|line| self.line(line))
    }
}

/// Whether only errors are printed, once that is decided.
static QUIET: OnceLock<bool> = OnceLock::new();

/// Sets whether only errors are printed from now on. The first call is the one that counts: flags are
/// read before scene files.
pub fn set_quiet(quiet: bool) {
    let _ = QUIET.set(quiet);
}

/// Whether only errors are printed.
pub fn is_quiet() -> bool {
    QUIET.get().is_some_and(|quiet| *quiet)
}

/// Prints a line for the user on stderr, unless only errors are printed.
pub fn message(line: impl Display) {
    if !is_quiet() {
        say(line);
    }
}

/// A line on stderr. If that is closed, nothing reads it.
fn say(line: impl Display) {
    let _ = Lines(&mut io::stderr().lock()).line(line);
}

/// Something chosen or changed that the user may want to know.
pub fn note(sentence: impl Display) {
    message(format_args!("note: {sentence}"));
}

/// How the program is called, where it was called without saying what to do.
pub fn usage_text(text: impl Display) {
    let _ = Lines(&mut io::stderr().lock()).block(text);
}

pub fn error(error: &Error) {
    let _ = Lines(&mut io::stderr().lock()).block(lines(error));
}

/// An error as it is printed: a line, and one for its hint.
pub fn lines(error: &Error) -> String {
    let line = format!("error: {}\n", on_one_line(error));
    match error.hint_text() {
        Some(hint) => format!("{line}hint: {}\n", on_one_line(hint)),
        None => line,
    }
}

/// The text as a terminal may be given it: on one line, and obeyed in nothing.
pub fn on_one_line(text: impl Display) -> String {
    let mut shown = Escaping(String::new());
    // Writing to a string fails only where the text's own formatting does, and shows what came before.
    let _ = write!(shown, "{text}");
    shown.0
}

struct Escaping(String);

impl fmt::Write for Escaping {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        for c in text.chars() {
            match is_obeyed(c) {
                true => self.0.extend(c.escape_default()),
                false => self.0.push(c),
            }
        }
        Ok(())
    }
}

/// Characters that a terminal or a pager acts upon instead of showing them: controls (C0, DEL, C1), line
/// and paragraph separators, and what embeds, overrides or isolates a reading direction (Unicode
/// Standard Annex 9).
fn is_obeyed(c: char) -> bool {
    c.is_control()
        || matches!(c, '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}' | '\u{200e}' | '\u{200f}' | '\u{61c}')
}

/// Writes a JSON document as [`json_to_stdout`] does, without the line's end.
pub fn write_json(out: &mut dyn Write, document: &impl Serialize) -> io::Result<()> {
    let form = EscapedJson(PrettyFormatter::new());
    document.serialize(&mut Serializer::with_formatter(out, form))?;
    Ok(())
}

/// Pretty JSON, of whose strings nothing is obeyed: JSON itself escapes only C0.
struct EscapedJson(PrettyFormatter<'static>);

impl Formatter for EscapedJson {
    fn write_string_fragment<W: ?Sized + Write>(
        &mut self,
        out: &mut W,
        fragment: &str,
    ) -> io::Result<()> {
        for c in fragment.chars() {
            match is_obeyed(c) {
                // All of them have four hexadecimal digits at most.
                true => write!(out, "\\u{:04x}", u32::from(c))?,
                false => write!(out, "{c}")?,
            }
        }
        Ok(())
    }

    fn begin_array<W: ?Sized + Write>(&mut self, out: &mut W) -> io::Result<()> {
        self.0.begin_array(out)
    }

    fn end_array<W: ?Sized + Write>(&mut self, out: &mut W) -> io::Result<()> {
        self.0.end_array(out)
    }

    fn begin_array_value<W: ?Sized + Write>(&mut self, out: &mut W, first: bool) -> io::Result<()> {
        self.0.begin_array_value(out, first)
    }

    fn end_array_value<W: ?Sized + Write>(&mut self, out: &mut W) -> io::Result<()> {
        self.0.end_array_value(out)
    }

    fn begin_object<W: ?Sized + Write>(&mut self, out: &mut W) -> io::Result<()> {
        self.0.begin_object(out)
    }

    fn end_object<W: ?Sized + Write>(&mut self, out: &mut W) -> io::Result<()> {
        self.0.end_object(out)
    }

    fn begin_object_key<W: ?Sized + Write>(&mut self, out: &mut W, first: bool) -> io::Result<()> {
        self.0.begin_object_key(out, first)
    }

    fn begin_object_value<W: ?Sized + Write>(&mut self, out: &mut W) -> io::Result<()> {
        self.0.begin_object_value(out)
    }

    fn end_object_value<W: ?Sized + Write>(&mut self, out: &mut W) -> io::Result<()> {
        self.0.end_object_value(out)
    }
}

#[cfg(test)]
mod tests {
    use std::path::{Path, PathBuf};

    use super::*;

    /// One of every kind that a terminal acts upon, and what is harmless beside it.
    const HOSTILE: &str = "a\u{1b}[31m\nerror: b\r\t\0\u{7f}\u{9b}1m\u{85}\u{2028}\u{2029}\u{202e}\u{2066}\u{200f}é×日本 \\n";

    #[test]
    fn what_a_terminal_obeys_is_shown_escaped_and_all_else_as_it_is() {
        let shown = on_one_line(HOSTILE);
        let expected = "a\\u{1b}[31m\\nerror: b\\r\\t\\u{0}\\u{7f}\\u{9b}1m\\u{85}\\u{2028}\\u{2029}\\u{202e}\\u{2066}\\u{200f}é×日本 \\n";
        assert_eq!(shown, expected);
        assert!(!shown.chars().any(is_obeyed));
        // The control: it was there before.
        assert_eq!(HOSTILE.chars().filter(|c| is_obeyed(*c)).count(), 13);
    }

    #[test]
    fn all_embeddings_overrides_and_isolates_are_known() {
        let known = (0x202a..=0x202e).chain(0x2066..=0x2069).chain(0x80..=0x9f);
        for code in known {
            assert!(is_obeyed(char::from_u32(code).unwrap()), "{code:x}");
        }
        // The control: their neighbours.
        for code in [0x2027, 0x202f, 0x2065, 0x206a, 0xa0] {
            assert!(!is_obeyed(char::from_u32(code).unwrap()), "{code:x}");
        }
    }

    #[test]
    fn a_block_keeps_its_lines_and_nothing_else() {
        let mut out = Vec::new();
        let mut lines = Lines(&mut out);
        lines.block("one\n  two\u{1b}\n\nthree").unwrap();
        lines.line("four\nfive").unwrap();
        let expected = "one\n  two\\u{1b}\n\nthree\nfour\\nfive\n";
        assert_eq!(String::from_utf8(out).unwrap(), expected);
    }

    #[test]
    fn json_reads_the_same_and_nothing_in_it_is_obeyed() {
        let document = serde_json::json!({ HOSTILE: [HOSTILE, 1.5, null, {}], "b": {"c": []} });
        let mut out = Vec::new();
        write_json(&mut out, &document).unwrap();
        let text = String::from_utf8(out).unwrap();
        let obeyed = |text: &str| text.lines().any(|line| line.chars().any(is_obeyed));
        assert!(!obeyed(&text), "{text}");
        let back: serde_json::Value = serde_json::from_str(&text).unwrap();
        assert_eq!(back, document);
        // The control: the plain writer lets some through; without them both write the same.
        let plain = serde_json::to_string_pretty(&document).unwrap();
        assert!(obeyed(&plain));
        let tame = serde_json::json!({"a": ["é", 1.5, null, {}], "b": {"c": [[1], "\n\""]}});
        let mut out = Vec::new();
        write_json(&mut out, &tame).unwrap();
        assert_eq!(out, serde_json::to_vec_pretty(&tame).unwrap());
    }

    /// The places in the sources that print by themselves.
    fn printing(text: &str) -> Vec<&str> {
        const CALLS: [&str; 5] = ["print!(", "println!(", "dbg!(", "stdout()", "stderr()"];
        let code = text.split("#[cfg(test)]").next().unwrap_or_default();
        let lines = code
            .lines()
            .filter(|line| !line.trim_start().starts_with("//"));
        let lines = lines.filter(|line| CALLS.iter().any(|call| line.contains(call)));
        lines.collect()
    }

    #[test]
    fn nothing_else_prints() {
        fn sources(folder: &Path, found: &mut Vec<PathBuf>) {
            for entry in std::fs::read_dir(folder).unwrap().flatten() {
                match entry.path() {
                    path if path.is_dir() => sources(&path, found),
                    path if path.extension().is_some_and(|e| e == "rs") => found.push(path),
                    _ => {}
                }
            }
        }
        let home = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
        let mut files = Vec::new();
        sources(&home, &mut files);
        assert!(files.len() > 100);
        for file in files {
            let text = std::fs::read_to_string(&file).unwrap();
            let name = file.strip_prefix(&home).unwrap();
            // The bars draw by themselves, what is in them cleaned here.
            if name != Path::new("cli/terminal.rs") && !name.starts_with("cli/progress") {
                assert_eq!(printing(&text), [""; 0], "{}", name.display());
            }
        }
        // The control.
        assert_eq!(printing("a\n    eprintln!(\"x\");\n").len(), 1);
    }
}
