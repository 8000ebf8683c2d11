//! Flat plates in light and in air.

use std::sync::Arc;

use nalgebra::Vector3;

use super::slug::not_negative;
use crate::error::{Error, MeshFault, MotionFault, all_finite, finite};
use crate::mass::Amount;
use crate::mass::polyhedron::{Index, Options, polyhedron_watched};
use crate::motion::loads::body_at_point::BodyAtPoint;
use crate::motion::loads::law::{ConservedMomentum, Law, Traits};
use crate::motion::loads::piecewise_signal::PiecewiseSignal;
use crate::motion::loads::principal_frame::{LawNumber, PrincipalFrame};
use crate::motion::loads::series_terms::SeriesTerms;
use crate::motion::loads::spline::{Spline, within};
use crate::motion::loads::variables::Parameter;
use crate::motion::loads::wrench::Wrench;
use crate::motion::state::Phase;
use crate::numerics::threads::{Halt, Watch, each_watched};

/// Plates that are computed side by side.
const LANES: usize = 4;

/// Two shares of the light that exceed one by less than this are all of it: they are rounded.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// Flat plates in the body, each with one side that feels light and air: where its centre is (from the origin of B), its area, and
/// its outward normal.
///
/// # Examples
///
/// ```
/// use std::ops::ControlFlow;
/// use polhode::motion::loads::Plates;
/// use polhode::nalgebra::Vector3;
///
/// // The two sides of a thin panel: a plate has one side.
/// let mut panel = Plates::default();
/// panel.add(&Vector3::new(2.0, 0.0, 0.0), 3.0, &Vector3::z())?;
/// panel.add(&Vector3::new(2.0, 0.0, 0.0), 3.0, &-Vector3::z())?;
/// // The triangles of a mesh, open or closed.
/// let corners = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
/// let faces = [[0_usize, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
/// let go_on = &mut |_| ControlFlow::Continue(());
/// assert_eq!((panel.count(), Plates::of_mesh(&corners, &faces, go_on)?.count()), (2, 4));
/// # Ok::<(), polhode::Error>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Plates {
    centers: Vec<Vector3<f64>>,
    areas: Vec<f64>,
    normals: Vec<Vector3<f64>>,
}

impl Plates {
    /// Adds a plate. The length of its normal does not count.
    ///
    /// # Errors
    /// For an area that is negative, a normal that is zero, what is not finite.
    pub fn add(
        &mut self,
        center: &Vector3<f64>,
        area: f64,
        normal: &Vector3<f64>,
    ) -> Result<(), Error> {
        all_finite("centers", center)?;
        not_negative("areas", area)?;
        let normal = unit("normals", normal)?;
        self.centers.push(*center);
        self.areas.push(area);
        self.normals.push(normal);
        Ok(())
    }

