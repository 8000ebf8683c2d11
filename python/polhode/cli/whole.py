"""Bodies from wherever they come: a file with a shape, or whole without one.

Whole are saved bodies, assemblies, and the numbers that a CAD program printed.
"""

from __future__ import annotations

from dataclasses import fields
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from polhode.cli.components import has_names
from polhode.cli.files import label
from polhode.cli.layout import Column, Field, Report, Table
from polhode.cli.loading import LoadedBody, load_body
from polhode.cli.options import BodyOptions
from polhode.cli.tables import (
    FileUnits,
    body_fields,
    ellipsoid_fields,
    note_linear,
    sigmas_of,
    tensor_fields,
    trust_fields,
)
from polhode.equimomental import ellipsoid
from polhode.errors import PolhodeError
from polhode.io.formats import check_arguments
from polhode.io.images import bodies_of_labels, body_of_image, is_image, read_image, unit_of
from polhode.io.mesh_solid import naming_file
from polhode.io.read import is_whole, read_whole
from polhode.units import amount, has_unit, metres_per, quantities, quantity, split, vector

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from polhode import RigidBody
    from polhode.io.images import Image

__all__ = [
    "any_body",
    "body_sections",
    "check_moments_alone",
    "check_source",
    "check_weight",
    "mass_and_center",
    "source_of",
    "whole_report",
]

_OF_MESHES: Final = (
    "thickness",
    "cut",
    "cut_point",
    "weld",
    "closure",
    "orient",
    "union",
    "repair",
    "index_base",
)
_OF_SHAPES: Final = ("density", "mass", *_OF_MESHES, "bond_sigma", "mass_sigmas")
_OF_PRINTOUTS: Final = ("inertia", "center_of_mass", "products", "inertia_about")
_PLAIN: Final = BodyOptions()


def any_body(file: Path | None, options: BodyOptions, **how: bool) -> LoadedBody:
    """Read the body in a file, or without one that of a CAD program's numbers; `how` is of `load_body`."""
    if file is None or any(_is_given(options, name) for name in _OF_PRINTOUTS):
        return _read_printout(file, options)
    if is_whole(file):
        return _whole_body(file, options)
    if is_image(file):
        return _image_body(file, options)
    return load_body(file, options, **how)


def _whole_body(file: Path, options: BodyOptions) -> LoadedBody:
    """Read a saved body or an assembly."""
    check_arguments(file, **{name: _is_given(options, name) for name in (*_OF_SHAPES, "length_unit")})
    body, kind, has_units, notes, _ = read_whole(file, options.length_unit)
    if body.shape:
        raise PolhodeError(
            f"{file}: it holds a stack of bodies, of shape {body.shape}, not one; save one of them alone"
        )
    mass_unit, length = ("kg", "m") if has_units else ("mass", "unit")
    return LoadedBody(body, [], mass_unit, length, notes=notes, kind=kind)


def _image_body(file: Path, options: BodyOptions) -> LoadedBody:
    """Read an image of voxels."""
    check_arguments(file, **{name: _is_given(options, name) for name in _OF_SHAPES})
    if (options.density is None) == (options.mass is None):
        raise PolhodeError(
            f"--density, --mass: {file} is an image of voxels, which needs one of them: --density 1000 "
            'for a mask, or --density "1=1050, 2=1900" by its values'
        )
    image = read_image(file)
    unit = unit_of(image, file, options.length_unit)
    weight = options.density or options.mass or ""
    names = [item.partition("=")[::2] for item in weight.split(",")] if has_names(options.density) else []
    if unit is None and has_unit(names[0][1] if names else weight):
        raise PolhodeError("--density, --mass: the file states no unit of length; state --length-unit too")
    scale = 1.0 if unit is None else metres_per(unit)
    density: float | dict[float | str, float] | None = None
    if names:
        density = {name.strip(): quantity(text, "kg/m^3", "--density") for name, text in names}
    elif options.density is not None:
        density = quantity(options.density, "kg/m^3", "--density")
    mass = None if options.mass is None else quantity(options.mass, "kg", "--mass")
    with naming_file(file):
        body = body_of_image(image, density, mass, scale)
        parts = _bodies_by_value(image, density, scale) if isinstance(density, dict) else ()
    sides = " x ".join(map(str, image.values.shape))
    notes = [f"{sides} voxels, each a homogeneous cell; its axes are those of the file"]
    if unit is None:
        notes.append("unit unknown: all results are in the file's own unit of length")
    mass_unit, length = ("kg", "m") if unit else ("mass", "unit")
    return LoadedBody(
        body, [], mass_unit, length, notes=(*notes,), kind="image", length_unit=unit, regions=parts
    )


