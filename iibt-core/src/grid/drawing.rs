//! Maps as drawings in text: `.` for a free cell; `#`, `@` or `T` for a blocked one.
//!
//! `@` and `T` are how the MovingAI benchmark maps draw obstacles.

use super::{Cell, Map, MapError};

/// The reason why a drawing is not a map. Lines and columns count from one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum DrawingError {
    /// The drawing is empty or has more cells than the map's type holds.
    #[error(transparent)]
    Size(MapError),
    /// A character other than `.`, `#`, `@` or `T`.
    #[error("line {line}, column {column}: a cell is '.' (free) or '#', '@', 'T' (blocked)")]
    Unknown {
        /// The line of the drawing.
        line: u32,
        /// The byte in that line.
        column: u32,
    },
    /// This line is longer or shorter than the first one.
    #[error("line {line}, column {column}: the line is not as long as the first one")]
    Ragged {
        /// The line of the drawing.
        line: u32,
        /// The first column that is missing or too many.
        column: u32,
    },
}

impl<const W: usize> Map<W> {
    /// The map that a drawing shows: one line per row, all equally long; a line feed after the last
    /// row is optional. Meant for a `const`, where a wrong drawing stops the build.
    ///
    /// # Errors
    /// [`DrawingError`]: the first fault in reading order, else whether there is a cell and all fit
    /// `W` words.
    ///
    /// ```
    /// use iibt_core::grid::{Cell, Map, words};
    ///
    /// const YARD: Map<{ words(4, 3) }> = match Map::drawn(concat!(
    ///     "..#.\n",
    ///     "..#.\n",
    ///     "....\n",
    /// )) {
    ///     Ok(map) => map,
    ///     Err(_) => panic!("the yard is drawn wrongly"),
    /// };
    /// assert!(!YARD.is_free(Cell(2)) && YARD.is_free(Cell(10)));
    /// ```
    pub const fn drawn(drawing: &str) -> Result<Self, DrawingError> {
        let signs = drawing.as_bytes();
        let width = first_line(signs);
        let pitch = width.saturating_add(1); // with the line feed
        if let Err(error) = check(signs, width) {
            return Err(error);
        }
        let height = signs.len().div_ceil(pitch);
        if width > u16::MAX as usize || height > u16::MAX as usize {
            return Err(DrawingError::Size(MapError::TooLarge));
        }
        let mut map = match Self::new(width as u16, height as u16) {
            Ok(map) => map,
            Err(error) => return Err(DrawingError::Size(error)),
        };
        let mut at = 0;
        while at < signs.len() {
            if is_blocked(signs[at]) {
                map.block(Cell((at - at / pitch) as u16)); // one line feed per row above
            }
            at += 1;
        }
        Ok(map)
    }
}

/// The length of the first line.
const fn first_line(signs: &[u8]) -> usize {
    let mut width = 0;
    while width < signs.len() && signs[width] != b'\n' {
        width += 1;
    }
    width
}

/// Whether every line is `width` known signs long.
const fn check(signs: &[u8], width: usize) -> Result<(), DrawingError> {
    let pitch = width.saturating_add(1);
    let mut at = 0;
    while at <= signs.len() {
        let (line, column) = ((at / pitch + 1) as u32, (at % pitch + 1) as u32);
        let ends = at % pitch == width;
        match if at < signs.len() { signs[at] } else { b'\n' } {
            b'\n' if ends || at == signs.len() && column == 1 => {}
            b'.' | b'#' | b'@' | b'T' if !ends => {}
            b'\n' | b'.' | b'#' | b'@' | b'T' => return Err(DrawingError::Ragged { line, column }),
            _ => return Err(DrawingError::Unknown { line, column }),
        }
        at += 1;
    }
    Ok(())
}

const fn is_blocked(sign: u8) -> bool {
    matches!(sign, b'#' | b'@' | b'T')
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::string::ToString;
    use std::vec::Vec;

    fn blocked(drawing: &str) -> (u16, u16, Vec<u16>) {
        let map = Map::<2>::drawn(drawing).unwrap();
        let blocked = (0..map.len() as u16).filter(|&cell| !map.is_free(Cell(cell)));
        (map.width(), map.height(), blocked.collect())
    }

    fn fault(drawing: &str) -> DrawingError {
        Map::<1>::drawn(drawing).unwrap_err()
    }

    #[test]
    fn reads_every_sign_in_rows() {
        assert_eq!(blocked("..#\n@.T\n"), (3, 2, std::vec![2, 3, 5]));
        assert_eq!(blocked("..#\n@.T"), (3, 2, std::vec![2, 3, 5]));
        assert_eq!(blocked("."), (1, 1, std::vec![]));
        assert_eq!(blocked("#\n#"), (1, 2, std::vec![0, 1]));
    }

    #[test]
    fn names_the_place_of_an_unknown_sign() {
        assert_eq!(fault("...\n.x."), DrawingError::Unknown { line: 2, column: 2 });
        assert_eq!(fault("...\r\n..."), DrawingError::Unknown { line: 1, column: 4 });
        let text = fault("...\n.x.").to_string();
        assert_eq!(text, "line 2, column 2: a cell is '.' (free) or '#', '@', 'T' (blocked)");
    }

    #[test]
    fn names_the_line_that_is_too_short_or_too_long() {
        assert_eq!(fault("...\n..\n..."), DrawingError::Ragged { line: 2, column: 3 });
        assert_eq!(fault("...\n....\n..."), DrawingError::Ragged { line: 2, column: 4 });
        assert_eq!(fault("...\n.."), DrawingError::Ragged { line: 2, column: 3 });
        assert_eq!(fault("...\n...\n\n"), DrawingError::Ragged { line: 3, column: 1 });
    }

    #[test]
    fn refuses_sizes_the_type_cannot_hold() {
        assert_eq!(fault(""), DrawingError::Size(MapError::Empty));
        assert_eq!(fault("\n"), DrawingError::Size(MapError::Empty));
        assert_eq!(fault(&".".repeat(33)), DrawingError::Size(MapError::TooLarge));
        assert_eq!(fault(&".".repeat(70_000)), DrawingError::Size(MapError::TooLarge));
    }
}
