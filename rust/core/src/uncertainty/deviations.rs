//! Standard deviations of what a body has, and where the first order is not enough for them.
//!
//! With `I = V diag(I_k) Vᵀ` and a change `W = Vᵀ δI V` of the tensor in its principal axes, to first order `δI_k = W_kk`, and
//! the axes turn by the small rotation φ about themselves with `[φ]×_ij = W_ij/(I_j − I_i)`.
//!
//! Of a number with the terms l, e and c of first, second and third order the variance is
//! `E[l²] + var(e) + 2 E[l c] + …` for normal draws: the first order is right within a percent as long as what follows stays
//! below two percent of it, here less a margin for what is not seen. Moments that are about to change places have no such
//! expansion: their gap has to be wide beside its own deviation.

use nalgebra::Vector3;

use super::changes::TensorAbout;
use super::doubt::Doubt;
use super::follow::{Follow, follow};
use super::higher::across;
use super::terms::{BodyTerms, ROUNDING, Terms};
use crate::error::Error;
use crate::mass::body::RigidBody;
use crate::mass::ten::Ten;
use crate::principal::PrincipalAxes;
use crate::principal::derivative::DEGENERATE_RTOL;

/// Least gap between moments for them to be linear, and for the axes: in deviations of the gap.
const GAPS: [f64; 2] = [2.0, 3.5];
/// An angle of more than this deviation, in radians, says nothing of where an axis is.
const ANYWHERE: f64 = 1.0;

/// Standard deviations of a body's numbers, and whether each is linear enough.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Deviations {
    /// Of the ten numbers.
    pub numbers: [f64; 10],
    /// Of the principal moments.
    pub moments: [f64; 3],
    /// Of the radii of gyration.
    pub radii: [f64; 3],
    /// Of the axes: of the small rotations about each of them, in radians; NaN where the axes are not determined.
    pub axes: [f64; 3],
    /// Whether the first order is enough for each of the ten numbers.
    pub is_linear: [bool; 10],
    /// For each of the moments.
    pub moments_are_linear: [bool; 3],
    /// For each of the radii.
    pub radii_are_linear: [bool; 3],
    /// For each of the angles.
    pub axes_are_linear: [bool; 3],
}

/// Standard deviations of mass, centre and tensor, of the principal moments and axes about C, and of the radii of gyration.
#[must_use]
pub fn deviations(body: &RigidBody, doubt: &Doubt) -> Deviations {
    of(&Ten::of(body), &body.principal(), doubt)
}

/// As [`deviations`], with tensor, moments, axes and radii about a point of the body frame.
///
/// # Errors
/// Those of [`follow`]; a point is in the domain of every body, so that there are none.
pub fn deviations_about(
    body: &RigidBody,
    doubt: &Doubt,
    point: &Vector3<f64>,
) -> Result<Deviations, Error> {
    let numbers = Ten::of(body);
    let from = Follow {
        bodies: &[(numbers, doubt)],
        numbers: &[],
    };
    let doubt = follow(&TensorAbout((*point).into()), from)?;
    let about = Ten {
        inertia: numbers.about((*point).into()),
        ..numbers
    };
    Ok(of(&about, &body.principal_about(point), &doubt))
}

