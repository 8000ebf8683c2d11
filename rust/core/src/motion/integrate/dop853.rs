//! DOP853: the explicit Runge-Kutta method of order 8 by Dormand and Prince with step-size control by embedded estimates
//! of orders 5 and 3 and a dense output of order 7 (Hairer, Nørsett & Wanner, Solving ODEs I, §II.5, §II.6, §II.10).

use nalgebra::SVector;

use super::runge_kutta::{Progress, RungeKutta, StepError, System};

/// The factor by which a step may shrink or grow, and the part of the optimal factor that is used.
const SHRINK: f64 = 1.0 / 3.0;
const GROW: f64 = 6.0;
const SAFETY: f64 = 0.9;
/// One over the order of the error that the estimate controls.
const EXPONENT: f64 = 1.0 / STEP_ERROR.order;
/// Of the error that the estimate controls; the constant is that of short steps of `y' = i y`.
const STEP_ERROR: StepError = StepError {
    constant: 4.3e-7,
    order: 8.0,
};

/// An integration under way.
#[derive(Clone, Debug)]
pub(crate) struct Dop853<const N: usize> {
    progress: Progress<N>,
    /// The slopes of the last accepted step; the thirteenth is the slope at its end.
    slopes: [SVector<f64, N>; EXTENDED_STAGES],
    /// Time and state before the last accepted step, and its length.
    last: (f64, SVector<f64, N>, f64),
    /// Its polynomial, once it is computed.
    dense: Option<Dense<N>>,
}

impl<const N: usize> RungeKutta<N> for Dop853<N> {
    fn new<S: System<N>>(
        system: &mut S,
        start: f64,
        end: f64,
        y: SVector<f64, N>,
        step: Option<f64>,
    ) -> Result<Self, S::Error> {
        let (progress, slope) = Progress::new(system, [start, end], y, step, STEP_ERROR)?;
        let mut slopes = [SVector::zeros(); EXTENDED_STAGES];
        slopes[STAGES] = slope;
        Ok(Self {
            last: (0.0, progress.state.value, 0.0),
            progress,
            slopes,
            dense: None,
        })
    }

    fn progress(&self) -> &Progress<N> {
        &self.progress
    }

    fn advance<S: System<N>>(&mut self, system: &mut S) -> Result<(), S::Error> {
        self.dense = None;
        let mut largest = GROW;
        loop {
            let (h, is_last) = self.progress.next()?;
            let y = self.progress.state.value;
            self.slopes[0] = self.slopes[STAGES];
            let slope_at_start = self.slopes[0];
            for stage in 1..STAGES {
                let y = y + self.weighted(STAGE_WEIGHTS[stage]) * h;
                let elapsed = self.progress.elapsed.0 + NODES[stage] * h;
                (self.progress).slope(system, elapsed, &y, &mut self.slopes[stage])?;
            }
            let state = (self.progress.state).plus(&(self.weighted(STAGE_WEIGHTS[STAGES]) * h));
            let error = self.error(system, &y, &state.value, h);
            let factor = SAFETY * error.powf(-EXPONENT); // infinite for no error, NaN for one that is not finite
            let progress = &mut self.progress;
            if error <= 1.0 {
                self.last = (progress.elapsed.0, y, h);
                progress.state = state;
                progress.advance(h, is_last);
                progress.step = h * factor.clamp(SHRINK, largest);
                system.accept(&mut progress.state);
                let y = progress.state.value;
                let elapsed = progress.elapsed.0;
                return progress.slope(system, elapsed, &y, &mut self.slopes[STAGES]);
            }
            self.slopes[STAGES] = slope_at_start;
            // The factor is below one, or not a number.
            progress.step = h * factor.max(SHRINK);
            largest = 1.0;
            progress.check_advances(error)?;
        }
    }

