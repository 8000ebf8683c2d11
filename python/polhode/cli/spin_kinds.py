"""What ``polhode spin`` tells of a free body and of a heavy top, under the same four headings."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from polhode._drift import drift
from polhode._lengths import lengths
from polhode._scene.pivot import path_of
from polhode.cli.layout import Column, Field, Table

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from polhode import FreeMotion, HeavyTop, Trajectory
    from polhode.cli.sigmas import Told

    Floats = NDArray[np.float64]

__all__ = ["FreeKind", "TopKind", "period_fields"]


class FreeKind:
    """A body on which nothing acts."""

    def __init__(self, motion: FreeMotion) -> None:
        self._motion = motion

    def fields(self, rate: float, rate_unit: str) -> list[Field]:
        """Tell the mode, the periods and the angles from L."""
        motion = self._motion
        angles, periods = np.rad2deg(motion.nutation), motion.periods

        def told(name: str, factor: float = 1.0) -> Told:
            found = periods.sigma
            if found is None:
                return {}
            return {"sigma": factor * getattr(found, name), "linear": getattr(found.linear, name)}

        return [
            Field("mode", "mode", str(motion.mode)),
            *period_fields(
                "rotation_period", "rotation period", periods.rotation, "P_psi, about e1", told("rotation")
            ),
            *period_fields(
                "precession_period",
                "precession period",
                periods.precession,
                "P_phi, mean, of e1 about L",
                told("precession"),
            ),
            *period_fields("flip_period", "flips every", periods.flip, "the intermediate axis", told("flip")),
            Field(
                "mean_precession",
                "mean precession",
                periods.rates * rate,
                rate_unit,
                "of e1 e2 e3 about L",
                **told("rates", rate),
            ),
            *(
                Field(f"angle_from_L.e{k + 1}", f"e{k + 1} from L", angles[k], "deg", "least, greatest")
                for k in range(3)
            ),
            Field("energy_ratio", "E / E_min", motion.energy_ratio, hint="1 for a spin about e3"),
            Field("modulus", "elliptic modulus", motion.modulus),
        ]

    def light_curve(self) -> list[Field | Table]:
        """Tell the periods in the other convention, and the frequencies of the light curve."""
        periods = self._motion.periods
        found = periods.light_curve()
        order = np.argsort(found.frequency)
        rows = [
            {
                "j": int(found.j[k]),
                "m": int(found.m[k]),
                "frequency": 86400.0 * f,
                "period": 1.0 / (3600.0 * f),
            }
            for k, f in zip(order.tolist(), found.frequency[order].tolist(), strict=True)
            if f > 0.0
        ]
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
            Table(
                "light_curve",
                [
                    Column("j", "j f_phi"),
                    Column("m", "+ m f_psi"),
                    Column("frequency", "frequency", "1/d"),
                    Column("period", "period", "h"),
                ],
                rows,
            ),
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
            *period_fields("nutation_period", "nutation period", motion.nutation_period, "", {}),
            Field(
                "mean_precession", "mean precession", motion.mean_precession * rate, rate_unit, "mean of phi'"
            ),
            Field("mean_spin", "mean spin", motion.mean_spin * rate, rate_unit, "mean of psi'"),
            Field("axial_spin", "omega along axis", motion.axial_spin * rate, rate_unit),
            Field(
                "sleeping_limit", "sleeping limit", motion.sleeping_limit * rate, rate_unit, "least, upright"
            ),
        ]

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
