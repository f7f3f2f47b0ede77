//! What inference is compared with where something is unknown: the same robots with a part of their
//! decision taken out, or with a rule in its place.

use crate::text::counted;
use iibt_core::navigation::Decider;

/// A decider to compare inference with.
///
/// ```
/// use host_sim::campaign::Ablation;
///
/// let names: Vec<&str> = Ablation::RULES.iter().map(|rule| rule.name).collect();
/// assert_eq!(names.len(), 18);
/// let rule = Ablation::find("look-on-the-way-4").expect("one of them");
/// assert!(rule.what().starts_with("the nearest robot reads first if it has at most 4 moves"));
/// ```
#[doc(alias = "baseline")]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Ablation {
    /// Its name on the command line.
    pub name: &'static str,
    /// What decides.
    pub decider: Decider,
}

impl Ablation {
    /// Inference without one of its parts, and choices that need none.
    pub const PARTS: &'static [Self] = &[
        of("no-branching", Decider::WithoutBranching),
        of("no-looking", Decider::WithoutLooking),
        of("last-reading", Decider::LastReading),
        of("staying-facts", Decider::StayingFacts),
        of("unshared", Decider::Unshared),
        of("random", Decider::Random),
        of("first", Decider::First),
        of("shortest", Decider::Shortest),
        of("matching", Decider::Matching),
    ];

    /// Rules that engineers write, with every threshold that was tried: the best of them for a
    /// mission is known in hindsight only.
    pub const RULES: &'static [Self] = &[
        of("free-space", Decider::Nearest),
        of("pessimistic", Decider::Farthest),
        of("likeliest", Decider::Likeliest),
        of("priced-2", Decider::Priced(2)),
        of("priced-4", Decider::Priced(4)),
        of("priced-8", Decider::Priced(8)),
        of("look-first", Decider::LookFirst(u8::MAX)),
        of("look-on-the-way", Decider::LookOnTheWay(u8::MAX)),
        of("look-first-1", Decider::LookFirst(1)),
        of("look-first-2", Decider::LookFirst(2)),
        of("look-first-3", Decider::LookFirst(3)),
        of("look-first-4", Decider::LookFirst(4)),
        of("look-first-6", Decider::LookFirst(6)),
        of("look-on-the-way-1", Decider::LookOnTheWay(1)),
        of("look-on-the-way-2", Decider::LookOnTheWay(2)),
        of("look-on-the-way-3", Decider::LookOnTheWay(3)),
        of("look-on-the-way-4", Decider::LookOnTheWay(4)),
        of("look-on-the-way-6", Decider::LookOnTheWay(6)),
    ];

    /// What is different, in words.
    #[must_use]
    pub fn what(&self) -> String {
        let text = match self.decider {
            Decider::Inference => "nothing",
            Decider::WithoutBranching => "what is seen on the way is worth nothing",
            Decider::WithoutLooking => "no robot is sent to look",
            Decider::LastReading => "a robot believes its last reading, and nothing else",
            Decider::StayingFacts => "a robot's first reading is a fact that stays",
            Decider::Unshared => {
                "no reading enters a joint decision, each robot only asks for another by its own"
            }
            Decider::Random => "any policy of the list",
            Decider::First => "the first policy of the list",
            Decider::Shortest => "the policy of the fewest ticks if nothing is seen",
            Decider::Matching => "the policy of the least distance to goals, walls not counted",
            Decider::Nearest => "to the nearest goals, as if all were free",
            Decider::Farthest => "to the goals of the worst world",
            Decider::Likeliest => "to the goals of the likeliest world",
            Decider::LookFirst(u8::MAX) => "the nearest robot reads first, the others stand",
            Decider::LookOnTheWay(u8::MAX) => "the nearest robot reads first, the others go on",
            Decider::Priced(times) => return format!("a doubtful cell costs {times} p / (1 - p) ticks"),
            Decider::LookFirst(moves) => return near(moves),
            Decider::LookOnTheWay(moves) => return near(moves) + ", the others go on",
        };
        text.to_owned()
    }

    /// All of them.
    pub fn all() -> impl Iterator<Item = &'static Self> {
        Self::PARTS.iter().chain(Self::RULES)
    }

    /// The one with a name.
    #[must_use]
    pub fn find(name: &str) -> Option<&'static Self> {
        Self::all().find(|ablation| ablation.name == name)
    }
}

const fn of(name: &'static str, decider: Decider) -> Ablation {
    Ablation { name, decider }
}

fn near(moves: u8) -> String {
    format!("the nearest robot reads first if it has at most {}", counted(moves, "move"))
}
