//! Parts of a flat list of beliefs.

use crate::inference::shape::MAX_CONDITIONS;

/// A few slices of a flat list.
pub(in crate::inference) struct Parts<'b> {
    count: usize,
    parts: [&'b [f32]; MAX_CONDITIONS],
}

impl<'b> Parts<'b> {
    #[inline]
    pub(in crate::inference) fn new(parts: impl Iterator<Item = &'b [f32]>) -> Self {
        let mut new = Self { count: 0, parts: [&[]; MAX_CONDITIONS] };
        for (slot, part) in new.parts.iter_mut().zip(parts) {
            *slot = part;
            new.count += 1;
        }
        new
    }

    #[inline]
    pub(in crate::inference) fn as_slice(&self) -> &[&'b [f32]] {
        self.parts.get(..self.count).unwrap_or(&[])
    }
}
