//! The report as a table for the terminal.

use super::report::{Item, Section, Verdict};
use crate::words::counted;
use comfy_table::{ContentArrangement, LineStyle, Table, TableStyle};

/// A line below the header and nothing else.
const STYLE: TableStyle = TableStyle::new().header_separator(LineStyle::new('─', '─', '─', '─'));

/// A terminal narrower than this gets lines that are too long for it.
const NARROWEST: u16 = 80;

/// One table of all items, a title above each section; wrapped to so many `columns`.
#[must_use]
pub fn table(sections: &[Section], columns: Option<u16>) -> String {
    let mut text = String::new();
    for section in sections {
        let mut table = Table::new();
        table.load_style(STYLE).set_header(["item", "paper", "ours", "wanted", "verdict"]);
        table.add_rows(section.items.iter().map(row));
        if let Some(columns) = columns {
            table.set_content_arrangement(ContentArrangement::Dynamic).set_width(columns.max(NARROWEST));
        }
        table.column_iter_mut().for_each(|column| {
            column.set_padding((0, 2));
        });
        text += &format!("{}  {}\n\n{}\n\n", section.id, section.title, table.trim_fmt());
        for item in &section.items {
            if let Some(note) = &item.note {
                text += &format!("  {}: {note}\n", item.what);
            }
        }
        text += "\n";
    }
    text + &tally(sections) + "\n"
}

fn row(item: &Item) -> [String; 5] {
    let text = |value: &Option<String>| value.clone().unwrap_or_else(|| "-".to_owned());
    [
        item.what.clone(),
        text(&item.paper),
        text(&item.ours),
        text(&item.tolerance),
        item.verdict.word().to_owned(),
    ]
}

/// How many items came out how.
#[must_use]
pub fn tally(sections: &[Section]) -> String {
    let items = || sections.iter().flat_map(|section| &section.items);
    let verdicts = [
        Verdict::Agrees,
        Verdict::Holds,
        Verdict::Differs,
        Verdict::Unknown,
        Verdict::Measured,
        Verdict::Misses,
    ];
    let count = |verdict: &Verdict| items().filter(|item| item.verdict == *verdict).count();
    let parts: Vec<_> = verdicts
        .iter()
        .map(|verdict| (verdict, count(verdict)))
        .filter(|&(verdict, count)| count > 0 || *verdict == Verdict::Misses)
        .map(|(verdict, count)| format!("{count} {}", verdict.word()))
        .collect();
    let all = u32::try_from(items().count()).unwrap_or(u32::MAX);
    format!("{}: {}", counted(all, "item"), parts.join(", "))
}
