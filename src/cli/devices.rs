//! `angioray devices`.

use crate::error::Result;
use crate::gpu::Device;

use super::scene::SceneArgument;
use super::terminal::lines_to_stdout;

/// List the OpenCL devices
///
/// What --device takes: the number in front, 'cpu', 'gpu', or part of a name. The double-precision
/// renderer, --device reference, is always there.
#[derive(clap::Args)]
#[command(override_usage = "angioray devices [OPTIONS]")]
#[command(after_help = "Example:
  angioray devices
  angioray render head.nrrd -o head.png --device 0")]
pub struct DevicesArguments {
    #[command(flatten)]
    scene: SceneArgument,
}

impl DevicesArguments {
    pub fn run(self) -> Result<()> {
        self.scene.open()?;
        let devices = Device::list()?;
        lines_to_stdout(|out| {
            for device in &devices {
                out.line(format_args!("{}  {}", device.id, device.name))?;
                out.line(format_args!(
                    "   {}, {} compute units, {:.1} GiB of memory, {:.1} GiB at most in one piece",
                    device.kind,
                    device.compute_units,
                    gib(device.memory_bytes),
                    gib(device.max_allocation_bytes)
                ))?;
                out.line(format_args!(
                    "   {}, {}, driver {}",
                    device.platform, device.version, device.driver
                ))?;
            }
            Ok(())
        })
    }
}

fn gib(bytes: u64) -> f64 {
    bytes as f64 / f64::from(1 << 30)
}