    /// The triangles of a mesh. A uniform pressure on a triangle acts at its centroid. The normals are outward where the corners are counter-clockwise
    /// seen from outside. The mesh may be open.
    ///
    /// # Errors
    /// [`MeshFault`] for a mesh without faces or area, for what is not finite, for faces that name no vertex or stand twice, for neighbours
    /// that are not wound alike, and for a closed mesh that is wound inward; [`Error::Stopped`] where `watch` says so.
    pub fn of_mesh<I: Index>(
        vertices: &[[f64; 3]],
        faces: &[[I; 3]],
        watch: &mut Watch<'_>,
    ) -> Result<Self, Error> {
        let checks = Options::default();
        match polyhedron_watched(vertices, faces, Amount::Mass(1.0), checks, watch) {
            // A sheet, or both sides of one.
            Ok(_)
            | Err(Halt::Failed(Error::Mesh(MeshFault::Open { .. } | MeshFault::NoVolume { .. }))) =>
                {}
            Err(halt) => return Err(halt.into()),
        }
        let mut plates = Self::default();
        let mut face = 0;
        each_watched(faces.iter(), watch, |corners| {
            let mut at = [Vector3::zeros(); 3];
            for (place, index) in at.iter_mut().zip(corners) {
                let vertex = vertices.get(index.position());
                let vertex = vertex.ok_or_else(|| MeshFault::IndexOutOfRange {
                    face,
                    index: index.to_i64(),
                    vertices: vertices.len(),
                })?;
                all_finite("vertices", vertex)?;
                *place = Vector3::from(*vertex);
            }
            let [a, b, c] = at;
            // Half the product of two edges, of a size that has a square.
            let (u, v) = (b - a, c - a);
            let size = u.amax().max(v.amax());
            let product = (u / size).cross(&(v / size));
            let area = finite("the area of a face", 0.5 * product.norm() * size * size)?;
            // A face without area exerts nothing, whatever its normal.
            let (area, normal) = match product.try_normalize(0.0) {
                Some(normal) if size > 0.0 => (area, normal),
                _ => (0.0, Vector3::z()),
            };
            plates.centers.push(a + (u + v) / 3.0);
            plates.areas.push(area);
            plates.normals.push(normal);
            face += 1;
            Ok::<_, Error>(())
        })?;
        let area: f64 = plates.areas.iter().sum();
        if area > 0.0 {
            return Ok(plates);
        }
        let faces = faces.len();
        Err(MeshFault::NoArea { area, faces }.into())
    }

    /// How many there are.
    #[must_use]
    pub fn count(&self) -> usize {
        self.areas.len()
    }

    /// In light, of which each plate mirrors one share and scatters the other on all sides (Lambert's law): `(ρ_s, ρ_d)` of each, or one pair for all.
    ///
    /// # Errors
    /// For shares that are not from 0 to 1, and more than 1 together.
    ///
    /// # Panics
    /// When there are neither one pair nor as many as plates.
    pub fn reflecting(&self, shares: &[[f64; 2]]) -> Result<Surface, Error> {
        for [mirrored, scattered] in shares {
            let both = mirrored + scattered;
            for value in [*mirrored, *scattered, both] {
                finite("coefficients", value)?;
                if !(0.0..=1.0 + ROUNDING).contains(&value) {
                    return Err(Error::OutOfDomain {
                        what: "coefficients",
                        law: "two shares of the light from 0 to 1, mirrored and scattered, with a sum of at most 1",
                        value,
                    });
                }
            }
        }
        self.with_weights(shares, |[mirrored, scattered], area| {
            let absorbed = (1.0 - mirrored) * area;
            [
                absorbed,
                2.0 * mirrored * area,
                2.0 / 3.0 * scattered * area,
            ]
        })
    }

    /// In air, with the drag coefficient of each plate, or one for all.
    ///
    /// # Errors
    /// For a coefficient that is negative or not finite.
    ///
    /// # Panics
    /// When there are neither one coefficient nor as many as plates.
    pub fn dragging(&self, coefficients: &[f64]) -> Result<Surface, Error> {
        for &coefficient in coefficients {
            not_negative("coefficients", coefficient)?;
        }
        self.with_weights(coefficients, |coefficient, area| {
            [coefficient * area, 0.0, 0.0]
        })
    }

    fn with_weights<C: Copy>(
        &self,
        coefficients: &[C],
        weights: impl Fn(C, f64) -> [f64; 3],
    ) -> Result<Surface, Error> {
        let (count, given) = (self.count(), coefficients.len());
        assert!(
            given == 1 || given == count,
            "coefficients of each plate, or of all"
        );
        let mut blocks = vec![Block::default(); count.div_ceil(LANES)];
        let mut is_dull = true;
        for k in 0..count {
            let coefficient = coefficients[if given == 1 { 0 } else { k }];
            let all = weights(coefficient, self.areas[k]);
            all_finite("the areas times their coefficients", &all)?;
            is_dull &= all[1] == 0.0 && all[2] == 0.0;
            let (block, lane) = (&mut blocks[k / LANES], k % LANES);
            for (i, weight) in all.into_iter().enumerate() {
                block.center[i][lane] = self.centers[k][i];
                block.normal[i][lane] = self.normals[k][i];
                block.weights[i][lane] = weight;
            }
        }
        Ok(Surface {
            blocks: blocks.into(),
            is_dull,
        })
    }
}

