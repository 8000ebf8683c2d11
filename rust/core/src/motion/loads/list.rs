//! What the list of the laws expands to.

/// From the list of the laws: each is a variant of [`Term`](super::Term), which passes every question on to it. A law that is
/// not asked something does not compile. `for_each_law` hands the names to whoever has something of his own for each.
macro_rules! laws {
    (($d:tt) $(#[$about:meta])* pub enum Term { $($(#[$of_law:meta])+ $law:ident($same:ident),)+ }) => {
        $(#[$about])*
        pub enum Term {
            $($(#[$of_law])+ $law($same),)+
            /// A term that acts in some windows of time only.
            Scheduled {
                /// When.
                windows: Windows,
                /// Which.
                term: Box<Term>,
            },
        }

        $(impl From<$law> for Term {
            fn from(law: $law) -> Self {
                Self::$law(law)
            }
        })+

        /// Calls a macro with the names of all laws.
        #[doc(hidden)]
        #[macro_export]
        macro_rules! for_each_law {
            ($d call:ident) => {
                $d call!($($law)+)
            };
        }

        impl Term {
            /// What it depends on and does, on a pivoted body or on a free one.
            #[must_use]
            pub fn traits(&self, pivoted: bool) -> Traits {
                match self {
                    $(Self::$law(law) => law.traits(pivoted),)+
                    Self::Scheduled { term, .. } => term.traits(pivoted),
                }
            }

            /// Its numbers, under the names and with the shapes that they have where the term is made. Those that were
            /// multiplied by a factor are those after it.
            #[must_use]
            pub fn parameters(&self) -> Vec<Parameter> {
                match self {
                    $(Self::$law(law) => law.parameters(),)+
                    Self::Scheduled { term, .. } => term.parameters(),
                }
            }

            /// The term that exerts `factor` times as much.
            ///
            /// # Errors
            /// When `factor` or what it makes is not finite.
            pub fn scaled(&self, factor: f64) -> Result<Self, Error> {
                finite("the factor of a load", factor)?;
                Ok(match self {
                    $(Self::$law(law) => Self::$law(law.scaled(factor)?),)+
                    Self::Scheduled { windows, term } => Self::Scheduled {
                        windows: windows.clone(),
                        term: Box::new(term.scaled(factor)?),
                    },
                })
            }

            /// The term of a motion that began at `t`, for the rest of it.
            #[must_use]
            pub fn with_epoch(self, t: f64) -> Self {
                match self {
                    $(Self::$law(law) => Self::$law(law.with_epoch(t)),)+
                    Self::Scheduled { windows, term } => Self::Scheduled {
                        windows,
                        term: Box::new(term.with_epoch(t)),
                    },
                }
            }

            /// The times at which it is not smooth, where a step must end; not sorted.
            #[must_use]
            pub fn breaks(&self) -> Vec<f64> {
                match self {
                    $(Self::$law(law) => law.breaks(),)+
                    Self::Scheduled { windows, term } => {
                        let mut breaks = windows.switches();
                        breaks.extend(term.breaks());
                        breaks
                    }
                }
            }

            /// Checks that the term can act on `body` from one time to another.
            ///
            /// # Errors
            /// [`OutsideSamples`](crate::error::MotionFault::OutsideSamples);
            /// [`PivotedInOrbit`](crate::error::MotionFault::PivotedInOrbit).
            pub fn check(&self, body: &BodyAtPoint, from: f64, to: f64) -> Result<(), Error> {
                match self {
                    $(Self::$law(law) => law.check(body, from, to),)+
                    Self::Scheduled { term, .. } => term.check(body, from, to),
                }
            }

            /// Force in N and torque in B about the reference point at time `t`. A scheduled term counts as switched on or off
            /// by the time; in a run by [`Term::active`].
            #[inline]
            #[must_use]
            pub fn wrench(&self, body: &BodyAtPoint, t: f64, phase: &Phase) -> Wrench {
                match self {
                    $(Self::$law(law) => law.wrench(body, t, phase),)+
                    Self::Scheduled { windows, term } => {
                        if windows.contains(t) {
                            term.wrench(body, t, phase)
                        } else {
                            Wrench::default()
                        }
                    }
                }
            }

            /// The energy of position that the body has in the term's field, when it has one: force and torque are what it
            /// loses. Positions from the origin of N. A term that depends on time has none.
            #[must_use]
            pub fn potential(&self, body: &BodyAtPoint, phase: &Phase) -> Option<f64> {
                match self {
                    $(Self::$law(law) => law.potential(body, phase),)+
                    Self::Scheduled { .. } => None,
                }
            }

            /// Adds what the term, switched on, does to the equations of a series; `side` is the sign that its law is taken for.
            pub(in crate::motion) fn add_to<'a, X: LawNumber>(
                &'a self,
                series: &mut SeriesTerms<'a, X>,
                axes: &PrincipalFrame<'_, X>,
                side: f64,
            ) {
                match self {
                    $(Self::$law(law) => law.add_to(series, axes, side),)+
                    Self::Scheduled { term, .. } => term.add_to(series, axes, side),
                }
            }

            /// What changes its law at a time and `phase`, if its law has a sign that changes with the state.
            pub(super) fn switch(&self, body: &BodyAtPoint, t: f64, phase: &Phase) -> Option<Switch> {
                match self {
                    $(Self::$law(law) => law.switch(body, t, phase),)+
                    Self::Scheduled { term, .. } => term.switch(body, t, phase),
                }
            }

            /// As [`Self::wrench`], with the law of the term, switched on, on one side of its switch.
            #[inline]
            pub(super) fn settled_wrench(
                &self,
                side: f64,
                body: &BodyAtPoint,
                t: f64,
                phase: &Phase,
            ) -> Wrench {
                match self {
                    $(Self::$law(law) => law.settled_wrench(side, body, t, phase),)+
                    Self::Scheduled { term, .. } => term.settled_wrench(side, body, t, phase),
                }
            }

            /// The function of the attitude (x, y, z, w), linear in it, whose sign its law has.
            pub(in crate::motion) fn switching<X: LawNumber>(
                &self,
                axes: &PrincipalFrame<'_, X>,
            ) -> Option<Vector4<X>> {
                match self {
                    $(Self::$law(law) => law.switching(axes),)+
                    Self::Scheduled { term, .. } => term.switching(axes),
                }
            }

            /// What it carries along in the body.
            #[must_use]
            pub fn carried(&self) -> Option<&dyn Carried> {
                match self {
                    $(Self::$law(law) => law.carried(),)+
                    Self::Scheduled { .. } => None, // what is carried along cannot be scheduled
                }
            }

            /// Whether its law has a sign that changes with the state.
            #[inline]
            pub(super) fn may_switch(&self) -> bool {
                match self {
                    $(Self::$law(law) => law.may_switch(),)+
                    Self::Scheduled { term, .. } => term.may_switch(),
                }
            }
        }
    };
}

pub(super) use laws;
