"""Windows: what stands in them is what was computed, and a picture shows it. Skipped without pyvista."""

from __future__ import annotations

import re
import sys
from typing import TYPE_CHECKING, Any

import numpy as np
import polhode
import pytest
from oracles.bodies import matrix
from oracles.meshes import cube
from polhode import RigidBody, Trajectory, loads, solids, view

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from polhode import GyrostatMotion

SIDES = np.array([1.0, 2.0, 3.0])
MOMENTS = (SIDES @ SIDES - SIDES**2) / 12.0


def test_without_pyvista_the_remedy_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pyvista", None)
    with pytest.raises(ModuleNotFoundError, match=r'a window needs pyvista: pip install "polhode\[view\]"'):
        solids.cube(1.0, mass=1.0).view()


@pytest.fixture
def pyvista(monkeypatch: pytest.MonkeyPatch) -> Iterator[Any]:
    library: Any = pytest.importorskip("pyvista", reason='pip install "polhode[view]"')
    monkeypatch.setattr(library, "OFF_SCREEN", True)
    yield library
    library.close_all()


@pytest.fixture(scope="module")
def motion() -> Trajectory:
    brick = solids.box(SIDES, mass=1.0).rotated((0.0, 0.0, 0.6, 0.8))
    return brick.simulate(np.linspace(0.0, 5.0, 101), omega=(0.3, 2.0, 0.1))


def pixels(plotter: Any) -> np.ndarray:
    return np.asarray(plotter.screenshot(return_img=True)).astype(int)


def colored(picture: np.ndarray, color: str) -> int:
    """How many pixels have a colour, or nearly."""
    wanted = np.array([int(color[i : i + 2], 16) for i in (1, 3, 5)])
    return int((np.abs(picture - wanted).max(axis=-1) < 12).sum())


class TestBodies:
    def test_a_mesh_and_its_edges(self, pyvista: Any) -> None:
        vertices, faces = cube(2.0)
        plotter = view.body(vertices * SIDES, faces, length_label="m")
        drawn = plotter.actors["body"].mapper.dataset
        np.testing.assert_allclose(drawn.bounds, np.outer(SIDES, (-1.0, 1.0)).reshape(-1))
        assert drawn.volume == pytest.approx(48.0)
        edges = plotter.actors["body-outline"].mapper.dataset
        assert edges.compute_cell_sizes()["Length"].sum() == pytest.approx(4 * 2.0 * SIDES.sum())
        shades = np.unique(pixels(plotter).reshape(-1, 3), axis=0)
        assert len(shades) > 20
        assert isinstance(plotter, pyvista.Plotter)

    @pytest.mark.usefixtures("pyvista")
    def test_axes_and_ellipsoid_lie_as_the_body_s(self) -> None:
        body = solids.box(SIDES, mass=1.0).rotated((0.0, 0.0, 0.6, 0.8)).translated((1.0, 0.0, 2.0))
        plotter = view.ellipsoid(body, size=2.0)
        surface = np.asarray(plotter.actors["ellipsoid"].mapper.dataset.points)
        arm = (surface - body.center_of_mass) @ body.principal.axes
        # r·I r is the same everywhere on it: I₁ (longest semi-axis)².
        np.testing.assert_allclose((arm**2) @ body.principal.moments, MOMENTS.min() * 4.0, rtol=1e-5)
        for k, axis in enumerate(body.principal.axes.T):
            tube = np.asarray(plotter.actors[f"ellipsoid-axes-{k}"].mapper.dataset.points)
            along = (tube - body.center_of_mass) @ axis
            across = np.linalg.norm(tube - body.center_of_mass - np.outer(along, axis), axis=1)
            assert along.max() == pytest.approx(2.5)
            assert across.max() < 0.05

    @pytest.mark.usefixtures("pyvista")
    def test_the_whole_picture_of_a_body(self) -> None:
        plotter = solids.box(SIDES, mass=1.0).view()
        picture = pixels(plotter)
        for color in ("#0072B2", "#D55E00", "#009E73"):  # the axes, or their names
            assert colored(picture, color) > 50
        drawn = plotter.actors["body"].mapper.dataset  # the box of equal inertia is the box
        np.testing.assert_allclose(drawn.bounds, np.outer(SIDES / 2, (-1.0, 1.0)).reshape(-1), rtol=1e-12)

    def test_a_plotter_is_used_and_returned(self, pyvista: Any) -> None:
        plotter = pyvista.Plotter()
        body = solids.cube(1.0, mass=1.0)
        assert view.body(*cube(), plotter) is plotter
        assert view.principal_axes(body, plotter) is plotter
        assert body.view(plotter, shape=cube()) is plotter
        count = len(plotter.actors)
        body.view(plotter, shape=cube())
        assert len(plotter.actors) == count  # the same names are replaced

    def test_stacks_are_refused(self) -> None:
        many = RigidBody.from_principal(np.ones(2), MOMENTS)
        with pytest.raises(ValueError, match=r"one body, got a stack of shape \(2,\)"):
            many.view()


