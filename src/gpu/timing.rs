//! The passes of a frame, launched together and timed by the queue's own clock.

use std::sync::Arc;
use std::time::Instant;

use ocl::core::{self, Event, ProfilingInfo};

use crate::crash;
use crate::error::Result;

use super::device::Device;
use super::pass::{Launch, Pass};
use super::status::device_error;

/// How long one pass ran on the device.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PassTime {
    /// The pass's name.
    pub name: &'static str,
    /// The time in ms, on the device's clock.
    pub ms: f64,
}

/// What the launches of a frame took, in ms.
#[derive(Debug, Clone, PartialEq)]
pub struct FrameTimes {
    /// The passes in launch order.
    pub passes: Vec<PassTime>,
    /// Time to build passes.
    pub build_ms: f64,
    /// Time from the first launch's start to the last one's end.
    pub device_ms: f64,
}

/// The launches of a frame, in order. They wait until all their passes are built, so that building is never
/// part of the device's time.
#[derive(Default)]
pub struct Timings {
    waiting: Vec<Launch>,
    /// Passes of launches that may follow the first start.
    announced: Vec<Arc<Pass>>,
    started: Vec<(&'static str, Event)>,
    build_ms: f64,
}

impl Timings {
    /// Puts a launch at the end.
    pub fn add(&mut self, launch: Launch) {
        self.waiting.push(launch);
    }

    /// Has the pass of a launch built with the others, without launching it: it may be launched when the host has
    /// seen what the launches before it found.
    pub fn announce(&mut self, launch: &Launch) {
        self.announced.push(Arc::clone(&launch.pass));
    }

    /// Builds what is not built and starts all launches that wait, without waiting for their end.
    ///
    /// # Errors
    /// A pass does not build; the device refused a launch.
    pub fn start(&mut self, device: &Device) -> Result<()> {
        let begun = Instant::now();
        let waiting = self.waiting.iter().map(|launch| &launch.pass);
        if Pass::build_all(device, waiting.chain(&self.announced))? > 0 {
            self.build_ms += begun.elapsed().as_secs_f64() * 1e3;
        }
        self.announced.clear();
        crash::catch_again(); // a driver's compiler may have been at work
        for launch in self.waiting.drain(..) {
            self.started.push((launch.name(), launch.start(device)?));
        }
        Ok(())
    }

    /// Starts what waits, waits for all, and returns what it took.
    ///
    /// # Errors
    /// A pass does not build; a launch failed on the device.
    pub fn finish(mut self, device: &Device) -> Result<FrameTimes> {
        self.start(device)?;
        device.finish()?;
        let at_ns = |event: &Event, point| -> Result<u64> {
            core::get_event_profiling_info(event, point)
                .map_err(|e| device_error("time a pass", &e))?
                .time()
                .map_err(|e| device_error("time a pass", &e))
        };
        let mut passes = Vec::with_capacity(self.started.len());
        let (mut first_ns, mut last_ns) = (u64::MAX, 0);
        for &(name, ref event) in &self.started {
            let start_ns = at_ns(event, ProfilingInfo::Start)?;
            let end_ns = at_ns(event, ProfilingInfo::End)?;
            first_ns = first_ns.min(start_ns);
            last_ns = last_ns.max(end_ns);
            passes.push(PassTime {
                name,
                ms: end_ns.saturating_sub(start_ns) as f64 * 1e-6,
            });
        }
        Ok(FrameTimes {
            passes,
            build_ms: self.build_ms,
            device_ms: last_ns.saturating_sub(first_ns) as f64 * 1e-6,
        })
    }
}
