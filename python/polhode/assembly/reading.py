"""Read the file of an assembly into a tree of placed bodies. A nested file is read once."""

from __future__ import annotations

import os
import re
import tomllib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from polhode.assembly.matter import body_of_part, kind_of
from polhode.assembly.overlaps import Form, Instance, find_overlaps, overlap_notes
from polhode.assembly.result import Assembly, Member
from polhode.assembly.tables import COMMON, HERE, TOP, Place, Scope, check_keys, copies, place_of, text_of
from polhode.errors import FileFormatError, PolhodeError
from polhode.io.budget import Budget, read_text, status_of, words_of
from polhode.uncertainty.ledgers import ledger_of_bodies

if TYPE_CHECKING:
    from polhode._core import RigidBody

__all__ = ["read"]

MOST_MEMBERS: Final = 100_000
"""Parts and groups of an assembly, copies counted."""
_MOST_TEXT: Final = 1 << 26
_MOST_NAMES: Final = 50
_PIECES: Final = re.compile(r"[=,\[\]{}\n]")
_DOTTED: Final = re.compile(r"[\w\"'-]\s*\.\s*[\w\"'-]")


@dataclass(frozen=True, eq=False)
class _Unit:
    """A part in its own axes, or an assembly with its parts in them."""

    name: str
    comment: str = ""
    body: RigidBody | None = None
    file: Path | None = None
    metres: float = 1.0
    shape: str = ""
    arguments: dict[str, Any] = field(default_factory=dict)
    form: Form | None = None
    children: tuple[tuple[Place, _Unit], ...] = ()
    members: int = 1
    notes: tuple[str, ...] = ()


def read(
    assembly: str | os.PathLike[str] | Mapping[str, Any], *, folder: str | os.PathLike[str] = "."
) -> Assembly:
    """Read an assembly: its parts, their positions and their sum.

    Parameters
    ----------
    assembly : path or mapping
        A TOML file, or what such a file holds: ``name``, ``length_unit`` and a list ``part`` of mappings.
    folder : path, optional
        Folder for the names of files in a mapping. Names in a file are relative to the folder of that file.

    Returns
    -------
    Assembly

    Raises
    ------
    PolhodeError
        If a key is not known, a part has none or several of the keys below, or an assembly is part of itself.
        The message names the file, the part and the key.
    OSError
        If a file cannot be read.

    Notes
    -----
    Each part has a ``name`` and is one of

    - ``solid``: a shape of :mod:`polhode.solids`, :mod:`polhode.laminae` or :mod:`polhode.rods`, with its
      arguments as keys, and ``mass`` or ``density``; ``"balls"`` is the union of overlapping balls, with
      ``centers`` and ``radii``;
    - ``file``: a mesh, with ``mass`` or ``density`` (also ``weld``, ``closure``, ``orient``, ``union``,
      ``repair``, ``index_base``), a molecule, a body that was saved, or a report of one (JSON);
    - ``assembly``: another such file;
    - ``inertia``: a table with ``mass``, ``com`` and ``tensor`` as a CAD program prints them, ``products``
      (``"positive"`` or ``"negative"``), ``about``, and ``rtol`` for a table of few digits.

    A part is at ``position``, turned by ``rotation``: a table with ``axis`` and ``degrees`` (or ``radians``);
    ``sequence`` with three angles under the key ``degrees`` or ``radians``; ``quaternion_xyzw``; or
    ``matrix``: ``r = R r_part + position``. ``mirror`` is the normal of a plane through the origin of the
    part: the part is replaced by its mirror image, before it is turned and placed. ``count`` is the number of
    copies; each copy is moved from the one before by ``turn`` and ``step``.

    Numbers without a unit are lengths in ``length_unit`` of the part or of the file, else in metres; masses
    in kg; densities in kg/m^3. A text may have its own unit: ``"2.7 g/cm^3"``, ``"5.0 ± 0.1 lbm"``, ``"10 20
    30 mm"``.

    Examples
    --------
    >>> from polhode import assembly
    >>> leg = {"name": "leg", "solid": "rod", "length": 0.44, "mass": 0.4, "position": [0.12, 0, 0.22]}
    >>> leg |= {"count": 3, "turn": {"axis": [0, 0, 1], "degrees": 120}}
    >>> seat = {"name": "seat", "solid": "disk", "radius": 0.16, "mass": 1.3, "position": [0, 0, 0.45]}
    >>> stool = assembly.read({"name": "stool", "part": [seat, leg]})
    >>> stool
    <Assembly 'stool': 4 parts, mass 2.5>
    >>> stool["leg/2"].body.center_of_mass.round(4)
    array([-0.06  ,  0.1039,  0.22  ])
    """
    if isinstance(assembly, Mapping):
        whole = _tree(dict(assembly), Path(folder), Scope(""), {}, (), Budget("assembly", 0))
    else:
        whole = _file(Path(assembly), {}, (), Budget(str(assembly), 0))
    return _assemble(whole)


