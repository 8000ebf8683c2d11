//! The compositions of drifts and kicks in a step.

/// A symmetric composition of drifts and kicks that begins and ends with a drift.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Scheme {
    /// Half a drift, a kick, half a drift: order 2, one kick a step.
    Strang,
    /// SRKN6(14a): order 6 for kinetic energies that are quadratic in the momenta, fourteen kicks a step.
    ///
    /// Source: Blanes and Moan, J. Comput. Appl. Math. 142 (2002) 313.
    RungeKuttaNystrom6,
    /// ABA864: orders 8, 6 and 4 in a load that is weak to the first, second and third power; seven kicks a step.
    ///
    /// Source: Blanes, Casas, Farrés, Laskar, Makazaga and Murua, Appl. Numer. Math. 68 (2013) 58.
    NearlyFree864,
}

const SRKN6_DRIFTS: [f64; 8] = [
    0.037_859_319_840_611_6,
    0.102_635_633_102_435,
    -0.025_867_888_266_558_7,
    0.314_241_403_071_447,
    -0.130_144_459_517_415,
    0.106_417_700_369_543,
    -0.008_794_243_128_510_58,
    0.207_305_069_056_895_36, // so that all make one step
];
const SRKN6_KICKS: [f64; 7] = [
    0.091_719_152_624_461_65,
    0.183_983_170_005_006,
    -0.056_534_365_832_888_27,
    0.004_914_688_774_712_854,
    0.143_761_127_168_358,
    0.328_567_693_746_804,
    -0.196_411_466_486_454_22, // so that all make one step
];
const ABA864_DRIFTS: [f64; 4] = [
    0.071_133_426_498_223_12,
    0.241_153_427_956_640_1,
    0.521_411_761_772_814_8,
    -0.333_698_616_227_678,
];
const ABA864_KICKS: [f64; 4] = [
    0.183_083_687_472_197_22,
    0.310_782_859_898_574_87,
    -0.026_564_618_511_958_8,
    0.065_396_142_282_373_42,
];

impl Scheme {
    /// All of them, those of fewest kicks first.
    pub(crate) const ALL: [Self; 3] = [Self::Strang, Self::NearlyFree864, Self::RungeKuttaNystrom6];

    /// Return the number of kicks in a step.
    #[must_use]
    pub(crate) fn kicks(self) -> usize {
        match self {
            Self::Strang => 1,
            Self::NearlyFree864 => 7,
            Self::RungeKuttaNystrom6 => 14,
        }
    }

    /// Return the order of the method, for a load that is not weak.
    #[must_use]
    pub(crate) fn order(self) -> i32 {
        match self {
            Self::Strang => 2,
            Self::NearlyFree864 => 4,
            Self::RungeKuttaNystrom6 => 6,
        }
    }

    /// Return the length of the drift before kick i, or of the last drift, relative to the step.
    #[must_use]
    pub(crate) fn drift(self, i: usize) -> f64 {
        let i = i.min(self.kicks() - i);
        match self {
            Self::Strang => 0.5,
            Self::NearlyFree864 => ABA864_DRIFTS[i],
            Self::RungeKuttaNystrom6 => SRKN6_DRIFTS[i],
        }
    }

    /// Return the strength of kick i, relative to the step.
    #[must_use]
    pub(crate) fn kick(self, i: usize) -> f64 {
        let i = i.min(self.kicks() - 1 - i);
        match self {
            Self::Strang => 1.0,
            Self::NearlyFree864 => ABA864_KICKS[i],
            Self::RungeKuttaNystrom6 => SRKN6_KICKS[i],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn drifts_and_kicks_make_one_step() {
        for scheme in Scheme::ALL {
            let drifts: f64 = (0..=scheme.kicks()).map(|i| scheme.drift(i)).sum();
            let kicks: f64 = (0..scheme.kicks()).map(|i| scheme.kick(i)).sum();
            assert!((drifts - 1.0).abs() < 4e-16 && (kicks - 1.0).abs() < 4e-16);
        }
    }

    /// ẍ = −ε sin x from (0.7, 1.3) for a time of 2.
    fn pendulum(scheme: Scheme, steps: i32, strength: f64) -> (f64, f64) {
        let h = 2.0 / f64::from(steps);
        let (mut x, mut v) = (0.7_f64, 1.3);
        for _ in 0..steps {
            for i in 0..=scheme.kicks() {
                x += scheme.drift(i) * h * v;
                if i < scheme.kicks() {
                    v -= strength * scheme.kick(i) * h * x.sin();
                }
            }
        }
        (x, v)
    }

    #[test]
    fn orders_are_those_of_the_sources() {
        let error = |scheme, steps, strength| {
            let (x, v) = pendulum(scheme, steps, strength);
            let exact = pendulum(Scheme::RungeKuttaNystrom6, 64, strength);
            f64::hypot(x - exact.0, v - exact.1)
        };
        for (scheme, steps, order) in [
            (Scheme::Strang, 16, 2.0),
            (Scheme::NearlyFree864, 4, 4.0),
            (Scheme::RungeKuttaNystrom6, 1, 6.0),
        ] {
            let measured = (error(scheme, steps, 1.0) / error(scheme, 2 * steps, 1.0)).log2();
            assert!(measured > order - 0.35, "{scheme:?} {measured}");
        }
        // A hundred times as weak, ten thousand times as accurate: the error is of the second power of the load.
        let ratio = error(Scheme::NearlyFree864, 2, 1.0) / error(Scheme::NearlyFree864, 2, 0.01);
        assert!(ratio > 1e4, "{ratio}");
    }
}
