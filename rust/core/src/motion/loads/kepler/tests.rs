use super::*;
use crate::motion::loads::stumpff::moved;

type State = (Vector3<f64>, Vector3<f64>);

/// The position at a time, relative to its size.
fn close(orbit: &Orbit, t: f64, position: [f64; 3], allowed: f64) {
    let (r, _) = orbit.at(t);
    let expected = Vector3::from(position);
    assert!(
        (r - expected).norm() < allowed * expected.norm(),
        "{r} {expected}"
    );
}

#[test]
fn circle_at_any_time() {
    let orbit = Orbit::new(1.0, &Vector3::x(), &Vector3::y()).expect("circle");
    for t in [0.1_f64, 1.0, 3.0, -2.0, 1e3, -1e6] {
        close(&orbit, t, [t.cos(), t.sin(), 0.0], 2e-15);
    }
}

#[test]
fn parabola_by_barker_s_equation() {
    // From perihelion q = ½: t = (tan(ν/2) + tan³(ν/2)/3)/2.
    let orbit = Orbit::new(1.0, &(Vector3::x() * 0.5), &(Vector3::y() * 2.0)).expect("orbit");
    for tangent in [0.1_f64, 1.0, 5.0, -3.0, 1e3] {
        let t = 0.5 * (tangent + tangent.powi(3) / 3.0);
        let place = [0.5 * (1.0 - tangent * tangent), tangent, 0.0];
        close(&orbit, t, place, 1e-14);
    }
}

#[test]
fn ellipse_and_hyperbola_from_perihelion() {
    for e in [0.1_f64, 0.7, 0.99, 0.999_999] {
        // a = 1; E − e sin E = t.
        let speed = ((1.0 + e) / (1.0 - e)).sqrt();
        let orbit = Orbit::new(1.0, &(Vector3::x() * (1.0 - e)), &(Vector3::y() * speed));
        let orbit = orbit.expect("ellipse");
        for anomaly in [0.3_f64, 1.5, 3.0, -2.0] {
            let t = anomaly - e * anomaly.sin();
            let place = [
                anomaly.cos() - e,
                ((1.0 - e) * (1.0 + e)).sqrt() * anomaly.sin(),
                0.0,
            ];
            // The semi-axis is known to ε/(1 − e) from the rounded speed.
            close(&orbit, t, place, 4e-15 / (1.0 - e));
        }
    }
    for e in [1.01_f64, 2.0, 30.0] {
        let speed = ((e + 1.0) / (e - 1.0)).sqrt();
        let orbit = Orbit::new(1.0, &(Vector3::x() * (e - 1.0)), &(Vector3::y() * speed));
        let orbit = orbit.expect("hyperbola");
        for anomaly in [0.2_f64, 2.0, -5.0, 20.0] {
            let t = e * anomaly.sinh() - anomaly;
            let place = [
                e - anomaly.cosh(),
                ((e - 1.0) * (e + 1.0)).sqrt() * anomaly.sinh(),
                0.0,
            ];
            close(&orbit, t, place, 3e-14);
        }
    }
}

#[test]
fn there_and_back_at_all_scales() {
    for (length, mu) in [(7e6_f64, 3.986_004_418e14), (1e-10, 1e-40), (1e20, 1e31)] {
        let speed = (mu / length).sqrt();
        let r = Vector3::new(0.6, -0.3, 0.9) * length;
        let v = Vector3::new(0.3, 0.9, 0.2) * speed;
        let there = Orbit::new(mu, &r, &v).expect("orbit");
        for turns in [0.3, 17.4, -80.0] {
            let t = turns * length / speed;
            let (r_then, v_then) = there.at(t);
            let energy = |r: &Vector3<f64>, v: &Vector3<f64>| 0.5 * v.dot(v) - mu / r.norm();
            let (before, after) = (energy(&r, &v), energy(&r_then, &v_then));
            assert!((after - before).abs() < 1e-14 * speed * speed);
            let back = Orbit::new(mu, &r_then, &v_then).expect("orbit").at(-t).0;
            assert!((back - r).norm() < 1e-12 * length, "{turns} {back} {r}");
        }
    }
    assert!(Orbit::new(1.0, &Vector3::x(), &Vector3::x()).is_err());
    assert!(Orbit::new(0.0, &Vector3::x(), &Vector3::y()).is_err());
    assert!(Orbit::new(1.0, &Vector3::zeros(), &Vector3::y()).is_err());
}

