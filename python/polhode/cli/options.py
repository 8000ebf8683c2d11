"""What the commands take; the help reads it, so nothing heavy is imported here."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Final, Literal, TypeAlias

from cyclopts import Group, Parameter

if TYPE_CHECKING:
    from collections.abc import Sequence

__all__ = [
    "MODES",
    "RESULTS",
    "AssembleOptions",
    "AuditOptions",
    "BodyOptions",
    "CheckOptions",
    "Count",
    "EnsembleOptions",
    "FindingsOptions",
    "FlybyOptions",
    "IdentifyOptions",
    "LedgerOptions",
    "LengthUnit",
    "MoleculeOptions",
    "OutputOptions",
    "ReportOptions",
    "RollOptions",
    "SpinOptions",
]


def _count(_: Any, tokens: Sequence[Any]) -> int:
    """Read the digits, or refuse what is no whole number."""
    text = tokens[0].value.strip()
    if not re.fullmatch(r"[+-]?[0-9]+", text):
        raise ValueError(f"expected a whole number, got {text!r}")
    return int(text)


def _group(name: str) -> Parameter:
    """Return what puts an option into this group of the help; groups come in the order of these calls."""
    return Parameter(group=Group.create_ordered(name))


BODY: Final = _group("Body")
SURFACE: Final = _group("Surface that rolls")
ROTATION: Final = _group("Rotation before the flyby")
ORBIT: Final = _group("Orbit past the planet")
MOTION: Final = _group("Motion")
ATOMS: Final = _group("Atoms")
MEASURED: Final = _group("Measurement")
TABLE: Final = _group("Table")
VERDICT: Final = _group("Verdict")
COPY: Final = _group("Corrected copy")
RANDOM: Final = _group("Random numbers")
REPORT: Final = _group("Report")
RESULTS: Final = _group("Results")
NUMBERS: Final = _group("Body without a file, by its numbers")
MESH: Final = _group("Mesh")
MOLECULE: Final = _group("Molecule")
COMPUTATION: Final = _group("Computation")

FLAG: Final = Parameter(negative="", show_default=False)
WORDS: Final = Parameter(negative="", consume_multiple=True, show_default=False)
"""Numbers, in one argument or in several."""
REPEATED: Final = Parameter(negative="", show_default=False)

Count: TypeAlias = Annotated[int, Parameter(converter=_count)]
LengthUnit: TypeAlias = Literal["m", "mm", "cm", "um", "nm", "km", "in", "ft", "angstrom"]
Described: TypeAlias = Literal["urdf", "sdf", "mjcf"]
Engine: TypeAlias = Literal["mujoco", "drake", "pinocchio", "pybullet", "simulink", "matlab"]
Program: TypeAlias = Literal[Described, Engine, "adams", "solidworks", "onshape"]
Method: TypeAlias = Literal["auto", "exact", "taylor", "dop853", "splitting", "radau"]
Words: TypeAlias = tuple[str, ...]
Paths: TypeAlias = tuple[Path, ...]


@dataclass(frozen=True, kw_only=True)
class OutputOptions:
    """Where the report goes and in which form.

    Attributes
    ----------
    form
        A table for people, or JSON with the same fields, where an infinite number is the string "Infinity"
        and an undefined one is null. Default: table, or json if --output ends in .json.
    output
        File for the text of the report; - is standard output. Default: the terminal.
    """

    form: Annotated[Literal["table", "json"] | None, Parameter(name="--format"), RESULTS] = None
    output: Annotated[Path | None, Parameter(allow_leading_hyphen=True), RESULTS] = None


@dataclass(frozen=True, kw_only=True)
class FindingsOptions:
    """Where the verdict goes and in which form.

    Attributes
    ----------
    form
        A table for people; JSON with the same fields; lines, one for each finding and one that sums up; or
        SARIF 2.1.0 with places and fixes, for editors and review pages. Default: table, or json or sarif if
        --output ends so.
    output
        File for the text of the report; - is standard output. Default: the terminal.
    """

    form: Annotated[
        Literal["table", "json", "lines", "sarif"] | None, Parameter(name="--format"), RESULTS
    ] = None
    output: Annotated[Path | None, Parameter(allow_leading_hyphen=True), RESULTS] = None


@dataclass(frozen=True, kw_only=True)
class BodyOptions:
    """How to read the file.

    Attributes
    ----------
    density
        Density, such as "2.7 g/cm^3", or with its standard deviation "2.70 ± 0.02 g/cm^3". A number without
        a unit is in kg/m^3 if --length-unit is given, else in the file's own unit. Each component may have
        its own density, with or without a sigma: "body=2700, insert=7.80(5) g/cm^3", by the names in the file
        or by numbers; "*=1000" is that of all others. Of an image: a factor of its values, or one for each.
    mass
        Mass instead of density, such as "0.3 lb", or with its standard deviation "5.0 ± 0.1 kg" (also with
        +-), "5.0(1) kg" or "5.0 kg ± 2 %". A number without a unit is in kg if --length-unit is given.
    length_unit
        Unit of the coordinates in the file; results are then in SI units. Without it, results are in the
        file's own unit, and the numbers that you type must have no unit.
    thickness
        Thickness of a sheet, such as 2mm: the mesh, open or closed, is the middle of a shell and not the
        surface of a
        solid. A number without a unit is in the unit of the file.
    cut
        Normal of a plane that cuts the solid, such as "0 0 -1": what lies on the side to which it points is
        left, closed by the section.
    cut_point
        A point of the plane of --cut, such as "0 0 30" (in the unit of the file) or "0, 0, 3 cm". Default:
        the origin.
    weld
        Join corners that are at most this far apart, such as 1e-6. A number without a unit is in the unit of
        the file. Without it, only equal corners are joined.
    closure
        Close an open mesh: caps closes each hole with a fan of triangles, hull takes the convex hull. The
        report states the change of the volume. Without it, an open mesh is an error.
    orient
        Turn over triangles that face inward. Without it, they are an error.
    union
        Join components that overlap, so that the region that they share counts once (uses manifold3d).
    repair
        Repair the mesh: weld corners, remove duplicate faces, orient the others consistently, close holes.
        The report lists each step with the change of volume. Without it, such a mesh is an error.
    index_base
        Number of the first vertex in an OBJ or plate file: 1 (OBJ) or 0.
    bond_sigma
        Standard deviation of each bond length, such as 0.003 or "0.3 pm". A number without a unit is in the
        unit of the file. Bonds are found by covalent radii. A bond in a ring cannot change its length alone;
        this is refused.
    mass_sigmas
        Take the published standard deviations of the isotopes' masses.
    inertia
        Inertia tensor that a CAD program printed, with --mass: Ixx Iyy Izz, or these and Ixy Ixz Iyz, or nine
        numbers row by row, such as "3 4 5 0.1 0 0 lbm in^2". A number without a unit is in kg m^2.
    center_of_mass
        Position of the centre of mass, for --inertia and --moments, such as "0 0 4 cm". A number without a
        unit is in m. Default: the origin.
    products
        Sign of the products in --inertia: positive for the integral of x y dm, negative for minus this
        integral, the element of the tensor. Required if a product is not zero.
    inertia_about
        Point about which --inertia is taken.
    """

    density: Annotated[str | None, BODY] = None
    mass: Annotated[str | None, BODY] = None
    length_unit: Annotated[LengthUnit | None, BODY] = None
    thickness: Annotated[str | None, MESH] = None
    cut: Annotated[Words, WORDS, MESH] = ()
    cut_point: Annotated[Words, WORDS, MESH] = ()
    weld: Annotated[str | None, MESH] = None
    closure: Annotated[Literal["caps", "hull"] | None, MESH] = None
    orient: Annotated[bool, FLAG, MESH] = False
    union: Annotated[bool, FLAG, MESH] = False
    repair: Annotated[bool, FLAG, MESH] = False
    index_base: Annotated[Literal[0, 1], MESH] = 1
    bond_sigma: Annotated[str | None, MOLECULE] = None
    mass_sigmas: Annotated[bool, FLAG, MOLECULE] = False
    inertia: Annotated[Words, WORDS, NUMBERS] = ()
    center_of_mass: Annotated[Words, WORDS, Parameter(alias="--com"), NUMBERS] = ()
    products: Annotated[Literal["positive", "negative"] | None, NUMBERS] = None
    inertia_about: Annotated[Literal["center_of_mass", "com", "origin"], NUMBERS] = "center_of_mass"


@dataclass(frozen=True, kw_only=True)
class ReportOptions:
    """What the report adds, and with what it is compared.

    Attributes
    ----------
    about
        Point about which the inertia tensor is printed too, such as 0 0 10 (in the unit of the file) or
        "0, 0, 1 cm".
    mass_unit
        Unit of mass (g, lb, ...) in which masses and moments are printed too, with the file's unit of length.
    expect
        Report saved with --format json, or some of its fields, to compare with. If a number differs, the
        exit code is 1.
    rtol
        Largest difference that --expect allows, relative to the largest component.
    program
        Print the numbers for another program instead of the report, in its own signs, axes and order, with
        all their digits.
    """

    about: Annotated[Words, WORDS, REPORT] = ()
    mass_unit: Annotated[str | None, REPORT] = None
    expect: Annotated[Path | None, REPORT] = None
    rtol: Annotated[float, REPORT] = 1e-6
    program: Annotated[Program | None, Parameter(name="--as"), REPORT] = None


@dataclass(frozen=True, kw_only=True)
class AssembleOptions:
    """What is shown of an assembly.

    Attributes
    ----------
    depth
        Number of levels that are shown below the whole.
    every
        Show every part of these levels, not only the first 40. JSON always has all.
    save
        File for a picture of the parts and their masses (.png, .pdf, .svg), for the whole as one body (.json,
        .npz), or for the tree as a ledger (.csv). May be repeated.
    """

    depth: Annotated[Count, REPORT] = 2
    every: Annotated[bool, FLAG, Parameter(name="--all"), REPORT] = False
    save: Annotated[Paths, REPEATED, RESULTS] = ()


@dataclass(frozen=True, kw_only=True)
class CheckOptions:
    """How a robot's links are judged.

    Attributes
    ----------
    packages
        Folder with the packages of package:// and model:// addresses. May be repeated. Folders above the
        file, ROS_PACKAGE_PATH, GZ_SIM_RESOURCE_PATH and AMENT_PREFIX_PATH are searched too.
    allow_outside
        Read meshes and included files from any place. Without it, only from the model's own package and from
        --packages.
    strict
        Let links fail too that are only suspect.
    fix
        File for a copy with right values where links fail; everything else stays as it is.
    density
        Density of links without a mass, for example "1000 kg/m^3". --fix then writes mass and inertia
        computed from their shapes.
    mass
        Mass of all links without a mass, together. It is shared out by the volumes of their shapes.
    only_robots
        Pass over files that are no robots: another root element, or no link. Without it, they are an error.
    arguments
        Arguments of a xacro file, such as "prefix:=left_". May be repeated.
    baseline
        File with findings that are accepted, by link and law. Links fail only by what is new.
    accept
        Write the findings of this run into the file of --baseline.
    """

    packages: Annotated[Paths, REPEATED, VERDICT] = ()
    allow_outside: Annotated[bool, FLAG, VERDICT] = False
    strict: Annotated[bool, FLAG, VERDICT] = False
    only_robots: Annotated[bool, FLAG, VERDICT] = False
    arguments: Annotated[Words, REPEATED, VERDICT] = ()
    baseline: Annotated[Path | None, VERDICT] = None
    accept: Annotated[bool, FLAG, VERDICT] = False
    fix: Annotated[Path | None, COPY] = None
    density: Annotated[str | None, COPY] = None
    mass: Annotated[str | None, COPY] = None


@dataclass(frozen=True, kw_only=True)
class MoleculeOptions:
    """Which isotopes a molecule is made of, and which of its moments are equal.

    Attributes
    ----------
    isotopes
        Isotopes to put in: 18O takes the place of every oxygen, 2=13C that of the second atom in the file.
        Commas separate several in one isotopologue. May be repeated, for more isotopologues.
    masses
        Masses of atoms whose isotope the file does not name: of the most common isotope, or the average over
        the isotopes of the element.
    length_unit
        Unit of the coordinates in the file.
    rtol
        Largest difference of moments that count as equal, relative to the largest moment. Default: 1e-6, or
        more if the file has few digits; the report states it.
    bond_sigma
        Standard deviation of each bond length, such as 0.003 or "0.3 pm". A number without a unit is in the
        unit of the file. Bonds are found by covalent radii. A bond in a ring cannot change its length alone;
        this is refused.
    mass_sigmas
        Take the published standard deviations of the isotopes' masses.
    """

    isotopes: Annotated[Words, REPEATED, ATOMS] = ()
    masses: Annotated[Literal["most_common", "average"], ATOMS] = "most_common"
    length_unit: Annotated[LengthUnit, ATOMS] = "angstrom"
    bond_sigma: Annotated[str | None, ATOMS] = None
    mass_sigmas: Annotated[bool, FLAG, ATOMS] = False
    rtol: Annotated[float | None, REPORT] = None


@dataclass(frozen=True, kw_only=True)
class AuditOptions:
    """A record of a motion, and the body that it is of.

    Attributes
    ----------
    body
        File with the body: a mesh, CAD, a saved body, an assembly or a printout.
    moments
        Three moments along the axes of the record instead of a file, such as "2 3 4"; only their ratios
        matter.
    time
        Column with the times, in s. Without it, one with a usual name.
    attitude
        Columns with the attitudes, such as "qx,qy,qz,qw": a quaternion with the scalar last, nine elements of
        a matrix row by row, or three Euler angles with --sequence. Without it, those with usual names.
    sequence
        Sequence of the Euler angles, such as ZYX (capital letters: about the turned axes), in rad.
    omega
        Columns with the angular velocity along the axes of the body, in rad/s, such as "wx,wy,wz". Without
        it, those with usual names, or none: it is then computed from the attitudes.
    gravity
        Declared load: the weight, with an acceleration along -z such as 9.81, of a body that turns about its
        fixed origin. A number without a unit is in m/s^2.
    wheel
        Declared load: a wheel of the body, its axis and its constant angular momentum relative to the body,
        such as "z, 2.5 kg m^2/s" or "0, 0.6, 0.8, 1.2 N m s". May be repeated.
    finer
        A second record, from the same start with smaller steps: the report gives the order of the method.
    ratio
        Step of the program in the first record divided by that in the finer one. Without it, the ratio of
        the times between rows.
    rtol
        What is off by less, relative to the angular momentum and the angular velocity, counts as the error
        of the program's steps. Default: 1e-5.
    save
        File for a picture of the drifts (.png, .pdf, .svg). May be repeated.
    """

    body: Annotated[Path | None, BODY] = None
    moments: Annotated[Words, WORDS, BODY] = ()
    time: Annotated[str | None, TABLE] = None
    attitude: Annotated[Words, WORDS, TABLE] = ()
    sequence: Annotated[str | None, TABLE] = None
    omega: Annotated[Words, WORDS, TABLE] = ()
    gravity: Annotated[str | None, MOTION] = None
    wheel: Annotated[Words, REPEATED, MOTION] = ()
    finer: Annotated[Path | None, REPORT] = None
    ratio: Annotated[float | None, REPORT] = None
    rtol: Annotated[float | None, REPORT] = None
    save: Annotated[Paths, REPEATED, RESULTS] = ()


@dataclass(frozen=True, kw_only=True)
class IdentifyOptions:
    """A log of measurements, from which a body is to be found.

    Attributes
    ----------
    kind
        Required: what was measured. A tumble is the angular velocity of a body in free flight; a wrench is
        force and torque on a payload that is moved; of pendulums, the periods.
    time
        Column with the times, in s. Without it, one with a usual name.
    omega
        Columns with the angular velocity, such as "gx,gy,gz". Without it, those with usual names.
    rate_unit
        Unit of the angular velocity. Without it, that in the names of its columns, or rad/s.
    force
        Columns with the force of the sensor on the payload, in N.
    torque
        Columns with its torque about the origin of the sensor, in N m.
    specific_force
        Columns with what an accelerometer reads there, in m/s^2.
    angular_acceleration
        Columns with the angular acceleration, if it was measured.
    bias
        Whether constant offsets of the sensor are estimated too.
    omega_sigma
        Noise of the angular velocity, such as "0.01 rad/s". Without it, it is estimated.
    rotor
        Of a tumble: known angular momentum of a wheel inside, such as "0 0 0.02 N m s".
    mass
        Mass of the body, for a tumble or for pendulums, such as "1.2 kg" or "1.2 ± 0.01 kg".
    gravity
        Of pendulums: acceleration of free fall, such as 9.81. A number without a unit is in m/s^2.
    save
        File for a picture of the fit (.png, .pdf, .svg), or for the body (.json). May be repeated.
    """

    kind: Annotated[Literal["tumble", "wrench", "pendulum"] | None, MEASURED] = None
    time: Annotated[str | None, TABLE] = None
    omega: Annotated[Words, WORDS, TABLE] = ()
    rate_unit: Annotated[Literal["rad/s", "deg/s", "rpm"] | None, TABLE] = None
    force: Annotated[Words, WORDS, TABLE] = ()
    torque: Annotated[Words, WORDS, TABLE] = ()
    specific_force: Annotated[Words, WORDS, TABLE] = ()
    angular_acceleration: Annotated[Words, WORDS, TABLE] = ()
    bias: Annotated[bool, FLAG, MEASURED] = False
    omega_sigma: Annotated[str | None, MEASURED] = None
    rotor: Annotated[Words, WORDS, MEASURED] = ()
    mass: Annotated[str | None, MEASURED] = None
    gravity: Annotated[str | None, MEASURED] = None
    save: Annotated[Paths, REPEATED, RESULTS] = ()


@dataclass(frozen=True, kw_only=True)
class LedgerOptions:
    """What is shown of a ledger.

    Attributes
    ----------
    tree
        Table with the columns child and parent, if the table of parts has no column parent.
    overwrite
        Replace numbers that the rows of assemblies state by the sums of their parts. Without it, such numbers
        are an error.
    ignore
        Column to leave out. May be repeated. Other unknown columns are an error.
    depth
        Number of levels that are shown below the whole.
    of
        Number whose variance is shared out among the parts: mass, Cx, Cy, Cz, Ixx, Iyy, Izz, Ixy, Ixz or Iyz.
    at
        Id of the assembly to show. Default: the whole.
    save
        File for a picture of the parts' shares of mass and variance (.png, .pdf, .svg), or for all rows, sums
        included, as a table (.csv). May be repeated.
    """

    tree: Annotated[Path | None, TABLE] = None
    overwrite: Annotated[bool, FLAG, TABLE] = False
    ignore: Annotated[Words, REPEATED, TABLE] = ()
    depth: Annotated[Count, REPORT] = 2
    of: Annotated[str, REPORT] = "mass"
    at: Annotated[str | None, REPORT] = None
    save: Annotated[Paths, REPEATED, RESULTS] = ()


@dataclass(frozen=True, kw_only=True)
class FlybyOptions:
    """A tumbling body past a planet.

    Attributes
    ----------
    moments
        Three principal moments instead of a file, such as "0.64 0.97 1"; only their ratios matter.
    periods
        Two periods: of the rotation about the long axis, and of the mean precession of this axis, such as
        "264.178 h, 27.38547 h". A number without a unit is in s. With sigmas, each clone has its own periods:
        "263 ± 6 h, 27.38(7) h".
    mode
        Required: the motion that has these periods. long-axis: ω circles the axis of the least moment;
        short-axis: ω circles the axis of the greatest moment.
    pole
        Direction of the angular momentum, three numbers along the axes of the orbit's elements. Default: all
        directions.
    pole_sigma
        Standard deviation of this direction along each of two axes across it, such as "5 deg".
    phase
        Phase of the tumbling at the start, a fraction of the first period, such as 0.3 or "0.30 ± 0.02".
        Default: all phases.
    azimuth
        Angle about --pole by which the body is turned at the start, such as "40 deg" or "40 ± 5 deg".
        Default: all angles. With --pole, --phase and --azimuth, and a sigma of any number, the report has
        standard deviations of what is after.
    eccentricity
        Eccentricity of the orbit, 1 or more: 4.25 for Apophis in 2029.
    periapsis
        Least distance from the planet's centre, such as "38011.486 km". A number without a unit is in m.
    radius
        Radius of the planet, such as "6378 km"; an orbit that comes nearer to its centre is refused. Default:
        6371 km, if --mu is the Earth's.
    mu
        Gravitational parameter of the planet, such as "398600.4418 km^3/s^2". A number without a unit is in
        m^3/s^2. Default: the Earth's.
    inclination
        Angle between the planes of the orbit and of reference, such as "30 deg". A number without a unit is
        in rad. This angle, --node and --argument matter only with --pole.
    node
        Longitude of the ascending node, from the first axis of reference, such as "30 deg". A number without
        a unit is in rad.
    argument
        Argument of the periapsis, from the ascending node, such as "30 deg". A number without a unit is in
        rad.
    span
        Length of time, with the least distance in its middle, such as "6 d". A number without a unit is in s.
    n
        Number of clones.
    seed
        Seed of the random numbers; the same seed makes the same clones.
    rtol
        Relative tolerance of the integration.
    client
        Address of the scheduler of a dask cluster that runs the clones, such as tcp://127.0.0.1:8786.
        Default: the threads of this machine.
    save
        File for a picture of the distributions (.png, .pdf, .svg). May be repeated.
    """

    moments: Annotated[Words, WORDS, BODY] = ()
    periods: Annotated[Words, WORDS, ROTATION] = ()
    mode: Annotated[Literal["long-axis", "short-axis"] | None, ROTATION] = None
    pole: Annotated[Words, WORDS, ROTATION] = ()
    pole_sigma: Annotated[str, ROTATION] = "0"
    phase: Annotated[str | None, ROTATION] = None
    azimuth: Annotated[str | None, ROTATION] = None
    eccentricity: Annotated[float, ORBIT] = 1.0
    periapsis: Annotated[str, ORBIT] = "40000 km"
    radius: Annotated[str | None, ORBIT] = None
    mu: Annotated[str, ORBIT] = "3.986004418e14"
    inclination: Annotated[str, ORBIT] = "0"
    node: Annotated[str, ORBIT] = "0"
    argument: Annotated[str, ORBIT] = "0"
    span: Annotated[str, ORBIT] = "6 d"
    n: Annotated[Count, RANDOM] = 1000
    seed: Annotated[Count, RANDOM] = 0
    rtol: Annotated[float, COMPUTATION] = 1e-10
    client: Annotated[str | None, COMPUTATION] = None
    save: Annotated[Paths, REPEATED, RESULTS] = ()


MODES: Final = (
    "state which of the two motions has these periods: --mode long-axis, where omega circles the axis of the "
    "least moment, or --mode short-axis, where it circles that of the greatest"
)


@dataclass(frozen=True, kw_only=True)
class StartOptions:
    """A motion from its start to its end; the commands describe the options in their own words."""

    moments: Annotated[Words, WORDS, BODY] = ()
    omega: Annotated[Words, WORDS, MOTION] = ()
    attitude: Annotated[Words, WORDS, MOTION] = ()
    gravity: Annotated[str | None, MOTION] = None
    wheel: Annotated[Words, REPEATED, MOTION] = ()
    end: Annotated[str | None, MOTION] = None


@dataclass(frozen=True, kw_only=True)
class SpinOptions(StartOptions):
    """How the body spins, and what is saved of it.

    Attributes
    ----------
    moments
        Three principal moments instead of a file, such as "1 3 3.2" or "2 4 5 g cm^2", or with sigmas
        "1.00 ± 0.01, 3.00(2), 3.2". A number without a unit is in kg m^2.
    omega
        Angular velocity at the start, in components along --axes, such as 0 6 0.01 or "10 20 30 deg/s", or
        with sigmas "0, 6.00 ± 0.05, 0.010(2)". A number without a unit is in rad/s.
    periods
        Two periods instead of --omega, as of a tumbling asteroid: of the rotation about the long axis, and of
        the mean precession of this axis, such as "5.41 d, 7.35 d", or with sigmas "263 ± 6 h, 27.38(7) h". A
        number without a unit is in s.
    mode
        Required with --periods: the motion that has them. long-axis: ω circles the axis of the least moment;
        short-axis: ω circles the axis of the greatest moment.
    gravity
        Acceleration along -z, such as 9.81, of a top whose origin is fixed. A number without a unit is in
        m/s^2. The centre of mass and the origin must lie on the symmetry axis.
    wheel
        Wheel that turns in the body: its axis, and its constant angular momentum relative to the body, such
        as "z, 2.5 kg m^2/s" or "0, 0.6, 0.8, 1.2 N m s". x, y and z are the axes of --omega; e1, e2 and e3
        are the principal axes. A number without a unit is in the report's unit of |L|. May be repeated. The
        moments of the body are those with the wheels locked.
    attitude
        Euler angles phi theta psi (ZXZ) at the start, such as "0 30 0 deg". A number without a unit is in
        rad.
    end
        Last time, such as 20 or "30 d". A number without a unit is in s. The first time is 0. Without it, the
        report describes the motion, and nothing is saved.
    degrees
        Print angular velocities in deg/s, and read --omega without a unit in deg/s.
    axes
        Axes of the components: those of the file, or the principal axes (ascending moments).
    times
        Number of times, the first and the last included.
    save
        File for the motion: a picture (.png, .pdf, .svg), an animation (.html, .gif, .mp4) or its numbers
        (.csv, .npz, .json). May be repeated. A mesh of more than 10 000 triangles is drawn coarser. A
        molecule is drawn as balls, an assembly part by part, and bare moments as the box with the same
        inertia.
    """

    periods: Annotated[Words, WORDS, MOTION] = ()
    mode: Annotated[Literal["long-axis", "short-axis"] | None, MOTION] = None
    degrees: Annotated[bool, FLAG, REPORT] = False
    axes: Annotated[Literal["file", "principal"], REPORT] = "file"
    times: Annotated[Count, RESULTS] = 1001
    save: Annotated[Paths, REPEATED, RESULTS] = ()


@dataclass(frozen=True, kw_only=True)
class RollOptions:
    """A body that rolls on a plane.

    Attributes
    ----------
    moments
        Three moments along the axes of the body, with --mass, instead of a file or of a homogeneous body,
        such as "8 8 8 g cm^2". A number without a unit is in kg m^2.
    surface
        Required: what touches the plane. A disk has a sharp edge; of a torus the outer side touches. Without
        a file, --moments and --inertia, a homogeneous ball, ellipsoid, thin disk or ring of this surface
        rolls, whose mass is --mass.
    radius
        Radius of a sphere or a disk, such as "5 cm". A number without a unit is in m, as for all lengths.
    semi_axes
        Semi-axes of an ellipsoid along the axes of the body, such as "20 3 2 cm".
    major_radius
        Radius of the circle that is the middle of the tube of a torus.
    minor_radius
        Radius of this tube.
    radii
        Two radii of curvature at the apex of a paraboloid, along x and y of the body, such as "10 2 cm". Its
        apex is its lowest point.
    apex
        Depth of this apex below the origin of the body, up to which the paraboloid reaches.
    axis
        Axis of a disk or a torus, three numbers along the axes of the body. Default: z.
    middle
        Middle of the surface in the body, such as "0 0 1 cm". Default: the origin of the body.
    omega
        Required: angular velocity at the start, in components along the axes of the body, such as 0 12 7 or
        "0 90 30 deg/s". A number without a unit is in rad/s.
    tilt
        Angle at the start from the normal of the plane to the axis z of the body, which is turned about x,
        such as 52deg. A number without a unit is in rad.
    attitude
        Euler angles phi theta psi (ZXZ) at the start instead of --tilt, such as "0 52 0 deg"; z of space is
        the normal of the plane. A number without a unit is in rad.
    gravity
        Acceleration of free fall. A number without a unit is in m/s^2.
    slope
        Angle by which the plane leans, down along x of space, such as 10deg. A number without a unit is in
        rad.
    turntable
        Rate at which the plane turns about its normal, such as "33.3 rpm". A number without a unit is in
        rad/s.
    friction
        Coefficient of dry friction: the body rolls while that takes no more, and slips else. Default: it
        rolls, whatever friction that takes.
    velocity
        Velocity of the centre of mass at the start along the axes of space, with --friction, such as "8 0 0".
        A number without a unit is in m/s. Default: the body does not slip at the start.
    lift
        What happens where the plane would have to pull: the body leaves it and the run stops, the body flies
        until it lands, or the plane holds it.
    end
        Required: last time, such as 3 or "2 min". A number without a unit is in s. The first time is 0.
    rtol
        Relative tolerance of the integration.
    times
        Number of times in the numbers of --save, the first and the last included.
    save
        File for the motion: a picture (.png, .pdf, .svg), an animation (.html, .gif, .mp4) or its numbers
        (.csv, .npz, .json). May be repeated.
    """

    moments: Annotated[Words, WORDS, BODY] = ()
    surface: Annotated[Literal["sphere", "ellipsoid", "disk", "torus", "paraboloid"] | None, SURFACE] = None
    radius: Annotated[str | None, SURFACE] = None
    semi_axes: Annotated[Words, WORDS, SURFACE] = ()
    major_radius: Annotated[str | None, SURFACE] = None
    minor_radius: Annotated[str | None, SURFACE] = None
    radii: Annotated[Words, WORDS, SURFACE] = ()
    apex: Annotated[str | None, SURFACE] = None
    axis: Annotated[Words, WORDS, SURFACE] = ()
    middle: Annotated[Words, WORDS, SURFACE] = ()
    omega: Annotated[Words, WORDS, MOTION] = ()
    tilt: Annotated[str | None, MOTION] = None
    attitude: Annotated[Words, WORDS, MOTION] = ()
    gravity: Annotated[str, MOTION] = "9.81"
    slope: Annotated[str | None, MOTION] = None
    turntable: Annotated[str | None, MOTION] = None
    friction: Annotated[float | None, MOTION] = None
    velocity: Annotated[Words, WORDS, MOTION] = ()
    lift: Annotated[Literal["stop", "fly", "hold"], MOTION] = "stop"
    end: Annotated[str | None, MOTION] = None
    rtol: Annotated[float, COMPUTATION] = 1e-12
    times: Annotated[Count, RESULTS] = 1001
    save: Annotated[Paths, REPEATED, RESULTS] = ()


@dataclass(frozen=True, kw_only=True)
class EnsembleOptions(StartOptions):
    """One motion, many times.

    Attributes
    ----------
    moments
        Three principal moments instead of a file, such as "1.00 ± 0.01, 3.00(2), 3.2". A number without a
        unit is in kg m^2.
    omega
        Angular velocity at the start, in components along the axes of the body, such as
        "0, 6.00 ± 0.05, 0.01". A number without a unit is in rad/s.
    attitude
        Attitude at the start: "any" draws every attitude with equal probability; or give Euler angles
        phi theta psi (ZXZ), such as "0 deg, 30 deg ± 2 deg, 0 deg" or "0, 0, 0 to 360 deg". A number without
        a unit is in rad. Default: the axes of the body are those of space.
    gravity
        Acceleration along -z, such as 9.81; the origin of the body is fixed. A number without a unit is in
        m/s^2.
    wheel
        Wheel that turns in the body: its axis, and its constant angular momentum relative to the body, such
        as "z, 2.5 kg m^2/s" or "0, 0.6, 0.8, 1.2 N m s". e1, e2 and e3 are the principal axes. May be
        repeated.
    end
        Last time, such as 20 or "30 d". A number without a unit is in s. The first time is 0.
    n
        Number of members.
    seed
        Seed of the random numbers, from 0 to 2^64 - 1; the same seed makes the same members.
    method
        Method of the computation. With --gravity and a body that is drawn at random, it is required: exact if
        all bodies are symmetric tops, else taylor or dop853.
    rtol
        Relative tolerance of the integration.
    save
        File of NumPy (.npz) or zarr group (.zarr) for the states of all members, instead of a report on their
        spread.
    times
        Number of times in --save, the first and the last included. Default: 2.
    resume
        Continue the file of --save that an earlier run has begun.
    checkpoint
        File for partial results, without --save. If it exists, the run continues from it.
    chunk
        Number of members that are run, written or sent to a worker together. Without --save, a multiple of
        4096.
    client
        Address of the scheduler of a dask cluster that runs the members, such as tcp://127.0.0.1:8786.
        Default: the threads of this machine.
    """

    n: Annotated[Count, RANDOM] = 1000
    seed: Annotated[Count, RANDOM] = 0
    method: Annotated[Method, COMPUTATION] = "auto"
    rtol: Annotated[float, COMPUTATION] = 1e-10
    save: Annotated[Path | None, RESULTS] = None
    times: Annotated[Count | None, RESULTS] = None
    resume: Annotated[bool, FLAG, RESULTS] = False
    checkpoint: Annotated[Path | None, RESULTS] = None
    chunk: Annotated[Count, COMPUTATION] = 4096
    client: Annotated[str | None, COMPUTATION] = None
