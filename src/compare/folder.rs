//! The folder that a comparison fills.

use std::io::Write;
use std::path::{Path, PathBuf};

use serde_json::Value;

use crate::error::{Error, Result};
use crate::output::{check_writable, write_atomically};

use super::columns::whole_table;
use super::row::Row;

/// `DIR`, with `results.json`, `results.csv`, `report.html`, and `pictures/`.
#[derive(Debug, Clone)]
pub struct Folder {
    path: PathBuf,
}

impl Folder {
    const PICTURES: &str = "pictures";

    /// One that may be there already. Makes nothing yet.
    ///
    /// # Errors
    /// It is there and takes no files.
    pub fn new(path: &Path) -> Result<Self> {
        let folder = Self {
            path: path.to_owned(),
        };
        if path.exists() {
            for file in [folder.json(), folder.csv(), folder.report()] {
                check_writable(&file)?;
            }
        }
        Ok(folder)
    }

    /// Makes it where there is none.
    ///
    /// # Errors
    /// The disk.
    pub fn make(&self) -> Result<()> {
        let pictures = self.path.join(Self::PICTURES);
        std::fs::create_dir_all(&pictures)
            .map_err(|cause| Error::io(&pictures, "make the folder", &cause))
    }

    pub fn json(&self) -> PathBuf {
        self.path.join("results.json")
    }

    pub fn csv(&self) -> PathBuf {
        self.path.join("results.csv")
    }

    pub fn report(&self) -> PathBuf {
        self.path.join("report.html")
    }

    /// The name within the folder, without its ending, of the pictures of a mode's contender, whose
    /// number makes the name one of its own.
    pub fn picture_name(mode: &str, number: usize, title: &str) -> String {
        let plain = |c: char| c.is_ascii_alphanumeric() || c == '.';
        let words = title.split(|c| !plain(c)).filter(|word| !word.is_empty());
        let slug = words.collect::<Vec<_>>().join("-").to_lowercase();
        format!("{}/{mode}-{number:02}-{slug}", Self::PICTURES)
    }

    /// The file of that name.
    pub fn file(&self, name: &str) -> PathBuf {
        self.path.join(name)
    }

    /// The results as far as they are known: `about` with the rows, and all figures as CSV.
    ///
    /// # Errors
    /// The disk.
    pub fn write_results(&self, about: &Value, rows: &[Row]) -> Result<()> {
        let mut document = about.clone();
        document["rows"] = serde_json::to_value(rows)
            .map_err(|cause| Error::failed(format!("the results are no JSON: {cause}")))?;
        write_text(&self.json(), &format!("{document:#}\n"))?;
        write_text(&self.csv(), &whole_table(rows).csv())
    }
}

fn write_text(path: &Path, text: &str) -> Result<()> {
    write_atomically(path, |out| {
        out.write_all(text.as_bytes())
            .map_err(|cause| Error::io(path, "write", &cause))
    })
}