    fn within<S: System<N>>(
        &mut self,
        system: &mut S,
        elapsed: f64,
    ) -> Result<SVector<f64, N>, S::Error> {
        let dense = match self.dense.take() {
            Some(dense) => dense,
            None => self.polynomial(system)?,
        };
        let y = dense.at(elapsed);
        self.dense = Some(dense);
        Ok(y)
    }
}

impl<const N: usize> Dop853<N> {
    /// Compute the polynomial in time through the last accepted step.
    ///
    /// # Errors
    /// Errors of the equations in its three additional evaluations.
    #[inline]
    fn polynomial<S: System<N>>(&mut self, system: &mut S) -> Result<Dense<N>, S::Error> {
        let (start, y, h) = self.last;
        for stage in STAGES + 1..EXTENDED_STAGES {
            let y = y + self.weighted(STAGE_WEIGHTS[stage]) * h;
            let elapsed = start + NODES[stage] * h;
            (self.progress).slope(system, elapsed, &y, &mut self.slopes[stage])?;
        }
        let change = self.progress.state.value - y;
        let (before, after) = (self.slopes[0] * h, self.slopes[STAGES] * h);
        let mut coefficients = [change; 7];
        coefficients[1] = before - change;
        coefficients[2] = change * 2.0 - (after + before);
        for (coefficient, row) in coefficients[3..].iter_mut().zip(DENSE) {
            *coefficient = self.weighted(row) * h;
        }
        Ok(Dense {
            start,
            step: h,
            y,
            coefficients,
        })
    }

    #[inline]
    fn weighted(&self, row: Row) -> SVector<f64, N> {
        let mut sum = SVector::zeros();
        for &(stage, weight) in row {
            let slope = &self.slopes[stage];
            for i in 0..N {
                sum[i] += slope[i] * weight;
            }
        }
        sum
    }

    /// Estimate the error: the estimate of order 5, damped by that of order 3, in units of the error allowed.
    #[inline]
    fn error<S: System<N>>(
        &self,
        system: &S,
        y: &SVector<f64, N>,
        y_new: &SVector<f64, N>,
        h: f64,
    ) -> f64 {
        let norm = |row| system.error_norm(y, y_new, &(self.weighted(row) * h));
        let (fifth, third) = (norm(ERROR_5), norm(ERROR_3));
        if fifth == 0.0 {
            0.0
        } else {
            fifth * (fifth / fifth.hypot(0.1 * third))
        }
    }
}

/// The states during one step as a polynomial of degree 7 in time.
#[derive(Clone, Debug)]
struct Dense<const N: usize> {
    start: f64,
    step: f64,
    y: SVector<f64, N>,
    coefficients: [SVector<f64, N>; 7],
}

impl<const N: usize> Dense<N> {
    /// Compute the state at `elapsed` since the start of the integration.
    #[inline]
    fn at(&self, elapsed: f64) -> SVector<f64, N> {
        let x = (elapsed - self.start) / self.step;
        let mut y = SVector::zeros();
        for (i, coefficient) in self.coefficients.iter().enumerate().rev() {
            y = (y + coefficient) * if i % 2 == 0 { x } else { 1.0 - x };
        }
        self.y + y
    }
}

/// A sparse row of weights.
type Row = &'static [(usize, f64)];

/// Stages of one step; the first stage of the next step is the thirteenth.
const STAGES: usize = 12;
/// Stages with those of the dense output.
const EXTENDED_STAGES: usize = 16;

/// Nodes: fractions of the step at which the stages are evaluated.
const NODES: [f64; EXTENDED_STAGES] = [
    0.0,
    0.052_600_151_958_767_73,
    0.078_900_227_938_151_6,
    0.118_350_341_907_227_4,
    0.281_649_658_092_772_6,
    0.333_333_333_333_333_3,
    0.25,
    0.307_692_307_692_307_7,
    0.651_282_051_282_051_3,
    0.6,
    0.857_142_857_142_857_1,
    1.0,
    1.0,
    0.1,
    0.2,
    0.777_777_777_777_777_8,
];

