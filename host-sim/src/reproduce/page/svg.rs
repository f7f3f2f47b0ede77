//! A drawing in SVG, built up element by element.

use maud::{Markup, PreEscaped, Render, html};
use std::fmt::Display;

/// A drawing of a certain size, in pixels.
pub(super) struct Svg {
    width: f64,
    height: f64,
    body: String,
}

/// The anchor of a text.
#[derive(Clone, Copy)]
pub(super) enum Anchor {
    Start,
    Middle,
    End,
}

/// A length or a place, to a tenth of a pixel.
struct Pixels(f64);

impl Render for Pixels {
    fn render_to(&self, to: &mut String) {
        format_args!("{:.1}", self.0).render_to(to);
    }
}

impl Svg {
    pub(super) const fn new(width: f64, height: f64) -> Self {
        Self { width, height, body: String::new() }
    }

    pub(super) fn line(&mut self, class: &str, from: (f64, f64), to: (f64, f64)) {
        let [x1, y1, x2, y2] = [from.0, from.1, to.0, to.1].map(Pixels);
        self.add(html! { line class=(class) x1=(x1) y1=(y1) x2=(x2) y2=(y2) {} });
    }

    pub(super) fn rectangle(
        &mut self,
        class: &str,
        (x, y): (f64, f64),
        (width, height): (f64, f64),
        round: f64,
    ) {
        let [x, y, width, height, round] = [x, y, width.max(0.0), height, round].map(Pixels);
        self.add(html! { rect class=(class) x=(x) y=(y) width=(width) height=(height) rx=(round) {} });
    }

    pub(super) fn circle(&mut self, class: &str, (x, y): (f64, f64), radius: f64) {
        let [x, y, radius] = [x, y, radius].map(Pixels);
        self.add(html! { circle class=(class) cx=(x) cy=(y) r=(radius) {} });
    }

    pub(super) fn polyline(&mut self, class: &str, points: &[(f64, f64)]) {
        self.add(html! { polyline class=(class) points=(listed(points)) {} });
    }

    pub(super) fn polygon(&mut self, class: &str, points: &[(f64, f64)]) {
        self.add(html! { polygon class=(class) points=(listed(points)) {} });
    }

    pub(super) fn text(&mut self, class: &str, (x, y): (f64, f64), anchor: Anchor, text: impl Display) {
        let anchor = match anchor {
            Anchor::Start => "start",
            Anchor::Middle => "middle",
            Anchor::End => "end",
        };
        let [x, y] = [x, y].map(Pixels);
        self.add(html! { text class=(class) x=(x) y=(y) text-anchor=(anchor) { (text.to_string()) } });
    }

    fn add(&mut self, element: Markup) {
        self.body += &element.into_string();
        self.body.push('\n');
    }

    /// The drawing, below its title.
    pub(super) fn finish(self, title: &str) -> Markup {
        let (width, height) = (self.width.round(), self.height.round());
        html! {
            div.panel {
                h3 { (title) }
                svg role="img" aria-label=(title) width=(width) height=(height)
                    viewBox={ "0 0 " (width) " " (height) } { (PreEscaped(self.body)) }
            }
        }
    }
}

fn listed(points: &[(f64, f64)]) -> String {
    points.iter().map(|(x, y)| format!("{x:.1},{y:.1}")).collect::<Vec<_>>().join(" ")
}

/// The approximate width of a text in small letters.
pub(super) fn width_of(text: &str) -> f64 {
    7.0 * text.chars().count() as f64
}

/// The number of colours besides the paper's grey.
const COLOURS: usize = 7;

/// The class of a colour: 0 is the paper's, from 1 on are ours, a robot or series each.
pub(super) fn colour(index: usize) -> String {
    match index.checked_sub(1) {
        None => "c0".to_owned(),
        Some(ours) => format!("c{}", ours % COLOURS + 1),
    }
}
