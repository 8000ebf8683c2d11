//! Steady motions on a level plane and whether they are stable: circles of a body of revolution, critical rates, the upright spin of a
//! rattleback, the tippe top.
//!
//! In a steady motion of a body of revolution `ω = Ω n + s e` with constant rates Ω about the normal and s about the axis e, and the
//! inclination of the axis is constant. In axes that turn with s about e relative to the body the state (γ, ω) rests, so that
//!
//! ```text
//! γ̇ = γ×ω = −s e×γ,   ω̇ = −s e×ω,   and small changes obey  ẋ = (∂f/∂x + s e×) x
//! ```
//!
//! The derivatives are exact, from numbers that carry them. Four of the six eigenvalues are zero: those of |γ|, of the family of steady
//! motions and of its two constants. So the other two are `±λ` with `λ² = ½ tr J²`, and no digit is lost in multiple roots.
//! Source: Routh, Advanced Rigid Dynamics (1884), §§ 244–248; Borisov & Mamaev, Regular and Chaotic Dynamics 7 (2002) 177.

use nalgebra::{Matrix6, UnitQuaternion, Vector3};

use super::contact::{Contact, LiftOff};
use super::equations::{ContactState, Equations, Motion};
use super::surface::{Surface, axes_of};
use crate::error::{Error, MotionFault, all_finite, finite};
use crate::mass::RigidBody;
use crate::motion::attitude::shortest_turn;
use crate::numerics::jet::Jet;
use crate::principal::SymmetricTop;

/// What is zero to rounding, relative to its parts.
const ROUNDING: f64 = 1e-10;

/// A body and its surface on a level plane.
struct Level {
    equations: Equations,
    gravity: f64,
    mass: f64,
}

/// A steady motion of a body of revolution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Steady {
    /// ω in body axes, and an attitude at which it is steady, of a plane normal to z.
    pub omega: Vector3<f64>,
    /// `R_NB`.
    pub attitude: UnitQuaternion<f64>,
    /// Ω, about the normal.
    pub turn: f64,
    /// s, about the axis of the body.
    pub spin: f64,
    /// Of the circle of the contact; infinite for a straight line.
    pub radius: f64,
    /// The force across the normal over that along it.
    pub friction_needed: f64,
    /// λ², whose roots `±λ` are the rates of small changes: where it is negative the motion is stable.
    pub squared_rate: f64,
}

/// Which rate a steady motion is to have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Rate {
    /// About the normal of the plane.
    Turn(f64),
    /// About the axis of the body, beside the turn.
    Spin(f64),
}

/// The upright motion of a body of revolution whose critical rate is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Upright {
    /// In a straight line, its axis level.
    Rolling,
    /// On the spot about the normal, its axis level.
    Spinning,
}

/// Rates of the two modes of a body that spins upright.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Modes {
    /// The real parts, that of the faster mode first: a positive one grows.
    pub growth_rates: [f64; 2],
    /// The imaginary parts.
    pub frequencies: [f64; 2],
}

impl Level {
    fn new(body: &RigidBody, surface: &Surface, gravity: &Vector3<f64>) -> Result<Self, Error> {
        all_finite("gravity", gravity)?;
        let up = -gravity;
        if up.norm() == 0.0 {
            return Err(Error::OutOfDomain {
                what: "gravity",
                law: "a vector that has a direction: the plane is normal to it",
                value: 0.0,
            });
        }
        let contact = Contact::rolling(*surface, up, Vector3::zeros(), 0.0, LiftOff::Hold)?;
        let down = Vector3::new(0.0, 0.0, -up.norm());
        let level = Contact::rolling(*surface, Vector3::z(), contact.point, 0.0, LiftOff::Hold)?;
        Ok(Self {
            equations: Equations::new(body, &level, &down),
            gravity: up.norm(),
            mass: body.mass(),
        })
    }

    fn motion(&self, normal: &Vector3<f64>, omega: &Vector3<f64>) -> Motion<f64> {
        self.equations.motion(&ContactState {
            attitude: [0.0, 0.0, 0.0, 1.0],
            omega: (*omega).into(),
            normal: (*normal).into(),
            place: [0.0; 2],
            slip: [0.0; 2],
            work: 0.0,
            height: [0.0; 2],
        })
    }