/// Weights of the earlier stages in each stage; row 12 is the solution of order 8.
const STAGE_WEIGHTS: [Row; EXTENDED_STAGES] = [
    &[],
    &[(0, 0.052_600_151_958_767_73)],
    &[(0, 0.019_725_056_984_537_9), (1, 0.059_175_170_953_613_7)],
    &[(0, 0.029_587_585_476_806_85), (2, 0.088_762_756_430_420_54)],
    &[
        (0, 0.241_365_134_159_266_7),
        (2, -0.884_549_479_328_286_1),
        (3, 0.924_834_003_261_792),
    ],
    &[
        (0, 0.037_037_037_037_037_035),
        (3, 0.170_828_608_729_473_86),
        (4, 0.125_467_687_566_822_42),
    ],
    &[
        (0, 0.037_109_375),
        (3, 0.170_252_211_019_544_05),
        (4, 0.060_216_538_980_455_96),
        (5, -0.017_578_125),
    ],
    &[
        (0, 0.037_092_000_118_504_79),
        (3, 0.170_383_925_712_239_98),
        (4, 0.107_262_030_446_373_28),
        (5, -0.015_319_437_748_624_402),
        (6, 0.008_273_789_163_814_023),
    ],
    &[
        (0, 0.624_110_958_716_075_7),
        (3, -3.360_892_629_446_941_4),
        (4, -0.868_219_346_841_726),
        (5, 27.592_099_699_446_71),
        (6, 20.154_067_550_477_894),
        (7, -43.489_884_181_069_96),
    ],
    &[
        (0, 0.477_662_536_438_264_34),
        (3, -2.488_114_619_971_667_7),
        (4, -0.590_290_826_836_843),
        (5, 21.230_051_448_181_193),
        (6, 15.279_233_632_882_423),
        (7, -33.288_210_968_984_86),
        (8, -0.020_331_201_708_508_627),
    ],
    &[
        (0, -0.937_142_430_085_987_3),
        (3, 5.186_372_428_844_064),
        (4, 1.091_437_348_996_729_5),
        (5, -8.149_787_010_746_927),
        (6, -18.520_065_659_996_96),
        (7, 22.739_487_099_350_505),
        (8, 2.493_605_552_679_652_3),
        (9, -3.046_764_471_898_219_6),
    ],
    &[
        (0, 2.273_310_147_516_538),
        (3, -10.534_495_466_737_25),
        (4, -2.000_872_058_224_862_5),
        (5, -17.958_931_863_118_8),
        (6, 27.948_884_529_419_96),
        (7, -2.858_998_277_135_023_5),
        (8, -8.872_856_933_530_63),
        (9, 12.360_567_175_794_303),
        (10, 0.643_392_746_015_763_6),
    ],
    &[
        (0, 0.054_293_734_116_568_765),
        (5, 4.450_312_892_752_409),
        (6, 1.891_517_899_314_500_3),
        (7, -5.801_203_960_010_585),
        (8, 0.311_164_366_957_819_9),
        (9, -0.152_160_949_662_516_1),
        (10, 0.201_365_400_804_030_34),
        (11, 0.044_710_615_727_772_59),
    ],
    &[
        (0, 0.056_167_502_283_047_954),
        (6, 0.253_500_210_216_624_83),
        (7, -0.246_239_037_470_802_5),
        (8, -0.124_191_423_263_816_37),
        (9, 0.153_291_798_278_765_68),
        (10, 0.008_201_052_295_634_69),
        (11, 0.007_567_897_660_545_699),
        (12, -0.008_298),
    ],
    &[
        (0, 0.031_834_648_163_502_14),
        (5, 0.028_300_909_672_366_776),
        (6, 0.053_541_988_307_438_566),
        (7, -0.054_923_748_571_390_99),
        (10, -0.000_108_347_328_697_249_32),
        (11, 0.000_382_571_090_835_658_4),
        (12, -0.000_340_465_008_687_404_56),
        (13, 0.141_312_443_674_632_5),
    ],
    &[
        (0, -0.428_896_301_583_791_94),
        (5, -4.697_621_415_361_164),
        (6, 7.683_421_196_062_599),
        (7, 4.068_989_818_397_11),
        (8, 0.356_727_187_455_281_1),
        (12, -0.001_399_024_165_159_014_5),
        (13, 2.947_514_789_152_772_4),
        (14, -9.150_958_472_179_87),
    ],
];

