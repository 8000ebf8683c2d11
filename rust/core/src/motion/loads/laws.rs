//! The list of the analytic laws, and the enum `Term` that is made of it. Each law stands in a file of its own in `laws`, which answers what a [`Law`] is asked; here its module is
//! declared, its type handed on, and its variant listed.

use nalgebra::{Vector3, Vector4};

pub mod constant_force;
pub mod constant_torque;
pub mod damping;
pub mod feedback;
pub mod gravity_gradient;
pub mod magnetic;
pub mod panels;
pub mod rotor;
pub mod sampled;
pub mod slug;
pub mod uniform_gravity;
pub mod wheel;

pub use self::constant_force::ConstantForce;
pub use self::constant_torque::ConstantTorque;
pub use self::damping::Damping;
pub use self::feedback::Feedback;
pub use self::gravity_gradient::GravityGradient;
pub use self::magnetic::{Magnetic, MagneticField, Moment};
pub use self::panels::{Panels, Plates, Stream, Surface};
pub use self::rotor::Rotor;
pub use self::sampled::Sampled;
pub use self::slug::Slug;
pub use self::uniform_gravity::UniformGravity;
pub use self::wheel::{Drive, Wheel};

use super::body_at_point::BodyAtPoint;
use super::carried_momentum::{CarriedMomentum, LawContext};
use super::law::{ConservedMomentum, Law, Traits};
use super::principal_frame::{LawNumber, PrincipalFrame};
use super::schedule::Windows;
use super::series_terms::SeriesTerms;
use super::switch::Switch;
use super::variables::Parameter;
use super::wrench::Wrench;
use crate::error::{Error, MotionFault, finite};
use crate::motion::kinematics::Frame;
use crate::motion::state::Phase;

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
            /// A wheel whose motor follows a controller, or coils that do.
            Controlled {
                /// The wheel, with a [`Drive::Controller`], or the coils, with a [`Moment::Commanded`].
                term: Box<Term>,
                /// The terms of the controller; what a program asks for besides is [commanded](super::Analytic::command).
                controller: Vec<Term>,
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
                    Self::Controlled { term, controller } => {
                        let own = term.traits(pivoted);
                        let needs_epoch = controller.iter().any(Term::needs_epoch);
                        let needs_body = controller.iter().any(Term::needs_body);
                        Traits {
                            needs_epoch: own.needs_epoch || needs_epoch,
                            needs_body: own.needs_body || needs_body,
                            ..own
                        }
                    }
                }
            }

            /// Its numbers, under the names and with the shapes that they have where the term is made. After [`Self::scaled`],
            /// they are the scaled values.
            #[must_use]
            pub fn parameters(&self) -> Vec<Parameter> {
                match self {
                    $(Self::$law(law) => law.parameters(),)+
                    Self::Scheduled { term, .. } => term.parameters(),
                    Self::Controlled { term, .. } => term.parameters(),
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
                    Self::Controlled { term, controller } => Self::Controlled {
                        term: Box::new(term.scaled(factor)?), // refused of wheels
                        controller: controller.clone(),
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
                    Self::Controlled { term, controller } => {
                        let begun = controller.into_iter().map(|term| term.with_epoch(t));
                        let controller = begun.collect();
                        Self::Controlled { term: Box::new(term.with_epoch(t)), controller }
                    }
                }
            }

            /// The times in a run from one time to another at which it is not smooth, where a step must end; not sorted, and the switches
            /// of windows at other times may be among them.
            #[must_use]
            pub fn breaks(&self, from: f64, to: f64) -> Vec<f64> {
                match self {
                    $(Self::$law(law) => law.breaks(from, to),)+
                    Self::Scheduled { windows, term } => {
                        let mut breaks = windows.switches();
                        breaks.extend(term.breaks(from, to));
                        breaks
                    }
                    Self::Controlled { term, controller } => {
                        let mut breaks = term.breaks(from, to);
                        breaks.extend(controller.iter().flat_map(|law| law.breaks(from, to)));
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
                    Self::Controlled { term, controller } => {
                        let middle = from + 0.5 * (to - from);
                        let mut acting = controller.iter().filter_map(|term| term.active(middle));
                        term.check(body, from, to)?;
                        acting.try_for_each(|term| term.check(body, from, to))
                    }
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
                    Self::Controlled { term, controller } => {
                        let asked = |term: &Term| term.wrench(body, t, phase).torque;
                        let command = controller.iter().map(asked).sum();
                        if let Some(coils) = term.coils() {
                            let idle = LawContext::without_command(body, t, t, phase);
                            return Wrench::couple(coils.torque(&LawContext { command, ..idle }));
                        }
                        let more = term.carried().map(|wheel| wheel.answer(body, t, phase, command));
                        term.wrench(body, t, phase) + Wrench::couple(more.unwrap_or_default())
                    }
                }
            }

            /// The energy of position that the body has in the term's field, when it has one: force and torque are what it
            /// loses. Positions from the origin of N. A term that depends on time has none.
            #[must_use]
            pub fn potential(&self, body: &BodyAtPoint, phase: &Phase) -> Option<f64> {
                match self {
                    $(Self::$law(law) => law.potential(body, phase),)+
                    Self::Scheduled { .. } | Self::Controlled { .. } => None,
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
                    Self::Scheduled { term, .. } | Self::Controlled { term, .. } => {
                        term.add_to(series, axes, side);
                    }
                }
            }

            /// What changes its law at a time and `phase`, if its law has a sign that changes with the state.
            pub(super) fn switch(&self, body: &BodyAtPoint, t: f64, phase: &Phase) -> Option<Switch> {
                match self {
                    $(Self::$law(law) => law.switch(body, t, phase),)+
                    Self::Scheduled { term, .. } | Self::Controlled { term, .. } => {
                        term.switch(body, t, phase)
                    }
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
                    Self::Scheduled { term, .. } | Self::Controlled { term, .. } => {
                        term.settled_wrench(side, body, t, phase)
                    }
                }
            }

            /// The function of the attitude (x, y, z, w), linear in it, whose sign its law has.
            pub(in crate::motion) fn switch_function<X: LawNumber>(
                &self,
                axes: &PrincipalFrame<'_, X>,
            ) -> Option<Vector4<X>> {
                match self {
                    $(Self::$law(law) => law.switch_function(axes),)+
                    Self::Scheduled { term, .. } | Self::Controlled { term, .. } => {
                        term.switch_function(axes)
                    }
                }
            }

            /// What it carries along in the body.
            #[must_use]
            pub fn carried(&self) -> Option<&dyn CarriedMomentum> {
                match self {
                    $(Self::$law(law) => law.carried(),)+
                    Self::Scheduled { .. } => None, // what is carried along cannot be scheduled
                    Self::Controlled { term, .. } => term.carried(),
                }
            }

            /// Whether its law has a sign that changes with the state.
            #[inline]
            pub(super) fn may_switch(&self) -> bool {
                match self {
                    $(Self::$law(law) => law.may_switch(),)+
                    Self::Scheduled { term, .. } => term.may_switch(),
                    Self::Controlled { .. } => false, // its controller does
                }
            }
        }
    };
}

