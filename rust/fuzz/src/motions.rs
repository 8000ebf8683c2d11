//! Free motions, tops, simulations under every load by every method.

use arbitrary::Result;
use nalgebra::Vector3;
use polhode::RigidBody;
use polhode::motion::angular_momentum::angular_momentum;
use polhode::motion::euler_equations::EulerEquations;
use polhode::motion::free::{CircledAxis, FreeMotion, FromPeriods, Invariants, attitude_about};
use polhode::motion::heavy_top::{HeavyTop, PivotedTop};
use polhode::motion::kinetic_energy::kinetic_energy;
use polhode::motion::pivot_reaction::pivot_reaction;
use polhode::motion::simulate::State;

use crate::bodies::{any, tame};
use crate::draw::Draw;
use crate::laws::{is_plain, is_unit};
use crate::runs::simulated;

/// Takes the bytes as a body and what it does.
///
/// # Panics
/// When a law is broken.
pub fn run(data: &[u8]) {
    let _ = Draw::new(data).and_then(one);
}

fn one(mut draw: Draw<'_>) -> Result<()> {
    let body = if draw.up_to(3)? == 0 {
        any(&mut draw)?.0
    } else {
        tame(&mut draw)?
    };
    let Some(body) = body else { return Ok(()) };
    match draw.up_to(7)? {
        0 | 1 => free(&body, draw),
        2 => top(&body, draw),
        3 => from_periods(&body, draw),
        4 => instants(&body, draw),
        _ => simulated(&body, draw),
    }
}

fn free(body: &RigidBody, mut draw: Draw<'_>) -> Result<()> {
    let (omega, attitude) = (draw.vector()?, draw.attitude()?);
    let Ok(motion) = FreeMotion::of(body, &omega, &attitude) else {
        return Ok(());
    };
    let times = draw.list(12, Draw::number)?;
    let mut attitudes = vec![[0.0; 4]; times.len()];
    let mut omegas = vec![[0.0; 3]; times.len()];
    motion.sample(&times, &mut attitudes, &mut omegas);
    let moments = body.principal().moments;
    // The tensor and the moments of others say different things, each as well as it is known.
    let is_known = body.error_bound().inertia <= 1e-14 * moments[0];
    let plain = is_known && is_plain(&moments) && is_plain(omega.as_slice());
    let energy = |omega: &Vector3<f64>| {
        kinetic_energy(body, omega, &Vector3::zeros(), &body.center_of_mass()).total()
    };
    let momentum = motion.angular_momentum();
    for (k, &t) in times.iter().enumerate() {
        let state = motion.at(t);
        let alone = polhode::motion::attitude::components(&state.attitude);
        if t.is_finite() {
            let bits = |numbers: &[f64]| numbers.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
            assert_eq!(bits(&alone), bits(&attitudes[k]), "alone and in a batch");
            assert_eq!(
                bits(state.omega.as_slice()),
                bits(&omegas[k]),
                "alone and in a batch"
            );
        } else {
            assert!(alone.iter().all(|x| x.is_nan()), "a state at {t:?}");
            continue;
        }
        if !plain || t.abs() > 1e12 {
            continue;
        }
        is_unit(&state.attitude);
        let size = omega.norm();
        assert!(state.omega.norm() <= 1e8 * size, "{:?}", state.omega);
        let (before, after) = (energy(&omega), energy(&state.omega));
        assert!(
            (after - before).abs() <= 1e-12 * before,
            "energy {before:?} {after:?} at {t:?}"
        );
        let now = state.attitude * (body.inertia() * state.omega);
        let allowed = 1e-12 * moments[2] * size;
        assert!(
            (now - momentum).amax() <= allowed,
            "L {momentum:?} {now:?} at {t:?}: {omega:?} {body:?}"
        );
        if t == 0.0 {
            assert!((state.omega - omega).amax() <= 1e-14 * size);
            assert!(state.attitude.angle_to(&attitude) <= 1e-7);
        }
        let bar = motion.error_bar(t, 1e-12);
        assert!(!(bar.attitude < 0.0 || bar.omega < 0.0), "{bar:?}");
    }
    let invariants = Invariants::of_motion(&motion);
    let periods = invariants.periods();
    assert!(
        !(periods.turn < 0.0
            || periods.wobble < 0.0
            || periods.spin < 0.0
            || periods.rotation < 0.0
            || periods.flip < 0.0),
        "{periods:?}"
    );
    let poinsot = invariants.poinsot();
    assert!(
        poinsot.distance >= 0.0 || poinsot.distance.is_nan(),
        "{poinsot:?}"
    );
    let count = draw.up_to(40)?;
    let curve = motion.polhode(count);
    assert_eq!(curve.len(), count);
    if plain {
        assert!(curve.iter().flatten().all(|x| x.is_finite()), "{curve:?}");
    }
    let _ = (
        invariants.nutation(),
        invariants.cones(),
        motion.herpolhode(draw.number()?),
    );
    let modulus = invariants.modulus();
    assert!(
        (0.0..=1.0).contains(&modulus) || modulus.is_nan(),
        "k = {modulus:?}"
    );
    assert!(invariants.kinetic_energy() >= 0.0 && invariants.angular_momentum() >= 0.0 || !plain);
    Ok(())
}

