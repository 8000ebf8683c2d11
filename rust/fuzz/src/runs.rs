//! Simulations under every load by every method.

use std::ops::ControlFlow;

use arbitrary::Result;
use nalgebra::Vector3;
use polhode::motion::integrate::variation::variations;
use polhode::motion::loads::{Analytic, CarriedMomentum, Load, Term, Wrench};
use polhode::motion::simulate::{
    Direction, End, Events, Method, NoEvents, Phase, Rule, Run, State, Task, Tolerance,
    check_times, simulate,
};
use polhode::{Error, RigidBody};

use crate::draw::{Draw, patience};
use crate::laws::{is_plain, is_unit};
use crate::loads::term;

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

    fn breaks(&self, from: f64, to: f64) -> Vec<f64> {
        self.0.breaks(from, to)
    }

    fn enter(&mut self, from: f64, to: f64) -> core::result::Result<(), Error> {
        self.0.enter(from, to)
    }

    fn wrench(&mut self, t: f64, phase: &Phase) -> core::result::Result<Wrench, Error> {
        self.0.wrench(t, phase)
    }

    fn act(
        &mut self,
        t: f64,
        phase: &Phase,
        rates: &mut [f64],
    ) -> core::result::Result<Wrench, Error> {
        self.0.act(t, phase, rates)
    }

    fn carried(&self) -> Vec<&dyn CarriedMomentum> {
        self.0.carried()
    }
}

/// Looks at the watch before a run is given up: as many steps.
const STEPS: u32 = 60;

/// A run of a body, whose samples and events are as its end says.
///
/// # Errors
/// When the bytes are used up.
///
/// # Panics
/// When a law is broken.
pub fn simulated(body: &RigidBody, mut draw: Draw<'_>) -> Result<()> {
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
    let method = draw.one_of(Method::ALL)?;
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
    let with_epoch: Vec<Term> = terms
        .into_iter()
        .map(|term| term.with_epoch(times[0]))
        .collect();
    let watch = &mut patience(STEPS);
    let events = draw.up_to(5)?;
    let mut load = Analytic::new(&with_epoch, task.body_at_point);
    let run = match events {
        0..3 => {
            let directions = [Direction::Any, Direction::Rising, Direction::Falling];
            let direction = draw.one_of(&directions)?;
            let last = draw.one_of(&[0, 1, 2])?;
            let mut passages = Passages {
                rules: vec![
                    Rule {
                        direction,
                        last,
                        ..Rule::default()
                    };
                    events
                ],
                levels: if draw.coin()? {
                    [0.0; 3]
                } else {
                    draw.numbers()?
                },
            };
            simulate(&task, &mut load, &mut passages, watch)
        }
        3 => simulate(&task, &mut Called(load), &mut NoEvents::new(), watch),
        _ => simulate(&task, &mut load, &mut NoEvents::new(), watch),
    };
    obeys(&run, &task, &with_epoch, &tolerance);
    if draw.up_to(7)? == 0 && matches!(run.end, End::Complete) {
        derivatives(&task, &with_epoch);
    }
    Ok(())
}

fn obeys(run: &Run<Error>, task: &Task<'_>, terms: &[Term], tolerance: &Tolerance) {
    assert!((1..=task.times.len()).contains(&run.samples.len()));
    let [first, last] = [task.times[0], task.times[task.times.len() - 1]];
    // Steppers count from the start of a span: the time they came to is rounded as a sum.
    let rounding = 4.0 * f64::EPSILON * first.abs().max(last.abs());
    let (low, high) = (first.min(last) - rounding, first.max(last) + rounding);
    assert!(
        (low..=high).contains(&run.time),
        "{:?} through {:?} ended at {:?}",
        task.method,
        task.times,
        run.time
    );
    if run.end == End::Complete {
        let off = (run.time - last).abs();
        assert!(off <= rounding, "complete, but off by {off:e}: {task:?}");
        assert_eq!(run.samples.len(), task.times.len());
    }
    let forward = last >= first;
    let is_finite = |phase: &Phase| phase.numbers().iter().all(|x| x.is_finite());
    for (&t, sample) in task.times.iter().zip(&run.samples) {
        let is_past = if forward {
            t <= run.time + rounding
        } else {
            t >= run.time - rounding
        };
        assert!(is_finite(sample), "at {t:?} there is {sample:?}");
        assert!(
            is_past,
            "ended at {:?}, but at {t:?} there is a state",
            run.time
        );
        is_unit(&sample.attitude);
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
        for sample in &run.samples {
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
    if let Ok(found) = variations(task, terms, &[], watch) {
        assert_eq!(found.len(), task.times.len());
        let numbers: usize = terms
            .iter()
            .flat_map(Term::parameters)
            .map(|parameter| parameter.count())
            .sum();
        for variation in found {
            assert_eq!(variation.load.len(), numbers);
            assert!(
                variation.state.iter().all(|x| x.is_finite()),
                "{:?} from {:?} at {:?} under {terms:?}",
                variation.state,
                task.initial,
                task.times
            );
        }
    }
}
