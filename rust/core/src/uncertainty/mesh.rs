//! Uncertainties of the solid that a closed triangle mesh bounds, by those of its vertices.
//!
//! By the divergence theorem the volume, its first and its second moments about a fixed point are sums over the tetrahedra that
//! it makes with each face: a face is asked for its nine derivatives alone, whatever the number of vertices.

use super::linear_forms::Form;
use super::linear_uncertainty::{LinearUncertainty, Tangent};
use super::variable::PROBES;
use crate::error::Error;
use crate::mass::Index;
use crate::mass::inertial_parameters::InertialParameters;
use crate::numerics::jet::Jet;
use crate::numerics::number::Real;
use crate::numerics::second_order_dual::SecondOrderDual;
use crate::numerics::threads::Watch;

/// Volume, `∫ r dV` and `∫ r rᵀ dV` (xx, yy, zz, xy, xz, yz).
type Moments<X> = [X; 10];

/// The places of the second moments.
const SECOND: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)];

/// Faces between two looks at whether to go on.
const BLOCK: usize = 4096;

/// The uncertainties of a homogeneous solid with these numbers: three forms for each vertex. Of a solid whose mass was given the
/// density changes with the volume.
///
/// # Examples
///
/// ```
/// use std::ops::ControlFlow;
/// use polhode::mass::polyhedron::polyhedron;
/// use polhode::mass::{Amount, inertial_parameters::InertialParameters};
/// use polhode::uncertainty::{LinearForms, Source, of_mesh};
///
/// // The corner of a cube, one vertex of which is known to 1 mm along x.
/// let vertices = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
/// let faces = [[0_usize, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
/// let body = polyhedron(&vertices, &faces, Amount::Density(6.0), false)?;
/// let mut sigmas = [0.0; 12];
/// sigmas[3] = 1e-3;
/// let given = LinearForms::independent(&sigmas, Source::fresh())?;
/// let go_on = &mut |_| ControlFlow::Continue(());
/// let uncertainty = of_mesh(&InertialParameters::of(&body), &vertices, &faces, &given.forms, false, go_on)?;
/// let sigma = uncertainty.covariance_with(&uncertainty)[(0, 0)].sqrt();
/// assert!((sigma - 1e-3).abs() < 1e-15); // the volume is x/6
/// # Ok::<(), polhode::Error>(())
/// ```
///
/// # Errors
/// [`Error::Stopped`] when `watch` asks for it.
pub fn of_mesh<I: Index>(
    solid: &InertialParameters<f64>,
    vertices: &[[f64; 3]],
    faces: &[[I; 3]],
    forms: &[Form],
    mass_is_given: bool,
    watch: &mut Watch<'_>,
) -> Result<LinearUncertainty, Error> {
    let from = |corner: usize| -> [f64; 3] {
        std::array::from_fn(|k| vertices[corner][k] - solid.center[k])
    };
    let mut moments = [0.0; 10];
    let mut by_coordinate = vec![[0.0; 10]; 3 * vertices.len()];
    each(faces, watch, |corners| {
        let place = |n: usize, k: usize| Jet::<9>::variable(from(corners[n])[k], 3 * n + k);
        let found = tetrahedron(std::array::from_fn(|n| {
            std::array::from_fn(|k| place(n, k))
        }));
        for (sum, term) in moments.iter_mut().zip(found) {
            *sum += term.value;
        }
        for (n, corner) in corners.into_iter().enumerate() {
            for k in 0..3 {
                for (sum, term) in by_coordinate[3 * corner + k].iter_mut().zip(found) {
                    *sum += term.slopes[3 * n + k];
                }
            }
        }
    })?;
    let mut tangents = Vec::new();
    for (form, slopes) in forms.iter().zip(&by_coordinate) {
        let along = std::array::from_fn(|k| Jet {
            value: moments[k],
            slopes: [slopes[k]],
        });
        let change = body(solid, &along, mass_is_given).map(|number: Jet<1>| number.slopes[0]);
        tangents
            .extend((form.iter()).map(|&(variable, step)| (variable, change.map(|x| x * step))));
    }
    let mut second_order = [Tangent::default(); PROBES];
    for (probe, curvature) in second_order.iter_mut().enumerate() {
        let slope = |form: &Form| -> f64 {
            form.iter()
                .map(|(variable, step)| step * variable.steps()[probe])
                .sum()
        };
        let slopes: Vec<f64> = forms.iter().map(slope).collect();
        let mut along = [SecondOrderDual::default(); 10];
        each(faces, watch, |corners| {
            let found = tetrahedron(corners.map(|corner| {
                let place = from(corner);
                std::array::from_fn(|k| SecondOrderDual::line(place[k], slopes[3 * corner + k]))
            }));
            for (sum, term) in along.iter_mut().zip(found) {
                *sum += term;
            }
        })?;
        *curvature = body(solid, &along, mass_is_given).map(|number| number.curvature);
    }
    Ok(LinearUncertainty::of(tangents, second_order))
}

/// Goes through the corners of all faces, and now and then asks whether to go on.
fn each<I: Index>(
    faces: &[[I; 3]],
    watch: &mut Watch<'_>,
    mut f: impl FnMut([usize; 3]),
) -> Result<(), Error> {
    for block in faces.chunks(BLOCK) {
        if watch(0.0).is_break() {
            return Err(Error::Stopped);
        }
        for face in block {
            f(face.map(Index::position));
        }
    }
    Ok(())
}

/// The moments of the tetrahedron between the origin and a face.
fn tetrahedron<X: Real>([a, b, c]: [[X; 3]; 3]) -> Moments<X> {
    let [x, y, z] = [(1, 2), (2, 0), (0, 1)].map(|(i, j)| b[i] * c[j] - b[j] * c[i]);
    let six = a[0] * x + a[1] * y + a[2] * z;
    let sum: [X; 3] = std::array::from_fn(|k| a[k] + b[k] + c[k]);
    let (first, second) = (six / X::from(24.0), six / X::from(120.0));
    std::array::from_fn(|k| match k {
        0 => six / X::from(6.0),
        1..4 => first * sum[k - 1],
        _ => {
            let (i, j) = SECOND[k - 4];
            second * (sum[i] * sum[j] + a[i] * a[j] + b[i] * b[j] + c[i] * c[j])
        }
    })
}

/// The body of these moments about the centre of mass that the solid is known to have.
fn body<X: Real>(
    solid: &InertialParameters<f64>,
    moments: &Moments<X>,
    mass_is_given: bool,
) -> InertialParameters<X> {
    let [volume, first @ .., xx, yy, zz, xy, xz, yz] = moments;
    let first: &[X; 3] = first;
    let density = if mass_is_given {
        X::from(solid.mass) / *volume
    } else {
        X::from(solid.mass / volume.rounded())
    };
    let mean = first.map(|sum| sum / *volume);
    let about =
        |second: X, (i, j): (usize, usize)| density * (second - *volume * mean[i] * mean[j]);
    let [xx, yy, zz, xy, xz, yz]: [X; 6] = {
        let second = [*xx, *yy, *zz, *xy, *xz, *yz];
        std::array::from_fn(|k| about(second[k], SECOND[k]))
    };
    InertialParameters {
        mass: *volume * density,
        center: std::array::from_fn(|k| X::from(solid.center[k]) + mean[k]),
        inertia: [yy + zz, xx + zz, xx + yy, -xy, -xz, -yz],
    }
}
