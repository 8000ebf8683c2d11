//! Which balls meet: a tree of boxes, halved across their longest side.

use nalgebra::Vector3;

use super::cut_ball::Plane;

/// Balls of a leaf.
const LEAF: usize = 6;

/// Balls in a tree of boxes. Lengths are in the unit of the body.
pub(super) struct Neighbours<'a> {
    centers: &'a [[f64; 3]],
    radii: &'a [f64],
    inverse: f64,
    /// The balls in the order of the leaves.
    order: Vec<usize>,
    boxes: Vec<Node>,
}

/// A box about some balls; those of its first half are in the next box, those of the second in `other`.
struct Node {
    low: [f64; 3],
    high: [f64; 3],
    from: usize,
    to: usize,
    /// Zero of a leaf.
    other: usize,
}

impl<'a> Neighbours<'a> {
    pub(super) fn of(centers: &'a [[f64; 3]], radii: &'a [f64], unit: f64) -> Self {
        let mut tree = Self {
            centers,
            radii,
            inverse: 1.0 / unit,
            order: (0..centers.len()).collect(),
            boxes: Vec::new(),
        };
        tree.build(0, centers.len());
        tree
    }

    fn build(&mut self, from: usize, to: usize) {
        let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        let (mut first, mut last) = (low, high);
        for &ball in &self.order[from..to] {
            let radius = self.radii[ball];
            for axis in 0..3 {
                let x = self.centers[ball][axis];
                low[axis] = low[axis].min(x - radius);
                high[axis] = high[axis].max(x + radius);
                first[axis] = first[axis].min(x);
                last[axis] = last[axis].max(x);
            }
        }
        let node = self.boxes.len();
        self.boxes.push(Node {
            low,
            high,
            from,
            to,
            other: 0,
        });
        if to - from <= LEAF {
            return;
        }
        let side = |axis: usize| last[axis] * 0.5 - first[axis] * 0.5;
        let longest = if side(0) >= side(1) && side(0) >= side(2) {
            0
        } else if side(1) >= side(2) {
            1
        } else {
            2
        };
        let middle = usize::midpoint(from, to);
        let centers = self.centers;
        self.order[from..to].select_nth_unstable_by(middle - from, |&a, &b| {
            (centers[a][longest].total_cmp(&centers[b][longest])).then(a.cmp(&b))
        });
        self.build(from, middle);
        self.boxes[node].other = self.boxes.len();
        self.build(middle, to);
    }

    /// The planes of the circles in which a ball meets others, from its center and in units of its radius, the deepest
    /// first; whether no other ball covers it.
    pub(super) fn planes(&self, ball: usize, planes: &mut Vec<Plane>) -> bool {
        planes.clear();
        let (center, radius) = (self.centers[ball], self.radii[ball]);
        let mut stack = vec![0];
        while let Some(node) = stack.pop() {
            let at = &self.boxes[node];
            let is_apart = (0..3).any(|axis| {
                center[axis] + radius < at.low[axis] || center[axis] - radius > at.high[axis]
            });
            if is_apart {
                continue;
            }
            if at.other != 0 {
                stack.extend([at.other, node + 1]);
                continue;
            }
            for &other in &self.order[at.from..at.to] {
                if other != ball && !self.meet(ball, other, planes) {
                    return false;
                }
            }
        }
        planes.sort_by(|a, b| a.height.total_cmp(&b.height));
        true
    }

    /// Adds the plane between two balls that meet; false where the other covers the ball.
    fn meet(&self, ball: usize, other: usize, planes: &mut Vec<Plane>) -> bool {
        let [from, to] = [ball, other].map(|k| self.centers[k]);
        let [own, theirs] = [ball, other].map(|k| self.radii[k] * self.inverse);
        let way: [f64; 3] = std::array::from_fn(|k| (to[k] - from[k]) * self.inverse);
        let way = Vector3::from(way);
        let largest = way.amax();
        if largest == 0.0 {
            return own > theirs || own == theirs && ball < other;
        }
        // Without underflow of squares.
        let distance = largest * (way / largest).norm();
        if distance >= own + theirs {
            return true;
        }
        if distance <= theirs - own {
            return false;
        }
        if distance <= own - theirs {
            return true;
        }
        let height = 0.5 * (distance + (own - theirs) / distance * (own + theirs)) / own;
        if height <= -1.0 {
            return false;
        }
        if height < 1.0 {
            let normal = way / distance;
            planes.push(Plane { normal, height });
        }
        true
    }
}
