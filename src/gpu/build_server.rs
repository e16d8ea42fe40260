//! The other side of [`super::builder`]: a process that builds the kernels that it reads of.

use std::fs;
use std::io::BufRead;
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::mpsc;

use crate::abrupt;
use crate::error::{Error, ErrorKind, Result};

use super::builder::{ARGUMENT, Request, answer_file, identity, packed};
use super::device::Device;
use super::program;

/// Whether this process was started as a builder.
pub fn is_requested() -> bool {
    std::env::args_os()
        .nth(1)
        .is_some_and(|first| first == ARGUMENT)
}

/// Builds the kernels that the standard input requests, as a builder, until it is closed.
pub fn serve() -> ExitCode {
    let Some(folder) = std::env::args_os().nth(2).map(PathBuf::from) else {
        return ExitCode::from(ErrorKind::Usage.exit_code());
    };
    let (send, requests) = mpsc::channel();
    std::thread::spawn(move || {
        for line in std::io::stdin().lock().lines().map_while(|line| line.ok()) {
            let _ = send.send(line);
        }
        // Nobody wants the rest. Not by `exit`, whose handlers would meet a compiler at work.
        abrupt::end(&[], 0);
    });
    let mut device = None;
    for (number, line) in (0..).zip(requests) {
        let bytes = packed(served(&line, &mut device));
        let (unfinished, answer) = (folder.join("unfinished"), answer_file(&folder, number));
        let written = fs::write(&unfinished, bytes);
        if written
            .and_then(|()| fs::rename(&unfinished, &answer))
            .is_err()
        {
            return ExitCode::from(ErrorKind::Resource.exit_code());
        }
    }
    ExitCode::SUCCESS
}

fn served(line: &str, device: &mut Option<Device>) -> Result<Option<Vec<u8>>> {
    let request: Request = serde_json::from_str(line)
        .map_err(|cause| Error::failed(format!("a request for a kernel: {cause}")))?;
    let device = match device {
        Some(device) => device,
        none => none.insert(Device::select(&request.device.to_string())?),
    };
    if identity(device.info()) != request.identity {
        return Err(Error::no_device("another device has its place"));
    }
    program::binary_of(device, &request)
}