    /// Compute ∂(γ̇, ω̇)/∂(γ, ω).
    fn derivative(&self, normal: &Vector3<f64>, omega: &Vector3<f64>) -> Matrix6<f64> {
        let zero = Jet::constant(0.0);
        let motion = self.equations.motion(&ContactState {
            attitude: [zero, zero, zero, Jet::constant(1.0)],
            omega: [0, 1, 2].map(|i| Jet::<6>::variable(omega[i], 3 + i)),
            normal: [0, 1, 2].map(|i| Jet::variable(normal[i], i)),
            place: [zero; 2],
            slip: [zero; 2],
            work: zero,
            height: [zero; 2],
        });
        let rates = [motion.rates.normal, motion.rates.omega].concat();
        Matrix6::from_fn(|row, column| rates[row].slopes[column])
    }

    /// Compute λ² of a steady motion with the spin s about an axis.
    fn squared_rate(
        &self,
        normal: &Vector3<f64>,
        omega: &Vector3<f64>,
        axis: &Vector3<f64>,
        spin: f64,
    ) -> f64 {
        let turn = axis.cross_matrix() * spin;
        let mut matrix = self.derivative(normal, omega);
        for block in [0, 3] {
            let mut view = matrix.fixed_view_mut::<3, 3>(block, block);
            view += turn;
        }
        0.5 * (matrix * matrix).trace()
    }

    /// Compute by how much ω̇ at right angles to axis and normal differs from that of a steady motion.
    fn off(&self, normal: &Vector3<f64>, axis: &Vector3<f64>, turn: f64, spin: f64) -> f64 {
        let across = normal.cross(axis).normalize();
        let omega = normal * turn + axis * spin;
        let rate = Vector3::from(self.motion(normal, &omega).rates.omega);
        (rate - normal.cross(axis) * (turn * spin)).dot(&across)
    }
}

/// The axis of a body of revolution, surface and matter.
fn axis_of_revolution(body: &RigidBody, surface: &Surface) -> Result<Vector3<f64>, Error> {
    let refused = |needs| Error::Motion(MotionFault::ContactCannotServe { needs });
    let center = body.center_of_mass();
    let is_sphere = surface.sphere_radius().is_some();
    let offset = center - surface.center();
    let axis = if is_sphere && offset.norm() <= ROUNDING * surface.size() {
        SymmetricTop::of(&body.principal(), ROUNDING)?.axis
    } else {
        surface.axis(&center).ok_or(refused(
            "steady motions are those of a surface of revolution: equal semi-axes or radii about one axis",
        ))?
    };
    if offset.cross(&axis).norm() > ROUNDING * surface.size() {
        return Err(refused(
            "the centre of mass of a body of revolution is on the axis of its surface: move the surface or the body",
        ));
    }
    let inertia = body.inertia();
    let along = axis.dot(&(inertia * axis));
    let across = 0.5 * (inertia.trace() - along);
    let outer = axis * axis.transpose();
    let symmetric = outer * (along - across) + nalgebra::Matrix3::identity() * across;
    if (symmetric - inertia).abs().max() > ROUNDING * inertia.trace() {
        return Err(refused(
            "the two moments across the axis of the surface must be equal: simulate this body, or give it equal moments",
        ));
    }
    Ok(axis)
}

