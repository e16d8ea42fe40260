//! What an unfinished run has measured, unit by unit, so that it can be resumed.

use std::collections::HashMap;
use std::fs::{File, TryLockError};
use std::io::{Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::{Map, Value, json};

use crate::error::{Error, Result};

/// The identity of a run, as names and values: a run of another identity cannot be resumed.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Run(pub Vec<(&'static str, String)>);

impl Run {
    /// An object of names and values.
    pub fn value(&self) -> Value {
        let pairs = self.0.iter();
        let pairs = pairs.map(|(name, value)| ((*name).to_owned(), Value::from(value.as_str())));
        Value::Object(pairs.collect::<Map<_, _>>())
    }

    /// The first value in which a journal's run differs: its name, its value then and now.
    fn difference(&self, then: &Value) -> Option<(&'static str, String, String)> {
        self.0.iter().find_map(|(name, now)| {
            let old = then.get(name).and_then(Value::as_str);
            (old != Some(now)).then(|| (*name, old.unwrap_or("nothing").to_owned(), now.clone()))
        })
    }
}

/// A file of JSON lines: the run, then a unit a line, each on the disk before the next is begun. A
/// line that was cut off while it was written is left out.
#[derive(Debug)]
pub struct Journal {
    path: PathBuf,
    /// Locked as long as the run lasts; at its end.
    file: File,
    results: HashMap<String, Value>,
    /// Whether the run is new: there was no unfinished one to resume.
    begun: bool,
}

impl Journal {
    pub const NAME: &str = "journal.jsonl";

    /// Opens the journal in `folder` to resume its run; begins one if there is none, and with
    /// `restart` in any case.
    ///
    /// # Errors
    /// The journal is of another run, damaged, or in use by another process; the disk.
    pub fn open(folder: &Path, run: &Run, restart: bool) -> Result<Self> {
        let path = folder.join(Self::NAME);
        let failed = |doing: &'static str| {
            let path = path.clone();
            move |cause: std::io::Error| Error::writing(&path, doing, &cause)
        };
        let mut options = File::options();
        let options = options.read(true).write(true).create(true).truncate(false);
        let mut file = options.open(&path).map_err(failed("open"))?;
        match file.try_lock() {
            Err(TryLockError::WouldBlock) => {
                return Err(Error::failed(format!(
                    "{}: another run is writing into this folder",
                    folder.display()
                ))
                .hint("wait until it has ended, or choose another folder"));
            }
            // Where files cannot be locked, a second run is the user's own affair.
            Err(TryLockError::Error(_)) | Ok(()) => {}
        }
        let mut bytes = Vec::new();
        if !restart {
            file.read_to_end(&mut bytes).map_err(failed("read"))?;
        }
        let whole = bytes.iter().rposition(|&byte| byte == b'\n');
        bytes.truncate(whole.map_or(0, |last| last + 1));
        file.set_len(bytes.len() as u64)
            .and_then(|()| file.seek(SeekFrom::End(0)))
            .map_err(failed("write"))?;
        let mut journal = Self {
            path,
            file,
            results: HashMap::new(),
            begun: bytes.is_empty(),
        };
        if journal.begun {
            journal.write(&json!({ "run": run.value() }))?;
        } else {
            journal.results = journal.read(folder, run, &bytes)?;
        }
        Ok(journal)
    }

    fn read(&self, folder: &Path, run: &Run, bytes: &[u8]) -> Result<HashMap<String, Value>> {
        let mut lines = bytes
            .strip_suffix(b"\n")
            .unwrap_or(bytes)
            .split(|&b| b == b'\n');
        let line = |number: usize, line: &[u8]| {
            let line = serde_json::from_slice::<Value>(line);
            line.map_err(|_| self.damaged(number))
        };
        let first = line(1, lines.next().unwrap_or_default())?;
        let then = first.get("run").ok_or_else(|| self.damaged(1))?;
        if let Some((name, then, now)) = run.difference(then) {
            return Err(Error::usage(format!(
                "{}: the run that was stopped here cannot be resumed: its {name} was {then}, \
                 this one's is {now}",
                folder.display()
            ))
            .hint("choose another folder, or begin anew with --restart"));
        }
        let mut results = HashMap::new();
        for (at, text) in lines.enumerate() {
            let number = at + 2;
            let mut line = line(number, text)?;
            let value = line.get_mut("found").map(Value::take);
            match (line.get("unit").and_then(Value::as_str), value) {
                (Some(key), Some(value)) => results.insert(key.to_owned(), value),
                _ => return Err(self.damaged(number)),
            };
        }
        Ok(results)
    }

    fn damaged(&self, line: usize) -> Error {
        Error::failed(format!("{}: line {line} is damaged", self.path.display()))
            .hint("begin anew with --restart")
    }

    /// Whether the run is new: there was no unfinished one to resume.
    pub fn is_begun(&self) -> bool {
        self.begun
    }

    /// How many units are known.
    pub fn units(&self) -> usize {
        self.results.len()
    }

    /// The result of a unit, if it was measured before.
    ///
    /// # Errors
    /// The journal holds something else under this key.
    pub fn result<T: DeserializeOwned>(&self, key: &str) -> Result<Option<T>> {
        let result = self.results.get(key);
        let result = result.map(|value| serde_json::from_value(value.clone()));
        result.transpose().map_err(|_| {
            Error::failed(format!(
                "{}: what it holds of '{key}' cannot be read",
                self.path.display()
            ))
            .hint("begin anew with --restart")
        })
    }

    /// Records the result of a unit.
    ///
    /// # Errors
    /// The disk.
    pub fn record(&mut self, key: &str, result: &impl Serialize) -> Result<()> {
        let result = serde_json::to_value(result)
            .map_err(|cause| Error::failed(format!("'{key}' cannot be recorded: {cause}")))?;
        self.write(&json!({ "unit": key, "found": result }))?;
        self.results.insert(key.to_owned(), result);
        Ok(())
    }

    fn write(&mut self, line: &Value) -> Result<()> {
        let written = self
            .file
            .write_all(format!("{line}\n").as_bytes())
            .and_then(|()| self.file.sync_data());
        written.map_err(|cause| Error::writing(&self.path, "write", &cause))
    }

    /// Removes the journal of a run that is finished: the same command then measures anew.
    ///
    /// # Errors
    /// The disk.
    pub fn finish(&self) -> Result<()> {
        std::fs::remove_file(&self.path)
            .map_err(|cause| Error::writing(&self.path, "remove the file", &cause))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(preset: &str) -> Run {
        Run(vec![("experiment", "b1".into()), ("effort", preset.into())])
    }

    #[test]
    fn what_was_recorded_is_read_again_bit_by_bit() {
        let folder = tempfile::tempdir().unwrap();
        let figures = vec![0.1 + 0.2, 1.0 / 3.0, f64::MIN_POSITIVE, 1e300];
        {
            let mut journal = Journal::open(folder.path(), &run("quick"), false).unwrap();
            journal.record("a/1", &figures).unwrap();
            journal.record("a/2", &None::<f64>).unwrap();
        }
        let journal = Journal::open(folder.path(), &run("quick"), false).unwrap();
        assert_eq!(journal.units(), 2);
        assert_eq!(journal.result::<Vec<f64>>("a/1").unwrap(), Some(figures));
        assert_eq!(journal.result::<Option<f64>>("a/2").unwrap(), Some(None));
        assert_eq!(journal.result::<f64>("a/3").unwrap(), None);
        // The control: what is of another type is not taken for it.
        let error = journal.result::<f64>("a/1").unwrap_err();
        assert!(
            error.to_string().contains("'a/1' cannot be read"),
            "{error}"
        );
        journal.finish().unwrap();
        drop(journal);
        let begun = Journal::open(folder.path(), &run("quick"), false).unwrap();
        assert_eq!(begun.units(), 0);
    }

    #[test]
    fn a_torn_line_is_left_out_wherever_it_was_cut() {
        let folder = tempfile::tempdir().unwrap();
        let mut journal = Journal::open(folder.path(), &run("quick"), false).unwrap();
        journal.record("first", &1.5).unwrap();
        let path = folder.path().join(Journal::NAME);
        let length = std::fs::metadata(&path).unwrap().len() as usize;
        journal.record("second", &"é".repeat(9)).unwrap();
        drop(journal);
        let bytes = std::fs::read(&path).unwrap();
        for cut in 0..bytes.len() {
            std::fs::write(&path, &bytes[..cut]).unwrap();
            let mut journal = Journal::open(folder.path(), &run("quick"), false).unwrap();
            assert_eq!(journal.units(), usize::from(cut >= length), "{cut}");
            journal.record("second", &2.5).unwrap();
            drop(journal);
            let journal = Journal::open(folder.path(), &run("quick"), false).unwrap();
            assert_eq!(journal.result::<f64>("second").unwrap(), Some(2.5), "{cut}");
        }
    }

    #[test]
    fn another_run_a_damaged_line_and_a_second_process_are_refused_in_a_sentence() {
        let folder = tempfile::tempdir().unwrap();
        let open = |preset: &str, restart| Journal::open(folder.path(), &run(preset), restart);
        let mut journal = open("quick", false).unwrap();
        journal.record("unit", &1.0).unwrap();
        let error = open("quick", false).unwrap_err();
        assert!(
            error.to_string().contains("another run is writing"),
            "{error}"
        );
        drop(journal);
        let error = open("full", false).unwrap_err();
        assert!(
            error
                .to_string()
                .contains("its effort was quick, this one's is full"),
            "{error}"
        );
        assert!(error.hint_text().unwrap().contains("--restart"));
        assert_eq!(open("quick", false).unwrap().units(), 1);
        assert_eq!(open("full", true).unwrap().units(), 0);
        let path = folder.path().join(Journal::NAME);
        let text = std::fs::read_to_string(&path).unwrap();
        std::fs::write(&path, format!("{text}{{\"unit\": 3}}\n")).unwrap();
        let error = open("full", false).unwrap_err();
        assert!(error.to_string().contains("line 2 is damaged"), "{error}");
    }
}
