"""Bodies from periods of pendulums: exact periods against mpmath, published bicycles, correlations."""

from __future__ import annotations

from typing import Any

import mpmath as mp
import numpy as np
import pytest
from polhode import RigidBody, Uncertain, identify, solids
from polhode.errors import IdentificationError

BODY = RigidBody.from_principal(2.0, (0.03, 0.05, 0.06))
G = 9.81


def fitted(*args: Any, **given: Any) -> Any:
    """Return the result; whether its body has sigmas is what the tests ask."""
    return identify.from_pendulum(*args, **given)


def exact_bifilar(moment: Any, mass: Any, length: float, distance: float, amplitude: float) -> Any:
    """∫ dφ/φ̇ of a quarter swing, with energy of the rise, at 50 digits."""
    big, wide, top = mp.mpf(length), mp.mpf(distance), mp.mpf(amplitude)

    def height(angle: Any) -> Any:
        return big - mp.sqrt(big**2 - wide**2 * mp.sin(angle / 2) ** 2)

    def rise(angle: Any) -> Any:
        return wide**2 * mp.sin(angle) / 4 / (big - height(angle))

    def integrand(s: Any) -> Any:
        angle = top * (1 - s * s)
        energy = 2 * mass * mp.mpf(G) * (height(top) - height(angle))
        return mp.sqrt((moment + mass * rise(angle) ** 2) / energy) * 2 * top * s

    return 4 * mp.quad(integrand, [0, 0.25, 0.5, 0.75, 1], method="gauss-legendre")


@pytest.mark.parametrize("degrees", [30, 40, 120])
class TestExactPeriods:
    def test_compound(self, degrees: int) -> None:
        amplitude = float(np.deg2rad(degrees))
        found = identify.compound((0, 2, 0), (0.1, 0.0, 0.3), 1.0, amplitude).exact_period(BODY, G)
        with mp.workdps(40):
            arm = mp.sqrt(mp.mpf(0.1) ** 2 + mp.mpf(0.3) ** 2)
            small = mp.sqrt((mp.mpf(0.05) + 2 * arm**2) / (2 * mp.mpf(G) * arm))
            want = 4 * small * mp.ellipk(mp.sin(mp.mpf(amplitude) / 2) ** 2)
            assert abs(found / want - 1) < 1e-13

    def test_torsional_does_not_depend_on_the_amplitude(self, degrees: int) -> None:
        found = identify.torsional((0, 0, 1), 1.0, stiffness=0.7, fixture=0.01).exact_period(BODY, G)
        assert degrees
        assert found == pytest.approx(2 * np.pi * np.sqrt(0.07 / 0.7), rel=1e-14)

    @pytest.mark.parametrize(("length", "distance"), [(0.8, 0.4), (1.5, 0.5)])
    def test_bifilar_and_trifilar(self, degrees: int, length: float, distance: float) -> None:
        amplitude = float(np.deg2rad(degrees))
        plate = {"plate_mass": 0.3, "plate_moment": 0.001}
        with mp.workdps(50):
            moment, mass = mp.mpf(BODY.inertia[2, 2]) + mp.mpf(0.001), mp.mpf(2) + mp.mpf(0.3)
            want = exact_bifilar(moment, mass, length, distance, amplitude)
            for swing in (
                identify.bifilar((0, 0, 1), 1.0, length, distance, amplitude, **plate),
                identify.trifilar((0, 0, 1), 1.0, length, distance / 2, amplitude, **plate),
            ):
                assert abs(swing.exact_period(BODY, G) / want - 1) < 1e-13

    def test_a_damped_swing_is_longer(self, degrees: int) -> None:
        given: dict[str, Any] = {"period": 1.0, "length": 0.8, "distance": 0.4}
        given["amplitude"] = float(np.deg2rad(degrees))
        free = identify.bifilar((0, 0, 1), **given).exact_period(BODY, G)
        damped = identify.bifilar((0, 0, 1), **given, decrement=0.5).exact_period(BODY, G)
        assert damped / free == pytest.approx(np.sqrt(1 + (0.5 / (2 * np.pi)) ** 2), rel=1e-14)


AXES = [(1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 0), (1, 0, 1), (0, 1, 1)]
TILTED = BODY.rotated(np.array([0.1, 0.3, -0.2, 0.9]) / np.sqrt(0.95))


