"""What wrong arguments meet: the argument's name, the row, the number; never a panic, never a repair."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import polhode
import pytest
from polhode import (
    RigidBody,
    errors,
    euler_angles,
    interop,
    kinematics,
    laminae,
    loads,
    parallel_axis,
    principal_axes,
    solids,
    tops,
    validity,
)

BODY = solids.box((1.0, 2.0, 3.0), mass=1.0)
PENCIL = RigidBody.from_principal(1.0, (2.0, 2.0, 1.0), center_of_mass=(0.0, 0.0, 1.0))
EYE = np.eye(3)
FACES = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])

UNIT = np.array([0.1, 0.7, 0.1, 0.7])
VECTOR = np.array([1.0, 2.0, 3.0])
TENSOR = np.array([[8.0, 1.0, 0.0], [1.0, 9.0, 2.0], [0.0, 2.0, 10.0]])
TURN = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
POINTS = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 2.0], [0.0, 3.0, 1.0], [1.0, 1.0, 5.0]])
ARRAYS: dict[str, tuple[str, Callable[[Any], object], Any]] = {
    "mass": ("mass", lambda x: RigidBody(x, EYE), 1.0),
    "inertia": ("inertia", lambda x: RigidBody(1.0, x), TENSOR),
    "inertia_about_origin": (
        "inertia_about_origin",
        lambda x: RigidBody(1.0, inertia_about_origin=x),
        TENSOR,
    ),
    "center_of_mass": ("center_of_mass", lambda x: RigidBody(1.0, EYE, x), VECTOR),
    "moments": ("moments", lambda x: RigidBody.from_principal(1.0, x), np.array([3.0, 4.0, 2.0])),
    "axes": ("axes", lambda x: RigidBody.from_principal(1.0, (2, 3, 4), x), TURN),
    "masses": ("masses", lambda x: RigidBody.from_particles(x, POINTS[:3]), VECTOR),
    "positions": ("positions", lambda x: RigidBody.from_particles((1, 2, 3, 4), x), POINTS),
    "principal_axes": ("inertia", principal_axes, TENSOR),
    "translated": ("displacement", BODY.translated, VECTOR),
    "rotated": ("rotation", BODY.rotated, TURN),
    "inertia_about": ("about", BODY.inertia_about, VECTOR),
    "moment_about": ("axis", BODY.moment_about, VECTOR),
    "kinetic_energy": ("omega", BODY.kinetic_energy, VECTOR),
    "velocity": ("velocity", lambda x: BODY.kinetic_energy((1, 2, 3), x), VECTOR),
    "angular_momentum": ("omega", BODY.angular_momentum, VECTOR),
    "angular_acceleration": ("omega", BODY.angular_acceleration, VECTOR),
    "torque": ("torque", lambda x: BODY.angular_acceleration((1, 2, 3), x), VECTOR),
    "inverse": ("angular_acceleration", lambda x: BODY.torque((1, 2, 3), x), VECTOR),
    "from C": ("inertia", lambda x: parallel_axis.from_center_of_mass(x, 1.0, VECTOR), TENSOR),
    "to C": ("displacement", lambda x: parallel_axis.to_center_of_mass(TENSOR, 1.0, x), VECTOR),
    "transport": ("frame_omega", lambda x: kinematics.transport(VECTOR, (1, 2, 4), x), VECTOR),
    "point_velocity": ("point", lambda x: BODY.point_velocity(x, (1, 2, 3)), VECTOR),
    "point_acceleration": ("omega", lambda x: BODY.point_acceleration((1, 2, 3), x), VECTOR),
    "pivot_reaction": ("gravity", lambda x: BODY.pivot_reaction((1, 2, 3), gravity=x), VECTOR),
    "angular_velocity": ("angles", lambda x: euler_angles.angular_velocity(x, (1, 2, 3)), VECTOR),
    "euler rates": ("omega", lambda x: euler_angles.rates((1, 2, 3), x), VECTOR),
    "least_spin": ("gravity", lambda x: tops.least_spin(PENCIL, x), VECTOR),
    "steady_precession": ("gravity", lambda x: tops.steady_precession(PENCIL, 99.0, 2.0, x), VECTOR),
    "simulate t": ("t", lambda x: BODY.simulate(x, (1, 2, 3)), np.array([0.0, 1.0])),
    "simulate omega": ("omega", lambda x: BODY.simulate([0, 1], x), VECTOR),
    "simulate attitude": ("attitude", lambda x: BODY.simulate([0, 1], (1, 2, 3), x), UNIT),
    "simulate position": ("position", lambda x: BODY.simulate([0, 1], (1, 2, 3), position=x), VECTOR),
    "simulate velocity": ("velocity", lambda x: BODY.simulate([0, 1], (1, 2, 3), velocity=x), VECTOR),
    "constant_torque": ("vector", loads.constant_torque, VECTOR),
    "size": ("size", lambda x: solids.box(x, mass=1.0), VECTOR),
    "polygon": ("vertices", lambda x: laminae.polygon(x, mass=1.0), np.eye(3)[:, :2]),
    "nodes": (
        "nodes",
        lambda x: RigidBody.from_tetrahedra(x, [(0, 1, 2, 3)], density=1.0),
        np.vstack([np.zeros(3), EYE]),
    ),
    "products": ("products", lambda x: RigidBody.from_positive_products(1.0, np.ones(3), x), np.zeros(3)),
    "pseudo_inertia": ("pseudo_inertia", interop.from_pseudo_inertia, np.eye(4)),
    "spatial_inertia": ("spatial_inertia", interop.from_spatial_inertia, np.eye(6)),
    "parameters": ("parameters", interop.from_log_cholesky, np.zeros(10)),
    "low": ("low", lambda x: validity.fit_in_box(BODY, x, np.ones(3)).margin, -np.ones(3)),
    "angles": ("angles", euler_angles.to_quaternion, VECTOR),
    "quaternion": ("quaternion", euler_angles.from_quaternion, UNIT),
    "vertices": ("vertices", lambda x: RigidBody.from_mesh(x, FACES, mass=1.0, orient=True), POINTS),
}
OPTIONAL = {
    "inertia",
    "inertia_about_origin",
    "axes",
    "simulate attitude",
    "simulate position",
    "simulate velocity",
}
EVALUATED = {
    "principal_axes",
    "inertia_about",
    "kinetic_energy",
    "velocity",
    "angular_momentum",
    "angular_acceleration",
    "torque",
    "inverse",
    "from C",
    "to C",
    "transport",
    "point_velocity",
    "point_acceleration",
    "pivot_reaction",
    "angular_velocity",
    "euler rates",
    "least_spin",
    "steady_precession",
}


def _numbers(result: Any) -> np.ndarray:
    """All numbers of a result, one row of them for each row of a stack."""
    if isinstance(result, polhode.PrincipalAxes):
        result = result.moments
    elif isinstance(result, polhode.KineticEnergy | polhode.AngularMomentum):
        result = result.total
    return np.asarray(result)


def _bits(result: Any) -> bytes:
    """What a result consists of, for comparing two of them bit by bit."""
    if isinstance(result, RigidBody):
        return bytes(result.inertia) + bytes(result.center_of_mass)
    if isinstance(result, polhode.Trajectory):
        return bytes(result.omega) + bytes(result.quaternion) + bytes(result.position)
    if isinstance(result, loads.Load):
        return _bits(BODY.simulate([0, 1], (1, 2, 3), load=result))
    return _numbers(result).tobytes()


@pytest.mark.parametrize("name", ARRAYS)
class TestEveryArray:
    def test_good_values_pass(self, name: str) -> None:
        _, call, good = ARRAYS[name]
        call(good)

    def test_lists_tuples_and_small_types_pass(self, name: str) -> None:
        _, call, good = ARRAYS[name]
        want = _bits(call(good))
        assert _bits(call(np.asarray(good).tolist())) == want
        for kind in (np.int8, np.uint16, np.int64, np.float32, np.float16, np.longdouble, bool):
            small = np.asarray(good).astype(kind)
            if np.array_equal(small, good):
                assert _bits(call(small)) == want

    def test_memory_layout_does_not_matter(self, name: str) -> None:
        _, call, good = ARRAYS[name]
        array, want = np.asarray(good, dtype=float), _bits(call(good))
        frozen = array.copy()
        frozen.flags.writeable = False
        strided = np.repeat(array, 2, axis=-1)[..., ::2] if array.ndim else array
        backward = array[..., ::-1].copy()[..., ::-1] if array.ndim else array
        for same in (frozen, strided, backward, array.astype(">f8"), np.asfortranarray(array)):
            assert _bits(call(same)) == want

    def test_inputs_are_not_changed(self, name: str) -> None:
        _, call, good = ARRAYS[name]
        array = np.array(good, dtype=float)
        before = array.copy()
        call(array)
        assert np.array_equal(array, before)

    @pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
    def test_what_is_not_finite_is_named_or_stays_not_finite(self, name: str, value: float) -> None:
        """Bodies, loads and starts must be finite; a formula evaluated row by row says so in that row."""
        argument, call, good = ARRAYS[name]
        array = np.array(good, dtype=float)
        array[(-1,) * array.ndim] = value
        if name in EVALUATED or (name == "quaternion" and np.isnan(value)):
            assert not np.isfinite(_numbers(call(array))).all()
            rows = np.array([good, array, good])
            results = _numbers(call(rows))
            assert np.isfinite(results[[0, 2]]).all()
        else:
            with pytest.raises(ValueError, match=rf"(?i)\b{argument}\b.*(nan|inf)|(nan|inf).*\b{argument}\b"):
                call(array)

    @pytest.mark.parametrize(
        "value",
        [1j, "a", "1.0", b"1", None, object(), {"a": 1}, np.datetime64("2026-01-01"), [[1.0], [1.0, 2.0]]],
    )
    def test_what_is_no_real_number_is_named(self, name: str, value: Any) -> None:
        argument, call, good = ARRAYS[name]
        mistakes: list[Any] = [value]
        if not isinstance(value, list):
            filled = np.full(np.shape(good), value, dtype=object)
            mistakes += [filled, filled.tolist()]
        if value is None and name in OPTIONAL:
            mistakes = mistakes[1:] if np.ndim(good) else []
        for wrong in mistakes:
            with pytest.raises((TypeError, ValueError), match=rf"\b{argument}\b"):
                call(wrong)

    def test_wrong_shapes_are_named_with_the_shape_that_came(self, name: str) -> None:
        argument, call, good = ARRAYS[name]
        if argument in {"mass", "masses", "t"}:
            return  # any shape has a meaning, or has its own test
        wrong = np.ones((*np.shape(good)[:-1], 7))
        shape = ", ".join(map(str, wrong.shape)) + ("," if wrong.ndim == 1 else "")
        with pytest.raises(ValueError, match=rf"\b{argument}\b.*expected shape \(.*\), got \({shape}\)"):
            call(wrong)
        with pytest.raises(ValueError, match=rf"\b{argument}\b.*got \(\)"):
            call(1.0)


class TestTimes:
    @pytest.mark.parametrize(
        "t",
        [[], [[0.0, 1.0]], 1.0, [0.0, 0.0], [0.0, 2.0, 1.0], [0.0, 1.0, 1.0], [1.0, 0.0, 0.5], [0.0, np.nan]],
    )
    def test_times_are_one_strictly_monotone_row(self, t: Any) -> None:
        with pytest.raises(ValueError, match=r"\bt\b"):
            BODY.simulate(t, (1.0, 2.0, 3.0))

    def test_the_time_that_breaks_the_order_is_named(self) -> None:
        with pytest.raises(ValueError, match=r"t\[3\]|\b3\b"):
            BODY.simulate([0.0, 1.0, 2.0, 1.5, 4.0], (1.0, 2.0, 3.0))


class TestOptions:
    @pytest.mark.parametrize(
        ("options", "word"),
        [
            ({"rtol": 0.0}, "rtol"),
            ({"rtol": -1e-10}, "rtol"),
            ({"rtol": np.nan}, "rtol"),
            ({"rtol": 2.0}, "rtol"),
            ({"atol": -1.0}, "atol"),
            ({"atol": np.nan}, "atol"),
            ({"method": "rk4"}, "method"),
            ({"method": "RK4"}, "method"),
            ({"about": "middle"}, "about"),
            ({"attitude": (0.0, 0.0, 0.0, 0.0)}, "attitude"),
        ],
    )
    def test_what_is_no_option_is_named(self, options: dict[str, Any], word: str) -> None:
        with pytest.raises(ValueError, match=word):
            BODY.simulate([0.0, 1.0], (1.0, 2.0, 3.0), **options)

    def test_a_wrong_method_is_answered_with_those_there_are(self) -> None:
        method: Any = "rk4"
        with pytest.raises(ValueError, match="dop853"):
            BODY.simulate([0.0, 1.0], (1.0, 2.0, 3.0), method=method)

    def test_unknown_keywords_are_type_errors(self) -> None:
        body: Any = BODY
        make: Any = RigidBody
        box: Any = solids.box
        calls: tuple[Any, ...] = (
            lambda: body.simulate([0.0, 1.0], (1, 2, 3), tol=1e-3),
            lambda: make(m=1.0, inertia=EYE),
            lambda: make(),
            lambda: box(1, 2, 3),
            lambda: body.kinetic_energy(),
        )
        for call in calls:
            with pytest.raises(TypeError):
                call()


class TestNonFiniteTensors:
    def test_a_row_that_is_not_finite_is_nan_for_itself_alone(self) -> None:
        tensors = np.array([np.diag([1.0, 2, 3]), np.full((3, 3), np.nan), np.diag([3.0, 2, 1])])
        found = principal_axes(tensors)
        assert np.isnan(found.moments[1]).all()
        assert np.isnan(found.axes[1]).all()
        assert np.array_equal(found.moments[::2], [[1.0, 2, 3]] * 2)

    def test_an_asymmetric_row_is_an_error_that_names_it(self) -> None:
        tensors = np.array([EYE, EYE, EYE])
        tensors[2, 0, 1] = 0.5
        with pytest.raises(ValueError, match=r"(?=.*symmetric)(?=.*\b2\b)"):
            principal_axes(tensors)


class TestClasses:
    def test_every_error_is_a_polhode_error_and_a_value_error(self) -> None:
        for name in errors.__all__:
            kind = getattr(errors, name)
            assert issubclass(kind, errors.PolhodeError)
            assert issubclass(kind, ValueError)

    def test_the_compiled_core_raises_these_very_classes(self) -> None:
        with pytest.raises(polhode.errors.InvalidInertiaError) as caught:
            RigidBody(1.0, np.diag([1.0, 1.0, 3.0]))
        assert type(caught.value) is errors.InvalidInertiaError

    def test_a_message_is_one_line(self) -> None:
        for call in (
            lambda: RigidBody(1.0, np.diag([1.0, 1.0, 3.0])),
            lambda: RigidBody(-1.0, EYE),
            lambda: RigidBody.from_mesh(EYE, [[0, 1, 2]], density=1.0),
            lambda: BODY.simulate([0.0, 0.0], (1, 2, 3)),
        ):
            with pytest.raises(ValueError, match=r".{20}") as caught:
                call()
            assert "\n" not in str(caught.value)

    @pytest.mark.parametrize("mass", [0.0, -1.0, -np.inf])
    def test_a_mass_is_positive(self, mass: float) -> None:
        with pytest.raises(ValueError, match="mass"):
            RigidBody(mass, EYE)
        with pytest.raises(ValueError, match=r"(?=.*mass)(?=.*\b1\b)"):
            RigidBody([1.0, mass], EYE)
