//! One process's share of the frames.

use std::fmt;
use std::str::FromStr;

use crate::error::{Error, Result};

/// Of `count` processes the one of this index: frames k with k ≡ index (mod count). Frames side by
/// side cost alike, so that all shares do.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shard {
    index: u32,
    count: u32,
}

impl Shard {
    /// All frames.
    pub const WHOLE: Self = Self { index: 0, count: 1 };

    /// # Errors
    /// An index that is not below the count (usage).
    pub fn new(index: u32, count: u32) -> Result<Self> {
        if index >= count {
            return Err(Error::usage(format!(
                "shard {index}/{count}: the first number counts from 0 and must be below the second"
            )));
        }
        Ok(Self { index, count })
    }

    /// Its frames among the first `frames`.
    pub fn frames(self, frames: u32) -> impl Iterator<Item = u32> {
        (self.index..frames).step_by(self.count as usize)
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.index, self.count)
    }
}

/// `--shard`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ShardChoice {
    Given(Shard),
    /// As the program that started this one says.
    Auto,
}

/// Variables that tell a process which of how many it is: the index, the first index (0 where none
/// is named), the count. A Slurm array's tasks are jobs of their own; within a job the nearest
/// starter is believed.
const VARIABLES: [(&str, Option<&str>, &str); 4] = [
    (
        "SLURM_ARRAY_TASK_ID",
        Some("SLURM_ARRAY_TASK_MIN"),
        "SLURM_ARRAY_TASK_COUNT",
    ),
    ("OMPI_COMM_WORLD_RANK", None, "OMPI_COMM_WORLD_SIZE"),
    ("PMI_RANK", None, "PMI_SIZE"),
    ("SLURM_PROCID", None, "SLURM_NTASKS"),
];

const ARRAY_STEP: &str = "SLURM_ARRAY_TASK_STEP";

impl ShardChoice {
    /// The shard and, where it was found in the environment, the variable that told it. `variable`
    /// looks one up.
    ///
    /// # Errors
    /// No variable or one that makes no sense (usage).
    pub fn resolve(
        self,
        variable: impl Fn(&str) -> Option<String>,
    ) -> Result<(Shard, Option<&'static str>)> {
        if let Self::Given(shard) = self {
            return Ok((shard, None));
        }
        let number = |name: &str, otherwise: u32| match variable(name) {
            None => Ok(otherwise),
            Some(text) => text.trim().parse().map_err(|_| {
                Error::usage(format!(
                    "shard auto: {name} is '{text}', which is no number"
                ))
            }),
        };
        for (index_name, first_name, count_name) in VARIABLES {
            if variable(index_name).is_none() || variable(count_name).is_none() {
                continue;
            }
            let (first, step) = match first_name {
                Some(first_name) => (number(first_name, 0)?, number(ARRAY_STEP, 1)?.max(1)),
                None => (0, 1),
            };
            let (index, count) = (number(index_name, 0)?, number(count_name, 0)?);
            let shard = Shard::new(index.saturating_sub(first) / step, count);
            return Ok((shard.map_err(|e| e.at(index_name))?, Some(index_name)));
        }
        let names: Vec<&str> = VARIABLES.iter().map(|(index, _, _)| *index).collect();
        Err(Error::usage(
            "shard auto: nothing in the environment says which of how many processes this is",
        )
        .hint(format!(
            "start it by sbatch --array, srun or mpirun (which set one of {}), or write --shard I/N",
            names.join(", ")
        )))
    }
}

impl FromStr for ShardChoice {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        if text == "auto" {
            return Ok(Self::Auto);
        }
        let numbers = text.split_once('/').and_then(|(index, count)| {
            Some((index.trim().parse().ok()?, count.trim().parse().ok()?))
        });
        match numbers {
            Some((index, count)) => Shard::new(index, count).map(Self::Given),
            None => Err(Error::usage(format!(
                "'{text}' is not a shard: write I/N, from 0/N to N-1/N, or auto"
            ))),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shards_are_the_frames_once_each() {
        for count in [1, 2, 3, 7, 20] {
            let mut all: Vec<u32> = (0..count)
                .flat_map(|index| Shard::new(index, count).unwrap().frames(10))
                .collect();
            all.sort_unstable();
            assert_eq!(all, (0..10).collect::<Vec<_>>(), "{count}");
        }
        // The control: without one of them there is a hole.
        assert!(!Shard::new(0, 2).unwrap().frames(10).any(|k| k == 3));
    }

    #[test]
    fn the_environment_tells_the_shard() {
        let auto = |variables: &[(&str, &str)]| {
            let variables: Vec<(String, String)> = variables
                .iter()
                .map(|(name, text)| ((*name).to_owned(), (*text).to_owned()))
                .collect();
            ShardChoice::Auto.resolve(move |wanted| {
                let found = variables.iter().find(|(name, _)| name == wanted);
                found.map(|(_, text)| text.clone())
            })
        };
        let shard = |index, count| Shard { index, count };
        let array = [
            ("SLURM_ARRAY_TASK_ID", "7"),
            ("SLURM_ARRAY_TASK_MIN", "1"),
            ("SLURM_ARRAY_TASK_STEP", "2"),
            ("SLURM_ARRAY_TASK_COUNT", "5"),
            ("SLURM_PROCID", "0"),
            ("SLURM_NTASKS", "1"),
        ];
        assert_eq!(
            auto(&array).unwrap(),
            (shard(3, 5), Some("SLURM_ARRAY_TASK_ID"))
        );
        assert_eq!(
            auto(&array[4..]).unwrap(),
            (shard(0, 1), Some("SLURM_PROCID"))
        );
        let mpi = [("OMPI_COMM_WORLD_RANK", "2"), ("OMPI_COMM_WORLD_SIZE", "4")];
        assert_eq!(auto(&mpi).unwrap().0, shard(2, 4));
        assert_eq!(
            auto(&[("PMI_RANK", "1"), ("PMI_SIZE", "3")]).unwrap().0,
            shard(1, 3)
        );
        for wrong in [
            &[][..],
            &[("PMI_RANK", "1")],
            &[("PMI_RANK", "3"), ("PMI_SIZE", "3")],
            &[("PMI_RANK", "one"), ("PMI_SIZE", "3")],
        ] {
            assert_eq!(auto(wrong).unwrap_err().exit_code(), 2, "{wrong:?}");
        }
    }

    #[test]
    fn a_shard_is_written_as_a_share() {
        assert_eq!(
            "1/3".parse(),
            Ok(ShardChoice::Given(Shard { index: 1, count: 3 }))
        );
        assert_eq!("auto".parse(), Ok(ShardChoice::Auto));
        for wrong in ["3/3", "0/0", "-1/3", "1", "a/b", "1/2/3", "Auto", ""] {
            assert!(wrong.parse::<ShardChoice>().is_err(), "{wrong}");
        }
    }
}