def measured(body: RigidBody, device: str, sigma: float = 1e-4, noise: Any = None) -> list[Any]:
    """Rows of one device about six axes, with exact periods and perhaps noise."""
    makers: dict[str, Any] = {
        "compound": lambda axis, period: identify.compound(axis, about_of(axis), period, 0.4),
        "torsional": lambda axis, period: identify.torsional(axis, period, 0.5, 0.001),
        "bifilar": lambda axis, period: identify.bifilar(axis, period, 1.0, 0.3, 0.6, 0.2, 0.002),
        "trifilar": lambda axis, period: identify.trifilar(axis, period, 1.0, 0.2, 0.5, 0.2, 0.002),
    }
    rows = []
    for axis in AXES:
        period = makers[device](axis, 1.0).exact_period(body, G)
        if noise is not None:
            period += sigma * noise.normal()
        rows.append(makers[device](axis, Uncertain(period, sigma)))
    return rows


def about_of(axis: Any) -> Any:
    return 0.3 * np.cross(axis, (0.3, 0.5, 0.8)) / np.linalg.norm(np.cross(axis, (0.3, 0.5, 0.8)))


class TestBodies:
    @pytest.mark.parametrize("device", ["compound", "torsional", "bifilar", "trifilar"])
    def test_exact_periods_give_the_body_back(self, device: str) -> None:
        found = fitted(measured(TILTED, device), gravity=G, mass=2.0)
        assert np.abs(found.body.inertia - TILTED.inertia).max() < 1e-12
        assert not found.at_edge
        assert found.observability == ()

    @pytest.mark.parametrize("device", ["compound", "torsional", "bifilar"])
    def test_sigmas_are_the_scatter_of_repeats(self, device: str) -> None:
        rng, errors = np.random.default_rng(5), []
        for _ in range(20):
            rows = measured(TILTED, device, noise=rng) + measured(TILTED, device, noise=rng)
            found = fitted(rows, gravity=G, mass=2.0)
            assert found.degrees_of_freedom == 6
            off = found.body.inertia[np.triu_indices(3)] - TILTED.inertia[np.triu_indices(3)]
            own = found.body.covariance[4:, 4:][np.ix_([0, 3, 4, 1, 5, 2], [0, 3, 4, 1, 5, 2])]
            errors.append(off @ np.linalg.solve(own, off))
        assert 4.0 < np.mean(errors) < 8.4  # of chi-square with 6 degrees: 6 ± 0.78

    def test_mass_and_centre_are_estimated(self) -> None:
        body = TILTED.translated((0.01, -0.02, 0.03))
        rows = measured(TILTED, "torsional")
        for about in ((0.3, 0, 0), (0, 0.3, 0), (0, 0, 0.3), (0.2, 0.2, 0.0), (0, -0.3, 0.1)):
            for axis in ((0, 0, 1), (0, 1, 0), (1, 0, 0)):
                if np.linalg.norm(np.cross(axis, np.array(about) - body.center_of_mass)) < 0.05:
                    continue
                swing = identify.compound(axis, about, 1.0, 0.2)
                period = swing.exact_period(body, G)
                rows.append(identify.compound(axis, about, Uncertain(period, 1e-4), 0.2))
        found = fitted(rows, gravity=G, center_of_mass=None)
        assert found.parameters[:4] == ("mass", "cx", "cy", "cz")
        assert found.body.mass == pytest.approx(2.0, rel=1e-9)
        assert np.abs(found.body.center_of_mass - body.center_of_mass).max() < 1e-9
        assert found.body.sigma.mass > 0.0

    def test_one_wire_correlates_two_bodies(self) -> None:
        """Both are measured with a wire that one rod calibrates: its error is most of theirs."""
        rod = identify.torsional((0, 0, 1), Uncertain(1.9, 1e-3), known=0.511)
        wheels = []
        for period in (0.79, 0.80):
            rows = [rod, identify.torsional((0, 0, 1), Uncertain(period, 1e-6))]
            rows.append(identify.compound((0, 1, 0), (0, 0, 0.3), Uncertain(1.45, 1e-5)))
            wheels.append(fitted(rows, gravity=G, mass=2.0, axis=(0, 1, 0)).body)
        first, second = wheels
        shared = first.covariance_with(second)[4, 4]
        assert shared / (first.sigma.inertia[0, 0] * second.sigma.inertia[0, 0]) > 0.99999

    def test_without_sigmas_the_residuals_tell_the_noise(self) -> None:
        rng = np.random.default_rng(2)
        rows = []
        for row in measured(TILTED, "torsional") * 20:
            period = row.numbers["period"].value * (1.0 + 1e-3 * rng.normal())
            rows.append(identify.torsional(row.numbers["axis"], period, 0.5, 0.001))
        found = fitted(rows, gravity=G, mass=2.0)
        assert found.noise is not None
        assert found.noise.value == pytest.approx(1e-3, rel=0.2)
        assert found.chi2 == pytest.approx(found.degrees_of_freedom)
        assert np.abs(found.body.inertia - TILTED.inertia).max() < 5 * found.body.sigma.inertia.max()

    def test_a_prior_completes_what_the_rows_leave_open(self) -> None:
        rows = measured(TILTED, "torsional")[:2]
        prior = TILTED.with_covariance(np.diag([1e-6] * 4 + [1e-6] * 6))
        found = fitted(rows, gravity=G, mass=2.0, prior=prior)
        assert np.abs(found.body.inertia - TILTED.inertia).max() < 1e-9
        sigma = found.body.sigma.inertia
        assert sigma[0, 0] < 1e-4 < sigma[2, 2] == pytest.approx(1e-3, rel=0.01)

    def test_the_most_likely_body_at_the_edge(self) -> None:
        """Periods of a plate, one off by 3 sigma: the plain solution breaks the triangle inequality."""
        plate = solids.box((0.3, 0.4, 0.0), mass=1.0)
        rows = []
        for axis in AXES:
            period = identify.torsional(axis, 1.0, 0.5).exact_period(plate, G)
            period *= 1.003 if axis == (0, 0, 1) else 1.0
            rows.append(identify.torsional(axis, Uncertain(period, 1e-3 * period), 0.5))
        found = fitted(rows, gravity=G, mass=1.0)
        assert found.at_edge
        assert not found.linear
        first, second, third = found.body.principal_moments
        assert third == pytest.approx(first + second, rel=1e-6)
        assert 2.0 < found.chi2 < 9.0
        assert found.gap <= 1e-8 * found.chi2


