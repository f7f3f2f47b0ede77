//! Frames of random messages: their bytes, and what is read from them and from damaged ones.

use super::{Area, Bits, Vector};
use crate::bench::random_model::Chance;
use heapless::Vec;
use iibt_core::team::{
    Context, Deframer, Envelope, Key, Keys, MAX_FRAME, Message, RobotId, SipHash64, Stamp, decode, encode,
};
use serde::{Deserialize, Serialize};

/// The frames.
const FRAMES: u32 = 32;

/// A message with the kinds of values that robots announce.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Announced {
    number: u32,
    values: Vec<f32, 8>,
    cells: Vec<u16, 8>,
    is_done: bool,
}

impl Message for Announced {
    const SCHEMA: &'static str = "self-test: number u32, values [f32; 0..8], cells [u16; 0..8], is done bool";
    const MAX_BYTES: usize = 5 + (1 + 8 * 4) + (1 + 8 * 3) + 1;
}

impl Announced {
    fn random(chance: &mut Chance) -> Self {
        Self {
            number: chance.bits() >> chance.below(32),
            values: (0..chance.below(9)).map(|_| chance.weight()).collect(),
            cells: (0..chance.below(9)).map(|_| (chance.bits() >> (16 + chance.below(16))) as u16).collect(),
            is_done: chance.below(2) == 0,
        }
    }
}

pub(super) fn run(tell: &mut dyn FnMut(Vector)) {
    for number in 0..FRAMES {
        let mut bits = Bits::NONE;
        // A message that takes no frame leaves the hash of nothing.
        let _ = add_frame(number, &mut bits);
        tell(bits.of(Area::Frames, number));
    }
}

#[inline(never)]
fn add_frame(number: u32, bits: &mut Bits) -> Option<()> {
    let chance = &mut Chance::new(u64::from(number));
    let auth = SipHash64::with(Keys::of_team(&Key::new(*b"vectors of tests"), number, number / 2));
    let context = Context::of::<Announced>(number, u64::from(chance.bits()));
    let stamp =
        Stamp { epoch: chance.bits() >> chance.below(32), sequence: chance.bits() >> chance.below(32) };
    let message = Announced::random(chance);
    let envelope = Envelope { sender: RobotId(chance.below(8) as u8), stamp, message };
    let mut buffer = [0; MAX_FRAME];
    let frame = encode(&envelope, &auth, context, &mut buffer).ok()?;
    bits.add_bytes(frame);

    let read = |frame: &[u8]| decode::<Announced>(frame, &auth, context).ok();
    let inside = frame.get(1..frame.len() - 1)?;
    bits.add(u32::from(read(inside).as_ref() == Some(&envelope)));
    for cut in 0..inside.len() {
        bits.add(u32::from(read(inside.get(..cut)?).is_some()));
    }
    let mut deframer = Deframer::new();
    for at in 0..8 * frame.len() {
        let (flipped, bit) = (at / 8, at % 8);
        for (place, byte) in frame.iter().enumerate() {
            let byte = byte ^ if place == flipped { 1 << bit } else { 0 };
            if let Some(received) = deframer.feed(byte) {
                bits.add(received.len() as u32);
                bits.add(u32::from(read(received).is_some()));
            }
        }
    }
    Some(())
}
