//! Exact free motion: set-up, one state, many states: `cargo bench --bench free_motion`.

use nalgebra::{Matrix3, UnitQuaternion, Vector3};
use polhode::RigidBody;
use polhode::inside::carlson_rf;
use polhode::motion::free::FreeMotion;
use polhode::parallel::{Level, level, set_level};

mod harness;

use harness::{Candidate, compare};

const ROWS: usize = 20_000;

fn main() {
    let best = level();
    let attitude = UnitQuaternion::from_euler_angles(-0.4, 0.8, 1.9);
    let principal = RigidBody::from_principal(
        1.0,
        &[1.0, 2.0, 2.5],
        &Matrix3::identity(),
        &Vector3::zeros(),
        0.0,
    );
    let tensor = Matrix3::new(4.0, -0.5, 0.25, -0.5, 5.0, 0.75, 0.25, 0.75, 6.0);
    let full = RigidBody::new(1.0, &tensor, &Vector3::zeros(), 0.0);
    let (Ok(principal), Ok(full)) = (principal, full) else {
        return;
    };
    let times: Vec<f64> = (0..ROWS).map(|k| 0.37 * k as f64).collect();
    let set_up = |body: &RigidBody, k: usize| {
        let omega = Vector3::new(0.3 + 1e-5 * k as f64, 0.2, 1.1);
        FreeMotion::of(body, &omega, &attitude)
    };
    let mut motions = Vec::with_capacity(ROWS);
    let mut others = Vec::with_capacity(ROWS);
    let mut integrals = vec![0.0; ROWS];
    compare(
        "set-up",
        ROWS,
        vec![
            Candidate::new("one integral R_F", || {
                for (integral, &t) in integrals.iter_mut().zip(&times) {
                    *integral = carlson_rf(t, 1.0, 0.5);
                }
            }),
            Candidate::new("principal moments", || {
                motions.clear();
                motions.extend((0..ROWS).map(|k| set_up(&principal, k)));
            }),
            Candidate::new("full tensor", || {
                others.clear();
                others.extend((0..ROWS).map(|k| set_up(&full, k)));
            }),
        ],
    );

    for (name, omega) in [
        ("circular series", Vector3::new(0.3, 0.2, 1.1)),
        ("hyperbolic series", Vector3::new(1e-4, 1.0, 1e-3)),
    ] {
        let Ok(motion) = FreeMotion::of(&principal, &omega, &attitude) else {
            return;
        };
        let mut states = Vec::with_capacity(ROWS);
        let outputs = std::cell::RefCell::new((vec![[0.0; 4]; ROWS], vec![[0.0; 3]; ROWS]));
        let mut candidates = vec![Candidate::new("one by one", || {
            states.clear();
            states.extend(times.iter().map(|&t| motion.at(t)));
        })];
        for candidate in Level::ALL.into_iter().filter(|level| level.is_available()) {
            let (outputs, motion, times) = (&outputs, &motion, &times);
            candidates.push(Candidate::new(format!("many, {candidate}"), move || {
                set_level(candidate);
                let (attitudes, omegas) = &mut *outputs.borrow_mut();
                motion.sample(times, attitudes, omegas);
                set_level(best);
            }));
        }
        compare(name, ROWS, candidates);
    }
}
