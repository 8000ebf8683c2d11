//! The two periods of Jacobi's functions.

/// The half periods: K along the real axis, K′ along the imaginary one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct HalfPeriods {
    /// K.
    pub real: f64,
    /// K′.
    pub imaginary: f64,
}
