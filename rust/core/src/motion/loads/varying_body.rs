//! A body whose mass and tensor change with time, and the load on it as one on the body of the start.

use std::ops::ControlFlow;

use nalgebra::{Matrix3, Vector3};

use super::body_at_point::BodyAtPoint;
use super::carried_momentum::CarriedMomentum;
use super::laws::Term;
use super::load::Load;
use super::spline::Spline;
use super::stiction::Bearing;
use super::switch::LawSwitch;
use super::wrench::Wrench;
use crate::error::{Error, MotionFault, all_finite};
use crate::mass::RigidBody;
use crate::motion::state::Phase;
use crate::numerics::threads::Watch;

/// A body known at some times: fuel that burns, a boom that comes out, grain that flows.
///
/// Mass, first moments and tensor about one point are cubic splines in time through those of the bodies, smooth to the second
/// derivative ("not a knot"); what is a cubic in time is met exactly. The body frame is the same at all times.
///
/// Where mass leaves through outlets, at rest in the body as it passes them, it takes its angular momentum along. With the tensor I about
/// the reference point P, and `r` from P to an outlet:
///
/// ```text
/// d(I ω)/dt + ω × I ω = N + ṁ r × (ω × r)      m v̇_C = F
/// ```
///
/// With several outlets each passes the same share. The momentum of what moves inside, relative to the body, is left out: it moves straight to and fro, and slowly. The thrust is a
/// load. Source: Thomson, Introduction to Space Dynamics; Eke, Dynamics of Variable Mass Systems, NASA CR-1998-208246.
///
/// # Examples
///
/// ```
/// use std::ops::ControlFlow;
/// use polhode::mass::{Amount, solids};
/// use polhode::motion::loads::{Analytic, BodyAtPoint, VaryingBody, VaryingLoad};
/// use polhode::motion::simulate::{Method, NoEvents, Phase, State, Task, Tolerance, simulate};
/// use polhode::nalgebra::{UnitQuaternion, Vector3};
///
/// // A cylinder burns down from 10 kg to 6 kg within 4 s, through a nozzle in the middle of its end.
/// let times = [0.0, 2.0, 4.0];
/// let grain = times.map(|t| solids::cylinder(0.1, 1.0, Amount::Mass(10.0 - t)));
/// let [first, second, third] = grain;
/// let bodies = [first?, second?, third?];
/// let nozzle = [Vector3::new(0.0, 0.0, -0.5)];
/// let rocket = VaryingBody::new(&times, &bodies, &nozzle, &mut |_| ControlFlow::Continue(()))?;
/// assert!((rocket.at(1.0)?.mass() - 9.0).abs() < 1e-15);
/// assert_eq!((rocket.times(), rocket.outlets()), (&times[..], &nozzle[..]));
///
/// // Its tumbling slows down, since the gas takes angular momentum along: ω = ω₀ (m/m₀)^(l²/4 / (I/m) − 1).
/// let start = rocket.at(0.0)?;
/// let phase = Phase::in_place(&State { attitude: UnitQuaternion::identity(), omega: Vector3::x() });
/// let task = Task::free(&start, phase, &[0.0, 4.0], Method::Dop853, Tolerance::new(1e-13, 0.0)?);
/// let mut load = VaryingLoad::new(&rocket, Analytic::new(&[], task.body_at_point), &task.body_at_point);
/// let run = simulate(&task, &mut load, &mut NoEvents::new(), &mut |_| ControlFlow::Continue(())).into_result()?;
/// let per_mass = (3.0 * 0.01 + 1.0) / 12.0;
/// assert!((run.phase.omega.x - 0.6_f64.powf(0.25 / per_mass - 1.0)).abs() < 1e-12);
/// # Ok::<(), polhode::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct VaryingBody {
    /// To which moments refer, from the origin of B.
    origin: Vector3<f64>,
    /// (m, 0, 0); m (C − origin); the tensor about the origin: (xx, yy, zz) and (yz, zx, xy).
    splines: [Spline; 4],
    outlets: Vec<Vector3<f64>>,
}

/// Points at which a piece is looked at, whether it is a body.
const LOOKS: usize = 8;

/// Mass, first moment and tensor about one point; or their rates.
#[derive(Clone, Copy)]
struct Moments {
    mass: f64,
    first: Vector3<f64>,
    tensor: Matrix3<f64>,
}