/// The direction of a vector of any size.
fn unit(what: &'static str, vector: &Vector3<f64>) -> Result<Vector3<f64>, Error> {
    all_finite(what, vector)?;
    let largest = vector.amax();
    if largest == 0.0 {
        return Err(Error::NoDirection { what });
    }
    Ok((vector / largest).normalize())
}

/// A few plates, number by number. A place without a plate has zeros.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Block {
    center: [[f64; LANES]; 3],
    normal: [[f64; LANES]; 3],
    /// a, b, c of [`Surface`].
    weights: [[f64; LANES]; 3],
}

/// Plates that take momentum from what comes from the direction s, with the pressure p:
///
/// ```text
/// F = −p cos θ (a s + (b cos θ + c) n)   where cos θ = s·n > 0,   else 0
/// ```
///
/// with the outward normal n of each plate, and its weights a, b, c: in light `A (1 − ρ_s)`, `2 A ρ_s`, `2/3 A ρ_d`; in air `A C_d`, 0, 0.
#[derive(Clone, Debug, PartialEq)]
pub struct Surface {
    blocks: Arc<[Block]>,
    /// Whether all forces are along s.
    is_dull: bool,
}

impl Surface {
    /// Force, and torque about `point`, for a pressure of −1 from the direction `s`; all in B.
    fn wrench(&self, s: &Vector3<f64>, point: &Vector3<f64>) -> [Vector3<f64>; 2] {
        let (mut along, mut arms) = ([0.0; LANES], [[0.0; LANES]; 3]);
        let (mut push, mut turn) = ([[0.0; LANES]; 3], [[0.0; LANES]; 3]);
        for Block {
            center,
            normal,
            weights,
        } in &*self.blocks
        {
            for l in 0..LANES {
                let n = [normal[0][l], normal[1][l], normal[2][l]];
                let cos = (n[0] * s.x + n[1] * s.y + n[2] * s.z).max(0.0);
                let back = cos * weights[0][l];
                let out = cos * (weights[1][l] * cos + weights[2][l]);
                let arm = [
                    center[0][l] - point.x,
                    center[1][l] - point.y,
                    center[2][l] - point.z,
                ];
                along[l] += back;
                for i in 0..3 {
                    let (j, k) = ((i + 1) % 3, (i + 2) % 3);
                    arms[i][l] += back * arm[i];
                    push[i][l] += out * n[i];
                    turn[i][l] += out * (arm[j] * n[k] - arm[k] * n[j]);
                }
            }
        }
        let sum = |lanes: &[f64; LANES]| lanes.iter().sum::<f64>();
        let vector = |lanes: [[f64; LANES]; 3]| Vector3::from(lanes.each_ref().map(sum));
        [
            s * sum(&along) + vector(push),
            vector(arms).cross(s) + vector(turn),
        ]
    }
}

/// Light or air that plates are in: where it comes from.
///
/// Between samples is a cubic spline, through the directions at unit length or through the velocities; beyond the first and last time
/// nothing is known.
#[derive(Clone, Debug, PartialEq)]
pub struct Stream {
    from: Origin,
    is_air: bool,
}

#[derive(Clone, Debug, PartialEq)]
enum Origin {
    /// A unit vector, and the square of the speed.
    Constant(Vector3<f64>, f64),
    /// Directions or velocities at some times.
    Sampled(Arc<Spline>),
}

impl Stream {
    /// Light from a constant direction: `toward` leads from the body to the Sun, in N. Its length does not count.
    ///
    /// # Errors
    /// When it is zero or not finite.
    pub fn light(toward: &Vector3<f64>) -> Result<Self, Error> {
        Ok(Self {
            from: Origin::Constant(unit("direction", toward)?, 1.0),
            is_air: false,
        })
    }

