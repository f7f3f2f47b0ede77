//! A campaign's report as a table for people.

use super::{CampaignReport, CampaignRow, Comparison, Summary};
use crate::statistics::{Difference, Distribution, Share};
use crate::text::counted;

impl CampaignReport {
    /// Returns a table with a line for each disturbance and pilot, and one that compares the first
    /// two.
    #[must_use]
    pub fn table(&self) -> String {
        let mut text = format!("{}, {} each\n\n", self.scenario, counted(self.seeds, "seed"));
        text += &format!(
            "{:<11}  {:<12}  {:<24}  {:>9}  {:>8}  {:<32}  {:>8}  {:>5}\n",
            "disturbance",
            "tree",
            "accomplished",
            "together",
            "collided",
            "ticks: mean, median, 95 %",
            "messages",
            "moves"
        );
        for row in &self.rows {
            text += &row.lines();
        }
        text += "\nIntervals are 95 %: Wilson's of a ratio, Student's of a mean. Ticks, messages and moves are means over flights\n\
                 that accomplished the mission; differences are of pairs with the same seed, both of which did.\n";
        text
    }
}

impl CampaignRow {
    fn lines(&self) -> String {
        let mut text = String::new();
        for (index, summary) in self.summaries.iter().enumerate() {
            let name = if index == 0 { self.disturbance.name() } else { "" };
            text += &format!("{name:<11}  {}\n{}", summary.line(), summary.missed_line());
        }
        if let Some(comparison) = &self.comparison {
            text += &format!("{:<11}  {}\n", "", comparison.line());
        }
        text
    }
}

impl Summary {
    fn line(&self) -> String {
        format!(
            "{:<12}  {}  {:>7.1} %  {:>8}  {}  {:>8.1}  {:>5.1}",
            self.pilot.name(),
            share(&self.accomplished),
            100.0 * self.together.ratio,
            self.collided.count,
            distribution(&self.ticks),
            self.messages.mean,
            self.moves.mean
        )
    }
}

impl Summary {
    /// The seeds of the flights that did not accomplish the mission; nothing if all did.
    fn missed_line(&self) -> String {
        let (most, all) = (10, self.missed.len());
        let seeds: Vec<String> = self.missed.iter().take(most).map(u64::to_string).collect();
        let more = if all > most { format!(" and {} more", all - most) } else { String::new() };
        if all == 0 {
            String::new()
        } else {
            format!("{:<11}  not with seeds {}{more}\n", "", seeds.join(", "))
        }
    }
}

impl Comparison {
    fn line(&self) -> String {
        let percent = |difference: &Difference| Difference {
            mean: 100.0 * difference.mean,
            interval: difference.interval.map(|bound| 100.0 * bound),
            ..*difference
        };
        format!(
            "{} minus {}: accomplished {} points, together {} points, ticks {}, messages {}",
            self.pilots[0].name(),
            self.pilots[1].name(),
            difference(&percent(&self.accomplished)),
            difference(&percent(&self.together)),
            difference(&self.ticks),
            difference(&self.messages)
        )
    }
}

fn share(share: &Share) -> String {
    let [low, high] = share.interval.map(|bound| 100.0 * bound);
    format!("{:>5.1} % ({low:>5.1} to {high:>5.1})", 100.0 * share.ratio)
}

fn distribution(of: &Distribution) -> String {
    if of.count == 0 {
        return format!("{:>32}", "-");
    }
    let [low, high] = of.interval;
    format!("{:>5.1} ({low:>5.1} to {high:>5.1}) {:>4.0} {:>4.0}", of.mean, of.median, of.p95)
}

fn difference(of: &Difference) -> String {
    if of.pairs == 0 {
        return "-".to_owned();
    }
    let [low, high] = of.interval;
    let mark = if of.is_significant() { "" } else { "; not significant" };
    format!("{:+.1} ({low:+.1} to {high:+.1}{mark})", of.mean)
}