/// `m (d² 1 − d dᵀ)` of the first moment `m d`.
fn parallel(mass: f64, first: &Vector3<f64>) -> Matrix3<f64> {
    (Matrix3::identity() * first.norm_squared() - first * first.transpose()) / mass
}

/// The rate of [`parallel`].
fn parallel_rate(now: &Moments, rate: &Moments) -> Matrix3<f64> {
    let (f, g) = (&now.first, &rate.first);
    let both = Matrix3::identity() * (2.0 * f.dot(g)) - f * g.transpose() - g * f.transpose();
    (both - parallel(now.mass, f) * rate.mass) / now.mass
}

impl Moments {
    /// The moments about a point that lies at `shift` from the present one, fixed in B; of rates too.
    fn about(&self, shift: &Vector3<f64>) -> Self {
        let (f, s) = (&self.first, shift);
        let cross = Matrix3::identity() * (2.0 * f.dot(s)) - f * s.transpose() - s * f.transpose();
        let own = Matrix3::identity() * s.norm_squared() - s * s.transpose();
        Self {
            mass: self.mass,
            first: f - s * self.mass,
            tensor: self.tensor - cross + own * self.mass,
        }
    }
}

impl VaryingBody {
    /// Through `bodies` at the ascending `times`; mass leaves or comes through `outlets` (from the origin of B), if there are any.
    ///
    /// # Errors
    /// Fewer than two times, times that do not ascend, an outlet that is not finite; without outlets, masses that differ by more than
    /// rounding. [`MotionFault::NoBodyBetween`] where the spline is none that a body can have. [`Error::Stopped`] where `watch` says so.
    ///
    /// # Panics
    /// When `times` and `bodies` differ in length.
    pub fn new(
        times: &[f64],
        bodies: &[RigidBody],
        outlets: &[Vector3<f64>],
        watch: &mut Watch<'_>,
    ) -> Result<Self, Error> {
        all_finite("outlet", outlets.iter().flatten())?;
        let origin = bodies
            .first()
            .map_or_else(Vector3::zeros, RigidBody::center_of_mass);
        let moments = |body: &RigidBody| {
            let first = (body.center_of_mass() - origin) * body.mass();
            (first, body.inertia() + parallel(body.mass(), &first))
        };
        if outlets.is_empty()
            && let Some(first) = bodies.first()
            && let Some((body, &t)) = bodies.iter().zip(times).find(|(body, _)| {
                (body.mass() - first.mass()).abs() > 4.0 * f64::EPSILON * first.mass()
            })
        {
            return Err(Error::Motion(MotionFault::MassWithoutOutlet {
                t,
                mass: body.mass(),
                first: first.mass(),
            }));
        }
        let names = [
            "t",
            "the span of t",
            "the moments of the bodies",
            "the spline through the bodies",
        ];
        let mut through = |of: &dyn Fn(&RigidBody) -> Vector3<f64>| {
            let values: Vec<_> = bodies.iter().map(of).collect();
            Spline::through(names, times, &values, &mut *watch)
        };
        let found = Self {
            origin,
            splines: [
                through(&|body| Vector3::new(body.mass(), 0.0, 0.0))?,
                through(&|body| moments(body).0)?,
                through(&|body| moments(body).1.diagonal())?,
                through(&|body| {
                    let tensor = moments(body).1;
                    Vector3::new(tensor[(1, 2)], tensor[(2, 0)], tensor[(0, 1)])
                })?,
            ],
            outlets: outlets.to_vec(),
        };
        for (k, pair) in times.windows(2).enumerate() {
            for part in 1..LOOKS {
                found.at(pair[0] + (pair[1] - pair[0]) * part as f64 / LOOKS as f64)?;
            }
            if let ControlFlow::Break(()) = watch(k as f64 / times.len() as f64) {
                return Err(Error::Stopped);
            }
        }
        Ok(found)
    }

    /// The times it was given at.
    #[must_use]
    pub fn times(&self) -> &[f64] {
        self.splines[0].knots()
    }

    /// Where mass leaves or comes, from the origin of B.
    #[must_use]
    pub fn outlets(&self) -> &[Vector3<f64>] {
        &self.outlets
    }

