//! Free motions, tops, simulations under every load by every method.

use std::ops::ControlFlow;

use arbitrary::Result;
use nalgebra::{Matrix3, Vector3};
use polhode::error::Error;
use polhode::motion::angular_momentum::angular_momentum;
use polhode::motion::euler_equations::EulerEquations;
use polhode::motion::free::{Circled, FreeMotion, FromPeriods, Invariants, attitude_about};
use polhode::motion::heavy_top::{HeavyTop, PivotedTop};
use polhode::motion::integrate::variation::{self, variations};
use polhode::motion::kinetic_energy::kinetic_energy;
use polhode::motion::loads::{
    Analytic, Damping, Feedback, Frame, GravityGradient, Load, Sampled, Term, Windows, Wrench,
};
use polhode::motion::pivot_reaction::pivot_reaction;
use polhode::motion::simulate::{
    Direction, End, Events, Method, NoEvents, Phase, Rule, Run, State, Task, Tolerance,
    check_times, simulate,
};
use polhode::{Error as Fault, RigidBody};

use crate::bodies::{any, tame};
use crate::draw::{Draw, patience};
use crate::laws::is_unit;

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

/// Whether numbers are so far from the ends of float64 that squares and products are numbers.
fn is_plain(numbers: &[f64]) -> bool {
    (numbers.iter()).all(|x| *x == 0.0 || (1e-30..1e30).contains(&x.abs()))
}

fn free(body: &RigidBody, mut draw: Draw<'_>) -> Result<()> {
    let (omega, attitude) = (draw.vector()?, draw.attitude()?);
    let motion = match FreeMotion::of(body, &omega, &attitude) {
        Ok(motion) => motion,
        Err(_) => return Ok(()),
    };
    let times = draw.list(12, Draw::number)?;
    let mut attitudes = vec![[0.0; 4]; times.len()];
    let mut omegas = vec![[0.0; 3]; times.len()];
    motion.sample(&times, &mut attitudes, &mut omegas);
    let moments = body.principal().moments;
    let plain = is_plain(&moments) && is_plain(omega.as_slice());
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
            "L {momentum:?} {now:?} at {t:?}"
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
        !(periods.rotation < 0.0 || periods.flip < 0.0),
        "{periods:?}"
    );
    let poinsot = invariants.poinsot();
    assert!(!(poinsot.distance < 0.0), "{poinsot:?}");
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
        if !plain || t.abs() > 1e9 {
            continue;
        }
        is_unit(&state.attitude);
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
    assert!(!(least < 0.0), "least spin {least:?}");
    let _ = top.steady_precession(draw.number()?, inclination, &gravity);
    Ok(())
}

