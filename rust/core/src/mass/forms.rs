//! Other people's forms of a rigid body, to and from: each says about which point and in which order.
//!
//! All but the log-Cholesky parameters are about the origin O of the body frame, and lose digits for a body that stands
//! many of its own lengths from it.
//!
//! | form | numbers |
//! |---|---|
//! | positive products | `Ixx, Iyy, Izz` and `Pxy, Pxz, Pyz = ∫ x y dm, …`, about C |
//! | ten parameters | `m, m cx, m cy, m cz, Ixx, Ixy, Iyy, Ixz, Iyz, Izz`, about O |
//! | pseudo-inertia | `J = [[∫ r rᵀ dm, m c], [m cᵀ, m]]`, about O |
//! | spatial inertia | `[[I_O, m c×], [−m c×, m 1]]`, about O |
//! | log-Cholesky | `α, d1, d2, d3, s12, s23, s13, t1, t2, t3` with `J = U Uᵀ` |

use nalgebra::{Matrix3, Matrix4, Matrix6, Vector3};

use super::body::RigidBody;
use super::parallel_axis::from_center_of_mass;
use super::validity::{ASYMMETRY, check_mass, check_symmetry};
use crate::error::{BodyFault, Error, all_finite_of_body};

/// In which order a spatial inertia stacks its two halves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SpatialOrder {
    /// Angular first: Featherstone, Drake.
    AngularLinear,
    /// Linear first: Pinocchio.
    LinearAngular,
}

impl RigidBody {
    /// From mass, moments `(Ixx, Iyy, Izz)` and *positive* products `(Pxy, Pxz, Pyz)`, `P_xy = ∫ x y dm`, about C.
    ///
    /// The products of many CAD and aerospace tables; the tensor's off-diagonal elements are minus these.
    ///
    /// # Errors
    /// As [`RigidBody::new`].
    pub fn from_positive_products(
        mass: f64,
        moments: &[f64; 3],
        products: &[f64; 3],
        center_of_mass: &Vector3<f64>,
        rtol: f64,
    ) -> Result<Self, Error> {
        all_finite_of_body("moments", moments)?;
        all_finite_of_body("products", products)?;
        let [x, y, z] = *moments;
        let [xy, xz, yz] = products.map(|p| 0.0 - p);
        let inertia = Matrix3::new(x, xy, xz, xy, y, yz, xz, yz, z);
        Self::new(mass, &inertia, center_of_mass, rtol)
    }

    /// Moments `(Ixx, Iyy, Izz)` and positive products `(Pxy, Pxz, Pyz)` about C.
    #[must_use]
    pub fn positive_products(&self) -> ([f64; 3], [f64; 3]) {
        let i = self.inertia();
        (
            [i.m11, i.m22, i.m33],
            [i.m12, i.m13, i.m23].map(|element| 0.0 - element),
        )
    }

    /// The ten numbers that the equations of motion are linear in:
    /// `m, m cx, m cy, m cz, Ixx, Ixy, Iyy, Ixz, Iyz, Izz`, the tensor about O with minus the products off its diagonal.
    #[must_use]
    pub fn parameters(&self) -> [f64; 10] {
        let i = self.inertia_about(&Vector3::zeros());
        let h = self.center_of_mass() * self.mass();
        [
            self.mass(),
            h.x,
            h.y,
            h.z,
            i.m11,
            i.m12,
            i.m22,
            i.m13,
            i.m23,
            i.m33,
        ]
    }

    /// From the ten numbers of [`Self::parameters`].
    ///
    /// # Errors
    /// As [`RigidBody::from_inertia_about_origin`].
    pub fn from_parameters(parameters: &[f64; 10], rtol: f64) -> Result<Self, Error> {
        all_finite_of_body("parameters", parameters)?;
        let [m, hx, hy, hz, xx, xy, yy, xz, yz, zz] = *parameters;
        check_mass(m)?;
        let about_origin = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
        Self::from_inertia_about_origin(m, &about_origin, &(Vector3::new(hx, hy, hz) / m), rtol)
    }

