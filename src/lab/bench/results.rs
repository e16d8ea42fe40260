//! The files that an experiment leaves.

use std::path::{Path, PathBuf};

use serde_json::{Value, json};

use crate::VERSION;
use crate::error::{Error, Result};
use crate::frame::{self, Encoding, Format};
use crate::lab::report::peer_command;
use crate::output::{check_writable, write_bytes};

use super::page::report;
use super::{Bench, Illustration, Outcome, Run};

/// The identity of the run, a peer's command without folders.
fn passed_on(run: &Run) -> Value {
    let mut value = run.value();
    if let Some(Value::String(peer)) = value.get_mut("peer") {
        *peer = peer_command(peer);
    }
    value
}

/// `results.csv` and `results.json` in one folder; in the end pictures and `report.html` beside them.
pub struct Results {
    folder: PathBuf,
    csv: PathBuf,
    json: PathBuf,
    page: PathBuf,
}

impl Results {
    /// Creates the folder if it does not exist.
    ///
    /// # Errors
    /// It cannot be made, or takes no files.
    pub fn in_folder(folder: &Path) -> Result<Self> {
        std::fs::create_dir_all(folder)
            .map_err(|cause| Error::writing(folder, "make the folder", &cause))?;
        let results = Self {
            folder: folder.to_owned(),
            csv: folder.join("results.csv"),
            json: folder.join("results.json"),
            page: folder.join("report.html"),
        };
        results.tables().into_iter().try_for_each(check_writable)?;
        Ok(results)
    }

    /// Removes what another run has left here, which would be mistaken for results of this one.
    ///
    /// # Errors
    /// The disk.
    pub fn forget(&self) -> Result<()> {
        for path in self.tables() {
            if path.is_file() {
                std::fs::remove_file(path)
                    .map_err(|cause| Error::writing(path, "remove the file", &cause))?;
            }
        }
        Ok(())
    }

    fn tables(&self) -> [&Path; 3] {
        [&self.csv, &self.json, &self.page]
    }

    /// Writes the table; `finished` says whether all files are whole.
    ///
    /// # Errors
    /// The disk.
    pub fn write(&self, bench: &Bench, run: &Run, outcome: &Outcome, finished: bool) -> Result<()> {
        let device = bench.device.info();
        let conditions = outcome.conditions;
        let document = json!({
            "version": VERSION,
            "command": "bench",
            "command_line": bench.command,
            "experiment": bench.experiment.name,
            "finished": finished,
            "run": passed_on(run),
            "size": conditions.side_px.map(|side_px| [side_px, side_px]),
            "repeats": conditions.repeats,
            "protocol": conditions.protocol.map(|protocol| protocol.name()),
            "device": {
                "name": device.name,
                "platform": device.platform,
                "driver": device.driver,
            },
            "rows": outcome.table.json(),
            "findings": outcome.findings,
            "failure": outcome.failure,
        });
        write_bytes(&self.csv, outcome.table.csv().as_bytes())?;
        write_bytes(&self.json, format!("{document:#}\n").as_bytes())
    }

    /// Writes everything, the table last, and returns the files.
    ///
    /// # Errors
    /// The disk.
    pub fn write_all(&self, bench: &Bench, run: &Run, outcome: &Outcome) -> Result<Vec<PathBuf>> {
        let mut files = vec![self.csv.clone(), self.json.clone()];
        let names = Illustration::files(&outcome.pictures);
        for (picture, name) in outcome.pictures.iter().zip(names) {
            let path = self.folder.join(name);
            frame::write(&path, &picture.frame, &Encoding::new(Format::Png), &[])?;
            files.push(path);
        }
        report(bench, outcome, &self.folder)?.write(&self.page)?;
        files.push(self.page.clone());
        self.write(bench, run, outcome, true)?;
        Ok(files)
    }
}