    /// The body at time `t`.
    ///
    /// # Errors
    /// [`MotionFault::OutsideBodies`], [`MotionFault::NoBodyBetween`].
    pub fn at(&self, t: f64) -> Result<RigidBody, Error> {
        self.check_at(t)?;
        let [
            Moments {
                mass,
                first,
                tensor,
            },
            _,
        ] = self.moments(t);
        let none = |_| Error::Motion(MotionFault::NoBodyBetween { t });
        // The difference of two tensors has the rounding errors of both.
        let inertia = tensor - parallel(mass, &first);
        let size = tensor.amax() / inertia.amax();
        let rtol = if size.is_finite() {
            8.0 * f64::EPSILON * size
        } else {
            0.0
        };
        RigidBody::new(mass, &inertia, &(self.origin + first / mass), rtol).map_err(none)
    }

    /// Checks that `t` is within its times.
    ///
    /// # Errors
    /// [`MotionFault::OutsideBodies`].
    pub fn check_at(&self, t: f64) -> Result<(), Error> {
        let (first, last) = (self.times()[0], self.times()[self.times().len() - 1]);
        if (first..=last).contains(&t) {
            Ok(())
        } else {
            Err(Error::Motion(MotionFault::OutsideBodies { t, first, last }))
        }
    }

    /// The torque about the reference point that the changes of the body exert beside a load: `−İ ω + ṁ r × (ω × r)`, components in B.
    ///
    /// # Examples
    ///
    /// ```
    /// use std::ops::ControlFlow;
    /// use polhode::mass::{Amount, solids};
    /// use polhode::motion::loads::VaryingBody;
    /// use polhode::nalgebra::Vector3;
    ///
    /// // The tensor of a ball that shrinks to half its size: its moment falls from 2 to 0.5.
    /// let bodies = [solids::sphere(1.0, Amount::Mass(5.0))?, solids::sphere(0.5, Amount::Mass(5.0))?];
    /// let ball = VaryingBody::new(&[0.0, 3.0], &bodies, &[], &mut |_| ControlFlow::Continue(()))?;
    /// assert!((ball.torque_of_change(1.0, &Vector3::z(), false).z - 0.5).abs() < 1e-15);
    /// # Ok::<(), polhode::Error>(())
    /// ```
    #[must_use]
    pub fn torque_of_change(&self, t: f64, omega: &Vector3<f64>, pivoted: bool) -> Vector3<f64> {
        self.instant(t, pivoted).torque_of_change(self, omega)
    }

    /// Moments about `self.origin` at time `t`, and their rates.
    fn moments(&self, t: f64) -> [Moments; 2] {
        let [mass, first, along, across] = self.splines.each_ref().map(|spline| spline.at(t));
        [0, 1].map(|k| {
            let (d, p) = (along[k], across[k]);
            Moments {
                mass: mass[k].x,
                first: first[k],
                tensor: Matrix3::new(d.x, p.z, p.y, p.z, d.y, p.x, p.y, p.x, d.z),
            }
        })
    }

    /// What the equations of motion need at time `t`.
    fn instant(&self, t: f64, pivoted: bool) -> Instant {
        let moments = self.moments(t);
        let [now, rate] = &moments;
        let inertia = now.tensor - parallel(now.mass, &now.first);
        let center = self.origin + now.first / now.mass;
        if pivoted {
            let [now, rate] = moments.map(|it| it.about(&-self.origin));
            return Instant {
                mass: now.mass,
                mass_rate: rate.mass,
                inertia,
                center,
                point: Vector3::zeros(),
                tensor: now.tensor,
                rate: rate.tensor,
            };
        }
        Instant {
            mass: now.mass,
            mass_rate: rate.mass,
            inertia,
            center,
            point: center,
            tensor: inertia,
            rate: rate.tensor - parallel_rate(now, rate),
        }
    }
}

/// A varying body at one time, about the reference point P.
struct Instant {
    mass: f64,
    mass_rate: f64,
    /// About C.
    inertia: Matrix3<f64>,
    /// C and P, from the origin of B.
    center: Vector3<f64>,
    point: Vector3<f64>,
    /// About P, and its rate.
    tensor: Matrix3<f64>,
    rate: Matrix3<f64>,
}

