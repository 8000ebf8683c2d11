//! Whether triangles bound a solid: every edge must be run along as often one way as the other.
//!
//! Every corner is thrown to a random place in a plane, equal corners to the same place. The signed area of a triangle
//! there is the sum over its edges of `p × q/2`, which changes sign with the direction of the edge: so the areas of all
//! triangles add up to zero when the edges cancel, and, but for a chance below 2⁻¹⁰⁰, only then. Two planes of integers
//! modulo 2⁶⁴ make 128 bits in all; one sum suffices for a mesh of any size. Only when it is not zero are the triangles
//! gone through again, to find the edge.

use std::collections::HashSet;
use std::convert::Infallible;
use std::hash::{BuildHasher, RandomState};
use std::sync::LazyLock;

use crate::error::{Count, MeshFault};
use crate::numerics::threads::{Halt, Watch, fill_blocks};
use crate::numerics::tree_sum::BLOCK;

/// The three corners of a triangle.
pub(super) type Triangle = [[f64; 3]; 3];

/// What every place depends on: drawn once for each process, so that no file can be made to fit it.
static KEY: LazyLock<[u64; 12]> = LazyLock::new(|| {
    let state = RandomState::new();
    std::array::from_fn(|k| state.hash_one(k))
});

/// A corner as bits; equal numbers have equal bits (−0 is +0).
pub(super) type Bits = [u64; 3];

#[inline(always)]
pub(super) fn bits(corner: &[f64; 3]) -> Bits {
    corner.map(|x| (x + 0.0).to_bits())
}

/// The upper half of a product folded onto the lower one.
#[inline(always)]
#[expect(clippy::cast_possible_truncation, reason = "the two halves")]
fn fold(a: u64, b: u64) -> u64 {
    let product = u128::from(a) * u128::from(b);
    product as u64 ^ (product >> 64) as u64
}

/// Where a corner is thrown, in two planes.
#[inline(always)]
fn place(key: &[u64; 12], [x, y, z]: Bits) -> [[u64; 2]; 2] {
    let a = fold(x ^ key[0], y ^ key[1]);
    let b = fold(y ^ key[2], z ^ key[3]);
    let c = fold(z ^ key[4], x ^ key[5]);
    [
        [fold(a ^ key[6], b ^ key[7]), fold(b ^ key[8], c ^ key[9])],
        [fold(c ^ key[10], a ^ key[11]), fold(a ^ key[8], c ^ key[7])],
    ]
}

/// Twice the signed area of a triangle in each plane: the same for whichever corner comes first, the opposite when it is
/// turned over.
#[inline(always)]
fn areas(key: &[u64; 12], triangle: &Triangle) -> [u64; 2] {
    let corner = |k: usize| place(key, bits(&triangle[k]));
    let [a, b, c] = [corner(0), corner(1), corner(2)];
    let area = |plane: usize| {
        let ([a, b, c], sub) = ([a[plane], b[plane], c[plane]], u64::wrapping_sub);
        let (e, f) = (
            [sub(b[0], a[0]), sub(b[1], a[1])],
            [sub(c[0], a[0]), sub(c[1], a[1])],
        );
        sub(e[0].wrapping_mul(f[1]), e[1].wrapping_mul(f[0]))
    };
    [area(0), area(1)]
}

/// The mark of a triangle that [`Boundary::of`] gives.
pub(super) fn mark(triangle: &Triangle) -> u64 {
    areas(&KEY, triangle)[0]
}

/// The mark of a corner: equal corners have the same.
pub(super) fn mark_of(corner: &[f64; 3]) -> u64 {
    place(&KEY, bits(corner))[0][0]
}

/// The sum of the areas of some triangles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Boundary([u64; 2]);

impl Boundary {
    /// Of these triangles; a mark of each goes to `marks`, the same for the same triangle seen from the same side, zero
    /// for one that has no three corners.
    #[inline(always)]
    pub(super) fn of(
        triangles: impl Iterator<Item = Triangle>,
        mut marks: impl FnMut(u64),
    ) -> Self {
        let key = &*KEY;
        let mut sum = Self::default();
        for triangle in triangles {
            let areas = areas(key, &triangle);
            marks(areas[0]);
            sum = sum.and(Self(areas));
        }
        sum
    }

    /// Of both together.
    #[inline(always)]
    pub(super) fn and(self, other: Self) -> Self {
        let sum = |k: usize| self.0[k].wrapping_add(other.0[k]);
        Self([sum(0), sum(1)])
    }

    /// Whether every edge is run along as often one way as the other.
    pub(super) fn is_closed(self) -> bool {
        self.0 == [0, 0]
    }
}

