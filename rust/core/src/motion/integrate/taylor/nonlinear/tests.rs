//! What rows have of orbits, looked up and put down.

use super::*;
use crate::motion::integrate::taylor::gravity_gradient::INITIAL_NUMBERS;
use crate::motion::integrate::taylor::orbit_cache::ENTRIES;
use crate::numerics::lane::Double;

type Pair = Batch<Double<false>, 2>;
const ORDER: usize = 6;

/// Places on one shelf: as many as it has pages, and one more.
fn neighbours() -> Vec<CacheKey> {
    let key = |k: u32| CacheKey {
        when: [f64::from(k).to_bits(), 0, 0],
        terms: (4096, 1),
    };
    let (_, bucket) = key(0).hash();
    let in_the_bucket = (0..).map(key).filter(|it| it.hash().1 == bucket);
    in_the_bucket.take(ENTRIES + 1).collect()
}

/// An orbit of its own for each number.
fn orbit(number: usize) -> [f64; INITIAL_NUMBERS] {
    let x = 0.125 * (1 + number) as f64;
    [0.1, 0.2, 0.3, 0.9, x, 2.0 * x, 3.0 * x, 4.0 * x]
}

/// What one row has of its orbit.
fn orbit_numbers(nonlinear: &mut NonlinearTerms<Pair>, row: usize) -> (Vec<f64>, Vec<f64>) {
    let gradient = &mut nonlinear.gradients[0];
    let initial_numbers = gradient.initial_numbers(row).to_vec();
    let half_turn = gradient.orbit().half_turn()[..ORDER].iter().flatten();
    let half_turn = half_turn.map(|x| x.get(row)).collect();
    (initial_numbers, half_turn)
}

/// A row finds an orbit and puts it down on a full shelf, in the place of the page that the row beside it is to read in the same
/// step, whichever of the two comes first.
#[test]
fn pages_are_read_before_one_is_put_down() {
    let (keys, new) = (neighbours(), ENTRIES);
    let one_gradient = Parts {
        gradients: 1,
        ..Parts::default()
    };
    for seeker in 0..2 {
        let reader = 1 - seeker;
        let mut displaced = 0;
        for entry in 0..ENTRIES {
            let mut nonlinear = NonlinearTerms::<Pair>::new(&one_gradient);
            let mut expected = Vec::new();
            for (number, key) in keys[..ENTRIES].iter().enumerate() {
                // Neither row finds it: both seek it, and put it down with the same numbers.
                for row in 0..2 {
                    assert!(!nonlinear.look_up(row, || (*key, 1.0)));
                    nonlinear.gradients[0].restore(row, orbit(number));
                }
                nonlinear.expand(ORDER);
                expected.push(orbit_numbers(&mut nonlinear, reader));
            }
            assert!(!nonlinear.look_up(seeker, || (keys[new], 1.0)));
            nonlinear.gradients[0].restore(seeker, orbit(new));
            assert!(nonlinear.look_up(reader, || (keys[entry], 1.0)));
            nonlinear.expand(ORDER);
            assert_eq!(
                orbit_numbers(&mut nonlinear, reader),
                expected[entry],
                "entry {entry}"
            );
            assert_eq!(
                orbit_numbers(&mut nonlinear, seeker).0,
                orbit(new),
                "entry {entry}"
            );
            // The new page is there, and the page that was read may be gone.
            assert!(nonlinear.look_up(seeker, || (keys[new], 1.0)));
            displaced += usize::from(!nonlinear.look_up(reader, || (keys[entry], 1.0)));
        }
        assert_eq!(displaced, 1, "the entry that was read was never displaced");
    }
}

/// A law that sees space beside the orbit has the series in N; the attitude goes to the orbit's frame and back.
#[test]
fn series_are_seen_from_the_orbit_if_nothing_else_sees_space() {
    let alone = Parts {
        gradients: 1,
        on_omega: true,
        quadratic: true,
        ..Parts::default()
    };
    let others = [
        Parts {
            gradients: 2,
            ..alone
        },
        Parts {
            directions: 1,
            ..alone
        },
        Parts {
            on_attitude: true,
            ..alone
        },
        Parts {
            is_pushed: true,
            ..alone
        },
        Parts {
            is_timed: true,
            ..alone
        },
        Parts { own: 1, ..alone },
        Parts {
            gradients: 0,
            ..alone
        },
    ];
    let q = [0.5, -0.1, 0.7, 0.5];
    let attitude = q.map(Pair::new);
    let get = |q: [Pair; 4]| q.map(|x| x.get(0));
    for parts in others {
        let nonlinear = NonlinearTerms::<Pair>::new(&parts);
        assert_eq!(get(nonlinear.initial_attitude(attitude)), q, "{parts:?}");
        assert_eq!(get(nonlinear.to_space(attitude)), q, "{parts:?}");
    }
    let mut nonlinear = NonlinearTerms::<Pair>::new(&alone);
    // Twice a right angle about (1, 1, 0) takes x to y, y to x and z to −z.
    let half = 0.5_f64.sqrt();
    nonlinear.gradients[0].restore(0, [half, half, 0.0, 0.0, 0.1, 0.2, 0.3, 0.4]);
    let begun = get(nonlinear.initial_attitude(attitude));
    // −(1, 1, 0)/√2 times q.
    let expected = [-1.2, 0.2, 0.6, 0.4].map(|x: f64| x * half);
    let back = get(nonlinear.to_space(nonlinear.initial_attitude(attitude)));
    for i in 0..4 {
        assert!((begun[i] - expected[i]).abs() < 1e-15, "{begun:?}");
        assert!((back[i] - q[i]).abs() < 1e-15, "{back:?}");
    }
}
