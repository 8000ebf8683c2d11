//! Bodies, states and loads of every kind, for the tests of motion.

use nalgebra::{Matrix3, UnitQuaternion, Vector3};
use polhode::RigidBody;
use polhode::motion::loads::schedule::Windows;
use polhode::motion::loads::{
    Damping, Drive, Feedback, Frame, GravityGradient, Magnetic, MagneticField, PiecewiseSignal,
    Rotor, Sampled, Slug, Term, Wheel,
};
use polhode::motion::simulate::{Phase, State};

pub(crate) fn turned(attitude: UnitQuaternion<f64>, omega: Vector3<f64>) -> Phase {
    Phase::in_place(&State { attitude, omega })
}

pub(crate) fn skew() -> UnitQuaternion<f64> {
    UnitQuaternion::from_euler_angles(0.3, -0.5, 1.1)
}

/// An asymmetric body whose axes and centre are askew.
pub(crate) fn asymmetric() -> RigidBody {
    let axes = skew().to_rotation_matrix().into_inner();
    let center = Vector3::new(0.1, -0.2, 0.3);
    RigidBody::from_principal(1.3, &[1.0, 2.0, 2.5], &axes, &center, 0.0).expect("a body")
}

/// A body with these principal moments about the axes of its frame.
pub(crate) fn aligned(moments: [f64; 3]) -> RigidBody {
    let (axes, center) = (Matrix3::identity(), Vector3::zeros());
    RigidBody::from_principal(1.0, &moments, &axes, &center, 0.0).expect("a body")
}

/// What a top under gravity along the third axis of space keeps: its energy and its angular momentum about that axis.
pub(crate) fn kept_by_a_top(body: &RigidBody, gravity: &Vector3<f64>, phase: &Phase) -> [f64; 2] {
    let momentum = body.inertia_about(&Vector3::zeros()) * phase.omega;
    let height = -gravity.dot(&(phase.attitude * body.center_of_mass()));
    let energy = 0.5 * phase.omega.dot(&momentum) + body.mass() * height;
    [energy, (phase.attitude * momentum).z]
}

/// Every kind of term, alone or with others.
pub(crate) fn loads() -> Vec<(&'static str, Vec<Term>)> {
    let v = Vector3::new(0.3, -0.2, 0.5);
    let at = Vector3::new(0.3, 0.1, 0.9);
    let m = Matrix3::new(0.3, 0.05, 0.0, 0.05, 0.4, -0.02, 0.0, -0.02, 0.2);
    let target = UnitQuaternion::from_euler_angles(2.0, 1.0, -2.0);
    let torque = |frame| Term::constant_torque(&v, frame).expect("finite");
    let force = |frame| Term::constant_force(&v, frame, Some(&at)).expect("finite");
    let gravity = Term::uniform_gravity(&Vector3::new(0.1, 0.2, -1.0)).expect("finite");
    let linear = Term::Damping(Damping::new(&m, &Matrix3::zeros()).expect("finite"));
    let quadratic = Term::Damping(Damping::new(&m, &(m * 0.5)).expect("finite"));
    let feedback = Term::Feedback(Feedback::new(&(m * 10.0), &m, &target).expect("finite"));
    let times: Vec<f64> = (-1..=7).map(|k| 1.5 * f64::from(k)).collect();
    let values: Vec<_> = times
        .iter()
        .map(|t| Vector3::new(t.sin(), t.cos(), 0.3 * (2.0 * t).sin()) * 0.5)
        .collect();
    let sampled = |frame| Term::Sampled(Sampled::new(&times, &values, frame).expect("ascending"));
    let field = MagneticField::uniform(&at).expect("finite");
    let magnet = Term::Magnetic(Magnetic::new(&v, None, field).expect("finite"));
    let windows = Windows::new(&[(1.0, 2.0), (3.0, 4.5), (7.0, f64::INFINITY)]).expect("ordered");
    let scheduled = |term: Term| term.schedule(&windows).expect("nothing is carried along");
    let rotor = Term::Rotor(Rotor::new(&v).expect("finite"));
    let slug = Term::Slug(Slug::new(0.2, 0.3).expect("positive"));
    let wheel =
        |drive, friction| Term::Wheel(Wheel::new(&at, 0.2, 3.0, friction, drive).expect("a wheel"));
    let held =
        PiecewiseSignal::table("torque", &[-1.0, 2.0, 5.5], &[0.3, -0.2, 0.4]).expect("ascending");
    let asked = Drive::Feedback(Feedback::new(&(m * 5.0), &m, &target).expect("finite"));
    let speeds =
        PiecewiseSignal::table("speed", &[-1.0, 4.0, 20.0], &[3.0, -1.0, 2.0]).expect("ascending");
    let speed = Drive::Speed(speeds);
    vec![
        ("none", vec![]),
        ("torque in the body", vec![torque(Frame::Body)]),
        ("torque in space", vec![torque(Frame::Space)]),
        ("gravity", vec![gravity.clone()]),
        ("force in space", vec![force(Frame::Space)]),
        ("thrust", vec![force(Frame::Body)]),
        ("two vectors", vec![torque(Frame::Space), gravity.clone()]),
        ("damping", vec![linear]),
        ("quadratic damping", vec![quadratic.clone()]),
        ("feedback", vec![feedback.clone()]),
        ("samples in the body", vec![sampled(Frame::Body)]),
        ("samples in space", vec![sampled(Frame::Space)]),
        ("magnet", vec![magnet]),
        ("schedule", vec![scheduled(torque(Frame::Space))]),
        (
            "all",
            vec![
                gravity,
                quadratic,
                feedback,
                scheduled(sampled(Frame::Space)),
            ],
        ),
        ("rotor", vec![rotor.clone()]),
        ("slug", vec![slug.clone()]),
        ("wheel", vec![wheel(Drive::Torque(held), 0.1)]),
        (
            "wheels",
            vec![wheel(asked, 0.0), slug, wheel(speed, 0.0), rotor],
        ),
    ]
}

/// On an eccentric orbit.
pub(crate) fn gradient() -> Term {
    let (position, velocity) = (Vector3::new(1.0, 0.2, 0.1), Vector3::new(-0.2, 0.9, 0.3));
    Term::GravityGradient(GravityGradient::new(1.0, &position, &velocity, None).expect("an orbit"))
}

/// How far two states are apart, in the largest of angle, ω, position and velocity.
pub(crate) fn apart(a: &Phase, b: &Phase) -> f64 {
    let q = (a.attitude.coords - b.attitude.coords).norm();
    let q = q.min((a.attitude.coords + b.attitude.coords).norm());
    let own = a
        .internal_state
        .iter()
        .zip(&b.internal_state)
        .map(|(a, b)| (a - b).abs());
    [
        2.0 * q,
        (a.omega - b.omega).norm(),
        (a.position - b.position).norm(),
        (a.velocity - b.velocity).norm(),
    ]
    .into_iter()
    .chain(own)
    .fold(0.0, f64::max)
}
