"""What the commands of a motion take; the help reads it, so nothing heavy is imported here."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Final, Literal, TypeAlias

from cyclopts import Parameter

from polhode.cli.counts import Count  # noqa: TC001  (cyclopts reads annotations)

__all__ = ["MODES", "EnsembleOptions", "SpinOptions"]

MODES: Final = (
    "state which of the two motions has these periods: --mode long-axis, where omega circles the axis of the "
    "least moment, or --mode short-axis, where it circles that of the greatest"
)

Words: TypeAlias = tuple[str, ...]


@dataclass(frozen=True, kw_only=True)
class StartOptions:
    """A motion from its start to its end; the commands say in their own words what they take."""

    moments: Annotated[
        Words, Parameter(name="--moments", negative="", consume_multiple=True, show_default=False)
    ] = ()
    omega: Annotated[
        Words, Parameter(name="--omega", negative="", consume_multiple=True, show_default=False)
    ] = ()
    attitude: Annotated[
        Words, Parameter(name="--attitude", negative="", consume_multiple=True, show_default=False)
    ] = ()
    gravity: Annotated[str | None, Parameter(name="--gravity")] = None
    wheel: Annotated[Words, Parameter(name="--wheel", negative="", show_default=False)] = ()
    until: Annotated[str | None, Parameter(name="--until")] = None


@dataclass(frozen=True, kw_only=True)
class SpinOptions(StartOptions):
    """How the body spins and what is kept of it.

    Attributes
    ----------
    moments
        Three principal moments instead of a file, as in "1 3 3.2" or "2 4 5 g cm^2"; a bare number is kg m^2.
        With sigmas: "1.00 ± 0.01, 3.00(2), 3.2".
    omega
        Angular velocity at the start, its components in the body, as in 0 6 0.01 or "10 20 30 deg/s"; a bare
        number is rad/s. With sigmas: "0, 6.00 ± 0.05, 0.010(2)".
    periods
        Instead of --omega, the two periods of a tumbling asteroid: rotation about the long axis and mean
        precession of that axis, as in "5.41 d, 7.35 d"; a bare number is in s. With sigmas:
        "263 ± 6 h, 27.38(7) h". --mode says which motion has them.
    mode
        Required with --periods: the motion that has them. long-axis: ω circles the axis of the least moment;
        short-axis: that of the greatest.
    gravity
        A top: the origin of the body stays where it is and this acceleration pulls along -z, as in 9.81; a
        bare number is m/s^2. The centre of mass and the origin have to lie on the symmetry axis.
    wheel
        A wheel that turns in the body: its axis, along the axes of --omega, and its momentum relative to the
        body, which is held, as in "z, 2.5 kg m^2/s" or "0, 0.6, 0.8, 1.2 N m s"; x, y and z name those axes,
        e1, e2 and e3 the principal ones. A bare number is in the report's unit of |L|. May be repeated. The
        moments of the body are those with its wheels locked.
    attitude
        Euler angles phi theta psi (ZXZ) at the start, as in "0 30 0 deg"; a bare number is in radians.
    until
        Time of the end, as in 20 or "30 d"; in s if bare. The start is 0. Without it the report tells
        what kind of motion it is, and nothing is saved.
    degrees
        Print angular velocity in deg/s, and read --omega without a unit in deg/s.
    axes
        Axes of the components: the file's, or the principal axes (ascending moments).
    samples
        Number of times, start and end included.
    save
        Where to write the motion: a picture (.png, .pdf, .svg), an animation (.html, .gif, .mp4) or its
        numbers (.csv, .npz, .json). May be repeated. A mesh is drawn as it is, one of more than
        10 000 triangles coarser; a molecule as balls, an assembly part by part, and a body of which
        only the moments are known as the box of the same inertia.
    """

    periods: Annotated[
        Words, Parameter(name="--periods", negative="", consume_multiple=True, show_default=False)
    ] = ()
    mode: Annotated[Literal["long-axis", "short-axis"] | None, Parameter(name="--mode")] = None
    degrees: Annotated[bool, Parameter(name="--degrees", negative="")] = False
    axes: Annotated[Literal["file", "principal"], Parameter(name="--axes")] = "file"
    samples: Annotated[Count, Parameter(name="--samples")] = 1001
    save: Annotated[tuple[Path, ...], Parameter(name="--save", negative="", show_default=False)] = ()


@dataclass(frozen=True, kw_only=True)
class EnsembleOptions(StartOptions):
    """One motion, many times.

    Numbers of --moments, --omega, --attitude, --mass and --center are the same for all members, or drawn:
    "1.00 ± 0.01" or "1.00(1)" from a normal distribution, "0.9 to 1.1" from a uniform one.

    Attributes
    ----------
    moments
        Three principal moments instead of a file, as in "1.00 ± 0.01, 3.00(2), 3.2"; a bare number is
        kg m^2.
    omega
        Angular velocity at the start, its components in the body, as in "0, 6.00 ± 0.05, 0.01"; a bare number
        is rad/s.
    attitude
        At the start: any for all attitudes, as likely, or Euler angles phi theta psi (ZXZ), as in
        "0 deg, 30 deg ± 2 deg, 0 deg" or "0, 0, 0 to 360 deg"; a bare number is in radians. Without it the
        axes of the body are those of space.
    gravity
        The origin of the body stays where it is and this acceleration pulls along -z, as in 9.81; a bare
        number is m/s^2.
    wheel
        A wheel that turns in the body: its axis and its momentum relative to the body, which is held, as in
        "z, 2.5 kg m^2/s" or "0, 0.6, 0.8, 1.2 N m s"; e1, e2 and e3 name the principal axes. May be repeated.
    until
        Time of the end, as in 20 or "30 d"; in s if bare. The start is 0.
    members
        How many.
    seed
        Of the random numbers, from 0 to 2^64 - 1: the same seed gives the same members.
    method
        How the motion is computed. With --gravity and a body that is drawn state one: exact where all bodies
        are symmetric tops, else taylor or dop853.
    rtol
        Relative tolerance of the integration.
    save
        Write the states of all members instead of telling their spread: to a file that NumPy reads (.npz) or
        to a zarr group (.zarr).
    samples
        Of --save: number of times, start and end included; 2 by default.
    resume
        Of --save: go on with what was begun there and ended half way.
    checkpoint
        Without --save: a file that keeps what is computed so far; where it is there the run goes on with it.
    chunk
        Members that are run, written or sent to a worker together; without --save a multiple of 4096.
    client
        Address of the scheduler of a dask cluster that runs the members, as in tcp://127.0.0.1:8786; by
        default the threads of this machine do.
    """

    members: Annotated[Count, Parameter(name="--members")] = 1000
    seed: Annotated[Count, Parameter(name="--seed")] = 0
    method: Annotated[
        Literal["auto", "exact", "taylor", "dop853", "splitting", "radau"], Parameter(name="--method")
    ] = "auto"
    rtol: Annotated[float, Parameter(name="--rtol")] = 1e-10
    save: Annotated[Path | None, Parameter(name="--save")] = None
    samples: Annotated[Count | None, Parameter(name="--samples")] = None
    resume: Annotated[bool, Parameter(name="--resume", negative="")] = False
    checkpoint: Annotated[Path | None, Parameter(name="--checkpoint")] = None
    chunk: Annotated[Count, Parameter(name="--chunk")] = 4096
    client: Annotated[str | None, Parameter(name="--client")] = None