/// Compute the steady motions of a body of revolution whose axis has an inclination to the normal of a level plane.
///
/// With a given turn there is one, with a given spin there are two, one, or none.
///
/// # Examples
///
/// ```
/// use polhode::mass::{Amount, solids};
/// use polhode::motion::rolling::{Surface, steady::{Rate, Steady, steady}};
/// use polhode::nalgebra::Vector3;
///
/// // A disk that rolls slowly round a wide circle leans little.
/// let disk = solids::cylinder(0.5, 0.0, Amount::Mass(1.0))?;
/// let surface = Surface::disk(0.5, Vector3::z(), Vector3::zeros())?;
/// let gravity = Vector3::new(0.0, 0.0, -9.81);
/// let found: Steady = steady(&disk, &surface, 1.5, &gravity, Rate::Turn(0.3))?[0];
/// assert!(found.radius > 1.0 && found.squared_rate < 0.0);
/// # Ok::<(), polhode::Error>(())
/// ```
///
/// # Errors
/// When the body or its surface is not one of revolution, the inclination is not between 0 and π, or no steady motion has this rate.
pub fn steady(
    body: &RigidBody,
    surface: &Surface,
    inclination: f64,
    gravity: &Vector3<f64>,
    rate: Rate,
) -> Result<Vec<Steady>, Error> {
    finite("inclination", inclination)?;
    if !(inclination > 0.0 && inclination < std::f64::consts::PI) {
        return Err(Error::OutOfDomain {
            what: "inclination",
            law: "between 0 and pi, from the axis of the body to the normal",
            value: inclination,
        });
    }
    let level = Level::new(body, surface, gravity)?;
    let axis = axis_of_revolution(body, surface)?;
    let aside: Vector3<f64> = axes_of(&nalgebra::Unit::new_normalize(axis))
        .column(0)
        .into();
    let normal = axis * inclination.cos() + aside * inclination.sin();
    if surface.margin(&normal) <= 0.0 {
        return Err(Error::Motion(MotionFault::NoPointOfContact {
            time: None,
            law: surface.beyond_margin(),
        }));
    }
    // The balance is a Ω² + b Ω s + c = 0.
    let unit = (level.gravity / surface.size()).sqrt();
    let off = |turn: f64, spin: f64| level.off(&normal, &axis, turn * unit, spin * unit);
    let c = off(0.0, 0.0);
    let a = off(1.0, 0.0) - c;
    let b = off(1.0, 1.0) - off(1.0, 0.0);
    let scale = a.abs() + b.abs() + c.abs();
    let none = |what, value| Error::OutOfDomain {
        what,
        law: "a rate at which a steady motion exists at this inclination",
        value,
    };
    let pairs = match rate {
        Rate::Turn(turn) => {
            finite("turn", turn)?;
            let turn = turn / unit;
            if turn == 0.0 || b.abs() <= ROUNDING * scale {
                return Err(none("turn", turn * unit));
            }
            vec![(turn, -(a * turn * turn + c) / (b * turn))]
        }
        Rate::Spin(spin) => {
            finite("spin", spin)?;
            let spin = spin / unit;
            let (half, square) = (0.5 * b * spin, 0.25 * b * b * spin * spin - a * c);
            if square < 0.0 {
                return Err(none("spin", spin * unit));
            }
            // The larger root by the sum that does not cancel, the smaller by the product.
            let sum = -(half + square.sqrt().copysign(half));
            let mut turns = Vec::new();
            if a.abs() > ROUNDING * scale {
                turns.push(sum / a);
            }
            if sum != 0.0 {
                turns.push(c / sum);
            }
            turns.dedup();
            turns.iter().map(|turn| (*turn, spin)).collect()
        }
    };
    let found = pairs.into_iter().map(|(turn, spin)| {
        let (turn, spin) = (turn * unit, spin * unit);
        let omega = normal * turn + axis * spin;
        let motion = level.motion(&normal, &omega);
        let (lift, arm) = (Vector3::from(motion.lift), Vector3::from(motion.arm));
        let pressed = lift.dot(&normal);
        Steady {
            omega,
            attitude: shortest_turn(&normal, &Vector3::z()).unwrap_or_else(|| {
                UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI)
            }),
            turn,
            spin,
            radius: (axis.cross(&arm) * spin).norm() / turn.abs(),
            friction_needed: (lift - normal * pressed).norm() / pressed,
            squared_rate: level.squared_rate(&normal, &omega, &axis, spin),
        }
    });
    Ok(found.collect())
}