def _bodies_by_value(
    image: Image, density: Mapping[Any, float], scale: float
) -> tuple[tuple[int, RigidBody], ...]:
    """Return the body of the voxels of each value, where the values are labels."""
    if image.values.dtype.kind == "f" and not (image.values == np.round(image.values)).all():
        return ()
    affine = image.affine.copy()
    affine[:3] *= scale
    found, bodies = bodies_of_labels(image.values, density, affine=affine)
    return tuple((int(value), bodies[k]) for k, value in enumerate(found))


def _regions(loaded: LoadedBody) -> Table:
    """List the voxels of each value."""
    moments = loaded.moment_unit
    columns = (
        Column("value", "value"),
        Column("mass", "mass", loaded.mass_unit),
        Column("center_of_mass", "centre of mass", loaded.length),
        Column("principal_moments", "principal moments", moments),
        Column("semi_axes", "semi-axes of the ellipsoid", loaded.length),
    )
    rows = [
        {
            "value": value,
            "mass": body.mass,
            "center_of_mass": body.center_of_mass,
            "principal_moments": body.principal_moments,
            "semi_axes": ellipsoid(body).semi_axes,
        }
        for value, body in loaded.regions
    ]
    return Table("regions", columns, rows)


def _read_printout(file: Path | None, options: BodyOptions) -> LoadedBody:
    """Make the body of --mass, --center-of-mass and --inertia."""
    from polhode.interop.printouts import from_printout

    if file is not None:
        name = next(name for name in _OF_PRINTOUTS if _is_given(options, name)).replace("_", "-")
        raise PolhodeError(f"--{name}: {label(file)} defines the body already; leave it out, or the file")
    for name in ("length_unit", *(name for name in _OF_SHAPES if name != "mass")):
        if _is_given(options, name):
            raise PolhodeError(
                f"--{name.replace('_', '-')}: --inertia has its own units and no shape; leave it out"
            )
    if not options.inertia or options.mass is None:
        raise PolhodeError(
            'give a file, or what a CAD program printed: --mass "2 lbm" --center-of-mass "0 0 1 in" '
            '--inertia "3 4 5 0.1 0 0 lbm in^2" --products positive'
        )
    count = len(split(options.inertia, None, "kg m^2", "--inertia"))
    if count not in (3, 6, 9):
        raise PolhodeError(
            f"--inertia: expected 3, 6 or 9 numbers, got {count}: the moments, Ixx Iyy Izz Ixy Ixz Iyz, or "
            "the rows of the tensor"
        )
    body = from_printout(
        amount(options.mass, "kg", "--mass"),
        vector(options.center_of_mass, "m", "--center-of-mass")
        if options.center_of_mass
        else (0.0, 0.0, 0.0),
        quantities(options.inertia, count, "kg m^2", "--inertia"),
        products=options.products,
        about=options.inertia_about,
        name="--inertia",
    )
    texts = (
        ("--mass", (options.mass,), "kg"),
        ("--center-of-mass", options.center_of_mass, "m"),
        ("--inertia", options.inertia, "kg m^2"),
    )
    notes = [
        f"{option} has no unit: {unit} was taken"
        for option, words, unit in texts
        if words and not any(has_unit(part) for part in split(words, None, unit, option))
    ]
    if not options.center_of_mass:
        notes.append("no --center-of-mass was given: the centre of mass was taken at the origin")
    return LoadedBody(body, [], "kg", "m", notes=tuple(notes), kind="printout")


