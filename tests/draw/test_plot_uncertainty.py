"""Bands and error ellipses: against draws that NumPy makes, and what is said where there are none."""

from __future__ import annotations

from typing import Any

import numpy as np
import polhode
import pytest
from polhode import Uncertain, loads
from polhode.draw.plot.ellipsoid import angle_covariance, axis_scatter
from scipy.spatial.transform import Rotation

pytest.importorskip("matplotlib")

from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from polhode import plot

RigidBody: Any = polhode.RigidBody  # what has a sigma is known where it is tested; the types do not know it
solids: Any = polhode.solids
TIMES = np.linspace(0.0, 4.0, 9)
PLACES = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
START = Rotation.from_rotvec([0.4, -0.2, 0.9])
ONE = np.eye(3)


def random_body(seed: int, share: float) -> tuple[Any, np.ndarray]:
    """A body far from symmetry with correlated tensor elements, and a factor of their covariance."""
    rng = np.random.default_rng(seed)
    turn = Rotation.random(random_state=seed).as_matrix()
    tensor = turn @ np.diag([1.0, 1.7, 2.4] * rng.uniform(0.95, 1.05, 3)) @ turn.T
    factor = np.zeros((10, 6))
    factor[4:] = share * rng.normal(size=(6, 6))
    return RigidBody(1.0, tensor).with_covariance(factor @ factor.T), factor


def tensors(body: Any, factor: np.ndarray, z: np.ndarray) -> np.ndarray:
    """The tensor for every row of standard normal numbers."""
    found = np.tile(body.inertia, (len(z), 1, 1))
    for change, (i, j) in zip((z @ factor.T)[:, 4:].T, PLACES, strict=True):
        found[:, i, j] += change
        if i != j:
            found[:, j, i] += change
    return found


def solid() -> Any:
    return Figure().add_subplot(projection="3d", computed_zorder=False)


def flat() -> Any:
    return Figure().add_subplot()


def words(ax: Any) -> list[str]:
    legend = ax.get_legend()
    return [legend.get_title().get_text(), *(text.get_text() for text in legend.get_texts())]


def edges(ax: Any) -> list[np.ndarray]:
    """Lower and upper edge of each band, shape (2, T, 2)."""
    return [
        np.array([path.vertices for path in c.get_paths()])
        for c in ax.collections
        if isinstance(c, LineCollection)
    ]


class TestAngles:
    @pytest.mark.parametrize("seed", range(6))
    def test_covariance_against_draws_that_are_diagonalised(self, seed: int) -> None:
        body, factor = random_body(seed, 1e-4)
        half = np.random.default_rng(seed + 100).normal(size=(100_000, 6))
        z = np.concatenate([half, -half])
        _, vectors = np.linalg.eigh(tensors(body, factor, z))
        axes = body.principal.axes
        turned = axes.T @ vectors  # signs of the columns are LAPACK's
        turned *= np.sign(np.einsum("nkk->nk", turned))[:, None, :]
        angles = 0.5 * np.stack(
            [turned[:, (k + 2) % 3, (k + 1) % 3] - turned[:, (k + 1) % 3, (k + 2) % 3] for k in range(3)], -1
        )
        drawn = angles.T @ angles / len(z)
        found = angle_covariance(body)
        assert found is not None
        scale = np.sqrt(np.outer(np.diagonal(found), np.diagonal(found)))
        assert np.abs((found - drawn) / scale).max() < 0.015
        for k in range(3):
            tips = turned[:, :, k]
            here = tips[:, [(k + 1) % 3, (k + 2) % 3]]
            scatter = axis_scatter(found, k)
            inside = np.einsum("ni,ij,nj->n", here, np.linalg.inv(scatter), here) <= -2.0 * np.log(0.05)
            assert inside.mean() == pytest.approx(0.95, abs=0.003)

    @pytest.mark.parametrize("seed", range(20))
    def test_its_diagonal_is_that_of_the_body(self, seed: int) -> None:
        body, _ = random_body(seed, 1e-3)
        found = angle_covariance(body)
        assert found is not None
        assert np.sqrt(np.diagonal(found)) == pytest.approx(body.sigma.axes, rel=1e-12)

    def test_what_is_not_determined_or_not_uncertain(self) -> None:
        assert angle_covariance(RigidBody(1.0, np.diag([1.0, 2.0, 2.5]))) is None
        found = angle_covariance(
            RigidBody(1.0, np.diag([1.0, 1.0, 1.5])).with_sigma(inertia=0.01 * ONE + 0.01)
        )
        assert found is not None
        assert np.isnan(np.diagonal(found)).tolist() == [False, False, True]
        only_mass = angle_covariance(solids.sphere(1.0, mass=Uncertain(1.0, 0.1)))
        assert only_mass is not None

    def test_a_stack_is_told(self) -> None:
        with pytest.raises(ValueError, match="one body, got a stack"):
            angle_covariance(RigidBody.stack([random_body(0, 1e-3)[0]] * 2))


