//! The folder of a run: its results so far, and how it resumes after a stop.

use std::cell::RefCell;
use std::collections::HashMap;
use std::path::{Path, PathBuf};

use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::error::{Error, Result};
use crate::stop;

use super::journal::{Journal, Run};
use super::results::Results;
use super::{Bench, Outcome};

/// The folder of a run, opened before the work begins, so that what cannot be written is known then.
pub struct Store {
    folder: PathBuf,
    /// The identity of the run.
    run: Run,
    results: Results,
    journal: RefCell<Journal>,
    /// Units measured before this process began.
    before: usize,
    /// How often each key was used: two volumes may have one name.
    used: RefCell<HashMap<String, usize>>,
}

impl Store {
    /// Creates the folder if it does not exist. The work ends between two units, or in one, when
    /// [`stop::requested`] says so. What another run has left there is removed.
    ///
    /// # Errors
    /// The folder cannot be made, takes no files, or holds what another run has left unfinished.
    pub fn in_folder(folder: &Path, run: &Run, restart: bool) -> Result<Self> {
        let results = Results::in_folder(folder)?;
        let journal = Journal::open(folder, run, restart)?;
        if journal.is_begun() {
            results.forget()?;
        }
        Ok(Self {
            run: run.clone(),
            folder: folder.to_owned(),
            results,
            before: journal.units(),
            journal: RefCell::new(journal),
            used: RefCell::default(),
        })
    }

    /// How many units were measured before.
    pub fn known_units(&self) -> usize {
        self.before
    }

    pub(super) fn unit<T: Serialize + DeserializeOwned>(
        &self,
        key: &str,
        compute: impl FnOnce() -> Result<T>,
    ) -> Result<T> {
        let key = &self.unique(key);
        if let Some(result) = self.journal.borrow().result(key)? {
            return Ok(result);
        }
        self.check_stop()?;
        let result = stop::over_failure(compute(), || self.check_stop())?;
        self.journal.borrow_mut().record(key, &result)?;
        Ok(result)
    }

    /// The key, numbered where it has been used before: the work has an order.
    fn unique(&self, key: &str) -> String {
        let mut used = self.used.borrow_mut();
        let times = used.entry(key.to_owned()).or_default();
        *times += 1;
        match *times {
            1 => key.to_owned(),
            times => format!("{key} #{times}"),
        }
    }

    /// Checks whether a stop is requested.
    ///
    /// # Errors
    /// It is.
    pub(super) fn check_stop(&self) -> Result<()> {
        if !stop::requested() {
            return Ok(());
        }
        let units = match self.journal.borrow().units() {
            1 => "1 unit of work is".to_owned(),
            units => format!("{units} units of work are"),
        };
        Err(Error::stopped(format!(
            "stopped before the end; {units} saved in {}",
            self.folder.display()
        ))
        .hint("the same command resumes from there; with --restart it begins anew"))
    }

    /// Writes the rows so far.
    pub(super) fn so_far(&self, bench: &Bench, outcome: &Outcome) -> Result<()> {
        self.results.write(bench, &self.run, outcome, false)
    }

    /// Writes all results and removes the journal; returns the files.
    ///
    /// # Errors
    /// The disk.
    pub fn finish(&self, bench: &Bench, outcome: &Outcome) -> Result<Vec<PathBuf>> {
        let files = self.results.write_all(bench, &self.run, outcome)?;
        self.journal.borrow().finish()?;
        Ok(files)
    }
}