class TestBicycles:
    """Raw measurements of bicycles by J. K. Moore and others.

    Source: distribution of BicycleParameters 1.5.2, ``data/bicycles/*/RawData`` (Moore, Hubbard, Kooijman and
    Schwab, "A method for estimating physical properties of a combined bicycle and rider", 2010). The wanted
    values are those of its files ``Parameters``.
    """

    # mass, arm, period on the axle's knife edge, on the wire; front and rear wheel of "Browser".
    WHEELS = (
        (
            (2.02, 0.02),
            (0.293, 0.001),
            (1.4811273727, 7.31000200392e-06),
            (0.787577011406, 1.46269721914e-06),
        ),
        (
            (3.11, 0.02),
            (0.29325, 0.001),
            (1.36108970039, 3.90671672693e-06),
            (0.796564786052, 1.16766813788e-06),
        ),
    )
    WANTED = (
        ((0.0883826870796, 0.00035969731805), (0.149221207336, 0.00151585483097)),
        ((0.0904114316323, 0.000367953786506), (0.152391250767, 0.00113908424669)),
    )

    @staticmethod
    def wire() -> Any:
        """Return the calibration of the wire by a rod: of the library `uncertainties`, as its data are."""
        uncertainties = pytest.importorskip("uncertainties")
        length, mass = uncertainties.ufloat(1.05, 0.001), uncertainties.ufloat(5.56, 0.02)
        width = uncertainties.ufloat(0.03, 0.0001)
        moment = mass / 12 * (3 * (width / 2) ** 2 + length**2)
        period = uncertainties.ufloat(1.89399317145, 5.93377589066e-06)
        return identify.torsional((0, 0, 1), period, known=moment)

    def wheel(self, k: int, wire: Any, gravity: Any) -> Any:
        mass, arm, swing, twist = (Uncertain(*one) for one in self.WHEELS[k])
        rows = [
            wire,
            identify.torsional((0, 0, 1), twist),
            identify.compound((0, 1, 0), [0.0, 0.0, arm], swing),
        ]
        return fitted(rows, gravity=gravity, mass=mass, axis=(0, 1, 0)).body

    def test_wheels_to_the_printed_digits(self) -> None:
        wire, gravity = self.wire(), Uncertain(9.81, 0.01)
        for k in (0, 1):
            body = self.wheel(k, wire, gravity)
            (across, of_across), (axial, of_axial) = self.WANTED[k]
            assert body.inertia[0, 0] == pytest.approx(across, rel=1e-10)
            assert body.inertia[1, 1] == pytest.approx(axial, rel=1e-10)
            assert body.sigma.inertia[0, 0] == pytest.approx(of_across, rel=1e-10)
            assert body.sigma.inertia[1, 1] == pytest.approx(of_axial, rel=1e-10)

    def test_the_correlation_that_the_files_drop(self) -> None:
        wire, gravity = self.wire(), Uncertain(9.81, 0.01)
        front, rear = (self.wheel(k, wire, gravity) for k in (0, 1))
        shared = front.covariance_with(rear)[4, 4]
        assert shared / (front.sigma.inertia[0, 0] * rear.sigma.inertia[0, 0]) > 0.999999

    def test_the_frame_is_that_of_no_body(self) -> None:
        """Its file has Ixx + Izz = 1.2864 < Iyy = 1.3164: 0.03 short of what any body has."""
        known = {"xx": 0.52962890621, "zz": 0.756786895402, "yy": 1.3163960125, "xz": -0.116285607878}
        matrix = np.diag([known["xx"], known["yy"], known["zz"]])
        matrix[0, 2] = matrix[2, 0] = known["xz"]
        rows = []
        for axis, sigma in (((1, 0, 0), 0.0025), ((0, 1, 0), 0.004), ((0, 0, 1), 0.0033), ((1, 0, 1), 0.003)):
            n = np.array(axis) / np.linalg.norm(axis)
            moment = float(n @ matrix @ n)
            period = 2 * np.pi * np.sqrt(moment)
            rows.append(identify.torsional(axis, Uncertain(period, 0.5 * period * sigma / moment), 1.0))
        found = fitted(rows, gravity=9.81, mass=9.86, normal=(0, 1, 0))
        assert found.at_edge
        assert found.chi2 > 9.0