class TestEllipses:
    @pytest.mark.parametrize("enlarged", [1.0, 5.0])
    def test_they_lie_on_the_ellipsoid_at_the_distance_of_their_probability(self, enlarged: float) -> None:
        body, _ = random_body(3, 2e-3)
        found = angle_covariance(body)
        assert found is not None
        before = len(plot.ellipsoid(body, solid(), coverage=None).lines)
        ax = plot.ellipsoid(body, solid(), coverage=0.9, enlarged=enlarged)
        # For each axis: two ends, each a part in front and one behind; then the entry of the legend.
        new = [np.array(line.get_data_3d()).T for line in ax.lines[before:]]
        assert len(new) == 15
        semi_axes = 1.0 / np.sqrt(body.principal.moments)
        semi_axes /= semi_axes.max()
        for k in range(3):
            points = np.concatenate(new[5 * k : 5 * k + 4])
            points = points[~np.isnan(points[:, 0])] @ body.principal.axes
            assert ((points / semi_axes) ** 2).sum(axis=1) == pytest.approx(1.0, rel=1e-12)
            tips = points / np.linalg.norm(points, axis=1, keepdims=True)
            tips *= np.sign(tips[:, [k]])
            here = tips[:, [(k + 1) % 3, (k + 2) % 3]]
            here *= (np.arccos(tips[:, k]) / np.linalg.norm(here, axis=1))[:, None] / enlarged
            squares = np.einsum("ni,ij,nj->n", here, np.linalg.inv(axis_scatter(found, k)), here)
            assert squares == pytest.approx(-2.0 * np.log(0.1), rel=1e-6)
        assert ("times as large" in words(ax)[0]) == (enlarged != 1.0)

    def test_bodies_without_sigmas_have_the_picture_that_they_had(self) -> None:
        body = RigidBody(1.0, np.diag([1.0, 2.0, 2.5]))
        ax = plot.ellipsoid(body, solid())
        assert ax.get_legend() is None
        assert len(ax.lines) == len(plot.ellipsoid(body, solid(), coverage=None).lines)

    def test_the_size_is_told_in_degrees(self) -> None:
        body = RigidBody(1.0, np.diag([1.0, 2.0, 2.6])).with_sigma(inertia=0.01 * (np.ones((3, 3)) - ONE))
        radius = np.rad2deg(2.447747 * 0.01)
        assert words(plot.ellipsoid(body, solid())) == [
            "where the axes point with 95 %",
            rf"$e_1$: ± {radius / 1.0:.2g}° × {radius / 1.6:.2g}°",
            rf"$e_2$: ± {radius / 0.6:.2g}° × {radius / 1.0:.2g}°",
            rf"$e_3$: ± {radius / 0.6:.2g}° × {radius / 1.6:.2g}°",
        ]

    def test_where_the_first_order_is_not_enough_they_are_dashed(self) -> None:
        sigma = np.full((3, 3), 0.006)
        body = RigidBody(1.0, np.diag([1.0, 1.04, 1.6])).with_sigma(inertia=sigma, source="scale")
        assert list(body.sigma.linear.axes) == [True, True, False]
        ax = plot.ellipsoid(body, solid())
        assert ["not enough" in text for text in words(ax)[1:]] == [True, True, False]
        assert [handle.get_linestyle() for handle in ax.get_legend().legend_handles] == ["--", "--", "-"]

    @pytest.mark.parametrize(
        ("moments", "free"), [((1.0, 1.0, 1.6), "$e_1$, $e_2$"), ((1.0, 1.6, 1.6), "$e_2$, $e_3$")]
    )
    def test_axes_between_equal_moments_have_a_circle(self, moments: Any, free: str) -> None:
        body = RigidBody(1.0, np.diag(moments)).with_sigma(inertia=np.full((3, 3), 0.01))
        said = words(plot.ellipsoid(body, solid()))
        assert len(said) == 3
        assert said[2] == f"{free}: not determined, anywhere on the circle"

    def test_a_ball_has_no_axes(self) -> None:
        body = RigidBody(1.0, ONE).with_sigma(inertia=np.full((3, 3), 0.01))
        assert words(plot.ellipsoid(body, solid()))[1:] == ["axes not determined: anywhere"]

    def test_an_ellipse_over_a_right_angle_is_none(self) -> None:
        from polhode.draw.plot.ellipsoid import _ellipses

        covariance = np.diag([0.01, 0.01, 0.5]) ** 2.0
        assert list(_ellipses(covariance, 3.1)[0]) == [0, 1, 2]  # 1.55 < π/2
        kept, loose = _ellipses(covariance, 3.2)
        assert list(kept) == [2]
        assert loose.tolist() == [False, False, True]

    @pytest.mark.usefixtures("without_surfaces")
    def test_bad_options_are_told(self) -> None:
        body, _ = random_body(1, 1e-3)
        for coverage in (0.0, 1.0, 95.0, np.nan):
            with pytest.raises(ValueError, match=r"coverage: .* is not between 0 and 1"):
                plot.ellipsoid(body, solid(), coverage=coverage)
        for enlarged in (0.0, -1.0, np.inf, np.nan):
            with pytest.raises(ValueError, match=r"enlarged: .* is not positive"):
                plot.ellipsoid(body, solid(), enlarged=enlarged)
        with pytest.raises(ValueError, match="is no ellipse; give less than"):
            plot.ellipsoid(body, solid(), enlarged=1e4)


