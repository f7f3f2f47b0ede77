//! What teams announce whose frames have to be small.

use super::claim::Cells;
use super::obstacles::MAX_EVIDENCE;
use crate::actions::HORIZON;
use crate::team::TAG_BYTES;
use crate::team::rounds::Claim;

/// The most joint policies of a team whose frames are small.
///
/// Robots that are built for no more than this announce evidence and way-points for two cells
/// together, where others do for [`MAX_EVIDENCE`]; and each two bytes of claims of robots that are
/// left out cost one policy of the list, down to one. So the frames of a whole team fit 64 bytes,
/// as a packet of CAN-FD has them: see [`longest_packet`].
pub const SMALL_FRAME_POLICIES: usize = 8;

/// The most cells that a robot built for `policies` joint policies announces evidence about.
pub(super) const fn places(policies: usize) -> usize {
    if policies > SMALL_FRAME_POLICIES { MAX_EVIDENCE } else { 2 }
}

/// The most policies of a list beside claims of so many bytes, for robots built for `policies`.
pub(super) const fn listed(policies: usize, claims: usize) -> usize {
    if policies > SMALL_FRAME_POLICIES {
        return policies;
    }
    let left = policies.saturating_sub(claims.div_ceil(2));
    if left > 0 { left } else { 1 }
}

/// Returns the longest frame in bytes, without delimiters, of robots on maps of `W` words that are
/// built for `K` joint policies, while `left_out` of them are left out.
///
/// Epoch, sequence and round count five bytes each, as the largest numbers do. Below 2^14, 2^21 and
/// 2^14, eight bytes of that are not used.
///
/// ```
/// use iibt_core::grid::words;
/// use iibt_core::navigation::longest_packet;
///
/// const W: usize = words(8, 8);
/// assert_eq!([0, 1].map(longest_packet::<W, 8>), [64, 63]); // eight policies, and two
/// assert_eq!([2, 3, 4].map(longest_packet::<W, 8>), [72, 83, 82]); // one policy
/// assert_eq!(longest_packet::<W, 16>(0), 84);
/// ```
#[must_use]
pub const fn longest_packet<const W: usize, const K: usize>(left_out: usize) -> usize {
    const { assert!(HORIZON < 128, "a step takes one byte") }
    let cell = cell_bytes(W);
    let claims = left_out * Cells::<W>::longest(left_out);
    let header = 1 + 1 + 1 + 5 + 5; // COBS, version, sender, epoch, sequence
    let proposal = 5 + 1 + 1 + claims;
    let fact = cell + (1 + cell) + 1 + places(K) * (cell + 1);
    let answer = 1 + 4 + (1 + 1 + 2 * listed(K, claims)) + (1 + 2) + 1;
    header + proposal + fact + answer + 1 + TAG_BYTES
}

/// The most bytes of a cell's number on maps of so many words.
const fn cell_bytes(words: usize) -> usize {
    if 32 * words <= 128 { 1 } else { 2 }
}

/// The bytes of readings that take the room of one cell with its evidence: as many as that has on
/// the smallest maps.
pub(super) const READINGS_IN_PLACE: usize = cell_bytes(1) + 1;

impl<const W: usize> Cells<W> {
    /// The most bytes of one robot's claim while so many are left out.
    const fn longest(left_out: usize) -> usize {
        let exact = 3 + 4 * W;
        let most = if left_out > 2 { Self::WIRE_BYTES / left_out } else { 14 };
        if exact < most { exact } else { most }
    }
}
