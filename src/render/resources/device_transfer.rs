//! A transfer function on the device: its knots, and the sums over them that a quadrature needs.

use crate::error::Result;
use crate::gpu::{Args, Buffer, Device, Group};
use crate::scene::{Filter, QuadratureMethod};

use super::transfer::Knots;

/// The tables of a transfer function that a pass reads beside its knots.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Tables {
    /// The integrals over the knots.
    pub sums: bool,
    /// The integrals of the values, which layers are averaged from.
    pub value_sums: bool,
    /// Whether the knots are those of the smoothed function, between which integrals are polynomials.
    pub smooth: bool,
}

impl Tables {
    /// The tables of a rule; `with_values` where layers are averaged.
    pub fn of(method: QuadratureMethod, filter: Filter, with_values: bool) -> Self {
        // At fixed steps with the nearest filter no value lies between two samples'.
        let smooth = method == QuadratureMethod::Preintegrated && filter == Filter::Linear;
        let sums = smooth || method == QuadratureMethod::Adaptive;
        Self {
            sums,
            value_sums: sums && with_values,
            smooth,
        }
    }

    /// The same with the integrals over the knots, where a pass reads those too.
    #[must_use]
    pub fn with_sums_if(self, read: bool, with_values: bool) -> Self {
        Self {
            sums: self.sums || read,
            value_sums: self.value_sums || read && with_values,
            ..self
        }
    }
}

/// A transfer function on the device, knots ascending in stored units.
pub struct DeviceTransfer {
    /// How many knots there are.
    pub knots: u32,
    /// The most by which the knots' colours differ in a channel.
    pub color_spread: f32,
    /// Stored units; outside nothing absorbs.
    pub absorbing: [f32; 2],
    values: Buffer<f32>,
    /// The knots' colours in linear light, with the opacity of the unit length in the last channel.
    colors: Buffer<[f32; 4]>,
    /// The sums over the knots, as `KnotSums` of `preintegrated.clh` has them.
    sums: Option<Buffer<[f32; 4]>>,
    value_sums: Option<Buffer<f32>>,
}

impl DeviceTransfer {
    /// Uploads the function of `knots` with the tables that are read.
    ///
    /// # Errors
    /// The device has no room.
    pub fn upload(device: &Device, knots: &Knots, tables: Tables) -> Result<Self> {
        let smooth;
        let knots = if tables.smooth {
            smooth = knots.smooth();
            &smooth
        } else {
            knots
        };
        const SUMS: &str = "transfer function's sums";
        let sums = || Buffer::upload(device, SUMS, &knots.sums());
        let value_sums = || Buffer::upload(device, SUMS, &knots.value_sums());
        Ok(Self {
            knots: knots.values.len() as u32,
            color_spread: knots.color_spread(),
            absorbing: knots.absorbing(),
            values: Buffer::upload(device, "transfer function", &knots.values)?,
            colors: Buffer::upload(device, "transfer function", &knots.colors)?,
            sums: tables.sums.then(sums).transpose()?,
            value_sums: tables.value_sums.then(value_sums).transpose()?,
        })
    }

    /// The knots and the sums over them alone, for a pass that averages no layers.
    pub fn integrals(&self) -> impl Group + '_ {
        Integrals(self)
    }

    /// Device memory held, in bytes.
    pub fn bytes(&self) -> u64 {
        let sums = self.sums.as_ref().map_or(0, |sums| sums.bytes());
        let value_sums = self.value_sums.as_ref().map_or(0, |sums| sums.bytes());
        self.values.bytes() + self.colors.bytes() + sums + value_sums
    }
}

/// The knots and the sums over them.
struct Integrals<'a>(&'a DeviceTransfer);

impl Group for Integrals<'_> {
    fn add_to(self, args: Args) -> Args {
        args.read("knot_values", &self.0.values)
            .read("knot_colors", &self.0.colors)
            .read_some("knot_sums", self.0.sums.as_ref())
    }
}

impl Group for &DeviceTransfer {
    fn add_to(self, args: Args) -> Args {
        args.read("knot_values", &self.values)
            .read("knot_colors", &self.colors)
            .read_some("knot_sums", self.sums.as_ref())
            .read_some("knot_value_sums", self.value_sums.as_ref())
    }
}
