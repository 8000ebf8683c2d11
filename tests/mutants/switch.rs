//! Which mutant lives: by the environment, or by who sets it. This file is no part of the crate.
#![allow(missing_docs, unsafe_code)]

use std::sync::atomic::{AtomicBool, AtomicU32, Ordering::Relaxed};

static LIVES: AtomicU32 = AtomicU32::new(u32::MAX);
static REACHED: [AtomicBool; 1024] = [const { AtomicBool::new(false) }; 1024];

/// Whether this mutant lives; it is noted that somebody asked.
#[inline]
pub fn is(number: u32) -> bool {
    REACHED[number as usize].store(true, Relaxed);
    let lives = LIVES.load(Relaxed);
    if lives == u32::MAX { told() == number } else { lives == number }
}

#[cold]
fn told() -> u32 {
    let told = std::env::var("POLHODE_MUTANT").ok().and_then(|word| word.parse().ok());
    polhode_mutant_lives(told.unwrap_or(0));
    told.unwrap_or(0)
}

/// From now on this one lives; 0 is none.
#[unsafe(no_mangle)]
pub extern "C" fn polhode_mutant_lives(number: u32) {
    LIVES.store(number, Relaxed);
}

/// Whether somebody asked for this one since this was asked last.
#[unsafe(no_mangle)]
pub extern "C" fn polhode_mutant_reached(number: u32) -> bool {
    REACHED[number as usize].swap(false, Relaxed)
}

/// The same question from Python.
#[unsafe(no_mangle)]
pub extern "C" fn polhode_mutant_asked(number: u32) -> bool {
    is(number)
}