/// Of ten numbers with the principal moments and axes of their tensor.
fn of(numbers: &Ten<f64>, principal: &PrincipalAxes, doubt: &Doubt) -> Deviations {
    let largest = principal.moments[2];
    let BodyTerms {
        own,
        moments,
        angles,
        radii,
        higher,
        to_second_order,
    } = BodyTerms::of(numbers, principal, doubt);
    let gaps: [Gap; 3] = std::array::from_fn(|k| {
        let (i, j) = across(k);
        Gap {
            width: principal.moments[j] - principal.moments[i],
            deviation: {
                let deviation = higher.gap(k).sqrt();
                if deviation > ROUNDING * largest {
                    deviation
                } else {
                    0.0
                }
            },
        }
    });
    // Where two moments may change places, the other two angles are about other axes.
    let none_changes = gaps.iter().all(|gap| gap.is_wide(GAPS[0]));
    let beside = |k: usize| [(k + 1) % 3, (k + 2) % 3];
    let stays = |k: usize| beside(k).iter().all(|&axis| gaps[axis].is_wide(GAPS[0]));
    let is_apart = gaps.map(|gap| gap.width > DEGENERATE_RTOL * largest);
    // A moment that is zero has no deviation but rounding. Where it has no second order either it is zero for ever, and so is
    // its radius of gyration; else the radius leaves zero by the first order of a length, which has no derivative there.
    let is_zero = |k: usize| {
        let deviation = moments[k].deviation();
        deviation >= principal.moments[k] && deviation <= ROUNDING * largest
    };
    // Neither order moves it: what is left of a body that is only turned is beyond them.
    let rests = |k: usize| {
        let moved = moments[k].first.max(to_second_order[k].mean_square());
        moved.sqrt() <= ROUNDING * largest
    };
    let radius = (largest / numbers.mass).sqrt() + Vector3::from(numbers.center).norm();
    let size = |k: usize| match k {
        0 => numbers.mass,
        1..4 => radius,
        _ => largest,
    };
    Deviations {
        numbers: own.map(Terms::deviation),
        moments: moments.map(Terms::deviation),
        radii: std::array::from_fn(|k| match (is_zero(k), rests(k)) {
            (true, true) => 0.0,
            (true, false) => f64::NAN,
            (false, _) => radii[k].deviation(),
        }),
        axes: std::array::from_fn(|k| {
            let sigma = angles[k].deviation();
            let is_determined = is_apart[k] && sigma < ANYWHERE;
            if is_determined { sigma } else { f64::NAN }
        }),
        is_linear: std::array::from_fn(|k| own[k].is_linear(size(k))),
        moments_are_linear: std::array::from_fn(|k| {
            stays(k) && (rests(k) || moments[k].is_linear(largest))
        }),
        radii_are_linear: std::array::from_fn(|k| {
            let rests = rests(k) && (is_zero(k) || radii[k].deviation() <= ROUNDING * radius);
            stays(k) && (rests || (!is_zero(k) && radii[k].is_linear(radius)))
        }),
        axes_are_linear: std::array::from_fn(|k| {
            is_apart[k] && none_changes && gaps[k].is_wide(GAPS[1]) && angles[k].is_linear(1.0)
        }),
    }
}

/// The gap between two moments.
#[derive(Clone, Copy)]
struct Gap {
    width: f64,
    deviation: f64,
}

impl Gap {
    fn is_wide(self, deviations: f64) -> bool {
        self.width >= deviations * self.deviation
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Matrix3;

    use super::*;
    use crate::uncertainty::Source;

    fn body(moments: [f64; 3]) -> RigidBody {
        RigidBody::from_principal(1.0, &moments, &Matrix3::identity(), &Vector3::zeros(), 0.0)
            .expect("body")
    }

    /// One variable, by which the tensor's elements change so.
    fn doubt(elements: [f64; 6]) -> Doubt {
        let change = Ten {
            inertia: elements,
            ..Ten::default()
        };
        Doubt {
            tangents: vec![(Source::named("one").variable(0), change)],
            ..Doubt::default()
        }
    }

    #[test]
    fn axes_between_equal_moments_are_not_determined() {
        let doubt = doubt([1e-3, 0.0, 0.0, 0.0, 0.0, 0.0]);
        let top = deviations(&body([1.0, 2.0, 2.0]), &doubt);
        assert!(top.axes[0].is_nan() && top.axes[1] == 0.0 && top.axes[2] == 0.0);
        assert_eq!(top.axes_are_linear, [false, true, true]);
        // The two moments that are equal stay so: they are as linear as the other.
        assert_eq!(
            (top.moments, top.moments_are_linear),
            ([1e-3, 0.0, 0.0], [true; 3])
        );
        let apart = deviations(&body([1.0, 2.0, 2.1]), &doubt);
        assert_eq!((apart.axes, apart.axes_are_linear), ([0.0; 3], [true; 3]));
    }

    #[test]
    fn moments_that_may_change_places_are_told_on_both_sides_of_the_limit() {
        let doubt = doubt([0.0, 0.0, 0.01, 0.0, 0.0, 0.0]);
        for (gap, moments) in [(0.99 * GAPS[0], false), (1.01 * GAPS[0], true)] {
            let found = deviations(&body([1.0, 1.5, 1.5 + 0.01 * gap]), &doubt);
            assert_eq!(found.moments_are_linear, [true, moments, moments]);
            assert_eq!(found.axes_are_linear, [false, moments, moments]);
        }
        for (gap, axes) in [(0.99 * GAPS[1], false), (1.01 * GAPS[1], true)] {
            let found = deviations(&body([1.0, 1.5, 1.5 + 0.01 * gap]), &doubt);
            assert_eq!(found.axes_are_linear, [axes, true, true]);
        }
    }
}