def uncertain_run(**options: Any) -> tuple[Any, Any, np.ndarray]:
    body, factor = random_body(7, 3e-4)
    omega = Uncertain([0.3, 0.5, 1.4], 3e-4)
    return body.simulate(TIMES, omega, Uncertain(START, 4e-4), **options), body, factor


def by_differences(quantity: Any) -> np.ndarray:
    """Deviations of a quantity of runs without sigmas, by steps of each independent number both ways."""
    body, factor = random_body(7, 3e-4)
    total: Any = 0.0
    for axis in np.eye(12):
        ends = []
        for z in (axis, -axis):
            tensor = tensors(body, factor, z[None, :6])[0]
            start = Rotation.from_rotvec(4e-4 * z[9:]) * START
            omega = np.array([0.3, 0.5, 1.4]) + 3e-4 * z[6:9]
            ends.append(quantity(RigidBody(1.0, tensor).simulate(TIMES, omega, start, rtol=1e-13)))
        total = total + (0.5 * (ends[0] - ends[1])) ** 2
    return np.asarray(np.sqrt(total))


PICTURES: dict[str, tuple[Any, Any]] = {
    "omega": (plot.angular_velocity, lambda run: run.omega),
    "degrees": (
        lambda run, ax, **o: plot.angular_velocity(run, ax, degrees=True, **o),
        lambda run: np.rad2deg(run.omega),
    ),
    "principal": (
        lambda run, ax, **o: plot.angular_velocity(run, ax, frame="principal", **o),
        lambda run: run.omega @ random_body(7, 3e-4)[0].principal.axes,
    ),
    "momentum in space": (plot.angular_momentum, lambda run: run.angular_momentum().spin),
    "momentum in the body": (
        lambda run, ax, **o: plot.angular_momentum(run, ax, frame="body", **o),
        lambda run: run.angular_momentum("body").spin,
    ),
    "ZXZ": (plot.euler_angles, lambda run: np.rad2deg(run.euler_angles(unwrap=True))),
    "zyx": (
        lambda run, ax, **o: plot.euler_angles(run, ax, sequence="zyx", **o),
        lambda run: np.rad2deg(run.euler_angles("zyx", unwrap=True)),
    ),
}