    /// Pseudo-inertia `J = ∫ (r; 1)(r; 1)ᵀ dm` about O (Wensing, Kim and Slotine 2018): a body is possible exactly when J is
    /// positive semidefinite.
    #[must_use]
    pub fn pseudo_inertia(&self) -> Matrix4<f64> {
        let c = self.center_of_mass();
        let h = c * self.mass();
        let sigma = second_moment(&self.inertia()) + h * c.transpose();
        let mut j = Matrix4::zeros();
        j.fixed_view_mut::<3, 3>(0, 0)
            .copy_from(&((sigma + sigma.transpose()) * 0.5));
        j.fixed_view_mut::<3, 1>(0, 3).copy_from(&h);
        j.fixed_view_mut::<1, 3>(3, 0).copy_from(&h.transpose());
        j[(3, 3)] = self.mass();
        j
    }

    /// From the pseudo-inertia about O.
    ///
    /// # Errors
    /// When it is not symmetric; as [`RigidBody::from_inertia_about_origin`].
    pub fn from_pseudo_inertia(pseudo_inertia: &Matrix4<f64>, rtol: f64) -> Result<Self, Error> {
        let what = "pseudo_inertia";
        all_finite_of_body(what, pseudo_inertia)?;
        check_symmetry(what, pseudo_inertia, ASYMMETRY.max(rtol))?;
        let j = (pseudo_inertia + pseudo_inertia.transpose()) * 0.5;
        let mass = j[(3, 3)];
        check_mass(mass)?;
        let sigma: Matrix3<f64> = j.fixed_view::<3, 3>(0, 0).into_owned();
        let h: Vector3<f64> = j.fixed_view::<3, 1>(0, 3).into_owned();
        let about_origin = inertia(&sigma);
        Self::from_inertia_about_origin(mass, &about_origin, &(h / mass), rtol)
    }

    /// Spatial inertia about O: `[[I_O, m c×], [−m c×, m 1]]` with the angular half first,
    /// `[[m 1, −m c×], [m c×, I_O]]` with the linear half first.
    #[must_use]
    pub fn spatial_inertia(&self, order: SpatialOrder) -> Matrix6<f64> {
        let c = self.center_of_mass();
        spatial(
            self.mass(),
            &(c * self.mass()),
            &from_center_of_mass(&self.inertia(), self.mass(), &c),
            order,
        )
    }

    /// From the spatial inertia about O.
    ///
    /// # Errors
    /// [`BodyFault::NotASpatialInertia`] with the element that differs from what the others imply; as
    /// [`RigidBody::from_inertia_about_origin`].
    pub fn from_spatial_inertia(
        spatial_inertia: &Matrix6<f64>,
        order: SpatialOrder,
        rtol: f64,
    ) -> Result<Self, Error> {
        let what = "spatial_inertia";
        all_finite_of_body(what, spatial_inertia)?;
        let (angular, linear) = order.halves();
        let mass = spatial_inertia[(linear, linear)];
        check_mass(mass)?;
        // The upper right block of the angular rows is m c×.
        let cross = spatial_inertia.fixed_view::<3, 3>(angular, linear);
        let h = Vector3::new(cross[(2, 1)], cross[(0, 2)], cross[(1, 0)]);
        let tensor: Matrix3<f64> = spatial_inertia
            .fixed_view::<3, 3>(angular, angular)
            .into_owned();
        let implied = spatial(mass, &h, &tensor, order);
        // Mass, first moments and tensor have their own units, so each block is held against its own size.
        let scales = [mass, (mass * tensor.amax()).sqrt(), tensor.amax()];
        for row in 0..6 {
            for column in 0..6 {
                let is_angular = |index: usize| (angular..angular + 3).contains(&index);
                let scale = scales[usize::from(is_angular(row)) + usize::from(is_angular(column))];
                let (got, expected) = (spatial_inertia[(row, column)], implied[(row, column)]);
                if (got - expected).abs() > ASYMMETRY.max(rtol) * scale {
                    return Err(BodyFault::NotASpatialInertia {
                        row,
                        column,
                        got,
                        expected,
                    }
                    .into());
                }
            }
        }
        Self::from_inertia_about_origin(mass, &tensor, &(h / mass), rtol)
    }