fn top(body: &RigidBody, mut draw: Draw<'_>) -> Result<()> {
    // Most bodies are no tops: one that is, its centre on its axis.
    let [spread, length, arm, mass] = [
        draw.positive()?,
        draw.positive()?,
        draw.number()?,
        draw.positive()?,
    ];
    let axis = draw.rotation()?;
    let moments = [spread + length, spread + length, 2.0 * spread];
    let center = axis.column(2) * arm;
    let made = RigidBody::from_principal(mass, &moments, &axis, &center, 0.0);
    let body = if draw.up_to(3)? == 0 { Ok(*body) } else { made };
    let top = body
        .and_then(|body| PivotedTop::of(&body, draw.one_of(&[1e-14, 1e-9, 1e-2]).unwrap_or(0.0)));
    let Ok(top) = top else { return Ok(()) };
    let (omega, attitude, gravity) = (draw.vector()?, draw.attitude()?, draw.vector()?);
    let Ok(motion) = HeavyTop::of(&top, &omega, &attitude, &gravity) else {
        return Ok(());
    };
    let numbers = [top.axial, top.transverse, top.mass_moment];
    let plain = is_plain(&numbers) && is_plain(omega.as_slice()) && is_plain(gravity.as_slice());
    let energy = |state: &State| {
        let spin = state.omega.dot(&top.axis);
        let across = state.omega - top.axis * spin;
        let kinetic = 0.5 * (top.axial * spin * spin + top.transverse * across.norm_squared());
        let height = -top.mass_moment * (state.attitude * top.axis).dot(&gravity);
        [
            kinetic + height,
            kinetic + height.abs() + top.mass_moment.abs() * gravity.norm(),
        ]
    };
    let start = State { attitude, omega };
    for t in draw.list(8, Draw::number)? {
        let state = motion.at(t);
        if !plain || t.is_nan() || t.abs() > 1e9 {
            continue;
        }
        assert!(
            state.omega.iter().all(|x| x.is_finite())
                && (state.attitude.norm() - 1.0).abs() < 1e-13,
            "{state:?} at {t:?}: {top:?} {omega:?} {attitude:?} {gravity:?}"
        );
        let ([before, size], [after, _]) = (energy(&start), energy(&state));
        assert!(
            (after - before).abs() <= 1e-10 * size,
            "energy of a top {before:?} {after:?} at {t:?}: {top:?} {omega:?} {attitude:?} {gravity:?}"
        );
    }
    let nutation = motion.nutation();
    let [low, high] = nutation.inclination;
    assert!(!plain || low <= high && low >= 0.0, "{nutation:?}");
    let inclination = draw.number()?;
    let _ = top.effective_potential(&omega, &attitude, &gravity, inclination);
    let least = top.least_spin(inclination, &gravity);
    assert!(least >= 0.0 || least.is_nan(), "least spin {least:?}");
    let _ = top.steady_precession(draw.number()?, inclination, &gravity);
    Ok(())
}

fn from_periods(body: &RigidBody, mut draw: Draw<'_>) -> Result<()> {
    let asked = FromPeriods {
        rotation: draw.positive()?,
        precession: draw.positive()?,
        circled: draw.one_of(&[CircledAxis::Long, CircledAxis::Short])?,
        sense: draw.one_of(&[1.0, -1.0, 0.0])?,
        phase: draw.number()?,
    };
    let principal = body.principal();
    if let Ok(omega) = asked.omega(&principal.moments) {
        if is_plain(&principal.moments) && is_plain(&[asked.rotation, asked.precession]) {
            let periods = Invariants::of(&principal.moments, &omega).periods();
            let own = if periods.spin.is_nan() {
                periods.rotation
            } else {
                periods.spin // of a symmetric body
            };
            assert!(
                own.is_nan() || (own - asked.rotation).abs() <= 1e-6 * asked.rotation,
                "{asked:?} {periods:?} {principal:?}"
            );
        }
        let direction = draw.vector()?;
        if let Ok(q) = attitude_about(&principal.moments, &principal.axes, &omega, &direction) {
            is_unit(&q);
        }
    }
    Ok(())
}

fn instants(body: &RigidBody, mut draw: Draw<'_>) -> Result<()> {
    let (omega, velocity, about, other) = (
        draw.vector()?,
        draw.vector()?,
        draw.vector()?,
        draw.vector()?,
    );
    let energy = kinetic_energy(body, &omega, &velocity, &about);
    let momentum = angular_momentum(body, &omega, &velocity, &other, &about);
    let equations = EulerEquations::about(body, &about);
    let acceleration = equations.angular_acceleration(&omega, &other);
    let all = [body.mass(), body.center_of_mass().norm()];
    let vectors = [omega, velocity, about, other];
    let plain = is_plain(&all)
        && is_plain(&body.principal().moments)
        && vectors.iter().all(|v| is_plain(v.as_slice()));
    if plain {
        let size = energy.translational + energy.rotational;
        assert!(
            energy.rotational >= 0.0 && energy.total() >= -1e-12 * size,
            "{energy:?}"
        );
        assert!(momentum.total().iter().all(|x| x.is_finite()));
        if let Ok(acceleration) = acceleration {
            let back = equations.torque(&omega, &acceleration);
            let size = other.norm()
                + equations.moments()[2] * (omega.norm_squared() + acceleration.norm());
            assert!((back - other).amax() <= 1e-12 * size, "{back:?} {other:?}");
        }
    }
    let _ = pivot_reaction(
        body,
        &draw.attitude()?,
        &omega,
        &velocity,
        &about,
        &other,
        &draw.vector()?,
    );
    Ok(())
}
