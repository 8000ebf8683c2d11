//! What runs refuse, how they end, and loads that are closures.

use crate::watch::go_on;
use std::error::Error as _;
use std::ops::ControlFlow;

use polhode::error::MotionFault;
use polhode::io::stl::{self, StlStream};
use polhode::mass::polyhedron::stream::StreamError;
use polhode::motion::integrate::taylor::{solve_many, solve_one};
use polhode::motion::integrate::variation::variations;
use polhode::motion::loads::{Analytic, Callback, Frame, Term, Wrench};
use polhode::motion::simulate::{
    End, Method, NoEvents, Phase, Run, State, Task, Tolerance, simulate,
};
use polhode::nalgebra::{Matrix3, UnitQuaternion, Vector3};
use polhode::{Error, RigidBody};

fn body() -> RigidBody {
    let (moments, centre) = ([1.0, 2.0, 2.5], Vector3::zeros());
    RigidBody::from_principal(2.0, &moments, &Matrix3::identity(), &centre, 0.0).expect("a body")
}

fn start() -> Phase {
    Phase::in_place(&State {
        attitude: UnitQuaternion::identity(),
        omega: Vector3::new(0.3, 1.0, -0.2),
    })
}

fn task<'a>(body: &'a RigidBody, from: Phase, times: &'a [f64], method: Method) -> Task<'a> {
    let tolerance = Tolerance::new(1e-10, 0.0).expect("a tolerance");
    Task::free(body, from, times, method, tolerance)
}

fn free(task: &Task<'_>) -> Run<Error> {
    let mut none = Analytic::new(&[], task.body_at_point);
    simulate(task, &mut none, &mut NoEvents::new(), &mut go_on)
}

#[test]
fn times_that_do_not_run_one_way_are_an_error_of_every_method() {
    let body = body();
    let bad: [&[f64]; 7] = [
        &[],
        &[0.0, 2.0, 1.0],
        &[0.0, f64::NAN, 3.0],
        &[0.0, 1.0, 1.0],
        &[f64::INFINITY],
        &[-1e308, 1e308],
        &[0.0, -1.0, -0.5],
    ];
    for times in bad {
        for &method in Method::ALL {
            let task = task(&body, start(), times, method);
            let run = free(&task);
            assert!(matches!(run.end, End::Failed(_)), "{method:?} {times:?}");
            assert_eq!(run.samples.len(), times.len().min(1));
            assert!(run.into_result().is_err());
            let series = solve_one(&task, &[], &mut go_on);
            assert!(matches!(series.end, End::Failed(_)), "{times:?}");
            let mut many: [Option<Run<Error>>; 5] = Default::default();
            solve_many(&|_| task.clone(), &|_| &[], &mut many, &|_| go_on(0.0));
            let all_failed = (many.iter().flatten()).all(|run| matches!(run.end, End::Failed(_)));
            assert!(all_failed && many.iter().all(Option::is_some), "{times:?}");
            assert!(
                variations(&task, &[], &[], &mut go_on).is_err(),
                "{times:?}"
            );
        }
    }
    let unsorted = free(&task(&body, start(), &[0.0, 2.0, 1.0], Method::Dop853)).into_result();
    let Err(Error::Motion(MotionFault::NotMonotone { index, .. })) = unsorted else {
        panic!("{unsorted:?}");
    };
    assert_eq!(index, 2);
    for times in [&[3.0][..], &[0.0, 1.0, 4.0], &[0.0, -1.0]] {
        for &method in Method::ALL {
            let run = free(&task(&body, start(), times, method))
                .into_result()
                .expect("good times");
            assert!(run.samples.iter().all(Phase::is_finite));
        }
    }
}

#[test]
fn a_state_that_is_no_number_is_an_error() {
    let body = body();
    let mut bad = [start(), start(), start()];
    bad[0].omega.y = f64::NAN;
    bad[1].position.x = f64::INFINITY;
    bad[2].velocity.z = f64::NAN;
    for (phase, what) in bad.into_iter().zip(["omega", "position", "velocity"]) {
        for &method in Method::ALL {
            let run = free(&task(&body, phase.clone(), &[0.0, 1.0], method));
            assert!(
                matches!(run.end, End::Failed(Error::NonFinite { what: named, .. }) if named == what),
                "{method:?} {:?}",
                run.end
            );
        }
    }
}

