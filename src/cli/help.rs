//! The program's help: `-h` is short, a line for each option, and `--help` says all.

use clap::{Arg, Command, CommandFactory};

use super::Arguments;
use crate::options::help::is_label;

/// Columns of the help where the output is no terminal, and at most.
pub const WIDTH: usize = 100;

/// The width that the parser puts before and between the columns of the short help.
const MARGINS: usize = 12;

/// The short texts of options whose own text does not begin with one, without what they belong to and their
/// default: the command, or nothing for all of them; the option; the text.
#[rustfmt::skip]
const BRIEF: &[(&str, &str, &str)] = &[
    ("", "smooth", "Smooth with a Gaussian of this sigma in mm"),
    ("", "caps", "close the surface where the volume ends"),
    ("", "refine", "how a hit is refined"),
    ("", "recon", "the filter at hits alone"),
    ("", "jitter", "Shift each ray's samples, against bands"),
    ("render", "check-sampling", "Say whether the step will do"),
    ("", "diffuse", "light reflected in all directions"),
    ("", "gradient-scale", "voxels from one to the next"),
    ("", "refill", "the blocks that are cast too"),
    ("", "screen-error", "Fill pixels that are proven to be within E"),
    ("", "lmip-threshold", "the value from which a local maximum counts"),
    ("", "raw-type", "Voxel type of a headerless raw file, such as u16be"),
    ("", "raw-offset", "Bytes before a headerless raw file's voxels"),
    ("", "light", "where light comes from; up to 4 times"),
    ("", "shade-from", "the gradient from which on it is shaded fully"),
    ("", "ambient-color", "tint of that light"),
    ("", "diffuse-color", "tint of that light"),
    ("", "specular-color", "tint of that light"),
    ("", "gradient-smooth", "sigma of the smoothing before them"),
    ("", "light-size", "The angle that each light fills"),
    ("", "ssao", "Ambient occlusion estimated from the picture"),
    ("", "cue", "cues to depth"),
    ("", "cue-range", "the depths of near and far"),
    ("", "clip-plane", "Keep what lies on this side of a plane; up to 64 times"),
    ("", "sampling", "exact, solving every cell, or at fixed steps"),
    ("", "probe", "search for peaks between samples"),
    ("", "max-error", "Choose the cheapest sampling within this error"),
    ("", "azimuth", "Turn the eye to the picture's right"),
    ("", "ortho", "Orthographic, the picture being this high"),
    ("", "device", "A device's number, part of its name, or reference"),
    ("", "scene", "Options from a TOML file, or those of a picture that carries them"),
    ("", "aov", "Layers beside the colour in .exr and .npy, or all"),
    ("render", "output", "The picture: .png .jpg .webp .exr .npy"),
    ("replay", "output", "The picture: .png .jpg .webp .exr .npy"),
    ("replay", "volume", "The volume, if it is not where the picture says"),
    ("orbit", "output", "Pictures such as frames/%04d.png, or .gif .apng .mp4 .webm"),
    ("orbit", "resume", "Keep existing frames, make the missing ones"),
    ("orbit", "axis", "The axis of rotation, through the target"),
    ("compare", "output", "A folder for the report, the tables and the pictures"),
    ("compare", "configs", "Settings to compare in place of the built-in ones"),
    ("bench", "output", "A folder for the table and the report"),
    ("bench", "frames", "How often each mode is timed in the experiment speed"),
    ("bench", "seed", "Decides the volumes and the rays that are tried"),
    ("bench", "peer", "Another renderer to time in the experiment speed"),
    ("bench", "restart", "Discard what a stopped run left in the folder"),
];

/// The program as it reads its arguments and explains itself.
pub fn program() -> Command {
    let mut program = shortened(Arguments::command(), "angioray");
    let names: Vec<String> = program
        .get_subcommands()
        .map(|command| command.get_name().to_owned())
        .collect();
    for name in names {
        program = program.mut_subcommand(&name, |command| {
            shortened(command, &format!("angioray {name}"))
        });
    }
    program
}