/// Goes through the triangles in order, each with its number, as often as asked.
pub(super) trait Replay {
    /// What can go wrong on the way.
    type Error;
    /// Once through.
    fn each(&mut self, visit: &mut dyn FnMut(usize, &Triangle)) -> Result<(), Self::Error>;
    /// [`find_repeats`], watched as everything else is.
    fn find_repeats(&mut self, marks: &mut [u64]) -> Result<Vec<u64>, Self::Error>;
}

/// An edge that is run along more often one way than the other.
pub(super) struct UnbalancedEdge {
    /// A face that runs along it the more frequent way.
    pub(super) face: usize,
    /// Another one, where the edge has no open side.
    pub(super) second: Option<usize>,
    /// Where it starts and ends.
    pub(super) ends: [[f64; 3]; 2],
    /// How many there are.
    pub(super) count: Count,
}

/// One run along an edge: its lower and higher end, whether upward, and the face.
type EdgeRun = (Bits, Bits, bool, usize);

/// Sums of runs that the edges are spread over.
const BUCKETS: usize = 1 << 16;

/// Runs that are looked at one by one.
const RUNS: usize = 1 << 20;

/// The edge that keeps the triangles from being closed, an open one if there is any, of the first face that has one.
///
/// In memory for a million runs: one time through tells which of 65536 groups of edges are unbalanced, another one
/// collects the runs in them.
pub(super) fn find_unbalanced<R: Replay>(
    triangles: &mut R,
) -> Result<Option<UnbalancedEdge>, R::Error> {
    let mut sums = vec![0_u64; BUCKETS];
    let mut sizes = vec![0_usize; BUCKETS];
    triangles.each(&mut |face, triangle| {
        for (hash, run) in runs(face, triangle) {
            let bucket = bucket(hash);
            let signed = if run.2 { hash } else { hash.wrapping_neg() };
            sums[bucket] = sums[bucket].wrapping_add(signed);
            sizes[bucket] += 1;
        }
    })?;
    let mut room = RUNS;
    let mut is_least = false;
    let mut wanted = HashSet::new();
    for bucket in (0..BUCKETS).filter(|&bucket| sums[bucket] != 0) {
        if sizes[bucket] > room {
            is_least = true;
        } else {
            room -= sizes[bucket];
            wanted.insert(bucket);
        }
    }
    let mut found: Vec<EdgeRun> = Vec::with_capacity(RUNS - room);
    triangles.each(&mut |face, triangle| {
        found.extend(
            runs(face, triangle)
                .filter(|(hash, _)| wanted.contains(&bucket(*hash)))
                .map(|(_, run)| run),
        );
    })?;
    found.sort_unstable();
    let upward = |group: &[EdgeRun]| group.iter().filter(|run| run.2).count();
    let faulty: Vec<&[EdgeRun]> = found
        .chunk_by(|p, q| (p.0, p.1) == (q.0, q.1))
        .filter(|group| 2 * upward(group) != group.len())
        .collect();
    let seen = faulty.len();
    // A wrongly wound face shows as two runs the same way, an open mesh as one run alone; the open edge is told first.
    let fault = faulty
        .into_iter()
        .map(|group| {
            let way = 2 * upward(group) > group.len();
            let mut faces = group.iter().filter(|run| run.2 == way).map(|run| run.3);
            let face = faces.next().unwrap_or(group[0].3);
            let is_even = group.len().is_multiple_of(2);
            let ends = [group[0].0, group[0].1].map(|end| end.map(f64::from_bits));
            (is_even, face, faces.next().filter(|_| is_even), way, ends)
        })
        .min_by_key(|fault| (fault.0, fault.1));
    Ok(
        fault.map(|(_, face, second, way, [low, high])| UnbalancedEdge {
            face,
            second,
            ends: if way { [low, high] } else { [high, low] },
            count: Count { seen, is_least },
        }),
    )
}

fn bucket(hash: u64) -> usize {
    (hash >> 48) as usize % BUCKETS
}

/// The runs of a triangle along its edges, each with a mixture of its ends that does not depend on the direction and is
/// the same in every process, so that the same mesh has the same message.
fn runs(face: usize, triangle: &Triangle) -> impl Iterator<Item = (u64, EdgeRun)> {
    const KEY: [u64; 12] = [
        0x9e37_79b9_7f4a_7c15,
        0xbf58_476d_1ce4_e5b9,
        0x94d0_49bb_1331_11eb,
        0xd6e8_feb8_6659_fd93,
        0xa076_1d64_78bd_642f,
        0xe703_7ed1_a0b4_28db,
        0x8ebc_6af0_9c88_c6e3,
        0x5899_65cc_7537_4cc3,
        0x1d8e_4e27_c47d_124f,
        0xeb44_acca_b455_d165,
        0xc2b2_ae3d_27d4_eb4f,
        0x1656_67b1_9e37_79f9,
    ];
    let corners = [0, 1, 2].map(|k| bits(&triangle[k]));
    [(0, 1), (1, 2), (2, 0)]
        .into_iter()
        .map(move |(from, to)| (corners[from], corners[to]))
        .filter(|(from, to)| from != to)
        .map(move |(from, to)| {
            let (low, high) = (from.min(to), from.max(to));
            let ([p, _], [_, q]) = (place(&KEY, low), place(&KEY, high));
            let hash = fold(p[0] ^ q[1], p[1] ^ q[0]);
            (hash, (low, high, from < to, face))
        })
}

