//! The volumes that the experiments look at.

use std::cell::OnceCell;

use crate::bench::{Bench, Effort, Specimen};
use crate::error::Result;
use crate::volume::PhantomKind;

/// A volume that an experiment looks at.
pub struct TestVolume<'a> {
    pub name: String,
    /// Of the three sizes of a paper's table, the one that this volume stands for.
    pub size: usize,
    origin: Origin<'a>,
}

enum Origin<'a> {
    /// By the user.
    Named(&'a Specimen),
    /// Made when it is first needed.
    Phantom {
        make: Box<dyn Fn() -> Result<Specimen>>,
        made: OnceCell<Box<Specimen>>,
    },
}

impl<'a> TestVolume<'a> {
    /// The user's volumes, which stand for the paper's middle size; without any a phantom in three
    /// sizes.
    pub fn in_three_sizes(bench: &'a Bench, kind: PhantomKind) -> Vec<Self> {
        let sides = match bench.effort {
            Effort::Quick => [32, 64, 96],
            Effort::Usual => [64, 128, 256],
            Effort::Full => [128, 256, 512],
        };
        let phantoms = sides.iter().enumerate();
        let phantoms = phantoms.map(|(size, &side)| Self::phantom(kind, side, size));
        Self::named_or(bench, phantoms.collect())
    }

    /// The user's volumes; without any a phantom.
    pub fn in_one_size(bench: &'a Bench, kind: PhantomKind) -> Vec<Self> {
        let side = match bench.effort {
            Effort::Quick => 64,
            Effort::Usual => 128,
            Effort::Full => 256,
        };
        Self::named_or(bench, vec![Self::phantom(kind, side, 1)])
    }

    /// The user's volumes; without any scans of vessels of these numbers of voxels along each side.
    pub fn scans(bench: &'a Bench, sides: &[u32]) -> Vec<Self> {
        let scan = |&side| Self {
            name: Specimen::scan_name(side),
            size: 1,
            origin: Origin::Phantom {
                make: Box::new(move || Specimen::scan(side)),
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
                make: Box::new(move || Specimen::sized(kind, side)),
                made: OnceCell::new(),
            },
        }
    }

    fn named_or(bench: &'a Bench, phantoms: Vec<Self>) -> Vec<Self> {
        if bench.specimens.is_empty() {
            return phantoms;
        }
        let named = bench.specimens.iter().map(|specimen| Self {
            name: specimen.name.clone(),
            size: 1,
            origin: Origin::Named(specimen),
        });
        named.collect()
    }

    /// # Errors
    /// Not enough memory.
    pub fn specimen(&self) -> Result<&Specimen> {
        match &self.origin {
            Origin::Named(specimen) => Ok(specimen),
            Origin::Phantom { make, made } => {
                if let Some(specimen) = made.get() {
                    return Ok(specimen);
                }
                let specimen = make()?;
                Ok(made.get_or_init(|| Box::new(specimen)))
            }
        }
    }
}