/// A command with a short help beside its whole one.
fn shortened(command: Command, name: &str) -> Command {
    let widths = widths(&command);
    let own = name.rsplit(' ').next().unwrap_or_default().to_owned();
    let command = command.mut_args(|argument| {
        let group = widths
            .iter()
            .find(|(group, _)| *group == group_of(&argument));
        let width = group.map_or(0, |(_, width)| *width);
        shortened_option(argument, &own, WIDTH.saturating_sub(MARGINS + width))
    });
    let whole = command
        .get_after_long_help()
        .or(command.get_after_help())
        .map(ToString::to_string)
        .unwrap_or_default();
    let mut short = String::new();
    if let Some(example) = first_example(&whole) {
        short.push_str(&format!("Example:\n  {example}\n\n"));
    }
    short.push_str(&format!("Full help: {name} --help"));
    command.after_help(short).after_long_help(whole)
}

/// An option whose text is one paragraph gets its beginning as the short one.
fn shortened_option(argument: Arg, command: &str, room: usize) -> Arg {
    let Some(help) = argument.get_help().map(ToString::to_string) else {
        return argument;
    };
    let name = argument.get_long().map(str::to_owned);
    let is_it = |(of, option, _): &&(&str, &str, &str)| {
        Some(*option) == name.as_deref() && (of.is_empty() || *of == command)
    };
    let short = match BRIEF.iter().find(is_it) {
        Some((_, _, text)) => {
            let (label, _, default) = parts(&help);
            brief(&format!("{label}{text}{default}"), room)
        }
        None => brief(&help, room),
    };
    let long = argument.get_long_help().map(ToString::to_string);
    argument.long_help(long.unwrap_or(help)).help(short)
}

/// The arguments that share a first column: the options under one heading, or the positional arguments.
fn group_of(argument: &Arg) -> (bool, Option<String>) {
    let heading = argument.get_help_heading().map(str::to_owned);
    (argument.is_positional(), heading)
}

/// The width of the first column of each group: an option's names and values.
fn widths(command: &Command) -> Vec<((bool, Option<String>), usize)> {
    let mut widths: Vec<((bool, Option<String>), usize)> = Vec::new();
    for argument in command.get_arguments() {
        let values = argument.get_value_names().unwrap_or_default().iter();
        let values: usize = values.map(|value| value.len() + " <>".len()).sum();
        let may_lack = argument.get_num_args().is_some_and(|n| n.min_values() == 0);
        let width = match argument.get_long() {
            // Room for a short name is always left.
            Some(long) if may_lack => "-o, --[=".len() + long.len() + values,
            Some(long) => "-o, --".len() + long.len() + values,
            None => values,
        };
        let group = group_of(argument);
        match widths.iter_mut().find(|(other, _)| *other == group) {
            Some((_, max_width)) => *max_width = width.max(*max_width),
            None => widths.push((group, width)),
        }
    }
    widths
}

/// The first of the examples of a help's end.
fn first_example(help: &str) -> Option<&str> {
    let mut lines = help.lines().skip_while(|line| *line != "Example:").skip(1);
    lines.next().map(str::trim).filter(|line| !line.is_empty())
}

/// The beginning of an option's text, up to `room` characters: its first clause, and its default where
/// there is room for it.
fn brief(help: &str, room: usize) -> String {
    let length = |text: &str| text.chars().count();
    if length(help) <= room {
        return help.to_owned();
    }
    let (label, text, default) = parts(help);
    let mut brief = format!("{label}{}", first_clause(text));
    while length(&brief) > room {
        let Some(cut) = brief.rfind(", ").or_else(|| brief.rfind(' ')) else {
            break;
        };
        brief.truncate(cut);
    }
    if length(&brief) + length(default) <= room {
        brief.push_str(default);
    }
    brief
}

/// A help's label with its colon, its text, and its default in brackets; the first and the last may be
/// empty.
fn parts(help: &str) -> (&str, &str, &str) {
    let end = help.rfind(" [default: ").unwrap_or(help.len());
    let (text, default) = help.split_at(end);
    let label = text.find(": ").filter(|&end| is_label(&text[..end]));
    let (label, text) = text.split_at(label.map_or(0, |end| end + ": ".len()));
    (label, text, default)
}

