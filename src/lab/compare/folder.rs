//! The folder that a comparison fills.

use std::path::{Path, PathBuf};

use serde_json::Value;

use crate::error::{Error, Result};
use crate::output::{check_folder, check_writable, write_bytes};
use crate::scene::Mode;

use super::Compared;
use super::columns::whole_table;
use super::look::Look;

/// `DIR`, with `results.json`, `results.csv`, `report.html`, and `pictures/`.
#[derive(Debug, Clone)]
pub struct Folder {
    path: PathBuf,
}

impl Folder {
    const PICTURES: &str = "pictures";

    /// The folder of a comparison, which may exist already; nothing is made yet.
    ///
    /// # Errors
    /// The folder exists and takes no files, or cannot be made.
    pub fn new(path: &Path) -> Result<Self> {
        let folder = Self {
            path: path.to_owned(),
        };
        check_folder(&path.join(Self::PICTURES))?;
        if path.exists() {
            for file in [folder.json(), folder.csv(), folder.report()] {
                check_writable(&file)?;
            }
        }
        Ok(folder)
    }

    /// Creates the folder if it does not exist.
    ///
    /// # Errors
    /// The disk.
    pub fn make(&self) -> Result<()> {
        let pictures = self.path.join(Self::PICTURES);
        std::fs::create_dir_all(&pictures)
            .map_err(|cause| Error::writing(&pictures, "make the folder", &cause))
    }

    /// The rows and all that is beside them, for programs.
    pub fn json(&self) -> PathBuf {
        self.path.join("results.json")
    }

    /// The path of the rows' figures.
    pub fn csv(&self) -> PathBuf {
        self.path.join("results.csv")
    }

    /// The path of the report page.
    pub fn report(&self) -> PathBuf {
        self.path.join("report.html")
    }

    /// The name within the folder, without its ending, of the pictures of a mode's candidate, whose
    /// number makes the name one of its own; of the title as much as a file's name should hold.
    pub fn picture_name(of_mode: &str, number: usize, title: &str) -> String {
        const MAX_LENGTH: usize = 60;
        let plain = |c: char| c.is_ascii_alphanumeric() || c == '.';
        let words = title.split(|c| !plain(c)).filter(|word| !word.is_empty());
        let mut slug = words.collect::<Vec<_>>().join("-").to_lowercase();
        slug.truncate(MAX_LENGTH);
        format!("{}/{of_mode}-{number:02}-{slug}", Self::PICTURES)
    }

    /// Whether a file among the pictures has a name that a comparison gives.
    fn is_picture(name: &str) -> bool {
        let number = |rest: &str| {
            let digits = rest.bytes().take_while(u8::is_ascii_digit).count();
            digits >= 2 && rest[digits..].starts_with('-')
        };
        let of = |mode: Mode| {
            let rest = name.strip_prefix(&mode.to_string())?.strip_prefix('-')?;
            let of_look = |look: Look| rest.strip_prefix(look.name())?.strip_prefix('-');
            let looks = Look::ALL.into_iter().filter_map(of_look);
            Some(number(rest) || looks.into_iter().any(number))
        };
        let ending = name.ends_with(".png") || name.ends_with(".exr");
        ending && Mode::ALL.into_iter().filter_map(of).any(|is| is)
    }

    /// Removes what an earlier comparison left here: its page and its pictures, which would otherwise lie
    /// beside results that are not theirs.
    ///
    /// # Errors
    /// The disk.
    pub fn clear(&self) -> Result<()> {
        let pictures = self.path.join(Self::PICTURES);
        let entries = std::fs::read_dir(&pictures)
            .map_err(|cause| Error::reading(&pictures, "read the folder", &cause))?;
        let names = entries.flatten().map(|entry| entry.file_name());
        let old = names.filter(|name| name.to_str().is_some_and(Self::is_picture));
        let old = old.map(|name| pictures.join(name));
        let all = old.chain([self.report(), self.json(), self.csv()]);
        for path in all.filter(|path| path.is_file()) {
            std::fs::remove_file(&path).map_err(|cause| Error::writing(&path, "remove", &cause))?;
        }
        Ok(())
    }

    /// The file of that name.
    pub fn file(&self, name: &str) -> PathBuf {
        self.path.join(name)
    }

    /// The results as far as they are known: `about` and what is known, and all figures as CSV.
    ///
    /// # Errors
    /// The disk.
    pub(super) fn write_results(&self, about: &Value, known: &Compared) -> Result<()> {
        let mut document = about.clone();
        let json = |cause| Error::failed(format!("the results are not JSON: {cause}"));
        document["scenes"] = serde_json::to_value(&known.scenes).map_err(json)?;
        document["max_error"] = serde_json::to_value(&known.choices).map_err(json)?;
        document["findings"] = serde_json::to_value(&known.findings).map_err(json)?;
        document["rows"] = serde_json::to_value(&known.rows).map_err(json)?;
        write_bytes(&self.json(), format!("{document:#}\n").as_bytes())?;
        write_bytes(&self.csv(), whole_table(&known.rows).csv().as_bytes())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_pictures_of_a_comparison_are_removed() {
        let place = tempfile::tempdir().unwrap();
        let folder = Folder::new(place.path()).unwrap();
        folder.make().unwrap();
        let name = Folder::picture_name("iso-lit", 3, &"Step 0.5, plain".repeat(30));
        assert!(
            name.starts_with("pictures/iso-lit-03-step-0.5-plain"),
            "{name}"
        );
        assert!(name.len() < 90, "{name}");
        let ours = [
            format!("{name}.png"),
            format!("{name}-error.exr"),
            "report.html".into(),
        ];
        let others = [
            "pictures/iso.png",
            "pictures/iso-3a.png",
            "pictures/my-01-a.png",
            "a.txt",
        ];
        let all = || ours.iter().map(String::as_str).chain(others);
        all().for_each(|name| std::fs::write(folder.file(name), "").unwrap());
        folder.clear().unwrap();
        let left: Vec<&str> = all().filter(|name| folder.file(name).exists()).collect();
        assert_eq!(left, others);
    }
}
