//! Every constructor of a body.

use arbitrary::Result;
use nalgebra::{Matrix3, Matrix4, Matrix6};
use polhode::error::Error;
use polhode::mass::density::{Effort, from_density, from_radial_density};
use polhode::mass::forms::SpatialOrder;
use polhode::mass::particles::{labelled_particles, particles};
use polhode::mass::polyhedron::closure::{close_with_caps, close_with_hull};
use polhode::mass::polyhedron::{Options, polyhedron_watched};
use polhode::mass::regions::Region;
use polhode::mass::surface::{area, surface};
use polhode::mass::tetrahedra::{CellDensity, tetrahedra};
use polhode::mass::thick_shell::thick_shell;
use polhode::mass::voxels::{Grid, voxels};
use polhode::mass::{Amount, curve, laminae, rods, solids};
use polhode::{Error as Fault, RigidBody};

use crate::draw::{Draw, patience};
use crate::laws::is_body;
use crate::meshes::mesh;
use crate::uses::used;

/// Takes the bytes as what a body is made of, makes it, and uses it.
///
/// # Panics
/// When a law is broken.
pub fn run(data: &[u8]) {
    let _ = Draw::new(data).and_then(one);
}

fn one(mut draw: Draw<'_>) -> Result<()> {
    let (body, admitted) = any(&mut draw)?;
    if let Some(body) = body {
        is_body(&body, admitted);
        used(&body, &mut draw, admitted)?;
    }
    Ok(())
}

/// A body, if what was drawn makes one, and the violation of laws it may have.
///
/// # Errors
/// When the bytes are used up.
pub fn any(draw: &mut Draw<'_>) -> Result<(Option<RigidBody>, f64)> {
    let mut admitted = 0.0;
    let body = match draw.up_to(13)? {
        0 => {
            let rtol = draw.one_of(&[0.0, 0.0, 1e-6, 1e-3])?;
            admitted = rtol;
            of_tensor(draw, rtol)?.ok()
        }
        1 => of_form(draw)?.ok(),
        2 => of_particles(draw)?,
        3 | 4 => of_mesh(draw)?,
        5 | 6 => of_cells(draw)?.ok(),
        7 => of_voxels(draw)?.ok(),
        8 | 9 => solid(draw)?.ok(),
        10 => flat(draw)?.ok(),
        11 => of_density(draw)?.ok(),
        12 => {
            let points = draw.list(8, Draw::numbers)?;
            curve::curve(&points, amount(draw)?, &mut patience(1000)).ok()
        }
        _ => {
            let parts = draw.list(3, solid)?;
            let parts: Vec<RigidBody> = parts.into_iter().flatten().collect();
            polhode::mass::assemblies::combined(&parts).ok()
        }
    };
    Ok((body, admitted))
}

/// A body with moments of ordinary sizes.
///
/// # Errors
/// When the bytes are used up.
pub fn tame(draw: &mut Draw<'_>) -> Result<Option<RigidBody>> {
    let [a, b, c] = draw.numbers::<3>()?.map(f64::abs);
    let moments = match draw.up_to(5)? {
        0 => [a, a, a],
        1 => [a + b, a + b, 2.0 * a],
        2 => [0.0, a, a],
        _ => [b + c, c + a, a + b],
    };
    let (axes, center) = (draw.rotation()?, draw.vector()?);
    Ok(RigidBody::from_principal(draw.positive()?, &moments, &axes, &center, 0.0).ok())
}

fn amount(draw: &mut Draw<'_>) -> Result<Amount> {
    let number = draw.positive()?;
    Ok(if draw.coin()? {
        Amount::Mass(number)
    } else {
        Amount::Density(number)
    })
}

type Made = core::result::Result<RigidBody, Fault>;

fn of_tensor(draw: &mut Draw<'_>, rtol: f64) -> Result<Made> {
    let (mass, center) = (draw.positive()?, draw.vector()?);
    Ok(match draw.up_to(3)? {
        0 => RigidBody::from_principal(mass, &draw.numbers()?, &draw.rotation()?, &center, rtol),
        1 => {
            let (moments, products) = (draw.numbers()?, draw.numbers()?);
            RigidBody::from_positive_products(mass, &moments, &products, &center, rtol)
        }
        kind => {
            let spread = draw.symmetric()?;
            // The square of a symmetric matrix is a second moment; so most are possible.
            let tensor = if draw.coin()? {
                let second = spread * spread;
                Matrix3::identity() * second.trace() - second
            } else {
                spread
            };
            let tensor = (tensor + tensor.transpose()) * 0.5;
            if kind == 2 {
                RigidBody::new(mass, &tensor, &center, rtol)
            } else {
                RigidBody::from_inertia_about_origin(mass, &tensor, &center, rtol)
            }
        }
    })
}

