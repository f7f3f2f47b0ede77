//! `reproduce`: the paper's results beside ours.

use super::{Failure, NOT_ACCOMPLISHED, print, size_of_screen};
use clap::Args;
use host_sim::reproduce::{self, CHAPTERS, Chapter, Effort, Run, Section};
use std::fs;
use std::io::{self, IsTerminal, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

pub(super) const EXAMPLES: &str = "\
Examples:
  host-sim reproduce                 everything, into the folder reproduction
  host-sim reproduce --only 6.2      one section
  host-sim reproduce --only 5.1 --only tables --out /tmp/paper
  host-sim reproduce --json | jq '.[].items[] | select(.verdict == \"misses\")'
docs/paper.md says what the modes 'as published' and 'default' are.

Exit status:
  0  no item falls short
  1  some item does
  2  wrong usage, or the page cannot be written";

#[derive(Args, Debug)]
pub(super) struct Reproduce {
    /// Only this section; may be given several times
    #[arg(long, value_name = "SECTION", value_parser = chapter)]
    only: Vec<&'static Chapter>,
    /// Fly only a few seeds where chance has a say
    #[arg(long)]
    quick: bool,
    /// Print everything as JSON, and nothing else
    #[arg(long)]
    json: bool,
    /// The folder to write the page index.html into
    #[arg(long, value_name = "DIR", default_value = "reproduction")]
    out: PathBuf,
}

impl Reproduce {
    pub(super) fn run(&self) -> Result<ExitCode, Failure> {
        let effort = if self.quick { Effort::Quick } else { Effort::Full };
        let chapters = CHAPTERS.iter().filter(|chapter| self.wants(chapter));
        let sections: Vec<Section> = chapters.map(|chapter| run(chapter, effort)).collect();
        let page = self.out.join("index.html");
        write(&self.out, &page, &reproduce::page(&sections))?;
        let text = if self.json {
            serde_json::to_string(&sections)? + "\n"
        } else {
            let columns = size_of_screen().and_then(|(columns, _)| u16::try_from(columns).ok());
            reproduce::table(&sections, columns) + &format!("\nThe page: {}\n", page.display())
        };
        print(&text)?;
        let succeeds = reproduce::succeeds(&sections);
        Ok(if succeeds { ExitCode::SUCCESS } else { ExitCode::from(NOT_ACCOMPLISHED) })
    }

    fn wants(&self, chapter: &Chapter) -> bool {
        self.only.is_empty() || self.only.iter().any(|wanted| wanted.id == chapter.id)
    }
}

/// Runs a chapter and says on standard error how far it has come.
fn run(chapter: &Chapter, effort: Effort) -> Section {
    let terminal = io::stderr().is_terminal();
    let title = format!("{}: {}", chapter.id, chapter.about);
    // What cannot be shown is no reason to stop.
    let say = |text: String| _ = io::stderr().write_all(text.as_bytes());
    if !terminal {
        say(format!("{title}\n"));
    }
    let section = chapter.run(&Run::new(effort, &|done, all| {
        if terminal {
            say(format!("\r\x1b[K{title}, {done} of {all}"));
        }
    }));
    if terminal {
        say(format!("\r\x1b[K{title}\n"));
    }
    section
}

fn write(folder: &Path, page: &Path, text: &str) -> Result<(), Failure> {
    let named = |path: &Path, error: io::Error| format!("{}: {error}", path.display());
    fs::create_dir_all(folder).map_err(|error| named(folder, error))?;
    fs::write(page, text).map_err(|error| named(page, error))?;
    Ok(())
}

fn chapter(id: &str) -> Result<&'static Chapter, String> {
    let ids = || CHAPTERS.iter().map(|chapter| chapter.id).collect::<Vec<_>>().join(", ");
    reproduce::chapter(id).ok_or_else(|| format!("there is no section '{id}': the sections are {}", ids()))
}