/// Compute the rate from which an upright body of revolution is stable, its axis level.
///
/// For a disk it is `√(g I_t m a/(I_s (I_s + m a²)))` in a straight line, and `√(m g a/(I_t + m a²))` on the spot.
///
/// # Examples
///
/// ```
/// use polhode::mass::{Amount, rods};
/// use polhode::motion::rolling::{Surface, steady::{Upright, critical_rate}};
/// use polhode::nalgebra::Vector3;
///
/// let hoop = rods::ring(0.5, Amount::Mass(1.0))?;
/// let surface = Surface::disk(0.5, Vector3::z(), Vector3::zeros())?;
/// let rate = critical_rate(&hoop, &surface, &Vector3::new(0.0, 0.0, -9.81), Upright::Rolling)?;
/// assert!((rate - (9.81 / (4.0 * 0.5_f64)).sqrt()).abs() < 1e-13);
/// # Ok::<(), polhode::Error>(())
/// ```
///
/// # Errors
/// As [`steady`]; when the body is not balanced upright, or is stable at rest.
pub fn critical_rate(
    body: &RigidBody,
    surface: &Surface,
    gravity: &Vector3<f64>,
    motion: Upright,
) -> Result<f64, Error> {
    let level = Level::new(body, surface, gravity)?;
    let axis = axis_of_revolution(body, surface)?;
    let normal: Vector3<f64> = axes_of(&nalgebra::Unit::new_normalize(axis))
        .column(0)
        .into();
    let unit = (level.gravity / surface.size()).sqrt();
    if level.off(&normal, &axis, 0.0, 0.0).abs() > ROUNDING * unit * unit {
        return Err(Error::Motion(MotionFault::ContactCannotServe {
            needs: "with its axis level the body must be balanced: the centre of mass in the plane of the contact; ask for \
                    steady motions at an inclination instead",
        }));
    }
    let squared = |rate: f64| match motion {
        Upright::Rolling => level.squared_rate(&normal, &(axis * rate), &axis, rate),
        Upright::Spinning => level.squared_rate(&normal, &(normal * rate), &axis, 0.0),
    };
    // λ² = p − q ω².
    let at_rest = squared(0.0);
    let slope = (squared(unit) - at_rest) / (unit * unit);
    if at_rest <= 0.0 || slope >= 0.0 {
        return Err(Error::Motion(MotionFault::ContactCannotServe {
            needs: "a body that falls over at rest and is held up by its rate has a critical one; this one has none",
        }));
    }
    Ok((at_rest / -slope).sqrt())
}

/// Compute the modes of a body that spins about the normal of a level plane, as a rattleback does: the third axis of its surface is
/// along the normal.
///
/// # Examples
///
/// ```
/// use polhode::RigidBody;
/// use polhode::motion::rolling::{Surface, steady::{Modes, modes}};
/// use polhode::nalgebra::{Matrix3, Vector3};
///
/// // Kane and Levinson's rattleback: its principal axes are turned against those of its surface.
/// let tensor = Matrix3::new(2e-4, 2e-5, 0.0, 2e-5, 1.6e-3, 0.0, 0.0, 0.0, 1.7e-3);
/// let body = RigidBody::new(1.0, &tensor, &Vector3::new(0.0, 0.0, -0.01), 0.0)?;
/// let surface = Surface::ellipsoid([0.2, 0.03, 0.02], Vector3::zeros(), None)?;
/// let found: Modes = modes(&body, &surface, &Vector3::new(0.0, 0.0, -9.81), 5.0)?;
/// let other = modes(&body, &surface, &Vector3::new(0.0, 0.0, -9.81), -5.0)?;
/// assert!(found.growth_rates[0] * other.growth_rates[0] < 0.0);
/// # Ok::<(), polhode::Error>(())
/// ```
///
/// # Errors
/// When the spin is not steady: C must be above the contact, and the normal a principal axis.
pub fn modes(
    body: &RigidBody,
    surface: &Surface,
    gravity: &Vector3<f64>,
    rate: f64,
) -> Result<Modes, Error> {
    finite("rate", rate)?;
    let level = Level::new(body, surface, gravity)?;
    let normal = surface.own_axis();
    let omega = normal * rate;
    let unit = level.gravity / surface.size() + rate * rate;
    let acceleration = Vector3::from(level.motion(&normal, &omega).rates.omega);
    if acceleration.norm() > ROUNDING * unit {
        return Err(Error::Motion(MotionFault::ContactCannotServe {
            needs: "the upright spin must be steady: the centre of mass above the contact, and the normal a principal axis of the body",
        }));
    }
    let eigenvalues = level.derivative(&normal, &omega).complex_eigenvalues();
    let mut all: Vec<_> = eigenvalues.iter().copied().collect();
    // Two are zero: those of |γ| and of the rate itself.
    all.sort_by(|a, b| b.norm_sqr().total_cmp(&a.norm_sqr()));
    let mut rates: Vec<_> = all[..4].iter().filter(|rate| rate.im >= 0.0).collect();
    rates.sort_by(|a, b| b.im.total_cmp(&a.im).then(b.re.total_cmp(&a.re)));
    let (first, second) = (rates[0], rates[1.min(rates.len() - 1)]);
    Ok(Modes {
        growth_rates: [first.re, second.re],
        frequencies: [first.im, second.im],
    })
}