def whole_report(
    file: Path | None, loaded: LoadedBody, mass_unit: str | None, about: tuple[float, float, float] | None
) -> Report:
    """Report on such a body."""
    report = Report()
    report.section(
        "",
        Field("file", "file", "(inertia)" if file is None else label(file)),
        Field("format", "format", loaded.kind),
        Field(
            "length_unit",
            "length unit",
            "unit unknown" if loaded.length != "m" else loaded.length_unit or "m",
        ),
    )
    if loaded.regions:
        report.section("voxels of each value", _regions(loaded))
    body_sections(report, loaded, FileUnits("m", mass_unit), about)
    return report


def body_sections(
    report: Report, loaded: LoadedBody, units: FileUnits, about: tuple[float, float, float] | None
) -> None:
    """Add what is told of every body: mass, tensors, principal axes, and where the numbers come from."""
    body = loaded.body
    report.section(
        "mass",
        *units.fields("mass", "mass", body.mass, loaded.mass_unit, mass=1, **sigmas_of(body, "mass")),
        *units.fields(
            "center_of_mass",
            "centre of mass",
            body.center_of_mass,
            loaded.length,
            length=1,
            scale=loaded.extent,
            **sigmas_of(body, "center_of_mass"),
        ),
    )
    report.section("inertia, its axes", *tensor_fields(loaded, units, about))
    report.section("principal axes", *body_fields(loaded, units))
    report.section("equivalent ellipsoid, along e1 e2 e3", *ellipsoid_fields(loaded, units))
    report.section("trust", *trust_fields(loaded))
    report.notes += loaded.notes
    if loaded.length == "unit":
        report.notes.append("unit unknown: all results are in the file's own units")
    note_linear(report)


def check_source(command: str, file: Path | None, moments: object, options: BodyOptions) -> None:
    """Refuse a command without a body, or with two."""
    if file is None and not (moments or options.inertia):
        raise PolhodeError(
            f"{command}: give a file, or principal moments with --moments, or a tensor with --inertia"
        )
    if moments and options.inertia:
        raise PolhodeError("--moments and --inertia: both say what the body is; give one of the two")
    if file is not None and moments:
        raise PolhodeError(f"--moments: the body is that of {label(file)}; give one of the two")


def source_of(file: Path | None, moments: object) -> str:
    """Say where a body comes from, for a report."""
    return label(file) if file is not None else "(moments)" if moments else "(inertia)"


def check_moments_alone(options: BodyOptions, *taken: str) -> None:
    """Refuse options of a file beside --moments, but those that are `taken`."""
    for field in fields(options):
        if field.name not in taken and _is_given(options, field.name):
            option = f"--{field.name.replace('_', '-')}"
            about = "a molecule" if field.name in ("bond_sigma", "mass_sigmas") else "a file"
            raise PolhodeError(
                f"{option}: it is about {about}, and --moments need none; leave it out, or give a file"
            )


def check_weight(gravity: str | None, options: BodyOptions) -> None:
    """Refuse --gravity where the body of --moments has no mass or no centre of mass."""
    if gravity is not None and (options.mass is None or not options.center_of_mass):
        raise PolhodeError(
            "--gravity: the weight acts at the centre of mass; state --mass and --center-of-mass too"
        )


def mass_and_center(options: BodyOptions) -> tuple[Any, Any]:
    """Read the mass and the centre of mass of the body of --moments; 1 kg and the origin without them."""
    mass = 1.0 if options.mass is None else amount(options.mass, "kg", "--mass")
    center = options.center_of_mass
    return mass, vector(center, "m", "--center-of-mass") if center else (0.0, 0.0, 0.0)


def _is_given(options: BodyOptions, name: str) -> bool:
    """Return whether an option differs from what holds without it."""
    return bool(getattr(options, name) != getattr(_PLAIN, name))