// Faces that stand twice, found by marks that equal faces share.

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
            let repeated = triangles.find_repeats(&mut self.list)?;
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
pub(super) fn find_repeats(
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
    use super::*;
    use std::ops::ControlFlow;

    const TETRAHEDRON: [Triangle; 4] = [
        [[0.0; 3], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]],
        [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]],
        [[0.0; 3], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0]],
        [[1.0, 0.0, -0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
    ];

    struct List(Vec<Triangle>);

    impl Replay for List {
        type Error = ();

        fn each(&mut self, visit: &mut dyn FnMut(usize, &Triangle)) -> Result<(), ()> {
            self.0.iter().enumerate().for_each(|(i, t)| visit(i, t));
            Ok(())
        }

        fn find_repeats(&mut self, _: &mut [u64]) -> Result<Vec<u64>, ()> {
            Ok(Vec::new())
        }
    }

    #[test]
    fn areas_cancel_when_edges_do() {
        let of = |list: &[Triangle]| Boundary::of(list.iter().copied(), |_| ());
        assert!(of(&TETRAHEDRON).is_closed());
        for (place, missing) in TETRAHEDRON.iter().enumerate() {
            let mut rest = TETRAHEDRON.to_vec();
            let turned = [0, 2, 1].map(|k| missing[k]);
            rest.remove(place);
            assert!(!of(&rest).is_closed());
            rest.push(turned);
            assert!(!of(&rest).is_closed());
            rest.push(*missing);
            rest.push([1, 2, 0].map(|k| missing[k]));
            assert!(of(&rest).is_closed());
        }
    }

    #[test]
    fn the_edge_is_found() {
        let mut open = List(TETRAHEDRON[..3].to_vec());
        let fault = find_unbalanced(&mut open).expect("list").expect("open");
        assert_eq!((fault.face, fault.second, fault.count.seen), (0, None, 3));
        assert_eq!(fault.ends, [[0.0, 1.0, 0.0], [1.0, 0.0, 0.0]]);
        let mut whole = List(TETRAHEDRON.to_vec());
        assert!(find_unbalanced(&mut whole).expect("list").is_none());
    }

    /// Triangles none of which stands twice.
    fn fan(count: u32) -> Vec<Triangle> {
        let corner = |k: u32| [f64::from(k), f64::from(k * k), 1.0];
        (0..count)
            .map(|k| [[0.0; 3], corner(k), corner(k + 1)])
            .collect()
    }

    /// Triangles that tell which of them repeat others.
    struct Repeating(Vec<Triangle>);

    impl Replay for Repeating {
        type Error = Halt<Infallible>;

        fn each(&mut self, visit: &mut dyn FnMut(usize, &Triangle)) -> Result<(), Self::Error> {
            self.0.iter().enumerate().for_each(|(i, t)| visit(i, t));
            Ok(())
        }

        fn find_repeats(&mut self, marks: &mut [u64]) -> Result<Vec<u64>, Self::Error> {
            find_repeats(marks, &mut |_| ControlFlow::Continue(()))
        }
    }

    fn repeat_fault(list: Vec<Triangle>, room: usize) -> Option<MeshFault> {
        let mut marks = Marks::beyond(0, room);
        for triangle in &list {
            marks.push(mark(triangle));
        }
        marks.find_duplicates(&mut Repeating(list)).expect("a list")
    }

    #[test]
    fn they_are_found_whichever_corner_comes_first() {
        let mut list = fan(10_000);
        assert_eq!(repeat_fault(list.clone(), ROOM), None);
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
        assert_eq!(repeat_fault(list.clone(), ROOM), Some(fault));
        list.pop();
        list.pop();
        list.extend_from_within(..);
        let Some(MeshFault::DuplicateFaces { count, .. }) = repeat_fault(list, ROOM) else {
            panic!("expected duplicates");
        };
        assert_eq!(count.seen, 10_000);
    }

    #[test]
    fn little_room_takes_longer_and_finds_the_same() {
        let mut list = fan(3_000);
        assert_eq!(repeat_fault(list.clone(), 50), None);
        for double in [1, 999, 2_999] {
            list.push(list[double]);
            let Some(MeshFault::DuplicateFaces { first, second, .. }) =
                repeat_fault(list.clone(), 50)
            else {
                panic!("expected duplicates");
            };
            assert_eq!((first, second), (double, 3_000));
            list.pop();
        }
        let same = vec![fan(5)[4]; 500];
        assert!(repeat_fault(same, 50).is_some());
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