    /// Log-Cholesky parameters `α, d1, d2, d3, s12, s23, s13, t1, t2, t3` (Rucker and Wensing 2022): the pseudo-inertia about O
    /// is `J = U Uᵀ`, `U = e^α [[e^d1, s12, s13, t1], [0, e^d2, s23, t2], [0, 0, e^d3, t3], [0, 0, 0, 1]]`. Any ten numbers
    /// are those of a possible body.
    ///
    /// Taken from mass, C and the second moment about C, so that a body far from O loses nothing: `α = ½ ln m`, `t = C`.
    ///
    /// # Errors
    /// [`BodyFault::NoLogCholesky`] for a body without thickness, whose second moments include a zero.
    pub fn log_cholesky(&self) -> Result<[f64; 10], Error> {
        // S/m = U Uᵀ with U upper triangular, from the last row upward.
        let s = second_moment(&self.inertia()) / self.mass();
        let size = s.amax();
        let pivot = |square: f64, along: &'static str| {
            if square > 8.0 * f64::EPSILON * size {
                Ok(square.sqrt())
            } else {
                Err(Error::Body(BodyFault::NoLogCholesky {
                    along,
                    square: square.max(0.0) * self.mass(),
                }))
            }
        };
        let u33 = pivot(s.m33, "z")?;
        let (u13, u23) = (s.m13 / u33, s.m23 / u33);
        let u22 = pivot(s.m22 - u23 * u23, "y")?;
        let u12 = (s.m12 - u13 * u23) / u22;
        let u11 = pivot(s.m11 - u12 * u12 - u13 * u13, "x")?;
        let [t1, t2, t3] = self.center_of_mass().into();
        Ok([
            0.5 * self.mass().ln(),
            u11.ln(),
            u22.ln(),
            u33.ln(),
            u12,
            u23,
            u13,
            t1,
            t2,
            t3,
        ])
    }

    /// From the parameters of [`Self::log_cholesky`].
    ///
    /// # Errors
    /// When a number is not finite, or the body overflows.
    pub fn from_log_cholesky(parameters: &[f64; 10]) -> Result<Self, Error> {
        all_finite_of_body("parameters", parameters)?;
        let [alpha, d1, d2, d3, s12, s23, s13, t1, t2, t3] = *parameters;
        let mass = (2.0 * alpha).exp();
        let (u11, u22, u33) = (d1.exp(), d2.exp(), d3.exp());
        let u = Matrix3::new(u11, s12, s13, 0.0, u22, s23, 0.0, 0.0, u33);
        let inertia = inertia(&(u * u.transpose() * mass));
        Self::new(mass, &inertia, &Vector3::new(t1, t2, t3), 0.0)
    }
}

impl SpatialOrder {
    /// Where the angular and the linear rows begin.
    fn halves(self) -> (usize, usize) {
        match self {
            Self::AngularLinear => (0, 3),
            Self::LinearAngular => (3, 0),
        }
    }
}

/// The 6×6 matrix of mass, first moment `h = m c` and tensor about O.
fn spatial(
    mass: f64,
    h: &Vector3<f64>,
    about_origin: &Matrix3<f64>,
    order: SpatialOrder,
) -> Matrix6<f64> {
    let (angular, linear) = order.halves();
    let cross = Matrix3::new(0.0, -h.z, h.y, h.z, 0.0, -h.x, -h.y, h.x, 0.0).map(|x| x + 0.0);
    let mut matrix = Matrix6::zeros();
    let mut block = |row: usize, column: usize, value: &Matrix3<f64>| {
        matrix.fixed_view_mut::<3, 3>(row, column).copy_from(value);
    };
    block(angular, angular, about_origin);
    block(angular, linear, &cross);
    block(linear, angular, &cross.transpose());
    block(linear, linear, &Matrix3::from_diagonal_element(mass));
    matrix
}

