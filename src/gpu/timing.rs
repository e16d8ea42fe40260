//! Device times of the passes of a frame, from the queue's own clock.

use ocl::core::{self, Event, ProfilingInfo};

use crate::error::Result;

use super::{Device, device_error};

/// How long one pass ran on the device.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PassTime {
    pub name: &'static str,
    pub ms: f64,
}

/// The launches of a frame, in order.
#[derive(Default)]
pub struct Timings {
    events: Vec<(&'static str, Event)>,
}

impl Timings {
    pub(super) fn record(&mut self, name: &'static str, event: Event) {
        self.events.push((name, event));
    }

    /// Waits for all launches; gives each pass's time and the time from the first launch's start to
    /// the last one's end, in ms.
    ///
    /// # Errors
    /// A launch failed on the device.
    pub fn finish(self, device: &Device) -> Result<(Vec<PassTime>, f64)> {
        device.finish()?;
        let at_ns = |event: &Event, moment| -> Result<u64> {
            core::get_event_profiling_info(event, moment)
                .map_err(|e| device_error("time a pass", &e))?
                .time()
                .map_err(|e| device_error("time a pass", &e))
        };
        let mut times = Vec::with_capacity(self.events.len());
        let (mut first_ns, mut last_ns) = (u64::MAX, 0);
        for (name, event) in &self.events {
            let start_ns = at_ns(event, ProfilingInfo::Start)?;
            let end_ns = at_ns(event, ProfilingInfo::End)?;
            first_ns = first_ns.min(start_ns);
            last_ns = last_ns.max(end_ns);
            times.push(PassTime {
                name,
                ms: end_ns.saturating_sub(start_ns) as f64 * 1e-6,
            });
        }
        Ok((times, last_ns.saturating_sub(first_ns) as f64 * 1e-6))
    }
}