/// What becomes of a tippe top.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TippeTop {
    /// The cosine of the final inclination: of the line from C to the centre of the sphere, from the normal.
    pub cos_theta: f64,
    /// Jellett's constant λ of the upright spin.
    pub jellett: f64,
    /// The spin beyond which the upright top is unstable; infinite where it is stable at all spins.
    pub upright_unstable_beyond: f64,
    /// The spin beyond which the inverted top is stable; infinite where it never is.
    pub inverted_stable_beyond: f64,
}

/// Compute what becomes of a ball with C below its centre that spins upright, on a plane with friction.
///
/// Friction keeps Jellett's constant λ, and takes energy until the slip has ceased. What is left is `E = λ²/(2 d·I d) + m g h` with the
/// vector d from the contact to C, and the height h of C; the top ends at a minimum. `spin`: about the normal at the start.
/// Source: Ebenfeld & Scheck, Annals of Physics 243 (1995) 195.
///
/// # Examples
///
/// ```
/// use polhode::RigidBody;
/// use polhode::motion::rolling::{Surface, steady::{TippeTop, tippe_top}};
/// use polhode::nalgebra::{Matrix3, Vector3};
///
/// // C is 3 mm below the centre of a ball of 2 cm.
/// let (moments, center) = ([8e-7, 8e-7, 8e-7], Vector3::new(0.0, 0.0, -0.003));
/// let body = RigidBody::from_principal(0.006, &moments, &Matrix3::identity(), &center, 0.0)?;
/// let surface = Surface::sphere(0.02, Vector3::zeros())?;
/// let gravity = Vector3::new(0.0, 0.0, -9.81);
/// let fast: TippeTop = tippe_top(&body, &surface, 200.0, &gravity)?;
/// assert_eq!(fast.cos_theta, -1.0); // it inverts
/// assert_eq!(tippe_top(&body, &surface, 1.0, &gravity)?.cos_theta, 1.0); // it stays upright
/// # Ok::<(), polhode::Error>(())
/// ```
///
/// # Errors
/// When the body is not a ball of revolution with C off the centre.
pub fn tippe_top(
    body: &RigidBody,
    surface: &Surface,
    spin: f64,
    gravity: &Vector3<f64>,
) -> Result<TippeTop, Error> {
    finite("spin", spin)?;
    let level = Level::new(body, surface, gravity)?;
    let Some(radius) = surface.sphere_radius() else {
        return Err(Error::Motion(MotionFault::ContactCannotServe {
            needs: "a tippe top has the surface of a sphere",
        }));
    };
    let axis = axis_of_revolution(body, surface)?;
    let below = (body.center_of_mass() - surface.center()).norm();
    if below <= ROUNDING * radius || below >= radius {
        return Err(Error::Motion(MotionFault::ContactCannotServe {
            needs: "the centre of mass of a tippe top is within the sphere, off its centre",
        }));
    }
    let inertia = body.inertia();
    let along = axis.dot(&(inertia * axis));
    let across = 0.5 * (inertia.trace() - along);
    // With u = cos θ: d = a n − c e, so d·e = a u − c, d² − (d·e)² = a² (1 − u²), h = a − c u.
    let (a, c) = (radius, below);
    let stiffness = |u: f64| across * a * a * (1.0 - u * u) + along * (a * u - c) * (a * u - c);
    let slope = |u: f64| -2.0 * across * a * a * u + 2.0 * along * a * (a * u - c);
    let weight = level.mass * level.gravity * c;
    // dE/du = −λ² D'/(2 D²) − m g c. Upright, u = 1, is stable while it is negative.
    let critical = |u: f64| {
        let (d, rate) = (stiffness(u), slope(u));
        // λ² at which dE/du = 0; with λ = I_s ω (a u − c) of a spin about the normal.
        let squared = -2.0 * d * d * weight / rate;
        let arm = along * (a * u - c);
        if squared > 0.0 {
            (squared / (arm * arm)).sqrt()
        } else {
            f64::INFINITY
        }
    };
    let jellett = along * (a - c) * spin;
    let energy_slope = |u: f64| {
        let d = stiffness(u);
        -jellett * jellett * slope(u) / (2.0 * d * d) - weight
    };
    // From upright the top goes down the slope, to the first minimum.
    let cos_theta = if energy_slope(1.0) <= 0.0 {
        1.0
    } else {
        first_minimum(&energy_slope)
    };
    Ok(TippeTop {
        cos_theta,
        jellett,
        upright_unstable_beyond: critical(1.0),
        inverted_stable_beyond: critical(-1.0),
    })
}