impl Instant {
    fn torque_of_change(&self, body: &VaryingBody, omega: &Vector3<f64>) -> Vector3<f64> {
        let mut torque = -(self.rate * omega);
        if self.mass_rate != 0.0 && !body.outlets.is_empty() {
            let taken = body.outlets.iter().map(|outlet| {
                let r = outlet - self.point;
                r.cross(&omega.cross(&r))
            });
            let share = self.mass_rate / body.outlets.len() as f64;
            torque += taken.sum::<Vector3<f64>>() * share;
        }
        torque
    }

    /// As a load sees it.
    fn body_at_point(&self, start: &BodyAtPoint) -> BodyAtPoint {
        BodyAtPoint {
            mass: self.mass,
            inertia: self.inertia,
            point: self.point,
            center: if start.pivoted {
                self.center
            } else {
                Vector3::zeros()
            },
            ..*start
        }
    }
}

/// A load on a varying body, as the load under which the body of the start moves in the same way.
#[derive(Clone, Debug)]
pub struct VaryingLoad<'a, L> {
    load: L,
    /// Nothing where the body does not vary.
    change: Option<Change<'a>>,
}

/// How the body of a [`VaryingLoad`] varies.
#[derive(Clone, Debug)]
struct Change<'a> {
    body: &'a VaryingBody,
    start: BodyAtPoint,
    /// Σ J a aᵀ of the wheels that turn freely.
    wheels: Matrix3<f64>,
    /// The tensor about the reference point that the equations of motion have, without these wheels.
    tensor: Matrix3<f64>,
    has_bearing: bool,
}

impl<'a, L: Load> VaryingLoad<'a, L> {
    /// `load` on `body`; `start`: the body at the first time, as the load sees it.
    ///
    /// It refuses to [act](Load::enter) beyond the times of the body, and with wheels that have dry friction or a limit of their rate: their
    /// bearings would hold the body of the start.
    pub fn new(body: &'a VaryingBody, load: L, start: &BodyAtPoint) -> Self {
        let carried = load.carried();
        let has_bearing =
            (carried.iter()).any(|it| it.bearing().is_some() || it.rate_limit().is_some());
        let turning = carried.iter().filter_map(|it| it.turning());
        let wheels: Matrix3<f64> = turning.map(|(a, j)| a * a.transpose() * j).sum();
        let tensor = start.inertia + parallel(start.mass, &(start.center * start.mass)) - wheels;
        Self {
            load,
            change: Some(Change {
                body,
                start: *start,
                wheels,
                tensor,
                has_bearing,
            }),
        }
    }

    /// `load` itself, on a body that does not vary: runs of bodies of both kinds are compiled once.
    ///
    /// # Examples
    ///
    /// ```
    /// use std::ops::ControlFlow;
    /// use polhode::mass::{Amount, solids};
    /// use polhode::motion::loads::{Analytic, VaryingLoad};
    /// use polhode::motion::simulate::{Method, NoEvents, Phase, State, Task, Tolerance, simulate};
    /// use polhode::nalgebra::{UnitQuaternion, Vector3};
    ///
    /// let ball = solids::sphere(1.0, Amount::Mass(5.0))?;
    /// let phase = Phase::in_place(&State { attitude: UnitQuaternion::identity(), omega: Vector3::z() });
    /// let task = Task::free(&ball, phase, &[0.0, 2.0], Method::Dop853, Tolerance::new(1e-12, 0.0)?);
    /// let mut load = VaryingLoad::constant(Analytic::new(&[], task.body_at_point));
    /// let run = simulate(&task, &mut load, &mut NoEvents::new(), &mut |_| ControlFlow::Continue(())).into_result()?;
    /// assert!((run.phase.omega.z - 1.0).abs() < 1e-12);
    /// # Ok::<(), polhode::Error>(())
    /// ```
    pub fn constant(load: L) -> Self {
        Self { load, change: None }
    }

    /// Set the body of the load to that at time `t`, if it varies.
    fn set_body_at(&mut self, t: f64) {
        if let Some(change) = &self.change {
            change.set_body_at(t, &mut self.load);
        }
    }
}

