//! The report as a table for the terminal.

use super::report::{Item, Section, Verdict};
use crate::text::counted;
use comfy_table::{ContentArrangement, LineStyle, Table, TableStyle};

/// A line below the header and nothing else.
const STYLE: TableStyle = TableStyle::new().header_separator(LineStyle::new('─', '─', '─', '─'));

/// A terminal narrower than this gets lines that are too long for it.
const NARROWEST: u16 = 80;

/// Returns one table of all items, wrapped to `columns`, with remarks and the tally below it.
#[must_use]
pub fn table(sections: &[Section], columns: Option<u16>) -> String {
    let mut table = Table::new();
    table.load_style(STYLE).set_header(["section", "item", "paper", "ours", "wanted", "verdict"]);
    table.add_rows(items(sections).map(|(section, item)| row(section, item)));
    if let Some(columns) = columns {
        table.set_content_arrangement(ContentArrangement::Dynamic).set_width(columns.max(NARROWEST));
    }
    table.column_iter_mut().for_each(|column| {
        column.set_padding((0, 2));
    });
    let notes = items(sections).filter_map(|(section, item)| {
        item.note.as_ref().map(|note| format!("{}, {}: {note}\n", section.id, item.what))
    });
    format!("{}\n\n{}\n{}\n", table.trim_fmt(), notes.collect::<String>(), tally(sections))
}

fn items(sections: &[Section]) -> impl Iterator<Item = (&Section, &Item)> {
    sections.iter().flat_map(|section| section.items.iter().map(move |item| (section, item)))
}

fn row(section: &Section, item: &Item) -> [String; 6] {
    let text = |value: &Option<String>| value.clone().unwrap_or_else(|| "-".to_owned());
    [
        section.id.to_owned(),
        item.what.clone(),
        text(&item.paper),
        text(&item.ours),
        text(&item.tolerance),
        item.verdict.word().to_owned(),
    ]
}

/// The number of items of each verdict.
#[must_use]
pub fn tally(sections: &[Section]) -> String {
    let verdicts = [
        Verdict::Agrees,
        Verdict::Holds,
        Verdict::Differs,
        Verdict::Unknown,
        Verdict::Measured,
        Verdict::Misses,
    ];
    let count = |verdict: &Verdict| items(sections).filter(|(_, item)| item.verdict == *verdict).count();
    let parts: Vec<_> = verdicts
        .iter()
        .map(|verdict| (verdict, count(verdict)))
        .filter(|&(verdict, count)| count > 0 || *verdict == Verdict::Misses)
        .map(|(verdict, count)| format!("{count} {}", verdict.word()))
        .collect();
    let all = u32::try_from(items(sections).count()).unwrap_or(u32::MAX);
    format!("{}: {}", counted(all, "item"), parts.join(", "))
}
