//! The report as a page, complete in itself: text, tables, and figures in SVG.

mod axis;
mod bars;
mod grid;
mod intervals;
mod legend;
mod lines;
mod svg;
mod tree;

use super::figure::{Figure, Panel};
use super::report::{Item, Section, Verdict};
use super::table::tally;
use svg::escaped;

const STYLE: &str = include_str!("page/style.css");

/// The page of these sections.
#[must_use]
pub fn page(sections: &[Section]) -> String {
    let mut page = String::from("<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n");
    page += "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n";
    page += "<link rel=\"icon\" href=\"data:,\">\n";
    page += &format!("<title>The paper, reproduced</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n");
    page += &navigation(sections);
    page += "<main>\n<header>\n<h1>The paper, reproduced</h1>\n<p>Bridging Probabilistic Inference and Behavior Trees: An \
             Interactive Framework for Adaptive Multi-Robot Cooperation (arXiv 2512.04404). Every number in the column \
             <em>ours</em> was computed when this page was made.</p>\n";
    page += &format!("<p class=\"tally\">{}</p>\n{}</header>\n", escaped(&tally(sections)), legend());
    sections.iter().for_each(|part| page += &section(part));
    page + "</main>\n</body>\n</html>\n"
}

fn navigation(sections: &[Section]) -> String {
    let link = |section: &Section| {
        let misses = section.items.iter().any(|item| item.verdict == Verdict::Misses);
        let mark = if misses { " class=\"misses\"" } else { "" };
        format!("<a href=\"#s{0}\"{mark}>{0}</a>", section.id)
    };
    format!("<nav>{}</nav>\n", sections.iter().map(link).collect::<Vec<_>>().join("\n"))
}

/// What the verdicts mean.
fn legend() -> String {
    let meanings = [
        (Verdict::Agrees, "as in the paper, within the tolerance"),
        (Verdict::Holds, "as claimed, where the paper has no such number"),
        (Verdict::Differs, "otherwise than in the paper, for the reason given"),
        (Verdict::Unknown, "the paper does not say enough to compare"),
        (Verdict::Measured, "compared with nothing"),
        (Verdict::Misses, "short of what is wanted"),
    ];
    let entry = |(verdict, meaning)| format!("<span>{} {meaning}</span>", badge(verdict));
    format!("<p class=\"legend\">{}</p>\n", meanings.map(entry).join("\n"))
}

fn section(section: &Section) -> String {
    let mut text =
        format!("<section id=\"s{0}\">\n<h2><small>{0}</small> {1}</h2>\n", section.id, section.title);
    section.text.iter().for_each(|paragraph| text += &format!("<p>{}</p>\n", prose(paragraph)));
    section.figures.iter().for_each(|part| text += &figure(part));
    text += &items(&section.items);
    text + "</section>\n"
}

/// Text in which names of the library stand between backticks.
fn prose(text: &str) -> String {
    let parts = text.split('`').enumerate();
    let part = |(index, part)| match index % 2 {
        0 => escaped(part),
        _ => format!("<code>{}</code>", escaped(part)),
    };
    parts.map(part).collect()
}

fn items(items: &[Item]) -> String {
    let mut text = String::from(
        "<table>\n<thead><tr><th>item</th><th>paper</th><th>ours</th><th>wanted</th><th></th></tr></thead>\n<tbody>\n",
    );
    for item in items {
        let cell = |value: &Option<String>| value.as_deref().map(escaped).unwrap_or_default();
        let note = item.note.as_ref().map(|note| format!("<div class=\"note\">{}</div>", escaped(note)));
        text += &format!(
            "<tr><td>{}{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td></tr>\n",
            escaped(&item.what),
            note.unwrap_or_default(),
            cell(&item.paper),
            cell(&item.ours),
            cell(&item.tolerance),
            badge(item.verdict)
        );
    }
    text + "</tbody>\n</table>\n"
}

fn badge(verdict: Verdict) -> String {
    let word = verdict.word().to_lowercase();
    format!("<span class=\"badge {word}\">{word}</span>")
}

fn figure(figure: &Figure) -> String {
    let panels: String = figure.panels.iter().map(panel).collect();
    format!(
        "<figure>\n<div class=\"panels\">\n{panels}</div>\n<figcaption>{}</figcaption>\n</figure>\n",
        escaped(&figure.caption)
    )
}

fn panel(panel: &Panel) -> String {
    match panel {
        Panel::Grid(picture) => grid::draw(picture),
        Panel::Bars(picture) => bars::draw(picture),
        Panel::Lines(picture) => lines::draw(picture),
        Panel::Intervals(picture) => intervals::draw(picture),
        Panel::Tree(picture) => tree::draw(picture),
    }
}