def _file(path: Path, known: dict[Path, _Unit], inside: tuple[Path, ...], budget: Budget) -> _Unit:
    """Read a file once; `inside` are the files that are being read, the outermost first."""
    status_of(path)
    real = Path(os.path.realpath(path))
    if real in inside:
        circle = " holds ".join(file.name for file in (*inside[inside.index(real) :], real))
        raise PolhodeError(f"{path}: an assembly cannot be part of itself: {circle}; take one out")
    if real not in known:
        text = read_text(path, "an assembly in TOML", _MOST_TEXT)
        budget.add_file(len(text))
        _check_toml(text, path)
        try:
            table = tomllib.loads(text)
        except (ValueError, RecursionError) as error:  # of TOML, or of a number of very many digits
            raise FileFormatError(f"{path}: not TOML: {error}; correct the line") from None
        known[real] = _tree(table, path.parent, Scope(str(path)), known, (*inside, real), budget)
    return known[real]


def _check_toml(text: str, path: Path) -> None:
    """Refuse keys of many names, for which Python's reader takes a time that grows with their square."""
    for piece in _PIECES.split(text):
        if piece.count(".") > _MOST_NAMES and len(_DOTTED.findall(piece)) > _MOST_NAMES:
            raise FileFormatError(
                f"{path}: a key has more than {_MOST_NAMES} names with dots between them; write tables"
            )


def _tree(
    table: dict[str, Any],
    folder: Path,
    scope: Scope,
    known: dict[Path, _Unit],
    inside: tuple[Path, ...],
    budget: Budget,
) -> _Unit:
    where = scope.where or "assembly"
    check_keys(table, TOP, where)
    name = text_of(table, "name", where) or (inside[-1].stem if inside else "assembly")
    _check_name(name, where)
    scope = Scope("").within(where, table.get("length_unit"))
    rows = table.get("part", [])
    if not isinstance(rows, list) or not all(isinstance(row, dict) for row in rows):
        raise PolhodeError(f"{where}: part: write each part under a line [[part]]")
    if not rows:
        raise PolhodeError(f"{where}: it has no parts; write each under a line [[part]]")
    children: list[tuple[Place, _Unit]] = []
    seen: set[str] = set()
    members = 1
    notes: list[str] = []
    for number, row in enumerate(rows, start=1):
        own = text_of(row, "name", f"{where}: part {number}")
        if not own:
            raise PolhodeError(f"{where}: part {number}: it has no name; state name")
        at = f"part {own!r}"
        _check_name(own, f"{where}: {at}")
        if own in seen:
            raise PolhodeError(f"{where}: {at}: the name is there twice; give each part its own")
        seen.add(own)
        child = _part(own, row, folder, scope.within(at, row.get("length_unit")), known, inside, budget)
        members += child[1].members
        notes += child[1].notes
        if members > MOST_MEMBERS:
            raise PolhodeError(f"{where}: more than {MOST_MEMBERS} parts, copies counted; lower count")
        children.append(child)
    return _Unit(
        name, text_of(table, "comment", where), children=tuple(children), members=members, notes=(*notes,)
    )