/// `S = ½ tr(I) 1 − I`.
pub(super) fn second_moment(inertia: &Matrix3<f64>) -> Matrix3<f64> {
    let i = inertia;
    // Each diagonal element from the differences that are meant: (Iyy + Izz − Ixx)/2.
    let half = |a: f64, b: f64, c: f64| 0.5 * (a - c + b);
    Matrix3::new(
        half(i.m22, i.m33, i.m11),
        0.0 - i.m12,
        0.0 - i.m13,
        0.0 - i.m12,
        half(i.m33, i.m11, i.m22),
        0.0 - i.m23,
        0.0 - i.m13,
        0.0 - i.m23,
        half(i.m11, i.m22, i.m33),
    )
}

/// `I = tr(S) 1 − S`.
fn inertia(s: &Matrix3<f64>) -> Matrix3<f64> {
    let (xy, xz, yz) = (0.0 - s.m12, 0.0 - s.m13, 0.0 - s.m23);
    Matrix3::new(
        s.m22 + s.m33,
        xy,
        xz,
        xy,
        s.m11 + s.m33,
        yz,
        xz,
        yz,
        s.m11 + s.m22,
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mass::{Amount, solids};

    fn brick() -> RigidBody {
        let turn = nalgebra::Rotation3::from_euler_angles(0.3, -1.1, 2.0).into_inner();
        let brick = solids::cuboid(&[1.0, 2.0, 3.0], Amount::Mass(2.5)).expect("brick");
        let moved = brick.translated(&Vector3::new(0.5, -0.25, 1.0));
        moved.expect("moved").rotated(&turn).expect("turned")
    }

    #[test]
    fn every_form_leads_back() {
        let body = brick();
        let [angular, linear] = [SpatialOrder::AngularLinear, SpatialOrder::LinearAngular];
        let again = [
            RigidBody::from_parameters(&body.parameters(), 0.0),
            RigidBody::from_pseudo_inertia(&body.pseudo_inertia(), 0.0),
            RigidBody::from_spatial_inertia(&body.spatial_inertia(angular), angular, 0.0),
            RigidBody::from_spatial_inertia(&body.spatial_inertia(linear), linear, 0.0),
            RigidBody::from_log_cholesky(&body.log_cholesky().expect("solid")),
        ];
        for other in again {
            assert!(other.expect("the same body").is_close(&body, 1e-14, 0.0));
        }
        let (moments, products) = body.positive_products();
        let c = body.center_of_mass();
        let same = RigidBody::from_positive_products(2.5, &moments, &products, &c, 0.0);
        assert_eq!(same.expect("body").inertia(), body.inertia());
    }

    #[test]
    fn spatial_inertia_gives_energy_and_momentum() {
        let body = brick();
        let (omega, v) = (Vector3::new(0.1, -0.7, 0.4), Vector3::new(1.0, 2.0, -0.5));
        let twist = nalgebra::Vector6::new(omega.x, omega.y, omega.z, v.x, v.y, v.z);
        let momentum = body.spatial_inertia(SpatialOrder::AngularLinear) * twist;
        let c = body.center_of_mass();
        let linear = (v + omega.cross(&c)) * body.mass();
        let angular = body.inertia() * omega + c.cross(&linear);
        assert!((momentum.fixed_rows::<3>(0) - angular).norm() < 1e-14 * angular.norm() * 10.0);
        assert!((momentum.fixed_rows::<3>(3) - linear).norm() < 1e-14 * linear.norm() * 10.0);
    }

    #[test]
    fn a_matrix_of_another_make_is_told() {
        let mut matrix = brick().spatial_inertia(SpatialOrder::AngularLinear);
        matrix[(4, 4)] = 7.0;
        let fault = RigidBody::from_spatial_inertia(&matrix, SpatialOrder::AngularLinear, 0.0);
        let expected = Error::Body(BodyFault::NotASpatialInertia {
            row: 4,
            column: 4,
            got: 7.0,
            expected: 2.5,
        });
        assert_eq!(fault, Err(expected));
        let plate = solids::cuboid(&[1.0, 2.0, 0.0], Amount::Mass(1.0)).expect("plate");
        assert!(matches!(
            plate.log_cholesky(),
            Err(Error::Body(BodyFault::NoLogCholesky { along: "z", .. }))
        ));
    }
}
