//! Where an option's help begins and ends: what it belongs to and its default, both of the table of rules
//! ([`super::rules`]). In between stands what the option itself says.

use clap::Arg;

use super::rules::{Decides, Group, Need, PROJECTIONS, RULES, Rule, deciding, rule};
use crate::scene::Mode;

/// Completes an argument's help by its rule, where it is an option of the scene: `dvr: the opacity at which
/// a ray ends [default: 0.999]`.
pub(crate) fn completed(argument: Arg) -> Arg {
    let rule = rule(Group::Scene, &option_of(&argument));
    let (Some(rule), Some(help)) = (rule, argument.get_help().map(ToString::to_string)) else {
        return argument;
    };
    let help = match label(rule) {
        Some(label) => format!("{label}: {}", uncapitalized(&help)),
        None => help,
    };
    argument.help(match rule.default {
        Some(default) => format!("{help} [default: {}]", default()),
        None => help,
    })
}

/// Completes the help of an error bound by the options of which it takes the place.
pub(super) fn completed_bound(argument: Arg) -> Arg {
    let help = argument.get_help().map(ToString::to_string);
    let (true, Some(help)) = (argument.get_id() == "max_error", help) else {
        return argument;
    };
    let decided = deciding(|decides| decides == Decides::HowWithinBound);
    let decided: Vec<String> = decided.map(|option| format!("--{option}")).collect();
    argument.help(format!("{help}; takes the place of {}", decided.join(", ")))
}

/// Whether a text is what an option's help may begin with.
pub(crate) fn is_label(text: &str) -> bool {
    RULES
        .iter()
        .any(|rule| label(rule).as_deref() == Some(text))
}

/// An argument's name as the table of rules has it: its flag's.
fn option_of(argument: &Arg) -> String {
    match argument.get_long() {
        Some(long) => long.to_owned(),
        None => argument.get_id().as_str().replace('_', "-"),
    }
}

/// What an option belongs to: of what it needs the narrowest, which comes last, and fixed steps.
fn label(rule: &Rule) -> Option<String> {
    let modes = rule.needs.iter().find_map(|need| match need {
        Need::Modes(modes, _) => Some(*modes),
        _ => None,
    });
    let modes = modes.unwrap_or_default();
    let narrowest = rule.needs.iter().rev().find_map(|need| match need {
        Need::Modes(..) => Some(names(modes, "")),
        Need::Normals => Some(names(modes, "shaded ")),
        Need::Shading => Some("shading".to_owned()),
        Need::Precomputed(_) => Some("precomputed gradients".to_owned()),
        Need::Eye => Some("with --eye".to_owned()),
        Need::Homogeneity => Some("with --homogeneity".to_owned()),
        Need::Sparse => Some("with --sparse".to_owned()),
        Need::Lens => Some("with --dof".to_owned()),
        Need::Cues => Some("with --cue".to_owned()),
        Need::Shadows => Some("with --shadows".to_owned()),
        _ => None,
    });
    let steps = rule
        .needs
        .contains(&Need::Steps)
        .then(|| "fixed steps".to_owned());
    let parts: Vec<String> = narrowest.into_iter().chain(steps).collect();
    (!parts.is_empty()).then(|| parts.join(", "))
}

/// The names of modes; `dvr` is what a medium has to be.
fn names(modes: &[Mode], dvr: &str) -> String {
    if modes == PROJECTIONS {
        return "projections".to_owned();
    }
    let name = |mode: &Mode| match mode {
        Mode::Dvr => format!("{dvr}{mode}"),
        _ => mode.to_string(),
    };
    modes.iter().map(name).collect::<Vec<_>>().join(", ")
}

/// A sentence as it goes on behind a label.
fn uncapitalized(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| {
        first.to_lowercase().chain(letters).collect()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_help_begins_with_what_the_option_needs_and_ends_with_its_default() {
        for (id, own, expected) in [
            ("termination", "The end", "dvr: the end [default: 0.999]"),
            (
                "refine",
                "How",
                "iso, fixed steps: how [default: regula-falsi:5]",
            ),
            (
                "window",
                "Values",
                "projections: values [default: the value range, without a few far-away values and padding]",
            ),
            ("gradient", "How", "iso, shaded dvr: how [default: central]"),
            (
                "ambient",
                "Light",
                "shading: light [default: 0.1; 0.5 with --ao or --ssao]",
            ),
            (
                "shading",
                "none",
                "iso, dvr: none [default: phong for iso, none for dvr]",
            ),
            (
                "up",
                "Up",
                "with --eye: up [default: 0,0,1; when looking along z that of the views superior and inferior]",
            ),
            ("eye", "The eye", "The eye"),
            ("zoom", "Magnify", "Magnify [default: 1]"),
            // The control: no option of the scene.
            ("output", "The file", "The file"),
        ] {
            let argument = completed(Arg::new(id).long(id).help(own));
            assert_eq!(argument.get_help().unwrap().to_string(), expected);
        }
        assert!(is_label("iso, shaded dvr") && is_label("fixed steps"));
        assert!(!is_label("Then raise the eye toward the picture's top"));
    }
}
