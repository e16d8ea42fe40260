//! The passes of a frame, launched together and timed by the queue's own clock.

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

/// The launches of a frame, in order. They wait until all their passes are built, so that building is never
/// part of the device's time.
#[derive(Default)]
pub struct Timings {
    waiting: Vec<Launch>,
}

impl Timings {
    /// Puts a launch at the end.
    pub fn add(&mut self, launch: Launch) {
        self.waiting.push(launch);
    }

    /// Builds the passes that are not built yet; returns the time in ms, 0 if there are none.
    ///
    /// # Errors
    /// One does not build.
    pub fn build(&self, device: &Device) -> Result<f64> {
        let start = Instant::now();
        match Pass::build_all(device, self.waiting.iter().map(|launch| &launch.pass))? {
            0 => Ok(0.0),
            _ => Ok(start.elapsed().as_secs_f64() * 1e3),
        }
    }

    /// Builds what is not built, launches all and waits; returns each pass's time and the time from the first
    /// launch's start to the last one's end, in ms.
    ///
    /// # Errors
    /// A pass does not build; a launch failed on the device.
    pub fn finish(self, device: &Device) -> Result<(Vec<PassTime>, f64)> {
        self.build(device)?;
        crash::catch_again(); // a driver's compiler may have been at work
        let events = self.waiting.iter().map(|launch| launch.start(device));
        let events = events.collect::<Result<Vec<Event>>>()?;
        device.finish()?;
        let at_ns = |event: &Event, point| -> Result<u64> {
            core::get_event_profiling_info(event, point)
                .map_err(|e| device_error("time a pass", &e))?
                .time()
                .map_err(|e| device_error("time a pass", &e))
        };
        let mut times = Vec::with_capacity(events.len());
        let (mut first_ns, mut last_ns) = (u64::MAX, 0);
        for (launch, event) in self.waiting.iter().zip(&events) {
            let start_ns = at_ns(event, ProfilingInfo::Start)?;
            let end_ns = at_ns(event, ProfilingInfo::End)?;
            first_ns = first_ns.min(start_ns);
            last_ns = last_ns.max(end_ns);
            times.push(PassTime {
                name: launch.name(),
                ms: end_ns.saturating_sub(start_ns) as f64 * 1e-6,
            });
        }
        Ok((times, last_ns.saturating_sub(first_ns) as f64 * 1e-6))
    }
}
