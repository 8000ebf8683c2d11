"""Derivatives of a motion by finite differences: for loads without series, such as functions."""

from __future__ import annotations

import inspect
from dataclasses import fields, is_dataclass, replace
from functools import cached_property, partial
from typing import TYPE_CHECKING, Any, Final, NamedTuple, cast

import numpy as np

from polhode import _core
from polhode.errors import PolhodeError
from polhode.results import MotionSensitivity
from polhode.uncertainty.motion import _exponential, _logarithm, _product, _take_row

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from numpy.typing import NDArray

    from polhode.motion.trajectory import Trajectory

    Floats = NDArray[np.float64]
    Recipe = tuple[str, tuple[Any, ...]]
    RecipeMaker = Callable[[Floats], Recipe]

__all__ = [
    "by_differences",
    "known_states",
    "numbers",
    "recipes",
]

HELD: Final = ("times", "t", "epoch", "target")
"""Arguments of loads that are not varied."""
AROUND: Final = ("_scheduled", "_with_epoch")
"""What is done to a part that was made."""


def recipes(load: _core.Load | None) -> list[Recipe]:
    """Return, for each part of a load, its function and arguments; nothing for compiled parts."""
    if load is None:
        return []
    try:
        _, (parts,) = cast("tuple[Any, tuple[list[Recipe]]]", _core.Load.__reduce__(load))
    except TypeError:
        return []
    return list(parts)


def known_states(load: _core.Load | None, made: list[Recipe]) -> set[str]:
    """Return the names of the states with fixed values: wheels whose speed is given."""
    names = iter(load.states if load is not None else ())
    plain = (_split_recipe(recipe)[1] for recipe in made)
    own = [(recipe, next(names, "")) for recipe in plain if recipe[0] in ("wheel", "slug")]
    return {name for (kind, given), name in own if kind == "wheel" and given[-1]["speed"] is not None}


def numbers(recipe: Recipe) -> Iterator[tuple[str, Floats, RecipeMaker]]:
    """Return the numbers among the arguments of a part by name, and the recipe with others in their place."""
    around, recipe = _split_recipe(recipe)
    if around:
        for name, values, changed in numbers(recipe):
            yield name, values, _nest_recipe(around, changed)
        return
    made_by, arguments = recipe
    function = getattr(_core, made_by, None)
    if function is None or made_by in ("callback", "torque_callback", "with_states"):
        return
    has_keywords = bool(arguments) and isinstance(arguments[-1], dict)
    plain, keywords = (arguments[:-1], arguments[-1]) if has_keywords else (arguments, {})
    named = dict(zip(inspect.signature(function).parameters, plain, strict=False)) | keywords
    for name, value in named.items():
        if isinstance(value, _core.Load):
            if value.states:  # one controller of several wheels, which would not be the same any more
                continue
            inner = recipes(value)
            for place, part in enumerate(inner):
                for deeper, values, changed in numbers(part):
                    rest = (inner[:place], inner[place + 1 :])
                    yield deeper, values, _with_load(made_by, named, name, changed, rest)
        elif is_dataclass(value):
            for deeper, values, placed in _fields_of(value):
                yield deeper, values, _with(made_by, named, name, placed)
        elif name not in HELD and isinstance(value, float | np.ndarray):
            yield name, np.array(value, dtype=float), _with(made_by, named, name, _plain)


def _split_recipe(recipe: Recipe) -> tuple[list[Recipe], Recipe]:
    """Split a recipe: return the operations on a part, the last first, and the recipe of the part."""
    around: list[Recipe] = []
    while recipe[0] in AROUND:
        around.append((recipe[0], recipe[1][1:]))
        recipe = recipe[1][0]
    return around, recipe


def _nest_recipe(around: list[Recipe], changed: RecipeMaker) -> RecipeMaker:
    def nest(values: Floats) -> Recipe:
        recipe = changed(values)
        for name, arguments in reversed(around):
            recipe = name, (recipe, *arguments)
        return recipe

    return nest


def _fields_of(path: Any) -> Iterator[tuple[str, Floats, Callable[[Floats], Any]]]:
    """Yield the numbers of an orbit, or of a field along one: name, value and a function that replaces it."""
    for field in fields(path):
        value = getattr(path, field.name)
        if is_dataclass(value):
            for deeper, values, placed in _fields_of(value):
                yield deeper, values, _within(path, field.name, placed)
        elif field.name not in HELD and value is not None:
            yield field.name, np.array(value, dtype=float), _within(path, field.name, _plain)


def _plain(values: Floats) -> Any:
    return values if values.ndim else float(values)


def _within(path: Any, name: str, placed: Callable[[Floats], Any]) -> Callable[[Floats], Any]:
    return lambda values: replace(path, **{name: placed(values)})


