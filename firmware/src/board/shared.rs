//! A value that the program shares with its interrupts.

use core::cell::RefCell;
use critical_section::Mutex;

/// A value that is accessed with the interrupts off; keep accesses short.
#[derive(Debug)]
pub(super) struct Shared<T>(Mutex<RefCell<T>>);

impl<T> Shared<T> {
    pub(super) const fn new(value: T) -> Self {
        Self(Mutex::new(RefCell::new(value)))
    }

    /// Calls a function with the value; `None` when this is called from within such a call, which
    /// only a fault or a panic does.
    pub(super) fn with<R>(&self, act: impl FnOnce(&mut T) -> R) -> Option<R> {
        critical_section::with(|section| {
            let mut value = self.0.borrow(section).try_borrow_mut().ok()?;
            Some(act(&mut value))
        })
    }
}

/// What comes at the start of the program. Unlike `None`, an empty slot is all zeros whatever its
/// type, so that a `static` beside it takes no flash.
#[derive(Debug)]
#[repr(u8)]
pub(super) enum Slot<T> {
    Empty,
    Full(T),
}

impl<T> Slot<T> {
    pub(super) const fn as_mut(&mut self) -> Option<&mut T> {
        match self {
            Self::Empty => None,
            Self::Full(value) => Some(value),
        }
    }
}
