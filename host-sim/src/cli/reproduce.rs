//! `reproduce`: the paper's results beside ours.

use super::{Failure, exit_status, report, size_of_screen};
use clap::Args;
use host_sim::reproduce::{self, CHAPTERS, Chapter, Effort, Reproduction, Section};
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
    /// Fly only a few seeds where results are random
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
        let page = self.out.join("index.html");
        // Before the work, so that a folder that cannot be had costs no time.
        fs::create_dir_all(&self.out).map_err(|error| cannot("make the folder", &self.out, &error))?;
        let chapters = CHAPTERS.iter().filter(|chapter| self.wants(chapter));
        let sections: Vec<Section> = chapters.map(|chapter| run(chapter, effort)).collect();
        report(self.json, &sections, || {
            let columns = size_of_screen().and_then(|(columns, _)| u16::try_from(columns).ok());
            reproduce::table(&sections, columns) + &format!("\nThe page: {}\n", page.display())
        })?;
        fs::write(&page, reproduce::page(&sections)).map_err(|error| cannot("write", &page, &error))?;
        Ok(exit_status(reproduce::succeeds(&sections)))
    }

    fn wants(&self, chapter: &Chapter) -> bool {
        self.only.is_empty() || self.only.iter().any(|wanted| wanted.id == chapter.id)
    }
}

/// Runs a chapter and reports its progress on standard error.
fn run(chapter: &Chapter, effort: Effort) -> Section {
    let terminal = io::stderr().is_terminal();
    let title = format!("{}: {}", chapter.id, chapter.about);
    // What cannot be shown is no reason to stop.
    let say = |text: String| _ = io::stderr().write_all(text.as_bytes());
    if !terminal {
        say(format!("{title}\n"));
    }
    let section = chapter.run(&Reproduction::new(effort, &|done, all| {
        if terminal {
            say(format!("\r\x1b[K{title}, {done} of {all}"));
        }
    }));
    if terminal {
        say(format!("\r\x1b[K{title}\n"));
    }
    section
}

fn cannot(what: &str, path: &Path, error: &io::Error) -> String {
    format!("cannot {what} {}: {error}", path.display())
}

fn chapter(id: &str) -> Result<&'static Chapter, String> {
    let ids = || CHAPTERS.iter().map(|chapter| chapter.id).collect::<Vec<_>>().join(", ");
    reproduce::chapter(id).ok_or_else(|| format!("there is no section '{id}': the sections are {}", ids()))
}

#[cfg(test)]
mod tests {
    use super::super::{Cli, Verb};
    use clap::Parser;
    use std::process::ExitCode;
    use std::{env, fs, process};

    fn reproduce(arguments: &[&str]) -> Result<super::Reproduce, String> {
        let all = [&["host-sim", "reproduce"], arguments].concat();
        match Cli::try_parse_from(all).map_err(|error| error.to_string())?.verb {
            Some(Verb::Reproduce(reproduce)) => Ok(reproduce),
            _ => panic!("another verb"),
        }
    }

    #[test]
    fn sections_are_taken_by_name_and_an_unknown_one_is_refused_with_those_there_are() {
        let some = reproduce(&["--only", "5.1", "--only", "tables"]).unwrap();
        assert_eq!(some.only.iter().map(|chapter| chapter.id).collect::<Vec<_>>(), ["5.1", "tables"]);
        assert!(reproduce(&[]).unwrap().only.is_empty());
        let refusal = reproduce(&["--only", "7"]).unwrap_err();
        assert!(refusal.contains("there is no section '7': the sections are 5.1, 5.2"), "{refusal}");
    }

    #[test]
    fn a_page_is_written_and_a_folder_that_cannot_be_made_is_named_before_the_work() {
        let folder = env::temp_dir().join(format!("host-sim-reproduce-{}", process::id()));
        let out = folder.to_str().expect("it is text");
        let one = reproduce(&["--only", "5.2", "--quick", "--out", out]).unwrap();
        assert_eq!(one.run().expect("it can be written"), ExitCode::SUCCESS);
        let page = folder.join("index.html");
        assert!(fs::read_to_string(&page).expect("it is there").ends_with("</html>\n"));
        let within = page.join("more");
        let refused = reproduce(&["--out", within.to_str().expect("it is text")]).unwrap().run().unwrap_err();
        let wanted = format!("cannot make the folder {}: ", within.display());
        assert!(refused.to_string().starts_with(&wanted), "{refused}");
        fs::remove_dir_all(folder).expect("it is there");
    }
}
