//! The datasets of the experiments: those that the user names, or phantoms made when they are needed.

use std::cell::OnceCell;

use crate::error::Result;
use crate::lab::bench::{Bench, Dataset, Preset};
use crate::volume::PhantomKind;

/// A dataset of an experiment, made when it is first needed.
pub struct LazyDataset<'a> {
    pub name: String,
    /// The index, among the three sizes of a paper's table, of the one that this volume stands for.
    pub size: usize,
    origin: Origin<'a>,
}

enum Origin<'a> {
    /// A dataset that the user named.
    Named(&'a Dataset),
    /// Made when it is first needed.
    Phantom {
        make: Box<dyn Fn() -> Result<Dataset>>,
        made: OnceCell<Box<Dataset>>,
    },
}

impl<'a> LazyDataset<'a> {
    /// The user's volumes, which stand for the paper's middle size; without any a phantom in three
    /// sizes.
    pub fn in_three_sizes(bench: &'a Bench, kind: PhantomKind) -> Vec<Self> {
        let sides = match bench.preset {
            Preset::Quick => [32, 64, 96],
            Preset::Usual => [64, 128, 256],
            Preset::Full => [128, 256, 512],
        };
        let phantoms = sides.iter().enumerate();
        let phantoms = phantoms.map(|(size, &side)| Self::phantom(kind, side, size));
        Self::named_or(bench, phantoms.collect())
    }

    /// The user's volumes; without any a phantom.
    pub fn in_one_size(bench: &'a Bench, kind: PhantomKind) -> Vec<Self> {
        let side = match bench.preset {
            Preset::Quick => 64,
            Preset::Usual => 128,
            Preset::Full => 256,
        };
        Self::named_or(bench, vec![Self::phantom(kind, side, 1)])
    }

    /// The user's volumes; without any scans of vessels of these numbers of voxels along each side.
    pub fn scans(bench: &'a Bench, sides: &[u32]) -> Vec<Self> {
        let scan = |&side| Self {
            name: Dataset::scan_name(side),
            size: 1,
            origin: Origin::Phantom {
                make: Box::new(move || Dataset::scan(side)),
                made: OnceCell::new(),
            },
        };
        Self::named_or(bench, sides.iter().map(scan).collect())
    }

    fn phantom(kind: PhantomKind, side: u32, size: usize) -> Self {
        Self {
            name: format!("{kind} phantom {side}"),
            size,
            origin: Origin::Phantom {
                make: Box::new(move || Dataset::sized(kind, side)),
                made: OnceCell::new(),
            },
        }
    }

    fn named_or(bench: &'a Bench, phantoms: Vec<Self>) -> Vec<Self> {
        if bench.datasets.is_empty() {
            return phantoms;
        }
        let named = bench.datasets.iter().map(|dataset| Self {
            name: dataset.name.clone(),
            size: 1,
            origin: Origin::Named(dataset),
        });
        named.collect()
    }

    /// The dataset, made now if it was not needed before.
    ///
    /// # Errors
    /// Not enough memory.
    pub fn get(&self) -> Result<&Dataset> {
        match &self.origin {
            Origin::Named(dataset) => Ok(dataset),
            Origin::Phantom { make, made } => {
                if let Some(dataset) = made.get() {
                    return Ok(dataset);
                }
                let dataset = make()?;
                Ok(made.get_or_init(|| Box::new(dataset)))
            }
        }
    }
}
