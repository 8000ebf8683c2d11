//! A harness for ratios: the candidates take turns, round by round, so that whatever else the machine does meets all of
//! them, and what is judged is the median of a candidate's time over the reference's in the same round.

use std::time::Instant;

/// Rounds of which the median is taken.
const ROUNDS: usize = 15;

/// A piece of work to time.
pub(crate) struct Candidate<'a> {
    pub(crate) name: String,
    pub(crate) work: Box<dyn FnMut() + 'a>,
}

impl<'a> Candidate<'a> {
    pub(crate) fn new(name: impl Into<String>, work: impl FnMut() + 'a) -> Self {
        Self {
            name: name.into(),
            work: Box::new(work),
        }
    }
}

/// Times the candidates against the first one and prints a table: nanoseconds for each of `rows` rows (median, and the
/// range of the middle half), and how many times faster than the first.
pub(crate) fn compare(title: &str, rows: usize, mut candidates: Vec<Candidate<'_>>) {
    let mut times = vec![Vec::with_capacity(ROUNDS); candidates.len()];
    for candidate in &mut candidates {
        (candidate.work)();
    }
    for _ in 0..ROUNDS {
        for (candidate, times) in candidates.iter_mut().zip(&mut times) {
            let start = Instant::now();
            (candidate.work)();
            times.push(start.elapsed().as_secs_f64() * 1e9 / rows as f64);
        }
    }
    println!(
        "{title}\n{:>32} {:>10} {:>17} {:>9}",
        "", "ns/row", "middle half", "faster"
    );
    for (candidate, own) in candidates.iter().zip(&times) {
        let mut ratios: Vec<f64> = times[0]
            .iter()
            .zip(own)
            .map(|(first, own)| first / own)
            .collect();
        let mut own = own.clone();
        own.sort_by(f64::total_cmp);
        ratios.sort_by(f64::total_cmp);
        println!(
            "{:>32} {:>10.1} {:>8.1}-{:<8.1} {:>8.1}x",
            candidate.name,
            own[ROUNDS / 2],
            own[ROUNDS / 4],
            own[ROUNDS - 1 - ROUNDS / 4],
            ratios[ROUNDS / 2]
        );
    }
}
