//! A campaign's report as a table for people.

use super::{Ablation, CampaignReport, CampaignRow, Comparison, Summary};
use crate::statistics::{Difference, Distribution, Share};
use crate::team::Pilot;
use crate::text::counted;

impl CampaignReport {
    /// Returns a table for each disturbance with a line for each decider: what it takes, and how
    /// much more than inference does. The best rule is named at the end of each.
    #[must_use]
    pub fn ablation_table(&self) -> String {
        let mut text = format!("{}, {} each\n", self.scenario, counted(self.seeds, "seed"));
        for row in &self.rows {
            text += &row.ablations();
        }
        text += "\nTicks are those until the last robot is where it ends; p95 is their 95th percentile. Intervals are\n\
                 95 %: Wilson's of a ratio, Student's of a mean. Differences are of pairs with the same seed, both of which accomplished the mission.\n";
        text
    }

    /// Returns a table with a line for each disturbance and pilot, and one that compares the first
    /// with each of the others.
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
            "ticks: mean, median, p95",
            "messages",
            "moves"
        );
        for row in &self.rows {
            text += &row.lines();
        }
        text += "\nIntervals are 95 %: Wilson's of a ratio, Student's of a mean; p95 is the 95th percentile. Ticks, messages and moves are means over flights\n\
                 that accomplished the mission; differences are of pairs with the same seed, both of which did.\n";
        text
    }
}

impl CampaignRow {
    /// A line for each decider; those of the rules, and which of them is the best.
    fn ablations(&self) -> String {
        let mut text = format!(
            "\n{:<17}  {:<24}  {:<32}  {:>5}  {}\n",
            format!("disturbance {}", self.disturbance.name()),
            "accomplished",
            "ticks: mean, median, p95",
            "worst",
            "more than inference"
        );
        let first = self.summaries.first().into_iter().map(|summary| (summary, None));
        let others = self.summaries.iter().skip(1).zip(self.comparisons.iter().map(Some));
        for (summary, comparison) in first.chain(others) {
            // A comparison is that of inference minus the other.
            let more = comparison.map_or_else(String::new, |comparison| {
                let [low, high] = comparison.ticks.interval;
                difference(&Difference {
                    mean: 0.0 - comparison.ticks.mean,
                    interval: [0.0 - high, 0.0 - low],
                    ..comparison.ticks
                })
            });
            text += &format!(
                "{:<17}  {}  {}  {:>5}  {more}\n",
                summary.pilot.name(),
                share(&summary.accomplished),
                distribution(&summary.ticks),
                of_some(&summary.ticks, format!("{:.0}", summary.ticks.most))
            );
        }
        if let Some(best) = self.best_rule() {
            text += &format!("the best rule in hindsight: {best}\n");
        }
        text
    }

    /// The rule that accomplishes the most missions, and of those that accomplish as many the one
    /// with the fewest ticks.
    fn best_rule(&self) -> Option<&'static str> {
        let is_rule = |summary: &&Summary| match summary.pilot {
            Pilot::Ablated(ablation) => Ablation::RULES.contains(ablation),
            _ => false,
        };
        let better = |one: &&Summary, other: &&Summary| {
            let done = one.accomplished.count.cmp(&other.accomplished.count).reverse();
            done.then(one.ticks.mean.total_cmp(&other.ticks.mean))
        };
        self.summaries.iter().filter(is_rule).min_by(better).map(|summary| summary.pilot.name())
    }

    fn lines(&self) -> String {
        let mut text = String::new();
        for (index, summary) in self.summaries.iter().enumerate() {
            let name = if index == 0 { self.disturbance.name() } else { "" };
            text += &format!("{name:<11}  {}\n{}", summary.line(), summary.missed_line());
        }
        for comparison in &self.comparisons {
            text += &format!("{:<11}  {}\n", "", comparison.line());
        }
        text
    }
}

