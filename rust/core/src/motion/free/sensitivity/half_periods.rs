//! What whole half periods leave of a time, however many they are.

use crate::numerics::double_double::DoubleDouble;

/// Half periods that a time holds: how many, and whether that is an odd number, which beyond 2⁵³ the first does not tell.
pub(super) struct Periods {
    pub(super) count: f64,
    pub(super) are_odd: bool,
}

/// From this many half periods on their number is not known to one at the first attempt.
const MANY: f64 = 4.5e15; // 2⁵²

/// The time but for whole half periods, and these.
pub(super) fn whole_off(t: f64, half_period: DoubleDouble) -> (Periods, f64) {
    let mut rest = DoubleDouble::from(t);
    let mut periods = Periods {
        count: 0.0,
        are_odd: false,
    };
    loop {
        let count = (rest.high / half_period.high).round();
        if count == 0.0 || !count.is_finite() {
            return (periods, rest.high);
        }
        rest -= half_period * count.into();
        periods.count += count;
        periods.are_odd ^= count % 2.0 != 0.0;
        if count.abs() < MANY {
            return (periods, rest.high);
        }
    }
}