/// A text up to the end of its first clause.
fn first_clause(text: &str) -> &str {
    let ends = [": ", "; ", ". ", " ("];
    let end = ends.iter().filter_map(|end| text.find(end)).min();
    text[..end.unwrap_or(text.len())].trim_end_matches('.')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_brief_text_is_the_first_clause_with_its_default_where_there_is_room() {
        for (help, room, expected) in [
            (
                "Skip empty space; never changes [default: on]",
                40,
                "Skip empty space [default: on]",
            ),
            (
                "Skip empty space; never changes [default: on]",
                20,
                "Skip empty space",
            ),
            (
                "iso, dvr: none, phong or other [default: a]",
                50,
                "iso, dvr: none, phong or other [default: a]",
            ),
            (
                "The eye's position, in mm. LPS",
                28,
                "The eye's position, in mm",
            ),
            ("The eye's position, in mm", 20, "The eye's position"),
            ("One two three", 8, "One two"),
        ] {
            assert_eq!(brief(help, room), expected);
        }
    }

    #[test]
    fn the_short_help_has_a_line_for_each_option_and_names_the_whole_one() {
        for mut command in program().get_subcommands().cloned() {
            let name = command.get_name().to_owned();
            let short = command.render_help().to_string();
            let whole = command.render_long_help().to_string();
            let end = format!("Full help: angioray {name} --help");
            assert!(short.trim_end().ends_with(&end), "{short}");
            for option in command.get_arguments() {
                let Some(long) = option.get_long() else {
                    continue;
                };
                let flag = format!("--{long}");
                let shows = |line: &&str| {
                    let mut columns = line.trim_start().split("  ");
                    let spec = columns.next().unwrap_or_default();
                    line.starts_with(' ') && spec.split([' ', '[']).any(|word| word == flag)
                };
                let line = short.lines().find(shows).unwrap_or_default();
                let text = option
                    .get_help()
                    .map(ToString::to_string)
                    .unwrap_or_default();
                assert!(
                    line.ends_with(&text),
                    "{name}: {flag} takes more than a line\n{short}"
                );
                assert!(line.chars().count() <= WIDTH, "{line}");
                // The whole one says more where there is more.
                let all = option
                    .get_long_help()
                    .map(ToString::to_string)
                    .unwrap_or_default();
                assert!(
                    whole.contains(all.split(' ').next().unwrap_or_default()),
                    "{flag}"
                );
            }
        }
    }

    #[test]
    fn short_texts_end_where_a_clause_or_a_part_of_it_does() {
        let text = |text: Option<&clap::builder::StyledStr>| {
            text.map(ToString::to_string).unwrap_or_default()
        };
        let is_complete = |option: &Arg| {
            let (short, long) = (text(option.get_help()), text(option.get_long_help()));
            let ((label, short, _), (whole, before, _)) = (parts(&short), parts(&long));
            let is_clause = short == before
                || short == first_clause(before)
                || first_clause(before).starts_with(&format!("{short}, "));
            label == whole
                && (is_clause || BRIEF.iter().any(|(_, _, brief)| brief.starts_with(short)))
        };
        let program = program();
        let cut_off: Vec<String> = program
            .get_subcommands()
            .flat_map(Command::get_arguments)
            .filter(|option| !is_complete(option))
            .map(|option| option.get_id().to_string())
            .collect();
        assert!(
            cut_off.is_empty(),
            "give these short texts of their own: {cut_off:?}"
        );
        // The control: what does not fit is cut off.
        let cut = shortened_option(Arg::new("x").help("One two three four"), "", 8);
        assert!(!is_complete(&cut));
    }

    #[test]
    fn every_text_of_its_own_is_an_option_s() {
        let program = program();
        for (of, option, _) in BRIEF {
            let has = |command: &&Command| {
                let mut options = command.get_arguments();
                (of.is_empty() || command.get_name() == *of)
                    && options.any(|one| one.get_long() == Some(*option))
            };
            assert!(
                program.get_subcommands().any(|command| has(&command)),
                "{of} {option}"
            );
        }
    }
}
