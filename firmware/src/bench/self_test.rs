//! A self-test: fixed vectors of everything that robots must compute alike, with a hash of all bits
//! that come out. They are the same on every chip and on the host.

mod frames;
mod models;
mod plans;
mod trees;

use core::fmt;
use iibt_core::team::Fnv1a;

/// What a vector computes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Area {
    /// Beliefs after an observation, exactly and by coordinate ascent.
    Beliefs,
    /// Variational and expected free energies, term by term, and posteriors.
    FreeEnergies,
    /// Statuses, times and calls of leaves of a tree that is ticked.
    Trees,
    /// Frames with their tags, and what is read from damaged ones.
    Frames,
    /// Joint plans, and decisions among them.
    Plans,
}

/// A vector with its result.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Vector {
    /// What it computes.
    pub area: Area,
    /// Its number in the area, which its inputs follow from.
    pub number: u32,
    /// A hash of all bits that came out.
    pub bits: u64,
}

impl fmt::Display for Vector {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let area = match self.area {
            Area::Beliefs => "beliefs",
            Area::FreeEnergies => "free energies",
            Area::Trees => "tree",
            Area::Frames => "frame",
            Area::Plans => "plan",
        };
        write!(f, "{area} {}: {:016x}", self.number, self.bits)
    }
}

/// Computes all vectors, one after the other, and tells each.
///
/// It takes some 10 KB of stack and 100 million instructions of a Cortex-M4F.
///
/// ```
/// use firmware::bench::self_test::{self, Area};
///
/// let mut plans = 0;
/// self_test::run(&mut |vector| plans += usize::from(vector.area == Area::Plans));
/// assert_eq!(plans, 240);
/// ```
pub fn run(tell: &mut dyn FnMut(Vector)) {
    models::run(tell);
    trees::run(tell);
    frames::run(tell);
    plans::run(tell);
}

/// The hash of everything that comes out of a vector.
#[derive(Clone, Copy, Debug)]
struct Bits(Fnv1a);

impl Bits {
    const NONE: Self = Self(Fnv1a::EMPTY);

    fn add_bytes(&mut self, bytes: &[u8]) {
        self.0 = self.0.write(bytes);
    }

    fn add(&mut self, word: u32) {
        self.add_bytes(&word.to_le_bytes());
    }

    fn add_numbers(&mut self, numbers: &[f32]) {
        numbers.iter().for_each(|number| self.add(number.to_bits()));
    }

    fn of(self, area: Area, number: u32) -> Vector {
        Vector { area, number, bits: self.0.finish() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;
    use std::vec::Vec;

    #[test]
    fn no_two_vectors_of_an_area_are_alike() {
        let mut vectors = Vec::new();
        run(&mut |vector| vectors.push(vector));
        for area in [Area::Beliefs, Area::FreeEnergies, Area::Trees, Area::Frames, Area::Plans] {
            let of_area = || vectors.iter().filter(|vector| vector.area == area);
            let different: HashSet<u64> = of_area().map(|vector| vector.bits).collect();
            // Some problems of the planner have no plan.
            assert!(different.len() >= of_area().count() * 3 / 4 && different.len() > 30, "{area:?}");
        }
    }
}