    /// Light from these directions at the ascending `times`. Now and then `watch` gets a fraction done, and may end it.
    ///
    /// # Errors
    /// As [`Self::light`]; for fewer than two times, times that do not ascend, and neighbouring directions that are a quarter of a turn apart or more;
    /// [`Error::Stopped`].
    ///
    /// # Panics
    /// When `times` and `toward` differ in length.
    pub fn light_sampled(
        times: &[f64],
        toward: &[Vector3<f64>],
        watch: &mut Watch<'_>,
    ) -> Result<Self, Error> {
        let mut units: Vec<Vector3<f64>> = Vec::with_capacity(toward.len());
        each_watched(toward.iter(), watch, |vector| {
            let next = unit("direction", vector)?;
            if let Some(last) = units.last()
                && next.dot(last) <= 0.0
            {
                return Err(Error::OutOfDomain {
                    what: "the angle between two samples of direction",
                    law: "less than a quarter of a turn (give more of them)",
                    value: next.dot(last).clamp(-1.0, 1.0).acos(),
                });
            }
            units.push(next);
            Ok(())
        })?;
        let names = [
            "times",
            "the span of times",
            "direction",
            "the spline through direction",
        ];
        let spline = Spline::through(names, times, &units, watch)?;
        Ok(Self {
            from: Origin::Sampled(Arc::new(spline)),
            is_air: false,
        })
    }

    /// Air through which the body moves with a constant velocity, in N.
    ///
    /// # Errors
    /// When it, or the square of the speed, is not finite.
    pub fn air(velocity: &Vector3<f64>) -> Result<Self, Error> {
        all_finite("velocity", velocity)?;
        let square = finite("the square of velocity", velocity.norm_squared())?;
        let toward = velocity.try_normalize(0.0).unwrap_or_default(); // at rest nothing comes from anywhere
        Ok(Self {
            from: Origin::Constant(toward, square),
            is_air: true,
        })
    }

    /// Air through which the body moves with these velocities at the ascending `times`. Now and then `watch` gets a fraction done, and may end it.
    ///
    /// # Errors
    /// As [`Self::air`]; for fewer than two times, and times that do not ascend; [`Error::Stopped`].
    ///
    /// # Panics
    /// When `times` and `velocities` differ in length.
    pub fn air_sampled(
        times: &[f64],
        velocities: &[Vector3<f64>],
        watch: &mut Watch<'_>,
    ) -> Result<Self, Error> {
        let names = [
            "times",
            "the span of times",
            "velocity",
            "the spline through velocity",
        ];
        let spline = Spline::through(names, times, velocities, watch)?;
        for velocity in velocities {
            finite("the square of velocity", velocity.norm_squared())?;
        }
        Ok(Self {
            from: Origin::Sampled(Arc::new(spline)),
            is_air: true,
        })
    }

    /// The unit vector to where it comes from at time `t`, and the pressure of it: of light as much as `level`, of air of the density
    /// `level` half of it times the square of the speed.
    fn at(&self, t: f64, level: f64) -> (Vector3<f64>, f64) {
        let (toward, square) = match &self.from {
            Origin::Constant(toward, square) => (*toward, *square),
            Origin::Sampled(spline) => {
                let [vector, _] = spline.at(t);
                let square = vector.norm_squared();
                if self.is_air && square == 0.0 {
                    return (Vector3::zeros(), 0.0);
                }
                (vector / square.sqrt(), square)
            }
        };
        let pressure = if self.is_air {
            0.5 * level * square
        } else {
            level
        };
        (toward, pressure)
    }
}

