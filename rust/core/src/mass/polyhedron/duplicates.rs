//! Faces that stand twice, found by marks that equal faces share.

use std::convert::Infallible;

use super::boundary::{Bits, Replay, bits, mark};
use crate::error::{Count, MeshFault};
use crate::numerics::reduce::BLOCK;
use crate::numerics::threads::{Halt, Watch, fill_blocks};

/// Marks that are held at a time, eight bytes each.
pub(super) const ROOM: usize = 1 << 23;
/// Repeated marks whose faces are compared corner by corner.
const SUSPECTS: usize = 1 << 16;

/// The marks of some triangles that lie in a range, as many as there is room for.
///
/// Of more triangles than that the range is as wide as it can be, and the marks beyond it are collected by going through
/// the triangles again: any number of them in constant memory.
pub(super) struct Marks {
    list: Vec<u64>,
    from: u64,
    to: u64,
    room: usize,
}

impl Marks {
    /// All of these, whatever room they take.
    pub(super) fn all(list: Vec<u64>) -> Self {
        let room = list.len();
        Self {
            list,
            ..Self::beyond(0, room)
        }
    }

    /// None yet, from this one on.
    pub(super) fn beyond(from: u64, room: usize) -> Self {
        Self {
            list: Vec::new(),
            from,
            to: u64::MAX,
            room,
        }
    }

    /// One more; zero is no mark.
    #[inline(always)]
    pub(super) fn push(&mut self, mark: u64) {
        if mark == 0 || !(self.from..=self.to).contains(&mark) {
            return;
        }
        if self.list.len() == self.room {
            self.narrow();
            if mark > self.to {
                return;
            }
        }
        self.list.push(mark);
    }

    /// Makes room by leaving the upper half of the range for later.
    fn narrow(&mut self) {
        while self.list.len() == self.room && self.to > self.from {
            self.to = self.from + (self.to - self.from) / 2;
            let to = self.to;
            self.list.retain(|&mark| mark <= to);
        }
        // One mark alone fills it: that it repeats is known.
        self.list.truncate(self.room - 1);
    }

    /// Faces that stand twice among all the triangles these marks are the first of.
    pub(super) fn find_duplicates<R: Replay>(
        mut self,
        triangles: &mut R,
    ) -> Result<Option<MeshFault>, R::Error> {
        loop {
            let is_whole = (self.from, self.to) == (0, u64::MAX);
            let repeated = triangles.repeated(&mut self.list)?;
            if let Some(fault) = compare(triangles, &repeated, is_whole)? {
                return Ok(Some(fault));
            }
            let Some(from) = self.to.checked_add(1) else {
                return Ok(None);
            };
            let mut next = Self {
                list: self.list,
                ..Self::beyond(from, self.room)
            };
            next.list.clear();
            triangles.each(&mut |_, triangle| next.push(mark(triangle)))?;
            self = next;
        }
    }
}

/// The first of the faces with these marks that repeat an earlier one.
fn compare<R: Replay>(
    triangles: &mut R,
    repeated: &[u64],
    is_whole: bool,
) -> Result<Option<MeshFault>, R::Error> {
    if repeated.is_empty() {
        return Ok(None);
    }
    let is_least = !is_whole || repeated.len() > SUSPECTS;
    let repeated = &repeated[..SUSPECTS.min(repeated.len())];
    let mut suspects: Vec<([Bits; 3], usize)> = Vec::new();
    triangles.each(&mut |face, triangle| {
        if repeated.binary_search(&mark(triangle)).is_ok() {
            let mut corners = [0, 1, 2].map(|k| bits(&triangle[k]));
            let lowest = (0..3).min_by_key(|&k| corners[k]).unwrap_or(0);
            corners.rotate_left(lowest);
            suspects.push((corners, face));
        }
    })?;
    suspects.sort_unstable();
    let pairs = suspects.windows(2).filter(|pair| pair[0].0 == pair[1].0);
    let seen = pairs.clone().count();
    let first = pairs.map(|pair| (pair[1].1, pair[0].1)).min();
    Ok(first.map(|(second, first)| MeshFault::DuplicateFaces {
        first,
        second,
        count: Count { seen, is_least },
    }))
}

/// Ranges of marks, by their upper bits: each is looked through by itself.
const RANGES: usize = 64;
const RANGE_BITS: u32 = RANGES.trailing_zeros();

/// Some marks, range after range.
struct Part<'a> {
    marks: &'a mut [u64],
    /// Where each range ends.
    ends: [usize; RANGES],
}

impl Part<'_> {
    fn spread(&mut self) {
        let marks = self.marks.to_vec();
        let mut counts = [0; RANGES];
        for &mark in &marks {
            counts[range(mark)] += 1;
        }
        let mut end = 0;
        let mut next = [0; RANGES];
        for ((next, count), last) in next.iter_mut().zip(counts).zip(&mut self.ends) {
            *next = end;
            end += count;
            *last = end;
        }
        for mark in marks {
            let place = &mut next[range(mark)];
            self.marks[*place] = mark;
            *place += 1;
        }
    }

    fn range(&self, index: usize) -> &[u64] {
        let start = index.checked_sub(1).map_or(0, |before| self.ends[before]);
        &self.marks[start..self.ends[index]]
    }
}

fn range(mark: u64) -> usize {
    (mark >> (u64::BITS - RANGE_BITS)) as usize
}