class TestLittleIsTold:
    def test_one_pendulum_names_what_it_leaves_open(self) -> None:
        with pytest.raises(IdentificationError, match="undetermined") as caught:
            fitted(measured(TILTED, "torsional")[2:3], gravity=G, mass=2.0)
        assert caught.value.kind == "undetermined"
        words = {one.words for one in caught.value.observability}
        assert words == {
            "the moment about x",
            "the moment about y",
            "the product of inertia xy",
            "the product of inertia xz",
            "the product of inertia yz",
        }

    def test_a_plane_of_symmetry_leaves_less_open(self) -> None:
        rows = [measured(TILTED, "torsional")[k] for k in (0, 1, 2)]
        with pytest.raises(IdentificationError) as caught:
            fitted(rows, gravity=G, mass=2.0, normal=(0, 1, 0))
        assert [one.words for one in caught.value.observability] == ["the product of inertia xz"]

    def test_a_wire_that_nothing_calibrates(self) -> None:
        rows = [identify.torsional(axis, Uncertain(2.0, 1e-3)) for axis in AXES]
        with pytest.raises(IdentificationError, match="stiffness of the wire"):
            fitted(rows, gravity=G, mass=2.0)

    def test_a_poor_stopwatch_is_told(self) -> None:
        rows = measured(TILTED, "torsional")
        poor = identify.torsional((0, 0, 1), Uncertain(rows[2].numbers["period"].value, 0.4), 0.5, 0.001)
        found = fitted([*rows[:2], poor, rows[3]], gravity=G, mass=2.0, normal=(0, 0, 1))
        assert [one.words for one in found.observability] == ["the moment about z"]
        assert found.observability[0].sigma == pytest.approx(found.body.sigma.inertia[2, 2])

    def test_exact_rows_that_contradict(self) -> None:
        rows = [identify.torsional(axis, Uncertain(2.0, 1e-3), 0.5) for axis in AXES]
        rows += [identify.torsional((0, 0, 1), 2.0, 0.5), identify.torsional((0, 0, 1), 2.1, 0.5)]
        with pytest.raises(IdentificationError) as caught:
            fitted(rows, gravity=G, mass=2.0)
        assert caught.value.kind == "contradiction"


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: identify.compound((0, 0, 0), (0, 0, 1), 1.0), "axis: expected a direction"),
        (lambda: identify.compound((0, 0, 1), (0, 0), 1.0), "about: expected shape"),
        (lambda: identify.compound((0, 0, 1), (0, 0, 1), -1.0), "period: expected a positive number"),
        (lambda: identify.compound((0, 0, 1), (0, 1, 0), 1.0, 30.0), "amplitude: expected radians"),
        (lambda: identify.bifilar((0, 0, 1), 1.0, 0.2, 0.5, 1.0), "amplitude: at 1.0 the wires end"),
        (lambda: identify.torsional((0, 0, 1), 1.0).exact_period(BODY, G), "stiffness"),
        (lambda: fitted([], gravity=G, mass=1.0), "measurements: expected at least one"),
        (lambda: fitted(measured(BODY, "torsional"), gravity=-1.0, mass=1.0), "gravity"),
        (lambda: fitted(measured(BODY, "torsional"), gravity=G), "mass: periods on wires"),
        (
            lambda: fitted(measured(BODY, "torsional"), gravity=G, mass=2.0, prior=BODY),
            "prior: expected one body with a covariance",
        ),
    ],
)
def test_bad_input(call: Any, words: str) -> None:
    with pytest.raises(ValueError, match=words):
        call()