/// Plates that light or air pushes and turns; see [`Surface`]. They throw no shadow on each other.
///
/// The pressure of light, or the density of air, is constant or runs straight between its times. The air is that of a given velocity: it does not
/// depend on the rates of the body.
///
/// The force is continuous, and has a kink where light or air begins to graze a plate.
///
/// # Examples
///
/// ```
/// use std::ops::ControlFlow;
/// use polhode::mass::{Amount, solids};
/// use polhode::motion::loads::{BodyAtPoint, Panels, PiecewiseSignal, Plates, Stream, Surface, Term};
/// use polhode::motion::simulate::{Phase, State};
/// use polhode::nalgebra::{UnitQuaternion, Vector3};
///
/// // A panel of 3 m², 2 m beside the centre of mass, in sunlight of 4.5 µPa: black, and a mirror with twice the force.
/// let mut panel = Plates::default();
/// panel.add(&Vector3::new(2.0, 0.0, 0.0), 3.0, &Vector3::z())?;
/// let sun = Stream::light(&Vector3::z())?;
/// let pressure = PiecewiseSignal::constant("pressure", 4.5e-6)?;
/// let body = BodyAtPoint::free(&solids::sphere(1.0, Amount::Mass(5.0))?, 0.0);
/// let rest = Phase::in_place(&State { attitude: UnitQuaternion::identity(), omega: Vector3::zeros() });
/// let exerted = |surface: Surface, stream: &Stream, level: &PiecewiseSignal| -> Result<_, polhode::Error> {
///     let panels = Panels::new(surface, stream.clone(), level.clone())?;
///     Ok(Term::Panels(panels).wrench(&body, 0.5, &rest))
/// };
/// let black = exerted(panel.reflecting(&[[0.0, 0.0]])?, &sun, &pressure)?;
/// assert_eq!((black.force.z, black.torque.y), (-13.5e-6, 27e-6));
/// assert_eq!(exerted(panel.reflecting(&[[1.0, 0.0]])?, &sun, &pressure)?.force.z, -27e-6);
/// // From behind, a plate feels nothing.
/// let behind = exerted(panel.reflecting(&[[0.0, 0.0]])?, &Stream::light(&-Vector3::z())?, &pressure)?;
/// assert_eq!(behind.force, Vector3::zeros());
///
/// // Air of 1e-12 kg/m³, into which it flies with 8 km/s.
/// let density = PiecewiseSignal::constant("density", 1e-12)?;
/// let drag = exerted(panel.dragging(&[2.0])?, &Stream::air(&Vector3::new(0.0, 0.0, 8e3))?, &density)?;
/// assert!((drag.force.z + 0.5e-12 * 8e3 * 8e3 * 2.0 * 3.0).abs() < 1e-18);
///
/// // Both at times.
/// let (times, go_on) = ([0.0, 1.0], &mut |_: f64| ControlFlow::Continue(()));
/// let moving = Stream::light_sampled(&times, &[Vector3::z(), Vector3::new(0.0, 1.0, 1.0)], go_on)?;
/// let sunset = PiecewiseSignal::table("pressure", &times, &[4.5e-6, 0.0])?;
/// assert!(exerted(panel.reflecting(&[[0.0, 0.0]])?, &moving, &sunset)?.force.z.abs() < 6.75e-6);
/// let slower = Stream::air_sampled(&times, &[Vector3::z() * 8e3, Vector3::z() * 6e3], go_on)?;
/// assert!(exerted(panel.dragging(&[2.0])?, &slower, &density)?.force.z > drag.force.z);
/// # Ok::<(), polhode::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Panels {
    surface: Surface,
    stream: Stream,
    /// The pressure of light, or the density of air.
    level: PiecewiseSignal,
    /// How many times as much they exert.
    factor: f64,
}

impl Panels {
    /// Plates in light with the pressure `level`, or in air with the density `level`.
    ///
    /// # Errors
    /// For a `level` that is negative somewhere.
    pub fn new(surface: Surface, stream: Stream, level: PiecewiseSignal) -> Result<Self, Error> {
        let what = if stream.is_air { "density" } else { "pressure" };
        for &value in level.values() {
            not_negative(what, value)?;
        }
        Ok(Self {
            surface,
            stream,
            level,
            factor: 1.0,
        })
    }

