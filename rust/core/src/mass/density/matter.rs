//! The density over a region as an integrand: what is asked of it at points, and what errors count for.

use nalgebra::Vector3;

use super::scaled::Scaled;
use super::total::{Moments, Total, about, middle};
use crate::error::Error;
use crate::mass::regions::Region;
use crate::numerics::power_of_two::halves;
use crate::numerics::quadrature::{Cell, Integrand, Leaf};

/// The density over a region as mass, first and second moments about the middle of each cell.
pub(super) struct Matter<'a, F> {
    /// In units of its size, `2^length`.
    pub(super) region: &'a Region,
    pub(super) density: Scaled<F>,
    pub(super) length: i32,
}

impl<E, F> Integrand<3, 10> for Matter<'_, F>
where
    E: From<Error>,
    F: FnMut(&[[f64; 3]], &mut [f64]) -> Result<(), E>,
{
    type Error = E;

    fn values(
        &mut self,
        cells: &[Cell<3>],
        points: &[[f64; 3]],
        values: &mut [Moments],
    ) -> Result<(), E> {
        let each = points.len() / cells.len().max(1);
        let placed: Vec<(Vector3<f64>, f64)> = (points.iter().enumerate())
            .map(|(i, parameters)| self.region.point(cells[i / each].chart, parameters))
            .collect();
        let [a, b] = halves(self.length);
        let positions: Vec<[f64; 3]> = placed
            .iter()
            .map(|(at, _)| at.map(|x| x * a * b).into())
            .collect();
        let densities = self.density.at(&positions, |&point| point)?;
        for (i, ((at, element), rho)) in placed.iter().zip(densities).enumerate() {
            let d = at - middle(self.region, &cells[i / each]);
            let w = rho * element;
            let wd = d * w;
            values[i] = [
                w,
                wd.x,
                wd.y,
                wd.z,
                wd.x * d.x,
                wd.x * d.y,
                wd.x * d.z,
                wd.y * d.y,
                wd.y * d.z,
                wd.z * d.z,
            ];
        }
        Ok(())
    }

    fn errors(&self, leaves: &[Leaf<3, 10>]) -> Vec<[f64; 3]> {
        let total = Total::of(self.region, leaves);
        if total.mass <= 0.0 {
            return vec![[0.0; 3]; leaves.len()]; // nothing there to refine
        }
        let (width, spread) = (total.width(), total.second.trace());
        // A spread that is none yet, as of signed charts that cancel, says nothing.
        let relative = |value: f64, scale: f64| match value / scale {
            _ if value == 0.0 => 0.0,
            relative if relative >= 0.0 => relative,
            _ => f64::INFINITY,
        };
        leaves
            .iter()
            .map(|leaf| {
                let q = middle(self.region, &leaf.cell) - total.center;
                leaf.differences.map(|difference| {
                    let (mass, first, second) = about(&difference, &q);
                    relative(mass.abs(), total.mass)
                        .max(relative(first.amax(), total.mass * width))
                        .max(relative(second.amax(), spread))
                })
            })
            .collect()
    }
}
