//! The command line: arguments to a job, the job run, its outcome as an exit code.

mod backend;
mod bench;
mod carried;
mod compare;
mod completion;
mod devices;
mod hardcase;
mod help;
mod info;
mod job;
mod man;
mod orbit;
mod outputs;
mod phantom;
mod progress;
mod render;
mod repeat;
mod replay;
mod sampling_check;
mod scene;
mod source;
mod stats;
mod stopping;
mod terminal;
mod tolerance;

use std::process::ExitCode;

use clap::error::ErrorKind;
use clap::{FromArgMatches, Parser, Subcommand};

use crate::error::{Error, Result};
use crate::options::Switch;
use crate::options::group::group;
use crate::volume;

/// Pictures from angiograms and other sparse scalar volumes, without a window
#[derive(Parser)]
#[command(
    name = "angioray",
    bin_name = "angioray",
    version,
    arg_required_else_help = true,
    max_term_width = help::WIDTH
)]
#[command(after_help = "Example:
  angioray phantom vessels -o vessels.nrrd
  angioray render vessels.nrrd -o vessels.png")]
struct Arguments {
    #[command(flatten)]
    voice: Voice,

    #[command(subcommand)]
    command: Command,
}

group! {
    /// How much the program says.
    pub struct Voice {
        /// Print only errors: no notes, no progress, no names of written files
        #[arg(long, value_name = "on|off", num_args = 0..=1, require_equals = true,
            default_missing_value = "on", global = true, help_heading = None::<&str>)]
        quiet: Switch,
    }
}

impl Arguments {
    fn run(self) -> Result<()> {
        if let Some(quiet) = self.voice.quiet {
            terminal::set_quiet(quiet.is_on());
        }
        self.command.run()
    }
}

#[derive(Subcommand)]
enum Command {
    Render(Box<render::RenderArguments>),
    Orbit(Box<orbit::OrbitArguments>),
    Compare(Box<compare::CompareArguments>),
    Replay(Box<replay::ReplayArguments>),
    Bench(bench::BenchArguments),
    Info(info::InfoArguments),
    Phantom(phantom::PhantomArguments),
    Devices(devices::DevicesArguments),
    Completion(completion::CompletionArguments),
    Man(man::ManArguments),
}

impl Command {
    fn run(self) -> Result<()> {
        // Before a device is opened: OpenCL drivers catch signals too, and end the process by their own
        // unless they were there last. An orbit and a bench listen for themselves.
        match &self {
            Self::Orbit(_) | Self::Bench(_) => {}
            Self::Compare(_) => stopping::at_once(
                "the results so far are in its folder, and the reference's pictures are cached",
            )?,
            _ => stopping::at_once("no file is left half-written")?,
        }
        match self {
            Self::Render(arguments) => arguments.run(),
            Self::Orbit(arguments) => arguments.run(),
            Self::Compare(arguments) => arguments.run(),
            Self::Replay(arguments) => arguments.run(),
            Self::Bench(arguments) => arguments.run(),
            Self::Info(arguments) => arguments.run(),
            Self::Phantom(arguments) => arguments.run(),
            Self::Devices(arguments) => arguments.run(),
            Self::Completion(arguments) => arguments.run(),
            Self::Man(arguments) => arguments.run(),
        }
    }
}

/// The whole program: its arguments, its work, its exit code.
pub fn main() -> ExitCode {
    let parsed = help::program()
        .try_get_matches()
        .and_then(|matches| Arguments::from_arg_matches(&matches));
    let outcome = match parsed {
        Ok(arguments) => ready().and_then(|()| arguments.run()),
        Err(stop) => match stop.kind() {
            ErrorKind::DisplayHelp | ErrorKind::DisplayVersion => {
                terminal::lines_to_stdout(|out| out.block(stop.render()))
            }
            ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand => {
                terminal::usage_text(stop.render());
                return ExitCode::from(2);
            }
            _ => Err(misused(&requoted(stop))),
        },
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            terminal::error(&error);
            ExitCode::from(error.exit_code())
        }
    }
}

/// Prepares the process: the thread pool, and a readable error in case a file is shortened while it is
/// read.
fn ready() -> Result<()> {
    rayon::ThreadPoolBuilder::new()
        .build_global()
        .map_err(|cause| Error::resource(format!("no threads can be started: {cause}")))?;
    volume::end_when_shortened(terminal::lines)
}

/// The parser's complaint about the arguments as they are shown: it quotes them, and a line break in one
/// would part the complaint at the wrong places.
fn requoted(stop: clap::Error) -> clap::Error {
    let shown =
        std::env::args_os().map(|argument| terminal::on_one_line(argument.to_string_lossy()));
    match help::program().try_get_matches_from(shown) {
        Err(same) if same.kind() == stop.kind() => same,
        _ => stop,
    }
}

/// The parser's complaint as one line and a hint.
fn misused(stop: &clap::Error) -> Error {
    let text = stop.render().to_string();
    let mut message = Vec::new();
    let mut hints = Vec::new();
    let before_usage = text.lines().take_while(|line| !line.starts_with("Usage:"));
    for line in before_usage.map(str::trim) {
        match line.strip_prefix("tip: ") {
            // Where no flag is alike the parser takes a wrong one for a value, which none is.
            Some(tip) if tip.starts_with("to pass ") => {}
            Some(tip) => hints.push(tip),
            None if line.starts_with("For more information") => {}
            None if !line.is_empty() => message.push(line),
            None => {}
        }
    }
    let message = message.join(" ");
    let error = Error::usage(message.strip_prefix("error: ").unwrap_or(&message));
    if hints.is_empty() {
        error.hint("--help lists them")
    } else {
        error.hint(hints.join("; "))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_arguments_are_consistent_and_every_command_has_an_example() {
        let mut program = help::program();
        program.clone().debug_assert();
        program.build();
        for command in program.get_subcommands().filter(|c| c.get_name() != "help") {
            let wanted = format!("  angioray {} ", command.get_name());
            let wanted = wanted.trim_end();
            let helps = [command.get_after_help(), command.get_after_long_help()];
            for help in helps.map(|help| help.map(ToString::to_string)) {
                let has_example = help.is_some_and(|text| text.contains(wanted));
                assert!(has_example, "{}", command.get_name());
            }
        }
    }
}