    /// The times at which it is known, of what is known at times: of the stream and of its level.
    fn tables(&self) -> [&[f64]; 2] {
        let stream = match &self.stream.from {
            Origin::Constant(..) => &[],
            Origin::Sampled(spline) => spline.knots(),
        };
        [stream, self.level.times()]
    }
}

impl Law for Panels {
    fn traits(&self, _: bool) -> Traits {
        Traits {
            exerts_force: true,
            depends_on_rates: false,
            needs_body: true,
            needs_epoch: false,
            keeps: match &self.stream.from {
                // All forces are along the stream, wherever they act.
                Origin::Constant(toward, _) if self.surface.is_dull => {
                    ConservedMomentum::along(toward)
                }
                _ => ConservedMomentum::Nothing,
            },
            has_series: false,
        }
    }

    /// Those of a law with a series; it has none.
    fn parameters(&self) -> Vec<Parameter> {
        Vec::new()
    }

    fn scaled(&self, factor: f64) -> Result<Self, Error> {
        Ok(Self {
            factor: finite("the load times its factor", self.factor * factor)?,
            ..self.clone()
        })
    }

    fn with_epoch(self, _: f64) -> Self {
        self
    }

    fn breaks(&self, from: f64, to: f64) -> Vec<f64> {
        let tables = self.tables().into_iter();
        tables
            .flat_map(|table| within(table, from, to))
            .copied()
            .collect()
    }

    fn check(&self, _: &BodyAtPoint, from: f64, to: f64) -> Result<(), Error> {
        for table in self.tables() {
            let (Some(&first), Some(&last)) = (table.first(), table.last()) else {
                continue;
            };
            if let Some(t) = [from, to].into_iter().find(|t| !(first..=last).contains(t)) {
                return Err(Error::Motion(MotionFault::OutsideSamples {
                    t,
                    first,
                    last,
                }));
            }
        }
        Ok(())
    }

    fn wrench(&self, body: &BodyAtPoint, t: f64, phase: &Phase) -> Wrench {
        let [level, _] = self.level.line(t);
        let (toward, pressure) = self.stream.at(t, level);
        let strength = -pressure * self.factor;
        if strength == 0.0 {
            return Wrench::default();
        }
        let toward = phase.attitude.inverse_transform_vector(&toward);
        let [force, torque] = self.surface.wrench(&toward, &body.point);
        Wrench {
            force: phase.attitude * (force * strength),
            torque: torque * strength,
        }
    }

    fn potential(&self, _: &BodyAtPoint, _: &Phase) -> Option<f64> {
        None
    }

    fn add_to<'a, X: LawNumber>(
        &'a self,
        _: &mut SeriesTerms<'a, X>,
        _: &PrincipalFrame<'_, X>,
        _: f64,
    ) {
    }
}

#[cfg(test)]
mod tests {
    use std::ops::ControlFlow;

    use nalgebra::UnitQuaternion;

    use super::*;
    use crate::mass::solids;
    use crate::motion::state::State;

    fn constant(level: f64) -> PiecewiseSignal {
        PiecewiseSignal::constant("level", level).expect("finite")
    }