def _with(made_by: str, named: dict[str, Any], name: str, placed: Callable[[Floats], Any]) -> RecipeMaker:
    return lambda values: (made_by, (named | {name: placed(values)},))


def _with_load(
    made_by: str,
    named: dict[str, Any],
    name: str,
    changed: RecipeMaker,
    rest: tuple[list[Recipe], list[Recipe]],
) -> RecipeMaker:
    before, after = rest

    def nest(values: Floats) -> Recipe:
        load = _core.Load._from_parts([*before, changed(values), *after])
        return made_by, (named | {name: load},)

    return nest


STEP: Final = 2e-3
"""Step relative to the scale of a number."""


class _Scheme(NamedTuple):
    """Steps, and the factors of differences of order six, and of order four from the same motions."""

    steps: Floats
    six: Floats
    four: Floats


CENTRAL: Final = _Scheme(
    np.array([1.0, 2.0, 3.0, -1.0, -2.0, -3.0]),
    np.array([45.0, -9.0, 1.0, -45.0, 9.0, -1.0]) / 60.0,
    np.array([8.0, -1.0, 0.0, -8.0, 1.0, 0.0]) / 12.0,
)
FORWARD: Final = _Scheme(
    np.arange(7.0),
    np.array([-147.0, 360.0, -450.0, 400.0, -225.0, 72.0, -10.0]) / 60.0,
    np.array([-25.0, 48.0, -36.0, 16.0, -3.0, 0.0, 0.0]) / 12.0,
)
"""One-sided differences for a number that is zero and must not be negative, such as friction."""
BACKWARD: Final = _Scheme(-FORWARD.steps, -FORWARD.six, -FORWARD.four)
"""Those for a number at its upper limit."""
SIXTH: Final = np.array([15.0, -6.0, 1.0, 15.0, -6.0, 1.0])
"""Factors of the sixth difference at the steps of `CENTRAL`; -20 is that of the motion itself."""
SETTLED: Final = 1e-5
"""Largest difference of the two orders, relative to the largest derivative by the same number."""
SMOOTH: Final = 1e-4
"""Largest sixth difference over a step, likewise. It is more where the slopes on the two sides differ: six
times what they differ by. There central differences of every order have the mean of the two slopes.
"""
NOISE: Final = 1e-9
"""Error of a motion, relative to its scale."""
RTOL: Final = 1e-13
LEAST: Final = 1e-90
"""The first step that is tried for a number that is zero."""
FARTHEST: Final = 1e6
"""Largest ratio of the next trial step to the last one."""
MANY: Final = 1000
"""Largest ratio of the numbers of integration steps with and without the trial step."""


class _Starts(NamedTuple):
    """Initial values of several motions, one along the first axis of each array."""

    mass: Floats
    center: Floats
    tensor: Floats
    turn: Floats
    omega: Floats
    states: dict[str, Floats]


def by_differences(self: Trajectory) -> MotionSensitivity:
    """Return the derivatives by differences of order six of motions simulated tightly."""
    stack = self.omega.shape[:-2]
    rows = [_Row(self, stack, row).sensitivity() for row in range(int(np.prod(stack, dtype=int)))]

    def to_stack(parts: list[Floats]) -> Floats:
        return np.array(parts).reshape(*stack, *np.shape(parts[0]))

    load = tuple({name: to_stack([row.load[k][name] for row in rows]) for name in part}
                 for k, part in enumerate(rows[0].load))  # fmt: skip
    fields = [name for name in MotionSensitivity._fields if name != "load"]
    return MotionSensitivity(
        load=load, **{name: to_stack([getattr(r, name) for r in rows]) for name in fields}
    )


