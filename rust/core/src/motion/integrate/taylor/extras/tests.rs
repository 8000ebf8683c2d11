//! What rows have of orbits, looked up and put down.

use super::*;
use crate::motion::integrate::taylor::almanac::PAGES;
use crate::motion::integrate::taylor::gradient::AT_START;
use crate::numerics::lane::Double;

type Pair = Pack<Double<false>, 2>;
const ORDER: usize = 6;

/// Places on one shelf: as many as it has pages, and one more.
fn neighbours() -> Vec<Place> {
    let place = |k: u32| Place {
        when: [f64::from(k).to_bits(), 0, 0],
        terms: (4096, 1),
    };
    let (_, shelf) = place(0).mark();
    let on_the_shelf = (0..).map(place).filter(|it| it.mark().1 == shelf);
    on_the_shelf.take(PAGES + 1).collect()
}

/// An orbit of its own for each number.
fn orbit(number: usize) -> [f64; AT_START] {
    let x = 0.125 * (1 + number) as f64;
    [0.1, 0.2, 0.3, 0.9, x, 2.0 * x, 3.0 * x, 4.0 * x]
}

/// What one row has of its orbit.
fn begun(extras: &mut Extras<Pair>, row: usize) -> (Vec<f64>, Vec<f64>) {
    let gradient = &mut extras.gradients[0];
    let at_start = gradient.at_start(row).to_vec();
    let half_turn = gradient.orbit().half_turn()[..ORDER].iter().flatten();
    let half_turn = half_turn.map(|x| x.get(row)).collect();
    (at_start, half_turn)
}

/// A row finds an orbit and puts it down on a full shelf, in the place of the page that the row beside it is to read in the same
/// step, whichever of the two comes first.
#[test]
fn pages_are_read_before_one_is_put_down() {
    let (places, new) = (neighbours(), PAGES);
    let one_gradient = SeriesStructure {
        gradients: 1,
        ..SeriesStructure::default()
    };
    for seeker in 0..2 {
        let reader = 1 - seeker;
        let mut displaced = 0;
        for page in 0..PAGES {
            let mut extras = Extras::<Pair>::new(&one_gradient);
            let mut expected = Vec::new();
            for (number, place) in places[..PAGES].iter().enumerate() {
                // Neither row finds it: both seek it, and put it down with the same numbers.
                for row in 0..2 {
                    assert!(!extras.recall(row, || (*place, 1.0)));
                    extras.gradients[0].start_at(row, orbit(number));
                }
                extras.expand(ORDER);
                expected.push(begun(&mut extras, reader));
            }
            assert!(!extras.recall(seeker, || (places[new], 1.0)));
            extras.gradients[0].start_at(seeker, orbit(new));
            assert!(extras.recall(reader, || (places[page], 1.0)));
            extras.expand(ORDER);
            assert_eq!(begun(&mut extras, reader), expected[page], "page {page}");
            assert_eq!(begun(&mut extras, seeker).0, orbit(new), "page {page}");
            // The new page is there, and the page that was read may be gone.
            assert!(extras.recall(seeker, || (places[new], 1.0)));
            displaced += usize::from(!extras.recall(reader, || (places[page], 1.0)));
        }
        assert_eq!(displaced, 1, "the page that was read was never displaced");
    }
}

/// A law that sees space beside the orbit has the series in N; the attitude goes to the orbit's frame and back.
#[test]
fn series_are_seen_from_the_orbit_if_nothing_else_sees_space() {
    let alone = SeriesStructure {
        gradients: 1,
        on_omega: true,
        quadratic: true,
        ..SeriesStructure::default()
    };
    let besides = [
        SeriesStructure {
            gradients: 2,
            ..alone
        },
        SeriesStructure {
            directions: 1,
            ..alone
        },
        SeriesStructure {
            on_attitude: true,
            ..alone
        },
        SeriesStructure {
            is_pushed: true,
            ..alone
        },
        SeriesStructure {
            is_timed: true,
            ..alone
        },
        SeriesStructure {
            internal_states: 1,
            ..alone
        },
        SeriesStructure {
            gradients: 0,
            ..alone
        },
    ];
    let q = [0.5, -0.1, 0.7, 0.5];
    let attitude = q.map(Pair::new);
    let get = |q: [Pair; 4]| q.map(|x| x.get(0));
    for parts in besides {
        let extras = Extras::<Pair>::new(&parts);
        assert_eq!(get(extras.begun(attitude)), q, "{parts:?}");
        assert_eq!(get(extras.in_space(attitude)), q, "{parts:?}");
    }
    let mut extras = Extras::<Pair>::new(&alone);
    // Twice a right angle about (1, 1, 0) takes x to y, y to x and z to −z.
    let half = 0.5_f64.sqrt();
    extras.gradients[0].start_at(0, [half, half, 0.0, 0.0, 0.1, 0.2, 0.3, 0.4]);
    let begun = get(extras.begun(attitude));
    // −(1, 1, 0)/√2 times q.
    let expected = [-1.2, 0.2, 0.6, 0.4].map(|x: f64| x * half);
    let back = get(extras.in_space(extras.begun(attitude)));
    for i in 0..4 {
        assert!((begun[i] - expected[i]).abs() < 1e-15, "{begun:?}");
        assert!((back[i] - q[i]).abs() < 1e-15, "{back:?}");
    }
}
