//! The files that an experiment leaves.

use std::io::Write;
use std::path::{Path, PathBuf};

use serde_json::json;

use crate::error::{Error, Result};
use crate::output::{check_writable, write_atomically};

use super::{Bench, Experiment, Outcome};

/// `results.csv` and `results.json` in one folder.
pub struct Results {
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
            csv: folder.join("results.csv"),
            json: folder.join("results.json"),
        };
        check_writable(&results.csv)?;
        check_writable(&results.json)?;
        Ok(results)
    }

    /// # Errors
    /// The disk.
    pub fn write(&self, bench: &Bench, experiment: &Experiment, outcome: &Outcome) -> Result<()> {
        let device = bench.device.info();
        let effort = bench.effort;
        let document = json!({
            "version": env!("CARGO_PKG_VERSION"),
            "command": "bench",
            "experiment": experiment.name,
            "size": [effort.side_px(), effort.side_px()],
            "repeats": effort.repeats(),
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

    /// The files, for the user.
    pub fn paths(&self) -> [&Path; 2] {
        [&self.csv, &self.json]
    }
}

fn write_text(path: &Path, text: &str) -> Result<()> {
    write_atomically(path, |out| {
        out.write_all(text.as_bytes())
            .map_err(|cause| Error::io(path, "write", &cause))
    })
}