laws!(
    ($)
    /// One analytic term of a load.
    #[derive(Clone, Debug, PartialEq)]
    #[non_exhaustive]
    pub enum Term {
        /// A torque N about the reference point of the motion.
        ConstantTorque(ConstantTorque),
        /// A force at a point p of the body: `N = (p − P)×F`.
        ConstantForce(ConstantForce),
        /// The weight m g at C.
        UniformGravity(UniformGravity),
        /// The torque of a distant attractor's field on a body in an orbit: `N = 3μ/r⁵ r×(I_C r)`.
        GravityGradient(GravityGradient),
        /// A torque against ω: `N = −D ω − E |ω| ω`.
        Damping(Damping),
        /// A torque known at some times, with a cubic spline in between.
        Sampled(Sampled),
        /// A torque that turns the body toward an attitude: `N = −K sign(w) vec(q_target⁻¹∘q) − D (ω − ω_target)`.
        Feedback(Feedback),
        /// The torque of a magnetic field: `N = (d − k Ḃ) × B`.
        Magnetic(Magnetic),
        /// Plates in light or air: `F = −p A cos θ ((1 − ρ_s) s + 2 (ρ_s cos θ + ρ_d/3) n)`, or `½ ρ v² C_d A cos θ` along the flow.
        Panels(Panels),
        /// A rotor that keeps its momentum in the body: `N = −ω × h`.
        Rotor(Rotor),
        /// A wheel with motor and friction: `ḣ = τ − c Ω − c₀ sign(Ω)`.
        Wheel(Wheel),
        /// A spherical damper: `N = k (σ − ω)`.
        Slug(Slug),
    }
);

impl Term {
    /// A torque constant in `frame`.
    ///
    /// # Errors
    /// When a component is not finite.
    pub fn constant_torque(vector: &Vector3<f64>, frame: Frame) -> Result<Self, Error> {
        ConstantTorque::new(vector, frame).map(Self::from)
    }

    /// A force constant in `frame` at `point` (from the origin of B), or at C.
    ///
    /// # Errors
    /// When a component is not finite.
    pub fn constant_force(
        vector: &Vector3<f64>,
        frame: Frame,
        point: Option<&Vector3<f64>>,
    ) -> Result<Self, Error> {
        ConstantForce::new(vector, frame, point).map(Self::from)
    }

    /// The weight of the body in the field g (in N).
    ///
    /// # Errors
    /// When a component is not finite.
    pub fn uniform_gravity(gravity: &Vector3<f64>) -> Result<Self, Error> {
        UniformGravity::new(gravity).map(Self::from)
    }

    /// A wheel whose motor follows the sum of these terms, and what a program [commands](super::Analytic::command).
    ///
    /// # Errors
    /// [`MotionFault::NoController`] for terms with a force, and for what the body carries along.
    pub fn controlled(wheel: Wheel, controller: Vec<Self>) -> Result<Self, Error> {
        let does_more = |term: &Self| term.exerts_force() || term.carried().is_some();
        if controller.iter().any(does_more) {
            return Err(MotionFault::NoController.into());
        }
        let term = Box::new(Self::Wheel(wheel));
        Ok(Self::Controlled { term, controller })
    }