fn from_periods(body: &RigidBody, mut draw: Draw<'_>) -> Result<()> {
    let asked = FromPeriods {
        rotation: draw.positive()?,
        precession: draw.positive()?,
        circled: draw.one_of(&[Circled::Long, Circled::Short])?,
        sense: draw.one_of(&[1.0, -1.0, 0.0])?,
        phase: draw.number()?,
    };
    let principal = body.principal();
    if let Ok(omega) = asked.omega(&principal.moments) {
        if is_plain(&principal.moments) && is_plain(&[asked.rotation, asked.precession]) {
            let periods = Invariants::of(&principal.moments, &omega).periods();
            assert!(
                (periods.rotation - asked.rotation).abs() <= 1e-6 * asked.rotation,
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

fn frame(draw: &mut Draw<'_>) -> Result<Frame> {
    draw.one_of(&[Frame::Body, Frame::Space])
}

fn matrix(draw: &mut Draw<'_>) -> Result<Matrix3<f64>> {
    Ok(if draw.coin()? {
        Matrix3::identity() * draw.positive()?
    } else {
        let half = Matrix3::from_row_slice(&draw.numbers::<9>()?);
        half * half.transpose()
    })
}

type Made = core::result::Result<Term, Fault>;

fn term(draw: &mut Draw<'_>) -> Result<Made> {
    Ok(match draw.up_to(8)? {
        0 => Term::constant_torque(&draw.vector()?, frame(draw)?),
        1 => {
            let point = draw.vector()?;
            let point = if draw.coin()? { Some(&point) } else { None };
            Term::constant_force(&draw.vector()?, frame(draw)?, point)
        }
        2 => Term::uniform_gravity(&draw.vector()?),
        3 => {
            let epoch = if draw.coin()? {
                Some(draw.number()?)
            } else {
                None
            };
            GravityGradient::new(draw.positive()?, &draw.vector()?, &draw.vector()?, epoch)
                .map(Term::GravityGradient)
        }
        4 => Damping::new(&matrix(draw)?, &Matrix3::zeros()).map(Term::Damping),
        5 => Damping::new(&Matrix3::zeros(), &matrix(draw)?).map(Term::Damping),
        6 => {
            let mut times = draw.list(6, Draw::number)?;
            times.sort_by(f64::total_cmp);
            if draw.coin()? && times.len() >= 2 {
                times.push(100.0);
                times.insert(0, -100.0);
                times.sort_by(f64::total_cmp);
            }
            let values = times
                .iter()
                .map(|_| draw.vector())
                .collect::<Result<Vec<_>>>()?;
            Sampled::new(&times, &values, frame(draw)?).map(Term::Sampled)
        }
        7 => Feedback::new(&matrix(draw)?, &matrix(draw)?, &draw.attitude()?).map(Term::Feedback),
        _ => {
            let windows = draw.list(4, |draw| Ok((draw.number()?, draw.number()?)))?;
            let term = Term::uniform_gravity(&draw.vector()?);
            let inner = if draw.coin()? {
                term
            } else {
                Term::constant_torque(&draw.vector()?, frame(draw)?)
            };
            Windows::new(&windows).and_then(|windows| Ok(inner?.scheduled(&windows)))
        }
    })
}

/// Passages of the components of ω through numbers.
struct Passages {
    rules: Vec<Rule>,
    levels: [f64; 3],
}

impl Events for Passages {
    type Error = Error;

    fn rules(&self) -> &[Rule] {
        &self.rules
    }

    fn value(&mut self, event: usize, _: f64, phase: &Phase) -> core::result::Result<f64, Error> {
        Ok(phase.omega[event % 3] - self.levels[event % 3])
    }
}

/// A load that only a callback knows.
struct Called<'a>(Analytic<'a>);

impl Load for Called<'_> {
    type Error = Error;

    fn exerts_force(&self) -> bool {
        self.0.exerts_force()
    }

    fn depends_on_rates(&self) -> bool {
        self.0.depends_on_rates()
    }

    fn breaks(&self) -> Vec<f64> {
        self.0.breaks()
    }

    fn enter(&mut self, from: f64, to: f64) -> core::result::Result<(), Error> {
        self.0.enter(from, to)
    }

    fn wrench(&mut self, t: f64, phase: &Phase) -> core::result::Result<Wrench, Error> {
        self.0.wrench(t, phase)
    }
}

const METHODS: [Method; 6] = [
    Method::Auto,
    Method::Exact,
    Method::Taylor,
    Method::Dop853,
    Method::Radau,
    Method::Splitting,
];

/// Looks at the watch before a run is given up: as many steps.
const STEPS: u32 = 120;

fn simulated(body: &RigidBody, mut draw: Draw<'_>) -> Result<()> {
    let terms = draw.list(3, term)?;
    let terms: Vec<Term> = terms.into_iter().flatten().collect();
    let mut times = draw.list(6, Draw::number)?;
    times.sort_by(f64::total_cmp);
    if draw.coin()? {
        times.reverse();
    }
    times.dedup();
    if check_times(&times).is_err() {
        return Ok(());
    }
    let mut initial = Phase::in_place(&State {
        attitude: draw.attitude()?,
        omega: draw.vector()?,
    });
    let pivoted = draw.coin()?;
    if !pivoted {
        (initial.position, initial.velocity) = (draw.vector()?, draw.vector()?);
    }
    let method = draw.one_of(&METHODS)?;
    let relative = draw.one_of(&[1e-10, 1e-6, 1e-3, 0.1, 1e-14, 1e-20])?;
    let Ok(tolerance) = Tolerance::new(relative, draw.one_of(&[0.0, 1e-9])?) else {
        return Ok(());
    };
    if !initial.numbers().iter().all(|x| x.is_finite()) {
        return Ok(());
    }
    let task = if pivoted {
        Task::pivoted(body, initial, &times, method, tolerance)
    } else {
        Task::free(body, initial, &times, method, tolerance)
    };
    let anchored: Vec<Term> = terms
        .into_iter()
        .map(|term| term.anchored(times[0]))
        .collect();
    let watch = &mut patience(STEPS);
    let events = draw.up_to(5)?;
    let run = if events < 3 {
        let direction = draw.one_of(&[Direction::Any, Direction::Rising, Direction::Falling])?;
        let last = draw.one_of(&[0, 1, 2])?;
        let mut passages = Passages {
            rules: vec![Rule { direction, last }; events],
            levels: if draw.coin()? {
                [0.0; 3]
            } else {
                draw.numbers()?
            },
        };
        let mut load = Analytic::new(&anchored, task.subject);
        simulate(&task, &mut load, &mut passages, watch)
    } else if events == 3 {
        let mut load = Called(Analytic::new(&anchored, task.subject));
        simulate(&task, &mut load, &mut NoEvents::new(), watch)
    } else {
        let mut load = Analytic::new(&anchored, task.subject);
        simulate(&task, &mut load, &mut NoEvents::new(), watch)
    };
    obeys(&run, &task, &anchored, &tolerance);
    if draw.up_to(7)? == 0 && matches!(run.end, End::Complete) {
        derivatives(&task, &anchored);
    }
    Ok(())
}

fn obeys(run: &Run<Error>, task: &Task<'_>, terms: &[Term], tolerance: &Tolerance) {
    assert_eq!(run.samples.len(), task.times.len());
    let [first, last] = [task.times[0], task.times[task.times.len() - 1]];
    assert!(
        run.time >= first.min(last) && run.time <= first.max(last),
        "{:?} through {:?} ended at {:?}",
        task.method,
        task.times,
        run.time
    );
    if run.end == End::Complete {
        assert_eq!(run.time, last, "complete: {:?}", task.method);
    }
    let forward = last >= first;
    let is_finite = |phase: &Phase| phase.numbers().iter().all(|x| x.is_finite());
    for (&t, sample) in task.times.iter().zip(&run.samples) {
        let is_past = if forward {
            t <= run.time
        } else {
            t >= run.time
        };
        let is_known = is_finite(sample);
        if run.end == End::Complete {
            assert!(is_known, "complete, but at {t:?} there is {sample:?}");
        }
        if !is_past {
            assert!(
                !is_known,
                "ended at {:?}, but at {t:?} there is a state",
                run.time
            );
        }
        if is_known {
            is_unit(&sample.attitude);
        }
    }
    let mut before = first;
    for crossing in &run.crossings {
        let t = crossing.time;
        assert!(
            if forward { t >= before } else { t <= before },
            "events in order"
        );
        before = t;
        assert!(is_finite(&crossing.phase), "{crossing:?}");
    }
    // Without torque energy and angular momentum are kept.
    let moments = task.euler.moments();
    let plain = is_plain(&moments) && is_plain(task.initial.omega.as_slice());
    if terms.is_empty() && plain && tolerance.relative <= 1e-6 && moments[0] > 1e-6 * moments[2] {
        let axes = task.euler.axes();
        let energy = |phase: &Phase| {
            let w = axes.tr_mul(&phase.omega);
            Vector3::from(moments).dot(&w.component_mul(&w))
        };
        let turns = task.initial.omega.norm() * (last - first).abs();
        let start = energy(&task.initial);
        for sample in run.samples.iter().filter(|sample| is_finite(sample)) {
            let off = (energy(sample) - start).abs();
            let allowed = (1e-11 + 1e3 * tolerance.relative) * (1.0 + turns) * start;
            assert!(
                off <= allowed,
                "energy of a free body off by {:e}",
                off / start
            );
        }
    }
}

fn derivatives(task: &Task<'_>, terms: &[Term]) {
    let watch: &mut dyn FnMut(f64) -> ControlFlow<()> = &mut patience(60);
    if let Ok(found) = variations(task, terms, watch) {
        assert_eq!(found.len(), task.times.len());
        let numbers: usize = terms
            .iter()
            .flat_map(variation::parameters)
            .map(|parameter| parameter.count())
            .sum();
        for variation in found {
            assert_eq!(variation.load.len(), numbers);
            assert!(
                variation.state.iter().all(|x| x.is_finite()),
                "{variation:?}"
            );
        }
    }
}
