//! What inference is compared with where something is unknown: the same robots with a part of their
//! decision taken out, or with a rule in its place.

use iibt_core::navigation::Decider;

/// A decider to compare inference with.
///
/// ```
/// use host_sim::campaign::Ablation;
///
/// let names: Vec<&str> = Ablation::RULES.iter().map(|rule| rule.name).collect();
/// assert_eq!(names.len(), 18);
/// let rule = Ablation::find("look-on-the-way-4").expect("one of them");
/// assert!(rule.what.starts_with("the nearest robot reads first if it has at most 4 moves"));
/// ```
#[doc(alias = "baseline")]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Ablation {
    /// Its name on the command line.
    pub name: &'static str,
    /// What is different, in words.
    pub what: &'static str,
    /// What decides.
    pub decider: Decider,
}

impl Ablation {
    /// Inference without one of its parts, and choices that need none.
    pub const PARTS: &'static [Self] = &[
        of("no-branching", "what is seen on the way is worth nothing", Decider::WithoutBranching),
        of("no-looking", "no robot is sent to look", Decider::WithoutLooking),
        of("last-reading", "a robot believes its last reading, and nothing else", Decider::LastReading),
        of("staying-facts", "a robot's first reading is a fact that stays", Decider::StayingFacts),
        of("unshared", "robots keep what they have read to themselves", Decider::Unshared),
        of("random", "any policy of the list", Decider::Random),
        of("first", "the first policy of the list", Decider::First),
        of("shortest", "the policy of the fewest ticks if nothing is seen", Decider::Shortest),
        of("matching", "the policy of the least distance to goals, walls not counted", Decider::Matching),
    ];

    /// Rules that engineers write, with every threshold that was tried: the best of them for a
    /// mission is known in hindsight only.
    pub const RULES: &'static [Self] = &[
        of("free-space", "to the nearest goals, as if all were free", Decider::Nearest),
        of("pessimistic", "to the goals of the worst world", Decider::Farthest),
        of("likeliest", "to the goals of the likeliest world", Decider::Likeliest),
        of("priced-2", "a doubtful cell costs 2 p / (1 - p) ticks", Decider::Priced(2)),
        of("priced-4", "a doubtful cell costs 4 p / (1 - p) ticks", Decider::Priced(4)),
        of("priced-8", "a doubtful cell costs 8 p / (1 - p) ticks", Decider::Priced(8)),
        of("look-first", "the nearest robot reads first, the others stand", Decider::LookFirst(u8::MAX)),
        of(
            "look-on-the-way",
            "the nearest robot reads first, the others go on",
            Decider::LookOnTheWay(u8::MAX),
        ),
        of("look-first-1", "the nearest robot reads first if it has at most 1 move", Decider::LookFirst(1)),
        of("look-first-2", "the nearest robot reads first if it has at most 2 moves", Decider::LookFirst(2)),
        of("look-first-3", "the nearest robot reads first if it has at most 3 moves", Decider::LookFirst(3)),
        of("look-first-4", "the nearest robot reads first if it has at most 4 moves", Decider::LookFirst(4)),
        of("look-first-6", "the nearest robot reads first if it has at most 6 moves", Decider::LookFirst(6)),
        of(
            "look-on-the-way-1",
            "the nearest robot reads first if it has at most 1 move, the others go on",
            Decider::LookOnTheWay(1),
        ),
        of(
            "look-on-the-way-2",
            "the nearest robot reads first if it has at most 2 moves, the others go on",
            Decider::LookOnTheWay(2),
        ),
        of(
            "look-on-the-way-3",
            "the nearest robot reads first if it has at most 3 moves, the others go on",
            Decider::LookOnTheWay(3),
        ),
        of(
            "look-on-the-way-4",
            "the nearest robot reads first if it has at most 4 moves, the others go on",
            Decider::LookOnTheWay(4),
        ),
        of(
            "look-on-the-way-6",
            "the nearest robot reads first if it has at most 6 moves, the others go on",
            Decider::LookOnTheWay(6),
        ),
    ];

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

const fn of(name: &'static str, what: &'static str, decider: Decider) -> Ablation {
    Ablation { name, what, decider }
}
