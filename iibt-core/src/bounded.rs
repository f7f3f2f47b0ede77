//! Lists of fixed capacity, filled without a panicking branch.

use heapless::Vec;

/// As many of `items` as there is room for; the rest is left out.
#[inline]
pub(crate) fn up_to<T, const N: usize>(items: impl IntoIterator<Item = T>) -> Vec<T, N> {
    let mut list = Vec::new();
    for item in items {
        if list.push(item).is_err() {
            break;
        }
    }
    list
}