impl Summary {
    fn line(&self) -> String {
        format!(
            "{:<12}  {}  {:>7.1} %  {:>8}  {}  {:>8}  {:>5}",
            self.pilot.name(),
            share(&self.accomplished),
            100.0 * self.together.ratio,
            self.collided.count,
            distribution(&self.ticks),
            of_some(&self.messages, format!("{:.1}", self.messages.mean)),
            of_some(&self.moves, format!("{:.1}", self.moves.mean))
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

/// A statistic as it is written, if it is one of any flights.
fn of_some(of: &Distribution, text: String) -> String {
    if of.count == 0 { "-".to_owned() } else { text }
}

fn distribution(of: &Distribution) -> String {
    if of.count == 0 {
        return format!("{:>32}", "-");
    }
    let [low, high] = of.interval;
    let interval = if of.count > 1 { format!("({low:>5.1} to {high:>5.1})") } else { String::new() };
    format!("{:>5.1} {interval:>16} {:>4.0} {:>4.0}", of.mean, of.median, of.p95)
}

fn difference(of: &Difference) -> String {
    match of.pairs {
        0 => return "-".to_owned(),
        1 => return format!("{:+.1}", of.mean),
        _ => {}
    }
    let [low, high] = of.interval;
    let mark = if of.is_significant() { "" } else { "; not significant" };
    format!("{:+.1} ({low:+.1} to {high:+.1}{mark})", of.mean)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::campaign::{Disturbance, Score, Violations};
    use crate::verdict::Outcome;

    fn score(ticks: Option<u32>) -> Score {
        let (outcome, accomplished) = (Outcome::Unfinished, ticks.is_some());
        let (ticks, faults) = (ticks.unwrap_or(200), Violations::default());
        Score {
            seed: 0,
            outcome,
            accomplished,
            together: false,
            ticks,
            reported: ticks,
            spread: 0,
            faults,
            bumps: 0,
            messages: 5,
            moves: 5,
            in_place: 0,
        }
    }

    /// A report of inference and a rule that took these ticks, `None` for a flight that failed.
    fn report(inference: &[Option<u32>], rule: &[Option<u32>]) -> CampaignReport {
        let pilots = [Pilot::Inference, Pilot::Ablated(&Ablation::RULES[0])];
        let [first, second] =
            [inference, rule].map(|ticks| ticks.iter().copied().map(score).collect::<Vec<_>>());
        let row = CampaignRow {
            disturbance: Disturbance::None,
            summaries: vec![Summary::of(pilots[0], &first), Summary::of(pilots[1], &second)],
            comparisons: vec![Comparison::of(pilots, &first, &second)],
        };
        CampaignReport { scenario: "t".to_owned(), seeds: first.len() as u32, rows: vec![row] }
    }

    /// The line of the rule.
    fn rule(report: &CampaignReport) -> String {
        let text = report.ablation_table();
        let line = text.lines().find(|line| line.starts_with("free-space"));
        line.expect("it was flown").split_whitespace().collect::<Vec<_>>().join(" ")
    }

    #[test]
    fn there_is_no_interval_of_a_single_flight_or_pair() {
        let one = report(&[Some(10)], &[Some(13)]);
        assert_eq!(rule(&one), "free-space 100.0 % ( 20.7 to 100.0) 13.0 13 13 13 +3.0");
        assert!(one.table().contains("inference minus free-space: accomplished +0.0 points, "));
        let two = report(&[Some(10), Some(12)], &[Some(13), Some(15)]);
        let line = rule(&two);
        assert!(line.contains("14.0 ( 1.3 to 26.7) 14 15 15 +3.0 (+3.0 to +3.0)"), "{line}");
    }

    #[test]
    fn there_are_no_numbers_of_flights_that_failed() {
        let none = report(&[Some(10), Some(12)], &[None, None]);
        assert_eq!(rule(&none), "free-space 0.0 % ( 0.0 to 65.8) - - -");
        let table = none.table();
        let line = table.lines().find(|line| line.contains("free-space  ")).expect("it was flown");
        assert!(line.trim_end().ends_with("-         -      -"), "{line}");
    }
}