/// Weights of the stages in the error estimate of order 5.
const ERROR_5: Row = &[
    (0, 0.013_120_044_994_194_88),
    (5, -1.225_156_446_376_204_4),
    (6, -0.495_758_949_657_250_2),
    (7, 1.664_377_182_454_986_4),
    (8, -0.350_328_848_749_973_66),
    (9, 0.334_179_118_713_017_5),
    (10, 0.081_923_206_485_115_71),
    (11, -0.022_355_307_863_886_294),
];

/// Weights of the stages in the error estimate of order 3.
const ERROR_3: Row = &[
    (0, -0.189_800_754_072_407_62),
    (5, 4.450_312_892_752_409),
    (6, 1.891_517_899_314_500_3),
    (7, -5.801_203_960_010_585),
    (8, -0.422_682_321_323_791_9),
    (9, -0.152_160_949_662_516_1),
    (10, 0.201_365_400_804_030_34),
    (11, 0.022_651_792_198_360_82),
];

/// Weights of the stages in the four highest coefficients of the dense output.
const DENSE: [Row; 4] = [
    &[
        (0, -8.428_938_276_109_013),
        (5, 0.566_714_953_519_377_7),
        (6, -3.068_949_945_949_891_7),
        (7, 2.384_667_656_512_07),
        (8, 2.117_034_582_445_028),
        (9, -0.871_391_583_777_973),
        (10, 2.240_437_430_260_788_3),
        (11, 0.631_578_778_769_468_8),
        (12, -0.088_990_336_451_333_31),
        (13, 18.148_505_520_854_727),
        (14, -9.194_632_392_478_356),
        (15, -4.436_036_387_594_894),
    ],
    &[
        (0, 10.427_508_642_579_134),
        (5, 242.283_491_775_258_17),
        (6, 165.200_451_717_270_28),
        (7, -374.546_754_722_690_2),
        (8, -22.113_666_853_125_306),
        (9, 7.733_432_668_472_264),
        (10, -30.674_084_731_089_398),
        (11, -9.332_130_526_430_229),
        (12, 15.697_238_121_770_845),
        (13, -31.139_403_219_565_178),
        (14, -9.352_924_358_844_48),
        (15, 35.816_841_486_394_08),
    ],
    &[
        (0, 19.985_053_242_002_433),
        (5, -387.037_308_749_351_8),
        (6, -189.178_138_195_167_58),
        (7, 527.808_159_205_423_6),
        (8, -11.573_902_539_959_63),
        (9, 6.881_232_694_696_3),
        (10, -1.000_605_096_691_083_8),
        (11, 0.777_713_779_805_344_3),
        (12, -2.778_205_752_353_508),
        (13, -60.196_695_231_264_12),
        (14, 84.320_405_506_677_16),
        (15, 11.992_291_136_182_79),
    ],
    &[
        (0, -25.693_933_462_703_75),
        (5, -154.189_748_690_236_43),
        (6, -231.529_379_176_045_5),
        (7, 357.639_117_910_614_1),
        (8, 93.405_324_183_624_32),
        (9, -37.458_323_136_451_63),
        (10, 104.099_649_508_962_3),
        (11, 29.840_293_426_660_5),
        (12, -43.533_456_590_011_14),
        (13, 96.324_553_959_188_28),
        (14, -39.177_261_675_615_44),
        (15, -149.726_836_257_985_64),
    ],
];

#[cfg(test)]
mod tests {
    use nalgebra::{Vector1, Vector2};

