//! A T-handle from two bars, and what a composite says when more is taken out than is there.

use polhode::Error;
use polhode::mass::{Amount, solids};
use polhode::nalgebra::Vector3;

fn main() -> Result<(), Error> {
    let bar = solids::cuboid(&[0.080, 0.012, 0.012], Amount::Density(7850.0))?;
    let stem = solids::cuboid(&[0.012, 0.012, 0.048], Amount::Density(7850.0))?
        .translated(&Vector3::new(0.0, 0.0, -0.030))?;
    let handle = bar.combined(&stem)?;
    println!(
        "mass {:.6} kg, centre {:.6?}",
        handle.mass(),
        handle.center_of_mass().as_slice()
    );
    println!(
        "moments {:.4?} kg mm²",
        handle.principal().moments.map(|moment| moment * 1e6)
    );
    // A part that was never there cannot be taken out.
    println!(
        "{}",
        stem.without(&bar)
            .map_or_else(|error| error.to_string(), |_| "a body".to_owned())
    );
    Ok(())
}
