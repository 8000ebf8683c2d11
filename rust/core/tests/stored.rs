//! Values in JSON and back: the same bits, and nothing that a constructor would refuse.

use std::fmt::Debug;

use polhode::io::TriangleMesh;
use polhode::mass::polyhedron::polyhedron;
use polhode::mass::{Amount, ErrorBound, Provenance, rods, solids};
use polhode::motion::euler_angles::Sequence;
use polhode::motion::free::FreeMotion;
use polhode::motion::loads::{
    ConstantForce, ConstantTorque, Damping, Frame, Rotor, Slug, UniformGravity, Windows,
};
use polhode::motion::simulate::{Crossing, Direction, Effort, Method, Phase, State, Tolerance};
use polhode::nalgebra::{Matrix3, UnitQuaternion, Vector3};
use polhode::principal::Top;
use polhode::{PrincipalAxes, RigidBody};
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::{Value, from_str, from_value, json, to_string, to_value};

fn again<T: Serialize + DeserializeOwned>(value: &T) -> T {
    from_str(&to_string(value).expect("stored")).expect("read")
}

fn kept<T: Serialize + DeserializeOwned + PartialEq + Debug>(value: &T) {
    assert_eq!(&again(value), value);
}

fn refused<T: DeserializeOwned + Debug>(value: Value, words: &str) {
    let told = from_value::<T>(value).expect_err("refused").to_string();
    assert!(told.contains(words), "{told}");
}

fn skew() -> UnitQuaternion<f64> {
    UnitQuaternion::from_euler_angles(0.3, -0.5, 1.1)
}

fn bodies() -> Vec<RigidBody> {
    let density = Amount::Density(2.7);
    let brick = solids::cuboid(&[0.1, 0.2, 0.3], density).expect("a brick");
    let turned = brick
        .rotated(&skew().to_rotation_matrix().into_inner())
        .and_then(|body| body.translated(&Vector3::new(0.1, 1e3, -2.0)))
        .expect("a brick");
    let rod = rods::rod(1.0, density).expect("a rod");
    let (vertices, faces) = corner();
    let tensor = Matrix3::new(1.0, 0.1, 0.0, 0.1, 2.0, -0.3, 0.0, -0.3, 2.5);
    vec![
        brick,
        turned,
        rod,
        polyhedron(&vertices, &faces, density, false).expect("a mesh"),
        RigidBody::new(3.0, &tensor, &Vector3::new(0.0, 1.0, 2.0), 0.0).expect("a tensor"),
        brick.combined(&turned).expect("both"),
        // From tables of few digits: the third moment exceeds the other two.
        RigidBody::new(1.0, &tabled(3.001), &Vector3::zeros(), 1e-3).expect("a table"),
        RigidBody::from_principal(
            1.0,
            &[1.0, 2.0, 3.001],
            &Matrix3::identity(),
            &Vector3::zeros(),
            1e-3,
        )
        .expect("a table"),
    ]
}

fn tabled(largest: f64) -> Matrix3<f64> {
    Matrix3::from_diagonal(&Vector3::new(1.0, 2.0, largest))
}

/// The corner of a cube.
fn corner() -> (Vec<[f64; 3]>, Vec<[usize; 3]>) {
    let vertices = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let faces = vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
    (vertices, faces)
}

#[test]
fn bodies_keep_every_bit() {
    for body in bodies() {
        assert_eq!(again(&body).to_array(), body.to_array(), "{body:?}");
        kept(&body.principal());
        kept(&body.error_bound());
        kept(&body.provenance());
    }
}

#[test]
fn a_body_typed_by_hand_goes_through_its_constructor() {
    let typed =
        |inertia: Value| json!({"mass": 2.0, "center_of_mass": [0, 0, 1], "inertia": inertia});
    let body: RigidBody =
        from_value(typed(json!([[1, 0, 0], [0, 2, 0], [0, 0, 2.5]]))).expect("a body");
    assert_eq!(body.principal().moments, [1.0, 2.0, 2.5]);
    assert_eq!(body.provenance(), bodies()[4].provenance());
    for (inertia, words) in [
        (
            json!([[1, 0, 0], [0, 2, 0], [0, 0, 3.5]]),
            "triangle inequality",
        ),
        (json!([[1, 0, 0], [0, 2, 0], [0, 0, -1]]), "negative"),
        (json!([[1, 0.5, 0], [0, 2, 0], [0, 0, 2.5]]), "symmetric"),
        (json!([[1, 0, 0], [0, 2, 0]]), "length"),
        (json!([[1, 0, 0], [0, null, 0], [0, 0, 2.5]]), "null"),
    ] {
        refused::<RigidBody>(typed(inertia), words);
    }
    let mut massless = typed(json!([[1, 0, 0], [0, 2, 0], [0, 0, 2.5]]));
    massless["mass"] = json!(0.0);
    refused::<RigidBody>(massless.clone(), "mass");
    massless["mass"] = json!(1.0);
    massless["Mass"] = json!(1.0);
    refused::<RigidBody>(massless, "unknown field");
}

