//! The methods by name.

/// How a motion is found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Method {
    /// The first of exact, Taylor and DOP853 that can serve the run.
    #[default]
    Auto,
    /// In closed form: a free body without a load, and a symmetric top pivoted on its axis under uniform gravity.
    Exact,
    /// Taylor series of the order at which the work is least: analytic loads. At tolerances that doubles cannot serve in numbers
    /// of twice their precision.
    Taylor,
    /// The explicit Runge-Kutta method of order 8 by Dormand and Prince: every load.
    Dop853,
    /// The implicit Runge-Kutta method Radau IIA of order 5: every load, for those that are stiff.
    Radau,
    /// Kicks between exact free motions at equal steps: loads that do not depend on rates, for long times.
    Splitting,
}

impl Method {
    /// Every method, in the order of this page.
    ///
    /// ```
    /// use polhode::motion::simulate::Method;
    ///
    /// let named = |name| Method::ALL.iter().find(|method| method.name() == name);
    /// assert_eq!(named("radau"), Some(&Method::Radau));
    /// assert_eq!(named("euler"), None);
    /// ```
    pub const ALL: &'static [Self] = &[
        Self::Auto,
        Self::Exact,
        Self::Taylor,
        Self::Dop853,
        Self::Radau,
        Self::Splitting,
    ];

    /// Its name.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Auto => "auto",
            Self::Exact => "exact",
            Self::Taylor => "taylor",
            Self::Dop853 => "dop853",
            Self::Radau => "radau",
            Self::Splitting => "splitting",
        }
    }
}