/// The marks that occur more than once, ascending; they are put in another order.
pub(super) fn repeated(
    marks: &mut [u64],
    watch: &mut Watch<'_>,
) -> Result<Vec<u64>, Halt<Infallible>> {
    let mut parts: Vec<Part<'_>> = marks
        .chunks_mut(BLOCK)
        .map(|marks| Part {
            marks,
            ends: [0; RANGES],
        })
        .collect();
    fill_blocks(&mut parts, 8, watch, |_, parts| {
        parts.iter_mut().for_each(Part::spread);
        Ok(())
    })?;
    let mut found = vec![Vec::new(); RANGES];
    fill_blocks(&mut found, 1, watch, |index, found| {
        found[0] = repeated_in(&parts, index);
        Ok(())
    })?;
    Ok(found.concat())
}

/// Those of one range. A bit for each place that a mark is thrown to, and one for each place that was hit again, leave few
/// to be sorted.
fn repeated_in(parts: &[Part<'_>], index: usize) -> Vec<u64> {
    let count: usize = parts.iter().map(|part| part.range(index).len()).sum();
    if count < 2 {
        return Vec::new();
    }
    let places = (16 * count).next_power_of_two().max(64);
    let shift = u64::BITS - places.trailing_zeros();
    #[expect(
        clippy::cast_possible_truncation,
        reason = "below the number of places"
    )]
    let place = |mark: u64| {
        let place = ((mark << RANGE_BITS) >> shift) as usize;
        (place / 64, 1_u64 << (place % 64))
    };
    let mut seen = vec![0_u64; places / 64];
    let mut again = vec![0_u64; places / 64];
    let marks = || parts.iter().flat_map(|part| part.range(index));
    for &mark in marks() {
        let (word, bit) = place(mark);
        again[word] |= seen[word] & bit;
        seen[word] |= bit;
    }
    let mut suspects: Vec<u64> = marks()
        .copied()
        .filter(|&mark| {
            let (word, bit) = place(mark);
            mark != 0 && again[word] & bit != 0
        })
        .collect();
    suspects.sort_unstable();
    let mut repeated: Vec<u64> = suspects
        .windows(2)
        .filter(|pair| pair[0] == pair[1])
        .map(|pair| pair[0])
        .collect();
    repeated.dedup();
    repeated
}

#[cfg(test)]
mod tests {
    use std::ops::ControlFlow;

    use super::super::boundary::Triangle;
    use super::*;

    struct List(Vec<Triangle>);

    impl Replay for List {
        type Error = Halt<Infallible>;

        fn each(&mut self, visit: &mut dyn FnMut(usize, &Triangle)) -> Result<(), Self::Error> {
            self.0.iter().enumerate().for_each(|(i, t)| visit(i, t));
            Ok(())
        }

        fn repeated(&mut self, marks: &mut [u64]) -> Result<Vec<u64>, Self::Error> {
            repeated(marks, &mut |_| ControlFlow::Continue(()))
        }
    }

    /// Triangles none of which stands twice.
    fn fan(count: u32) -> Vec<Triangle> {
        let corner = |k: u32| [f64::from(k), f64::from(k * k), 1.0];
        (0..count)
            .map(|k| [[0.0; 3], corner(k), corner(k + 1)])
            .collect()
    }

    fn found(list: Vec<Triangle>, room: usize) -> Option<MeshFault> {
        let mut marks = Marks::beyond(0, room);
        for triangle in &list {
            marks.push(mark(triangle));
        }
        marks.find_duplicates(&mut List(list)).expect("a list")
    }

    #[test]
    fn they_are_found_whichever_corner_comes_first() {
        let mut list = fan(10_000);
        assert_eq!(found(list.clone(), ROOM), None);
        list.push([2, 0, 1].map(|k| list[700][k]));
        list.push([1, 0, 2].map(|k| list[2][k])); // the other side
        let fault = MeshFault::DuplicateFaces {
            first: 700,
            second: 10_000,
            count: Count {
                seen: 1,
                is_least: false,
            },
        };
        assert_eq!(found(list.clone(), ROOM), Some(fault));
        list.pop();
        list.pop();
        list.extend_from_within(..);
        let Some(MeshFault::DuplicateFaces { count, .. }) = found(list, ROOM) else {
            panic!("expected duplicates");
        };
        assert_eq!(count.seen, 10_000);
    }

    #[test]
    fn little_room_takes_longer_and_finds_the_same() {
        let mut list = fan(3_000);
        assert_eq!(found(list.clone(), 50), None);
        for double in [1, 999, 2_999] {
            list.push(list[double]);
            let Some(MeshFault::DuplicateFaces { first, second, .. }) = found(list.clone(), 50)
            else {
                panic!("expected duplicates");
            };
            assert_eq!((first, second), (double, 3_000));
            list.pop();
        }
        let same = vec![fan(5)[4]; 500];
        assert!(found(same, 50).is_some());
    }

    #[test]
    fn the_last_mark_of_a_range_belongs_to_it() {
        let (middle, mut marks) = (u64::MAX / 2, Marks::beyond(0, 2));
        for mark in [middle, u64::MAX, 1] {
            marks.push(mark);
        }
        assert_eq!((&*marks.list, marks.to), (&[middle, 1][..], middle));
        // What lies beyond is left for later.
        marks.push(middle - 1);
        assert_eq!((&*marks.list, marks.to), (&[1][..], middle / 2));
    }
}
