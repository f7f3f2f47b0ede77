//! Lists of fixed capacity, filled without a panicking branch.

use heapless::{LenType, Vec};

/// A list of the first `items`, as many as fit; the rest is dropped.
#[inline]
pub(crate) fn up_to<T, const N: usize, L: LenType>(items: impl IntoIterator<Item = T>) -> Vec<T, N, L> {
    let mut list = Vec::new();
    for item in items {
        if list.push(item).is_err() {
            break;
        }
    }
    list
}
