//! Attitudes, Euler angles, kinematics, principal axes.

use std::ops::ControlFlow;

use arbitrary::Result;
use nalgebra::{Matrix3, Vector3};
use polhode::motion::attitude::{self, from_components, from_matrix, normalize};
use polhode::motion::euler_angles::{SINGULAR, Sequence};
use polhode::motion::free_precession::free_precession;
use polhode::motion::kinematics::{Frame, point_acceleration, point_velocity, transport};
use polhode::motion::stability::stability;
use polhode::principal::axes::{principal_axes_many, principal_moments_many};
use polhode::principal::{
    PrincipalAxes, SymmetricTop, TOP_RTOL, canonical, classify, derivative, gaps, principal_axes,
    ray_kappa,
};

use crate::draw::Draw;
use crate::laws::{LEAST, diagonalizes, is_rotation, is_unit, size};

/// Takes the bytes as attitudes, angles or tensors.
///
/// # Panics
/// When a law is broken.
pub fn run(data: &[u8]) {
    let _ = Draw::new(data).and_then(one);
}

fn one(mut draw: Draw<'_>) -> Result<()> {
    match draw.up_to(3)? {
        0 => euler(draw),
        1 => attitudes(draw),
        2 => kinematics(draw),
        _ => tensors(draw),
    }
}

const SEQUENCES: [&str; 24] = [
    "XYX", "XYZ", "XZX", "XZY", "YXY", "YXZ", "YZX", "YZY", "ZXY", "ZXZ", "ZYX", "ZYZ", "xyx",
    "xyz", "xzx", "xzy", "yxy", "yxz", "yzx", "yzy", "zxy", "zxz", "zyx", "zyz",
];

fn euler(mut draw: Draw<'_>) -> Result<()> {
    let Ok(sequence) = draw.one_of(&SEQUENCES)?.parse::<Sequence>() else {
        return Ok(());
    };
    let angles = draw.numbers()?;
    match sequence.to_quaternion(&angles) {
        Ok(q) => {
            is_unit(&q);
            if let Ok(back) = sequence.from_quaternion(&q) {
                assert!(back.iter().all(|angle| angle.abs() <= std::f64::consts::PI));
                let again = sequence
                    .to_quaternion(&back)
                    .map(|again| again.angle_to(&q));
                assert!(
                    matches!(again, Ok(turn) if turn <= 1e-7),
                    "{sequence} {angles:?} comes back as {back:?}, off by {again:?}"
                );
            }
        }
        Err(_) => assert!(angles.iter().any(|angle| !angle.is_finite())),
    }
    let q = draw.attitude()?;
    if let Ok(back) = sequence.from_quaternion(&q) {
        let again = sequence
            .to_quaternion(&back)
            .map(|again| again.angle_to(&q));
        assert!(matches!(again, Ok(turn) if turn <= 1e-7), "{q:?} {again:?}");
    }
    let (rates, omega) = (draw.numbers()?, draw.vector()?);
    let is_tame = angles
        .iter()
        .chain(&rates)
        .chain(&omega)
        .all(|x| x.abs() < 1e6);
    for frame in [Frame::Body, Frame::Space] {
        let turning = sequence.angular_velocity(&angles, &rates, frame);
        let back = sequence.rates(&angles, &omega, frame);
        if !is_tame {
            continue;
        }
        assert!(turning.iter().all(|x| x.is_finite()));
        if let Ok(back) = back {
            // As good as the middle angle is far from where they are not defined.
            let again = sequence.angular_velocity(&angles, &back, frame);
            let largest = Vector3::from(back).amax().max(omega.amax());
            assert!(
                (again - omega).amax() <= 1e-14 * largest + LEAST,
                "{sequence} {angles:?} {omega:?} {again:?}"
            );
            assert!(largest * SINGULAR <= 8.0 * omega.amax() + LEAST, "{back:?}");
        }
        assert!(sequence.middle_rate(&angles, &omega, frame).abs() <= 3.0 * omega.amax() + LEAST);
    }
    Ok(())
}

