//! The metadata of PNG and EXR: read back from the file alone, whole or spoiled.

use std::fs;

use angioray::frame::{Encoding, Format, read_metadata, write};

use super::{METADATA, picture};

#[test]
fn metadata_comes_back_from_png_and_exr_alone() {
    let folder = tempfile::tempdir().unwrap();
    let expected = METADATA.map(|(key, text)| (key.to_owned(), text.to_owned()));
    for name in ["a.png", "a.exr"] {
        let path = folder.path().join(name);
        let encoding = Encoding::new(Format::from_path(&path).unwrap());
        write(&path, &picture(), &encoding, &METADATA).unwrap();
        assert_eq!(read_metadata(&path).unwrap(), expected, "{name}");
        // A file cut short is refused, or gives all; it never panics or makes up a part.
        let whole = fs::read(&path).unwrap();
        let cut = folder.path().join("cut");
        for length in 0..whole.len() {
            fs::write(&cut, &whole[..length]).unwrap();
            match read_metadata(&cut) {
                Ok(pairs) => assert_eq!(pairs, expected, "{name} cut at {length}"),
                Err(error) => assert_eq!(error.exit_code(), 65),
            }
        }
        fs::write(&cut, &whole[..60]).unwrap();
        assert!(read_metadata(&cut).is_err(), "{name}");

        write(&path, &picture(), &encoding, &[]).unwrap();
        assert_eq!(read_metadata(&path).unwrap(), [], "{name}");
    }
    let path = folder.path().join("a.webp");
    write(&path, &picture(), &Encoding::new(Format::WebP), &METADATA).unwrap();
    let message = read_metadata(&path).unwrap_err().to_string();
    assert!(message.contains("neither a PNG nor an EXR"), "{message}");
}

/// Reading ends, with an answer or a sentence, whatever a byte of the header says.
#[test]
fn spoiled_headers_do_not_bring_the_reader_down() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["a.png", "a.exr"] {
        let path = folder.path().join(name);
        let encoding = Encoding::new(Format::from_path(&path).unwrap());
        write(&path, &picture(), &encoding, &METADATA).unwrap();
        let whole = fs::read(&path).unwrap();
        let mut refused = 0;
        for at in 0..whole.len().min(500) {
            for spoiled in [0, 0x7f, 0xff, whole[at] ^ 1, whole[at] ^ 0x20] {
                let mut bytes = whole.clone();
                bytes[at] = spoiled;
                fs::write(&path, &bytes).unwrap();
                refused += usize::from(read_metadata(&path).is_err());
            }
        }
        assert!(refused > 20, "{name}: {refused}");
    }
}