#[test]
fn no_body_that_cannot_be_comes_from_a_file() {
    let good = to_value(bodies()[4]).expect("stored");
    let spoilt = |path: &str, value: Value| {
        let mut bad = good.clone();
        *bad.pointer_mut(path).expect(path) = value;
        bad
    };
    for (path, value, words) in [
        ("/mass", json!(-3.0), "mass"),
        ("/mass", json!(null), "null"),
        ("/center_of_mass/1", json!("1"), "string"),
        ("/inertia/0/1", json!(0.2), "symmetric"),
        ("/inertia/0/0", json!(1.5), "inertia"),
        ("/cached/principal/moments/2", json!(9.0), "inertia"),
        ("/cached/principal/moments/0", json!(5.0), "exceed"),
        ("/cached/principal/axes/0/0", json!(3.0), "rotation"),
        (
            "/cached/error_bound/inertia",
            json!(-1.0),
            "error_bound.inertia",
        ),
        ("/cached/provenance/checks/0", json!("holy"), "holy"),
        ("/cached/provenance/source", json!("dream"), "dream"),
        ("/cached/provenance/rounding", json!(-1.0), "rounding"),
    ] {
        refused::<RigidBody>(spoilt(path, value), words);
    }
    // Moments, axes and tensor that agree, and are of no body; those of a table, whose admission was taken away.
    let table = to_value(bodies().pop().expect("a table")).expect("stored");
    assert!(table["rtol"].as_f64() > Some(1e-4));
    let mut bad = table.clone();
    bad["rtol"] = json!(0.0);
    refused::<RigidBody>(bad, "triangle inequality");
    let mut bad = table;
    bad["rtol"] = json!(1.5);
    refused::<RigidBody>(bad, "rtol");
}

#[test]
fn states_and_what_is_asked_of_runs() {
    let state = State {
        attitude: skew(),
        omega: Vector3::new(0.1, -0.2, 1e-300),
    };
    let mut phase = Phase::in_place(&state);
    phase.position = Vector3::new(1.0, 2.0, 0.1 + 0.2);
    phase.internal_state = vec![0.5, -1.0 / 3.0].into();
    kept(&state);
    kept(&phase);
    kept(&Crossing {
        event: 1,
        time: 0.1,
        phase: phase.clone(),
    });
    kept(&Effort {
        steps: u64::MAX,
        evaluations: 0,
    });
    kept(&Tolerance::new(1e-20, 1e-9).expect("a tolerance").within(77));
    for &method in Method::ALL {
        kept(&method);
        assert_eq!(to_value(method).expect("stored"), method.name());
    }
    for direction in [Direction::Any, Direction::Rising, Direction::Falling] {
        kept(&direction);
    }
    for frame in [Frame::Body, Frame::Space] {
        kept(&frame);
    }
    for top in [Top::Spherical, Top::Oblate, Top::Linear, Top::None] {
        kept(&top);
        assert_eq!(to_value(top).expect("stored"), top.as_str());
    }
    for name in ["ZXZ", "xyz", "ZYX"] {
        kept(&name.parse::<Sequence>().expect("a sequence"));
    }

    let mut bad = to_value(state).expect("stored");
    bad["attitude"] = json!([0, 0, 0, 2]);
    refused::<State>(bad.clone(), "unit quaternion");
    bad["attitude"] = json!([0, 0, 0, 0]);
    refused::<State>(bad, "unit quaternion");
    refused::<State>(to_value(State::nan()).expect("stored"), "null");
    refused::<Tolerance>(json!({"relative": 0.5, "absolute": 0}), "rtol");
    refused::<Tolerance>(json!({"relative": 1e-9, "absolute": -1}), "atol");
    refused::<Method>(json!("euler"), "euler");
    refused::<Sequence>(json!("XXZ"), "XXZ");
}

#[test]
fn a_free_motion_is_its_body_and_its_first_state() {
    let body = bodies()[4];
    let motion = FreeMotion::of(&body, &Vector3::new(0.3, 1.0, -0.2), &skew()).expect("a motion");
    kept(&motion.mode);
    let (body, start) = again(&(body, motion.initial));
    let read = FreeMotion::of(&body, &start.omega, &start.attitude).expect("a motion");
    assert_eq!(read, motion);
}

#[test]
fn loads_that_are_plain_numbers() {
    let v = Vector3::new(0.3, -0.2, 0.1 + 0.2);
    let m = Matrix3::new(0.3, 0.05, 0.0, 0.05, 0.4, -0.02, 0.0, -0.02, 0.2);
    for frame in [Frame::Body, Frame::Space] {
        kept(&ConstantTorque::new(&v, frame).expect("finite"));
        kept(&ConstantForce::new(&v, frame, None).expect("finite"));
        kept(&ConstantForce::new(&v, frame, Some(&(v * 2.0))).expect("finite"));
    }
    kept(&UniformGravity::new(&v).expect("finite"));
    kept(&Damping::new(&m, &(m * 0.1)).expect("finite"));
    kept(&Rotor::new(&v).expect("finite"));
    kept(&Slug::new(0.2, 0.3).expect("positive"));
    let endless = [(1.0, 2.0), (3.0, f64::INFINITY)];
    kept(&Windows::new(&endless).expect("ordered"));

    refused::<Slug>(json!({"inertia": 0.0, "damping": 1.0}), "positive");
    refused::<Windows>(json!({"windows": [[3.0, 2.0]]}), "window");
    refused::<Rotor>(json!({"momentum": [0, 0]}), "length");
    refused::<ConstantTorque>(json!({"vector": [0, 0, 1], "frame": "moon"}), "moon");
}

#[test]
fn amounts_and_meshes() {
    kept(&Amount::Mass(0.1));
    kept(&Amount::Density(2700.0));
    let (vertices, faces) = corner();
    kept(&TriangleMesh { vertices, faces });
    kept(&ErrorBound::default());
    kept(&Provenance::default());
    refused::<Amount>(json!({"mass": -1.0}), "mass");
    refused::<Amount>(json!({"mass": 1.0, "density": 1.0}), "");
    refused::<PrincipalAxes>(
        json!({"moments": [1, 2, 3], "axes": [[1, 0, 0], [0, 1, 0], [0, 0, -1]]}),
        "rotation",
    );
}
