//! `--scene`: every command's options from a file, or from a picture that carries its scene.

use std::path::{Path, PathBuf};

use clap::CommandFactory;

use crate::error::Result;
use crate::options::{SceneFile, flag_names};

use super::carried::Carried;
use super::{Arguments, Voice, terminal};

#[derive(clap::Args)]
pub struct SceneArgument {
    /// Take options from a TOML file: the flags' names as keys, those of other commands left
    /// alone, files relative to it; flags win over it. Or from a picture, .png or .exr, that carries
    /// its scene
    #[arg(long, value_name = "FILE.toml|PICTURE", help_heading = "Scene")]
    scene: Option<PathBuf>,
}

impl SceneArgument {
    pub fn path(&self) -> Option<&Path> {
        self.scene.as_deref()
    }

    /// The file named, or one that says nothing; of a picture the scene that it carries. One file may serve several commands: a key is
    /// wrong when no command has such a flag.
    pub fn open(&self) -> Result<SceneFile> {
        let Some(path) = &self.scene else {
            return Ok(SceneFile::of_text("", ""));
        };
        let file = match Carried::of(path)? {
            Some(carried) => carried.scene_file(),
            None => SceneFile::read(path)?,
        };
        file.check_keys(&keys())?;
        if let Some(quiet) = file.group::<Voice>()?.quiet {
            terminal::set_quiet(quiet.is_on());
        }
        Ok(file)
    }
}

/// The names of all commands' flags that a scene file may hold.
fn keys() -> Vec<String> {
    let program = Arguments::command();
    let names = program.get_subcommands().flat_map(flag_names);
    let names = names.chain(flag_names(&program));
    names.filter(|name| name != "scene").collect()
}
