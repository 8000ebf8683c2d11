//! Instruction set and number of threads are settings of the process: tests that change them take turns.

use std::sync::{Mutex, MutexGuard, PoisonError};

pub(crate) fn take_turn() -> MutexGuard<'static, ()> {
    static TURN: Mutex<()> = Mutex::new(());
    TURN.lock().unwrap_or_else(PoisonError::into_inner)
}
