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
use maud::{DOCTYPE, Markup, PreEscaped, html};

const STYLE: &str = include_str!("page/style.css");

/// The page of these sections.
#[must_use]
pub fn page(sections: &[Section]) -> String {
    html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                link rel="icon" href="data:,";
                title { "The paper, reproduced" }
                style { (PreEscaped(STYLE)) }
            }
            body {
                nav { @for section in sections { (link(section)) } }
                main {
                    (header(sections))
                    @for part in sections { (section(part)) }
                }
            }
        }
        "\n"
    }
    .into_string()
}

/// The way to a section, marked where something in it misses.
fn link(section: &Section) -> Markup {
    let misses = section.items.iter().any(|item| item.verdict == Verdict::Misses);
    html! { a class=[misses.then_some("misses")] href={ "#s" (section.id) } { (section.id) } "\n" }
}

fn header(sections: &[Section]) -> Markup {
    html! {
        header {
            h1 { "The paper, reproduced" }
            p {
                "Bridging Probabilistic Inference and Behavior Trees: An Interactive Framework for Adaptive "
                "Multi-Robot Cooperation (arXiv 2512.04404). Every number in the column " em { "ours" }
                " was computed when this page was made."
            }
            p.tally { (tally(sections)) }
            (legend())
        }
    }
}

/// The meaning of each verdict.
fn legend() -> Markup {
    let meanings = [
        (Verdict::Agrees, "as in the paper, within the tolerance"),
        (Verdict::Holds, "as claimed, where the paper has no such number"),
        (Verdict::Differs, "otherwise than in the paper, for the reason given"),
        (Verdict::Unknown, "the paper does not say enough to compare"),
        (Verdict::Measured, "compared with nothing"),
        (Verdict::Misses, "short of what is wanted"),
    ];
    html! { p.legend { @for (verdict, meaning) in meanings { span { (badge(verdict)) " " (meaning) } "\n" } } }
}

fn section(section: &Section) -> Markup {
    html! {
        section id={ "s" (section.id) } {
            h2 { small { (section.id) } " " (section.title) }
            @for paragraph in &section.text { p { (prose(paragraph)) } }
            @for part in &section.figures { (figure(part)) }
            (items(&section.items))
        }
    }
}

/// Text in which names of the library stand between backticks.
fn prose(text: &str) -> Markup {
    html! {
        @for (index, part) in text.split('`').enumerate() {
            @if index % 2 == 0 { (part) } @else { code { (part) } }
        }
    }
}

fn items(items: &[Item]) -> Markup {
    html! {
        table {
            thead { tr { @for name in ["item", "paper", "ours", "wanted", ""] { th { (name) } } } }
            tbody { @for item in items { (row(item)) "\n" } }
        }
    }
}

fn row(item: &Item) -> Markup {
    html! {
        tr {
            td { (item.what) @if let Some(note) = &item.note { div.note { (note) } } }
            @for value in [&item.paper, &item.ours, &item.tolerance] { td { (value.as_deref().unwrap_or_default()) } }
            td { (badge(item.verdict)) }
        }
    }
}

fn badge(verdict: Verdict) -> Markup {
    let word = verdict.word().to_lowercase();
    html! { span.badge.(word) { (word) } }
}

fn figure(figure: &Figure) -> Markup {
    html! {
        figure {
            div.panels { @for picture in &figure.panels { (panel(picture)) } }
            figcaption { (figure.caption) }
        }
    }
}

fn panel(panel: &Panel) -> Markup {
    match panel {
        Panel::Grid(picture) => grid::draw(picture),
        Panel::Bars(picture) => bars::draw(picture),
        Panel::Lines(picture) => lines::draw(picture),
        Panel::Intervals(picture) => intervals::draw(picture),
        Panel::Tree(picture) => tree::draw(picture),
    }
}