    use super::*;
    use crate::error::Error;
    use crate::motion::integrate::Compensated;

    /// ẍ = −x, whose solution from (1, 0) is (cos t, −sin t).
    struct Oscillator {
        tolerance: f64,
    }

    impl System<2> for Oscillator {
        type Error = Error;

        fn derivative(
            &mut self,
            _t: f64,
            y: &Vector2<f64>,
            slope: &mut Vector2<f64>,
        ) -> Result<(), Error> {
            *slope = Vector2::new(y.y, -y.x);
            Ok(())
        }

        fn error_norm(&self, _: &Vector2<f64>, _: &Vector2<f64>, error: &Vector2<f64>) -> f64 {
            error.norm() / self.tolerance
        }

        fn accept(&mut self, _: &mut Compensated<2>) {}
    }

    fn run(tolerance: f64, end: f64) -> (f64, f64, u64) {
        let mut system = Oscillator { tolerance };
        let mut stepper =
            Dop853::new(&mut system, 3.0, 3.0 + end, Vector2::x(), None).expect("finite");
        let mut between: f64 = 0.0;
        while !stepper.is_finished() {
            let before = stepper.elapsed();
            stepper.advance(&mut system).expect("smooth");
            for part in [0.0, 0.3, 0.5, 0.9, 1.0] {
                let t = before + part * (stepper.elapsed() - before);
                let y = stepper.within(&mut system, t).expect("smooth");
                between = between.max((y - Vector2::new(t.cos(), -t.sin())).norm());
            }
        }
        let exact = Vector2::new(end.cos(), -end.sin());
        (
            (stepper.state() - exact).norm(),
            between,
            stepper.progress.steps,
        )
    }

    #[test]
    fn error_follows_the_tolerance_forward_and_backward() {
        for end in [20.0, -20.0] {
            for tolerance in [1e-6, 1e-9, 1e-12] {
                let (error, between, _) = run(tolerance, end);
                assert!(error < 50.0 * tolerance, "{error:e}");
                assert!(between < 200.0 * tolerance, "{between:e}");
            }
        }
    }

    #[test]
    fn order_is_eight() {
        // Work grows with the eighth root of the accuracy: 10⁴ times as accurate for 10^½ times the steps.
        let (coarse, fine) = (run(1e-6, 200.0).2 as f64, run(1e-10, 200.0).2 as f64);
        assert!(
            (fine / coarse).log10() < 0.6 && (fine / coarse).log10() > 0.4,
            "{}",
            fine / coarse
        );
    }

    /// At rest for half a second, then shaken.
    struct Shaken;

    impl System<1> for Shaken {
        type Error = Error;

        fn derivative(
            &mut self,
            t: f64,
            _: &Vector1<f64>,
            slope: &mut Vector1<f64>,
        ) -> Result<(), Error> {
            slope.x = if t < 0.5 { 0.0 } else { 1e3 * (1e3 * t).sin() };
            Ok(())
        }

        fn error_norm(&self, _: &Vector1<f64>, _: &Vector1<f64>, error: &Vector1<f64>) -> f64 {
            error.norm() / 1e-6
        }

        fn accept(&mut self, _: &mut Compensated<1>) {}
    }

    #[test]
    fn a_step_after_one_that_was_refused_is_no_longer() {
        let first = |step: f64| {
            let mut stepper =
                Dop853::new(&mut Shaken, 0.0, 100.0, Vector1::zeros(), Some(step)).expect("finite");
            stepper.advance(&mut Shaken).expect("at rest");
            (stepper.elapsed(), stepper.progress.step)
        };
        // One second reaches into the shaking: a third of it is taken, without any error, and so is the next.
        assert_eq!(first(1.0), (SHRINK, SHRINK));
        // Where none was refused, a step without error is followed by the longest that may follow.
        assert_eq!(first(0.0625), (0.0625, 0.0625 * GROW));
    }
}
