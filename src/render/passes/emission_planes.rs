//! What both passes of an emission write.

use crate::error::Result;
use crate::frame::Wanted;
use crate::gpu::{Buffer, Defines, Launch, Parameter, output};

use super::{Counters, Run, switch};

/// The planes of an emission: its colour (linear light, premultiplied), and those of its layers that are
/// wanted. A pass is built for the layers it writes: without any it computes none.
pub struct EmissionPlanes {
    pub color: Buffer<[f32; 4]>,
    /// Depth in mm from the eye and value in stored units.
    pub place: Option<(Buffer<f32>, Buffer<f32>)>,
    pub normal: Option<Buffer<[f32; 4]>>,
    pub counters: Option<Counters>,
}

impl EmissionPlanes {
    /// # Errors
    /// The device has no room.
    pub fn new(run: &Run, wanted: Wanted) -> Result<Self> {
        let place = || Ok((run.plane("depth plane")?, run.plane("value plane")?));
        let normal = || run.plane("normal plane");
        Ok(Self {
            color: run.plane("colour plane")?,
            place: (wanted.depth || wanted.value).then(place).transpose()?,
            normal: wanted.normal.then(normal).transpose()?,
            counters: run.counters(wanted.counters)?,
        })
    }

    /// The switches of a pass that writes these planes.
    pub(super) fn define(&self, defines: Defines) -> Defines {
        defines
            .with("LAYERS", switch(self.place.is_some()))
            .with("NORMALS", switch(self.normal.is_some()))
            .with("COUNTERS", switch(self.counters.is_some()))
    }

    /// Their place at the end of a pass's signature.
    pub(super) fn parameters(&self) -> Vec<Parameter> {
        let mut parameters = vec![output::<[f32; 4]>("color")];
        if self.place.is_some() {
            parameters.extend([output::<f32>("depth"), output::<f32>("value")]);
        }
        parameters.extend((self.normal.iter()).map(|_| output::<[f32; 4]>("normal")));
        parameters.extend(Counters::parameters(self.counters.is_some()));
        parameters
    }

    /// Gives them as a pass's last arguments.
    pub(super) fn give<'a>(&'a mut self, launch: Launch<'a>) -> Launch<'a> {
        let mut launch = launch.output(&mut self.color);
        if let Some((depth, value)) = &mut self.place {
            launch = launch.output(depth).output(value);
        }
        if let Some(normal) = &mut self.normal {
            launch = launch.output(normal);
        }
        Counters::give(self.counters.as_mut(), launch)
    }
}
