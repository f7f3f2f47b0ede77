//! Groups of factors that move together.

use super::{MAX_FACTORS, MAX_MODALITIES, Model};

impl Model<'_> {
    /// Numbers the groups in the order of their first factors: factors that are coupled in motion,
    /// or moved by the same actions, are in one.
    pub(super) const fn find_groups(&mut self) {
        let mut grouped: u32 = 0;
        let mut factor = 0;
        while factor < self.factors.len() && factor < MAX_FACTORS {
            if let Some(control) = self.control(factor)
                && control >= self.controls as usize
            {
                self.controls = control as u8 + 1;
            }
            if grouped >> factor & 1 == 0 {
                let members = self.moved_with(1 << factor);
                self.assign_group(members);
                grouped |= members;
            }
            factor += 1;
        }
    }

    const fn assign_group(&mut self, members: u32) {
        let group = self.group_count as usize;
        if group >= MAX_FACTORS {
            return;
        }
        self.members[group] = members as u16;
        let mut factor = 0;
        while factor < self.factors.len() && factor < MAX_FACTORS {
            if members >> factor & 1 == 1 {
                self.groups[factor] = self.group_count;
                if let Some(control) = self.control(factor) {
                    self.moved_by[group] |= 1 << control;
                }
            }
            factor += 1;
        }
        self.group_count += 1;
    }

    pub(super) const fn find_scopes(&mut self) {
        let mut modality = 0;
        while modality < self.modalities.len() && modality < MAX_MODALITIES {
            let factors = self.modalities[modality].factors;
            let mut at = 0;
            while at < factors.len() {
                if factors[at] < MAX_FACTORS {
                    self.scopes[modality] |= 1 << self.groups[factors[at]];
                }
                at += 1;
            }
            modality += 1;
        }
    }

    /// The factors that move together with `members`, themselves included, a bit for each.
    const fn moved_with(&self, mut members: u32) -> u32 {
        loop {
            let before = members;
            let mut first = 0;
            while first < self.factors.len() {
                let mut second = 0;
                while second < self.factors.len() {
                    let one = members >> first & 1 == 1 || members >> second & 1 == 1;
                    if one && self.move_together(first, second) {
                        members |= 1 << first | 1 << second;
                    }
                    second += 1;
                }
                first += 1;
            }
            if members == before {
                return members;
            }
        }
    }

    const fn move_together(&self, first: usize, second: usize) -> bool {
        let shared = match (self.control(first), self.control(second)) {
            (Some(one), Some(other)) => one == other,
            _ => false,
        };
        shared || (first < self.factors.len() && contains(self.factors[first].coupled_to, second))
    }
}

pub(super) const fn contains(list: &[usize], wanted: usize) -> bool {
    let mut at = 0;
    while at < list.len() {
        if list[at] == wanted {
            return true;
        }
        at += 1;
    }
    false
}