fn of_form(draw: &mut Draw<'_>) -> Result<Made> {
    Ok(match draw.up_to(3)? {
        0 => RigidBody::from_parameters(&draw.numbers()?, 0.0),
        1 => {
            let half = Matrix4::from_row_slice(&draw.numbers::<16>()?);
            RigidBody::from_pseudo_inertia(&(half * half.transpose()), 0.0)
        }
        2 => RigidBody::from_spatial_inertia(
            &Matrix6::from_row_slice(&draw.numbers::<36>()?),
            SpatialOrder::LinearAngular,
            0.0,
        ),
        _ => RigidBody::from_log_cholesky(&draw.numbers()?),
    })
}

fn of_particles(draw: &mut Draw<'_>) -> Result<Option<RigidBody>> {
    let masses = draw.list(8, Draw::positive)?;
    let positions = masses
        .iter()
        .map(|_| draw.numbers())
        .collect::<Result<Vec<_>>>()?;
    let labels = masses
        .iter()
        .map(|_| draw.one_of(&[-1, 0, 1, 2]))
        .collect::<Result<Vec<_>>>()?;
    if let Ok(bodies) = labelled_particles(&masses, &positions, &labels, &mut patience(1000)) {
        for body in &bodies {
            is_body(body, 0.0);
        }
    }
    Ok(particles(&masses, &positions).ok())
}

fn of_mesh(draw: &mut Draw<'_>) -> Result<Option<RigidBody>> {
    let mesh = mesh(draw)?;
    let (vertices, faces) = (&mesh.vertices, &mesh.faces);
    let amount = amount(draw)?;
    let (orient, check) = (draw.coin()?, draw.up_to(3)? > 0);
    let options = Options { orient, check };
    let watch = &mut patience(1000);
    if let Ok(area) = area(vertices, faces, watch) {
        assert!(area >= 0.0, "area {area:?}");
    }
    let kind = draw.up_to(5)?;
    let body = match kind {
        0 => surface(vertices, faces, amount, watch).ok(),
        1 => close_with_caps(vertices, faces, amount, options, watch)
            .map(|solid| solid.body)
            .ok(),
        2 => {
            let hull = mesh.faces.iter().rev().copied().collect::<Vec<_>>();
            close_with_hull(vertices, faces, &hull, amount, watch)
                .map(|solid| solid.body)
                .ok()
        }
        3 => thick_shell(vertices, faces, draw.positive()?, amount, watch).ok(),
        _ => polyhedron_watched(vertices, faces, amount, options, watch)
            .map(|solid| solid.body)
            .ok(),
    };
    // What nobody checked may be no body.
    if !check && !matches!(kind, 0 | 2 | 3) {
        return Ok(None);
    }
    if let (Some(body), Amount::Mass(mass)) = (&body, amount) {
        assert_eq!(body.mass(), mass, "a mass that was given");
    }
    Ok(body)
}

fn of_cells(draw: &mut Draw<'_>) -> Result<Made> {
    let mut nodes: Vec<[f64; 3]> = draw.list(7, Draw::numbers)?;
    // A nearly flat cell is where digits are lost.
    if nodes.len() >= 4 && draw.coin()? {
        let small = draw.tiny()?;
        let weight = draw.numbers::<3>()?;
        let off = draw.number()? * small;
        let mut flat = [off; 3];
        for k in 0..3 {
            flat[k] += (0..3).map(|j| weight[j] * nodes[j][k]).sum::<f64>();
        }
        nodes[3] = flat;
    }
    let last = nodes.len();
    let cells = draw.list(5, |draw| {
        Ok([
            draw.up_to(last)?,
            draw.up_to(last)?,
            draw.up_to(last)?,
            draw.up_to(last)?,
        ])
    })?;
    let cells = if cells.is_empty() {
        vec![[0, 1, 2, 3]]
    } else {
        cells
    };
    let watch = &mut patience(1000);
    Ok(match draw.up_to(2)? {
        0 => tetrahedra(
            &nodes,
            &cells,
            CellDensity::Uniform(draw.positive()?),
            watch,
        ),
        1 => {
            let density = cells
                .iter()
                .map(|_| draw.positive())
                .collect::<Result<Vec<_>>>()?;
            tetrahedra(&nodes, &cells, CellDensity::PerCell(&density), watch)
        }
        _ => {
            let density = nodes
                .iter()
                .map(|_| draw.positive())
                .collect::<Result<Vec<_>>>()?;
            tetrahedra(&nodes, &cells, CellDensity::PerNode(&density), watch)
        }
    })
}