#[test]
fn a_run_becomes_a_result() {
    let body = body();
    let task = task(&body, start(), &[0.0, 5.0], Method::Dop853);
    assert!(free(&task).into_result().is_ok());
    let mut none = Analytic::new(&[], task.body_at_point);
    let stopped = simulate(&task, &mut none, &mut NoEvents::new(), &mut |_| {
        ControlFlow::Break(())
    });
    assert!(matches!(stopped.into_result(), Err(Error::Stopped)));
    let failing = Callback::torque(|t, _: &Phase| {
        if t > 1.0 {
            Err(Error::Empty { what: "torque" })
        } else {
            Ok(Vector3::zeros())
        }
    });
    let run = simulate(&task, &mut { failing }, &mut NoEvents::new(), &mut go_on);
    assert_eq!(run.into_result(), Err(Error::Empty { what: "torque" }));
}

#[test]
fn a_closure_is_the_term_that_it_writes_down() {
    let (body, weight) = (body(), Vector3::new(0.0, 0.0, -9.8));
    let (torque, centre) = (Vector3::new(0.2, 0.1, -0.3), body.center_of_mass());
    assert_eq!(centre, Vector3::zeros());
    let terms = [
        Term::constant_torque(&torque, Frame::Body).expect("finite"),
        Term::uniform_gravity(&weight).expect("finite"),
    ];
    for method in [Method::Dop853, Method::Radau, Method::Splitting] {
        let task = task(&body, start(), &[0.0, 2.0], method);
        let mut analytic = Analytic::new(&terms, task.body_at_point);
        let known = simulate(&task, &mut analytic, &mut NoEvents::new(), &mut go_on);
        let load = Callback::wrench(|_, _: &Phase| {
            Ok::<_, Error>(Wrench {
                force: weight * 2.0,
                torque,
            })
        });
        let mut load = load.independent_of_rates();
        let run = simulate(&task, &mut load, &mut NoEvents::new(), &mut go_on);
        let (run, known) = (run.into_result(), known.into_result());
        let (run, known) = (run.expect("goes on").phase, known.expect("goes on").phase);
        assert!((run.omega - known.omega).norm() < 1e-9, "{method:?}");
        assert!((run.position - Vector3::z() * -19.6).norm() < 1e-9);
    }
}

#[test]
fn a_break_keeps_the_digits_of_a_torque_that_jumps() {
    let body = body();
    let still = Phase::in_place(&State {
        attitude: UnitQuaternion::identity(),
        omega: Vector3::zeros(),
    });
    let task = task(&body, still, &[0.0, 2.0], Method::Dop853);
    let on = |t: f64, _: &Phase| Ok::<_, Error>(Vector3::z() * if t < 1.25 { 1.0 } else { 0.0 });
    let mut steps = [0, 0];
    for (k, load) in [
        Callback::torque(on),
        Callback::torque(on).with_breaks(&[1.25, 7.0]),
    ]
    .iter_mut()
    .enumerate()
    {
        let run = simulate(&task, load, &mut NoEvents::new(), &mut go_on)
            .into_result()
            .expect("goes on");
        steps[k] = run.effort.steps;
        assert!((run.phase.omega.z - 0.5).abs() < 1e-9);
    }
    assert!(steps[1] < steps[0], "{steps:?}");
}

#[test]
fn errors_of_files_are_errors_of_rust() {
    let folder = std::env::temp_dir().join(format!("polhode-runs-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    let path = folder.join("one.stl");
    let gone = stl::read_file(&path).expect_err("is not there");
    assert!(matches!(gone, StreamError::Io(_)) && gone.source().is_some());
    assert!(StlStream::open(&path).is_err());
    let mut bytes = vec![b' '; 80];
    bytes.extend(1_u32.to_le_bytes());
    bytes.extend([0; 12]);
    for x in [0.0_f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0] {
        bytes.extend(x.to_le_bytes());
    }
    bytes.extend([0; 2]);
    std::fs::write(&path, &bytes).expect("written");
    assert_eq!(stl::read_file(&path).expect("an STL").faces, [[0, 1, 2]]);
    assert!(StlStream::open(&path).is_ok());
    bytes.push(0);
    std::fs::write(&path, &bytes).expect("written");
    let longer: Box<dyn std::error::Error> = stl::read_file(&path).expect_err("too long").into();
    assert!(longer.to_string().contains("135"), "{longer}");
    std::fs::remove_dir_all(&folder).expect("removed");
}
