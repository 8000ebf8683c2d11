//! Principal axes that suit the momentum inside: equal moments have one axis along their part of it.

use crate::numerics::double_double::DoubleDouble;
use crate::numerics::power_of_two::exponent;

/// Three components to twice the precision.
pub(super) type Vector = [DoubleDouble; 3];

/// Axes of which no two with equal moments both have a part of h.
pub(super) struct ReducedAxes {
    /// Ascending.
    pub(super) moments: Vector,
    /// h/|L| along the axes.
    pub(super) rotor: Vector,
    /// The axes, one after the other, in principal axes.
    axes: [Vector; 3],
}

/// Neighbouring axes with equal moments.
#[derive(Clone, Copy)]
pub(super) struct Group {
    /// The first of them, which has all of their part of h.
    pub(super) first: usize,
    /// How many.
    pub(super) count: usize,
}

impl Group {
    /// Whether an axis belongs to it.
    pub(super) fn contains(self, i: usize) -> bool {
        (self.first..self.first + self.count).contains(&i)
    }
}

impl ReducedAxes {
    /// Of ascending moments, and h/|L| in principal axes.
    pub(super) fn of(moments: &Vector, rotor: &Vector) -> Self {
        let (zero, one) = (DoubleDouble::default(), DoubleDouble::from(1.0));
        let mut frame = Self {
            moments: *moments,
            rotor: *rotor,
            axes: [0, 1, 2].map(|i| [0, 1, 2].map(|j| if i == j { one } else { zero })),
        };
        for group in frame.groups() {
            // The last first: its part goes to the axis before it.
            for i in (group.first..group.first + group.count - 1).rev() {
                frame.turn(i);
            }
        }
        frame
    }

    /// Turn an axis and the next, so that all of h in their plane is along the first.
    fn turn(&mut self, i: usize) {
        let (a, b) = (self.rotor[i], self.rotor[i + 1]);
        let length = norm(&[a, b, DoubleDouble::default()]);
        if b.high == 0.0 || length.high == 0.0 {
            return;
        }
        let (c, s) = (a / length, b / length);
        let (x, y) = (self.axes[i], self.axes[i + 1]);
        self.axes[i] = [0, 1, 2].map(|k| c * x[k] + s * y[k]);
        self.axes[i + 1] = [0, 1, 2].map(|k| c * y[k] - s * x[k]);
        self.rotor[i] = length;
        self.rotor[i + 1] = DoubleDouble::default();
    }

    /// Axes with equal moments together.
    pub(super) fn groups(&self) -> Vec<Group> {
        let mut groups: Vec<Group> = Vec::with_capacity(3);
        for i in 0..3 {
            match groups.last_mut() {
                Some(group) if self.moments[group.first] == self.moments[i] => group.count += 1,
                _ => groups.push(Group { first: i, count: 1 }),
            }
        }
        groups
    }

    /// Groups in which there is nothing of h.
    pub(super) fn without_rotor(&self) -> Vec<Group> {
        let mut groups = self.groups();
        groups.retain(|group| self.rotor[group.first].high == 0.0);
        groups
    }

    /// Axes with a part of h, the largest moment first: their poles ascend.
    pub(super) fn with_rotor(&self) -> Vec<usize> {
        (0..3)
            .rev()
            .filter(|&i| self.rotor[i].high != 0.0)
            .collect()
    }

    /// A vector in these axes, in principal ones.
    pub(super) fn outward(&self, v: &Vector) -> Vector {
        [0, 1, 2].map(|k| {
            v.iter()
                .zip(&self.axes)
                .fold(DoubleDouble::default(), |sum, (&x, axis)| sum + x * axis[k])
        })
    }
}

/// The length, which does not overflow.
pub(super) fn norm(v: &Vector) -> DoubleDouble {
    let largest = v.iter().fold(0.0, |most: f64, x| most.max(x.high.abs()));
    if largest == 0.0 {
        return DoubleDouble::default();
    }
    let unit = exponent(largest);
    let [x, y, z] = v.map(|x| x.times_power_of_two(-unit));
    (x * x + y * y + z * z).sqrt().times_power_of_two(unit)
}