class _Row:
    """One motion of a stack, and its neighbours."""

    def __init__(self, run: Trajectory, stack: tuple[int, ...], row: int) -> None:
        place = np.unravel_index(row, stack)
        self.run, self.place = run, place
        self.body = _take_row(run.body, stack, row)
        self.load = _take_row(run._acting("sensitivity"), stack, row)
        self.recipes = recipes(self.load)
        self.omega, self.quaternion = run.omega[place], run.quaternion[place]
        self.states = {name: values[place][0] for name, values in run.states.items()}
        # Those that do not follow from the numbers of the load, and those that can be anything.
        self.given = {name: self.states[name] for name in run._origin.states}
        known = known_states(self.load, self.recipes)
        self.free = {name: values for name, values in self.states.items() if name not in known}
        self.most_steps: int | None = None
        self.tensor = self.body.inertia_about("origin") if run.pivoted else self.body.inertia

    def sensitivity(self) -> MotionSensitivity:
        """Return all derivatives."""
        run, body = self.run, self.body
        axes = (body.principal_about("origin") if run.pivoted else body.principal).axes
        moments = np.linalg.eigvalsh(self.tensor)
        length = float(np.sqrt(moments[-1] / body.mass))
        speed = float(np.nanmax(np.linalg.norm(self.omega, axis=-1))) or 1.0 / float(np.ptp(run.t))
        state = [self.by("turn", k, 1.0, self.free) for k in range(3)]
        state += [self.by("omega", k, speed, self.free) for k in range(3)]
        for name, values in self.states.items():
            size = float(np.nanmax(np.abs(run.states[name][self.place])))
            for k in range(len(values)):
                is_free = name in self.free
                state.append(self.by(name, k, size, self.free) if is_free else np.zeros_like(state[0]))
        tensor = []
        for i, j in ((0, 0), (1, 1), (2, 2), (1, 2), (2, 0), (0, 1)):
            along = np.zeros((3, 3))
            along[i, j] = along[j, i] = 1.0
            has_neighbours = moments[0] > 0.0
            tensor.append(self.by_tensor(axes @ along @ axes.T, float(moments[0])) if has_neighbours
                          else np.full_like(state[0], np.nan))  # fmt: skip
        center = [self.by("center", k, length, self.given) for k in range(3)]
        mass = self.by("mass", 0, float(body.mass), self.given)
        return MotionSensitivity(
            np.stack(state, axis=-1),
            np.stack(tensor[:3], axis=-1),
            np.stack(tensor[3:], axis=-1),
            np.stack(center, axis=-1),
            mass,
            tuple(self.by_load()),
            self.begins(speed),
        )

    def ends(self, starts: _Starts, load: _core.Load | None) -> Floats:
        """Run; (δ, ω, states) at every time, shape (n, T, 6 + k), δ from the attitude of this motion."""
        run = self.run
        about = "inertia_about_origin" if run.pivoted else "inertia"
        options: dict[str, Any] = {about: starts.tensor, "center_of_mass": starts.center, "rtol": 0.1}
        at_start: dict[str, Any] = {} if run.pivoted else {"velocity": run.velocity[self.place][0]}
        moved = _core.RigidBody(starts.mass, **options).simulate(
            run.t, starts.omega, _product(self.quaternion[0], _exponential(starts.turn)), load=load,
            position=run.position[self.place][0], about=run._about_word(), rtol=RTOL,
            states=starts.states or None, max_steps=self.most_steps, **at_start,
        )  # fmt: skip
        back = self.quaternion * np.array([-1.0, -1.0, -1.0, 1.0])
        tilt = _logarithm(_product(back, moved.quaternion))
        return np.concatenate([tilt, moved.omega, *moved.states.values()], axis=-1)

    def starts(self, held: dict[str, Floats], count: int = 1) -> _Starts:
        """Return this many copies of the start, with these states."""
        body, many = self.body, np.ones((count, 1))
        states = {name: many * values for name, values in held.items()}
        tensor = np.tile(self.tensor, (count, 1, 1))
        center, turn = many * body.center_of_mass, np.zeros((count, 3))
        return _Starts(np.full(count, body.mass), center, tensor, turn, many * self.omega[0], states)

    def by(self, name: str, k: int, size: float, held: dict[str, Floats]) -> Floats:
        """Compute the derivative by one number of scale `size`, with these states fixed, shape (T, 6 + k)."""

        def end_states(steps: Floats) -> Floats:
            starts = self.starts(held, len(steps))
            values = starts.states[name] if name in starts.states else getattr(starts, name)
            values.reshape(len(steps), -1)[:, k] += steps  # they are new
            return self.ends(starts, self.load)

        return self.along(end_states, size, name)

    def by_tensor(self, along: Floats, size: float) -> Floats:
        """Compute the derivative by the tensor, in the direction of another tensor."""

        def end_states(steps: Floats) -> Floats:
            starts = self.starts(self.given, len(steps))
            starts.tensor[:] += steps[:, None, None] * along
            return self.ends(starts, self.load)

        return self.along(end_states, size, "tensor")

    def by_load(self) -> Iterator[dict[str, Floats]]:
        """Compute the derivatives by the numbers of each part of the load."""
        for place, recipe in enumerate(self.recipes):
            found: dict[str, Floats] = {}
            for name, values, changed in numbers(recipe):
                size = float(np.max(np.abs(values)))
                columns = []
                for index in np.ndindex(values.shape):
                    other = partial(self.other_load, place, changed, values, index)
                    moved = partial(self.under, other)
                    columns.append(self.along(moved, size, name, partial(_scheme, other)))
                found[name] = np.moveaxis(np.array(columns), 0, -1).reshape(*columns[0].shape, *values.shape)
            yield found

    def other_load(
        self, place: int, changed: RecipeMaker, values: Floats, index: tuple[int, ...], step: float
    ) -> _core.Load:
        """Return the load with one number of a part increased by a step."""
        others = values.copy()
        others[index] += step
        parts = [*self.recipes[:place], changed(others), *self.recipes[place + 1 :]]
        return _core.Load._from_parts(parts)

    def under(self, other: Callable[[float], _core.Load], steps: Floats) -> Floats:
        """Return the motion under other loads."""
        start = self.starts(self.given)
        return np.array([self.ends(start, other(step))[0] for step in steps])

    def begins(self, speed: float) -> Floats:
        """Compute the derivative, by ω, of the initial states that are not given; they are linear in ω."""
        columns = []
        for axis in np.eye(3):
            starts = self.starts(self.given, 2)
            starts.omega[:] += speed * np.outer((1.0, -1.0), axis)
            there = self.body.simulate(
                self.run.t[:1], starts.omega, load=self.load, about=self.run._about_word(),
                states=starts.states or None,
            )  # fmt: skip
            parts = [
                values[:, 0] if name in self.free else np.zeros_like(values[:, 0])
                for name, values in there.states.items()
            ]
            states = np.concatenate([np.zeros((2, 0)), *parts], axis=-1)
            columns.append((states[0] - states[1]) / (2 * speed))
        return np.stack(columns, axis=-1)

    def along(
        self,
        moved: Callable[[Floats], Floats],
        size: float,
        name: str,
        scheme: Callable[[float], _Scheme] = lambda _: CENTRAL,
    ) -> Floats:
        """Compute the derivative by a number of scale `size`.

        `moved` gives the motions where it is more by these steps, `scheme` the differences to take.
        """
        step = STEP * size if size > 0.0 else self.step_from_zero(moved)
        return self.combine_differences(scheme(step), moved, step, name)

    def step_from_zero(self, moved: Callable[[Floats], Floats]) -> float:
        """Find the step for a number that is zero and has no scale: the step that moves the motion by `STEP`.

        It comes from below, since with a step that is much too long the motion takes very many steps.
        Nor does it go on to such a step where the number has no effect.
        """
        here = moved(np.zeros(1))
        large = _large(here)
        large[large == 0.0] = np.inf
        step = LEAST
        self.most_steps = MANY * (1 + int(np.max(self.run.steps[self.place])))
        while step < 1.0 / LEAST:
            try:
                there = moved(np.array([step]))
            except PolhodeError:
                step /= FARTHEST
                break
            change = float(np.max(np.abs(there - here) / large))
            factor = STEP / change if change > 0.0 else FARTHEST
            if 0.1 < factor < 10.0:
                break
            step *= min(max(factor, 1.0 / FARTHEST), FARTHEST)
        self.most_steps = None
        return step

    def combine_differences(
        self, scheme: _Scheme, moved: Callable[[Floats], Floats], step: float, name: str
    ) -> Floats:
        """Combine the motions of a scheme; both orders agree where the motion is smooth in the number.

        Where the slopes on the two sides of the number differ there is no derivative.
        """
        ends = moved(scheme.steps * step)
        found = np.asarray(np.tensordot(scheme.six, ends, 1) / step)
        off = np.abs(found - np.tensordot(scheme.four, ends, 1) / step)
        size, noise = _together(np.abs(found).max(axis=0)), _large(ends)
        late = np.flatnonzero(~(off <= SETTLED * size + NOISE * noise / step).all(axis=-1))
        if len(late):
            raise PolhodeError(
                f"sensitivity: differences by {name} of order four and six do not agree at "
                f"t = {float(self.run.t[late[0]])!r}: a change of the law is too close to that time, or the "
                "motion too sensitive; ask for other or earlier times"
            )
        if scheme is CENTRAL:
            sixth = np.abs(np.tensordot(SIXTH, ends, 1) - 20.0 * self.unmoved) / step
            found[~(sixth <= SMOOTH * size + NOISE * noise / step).all(axis=-1)] = np.nan
        return found

    @cached_property
    def unmoved(self) -> Floats:
        """The motion itself, as its neighbours are computed."""
        ends: Floats = self.ends(self.starts(self.free), self.load)[0]
        return ends


def _scheme(other: Callable[[float], _core.Load], step: float) -> _Scheme:
    """Return the differences for a number that may be at a limit."""
    farthest = float(max(CENTRAL.steps)) * step
    for direction, scheme in ((-1.0, FORWARD), (1.0, BACKWARD)):
        try:
            other(direction * farthest)
        except PolhodeError:
            return scheme
    return CENTRAL


def _together(sizes: Floats) -> Floats:
    """Return the largest of the attitude and of ω for each component; each state has a unit of its own."""
    for part in (slice(0, 3), slice(3, 6)):
        sizes[part] = sizes[part].max()
    return sizes


def _large(ends: Floats) -> Floats:
    """Return the scale of each number of the motions: one for an attitude."""
    large = _together(np.abs(ends).max(axis=(0, 1)))
    large[:3] = 1.0
    return large