    /// Coils that follow the sum of these terms, and what a program [commands](super::Analytic::command): see [`Moment::Commanded`].
    ///
    /// # Errors
    /// As [`Self::controlled`].
    ///
    /// # Examples
    ///
    /// ```
    /// use polhode::mass::{Amount, solids};
    /// use polhode::motion::loads::{BodyAtPoint, Magnetic, MagneticField, Moment, Term};
    /// use polhode::motion::simulate::{Phase, State};
    /// use polhode::motion::kinematics::Frame;
    /// use polhode::nalgebra::{UnitQuaternion, Vector3};
    ///
    /// // A torque is asked for; the coils exert the part of it that is across the field.
    /// let field = MagneticField::uniform(&Vector3::new(0.0, 0.0, 4e-5))?;
    /// let asked = Term::constant_torque(&Vector3::new(1e-4, 0.0, 2e-4), Frame::Body)?;
    /// let coils = Term::controlled_coils(Magnetic::of(Moment::Commanded(1.0), None, field)?, vec![asked])?;
    /// let body = BodyAtPoint::free(&solids::sphere(1.0, Amount::Mass(5.0))?, 0.0);
    /// let rest = Phase::in_place(&State { attitude: UnitQuaternion::identity(), omega: Vector3::zeros() });
    /// assert!((coils.wrench(&body, 0.0, &rest).torque - Vector3::x() * 1e-4).norm() < 1e-19);
    /// # Ok::<(), polhode::Error>(())
    /// ```
    pub fn controlled_coils(coils: Magnetic, controller: Vec<Self>) -> Result<Self, Error> {
        let does_more = |term: &Self| term.exerts_force() || term.carried().is_some();
        if controller.iter().any(does_more) {
            return Err(MotionFault::NoController.into());
        }
        let term = Box::new(Self::Magnetic(coils));
        Ok(Self::Controlled { term, controller })
    }

    /// The magnets and coils, of a term that is some.
    #[must_use]
    pub fn coils(&self) -> Option<&Magnetic> {
        match self {
            Self::Magnetic(law) => Some(law),
            Self::Scheduled { term, .. } | Self::Controlled { term, .. } => term.coils(),
            _ => None,
        }
    }

    /// The terms of the controller that the motor of a wheel, or coils, follow; nothing of other terms.
    #[must_use]
    pub fn controller(&self) -> &[Self] {
        match self {
            Self::Controlled { controller, .. } => controller,
            _ => &[],
        }
    }

    /// The term in `windows` only; of a scheduled one, where both sets of windows are open.
    ///
    /// # Errors
    /// [`MotionFault::StatesStay`] for what the body carries along.
    pub fn schedule(self, windows: &Windows) -> Result<Self, Error> {
        if self.carried().is_some() {
            return Err(MotionFault::StatesStay { what: "scheduled" }.into());
        }
        Ok(match self {
            Self::Scheduled {
                windows: own,
                term: inner,
            } => Self::Scheduled {
                windows: own.within(windows),
                term: inner,
            },
            term => Self::Scheduled {
                windows: windows.clone(),
                term: Box::new(term),
            },
        })
    }

    /// The term as it acts throughout a span of time without breaks around `middle`: nothing where it is switched off,
    /// else never a scheduled one.
    #[must_use]
    pub fn active(&self, middle: f64) -> Option<&Self> {
        match self {
            Self::Scheduled { windows, term } => {
                (windows.contains(middle)).then(|| term.active(middle))?
            }
            law => Some(law),
        }
    }

    /// How many internal states it has.
    #[must_use]
    pub fn internal_states(&self) -> usize {
        self.carried().map_or(0, CarriedMomentum::count)
    }

    /// How many numbers it has.
    #[must_use]
    pub fn count(&self) -> usize {
        self.parameters().iter().map(Parameter::count).sum()
    }

    /// Whether it pushes, so that a free body's position depends on it.
    #[must_use]
    pub fn exerts_force(&self) -> bool {
        self.traits(false).exerts_force
    }

    /// Whether it depends on ω or on the velocity.
    #[must_use]
    pub fn depends_on_rates(&self) -> bool {
        self.traits(false).depends_on_rates
    }

    /// Whether it depends on the body it acts on.
    #[must_use]
    pub fn needs_body(&self) -> bool {
        self.traits(false).needs_body
    }

    /// Whether it begins with the motion, wherever in time that is.
    #[must_use]
    pub fn needs_epoch(&self) -> bool {
        self.traits(false).needs_epoch
    }

    /// What of the angular momentum about the reference point it leaves as it is, on a pivoted body or on a free one.
    #[must_use]
    pub fn keeps(&self, pivoted: bool) -> ConservedMomentum {
        self.traits(pivoted).keeps
    }
}
