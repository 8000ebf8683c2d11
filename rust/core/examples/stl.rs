//! A part from a binary STL: `cargo run --example stl PART.stl DENSITY`; without a name, a tetrahedron that it writes first.

use std::error::Error;
use std::{env, fs};

use polhode::io::stl;
use polhode::mass::Amount;
use polhode::mass::polyhedron::polyhedron;

fn main() -> Result<(), Box<dyn Error>> {
    let mut words = env::args().skip(1);
    let path = match words.next() {
        Some(path) => path.into(),
        None => tetrahedron()?,
    };
    let density = words.next().map_or(Ok(1000.0), |word| word.parse())?;
    let mesh = stl::read_file(&path)?;
    let body = polyhedron(&mesh.vertices, &mesh.faces, Amount::Density(density), false)?;
    println!(
        "{}: {} triangles, {} kg",
        path.display(),
        mesh.faces.len(),
        body.mass()
    );
    println!("inertia about the centre of mass{}", body.inertia());
    println!("which is off by at most {:.1e}", body.error_bound().inertia);
    Ok(())
}

/// The corner of a cube, as a file.
fn tetrahedron() -> std::io::Result<std::path::PathBuf> {
    let corners: [[f32; 3]; 4] = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let mut bytes = vec![b' '; 80];
    bytes.extend(4_u32.to_le_bytes());
    for face in [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]] {
        bytes.extend([0; 12]);
        bytes.extend(
            face.iter()
                .flat_map(|&k: &usize| corners[k])
                .flat_map(f32::to_le_bytes),
        );
        bytes.extend([0; 2]);
    }
    let path = env::temp_dir().join("polhode-tetrahedron.stl");
    fs::write(&path, bytes)?;
    Ok(path)
}
