//! One process's share of the frames.

use std::fmt;
use std::str::FromStr;

use crate::error::{Error, Result};

/// One process's share of `count`: the frames k with k ≡ index (mod count). Neighbouring frames cost
/// about the same, so the shares do too.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shard {
    index: u32,
    count: u32,
}

impl Shard {
    /// The share of a process that makes all frames.
    pub const WHOLE: Self = Self { index: 0, count: 1 };

    /// The share of process `index`, counted from 0, of `count`.
    ///
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

    /// The number of the process among all, from 0.
    pub fn index(self) -> u32 {
        self.index
    }

    /// The share of `self` within a share `outer`, each of whose processes runs as many processes as
    /// `self` counts.
    fn within(self, outer: Self) -> Result<Self> {
        let count = outer.count.checked_mul(self.count).ok_or_else(|| {
            Error::usage(format!(
                "shard {self} of shard {outer}: there are more than {} processes",
                u32::MAX
            ))
        })?;
        Self::new(outer.index * self.count + self.index, count)
    }

    /// The frames of this share among the first `frames`.
    pub fn frames(self, frames: u32) -> impl Iterator<Item = u32> {
        (self.index..frames).step_by(self.count as usize)
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.index, self.count)
    }
}

/// The choice by `--shard`: a given share, or that of the environment.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ShardChoice {
    /// The share that the user wrote.
    Given(Shard),
    /// Taken from the environment, as set by the launcher that started this program.
    Auto,
}

/// Variables that give a process its index in its job and the number of processes, index and count, the
/// nearest starter first. Slurm's count is that of srun's step: a batch script itself has a
/// `SLURM_PROCID` too, 0 of however many tasks the job may start.
const RANKS: [(&str, &str); 3] = [
    ("OMPI_COMM_WORLD_RANK", "OMPI_COMM_WORLD_SIZE"),
    ("PMI_RANK", "PMI_SIZE"),
    ("SLURM_PROCID", "SLURM_STEP_NUM_TASKS"),
];

/// A Slurm array's tasks are jobs of their own, each of which may start processes.
const ARRAY_TASK: &str = "SLURM_ARRAY_TASK_ID";
const ARRAY_FIRST: &str = "SLURM_ARRAY_TASK_MIN";
const ARRAY_STEP: &str = "SLURM_ARRAY_TASK_STEP";
const ARRAY_COUNT: &str = "SLURM_ARRAY_TASK_COUNT";

impl ShardChoice {
    /// The shard and, where it was found in the environment, the variables that gave it: process p
    /// of t in task a of an array of n is shard a·t + p of n·t. `variable` looks one up.
    ///
    /// # Errors
    /// No variable or one that makes no sense (usage).
    pub fn resolve(
        self,
        variable: impl Fn(&str) -> Option<String>,
    ) -> Result<(Shard, Option<String>)> {
        if let Self::Given(shard) = self {
            return Ok((shard, None));
        }
        let number = |name: &str, otherwise: u32| match variable(name) {
            None => Ok(otherwise),
            Some(text) => text.trim().parse().map_err(|_| {
                Error::usage(format!(
                    "shard auto: {name} is '{text}', which is not a number"
                ))
            }),
        };
        let is_set = |name: &str| variable(name).is_some();
        let mut given = None;
        if is_set(ARRAY_TASK) && is_set(ARRAY_COUNT) {
            let (first, step) = (number(ARRAY_FIRST, 0)?, number(ARRAY_STEP, 1)?.max(1));
            let (task, count) = (number(ARRAY_TASK, 0)?, number(ARRAY_COUNT, 0)?);
            let shard = Shard::new(task.saturating_sub(first) / step, count);
            given = Some((shard.map_err(|e| e.at(ARRAY_TASK))?, ARRAY_TASK.to_owned()));
        }
        let rank = RANKS
            .into_iter()
            .find(|(index, count)| is_set(index) && is_set(count));
        if let Some((index_name, count_name)) = rank {
            let shard = Shard::new(number(index_name, 0)?, number(count_name, 0)?);
            let rank = shard.map_err(|e| e.at(index_name))?;
            given = Some(match given {
                Some((task, by)) => (rank.within(task)?, format!("{by} and {index_name}")),
                None => (rank, index_name.to_owned()),
            });
        }
        if let Some((shard, by)) = given {
            return Ok((shard, Some(by)));
        }
        let ranks = RANKS.map(|(index, count)| format!("{index} and {count}"));
        Err(Error::usage(
            "shard auto: the environment does not say which process this is, and of how many",
        )
        .hint(format!(
            "start it with sbatch --array, srun or mpirun (which set {ARRAY_TASK}, {}), or write --shard I/N",
            ranks.join(", or ")
        )))
    }
}

impl FromStr for ShardChoice {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        if text.trim().eq_ignore_ascii_case("auto") {
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
    fn the_environment_gives_the_shard() {
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
            ("SLURM_NTASKS", "4"),
        ];
        let given = |variables: &[_]| {
            let (shard, by) = auto(variables).unwrap();
            (shard, by.unwrap())
        };
        assert_eq!(given(&array), (shard(3, 5), "SLURM_ARRAY_TASK_ID".into()));
        // A batch script that srun did not start is no process of several.
        assert_eq!(auto(&array[4..]).unwrap_err().exit_code(), 2);
        let step = [
            ("SLURM_PROCID", "2"),
            ("SLURM_NTASKS", "8"),
            ("SLURM_STEP_NUM_TASKS", "4"),
        ];
        assert_eq!(given(&step), (shard(2, 4), "SLURM_PROCID".into()));
        // Steps of an array's tasks: every share once.
        let both = [&array[..4], &step[..]].concat();
        let by = "SLURM_ARRAY_TASK_ID and SLURM_PROCID";
        assert_eq!(given(&both), (shard(14, 20), by.into()));
        let mut all: Vec<u32> = (0..5)
            .flat_map(|task| (0..4).map(move |rank| (task, rank)))
            .map(|(task, rank)| {
                let within = shard(rank, 4).within(shard(task, 5)).unwrap();
                assert_eq!(within.count, 20);
                within.index
            })
            .collect();
        all.sort_unstable();
        assert_eq!(all, (0..20).collect::<Vec<_>>());
        assert!(shard(0, 1 << 16).within(shard(0, 1 << 16)).is_err());
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
        for auto in ["auto", "AUTO"] {
            assert_eq!(auto.parse(), Ok(ShardChoice::Auto));
        }
        for wrong in ["3/3", "0/0", "-1/3", "1", "a/b", "1/2/3", "automatic", ""] {
            assert!(wrong.parse::<ShardChoice>().is_err(), "{wrong}");
        }
    }
}
