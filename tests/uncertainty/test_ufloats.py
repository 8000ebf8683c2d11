"""Numbers of the package `uncertainties`: taken where an `Uncertain` is, and given back as what they were."""

from __future__ import annotations

import struct
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from polhode import RigidBody, Uncertain, laminae, solids
from polhode.errors import PolhodeError
from polhode.uncertainty import join, propagate, to_ufloats
from uncertainties import ufloat
from uncertainties.umath import sqrt


def test_a_number_comes_back_as_itself() -> None:
    mass = ufloat(5.0, 0.1)
    ball: Any = solids.sphere(1.0, mass=mass)
    assert (to_ufloats(ball).mass - mass).std_dev == pytest.approx(0.0, abs=1e-16)
    assert ball.sigma.mass == 0.1


def test_their_arithmetic_and_ours_agree() -> None:
    """A box put beside a ball, by `uncertainties` alone and by bodies; one density for both."""
    density, edge, radius, place = ufloat(2.0, 0.02), ufloat(1.0, 0.01), ufloat(0.5, 0.004), ufloat(3.0, 0.05)
    box = solids.box([edge, 2.0, 3.0], density=density)
    ball = solids.sphere(radius, density=density).translated([place, 0.0, 0.0])
    found = to_ufloats(box + ball)
    m, n = density * edge * 6.0, density * 4 / 3 * np.pi * radius**3
    reduced = m * n / (m + n) * place**2
    expected = m * (edge**2 + 9.0) / 12 + 0.4 * n * radius**2 + reduced
    inertia = found.inertia[1, 1]
    assert inertia.nominal_value == pytest.approx(expected.nominal_value, rel=1e-14)
    assert inertia.std_dev == pytest.approx(expected.std_dev, rel=1e-12)
    assert (inertia - expected).std_dev == pytest.approx(0.0, abs=1e-14)
    center = n * place / (m + n)
    assert (found.center_of_mass[0] - center).std_dev == pytest.approx(0.0, abs=1e-15)
    gyration = sqrt(inertia / found.mass)
    assert gyration.std_dev == pytest.approx(sqrt(expected / (m + n)).std_dev, rel=1e-12)


def test_correlated_numbers_stay_correlated() -> None:
    x = ufloat(1.0, 0.1)
    given: Any = join([x, 2 * x, 3.0])
    assert given.covariance == pytest.approx(
        np.array([[0.01, 0.02, 0.0], [0.02, 0.04, 0.0], [0.0, 0.0, 0.0]])
    )
    assert given.sigma.tolist() == pytest.approx([0.1, 0.2, 0.0])
    assert given.value.tolist() == [1.0, 2.0, 3.0]


def test_particles_and_a_mesh() -> None:
    masses = [ufloat(1.0, 0.1), 3.0]
    dumbbell: Any = RigidBody.from_particles(masses, [(0, 0, 0), (4, 0, 0)])
    assert dumbbell.sigma.mass == pytest.approx(0.1)
    corners = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
    faces = [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)]
    solid: Any = RigidBody.from_mesh(corners, faces, density=ufloat(6.0, 0.3))
    assert solid.sigma.mass == pytest.approx(0.05)


def test_files_of_meshes_keep_it(tmp_path: Path) -> None:
    """Formats that are streamed and formats that are read whole, with a number of either kind."""
    corners = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], dtype=float)
    faces = [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)]
    text = "".join("v {} {} {}\n".format(*row) for row in corners)
    text += "".join("f {} {} {}\n".format(*(i + 1 for i in face)) for face in faces)
    (tmp_path / "a.obj").write_text(text, "utf-8")
    triangles = b"".join(struct.pack("<12fH", 0, 0, 0, *corners[list(face)].ravel(), 0) for face in faces)
    (tmp_path / "a.stl").write_bytes(b" " * 80 + struct.pack("<I", 4) + triangles)
    for name in ("a.obj", "a.stl"):
        for number in (Uncertain(6.0, 0.3), ufloat(6.0, 0.3)):
            by_density: Any = RigidBody.from_file(tmp_path / name, density=number)
            by_mass: Any = RigidBody.from_file(tmp_path / name, mass=number)
            assert by_density.sigma.mass == pytest.approx(0.05)
            assert by_mass.sigma.mass == pytest.approx(0.3)


def test_what_has_none_is_none() -> None:
    assert join([1.0, 2.0]) is None
    assert join("text") is None
    assert join([[1.0], [2.0, 3.0]]) is None
    itself: list[Any] = [1.0]
    itself += [itself, itself]
    assert join(itself) is None
    with pytest.raises(TypeError, match="radius"):
        solids.sphere(["a"], mass=1.0)


def test_other_objects_are_not_asked() -> None:
    class Asked:
        """Refuses to be an array, once for each time that it is asked."""

        count = 0

        def __array__(self, *_: object, **__: object) -> Any:
            self.count += 1
            raise TypeError("no array")

    asked: Any = Asked()
    with pytest.raises(TypeError, match="no array"):
        solids.sphere(asked, mass=1.0)
    assert asked.count == 1


def test_a_body_without_sigma_and_a_stack() -> None:
    numbers = to_ufloats(solids.cube(1.0, mass=6.0))
    assert numbers.mass.nominal_value == 6.0
    assert numbers.mass.std_dev == 0.0
    with pytest.raises(ValueError, match="stack"):
        to_ufloats(solids.sphere([1.0, 2.0], mass=1.0))


def test_bodies_of_ours_are_correlated_there() -> None:
    radius = Uncertain(0.5, 0.01)
    a, b = (to_ufloats(laminae.disk(radius, mass=m)).inertia[2, 2] for m in (1.0, 2.0))
    assert (b - 2 * a).std_dev == pytest.approx(0.0, abs=1e-17)


def test_arguments_alone_are_drawn_from_their_sources() -> None:
    """A function of numbers only, with a body made inside of it: draws of what the body is made of."""
    radius = Uncertain(1.0, 0.2)
    found = propagate(
        lambda r: solids.sphere(r, density=1.0).mass, None, "monte-carlo", arguments=[radius], n=4000, seed=3
    )
    # E[r³] = 1 + 3 σ², var(r³) = 9 σ² + 36 σ⁴ + 15 σ⁶
    mean = 4 / 3 * np.pi * (1 + 3 * 0.04)
    sigma = 4 / 3 * np.pi * np.sqrt(9 * 0.04 + 36 * 0.0016 + 15 * 0.000064)
    assert found.value == pytest.approx(mean, abs=4 * sigma / np.sqrt(4000))
    assert found.sigma == pytest.approx(sigma, rel=0.06)


@pytest.mark.parametrize(
    "length", [ufloat(1.0, float("nan")), ufloat(1.0, float("inf")), ufloat(1.0, 1e200) * ufloat(1e200, 0.1)]
)
def test_sigmas_that_are_not_finite_are_refused(length: Any) -> None:
    with pytest.raises(PolhodeError, match="standard deviations of a ufloat must be finite"):
        solids.box((length, 1.0, 1.0), mass=1.0)
    box: Any = solids.box((ufloat(1.0, 1e150), 1.0, 1.0), mass=1.0)
    assert np.isfinite(box.sigma.inertia).all()