class TestMotion:
    @pytest.mark.usefixtures("pyvista")
    @pytest.mark.parametrize("index", [0, 37, 100])
    def test_the_body_stands_as_it_does_at_the_time(self, motion: Trajectory, index: int) -> None:
        plotter = motion.view(at=float(motion.t[index]), shape=cube())
        placed = plotter.actors["motion-body"].user_matrix
        np.testing.assert_allclose(placed[:3, :3], motion.rotation[index].as_matrix(), atol=1e-12)
        np.testing.assert_array_equal(placed[:3, 3], 0.0)
        omega = motion.rotation[index].apply(motion.omega[index])
        arrow = np.asarray(plotter.actors["motion-omega"].mapper.dataset.points)
        tip = arrow[np.linalg.norm(arrow, axis=1).argmax()]
        assert tip @ omega == pytest.approx(
            np.linalg.norm(tip) * np.linalg.norm(omega), rel=1e-6
        )  # in float32

    @pytest.mark.usefixtures("pyvista")
    def test_it_moves_on_the_same_plotter(self, motion: Trajectory) -> None:
        plotter = view.motion(motion, at=0.0)
        early, again = pixels(plotter), pixels(plotter)
        count = len(plotter.actors)
        assert view.motion(motion, plotter, at=2.0) is plotter
        late = pixels(plotter)
        assert len(plotter.actors) == count
        assert np.array_equal(early, again)
        assert (np.abs(late - early).max(axis=-1) > 30).mean() > 0.01

    def test_the_slider_and_the_space_bar_move_it(
        self, pyvista: Any, motion: Trajectory, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        """In a window: here one without a screen."""
        monkeypatch.setattr(pyvista, "OFF_SCREEN", False)
        small = pyvista.Plotter(off_screen=False, window_size=[96, 64])  # it is drawn up to a hundred times
        with pytest.warns(UserWarning, match="duration: .* turns by up to 96.9 deg"):
            plotter = view.motion(motion, small, duration=0.2)
        slider = getattr(plotter, "widgets", plotter).slider_widgets[0]
        slider.GetRepresentation().SetValue(float(motion.t[37]))
        slider.InvokeEvent("InteractionEvent")
        placed = plotter.actors["motion-body"].user_matrix
        np.testing.assert_allclose(placed[:3, :3], motion.rotation[37].as_matrix(), atol=1e-12)
        plotter.show(interactive=False, auto_close=False)
        plotter.iren.interactor.SetKeySym("space")
        plotter.iren.interactor.InvokeEvent("KeyPressEvent")
        for _ in range(100):  # each draws a picture
            plotter.iren.interactor.InvokeEvent("TimerEvent")
            if slider.GetRepresentation().GetValue() > motion.t[37]:
                break
        else:
            pytest.fail("it does not move")

    @pytest.mark.usefixtures("pyvista")
    def test_a_body_at_rest_has_no_arrows(self) -> None:
        still = solids.cube(1.0, mass=1.0).simulate([0.0, 1.0], (0.0, 0.0, 0.0))
        assert not {"motion-L", "motion-omega"} & set(view.motion(still).actors)

    @pytest.mark.parametrize("at", [-0.1, 5.1, np.nan])
    def test_times_beyond_the_motion(self, motion: Trajectory, at: float) -> None:
        with pytest.raises(ValueError, match="is not between 0 and 5, the times of the motion"):
            motion.view(at=at)


@pytest.mark.usefixtures("pyvista")
class TestWheels:
    """Of a gyrostat: discs in the body that turn by their angle relative to it."""

    TURNING = polhode.wheel(axis=(0.0, 0.6, 0.8), inertia=0.2, rate=2.5, mode="held")

    def gyrostat(self, inside: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> GyrostatMotion:
        brick = solids.box(SIDES, mass=1.0)
        return brick.gyrostat(inside, wheels=[self.TURNING]).free_motion((0.3, 0.9, 0.1))

    @pytest.mark.parametrize("at", [0.0, 0.7, 2.0])
    def test_a_disc_stands_and_turns_as_the_wheel_does(self, at: float) -> None:
        motion = self.gyrostat()
        plotter = view.motion(motion, end=2.0, at=at, duration=10.0)
        placed = plotter.actors["motion-wheel-0-rim"].user_matrix
        (shown,) = re.findall(r"t = (\S+) s", plotter.actors["motion-time"].GetText(2))
        t = float(shown)
        np.testing.assert_allclose(placed[:3, :3], matrix(motion.at(t).quaternion), atol=2e-3)
        mark = plotter.actors["motion-wheel-0-mark-0"].user_matrix
        turn = (mark @ np.linalg.inv(placed))[:3, :3]
        axis = placed[:3, :3] @ (0.0, 0.6, 0.8)
        np.testing.assert_allclose(turn @ axis, axis, atol=1e-12)
        half = 0.5 * 2.5 * t
        quaternion = np.array([*(np.sin(half) * axis), np.cos(half)])
        np.testing.assert_allclose(turn, matrix(quaternion), atol=2e-3)
        assert "wheel: 2.5 rad/s" in plotter.actors["motion-time"].GetText(2)
        picture = pixels(plotter)
        assert (np.abs(picture - (0x7A, 0x4A, 0x00)).max(axis=-1) < 24).sum() > 40

    def test_fast_ones_are_slowed_and_rotors_have_rings(self) -> None:
        for duration, is_slowed in ((0.5, False), (0.45, True)):  # 19.1 and 21.2 degrees a picture
            plotter = view.motion(self.gyrostat((0.3, 0.0, 0.0)), end=2.0, duration=duration)
            assert ("2.5 rad/s, drawn 2× slower" in plotter.actors["motion-time"].GetText(2)) == is_slowed
        assert "rotor: speed not known" in plotter.actors["motion-time"].GetText(2)
        assert "motion-wheel-1-mark-5" in plotter.actors
        assert "motion-wheel-1-mark-6" not in plotter.actors

    def test_states_keep_their_wheels(self) -> None:
        plotter = view.motion(self.gyrostat().at(np.linspace(0.0, 2.0, 21)))
        assert "wheel: 2.5 rad/s" in plotter.actors["motion-time"].GetText(2)

    def test_a_rotor_tells_its_momentum_alone(self) -> None:
        brick = solids.box(SIDES, mass=1.0)
        run = brick.simulate(np.linspace(0.0, 2.0, 21), (0.3, 0.9, 0.1), load=loads.rotor((0.0, 0.0, 2.0)))
        assert "rotor: speed not known" in view.motion(run).actors["motion-time"].GetText(2)

    def test_ends(self) -> None:
        with pytest.raises(ValueError, match="end: a motion in closed form has no end of its own"):
            view.motion(self.gyrostat())
        with pytest.raises(ValueError, match="end: a trajectory has its own times"):
            view.motion(self.gyrostat().at([0.0, 1.0]), end=2.0)


def test_a_picture_is_saved(pyvista: Any, tmp_path: Path) -> None:
    path = tmp_path / "body.png"
    solids.cube(1.0, mass=1.0).view(pyvista.Plotter(off_screen=True)).screenshot(path)
    assert path.stat().st_size > 1000