def at_samples(edge: np.ndarray) -> np.ndarray:
    """The points of an edge at the times of the run, without those where an angle leaves its turn."""
    return edge[..., np.isin(edge.reshape(-1, *edge.shape[-2:])[0, :, 0], TIMES), :]


class TestBands:
    @pytest.mark.parametrize("name", PICTURES)
    def test_against_differences_of_runs(self, name: str) -> None:
        draw, quantity = PICTURES[name]
        ax = draw(uncertain_run()[0], flat(), coverage=0.9)
        expected = 1.6448536 * by_differences(quantity)
        found = edges(ax)
        assert len(found) == 3
        for i, (low, high) in enumerate(map(at_samples, found)):
            width = 0.5 * (high[:, 1] - low[:, 1])
            known = ~np.isnan(width)
            assert known.sum() >= 7  # Euler angles wrap, or are near where they are not defined
            np.testing.assert_allclose(width[known], expected[known, i], rtol=2e-3, atol=1e-12)
            middle = at_samples(np.stack(ax.lines[i].get_data(), axis=-1))[:, 1]
            np.testing.assert_allclose(0.5 * (low + high)[known, 1], middle[known], rtol=1e-9, atol=1e-12)
        assert words(ax)[-1] == "90 %"

    def test_momentum_of_a_top_by_its_mass_and_centre(self) -> None:
        """About a fixed point the tensor depends on mass and centre."""
        mass, z = Uncertain(2.0, 1e-3), Uncertain((0.0, 0.0, 0.5), 1e-3)
        weight = loads.uniform_gravity((0.0, 0.0, -9.81))
        options: Any = {"load": weight, "about": "origin"}
        tensor = np.diag([0.3, 0.3, 0.1])

        def spin(m: float, c: Any) -> np.ndarray:
            run = RigidBody(m, tensor, c).simulate(TIMES[:4], (0.1, 0.2, 9.0), START, rtol=1e-13, **options)
            return np.asarray(run.angular_momentum().spin)

        total: Any = 0.0
        for change in 1e-3 * np.eye(4):
            ends = [spin(2.0 + s * change[0], np.array([0, 0, 0.5]) + s * change[1:]) for s in (1, -1)]
            total = total + (0.5 * (ends[0] - ends[1])) ** 2
        run = RigidBody(mass, tensor, z).simulate(TIMES[:4], (0.1, 0.2, 9.0), START, **options)
        for i, (low, high) in enumerate(edges(plot.angular_momentum(run, flat(), coverage=0.9))):
            width = 0.5 * (high - low)[:, 1]
            np.testing.assert_allclose(width, 1.6448536 * np.sqrt(total)[:, i], rtol=2e-3, atol=1e-9)

    def test_every_row_of_a_stack_has_its_own(self) -> None:
        first, second = random_body(7, 3e-4)[0], random_body(8, 1e-3)[0]
        stack = RigidBody.stack([first, second]).simulate(TIMES, (0.3, 0.5, 1.4))
        for draw in (plot.angular_velocity, plot.angular_momentum, plot.euler_angles):
            alone = [
                edge
                for body in (first, second)
                for edge in edges(draw(body.simulate(TIMES, (0.3, 0.5, 1.4)), flat()))
            ]
            for one, other in zip(edges(draw(stack, flat())), alone, strict=True):
                both = map(at_samples, (one, other))
                off = np.subtract(*both)
                # The angles of a stack have one turn in common.
                turns = np.round(off / 360.0) if draw is plot.euler_angles else 0.0
                np.testing.assert_allclose(
                    off - 360.0 * turns, np.where(np.isnan(off), np.nan, 0.0), atol=1e-9
                )

    def test_one_body_from_several_starts(self) -> None:
        body = random_body(7, 3e-4)[0]
        starts = np.array([[0.3, 0.5, 1.4], [1.0, 0.1, 0.2]])
        both = edges(plot.angular_momentum(body.simulate(TIMES, starts), flat()))
        alone = [e for w in starts for e in edges(plot.angular_momentum(body.simulate(TIMES, w), flat()))]
        for one, other in zip(both, alone, strict=True):
            np.testing.assert_allclose(one, other, rtol=1e-9, atol=1e-12)

    @pytest.mark.parametrize("draw", [plot.angular_velocity, plot.angular_momentum, plot.euler_angles])
    def test_runs_without_sigmas_have_the_picture_that_they_had(self, draw: Any) -> None:
        run = RigidBody(1.0, np.diag([1.0, 2.0, 2.5])).simulate(TIMES, (0.3, 0.5, 1.4))
        for ax in (draw(run, flat()), draw(uncertain_run()[0], flat(), coverage=None)):
            assert len(ax.lines) == 3
            assert not ax.collections
            assert len(words(ax)) == 4
            assert words(ax)[0] == ""

    @pytest.mark.parametrize("draw", [plot.angular_velocity, plot.angular_momentum, plot.euler_angles])
    def test_why_there_is_no_band_is_said(self, draw: Any) -> None:
        run, body, _ = uncertain_run()
        ax = draw(run.resume(TIMES[-1] + TIMES), flat())
        assert not ax.collections
        assert words(ax)[0] == "no band: motion before, or load, is not known"
        called = loads.torque_callback(lambda *_: np.array([0.1, 0.0, 0.0]))
        ax = draw(body.simulate(TIMES, (0.3, 0.5, 1.4), load=called), flat())
        assert not ax.collections
        assert words(ax)[0] == "no band: motion without derivatives"

    def test_where_the_first_order_cannot_be_enough_is_said(self) -> None:
        body = solids.box(Uncertain((1.0, 2.0, 3.0), 0.02), mass=1.0)
        times = np.linspace(0.0, 60.0, 601)
        run = body.simulate(times, (0.3, 1.5, 0.6))
        ax = plot.angular_velocity(run, flat())
        wide = (1.959964 * run.sigma.omega > np.linalg.norm(run.omega, axis=1).max()).any(axis=1)
        assert words(ax)[0] == f"bands beyond the first order from {times[wide.argmax()]:.4g} on"
        until = int(wide.argmax())
        assert words(plot.angular_velocity(body.simulate(times[:until], (0.3, 1.5, 0.6)), flat()))[0] == ""

    def test_near_where_euler_angles_are_not_defined_they_have_no_band(self) -> None:
        body = random_body(7, 3e-4)[0]
        for tilt, known in ((0.03, True), (0.01, False)):  # of 1.96 · 0.01
            start = Uncertain(Rotation.from_rotvec([tilt, 0.0, 0.0]), 0.01)
            run = body.simulate([0.0, 1e-9], (0.0, 0.0, 1.0), start)
            found = [np.isfinite(edge).all() for edge in edges(plot.euler_angles(run, flat()))]
            assert found == [known, True, known]

    def test_a_run_that_ended_has_its_band_until_then(self) -> None:
        body = random_body(7, 3e-4)[0]
        end = polhode.Event(lambda t, *_: t - 2.2, terminal=True)
        ax = plot.angular_velocity(body.simulate(TIMES, (0.3, 0.5, 1.4), events=end), flat())
        for low, _ in edges(ax):
            assert np.isfinite(low[:5]).all()

    def test_a_bad_coverage_is_told(self) -> None:
        run = uncertain_run()[0]
        for draw in (plot.angular_velocity, plot.angular_momentum, plot.euler_angles):
            with pytest.raises(ValueError, match=r"coverage: 95\.0 is not between 0 and 1"):
                draw(run, flat(), coverage=95.0)
