"""What ``polhode spin`` tells of a free body and of a heavy top, under the same four headings."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from polhode._drift import drift
from polhode._lengths import lengths
from polhode._scene.pivot import path_of
from polhode.cli.layout import Cell, Column, Field, Table
from polhode.cli.spin_sigmas import of_shape

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from polhode import FreeMotion, HeavyTop, Trajectory
    from polhode.cli.sigmas import Told

    Floats = NDArray[np.float64]

__all__ = ["FreeKind", "TopKind", "period_fields"]

ROUNDING: Final = 1e-12
"""Of the largest component of omega: less is what rounding of the axes leaves."""


class FreeKind:
    """A body on which nothing acts."""

    def __init__(self, motion: FreeMotion) -> None:
        self._motion = motion

    def fields(self, rate: float, rate_unit: str) -> list[Field]:
        """Tell the mode, the periods and the angles from L."""
        motion = self._motion
        angles, periods = np.rad2deg(motion.nutation), motion.periods
        of_angles = of_shape(motion)
        return [
            Field("mode", "mode", str(motion.mode)),
            *self._periods(),
            Field(
                "mean_precession",
                "mean precession",
                periods.rates * rate,
                rate_unit,
                "of e1 e2 e3 about L",
                **self._told("rates", rate),
            ),
            *(
                Field(
                    f"angle_from_L.e{k + 1}",
                    f"e{k + 1} from L",
                    angles[k],
                    "deg",
                    "least, greatest",
                    **of_angles(f"nutation {k}"),
                )
                for k in range(3)
            ),
            Field(
                "energy_ratio",
                "E / E_min",
                motion.energy_ratio,
                hint="1 for a spin about e3",
                **of_angles("energy_ratio"),
            ),
            Field("modulus", "elliptic modulus", motion.modulus, **of_angles("modulus")),
        ]

    def _told(self, name: str, factor: float = 1.0) -> Told:
        found = self._motion.periods.sigma
        if found is None:
            return {}
        return {"sigma": factor * getattr(found, name), "linear": getattr(found.linear, name)}

    def _periods(self) -> list[Field]:
        """Return the periods that this mode has, by the words of the glossary."""
        motion, periods, told = self._motion, self._motion.periods, self._told
        mode = str(motion.mode)
        if not np.isnan(periods.turn):
            along = np.abs(motion.omega @ motion.body.principal.axes)
            is_along = mode != "spherical" and np.count_nonzero(along > ROUNDING * along.max()) == 1
            axis = f"e{int(np.argmax(along)) + 1}" if is_along else "an axis at rest in the body"
            if not np.isfinite(periods.turn):
                return [Field("turn_period", "one turn", periods.turn, "s", "the body is at rest")]
            return [
                *period_fields("turn_period", "one turn", periods.turn, f"about {axis}", told("turn")),
                *self._wobble(),
            ]
        if mode == "symmetric":
            axis = f"e{int(motion.cones.axis) + 1}"
            return [
                *period_fields(
                    "spin_period",
                    "spin period",
                    periods.spin,
                    f"about {axis}, relative to the plane of {axis} and L",
                    told("spin"),
                ),
                *period_fields(
                    "precession_period",
                    "precession period",
                    periods.precession,
                    f"of {axis} about L",
                    told("precession"),
                ),
            ]
        hints = {
            "long-axis": "P_psi, of the rotation about e1",
            "short-axis": "P_psi, of the swing of e1 to and fro",
            "separatrix": "P_psi: omega never returns",
        }
        flips = "the intermediate axis turns over" + (", once" if mode == "separatrix" else "")
        return [
            *period_fields(
                "rotation_period", "rotation period", periods.rotation, hints[mode], told("rotation")
            ),
            *period_fields(
                "precession_period",
                "precession period",
                periods.precession,
                "P_phi, mean, of e1 about L",
                told("precession"),
            ),
            *(
                []
                if np.isnan(periods.flip)
                else period_fields("flip_period", "flips every", periods.flip, flips, told("flip"))
            ),
        ]

    def _wobble(self) -> list[Field]:
        motion, wobble = self._motion, self._motion.periods.wobble
        hint = "of small oscillations of omega in the body"
        if not np.isnan(wobble):
            return period_fields("wobble_period", "wobble", wobble, hint, self._told("wobble"))
        is_unstable = str(motion.mode) == "steady"
        why = "the spin is unstable" if is_unstable else "omega rests wherever it is put in the body"
        return [Field("wobble_period", "wobble", None, hint=why, cells=["none"])]

    def light_curve(self) -> list[Field | Table]:
        """Return the frequencies of the light curve, and periods of a tumbling body in the other convention.

        Returns
        -------
        list of Field and Table
            Empty for a motion that never repeats.
        """
        periods = self._motion.periods
        found = periods.light_curve()
        is_known = found.frequency > 0.0
        if not is_known.any():
            return []
        # Spins of a laboratory in seconds, those of asteroids in hours; the JSON has hours.
        is_slow = float(found.frequency[is_known].min()) < 1.0 / 3600.0
        columns = [
            Column("frequency", "frequency", "1/d", shown="" if is_slow else "1/s"),
            Column("period", "period", "h", shown="" if is_slow else "s"),
        ]
        per = (86400.0, 3600.0) if is_slow else (1.0, 1.0)
        order = np.argsort(found.frequency)
        rows = []
        for k, f in zip(order.tolist(), found.frequency[order].tolist(), strict=True):
            if f > 0.0:
                numbers = {
                    "frequency": (86400.0 * f, per[0] * f),
                    "period": (1.0 / (3600.0 * f), 1.0 / (per[1] * f)),
                }
                cells = {name: Cell(f"{shown:.4g}", value) for name, (value, shown) in numbers.items()}
                rows.append({"j": int(found.j[k]), "m": int(found.m[k]), **cells})
        if not np.isnan(periods.turn):
            return [Table("light_curve", [Column("j", "j / turn"), *columns], rows)]
        if not np.isnan(periods.spin):
            of_spin = [Column("j", "j / precession"), Column("m", "+ m / spin"), *columns]
            return [Table("light_curve", of_spin, rows)]
        swings = "swinging" if self._motion.mode == "long-axis" else "rotation"
        return [
            *period_fields(
                "short_axis.rotation_period", "P_psi, short axis", periods.rotation, f"{swings}, about e3", {}
            ),
            *period_fields(
                "short_axis.precession_period",
                "P_phi, short axis",
                periods.precession_short_axis,
                "mean, of e3 about L",
                {},
            ),
            Table("light_curve", [Column("j", "j f_phi"), Column("m", "+ m f_psi"), *columns], rows),
        ]

    def constants(self, moment_unit: str) -> list[Field]:
        """Give what is conserved: the energy and the angular momentum."""
        motion, unit = self._motion, f"{moment_unit}/s"
        momentum = motion.angular_momentum
        size = float(lengths(momentum))
        return [
            Field("kinetic_energy", "kinetic energy", motion.kinetic_energy, f"{moment_unit}/s^2"),
            Field("angular_momentum", "|L|", size, unit),
            Field("angular_momentum_vector", "L, in space", momentum, unit, scale=size),
        ]

    def stability(self) -> list[Field]:
        """Tell whether steady spins with this angular momentum are stable."""
        squares = self._motion.stability
        words = ["stable" if x > 0 else "unstable" if x < 0 else "neutral" for x in squares]
        words = ["undefined" if np.isnan(x) else word for x, word in zip(squares, words, strict=True)]
        return [
            Field("stability", "spin about e1 e2 e3", ", ".join(words)),
            Field(
                "stability_frequency_squared", "frequency^2", squares, "1/s^2", "of oscillations in the body"
            ),
        ]

    def drifts(self, trajectory: Trajectory) -> list[Field]:
        """Tell how well the trajectory keeps what is conserved."""
        energy = trajectory.kinetic_energy().total
        momentum = trajectory.angular_momentum().total
        hint = "largest, relative; the vector in space"
        return [
            Field(
                "kinetic_energy_drift",
                "drift of energy",
                drift(energy, np.abs(energy)),
                hint="largest, relative",
            ),
            Field("angular_momentum_drift", "drift of L", drift(momentum, lengths(momentum)), hint=hint),
        ]


class TopKind:
    """A symmetric top under gravity, its origin fixed."""

    def __init__(self, motion: HeavyTop) -> None:
        self._motion = motion

    def fields(self, rate: float, rate_unit: str) -> list[Field]:
        """Tell how the axis nods and goes round."""
        motion = self._motion
        limits = np.rad2deg(motion.nutation_limits)
        return [
            Field("path", "path of the axis", path_of(motion)),
            Field("nutation_limits", "axis from vertical", limits, "deg", "least, greatest"),
            *self._periods(),
            Field(
                "mean_precession", "mean precession", motion.mean_precession * rate, rate_unit, "mean of phi'"
            ),
            Field("mean_spin", "mean spin", motion.mean_spin * rate, rate_unit, "mean of psi'"),
            Field("axial_spin", "omega along axis", motion.axial_spin * rate, rate_unit),
            Field(
                "sleeping_limit", "sleeping limit", motion.sleeping_limit * rate, rate_unit, "least, upright"
            ),
        ]

    def _periods(self) -> list[Field]:
        """Return the periods that this path has, by the words of the glossary."""
        motion = self._motion
        period, why = motion.nutation_period, "the inclination of the axis is constant"
        if not np.isnan(period):
            hint = "" if np.isfinite(period) else "the axis never returns"
            return period_fields("nutation_period", "nutation period", period, hint, {})
        fields = [Field("nutation_period", "nutation period", None, hint=why, cells=["none"])]
        speed = float(lengths(motion.omega))
        if str(motion.path) != "steady" or speed == 0.0:
            return fields
        return [*period_fields("turn_period", "one turn", 2.0 * np.pi / speed, "about the axis", {}), *fields]

    def constants(self, moment_unit: str) -> list[Field]:
        """Give what is conserved: the energy and the angular momentum about the vertical."""
        start = self._motion.at([0.0])
        kinetic, potential = self._energies(start)
        upright = start.angular_momentum().total[0, 2]
        hint = "kinetic and of its weight, from the pivot"
        return [
            Field("energy", "energy", (kinetic + potential)[0], f"{moment_unit}/s^2", hint),
            Field("angular_momentum_vertical", "L, vertical", upright, f"{moment_unit}/s"),
        ]

    def stability(self) -> list[Field]:
        """Tell whether the top would sleep upright with this spin about its axis."""
        is_stable = abs(self._motion.axial_spin) >= self._motion.sleeping_limit
        return [Field("stability", "upright", "stable" if is_stable else "unstable")]

    def drifts(self, trajectory: Trajectory) -> list[Field]:
        """Tell how well the trajectory keeps what is conserved."""
        kinetic, potential = self._energies(trajectory)
        momentum = trajectory.angular_momentum().total
        energy = drift(kinetic + potential, kinetic + np.abs(potential))
        upright = drift(momentum[:, 2], lengths(momentum))
        return [
            Field("energy_drift", "drift of energy", energy, hint="largest, relative"),
            Field("angular_momentum_drift", "drift of L vertical", upright, hint="largest, relative to L"),
        ]

    def _energies(self, trajectory: Trajectory) -> tuple[Floats, Floats]:
        """Kinetic energy, and that of the weight, zero at the height of the pivot."""
        height = -(trajectory.point("center_of_mass") @ self._motion.gravity)
        return trajectory.kinetic_energy().total, float(trajectory.body.mass) * height


def period_fields(key: str, label: str, seconds: float, hint: str, told: Told) -> list[Field]:
    """Give a period in seconds, and a long one in days too."""
    fields = [Field(key, label, seconds, "s", hint, **told)]
    if np.isfinite(seconds) and seconds >= 3600.0:
        if "sigma" in told:
            told = {**told, "sigma": np.asarray(told["sigma"]) / 86400.0}
        fields.append(Field(f"in_days.{key}", "", seconds / 86400.0, "d", **told))
    return fields