/// Compute the place of the first zero of a slope below 1 where it falls to negative values; −1 without one.
fn first_minimum(slope: &dyn Fn(f64) -> f64) -> f64 {
    const PARTS: u32 = 4096;
    let place = |part: u32| 1.0 - 2.0 * f64::from(part) / f64::from(PARTS);
    let Some(part) = (1..=PARTS).find(|part| slope(place(*part)) < 0.0) else {
        return -1.0;
    };
    let (mut low, mut high) = (place(part), place(part - 1));
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if slope(middle) < 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mass::{Amount, rods, solids};

    /// The four critical rates of disk and hoop, and λ² on both sides of them.
    #[test]
    fn disk_and_hoop() {
        let (a, g) = (0.4, 9.81);
        let gravity = Vector3::new(0.0, 0.0, -g);
        let surface = Surface::disk(a, Vector3::z(), Vector3::zeros()).expect("a disk");
        let disk = solids::cylinder(a, 0.0, Amount::Mass(2.0)).expect("a disk");
        let hoop = rods::ring(a, Amount::Mass(2.0)).expect("a hoop");
        for (body, motion, squared) in [
            (&disk, Upright::Rolling, g / (3.0 * a)),
            (&disk, Upright::Spinning, 4.0 * g / (5.0 * a)),
            (&hoop, Upright::Rolling, g / (4.0 * a)),
            (&hoop, Upright::Spinning, 2.0 * g / (3.0 * a)),
        ] {
            let found = critical_rate(body, &surface, &gravity, motion).expect("a rate");
            assert!((found / squared.sqrt() - 1.0).abs() < 1e-13, "{motion:?}");
        }
    }

    #[test]
    fn steady_circles_rest() {
        let surface = Surface::torus(0.4, 0.1, Vector3::z(), Vector3::zeros()).expect("a torus");
        let body = solids::cylinder(0.4, 0.2, Amount::Mass(2.0)).expect("a body");
        let gravity = Vector3::new(0.0, 0.0, -9.81);
        let level = Level::new(&body, &surface, &gravity).expect("a plane");
        let one = steady(&body, &surface, 1.2, &gravity, Rate::Turn(2.0)).expect("a circle");
        let again = steady(&body, &surface, 1.2, &gravity, Rate::Spin(one[0].spin));
        let again = again.expect("circles");
        assert_eq!(again.len(), 2);
        assert!(again.iter().any(|found| (found.turn - 2.0).abs() < 1e-12));
        for found in again {
            let normal = found.attitude.inverse() * Vector3::z();
            assert!((normal.z - 1.2_f64.cos()).abs() < 1e-15);
            assert!(
                level
                    .off(&normal, &Vector3::z(), found.turn, found.spin)
                    .abs()
                    < 1e-11
            );
        }
    }

    #[test]
    fn bodies_of_no_revolution_are_refused() {
        let gravity = Vector3::new(0.0, 0.0, -9.81);
        let brick = solids::cuboid(&[1.0, 2.0, 3.0], Amount::Mass(1.0)).expect("a brick");
        let ellipsoid = Surface::ellipsoid([1.0, 2.0, 3.0], Vector3::zeros(), None).expect("one");
        let disk = Surface::disk(1.0, Vector3::z(), Vector3::zeros()).expect("one");
        for surface in [&ellipsoid, &disk] {
            assert!(steady(&brick, surface, 1.0, &gravity, Rate::Turn(1.0)).is_err());
        }
        let ball = solids::sphere(1.0, Amount::Mass(1.0)).expect("a ball");
        assert!(tippe_top(&ball, &disk, 1.0, &gravity).is_err());
        assert!(steady(&ball, &disk, 0.0, &gravity, Rate::Turn(1.0)).is_err());
        assert!(steady(&ball, &disk, 1.0, &Vector3::zeros(), Rate::Turn(1.0)).is_err());
        assert!(critical_rate(&brick, &disk, &gravity, Upright::Rolling).is_err());
    }
}
