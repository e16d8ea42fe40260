//! The files that an experiment leaves.

use std::io::Write;
use std::path::{Path, PathBuf};

use serde_json::json;

use crate::error::{Error, Result};
use crate::frame::{self, Encoding, Format};
use crate::output::{check_writable, write_atomically};

use super::page::report;
use super::{Bench, Outcome};

/// `results.csv` and `results.json` in one folder; in the end pictures and `report.html` beside them.
pub struct Results {
    folder: PathBuf,
    csv: PathBuf,
    json: PathBuf,
}

impl Results {
    /// Makes the folder where there is none.
    ///
    /// # Errors
    /// It cannot be made, or takes no files.
    pub fn in_folder(folder: &Path) -> Result<Self> {
        std::fs::create_dir_all(folder)
            .map_err(|cause| Error::io(folder, "make the folder", &cause))?;
        let results = Self {
            folder: folder.to_owned(),
            csv: folder.join("results.csv"),
            json: folder.join("results.json"),
        };
        check_writable(&results.csv)?;
        check_writable(&results.json)?;
        Ok(results)
    }

    /// Writes the table; `finished` tells whether it is whole.
    ///
    /// # Errors
    /// The disk.
    pub fn write(&self, bench: &Bench, outcome: &Outcome, finished: bool) -> Result<()> {
        let device = bench.device.info();
        let effort = bench.effort;
        let document = json!({
            "version": env!("CARGO_PKG_VERSION"),
            "command": "bench",
            "experiment": bench.experiment.name,
            "finished": finished,
            "size": [effort.side_px(), effort.side_px()],
            "repeats": effort.repeats(),
            "protocol": bench.protocol().name(),
            "device": {
                "name": device.name,
                "platform": device.platform,
                "driver": device.driver,
            },
            "rows": outcome.table.json(),
            "findings": outcome.findings,
            "failure": outcome.failure,
        });
        write_text(&self.csv, &outcome.table.csv())?;
        write_text(&self.json, &format!("{document:#}\n"))
    }

    /// Writes everything, and gives the files.
    ///
    /// # Errors
    /// The disk.
    pub fn write_all(&self, bench: &Bench, outcome: &Outcome) -> Result<Vec<PathBuf>> {
        self.write(bench, outcome, true)?;
        let mut files = vec![self.csv.clone(), self.json.clone()];
        for picture in &outcome.pictures {
            let path = self.folder.join(picture.file());
            frame::write(&path, &picture.frame, &Encoding::new(Format::Png), &[])?;
            files.push(path);
        }
        let page = self.folder.join("report.html");
        report(bench, outcome, &self.folder)?.write(&page)?;
        files.push(page);
        Ok(files)
    }
}

fn write_text(path: &Path, text: &str) -> Result<()> {
    write_atomically(path, |out| {
        out.write_all(text.as_bytes())
            .map_err(|cause| Error::io(path, "write", &cause))
    })
}
