//! Values out of the bytes of a frame, straight into their places: a list that serde hands on is
//! copied several times on the way.

use heapless::{LenType, Vec};
use serde::Deserialize;

/// Takes a value from the front of `bytes`; `None` if there is none.
#[inline]
pub(crate) fn value<'b, T: Deserialize<'b>>(bytes: &mut &'b [u8]) -> Option<T> {
    let (value, rest) = postcard::take_from_bytes(bytes).ok()?;
    *bytes = rest;
    Some(value)
}

/// Takes a list from the front of `bytes`, in the place of another; `None` if there is none, or one
/// too long.
#[inline]
pub(crate) fn list<'b, T, L, const N: usize>(to: &mut Vec<T, N, L>, bytes: &mut &'b [u8]) -> Option<()>
where
    T: Deserialize<'b>,
    L: LenType,
{
    let count = value(bytes)?;
    items(to, count, bytes)
}

/// Takes so many items from the front of `bytes`, in the place of those of a list; `None` if there
/// are fewer, or the list has less room.
#[inline]
pub(crate) fn items<'b, T, L, const N: usize>(
    to: &mut Vec<T, N, L>,
    count: u32,
    bytes: &mut &'b [u8],
) -> Option<()>
where
    T: Deserialize<'b>,
    L: LenType,
{
    to.clear();
    for _ in 0..count {
        to.push(value(bytes)?).ok()?;
    }
    Some(())
}