#[test]
fn functions_after_a_small_step_follow_from_those_before() {
    for beta in [1.7_f64, -1.7, 1e-9, 0.0] {
        for s in [0.3, -2.0, 7.0] {
            let before = functions(beta, s);
            // To the largest step for which they are taken from there, in units of 1/√|β|.
            for part in [1e-9, -1e-6, 0.99e-4, -0.99e-4] {
                let h = part / beta.abs().sqrt().max(0.1);
                let (found, exact) = (moved(&before, beta, h), functions(beta, s + h));
                let size = exact.iter().fold(1.0_f64, |most, x| most.max(x.abs()));
                for k in 0..4 {
                    assert!(
                        (found[k] - exact[k]).abs() < 4e-15 * size,
                        "{beta} {s} {h} {k}"
                    );
                }
            }
        }
    }
}

#[test]
fn derivatives_are_those_of_neighbours() {
    let cases = [
        // An ellipse at either side of where the series of G₄ and G₅ end, and revolutions later; a hyperbola; a parabola.
        ([1.0, 0.2, -0.1], [0.1, 0.9, 0.3], [0.4, 2.5, -1.5, 60.0]),
        ([1.0, 0.2, -0.1], [0.5, 1.6, 0.3], [0.4, 2.5, -9.0, 60.0]),
        ([0.5, 0.0, 0.0], [0.0, 2.0, 0.0], [0.4, 2.5, -9.0, 60.0]),
    ];
    for (position, velocity, times) in cases {
        let numbers = |shift: f64, column: usize| {
            let mut x = [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
            x[1..4].copy_from_slice(&position);
            x[4..].copy_from_slice(&velocity);
            x[column] += shift;
            x
        };
        let orbit = |[mu, a, b, c, u, v, w]: [f64; 7]| {
            Orbit::new(mu, &Vector3::new(a, b, c), &Vector3::new(u, v, w)).expect("orbit")
        };
        for t in times {
            let (r, v) = orbit(numbers(0.0, 0)).varied::<7>(t, Jet::variable);
            let (r0, v0) = orbit(numbers(0.0, 0)).at(t);
            assert!((r.map(|x| x.value) - r0).norm() < 1e-13 * r0.norm());
            assert!((v.map(|x| x.value) - v0).norm() < 1e-13 * v0.norm());
            for column in 0..7 {
                // Differences of fourth order.
                let h = 2e-3 / (1.0 + t.abs());
                let at = |shift| orbit(numbers(shift, column)).at(t);
                let ends = [at(h), at(-h), at(2.0 * h), at(-2.0 * h)];
                let slope = |pick: fn(&State) -> Vector3<f64>| {
                    let [a, b, c, d] = ends.each_ref().map(pick);
                    ((a - b) * 8.0 - (c - d)) / (12.0 * h)
                };
                for (own, slope) in [(r, slope(|state| state.0)), (v, slope(|state| state.1))] {
                    let error = (own.map(|x| x.slopes[column]) - slope).norm();
                    assert!(error < 1e-5 * (1.0 + slope.norm()), "{t} {column}");
                }
            }
        }
    }
}

#[test]
fn a_state_is_known_up_to_the_reach_and_beyond_it_to_nobody() {
    let orbit =
        |speed: f64| Orbit::new(1.0, &Vector3::x(), &(Vector3::y() * speed)).expect("orbit");
    for speed in [1.0, 1.3, 1.41, 2.0_f64.sqrt(), 1.5] {
        let one = orbit(speed);
        let reach = one.reach * one.time;
        for sense in [1.0, -1.0] {
            assert!(one.check(sense * reach).is_ok());
            assert!(one.check(sense * reach.next_up()).is_err());
            let (r, v) = one.at(sense * reach);
            assert!(
                r.iter().chain(&v).all(|x| x.is_finite()),
                "{speed}: {r} {v}"
            );
            // The energy shows whether the state is one of the orbit, wherever on it.
            let energy = 0.5 * v.norm_squared() - 1.0 / r.norm();
            assert!(
                (energy - 0.5 * speed * speed + 1.0).abs() < 1e-13,
                "{speed} {energy}"
            );
        }
        assert!(one.check(f64::INFINITY).is_ok() && one.check(f64::NAN).is_ok());
    }
    // A circle: 2⁸⁸ revolutions.
    let turns = orbit(1.0).reach * orbit(1.0).time / orbit(1.0).period();
    assert!((turns / 2.0_f64.powi(88) - 1.0).abs() < 0.01, "{turns:e}");
}
