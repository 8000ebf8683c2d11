"""What the commands take; the help reads it, so nothing heavy is imported here."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Final, Literal, TypeAlias

from cyclopts import Parameter

if TYPE_CHECKING:
    from collections.abc import Sequence

__all__ = [
    "MODES",
    "AssembleOptions",
    "BodyOptions",
    "CheckOptions",
    "Count",
    "EnsembleOptions",
    "FlybyOptions",
    "LedgerOptions",
    "LengthUnit",
    "MoleculeOptions",
    "OutputOptions",
    "ReportOptions",
    "SpinOptions",
]


def _count(_: Any, tokens: Sequence[Any]) -> int:
    """Read the digits, or refuse what is no whole number."""
    text = tokens[0].value.strip()
    if not re.fullmatch(r"[+-]?[0-9]+", text):
        raise ValueError(f"expected a whole number, got {text!r}")
    return int(text)


Count: TypeAlias = Annotated[int, Parameter(converter=_count)]
LengthUnit: TypeAlias = Literal["m", "mm", "cm", "um", "nm", "km", "in", "ft", "angstrom"]
Described: TypeAlias = Literal["urdf", "sdf", "mjcf"]
Engine: TypeAlias = Literal["mujoco", "drake", "pinocchio", "pybullet", "simulink", "matlab"]
Program: TypeAlias = Literal[Described, Engine, "adams", "solidworks", "onshape"]
Words: TypeAlias = tuple[str, ...]


@dataclass(frozen=True, kw_only=True)
class OutputOptions:
    """Where the report goes and in which form.

    Attributes
    ----------
    form
        A table for people or the same fields as JSON, where an infinite number is the string "Infinity" and
        an undefined one is null; JSON by default where --output ends in .json.
    output
        Write the report to this file instead of the terminal; - is standard output.
    """

    form: Annotated[Literal["table", "json"] | None, Parameter(name="--format")] = None
    output: Annotated[Path | None, Parameter(name="--output", allow_leading_hyphen=True)] = None


@dataclass(frozen=True, kw_only=True)
class BodyOptions:
    """How to read the file.

    Attributes
    ----------
    density
        Density, as in "2.7 g/cm^3"; a bare number is kg/m^3 where --length-unit is given, which the report
        says, else per the file's own unit of volume. It may have a sigma, as in "2.70 ± 0.02 g/cm^3". Each
        component its own, with or without a sigma: "body=2700, insert=7.80(5) g/cm^3", by the names of OBJ
        groups or by numbers.
    mass
        Mass instead of density, as in "0.3 lb"; a bare number is kg where --length-unit is given. It may have
        a sigma: "5.0 ± 0.1 kg", with +- as well, "5.0(1) kg" or "5.0 kg ± 2 %".
    length_unit
        Unit of the file's coordinates; results are then in SI units. Without it all results are in
        the file's own unit, and numbers on the command line carry none.
    weld
        Join corners that are at most this far apart; a bare number is in the unit of the file. Without it
        only equal corners are joined.
    closure
        Close an open mesh: caps closes each hole by a fan of triangles, hull takes the convex hull. The
        report says by how much that changes the volume; without it an open mesh is an error.
    orient
        Turn triangles that face inward; without it they are an error.
    union
        Join components of a mesh that overlap, so that what they share counts once (by manifold3d).
    repair
        Mend the mesh: weld corners, drop faces that stand twice, wind the others alike, fill loops. The
        report lists each step with the change of volume; without it such meshes are an error.
    index_base
        What the faces of an OBJ or plate file count vertices from: 1 (OBJ) or 0.
    bond_sigma
        Of a molecule: sigma of the length of each bond, as in 0.003 or "0.3 pm"; a bare number is in the unit
        of the file. Bonds are found by covalent radii; one in a ring cannot be stretched alone: an error.
    mass_sigmas
        Of a molecule: the masses of its isotopes have the sigmas that are on record.
    inertia
        Instead of a file, the tensor that a CAD program printed, with --mass and --com: Ixx Iyy Izz, with
        Ixy Ixz Iyz after them, or nine numbers row by row, as in "3 4 5 0.1 0 0 lbm in^2"; a bare number is
        kg m^2.
    com
        Position of the centre of mass, of --inertia, or of --moments from the fixed point; a bare number is
        in m.
    products
        Of --inertia, where a product is not zero: positive for the integral of x y dm, negative for minus
        that, the element of the tensor.
    inertia_about
        The point of --inertia.
    """

    density: Annotated[str | None, Parameter(name="--density")] = None
    mass: Annotated[str | None, Parameter(name="--mass")] = None
    length_unit: Annotated[LengthUnit | None, Parameter(name="--length-unit")] = None
    weld: Annotated[str | None, Parameter(name="--weld")] = None
    closure: Annotated[Literal["caps", "hull"] | None, Parameter(name="--closure")] = None
    orient: Annotated[bool, Parameter(name="--orient", negative="")] = False
    union: Annotated[bool, Parameter(name="--union", negative="")] = False
    repair: Annotated[bool, Parameter(name="--repair", negative="")] = False
    index_base: Annotated[Literal[0, 1], Parameter(name="--index-base")] = 1
    bond_sigma: Annotated[str | None, Parameter(name="--bond-sigma")] = None
    mass_sigmas: Annotated[bool, Parameter(name="--mass-sigmas", negative="")] = False
    inertia: Annotated[
        Words, Parameter(name="--inertia", negative="", consume_multiple=True, show_default=False)
    ] = ()
    com: Annotated[
        Words, Parameter(name=("--com", "--center"), negative="", consume_multiple=True, show_default=False)
    ] = ()
    products: Annotated[Literal["positive", "negative"] | None, Parameter(name="--products")] = None
    inertia_about: Annotated[
        Literal["center_of_mass", "com", "origin"], Parameter(name="--inertia-about")
    ] = "center_of_mass"


@dataclass(frozen=True, kw_only=True)
class ReportOptions:
    """What the report tells beyond the usual, and what it is held against.

    Attributes
    ----------
    about
        A point to give the inertia tensor about, as in 0 0 10 (in the unit of the file) or "0, 0, 1 cm".
    mass_unit
        Give masses and moments also in this unit, with the file's unit of length: g, lb, ...
    expect
        A report saved with --format json, or any of its fields: numbers that differ end with exit code 1.
    rtol
        How far they may differ, relative to the largest component.
    program
        Print the numbers for another program instead of the report, in its own signs, axes and order, with
        all their digits.
    """

    about: Annotated[
        Words, Parameter(name="--about", negative="", consume_multiple=True, show_default=False)
    ] = ()
    mass_unit: Annotated[str | None, Parameter(name="--mass-unit")] = None
    expect: Annotated[Path | None, Parameter(name="--expect")] = None
    rtol: Annotated[float, Parameter(name="--rtol")] = 1e-6
    program: Annotated[Program | None, Parameter(name="--as")] = None


@dataclass(frozen=True, kw_only=True)
class AssembleOptions:
    """What is told of an assembly.

    Attributes
    ----------
    depth
        How many levels below the whole are shown.
    every
        Show every part of these levels, instead of the first 40; --format json always does.
    save
        Where to draw the parts and their masses (.png, .pdf, .svg), or write the whole as one body (.json,
        .npz), or its tree as a ledger (.csv). May be repeated.
    """

    depth: Annotated[Count, Parameter(name="--depth")] = 2
    every: Annotated[bool, Parameter(name="--all", negative="")] = False
    save: Annotated[tuple[Path, ...], Parameter(name="--save", negative="", show_default=False)] = ()


@dataclass(frozen=True, kw_only=True)
class CheckOptions:
    """How a robot's links are judged.

    Attributes
    ----------
    packages
        A folder that holds the packages of package:// and model:// addresses. May be repeated; folders above
        the file, ROS_PACKAGE_PATH, GZ_SIM_RESOURCE_PATH and AMENT_PREFIX_PATH are searched too.
    allow_outside
        Read meshes and included files wherever their names lead; without it only in the model's own package
        and in those of --packages.
    strict
        Let links that are only suspect fail as well.
    fix
        Write the file to this one with right values where links fail, everything else as it stands.
    density
        Of links for which the file says no mass, such as 1000 kg/m^3: --fix then writes what their shapes
        have.
    mass
        Of all links for which the file says no mass, together; shared by the volumes of their shapes.
    """

    packages: Annotated[tuple[Path, ...], Parameter(name="--packages", negative="", show_default=False)] = ()
    allow_outside: Annotated[bool, Parameter(name="--allow-outside", negative="")] = False
    strict: Annotated[bool, Parameter(name="--strict", negative="")] = False
    fix: Annotated[Path | None, Parameter(name="--fix")] = None
    density: Annotated[str | None, Parameter(name="--density")] = None
    mass: Annotated[str | None, Parameter(name="--mass")] = None


@dataclass(frozen=True, kw_only=True)
class MoleculeOptions:
    """Which nuclides a molecule is made of, and which of its moments are equal.

    Attributes
    ----------
    isotopes
        Nuclides to put in: for an element (18O: all its atoms) or for one atom by its number in the file
        (2=13C). May be repeated: each option is one isotopologue, in which several are separated by commas.
    masses
        Where a label of the file names no isotope: the most common one of the element, or the average over
        them.
    length_unit
        Unit of the file's coordinates.
    rtol
        Moments closer than this times the largest count as equal, for the class of the top; by default 1e-6,
        and more where the file has so few digits that their rounding can make more. The report tells which.
    bond_sigma
        Sigma of the length of each bond, as in 0.003 or "0.3 pm"; a bare number is in the unit of the file.
        Bonds are found by covalent radii; one in a ring cannot be stretched alone and is an error.
    mass_sigmas
        The masses of isotopes have the sigmas that are on record.
    """

    isotopes: Annotated[Words, Parameter(name="--isotopes", negative="", show_default=False)] = ()
    masses: Annotated[Literal["most_common", "average"], Parameter(name="--masses")] = "most_common"
    length_unit: Annotated[LengthUnit, Parameter(name="--length-unit")] = "angstrom"
    rtol: Annotated[float | None, Parameter(name="--rtol")] = None
    bond_sigma: Annotated[str | None, Parameter(name="--bond-sigma")] = None
    mass_sigmas: Annotated[bool, Parameter(name="--mass-sigmas", negative="")] = False


@dataclass(frozen=True, kw_only=True)
class LedgerOptions:
    """What is told of a ledger.

    Attributes
    ----------
    tree
        A table with the columns child and parent, where the table of parts has no column parent.
    depth
        How many levels below the whole are shown.
    of
        Whose variance is shared out among the parts: mass, Cx, Cy, Cz, Ixx, Iyy, Izz, Ixy, Ixz or Iyz.
    at
        The id of the assembly that is shown instead of the whole.
    overwrite
        Roll up over numbers that the rows of assemblies state; without it they are an error.
    ignore
        A column to leave out. May be repeated; other columns that are not known are an error.
    picture
        Where to draw who contributes mass and who contributes variance (.png, .pdf, .svg).
    """

    tree: Annotated[Path | None, Parameter(name="--tree")] = None
    depth: Annotated[Count, Parameter(name="--depth")] = 2
    of: Annotated[str, Parameter(name="--of")] = "mass"
    at: Annotated[str | None, Parameter(name="--at")] = None
    overwrite: Annotated[bool, Parameter(name="--overwrite", negative="")] = False
    ignore: Annotated[Words, Parameter(name="--ignore", negative="", show_default=False)] = ()
    picture: Annotated[Path | None, Parameter(name="--picture")] = None


@dataclass(frozen=True, kw_only=True)
class FlybyOptions:
    """A tumbling body past a planet.

    Attributes
    ----------
    moments
        Three principal moments instead of a file, as in "0.64 0.97 1"; only their ratios matter.
    periods
        The two periods before the flyby: rotation about the long axis and mean precession of that axis, as in
        "264.178 h, 27.38547 h"; a bare number is in s. With sigmas each clone has periods of its own:
        "263 ± 6 h, 27.38(7) h".
    mode
        Required: the motion that has these periods. long-axis: ω circles the axis of the least moment;
        short-axis: that of the greatest.
    eccentricity
        Of the orbit past the planet, 1 or more: 4.25 for Apophis in 2029.
    periapsis
        Least distance from the planet's centre, as in "38011.486 km"; a bare number is in m.
    radius
        Of the planet, as in "6378 km"; an orbit that comes nearer to its centre is refused. By default that
        of the Earth, 6371 km, if --mu is the Earth's.
    mu
        Gravitational parameter of the planet, as in "398600.4418 km^3/s^2"; a bare number is in m^3/s^2. By
        default that of the Earth.
    inclination
        Angle between the orbit's plane and the plane of reference, as in "30 deg"; a bare number is in rad.
        It matters where --pole is stated, as --node and --argument do.
    node
        Longitude of the ascending node, from the first axis of reference in its plane, as in "30 deg"; a bare
        number is in rad.
    argument
        Argument of the periapsis, from the ascending node in the orbit's plane, as in "30 deg"; a bare number
        is in rad.
    span
        How long, with the least distance in the middle, as in "6 d"; a bare number is in s.
    pole
        Direction of the angular momentum before the flyby, three numbers along the axes of the orbit's
        elements; by default all directions.
    pole_sigma
        How well it is known: a standard deviation along each of two axes across it, as in "5 deg".
    clones
        How many.
    seed
        Of the random numbers: the same seed gives the same clones.
    rtol
        Relative tolerance of the integration.
    client
        Address of the scheduler of a dask cluster that runs the clones, as in tcp://127.0.0.1:8786; by
        default the threads of this machine do.
    save
        Where to draw the distributions (.png, .pdf, .svg). May be repeated.
    """

    moments: Annotated[
        Words, Parameter(name="--moments", negative="", consume_multiple=True, show_default=False)
    ] = ()
    periods: Annotated[
        Words, Parameter(name="--periods", negative="", consume_multiple=True, show_default=False)
    ] = ()
    mode: Annotated[Literal["long-axis", "short-axis"] | None, Parameter(name="--mode")] = None
    eccentricity: Annotated[float, Parameter(name="--eccentricity")] = 1.0
    periapsis: Annotated[str, Parameter(name="--periapsis")] = "40000 km"
    radius: Annotated[str | None, Parameter(name="--radius")] = None
    mu: Annotated[str, Parameter(name="--mu")] = "3.986004418e14"
    inclination: Annotated[str, Parameter(name="--inclination")] = "0"
    node: Annotated[str, Parameter(name="--node")] = "0"
    argument: Annotated[str, Parameter(name="--argument")] = "0"
    span: Annotated[str, Parameter(name="--span")] = "6 d"
    pole: Annotated[
        Words, Parameter(name="--pole", negative="", consume_multiple=True, show_default=False)
    ] = ()
    pole_sigma: Annotated[str, Parameter(name="--pole-sigma")] = "0"
    clones: Annotated[Count, Parameter(name="--clones")] = 1000
    seed: Annotated[Count, Parameter(name="--seed")] = 0
    rtol: Annotated[float, Parameter(name="--rtol")] = 1e-10
    client: Annotated[str | None, Parameter(name="--client")] = None
    save: Annotated[tuple[Path, ...], Parameter(name="--save", negative="", show_default=False)] = ()


MODES: Final = (
    "state which of the two motions has these periods: --mode long-axis, where omega circles the axis of the "
    "least moment, or --mode short-axis, where it circles that of the greatest"
)


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
