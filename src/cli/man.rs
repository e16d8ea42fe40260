//! `angioray man`.

use std::io;

use clap_mangen::Man;

use crate::error::{Error, Result};

use super::help;
use super::scene::SceneArgument;
use super::terminal::to_stdout;

/// Print the manual of the whole program as a man page
#[derive(clap::Args)]
#[command(override_usage = "angioray man [OPTIONS]")]
#[command(after_help = "Example:
  angioray man

'angioray man | man -l -' shows it; man looks for it in ~/.local/share/man/man1/angioray.1.")]
pub struct ManArguments {
    #[command(flatten)]
    scene: SceneArgument,
}

impl ManArguments {
    pub fn run(self) -> Result<()> {
        self.scene.open()?;
        let page = page().map_err(|cause| {
            Error::resource(format!("the manual cannot be put together: {cause}"))
        })?;
        to_stdout(|out| out.write_all(&page))
    }
}

/// The program's own page, then a section for each command.
fn page() -> io::Result<Vec<u8>> {
    let mut program = help::program();
    program.build();
    let mut page = Vec::new();
    let root = Man::new(program.clone());
    root.render_title(&mut page)?;
    root.render_name_section(&mut page)?;
    root.render_synopsis_section(&mut page)?;
    root.render_description_section(&mut page)?;
    root.render_options_section(&mut page)?;
    for command in program.get_subcommands() {
        if command.get_name() != "help" {
            page.extend(section(command)?);
        }
    }
    let mut end = Vec::new();
    root.render_extra_section(&mut end)?;
    page.extend(examples(&String::from_utf8_lossy(&end)).into_bytes());
    root.render_version_section(&mut page)?;
    Ok(page)
}

/// The section of what stands at a help's end: its lines as they are.
fn examples(extra: &str) -> String {
    let lines = extra.lines().map(|line| match line {
        ".SH EXTRA" => ".SH EXAMPLES\n.nf\n".to_owned(),
        other => format!("{other}\n"),
    });
    lines.chain([".fi\n".to_owned()]).collect()
}

/// A command's page, its sections one level down.
fn section(command: &clap::Command) -> io::Result<Vec<u8>> {
    let name = format!("angioray {}", command.get_name());
    let man = Man::new(command.clone());
    let mut own = Vec::new();
    man.render_synopsis_section(&mut own)?;
    man.render_description_section(&mut own)?;
    man.render_options_section(&mut own)?;
    let mut end = Vec::new();
    man.render_extra_section(&mut end)?;
    let mut own = String::from_utf8_lossy(&own).into_owned();
    own.push_str(&examples(&String::from_utf8_lossy(&end)));
    let mut section = format!(".SH {}\n", name.to_uppercase());
    for line in own.lines() {
        match line.strip_prefix(".SH ") {
            Some(title) => section.push_str(&format!(".SS {title}")),
            None => section.push_str(line),
        }
        section.push('\n');
    }
    Ok(section.into_bytes())
}