def _part(
    name: str,
    row: dict[str, Any],
    folder: Path,
    scope: Scope,
    known: dict[Path, _Unit],
    inside: tuple[Path, ...],
    budget: Budget,
) -> tuple[Place, _Unit]:
    """Read a part: one, or a group of its copies."""
    kind = kind_of(row, scope.where)
    comment = text_of(row, "comment", scope.where)
    file = folder / text_of(row, "file", scope.where) if kind == "file" else None
    if kind == "assembly":
        surplus = [key for key in row if key not in COMMON]
        if surplus and surplus[0] in ("mass", "density"):
            raise PolhodeError(
                f"{scope.where}: {surplus[0]}: an assembly has that of its parts; state it there"
            )
        check_keys(row, COMMON, scope.where)
        try:
            inner = _file(folder / text_of(row, "assembly", scope.where), known, inside, budget)
        except OSError as error:
            raise PolhodeError(f"{scope.where}: {words_of(error)}") from error
        one = _Unit(
            name, comment or inner.comment, children=inner.children, members=inner.members, notes=inner.notes
        )
    else:
        if file is not None:
            _count_reading(file, scope.where, budget)
        body, metres, arguments, told, mesh = body_of_part(kind, row, scope, folder)
        shape = text_of(row, "solid", scope.where)
        form = Form(shape, arguments, mesh) if shape or mesh is not None else None
        mended = row.get("repair") is True and "repaired" in body.provenance.checked
        notes = (*told, *((f"{scope.where}: its mesh was repaired; polhode report lists how",) * mended))
        one = _Unit(name, comment, body, file, metres, shape, arguments, form, notes=notes)
    place, moves = place_of(row, scope), copies(row, scope)
    if len(moves) == 1:
        return place, one
    members = one.members * len(moves) + 1
    if members > MOST_MEMBERS:
        raise PolhodeError(f"{scope.where}: more than {MOST_MEMBERS} parts, copies counted; lower count")
    group = tuple(
        (move.of(place), replace(one, name=f"{k}", notes=())) for k, move in enumerate(moves, start=1)
    )
    return HERE, _Unit(name, comment, children=group, members=members, notes=one.notes)


def _count_reading(file: Path, where: str, budget: Budget) -> None:
    """Count the reading of a part's file, which many parts may name."""
    if file.is_file():  # else its reader says what is wrong
        size = file.stat().st_size
        budget.add_file(size, os.path.realpath(file))
        budget.spend("readings of files", 1, where)
        budget.spend("bytes read", size, where)


def _check_name(name: str, where: str) -> None:
    if "/" in name or name != name.strip():
        raise PolhodeError(
            f"{where}: the name {name!r} has a / or a blank at its end, which separate names; leave it out"
        )


def _assemble(whole: _Unit) -> Assembly:
    """Place every part in the axes of the whole, and roll them up."""
    ids, parents, comments = [], [], []
    bodies: list[RigidBody | None] = []
    members: dict[str, Member] = {}
    placed: list[Instance] = []
    for name, parent, place, unit in _walk(whole):
        ids.append(name)
        parents.append(parent)
        comments.append(unit.comment)
        body = None if unit.body is None else place.place(unit.body)
        bodies.append(body)
        if body is not None:
            members[name] = Member(name, body, unit.shape, unit.arguments, unit.file, unit.metres, *place)
            placed.append(Instance(name, body, place, unit.form))
    found, unseen = find_overlaps(placed)
    return Assembly(
        name=whole.name,
        parts=tuple(members.values()),
        ledger=ledger_of_bodies(ids, parents, bodies, comments),
        notes=(*whole.notes, *overlap_notes(found), *unseen),
        overlaps=tuple(found),
    )


def _walk(whole: _Unit) -> Iterator[tuple[str, str, Place, _Unit]]:
    """Return every part and group with its full name and that of what it is in, the outer ones first."""
    root, names = whole.name, {inner.name for _, inner in whole.children}
    while root in names:  # a part may have the name of the whole, but not its place in the tree
        root = f"{root} (whole)"
    waiting = [(root, "", HERE, whole)]
    while waiting:
        name, parent, place, unit = waiting.pop()
        yield name, parent, place, unit
        prefix = f"{name}/" if parent else ""
        waiting += [
            (f"{prefix}{inner.name}", name, place.of(at), inner) for at, inner in reversed(unit.children)
        ]
