//! Which balls meet: a tree of boxes, halved across their longest side.

use nalgebra::Vector3;

use super::cut_ball::Plane;

/// A ball, by its center and its radius.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ball {
    pub(super) center: [f64; 3],
    pub(super) radius: f64,
}

/// Balls of a leaf.
const LEAF: usize = 8;

/// Balls in a tree of boxes.
pub(super) struct Neighbours {
    /// In the order of the leaves, so that what is near stands near in memory.
    pub(super) balls: Vec<Ball>,
    /// The unit of lengths of planes.
    inverse: f64,
    /// Each box before those of its two halves.
    boxes: Vec<Node>,
}

/// A box about some balls.
struct Node {
    low: [f64; 3],
    high: [f64; 3],
    from: usize,
    to: usize,
    /// The next box that is not within this one.
    next: usize,
}

impl Neighbours {
    pub(super) fn of(balls: Vec<Ball>, unit: f64) -> Self {
        let mut tree = Self {
            balls,
            inverse: 1.0 / unit,
            boxes: Vec::new(),
        };
        tree.build(0, tree.balls.len());
        tree
    }

    fn build(&mut self, from: usize, to: usize) {
        let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        let (mut first, mut last) = (low, high);
        for ball in &self.balls[from..to] {
            for axis in 0..3 {
                let x = ball.center[axis];
                low[axis] = low[axis].min(x - ball.radius);
                high[axis] = high[axis].max(x + ball.radius);
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
            next: node + 1,
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
        self.balls[from..to].select_nth_unstable_by(middle - from, |a, b| {
            a.center[longest].total_cmp(&b.center[longest])
        });
        self.build(from, middle);
        self.build(middle, to);
        self.boxes[node].next = self.boxes.len();
    }

    /// The planes of the circles in which a ball meets others, from its center and in units of its radius, the deepest
    /// first; whether no other ball covers it.
    pub(super) fn planes(&self, index: usize, planes: &mut Vec<Plane>) -> bool {
        planes.clear();
        let ball = self.balls[index];
        let low = ball.center.map(|x| x - ball.radius);
        let high = ball.center.map(|x| x + ball.radius);
        let mut node = 0;
        while let Some(at) = self.boxes.get(node) {
            let is_apart =
                (0..3).any(|axis| high[axis] < at.low[axis] || low[axis] > at.high[axis]);
            let is_leaf = at.next == node + 1;
            node = if is_apart { at.next } else { node + 1 };
            if is_apart || !is_leaf {
                continue;
            }
            for other in at.from..at.to {
                if other != index && !self.meet(index, other, planes) {
                    return false;
                }
            }
        }
        planes.sort_unstable_by(|a, b| a.height.total_cmp(&b.height));
        true
    }

    /// Adds the plane between two balls that meet; false where the other covers the ball.
    fn meet(&self, ball: usize, other: usize, planes: &mut Vec<Plane>) -> bool {
        /// Squares below this may have lost digits.
        const FAINT: f64 = 1e-280;
        let [from, to] = [ball, other].map(|k| self.balls[k].center);
        let [own, theirs] = [ball, other].map(|k| self.balls[k].radius * self.inverse);
        let way: [f64; 3] = std::array::from_fn(|k| (to[k] - from[k]) * self.inverse);
        let way = Vector3::from(way);
        let (square, reach) = (way.norm_squared(), own + theirs);
        if square > 1.000_001 * reach * reach {
            return true;
        }
        let distance = if square > FAINT {
            square.sqrt()
        } else {
            let largest = way.amax();
            if largest == 0.0 {
                return own > theirs || own == theirs && ball < other;
            }
            largest * (way / largest).norm()
        };
        if distance >= reach {
            return true;
        }
        if distance <= theirs - own {
            return false;
        }
        if distance <= own - theirs {
            return true;
        }
        let height = 0.5 * (distance + (own - theirs) / distance * reach) / own;
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
