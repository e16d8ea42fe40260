//! `angioray completion`.

use clap::CommandFactory;
use clap_complete::Shell;

use crate::error::{Error, Result};
use crate::options::group::group;
use crate::options::text_form::readable;

use super::scene::SceneArgument;
use super::terminal::to_stdout;

/// Print a shell's completions of the commands and options
#[derive(clap::Args)]
#[command(override_usage = "angioray completion SHELL [OPTIONS]")]
#[command(after_help = "Example:
  angioray completion bash
  angioray completion zsh

Shells look for it in these files:
  bash  ~/.local/share/bash-completion/completions/angioray
  fish  ~/.config/fish/completions/angioray.fish
  zsh   _angioray, in a folder of $fpath")]
pub struct CompletionArguments {
    #[command(flatten)]
    completion: CompletionOptions,

    #[command(flatten)]
    scene: SceneArgument,
}

group! {
    /// Whose completions.
    pub struct CompletionOptions {
        /// The shell: bash, elvish, fish, powershell or zsh
        #[arg(value_name = "SHELL")]
        shell: ShellName,
    }
}

/// A shell by its name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ShellName(Shell);

impl std::str::FromStr for ShellName {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let shell = <Shell as clap::ValueEnum>::from_str(text.trim(), true);
        shell.map(Self).map_err(|_| {
            Error::usage(format!(
                "'{text}' is not a shell: write bash, elvish, fish, powershell or zsh"
            ))
        })
    }
}

readable!(ShellName);

impl CompletionArguments {
    pub fn run(self) -> Result<()> {
        let file = self.scene.open()?;
        let options = self.completion.over(file.group()?);
        let Some(ShellName(shell)) = options.shell else {
            return Err(Error::usage("no shell was named")
                .hint("write bash, elvish, fish, powershell or zsh"));
        };
        let mut script = Vec::new();
        let mut program = super::Arguments::command();
        clap_complete::generate(shell, &mut program, "angioray", &mut script);
        to_stdout(|out| out.write_all(&script))
    }
}
