//! What a page or a file of results says of places, which is read elsewhere: names without the folders
//! in which things lay.

use std::path::Path;

/// How a program was called, to be repeated elsewhere: quoted for a POSIX shell, every file and folder by
/// its name alone, also in the command of a peer.
pub fn command_line(words: impl IntoIterator<Item = String>) -> String {
    let mut before = String::new();
    let words = words.into_iter().map(|word| {
        let shown = match word.strip_prefix("--peer=") {
            Some(command) => format!("--peer={}", peer_command(command)),
            None if before == "--peer" => peer_command(&word),
            None => with_name_alone(&word),
        };
        before = word;
        quoted(&shown)
    });
    words.collect::<Vec<_>>().join(" ")
}

/// A peer's command, its files by their names alone.
pub fn peer_command(command: &str) -> String {
    let words = shlex::split(command).unwrap_or_else(|| vec![command.to_owned()]);
    let words = words.iter().map(|word| quoted(&with_name_alone(word)));
    words.collect::<Vec<_>>().join(" ")
}

/// A sentence without the folders of the absolute paths in it.
pub fn without_folders(sentence: &str) -> String {
    let begins_word = |c: char| c.is_whitespace() || "'\"([=,:;".contains(c);
    let ends_path = |c: char| c.is_whitespace() || "'\")],:;".contains(c);
    let mut shown = String::new();
    let mut rest = sentence;
    while let Some(at) = rest.find('/') {
        let (before, path) = rest.split_at(at);
        let begins = match before.chars().next_back().or(shown.chars().next_back()) {
            None => true,
            // An address such as https://… is no path.
            Some(':') => !path.starts_with("//"),
            Some(c) => begins_word(c),
        };
        shown.push_str(before);
        let end = path.find(ends_path).unwrap_or(path.len());
        match begins {
            true => shown.push_str(&name_of(&path[..end])),
            false => shown.push_str(&path[..end]),
        }
        rest = &path[end..];
    }
    shown + rest
}

/// An argument whose value, where it is a path, is the path's last name.
fn with_name_alone(word: &str) -> String {
    let value_at = match word.as_bytes() {
        [b'-', b'-', ..] => word.find('=').map_or(0, |at| at + 1),
        [b'-', letter, ..] if letter.is_ascii_alphabetic() => 2,
        _ => 0,
    };
    let (flag, value) = word.split_at(value_at);
    match is_path(value) {
        true => format!("{flag}{}", name_of(value)),
        false => word.to_owned(),
    }
}

/// Whether a value names a file in a folder; a fraction such as `max:1/255` has its slash between
/// digits.
fn is_path(value: &str) -> bool {
    let bytes = value.as_bytes();
    let is_digit = |at: Option<usize>| {
        at.and_then(|at| bytes.get(at))
            .is_some_and(u8::is_ascii_digit)
    };
    let mut slashes = (0..bytes.len()).filter(|&at| bytes[at] == b'/');
    slashes.any(|at| !(is_digit(at.checked_sub(1)) && is_digit(Some(at + 1))))
}

/// The last name of a path; of one that has none, such as `/` or `../..`, the folder itself.
fn name_of(path: &str) -> String {
    let name = Path::new(path).file_name();
    name.map_or(".".into(), |name| name.to_string_lossy().into_owned())
}

/// A word as a shell reads it.
fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_./:=,%+@".contains(c);
    if !word.is_empty() && word.chars().all(plain) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', r"'\''"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_quoted_where_a_shell_would_split_or_change_them() {
        for (word, expected) in [
            ("--iso=50%", "--iso=50%"),
            ("LAO 30", "'LAO 30'"),
            ("", "''"),
            ("it's", r"'it'\''s'"),
            ("$HOME", "'$HOME'"),
            ("a*", "'a*'"),
        ] {
            assert_eq!(quoted(word), expected);
        }
    }

    #[test]
    fn a_command_names_files_without_their_folders() {
        for (word, expected) in [
            ("/home/me/my data/head.nrrd", "head.nrrd"),
            ("../x/head.nrrd", "head.nrrd"),
            ("/home/me/my data/a b.nrrd", "'a b.nrrd'"),
            ("--tf=/home/me/tf.toml", "--tf=tf.toml"),
            ("-o/home/me/out/", "-oout"),
            ("--mesh=/a/b.stl:red", "--mesh=b.stl:red"),
            ("/", "."),
            ("../..", "."),
            ("2024/ct/head.nrrd", "head.nrrd"),
            // The control: what is no path stays.
            ("max:1/255", "max:1/255"),
            ("--max-error=max:1/255", "--max-error=max:1/255"),
            ("1/4", "1/4"),
            ("--azimuth", "--azimuth"),
            ("-0.5,1,2", "-0.5,1,2"),
            ("head.nrrd", "head.nrrd"),
        ] {
            assert_eq!(command_line([word.to_owned()]), expected, "{word}");
        }
        let words = [
            "compare",
            "--peer",
            "'/opt/my python' /srv/peer.py --fast",
            "-o",
            "/tmp/x",
        ];
        assert_eq!(
            command_line(words.map(str::to_owned)),
            r"compare --peer ''\''my python'\'' peer.py --fast' -o x"
        );
        assert_eq!(
            command_line(["--peer=/bin/a /b/c".to_owned()]),
            "'--peer=a c'"
        );
    }

    #[test]
    fn a_sentence_names_files_without_their_folders() {
        for (sentence, expected) in [
            (
                "/a/b/c.txt: cannot write: full",
                "c.txt: cannot write: full",
            ),
            (
                "it ended: File \"/usr/x.py\", line 3",
                "it ended: File \"x.py\", line 3",
            ),
            ("(folder '/a/b')", "(folder 'b')"),
            ("no /x", "no x"),
            ("path=/a/b and /c/d", "path=b and d"),
            // The control: what is no absolute path stays.
            ("1/255 of 3 km/h, and/or", "1/255 of 3 km/h, and/or"),
            ("see https://example.org/a", "see https://example.org/a"),
            ("", ""),
        ] {
            assert_eq!(without_folders(sentence), expected);
        }
    }
}
