//! A battery gauge by the voltage of the battery.

use crate::hardware::Battery;

/// An analogue-to-digital converter of the battery's voltage.
pub trait Samples {
    /// Returns the latest sample. It does not wait for a new one.
    fn sample(&mut self) -> u16;
}

/// The samples of an empty and of a full battery, in the unit of the converter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct VoltageRange {
    /// At 0 %.
    pub empty: u16,
    /// At 100 %.
    pub full: u16,
}

impl VoltageRange {
    /// Returns the charge at a sample in percent, on a straight line between empty and full.
    ///
    /// Below half of an empty battery's voltage there is none, as on a robot that hangs on a cable:
    /// that counts as full.
    ///
    /// ```
    /// use firmware::adapters::VoltageRange;
    ///
    /// let cell = VoltageRange { empty: 3300, full: 4200 }; // in millivolts
    /// assert_eq!([3200, 3300, 3750, 4300].map(|mv| cell.charge(mv)), [0, 0, 50, 100]);
    /// assert_eq!(cell.charge(20), 100); // no battery
    /// ```
    #[must_use]
    pub fn charge(self, sample: u16) -> u8 {
        if sample < self.empty / 2 {
            return 100;
        }
        let above = u32::from(sample.saturating_sub(self.empty));
        let range = u32::from(self.full.saturating_sub(self.empty));
        (100 * above).checked_div(range).map_or(100, |percent| percent.min(100) as u8)
    }
}

/// A [`Battery`] whose charge is read off its voltage.
///
/// The voltage sags while motors run, so choose the thresholds of a robot with a margin.
#[derive(Debug)]
pub struct VoltageGauge<C> {
    converter: C,
    range: VoltageRange,
}

impl<C> VoltageGauge<C> {
    /// Creates a gauge from a converter and the range of its samples.
    pub const fn new(converter: C, range: VoltageRange) -> Self {
        Self { converter, range }
    }
}

impl<C: Samples> Battery for VoltageGauge<C> {
    fn charge(&mut self) -> u8 {
        self.range.charge(self.converter.sample())
    }
}
