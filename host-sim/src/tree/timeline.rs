//! A page that shows when which node was running and how it ended.

use super::instance::Instance;
use super::statuses::name;
use super::xml::escaped;
use iibt_core::time::Instant;
use iibt_core::tree::{Status, StatusChange};
use std::fmt::Write;

/// The height of a node's line, in pixels.
const LINE: usize = 18;
/// The width of the names and of the picture, in pixels.
const NAMES: usize = 360;
const WIDTH: f64 = 1000.0;

const STYLE: &str = "body{font:13px sans-serif;margin:1em;color:#222;background:#fff}svg{display:block}\
.running{fill:#e8a33d}.success{fill:#3a9a5b}.failure{fill:#c8503c}.skipped{fill:#9aa3ad}.idle{fill:#55606b}\
line{stroke:#e4e6e9}text{font-size:12px}.key span{margin-right:1.5em}.key b{display:inline-block;width:.9em;height:.9em;\
margin-right:.4em;vertical-align:-.1em}";

impl Instance {
    /// A page, complete in itself, with a line for each node: when it was running, and a mark where
    /// it ended or was halted. Times count milliseconds; nodes are named as for
    /// [`btlog`](Self::btlog).
    #[must_use]
    pub fn timeline(&self, transitions: &[StatusChange]) -> String {
        let start = transitions.first().map_or(Instant(0), |first| first.time);
        let end = transitions.last().map_or(start, |last| last.time);
        let scale = WIDTH / f64::from(end.since(start).0.max(1));
        let at = |time: Instant| NAMES as f64 + f64::from(time.since(start).0) * scale;
        let height = self.nodes.len() * LINE + 2 * LINE;
        let mut page = head(&self.main);
        _ = writeln!(
            page,
            "<svg width=\"{}\" height=\"{height}\" role=\"img\">",
            NAMES as f64 + WIDTH + 20.0
        );
        _ = writeln!(page, "<text x=\"{NAMES}\" y=\"13\">0 ms</text>");
        let total = end.since(start).0;
        _ = writeln!(page, "<text x=\"{}\" y=\"13\" text-anchor=\"end\">{total} ms</text>", at(end));
        for (index, node) in self.nodes.iter().enumerate() {
            let (x, y) = (4 + 10 * (node.level - 1), LINE + index * LINE);
            let label = escaped(node.subtree.as_deref().unwrap_or(&node.name));
            _ = writeln!(page, "<line x1=\"0\" x2=\"{}\" y1=\"{y}\" y2=\"{y}\"/>", NAMES as f64 + WIDTH);
            _ = writeln!(page, "<text x=\"{x}\" y=\"{}\">{label}</text>", y + 13);
        }
        let mut begun: Vec<Option<Instant>> = vec![None; self.nodes.len()];
        for transition in transitions {
            let Some(since) = begun.get_mut(usize::from(transition.node)) else { continue };
            let y = LINE + usize::from(transition.node) * LINE;
            if let Some(since) = since.take() {
                bar(&mut page, at(since), at(transition.time), y);
            }
            match transition.to {
                Some(Status::Running) => *since = Some(transition.time),
                ended => mark(&mut page, at(transition.time), y, ended, transition.time.since(start).0),
            }
        }
        for (index, since) in begun.iter().enumerate() {
            if let Some(since) = since {
                bar(&mut page, at(*since), at(end), LINE + index * LINE);
            }
        }
        page.push_str("</svg>\n</body></html>\n");
        page
    }
}

fn head(title: &str) -> String {
    let title = escaped(title);
    let key = ["running", "success", "failure", "skipped", "idle"].map(|status| {
        let colour = match status {
            "running" => "#e8a33d",
            "success" => "#3a9a5b",
            "failure" => "#c8503c",
            "skipped" => "#9aa3ad",
            _ => "#55606b",
        };
        let word = if status == "idle" { "halted" } else { status };
        format!("<span><b style=\"background:{colour}\"></b>{word}</span>")
    });
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>{title}</title>\n<style>{STYLE}</style></head>\n\
         <body><h1>{title}</h1>\n<p class=\"key\">{}</p>\n",
        key.concat()
    )
}

fn bar(page: &mut String, from: f64, to: f64, y: usize) {
    let (top, height) = (y + 5, LINE - 9);
    let width = (to - from).max(1.0);
    _ = writeln!(
        page,
        "<rect class=\"running\" x=\"{from:.1}\" y=\"{top}\" width=\"{width:.1}\" height=\"{height}\"/>"
    );
}

fn mark(page: &mut String, at: f64, y: usize, status: Option<Status>, time: u32) {
    let word = name(status);
    let class = word.to_lowercase();
    let (top, height) = (y + 2, LINE - 3);
    let said = if status.is_none() { "halted" } else { word };
    _ = writeln!(
        page,
        "<rect class=\"{class}\" x=\"{at:.1}\" y=\"{top}\" width=\"4\" height=\"{height}\"><title>{said} at {time} ms</title></rect>"
    );
}