fn attitudes(mut draw: Draw<'_>) -> Result<()> {
    let numbers: [f64; 4] = draw.numbers()?;
    if let Ok(q) = from_components("attitude", &numbers) {
        is_unit(&q);
        let components = attitude::components(&q);
        let off = components.iter().zip(numbers).map(|(a, b)| (a - b).abs());
        assert!(off.fold(0.0, f64::max) <= 2e-8);
    }
    let q = draw.attitude()?;
    is_unit(&normalize(q.as_ref()));
    assert!(from_components("attitude", &attitude::components(&q)).is_ok());
    let R = q.to_rotation_matrix().into_inner();
    let back = from_matrix(&R);
    assert!(matches!(&back, Ok(back) if back.w >= 0.0 && back.angle_to(&q) <= 1e-7));
    if let Ok(q) = from_matrix(&draw.rotation()?) {
        is_unit(&q);
    }
    Ok(())
}

fn kinematics(mut draw: Draw<'_>) -> Result<()> {
    let (a, b, c, d) = (
        draw.vector()?,
        draw.vector()?,
        draw.vector()?,
        draw.vector()?,
    );
    let all = [
        point_velocity(&a, &b, &c),
        point_acceleration(&a, &b, &c, &d),
        transport(&a, &b, &c),
    ];
    let is_tame = [a, b, c, d].iter().flatten().all(|x| x.abs() < 1e100);
    assert!(!is_tame || all.iter().flatten().all(|x| x.is_finite()));
    let moments: [f64; 3] = draw.numbers()?;
    let mut ascending = moments;
    ascending.sort_by(f64::total_cmp);
    let _ = (ray_kappa(&ascending), stability(&ascending, draw.number()?));
    let top = classify(&ascending, draw.number()?);
    assert!(!top.as_str().is_empty());
    let principal = PrincipalAxes {
        moments: ascending,
        axes: draw.attitude()?.to_rotation_matrix().into_inner(),
    };
    if let Ok(top) = SymmetricTop::of(&principal, draw.number()?) {
        let _ = free_precession(&top, &draw.vector()?);
    }
    Ok(())
}

fn tensors(mut draw: Draw<'_>) -> Result<()> {
    let tensors = draw.list(9, Draw::symmetric)?;
    let rows: Vec<[f64; 9]> = tensors
        .iter()
        .map(|a| a.as_slice().try_into().unwrap_or([0.0; 9]))
        .collect();
    let mut moments = vec![[0.0; 3]; rows.len()];
    let mut alone = moments.clone();
    let mut axes = vec![[0.0; 9]; rows.len()];
    let watch = &mut |_: f64| ControlFlow::Continue(());
    let done = principal_axes_many(&rows, 0.0, &mut moments, &mut axes, watch);
    assert!(done.is_ok(), "{done:?}");
    assert!(principal_moments_many(&rows, 0.0, &mut alone, watch).is_ok());
    for (k, tensor) in tensors.iter().enumerate() {
        let principal = principal_axes(tensor);
        let of_row = Matrix3::from_row_slice(&axes[k]);
        let bits = |numbers: &[f64]| numbers.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
        if tensor.iter().any(|x| !x.is_finite()) {
            assert!(principal.moments.iter().all(|x| x.is_nan()));
            assert!(moments[k].iter().all(|x| x.is_nan()));
            continue;
        }
        assert_eq!(bits(&principal.moments), bits(&moments[k]), "{tensor:?}");
        assert_eq!(
            bits(principal.axes.as_slice()),
            bits(of_row.as_slice()),
            "{tensor:?}"
        );
        assert_eq!(bits(&moments[k]), bits(&alone[k]), "{tensor:?}");
        // Beyond the largest number the moments have none.
        if size(tensor) > 5e307 {
            continue;
        }
        diagonalizes(&principal, tensor, 0.0);
        let [low, high] = gaps(&principal.moments);
        assert!(
            low >= 0.0 && high >= 0.0 || principal.moments[0] < 0.0,
            "gaps {low} {high}"
        );
        let chosen = canonical(&principal, TOP_RTOL);
        is_rotation(&chosen.axes);
        assert_eq!(chosen.moments, principal.moments);
        let tangent = draw.symmetric()?;
        let change = derivative(&principal, &tangent, 1e-12);
        let is_finite = tangent.iter().all(|x| x.is_finite());
        if is_finite && size(&tangent) < 1e100 && (1e-100..1e100).contains(&size(tensor)) {
            assert!(
                change
                    .moments
                    .iter()
                    .chain(&change.axes)
                    .all(|x| x.is_finite())
            );
            let trace: f64 = change.moments.iter().sum();
            assert!((trace - tangent.trace()).abs() <= 1e-13 * size(&tangent) + LEAST);
        }
    }
    Ok(())
}