fn of_voxels(draw: &mut Draw<'_>) -> Result<Made> {
    let shape = [draw.up_to(3)?, draw.up_to(3)?, draw.up_to(3)?];
    let count = shape.iter().product();
    let density = (0..count)
        .map(|_| draw.positive())
        .collect::<Result<Vec<f64>>>()?;
    let spacing = [draw.positive()?, draw.positive()?, draw.positive()?];
    let origin = draw.numbers()?;
    let grid = Grid::of_boxes(&density, shape, spacing, origin);
    Ok(grid.and_then(|grid| voxels(&grid, &mut patience(1000))))
}

fn solid(draw: &mut Draw<'_>) -> Result<Made> {
    let kind = draw.up_to(14)?;
    let (a, b, c) = (draw.positive()?, draw.positive()?, draw.positive()?);
    let amount = amount(draw)?;
    let sides = u32::try_from(draw.up_to(12)?).unwrap_or(0);
    Ok(match kind {
        0 => solids::cuboid(&[a, b, c], amount),
        1 => solids::cube(a, amount),
        2 => solids::sphere(a, amount),
        3 => solids::hollow_sphere(a, b, amount),
        4 => solids::ellipsoid(&[a, b, c], amount),
        5 => solids::cylinder(a, b, amount),
        6 => solids::tube(a, b, c, amount),
        7 => solids::cone(a, b, amount),
        8 => solids::frustum(a, b, c, amount),
        9 => solids::capsule(a, b, amount),
        10 => solids::torus(a, b, amount),
        11 => solids::hemisphere(a, amount),
        12 => solids::prism(sides, a, b, amount),
        13 => solids::pyramid(&[a, b, c], amount),
        _ => {
            if draw.coin()? {
                solids::wedge(&[a, b, c], amount)
            } else {
                solids::tetrahedron(a, amount)
            }
        }
    })
}

fn flat(draw: &mut Draw<'_>) -> Result<Made> {
    let kind = draw.up_to(9)?;
    let (a, b) = (draw.positive()?, draw.positive()?);
    let amount = amount(draw)?;
    Ok(match kind {
        0 => laminae::disk(a, amount),
        1 => laminae::annulus(a, b, amount),
        2 => laminae::ellipse(&[a, b], amount),
        3 => laminae::rectangle(&[a, b], amount),
        4 => {
            let corners = [draw.numbers()?, draw.numbers()?, draw.numbers()?];
            laminae::triangle(&corners, amount)
        }
        5 => rods::rod(a, amount),
        6 => rods::ring(a, amount),
        7 => rods::arc(a, b, amount),
        _ => {
            let corners = draw.list(9, Draw::numbers)?;
            laminae::polygon(&corners, amount, &mut patience(1000))
        }
    })
}

fn of_density(draw: &mut Draw<'_>) -> Result<Made> {
    let effort = Effort {
        rtol: draw.one_of(&[1e-3, 1e-6, 1e-9, 0.0, 2.0])?,
        max_evaluations: draw.one_of(&[0, 100, 20_000])?,
    };
    let [constant, slope, curve] = draw.numbers()?;
    let jump = draw.number()?;
    let law = |x: f64| {
        let rho = constant + slope * x + curve * x * x;
        if x > jump { rho.abs() } else { rho.abs() * 0.5 }
    };
    if draw.up_to(2)? == 0 {
        let boundaries = draw.list(4, Draw::positive)?;
        let density = |radii: &[f64], out: &mut [f64]| {
            out.iter_mut()
                .zip(radii)
                .for_each(|(out, &r)| *out = law(r));
            Ok::<(), Error>(())
        };
        return Ok(from_radial_density(&boundaries, density, effort)
            .and_then(|found| found.require_converged()));
    }
    let region = match draw.up_to(4)? {
        0 => Region::cuboid(&draw.vector()?, &draw.vector()?),
        1 => Region::ball(draw.positive()?, &draw.vector()?, draw.positive()?),
        2 => Region::ellipsoid(&draw.vector()?, &draw.vector()?),
        3 => Region::cylinder(
            draw.positive()?,
            draw.positive()?,
            &draw.vector()?,
            draw.positive()?,
        ),
        _ => {
            let mesh = mesh(draw)?;
            Region::mesh(&mesh.vertices, &mesh.faces, &mut patience(1000))
        }
    };
    let density = |points: &[[f64; 3]], out: &mut [f64]| {
        out.iter_mut()
            .zip(points)
            .for_each(|(out, p)| *out = law(p[0]));
        Ok::<(), Error>(())
    };
    Ok(region
        .and_then(|region| from_density(&region, density, effort))
        .and_then(|found| found.require_converged()))
}