impl Change<'_> {
    /// Compute the body at time `t`, and set it in the load.
    fn set_body_at(&self, t: f64, load: &mut impl Load) -> Instant {
        let now = self.body.instant(t, self.start.pivoted);
        load.set_body(&now.body_at_point(&self.start));
        now
    }

    /// Compute what a load exerts on the body of the start, for the motion of the body at time `t`. Not inlined: the loop over steps
    /// of a body that does not vary has no room for it.
    #[inline(never)]
    fn act<L: Load>(
        &self,
        load: &mut L,
        t: f64,
        phase: &Phase,
        rates: &mut [f64],
    ) -> Result<Wrench, L::Error> {
        let now = self.set_body_at(t, load);
        let Wrench { force, torque } = load.act(t, phase, rates)?;
        let omega = &phase.omega;
        let tensor = now.tensor - self.wheels;
        let torque =
            torque + now.torque_of_change(self.body, omega) - omega.cross(&(tensor * omega));
        let none = || Error::Motion(MotionFault::NoBodyBetween { t });
        let acceleration = tensor.cholesky().ok_or_else(none)?.solve(&torque);
        Ok(Wrench {
            force: force * (self.start.mass / now.mass),
            torque: self.tensor * acceleration + omega.cross(&(self.tensor * omega)),
        })
    }
}

impl<L: Load> Load for VaryingLoad<'_, L> {
    type Error = L::Error;

    fn analytic(&self) -> Option<&[Term]> {
        match self.change {
            Some(_) => None,
            None => self.load.analytic(),
        }
    }

    fn exerts_force(&self) -> bool {
        self.load.exerts_force()
    }

    fn depends_on_rates(&self) -> bool {
        self.change.is_some() || self.load.depends_on_rates()
    }

    fn breaks(&self, from: f64, to: f64) -> Vec<f64> {
        let mut breaks = self.load.breaks(from, to);
        if let Some(change) = &self.change {
            let knots = change.body.times();
            // The first two pieces are one cubic, and the last two.
            breaks.extend(knots.iter().skip(2).take(knots.len().saturating_sub(4)));
        }
        breaks
    }

    fn enter(&mut self, from: f64, to: f64) -> Result<(), L::Error> {
        if let Some(change) = &self.change {
            if change.has_bearing {
                return Err(Error::Motion(MotionFault::VaryingWithBearing).into());
            }
            change.body.check_at(from)?;
            change.body.check_at(to)?;
            change.set_body_at(from, &mut self.load);
        }
        self.load.enter(from, to)
    }

    fn settle(&mut self, t: f64, phase: &Phase) {
        self.set_body_at(t);
        self.load.settle(t, phase);
    }

    fn set_body(&mut self, body: &BodyAtPoint) {
        if self.change.is_none() {
            self.load.set_body(body);
        }
    }

    fn law_switches(&self) -> Vec<LawSwitch> {
        self.load.law_switches()
    }

    fn switch_law(&mut self, change: &LawSwitch) {
        self.load.switch_law(change);
    }

    fn bearings(&self) -> &[Bearing] {
        self.load.bearings()
    }

    fn over_limit(&self, wheel: Option<usize>, t: f64, phase: &Phase) -> f64 {
        self.load.over_limit(wheel, t, phase)
    }

    fn cuts(&self, from: f64, to: f64, phase: &Phase) -> Vec<f64> {
        self.load.cuts(from, to, phase)
    }

    fn firing(&self, t: f64, is_before: bool, phase: &Phase) -> Vec<(usize, bool)> {
        self.load.firing(t, is_before, phase)
    }

    fn wrench(&mut self, t: f64, phase: &Phase) -> Result<Wrench, L::Error> {
        self.act(t, phase, &mut [])
    }

    fn carried(&self) -> Vec<&dyn CarriedMomentum> {
        self.load.carried()
    }

    fn sizes(&self) -> Vec<[f64; 2]> {
        self.load.sizes()
    }

    #[inline(always)]
    fn act(&mut self, t: f64, phase: &Phase, rates: &mut [f64]) -> Result<Wrench, L::Error> {
        let Some(change) = &self.change else {
            return self.load.act(t, phase, rates);
        };
        // Number by number: what a load on a body that does not vary exerts stays in registers then.
        let Wrench { force, torque } = change.act(&mut self.load, t, phase, rates)?;
        Ok(Wrench {
            force: Vector3::new(force.x, force.y, force.z),
            torque: Vector3::new(torque.x, torque.y, torque.z),
        })
    }

    fn jump(&mut self, t: f64, phase: &mut Phase) -> Result<(), L::Error> {
        self.set_body_at(t);
        self.load.jump(t, phase)
    }
}