    #[test]
    fn plates_side_by_side_are_plates_one_by_one() {
        let number = |k: usize, i: usize| ((7 * k + 3 * i) % 11) as f64 / 5.0 - 1.0;
        let vector = |k: usize| Vector3::from_fn(|i, _| number(k, i) + 0.01);
        let body = solids::cuboid(&[1.0, 2.0, 3.0], Amount::Mass(2.0)).expect("a body");
        let body = BodyAtPoint {
            point: Vector3::new(0.3, -0.2, 0.1),
            ..BodyAtPoint::free(&body, 0.0)
        };
        let phase = Phase::in_place(&State {
            attitude: UnitQuaternion::from_euler_angles(0.3, -0.8, 2.0),
            omega: Vector3::zeros(),
        });
        for count in [0, 1, 3, 4, 5, 8, 11] {
            let mut all = Plates::default();
            let (mut apart, mut scale) = (Wrench::default(), 0.0);
            let stream = Stream::light(&Vector3::new(0.3, 0.5, -0.7)).expect("a direction");
            for k in 0..count {
                let mut one = Plates::default();
                for plates in [&mut one, &mut all] {
                    (plates.add(&vector(k), 0.5 + k as f64, &vector(k + 5))).expect("a plate");
                }
                let surface = one.reflecting(&[[0.3, 0.2]]).expect("shares");
                let panel = Panels::new(surface, stream.clone(), constant(2.0)).expect("positive");
                let exerted = panel.wrench(&body, 0.0, &phase);
                apart += exerted;
                scale += exerted.force.norm() + exerted.torque.norm();
            }
            let surface = all.reflecting(&[[0.3, 0.2]]).expect("shares");
            let together = Panels::new(surface, stream, constant(2.0)).expect("positive");
            let together = together.wrench(&body, 0.0, &phase);
            assert!((together.force - apart.force).norm() <= 1e-15 * scale);
            assert!((together.torque - apart.torque).norm() <= 1e-15 * scale);
        }
    }

    #[test]
    fn what_cannot_be_is_refused() {
        let mut plates = Plates::default();
        assert!(plates.add(&Vector3::zeros(), -1e-9, &Vector3::x()).is_err());
        assert!(
            plates
                .add(&Vector3::zeros(), 1.0, &Vector3::zeros())
                .is_err()
        );
        assert!(
            plates
                .add(&Vector3::zeros(), 0.0, &(Vector3::x() * 1e-300))
                .is_ok()
        );
        for (shares, is_right) in [
            ([0.0, 0.0], true),
            ([1.0, 0.0], true),
            ([0.7, 0.3 + 1e-16], true),
            ([0.7, 0.3 + 1e-14], false),
            ([-1e-9, 0.5], false),
            ([0.5, -1e-9], false),
            ([f64::NAN, 0.5], false),
        ] {
            assert_eq!(plates.reflecting(&[shares]).is_ok(), is_right, "{shares:?}");
        }
        assert!(plates.dragging(&[0.0]).is_ok() && plates.dragging(&[-1e-9]).is_err());
        assert!(Stream::light(&Vector3::zeros()).is_err());
        assert!(Stream::air(&Vector3::repeat(1e200)).is_err());
        let surface = plates.dragging(&[2.2]).expect("positive");
        let still = Stream::air(&Vector3::zeros()).expect("at rest");
        assert!(Panels::new(surface, still, constant(-1e-9)).is_err());
    }

    #[test]
    fn directions_have_unit_length_between_samples() {
        let go_on = &mut |_: f64| ControlFlow::Continue(());
        let toward = [
            Vector3::x() * 7.0,
            Vector3::new(1.0, 1.0, 0.0),
            Vector3::y(),
        ];
        let times = [0.0, 1.0, 2.0];
        let light = Stream::light_sampled(&times, &toward, go_on).expect("near each other");
        let air = Stream::air_sampled(&times, &toward, go_on).expect("finite");
        for t in [0.0, 0.3, 1.0, 1.9, 2.0] {
            let (direction, pressure) = light.at(t, 3.0);
            assert!((direction.norm() - 1.0).abs() < 1e-15);
            assert_eq!(pressure, 3.0);
            assert!((air.at(t, 3.0).0.norm() - 1.0).abs() < 1e-15);
        }
        assert!((air.at(0.0, 3.0).1 - 73.5).abs() < 1e-13);
        // A quarter of a turn apart, and less.
        let apart = |y: f64| [Vector3::x(), Vector3::new(y, 1.0, 0.0)];
        assert!(Stream::light_sampled(&times[..2], &apart(0.0), go_on).is_err());
        assert!(Stream::light_sampled(&times[..2], &apart(1e-9), go_on).is_ok());
    }
}
