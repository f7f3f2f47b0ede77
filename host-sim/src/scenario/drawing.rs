//! The drawn map: free cells, obstacles, and where robots and goals are.

use super::{Floor, MAX_CELLS};
use crate::input::{Fault, Read, refuse};
use crate::text::counted;
use iibt_core::grid::Cell;
use iibt_core::team::MAX_TEAM;
use std::ops::Range;
use toml::Spanned;

/// The content of a drawn map.
pub(super) struct Drawing {
    pub map: Floor,
    /// The start that is drawn for each robot, by its number less one.
    pub starts: [Option<Cell>; MAX_TEAM],
    /// The goals, row by row.
    pub goals: Vec<Cell>,
}

/// One row: its characters, and where they are written.
struct MapRow<'t> {
    marks: &'t str,
    span: Range<usize>,
}

impl Drawing {
    /// Reads the map written at `drawn` in the file's text.
    pub(super) fn read(text: &str, drawn: &Spanned<String>) -> Read<Self> {
        let rows = rows(text, drawn.span());
        let mut drawing = Self::blank(&rows, drawn.span())?;
        let marks = rows.iter().flat_map(|row| row.marks.chars().map(move |mark| (row, mark)));
        for (index, (row, mark)) in marks.enumerate() {
            let cell = Cell(index as u16);
            drawing.mark(cell, mark).map_err(|reason| {
                let (line, column) = (cell.0 / drawing.map.width(), cell.0 % drawing.map.width());
                Fault::new(row.span.clone(), format!("row {line}, column {column} of the map: {reason}"))
            })?;
        }
        Ok(drawing)
    }

    fn blank(rows: &[MapRow<'_>], span: Range<usize>) -> Read<Self> {
        let width = rows.first().map_or(0, MapRow::width);
        if let Some((number, row)) = rows.iter().enumerate().find(|(_, row)| row.width() != width) {
            let reason = format!(
                "row {number} of the map has {}, but row 0 has {width}",
                counted(row.width() as u32, "cell")
            );
            return refuse(row.span.clone(), reason);
        }
        let map = floor(width, rows.len()).ok_or_else(|| {
            let found = format!("the map has {width} x {} cells", rows.len());
            Fault::new(span, format!("{found}: draw 2 to {MAX_CELLS}, '.' for free and '#' for blocked"))
        })?;
        Ok(Self { map, starts: [None; MAX_TEAM], goals: Vec::new() })
    }

    fn mark(&mut self, cell: Cell, mark: char) -> Result<(), String> {
        match mark {
            '.' => Ok(()),
            '#' => {
                self.map.block(cell);
                Ok(())
            }
            'G' => {
                self.goals.push(cell);
                Ok(())
            }
            '1'..='8' => match self.starts[mark as usize - '1' as usize].replace(cell) {
                None => Ok(()),
                Some(before) => Err(format!("robot {mark} is drawn at {} already", before.0)),
            },
            other => Err(format!(
                "'{}' is not a map character: '.' is free, '#' blocked, '1' to '8' a robot, 'G' a goal",
                other.escape_debug()
            )),
        }
    }
}

impl MapRow<'_> {
    fn width(&self) -> usize {
        self.marks.chars().count()
    }
}

/// Returns a map without obstacles, if this size is possible.
fn floor(width: usize, height: usize) -> Option<Floor> {
    let fits = (2..=MAX_CELLS).contains(&width.checked_mul(height)?);
    let (width, height) = (u16::try_from(width).ok()?, u16::try_from(height).ok()?);
    fits.then(|| Floor::new(width, height).ok()).flatten()
}

/// The rows as they stand in the file, without quotes, indentation, and empty lines around them.
fn rows(text: &str, span: Range<usize>) -> Vec<MapRow<'_>> {
    let written = text.get(span.clone()).unwrap_or_default();
    let opened = written.trim_start_matches(['"', '\'']);
    let mut at = span.start + written.len() - opened.len();
    let mut rows = Vec::new();
    for line in opened.trim_end_matches(['"', '\'']).split_inclusive('\n') {
        rows.push(MapRow { marks: line.trim(), span: at..at + line.len() });
        at += line.len();
    }
    let drawn = |row: &MapRow<'_>| !row.marks.is_empty();
    rows.truncate(rows.iter().rposition(drawn).map_or(0, |last| last + 1));
    let first = rows.iter().position(drawn).unwrap_or(0);
    rows.split_off(first)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenario::file::ScenarioFile;

    fn read(text: &str) -> Read<Drawing> {
        let file: ScenarioFile = toml::from_str(text).unwrap();
        Drawing::read(text, &file.map)
    }

    #[test]
    fn a_map_is_read_however_it_is_quoted_and_indented() {
        let texts = [
            "title = 't'\nmap = \"\"\"\n1.#\nG..\n\"\"\"",
            "title = 't'\nmap = '''1.#\nG..'''",
            "title = 't'\nmap = '''\r\n\r\n    1.#\r\n    G..\r\n\r\n  '''\r\n",
        ];
        for text in texts {
            let drawing = read(text).unwrap();
            let size = (drawing.map.width(), drawing.map.height());
            let blocked: Vec<_> = (0..6).map(Cell).filter(|&cell| !drawing.map.is_free(cell)).collect();
            assert_eq!((size, blocked), ((3, 2), vec![Cell(2)]), "{text}");
            assert_eq!((drawing.starts[0], drawing.goals), (Some(Cell(0)), vec![Cell(3)]), "{text}");
        }
    }

    #[test]
    fn a_map_has_a_size_that_fits() {
        let map = |width: usize, height: usize| {
            let rows = vec![".".repeat(width); height].join("\n");
            read(&format!("title = 't'\nmap = '''\n{rows}\n'''")).is_ok()
        };
        assert!(map(2, 1) && map(1, 2) && map(32, 32) && map(1024, 1));
        assert!(!map(0, 0) && !map(1, 1) && !map(33, 32) && !map(1025, 1) && !map(70_000, 1));
    }
}
