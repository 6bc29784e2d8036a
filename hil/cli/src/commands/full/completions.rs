//! `hil completions` and `hil man`: descriptions of the commands for shells and for `man`.

use std::path::{Path, PathBuf};

use clap::{Args, CommandFactory as _};
use clap_complete::Shell;
use clap_mangen::Man;
use mesh_damper_output::Plan;
use mesh_damper_output::error::InputError;

use crate::commands::{Cli, Failure, say};

/// The name of the program.
const PROGRAM: &str = "hil";

/// Print a script that completes commands and options in a shell
#[derive(Args, Debug)]
#[command(
    after_help = "Examples:\n  hil completions bash > ~/.local/share/bash-completion/completions/hil\n  \
    hil completions zsh > ~/.zfunc/_hil\n  \
    hil completions fish > ~/.config/fish/completions/hil.fish"
)]
pub struct CompletionsCommand {
    /// The shell
    #[arg(value_enum, value_name = "SHELL")]
    shell: Shell,
}

impl CompletionsCommand {
    pub fn run(self) -> Result<(), Failure> {
        let output = Path::new("-");
        let mut outputs = Plan::new().writes([output]).begin()?;
        let mut script = Vec::new();
        clap_complete::generate(self.shell, &mut Cli::command(), PROGRAM, &mut script);
        outputs.add(output, script);
        Ok(outputs.write()?)
    }
}

/// Write man pages of `hil` and of each of its commands
///
/// Writes hil.1, hil-trace.1 and so on into the folder of --out. `man -l FILE` shows one.
#[derive(Args, Debug)]
#[command(after_help = "Example:\n  hil man --out ~/.local/share/man/man1")]
pub struct ManCommand {
    /// Folder for the pages
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
}

impl ManCommand {
    pub fn run(self) -> Result<(), Failure> {
        let pages = pages()?;
        let names = pages.iter().map(|(name, _)| name);
        let mut outputs = Plan::new().fills(self.out.as_path(), names).begin()?;
        let count = pages.len();
        for (name, page) in pages {
            outputs.add(self.out.join(name), page);
        }
        outputs.write()?;
        say(&format!("{count} pages are in {}", self.out.display()));
        Ok(())
    }
}

/// All pages with the names of their files.
fn pages() -> Result<Vec<(String, Vec<u8>)>, InputError> {
    let mut whole = Cli::command().disable_help_subcommand(true);
    whole.build();
    let mut pages = Vec::new();
    add_pages(&whole, PROGRAM, &mut pages)
        .map_err(|error| InputError::new("the man pages", error.to_string(), "report this"))?;
    Ok(pages)
}

fn add_pages(
    command: &clap::Command,
    name: &str,
    pages: &mut Vec<(String, Vec<u8>)>,
) -> std::io::Result<()> {
    for part in command.get_subcommands().filter(|part| !part.is_hide_set()) {
        add_pages(part, &format!("{name}-{}", part.get_name()), pages)?;
    }
    let mut page = Vec::new();
    let command = command.clone().display_name(name.to_owned());
    Man::new(command)
        .source(concat!("mesh-damper ", env!("CARGO_PKG_VERSION")))
        .manual("mesh-damper")
        .render(&mut page)?;
    // The section after the options contains the examples.
    let page = String::from_utf8_lossy(&page).replace("\n.SH EXTRA\n", "\n.SH EXAMPLES\n");
    pages.push((format!("{name}.1"), page.into_bytes()));
    Ok(())
}
