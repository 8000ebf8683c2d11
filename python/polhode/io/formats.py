"""The reader of each format: it opens a file and returns a mesh, solids of CAD, a molecule or a saved body.

Nothing is repaired and nothing is guessed: a file is what its name says and whole, or it is an error.
The one exception is exact: corners at bit-equal coordinates are one vertex, because STL stores each
triangle's corners anew.
"""

from __future__ import annotations

import os
import warnings
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, BinaryIO, Final, Literal, NamedTuple

import numpy as np

from polhode import _core
from polhode._format import Argument
from polhode.errors import FileFormatError, PolhodeError
from polhode.io.budget import Budget, check_ordinary, naming, status_of, whole_of
from polhode.io.content import EXPECTED_CONTENT, MOLECULE_SUFFIXES, Content, is_molecule, open_file, unread
from polhode.io.images import is_image
from polhode.io.mesh import Mesh, check_faces, weld, weld_within
from polhode.io.mesh_solid import MeshSolid, naming_file, solid_of
from polhode.io.plates import read_numbered_plates
from polhode.io.saved import read_body, read_report
from polhode.io.unpacked import inner_suffix, unpack
from polhode.units import METRES, metres_per

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from polhode._core import RigidBody
    from polhode._typing import SupportsSigma
    from polhode.io.cad_files import CadFile
    from polhode.io.molecules import Molecule
    from polhode.molecules import Isotope
    from polhode.molecules.nuclides import Masses

    Number = float | _core.Uncertain | SupportsSigma

__all__ = [
    "ASSEMBLY_SUFFIX",
    "CAD_SUFFIXES",
    "SAVED_SUFFIXES",
    "FileContent",
    "Whole",
    "body_of_molecule",
    "check_arguments",
    "load",
    "molecule_isotopes",
    "read_mesh",
    "read_saved",
    "solid_from_file",
    "warn",
]

SAVED_SUFFIXES: Final = (".json", ".npz")
"""Of bodies that ``RigidBody.save`` wrote, and of reports."""
ASSEMBLY_SUFFIX: Final = ".toml"
_OF_MESHES: Final = (
    "density",
    "mass",
    "thickness",
    "cut",
    "weld",
    "closure",
    "orient",
    "union",
    "repair",
    "index_base",
)
_OF_MOLECULES: Final = ("masses", "bond_sigma", "mass_sigmas")
CAD_SUFFIXES: Final = (".step", ".stp", ".igs", ".iges")
_METRE: Final = ("m", "metre", "meter")
_OF_EXTRAS: Final = (*CAD_SUFFIXES, ".vtk", ".vtu", ".vtp")
_MESH_SUFFIXES: Final = tuple(
    suffix for suffix in EXPECTED_CONTENT if suffix not in (*MOLECULE_SUFFIXES, *_OF_EXTRAS)
)
_TEXT_SUFFIXES: Final = tuple(suffix for suffix, known in EXPECTED_CONTENT.items() if "v/f text" in known)


@dataclass(eq=False, repr=False)
class FileContent:
    """What a file holds.

    Triangles of binary STL, binary PLY and v/f text are read when `mesh` is first asked for. All other files
    are read at once.

    Attributes
    ----------
    path : pathlib.Path
        Path of the file.
    format : str
        ``"binary STL"``, ``"ASCII STL"``, ``"v/f text"`` (OBJ and plate files), ``"numbered plates"``,
        ``"PLY"``, ``"OFF"``, ``"GLB"``, ``"glTF"``, ``"COLLADA"``, ``"3MF"``, ``"VTK"``; of solids ``"STEP"``
        or ``"IGES"``; of a molecule ``"XYZ"``, ``"PDB"`` or ``"MOL"``.
    is_stream : bool
        Whether the triangles can be read one after the other, without having all of them in memory.
    index_base : {1, 0}
        Number of the first vertex in v/f text.
    unit : str or None
        Unit of the coordinates, one of those in :data:`polhode.units.METRES`; None if neither the file nor
        its format states one.
    states_unit : bool
        Whether the file itself states the unit. Another unit is then an error.
    notes : tuple of str
        What was done to read the file, and which parts of it were not read.
    cad : CadFile or None
        The solids of a STEP or IGES file.
    groups : tuple of (str, int)
        The name of each part of a mesh and the number of its triangles, in the order of the faces; empty
        where the format has no names, and for v/f text, whose names are read when they are asked for.
    materials : tuple of (str, int)
        The same of the materials of a 3MF file.
    """

    path: Path
    format: str
    is_stream: bool = False
    index_base: int = 1
    unit: str | None = None
    states_unit: bool = False
    notes: tuple[str, ...] = ()
    cad: CadFile | None = None
    groups: tuple[tuple[str, int], ...] = ()
    materials: tuple[tuple[str, int], ...] = ()
    _molecule: Molecule | None = None
    _mesh: Mesh | None = None

    def __repr__(self) -> str:
        return f"<FileContent {self.format} from {self.path}>"

    @property
    def mesh(self) -> Mesh:
        """The triangles."""
        if self._molecule is not None:
            raise FileFormatError(self.path, f": {self.format} holds atoms, not a mesh; ask for its molecule")
        if self.cad is not None:
            raise FileFormatError(
                self.path,
                f": {self.format} holds solids with curved faces, not triangles; polhode report "
                "tells their mass properties; export a mesh from CAD where one is needed",
            )
        if self._mesh is None:
            self._mesh = self._read_mesh()
        return self._mesh

    @property
    def molecule(self) -> Molecule:
        """The atoms."""
        if self._molecule is None:
            held = "solids" if self.cad is not None else "a mesh"
            raise FileFormatError(self.path, f": {self.format} holds {held}, not atoms; ask for its mesh")
        return self._molecule

    def length(self, length_unit: str | None) -> str | None:
        """Return the unit of the coordinates: that of the file, or the one that the caller states.

        Parameters
        ----------
        length_unit : str or None
            What is stated.

        Raises
        ------
        PolhodeError
            Where that contradicts the file.
        """
        if length_unit is None or self.unit is None:
            return self.unit if length_unit is None else length_unit
        metres_per(length_unit)
        if self.states_unit and length_unit != self.unit:
            raise PolhodeError(
                Argument("length_unit"),
                f": {self.path} says itself that its unit is {self.unit!r}, not {length_unit!r}; leave ",
                Argument("length_unit"),
                " out, or export the file in the right unit",
            )
        return length_unit

    def _read_mesh(self) -> Mesh:
        if self.format == "binary STL":
            return Mesh(*_core.read_stl(str(self.path)), self.format)
        if self.format == "PLY":
            with naming(self.path), self.path.open("rb") as stream:
                return _by_trimesh(stream, self.path, _budget(self.path))
        mesh = Mesh(*_core.read_plates(str(self.path), self.index_base), self.format)
        check_faces(mesh, str(self.path))
        return mesh


def load(path: str | os.PathLike[str], *, index_base: int = 1) -> FileContent:
    r"""Open a file that holds a mesh, a molecule or solids of CAD.

    The suffix of its name says which formats the file may have, and its content which of these it has: for
    example text or binary STL. Content of any other format is an error.

    Parameters
    ----------
    path : str or os.PathLike
        The suffix is one of

        - of a mesh: ``.stl``, ``.obj``, ``.tab``, ``.txt``, ``.ply``, ``.off``, ``.glb``, ``.gltf``,
          ``.dae``, ``.3mf``, ``.vtk``, ``.vtu``, ``.vtp``; see :func:`read_mesh`;
        - of a molecule: ``.xyz``, ``.extxyz``, ``.pdb``, ``.ent``, ``.mol``, ``.sdf``;
        - of solids of CAD: ``.step``, ``.stp``, ``.igs``, ``.iges`` (extra ``cad``).

        Each may be packed with gzip, with ``.gz`` after its own suffix.
    index_base : {1, 0}
        Number of the first vertex in v/f text: 1 in OBJ and in most plate files, 0 in some.

    Returns
    -------
    FileContent

    Raises
    ------
    FileFormatError
        If the file is empty, cut short or damaged, or if its content does not fit its suffix.
    OSError
        If the file cannot be read.

    Examples
    --------
    >>> import tempfile
    >>> from pathlib import Path
    >>> from polhode.io import load
    >>> corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder, "corner.obj")
    ...     _ = path.write_text(corners + "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n")
    ...     loaded = load(path)
    ...     loaded.format, loaded.mesh.faces.shape
    ('v/f text', (4, 3))
    """
    file = Path(path)
    suffix = inner_suffix(file)
    if index_base not in (0, 1):
        raise PolhodeError(Argument("index_base"), f": expected 0 or 1, got {index_base!r}")
    if index_base != 1 and suffix not in _TEXT_SUFFIXES:
        base = Argument("index_base")
        raise PolhodeError(base, f": {file} is not v/f text (.obj, .tab, .txt); leave ", base, " out")
    if suffix in CAD_SUFFIXES:
        from polhode.io.cad_geometry import check_occt

        check_occt(f"{file}: reading CAD files (STEP, IGES)")  # told of any such name
    if file.suffix.lower() == ".gz" and suffix not in EXPECTED_CONTENT:
        check_ordinary(file)
        raise unread(file, suffix, _MESH_SUFFIXES)
    budget = _budget(file)
    with unpack(file, budget) as inside:
        packed = None if inside is file else status_of(file).st_size
        loaded = _load(inside, suffix, index_base, budget, packed)
        if inside is file:
            return loaded
        held = None if loaded.cad is not None or loaded._molecule is not None else loaded.mesh
    note = f"unpacked with gunzip from {file.name}"
    return replace(loaded, path=file, is_stream=False, notes=(*loaded.notes, note), _mesh=held)


def _budget(file: Path) -> Budget:
    """Return the budget of a file, by its size as it lies on the disk."""
    with naming(file):
        return Budget(str(file), status_of(file).st_size)


def _load(file: Path, suffix: str, index_base: int, budget: Budget, packed: int | None) -> FileContent:
    """Open and read a file that is not packed; `packed` is the size of the one that it was unpacked from."""
    with open_file(file) as content:
        stream = content.stream
        if suffix in MOLECULE_SUFFIXES:
            return _load_molecule(content, file, suffix, budget)
        if suffix in CAD_SUFFIXES:
            return _load_cad(file, packed)
        if content.format == "ASCII STL":
            from polhode.io.stl import read_ascii_stl

            corners, groups = read_ascii_stl(stream, file)
            faces = np.arange(corners.size // 3).reshape(-1, 3)
            mesh = weld(corners.reshape(-1, 3), faces, "ASCII STL")
            return FileContent(file, "ASCII STL", groups=groups, _mesh=mesh)
        if suffix == ".stl":
            # Whatever is neither text nor another known format is the compiled reader's to read or refuse.
            return FileContent(file, "binary STL", is_stream=True)
        if content.format == "numbered plates":
            mesh = read_numbered_plates(stream, file)
            check_faces(mesh, str(file))
            return FileContent(file, mesh.format, _mesh=mesh)
        if suffix in _TEXT_SUFFIXES:
            return FileContent(file, "v/f text", index_base=index_base)
        if suffix == ".dae":
            return _load_collada(stream, file, budget)
        if suffix == ".3mf":
            from polhode.io.three_mf import read_three_mf

            package = read_three_mf(stream, file, budget)
            return FileContent(
                file,
                "3MF",
                unit=package.unit,
                states_unit=package.states_unit,
                notes=package.notes,
                groups=package.groups,
                materials=package.materials,
                _mesh=package.mesh,
            )
        if suffix in (".vtk", ".vtu", ".vtp"):
            from polhode.io.vtk import read_vtk

            return FileContent(file, "VTK", _mesh=read_vtk(file, budget))
        if suffix in (".glb", ".gltf"):
            from polhode.io.gltf import read_gltf

            mesh, groups = read_gltf(stream, file, budget, is_binary=suffix == ".glb")
            return FileContent(file, mesh.format, unit="m", groups=groups, _mesh=mesh)
        if _is_binary_ply(content, suffix):
            return FileContent(file, "PLY", is_stream=True)
        mesh = _by_trimesh(stream, file, budget)
    return FileContent(file, mesh.format, _mesh=mesh)


def _load_molecule(content: Content, file: Path, suffix: str, budget: Budget) -> FileContent:
    from polhode.io import molecules

    for _ in content.stream:  # each line may be an atom, which takes far more memory
        budget.spend("atoms")
    content.stream.seek(0)
    if suffix in (".pdb", ".ent"):
        return FileContent(file, "PDB", _molecule=molecules.read_pdb(content.stream, file))
    if suffix in (".mol", ".sdf"):
        return FileContent(file, "MOL", _molecule=molecules.read_mol(content.stream, file))
    return FileContent(file, "XYZ", _molecule=molecules.molecule_of(content.stream, file))


def _load_cad(file: Path, packed: int | None) -> FileContent:
    from polhode.io.cad_process import read_cad_apart

    cad = read_cad_apart(file, packed)
    notes = []
    if cad.left_out:
        notes.append(f"{cad.left_out} faces of the file bound no solid and count nothing")
    if len(cad.names_of_units) > 1 or (cad.unit == "m" and cad.names_of_units[0] not in _METRE):
        names = ", ".join(cad.names_of_units)
        notes.append(
            f"the file's lengths are in: {names}; each was read in its own unit, and all are told in m"
        )
    if cad.unread_densities:
        notes.append("the densities of its materials have units that are not understood and are not used")
    notes += cad.overlaps
    return FileContent(file, cad.format, unit=cad.unit, states_unit=True, notes=tuple(notes), cad=cad)


def _load_collada(stream: BinaryIO, file: Path, budget: Budget) -> FileContent:
    from polhode.io.collada import read_collada

    mesh, groups, metres, up = read_collada(whole_of(stream, file), file, budget)
    notes = []
    if up != "Z":
        notes.append(
            f"up is {up} by the file: its axes are told as they are (RViz does so; Gazebo turns them)"
        )
    if metres is None:
        return FileContent(file, "COLLADA", unit="m", notes=tuple(notes), groups=groups, _mesh=mesh)
    unit = next((name for name, known in METRES.items() if abs(metres - known) <= 1e-9 * known), None)
    if unit is not None:
        return FileContent(
            file, "COLLADA", unit=unit, states_unit=True, notes=tuple(notes), groups=groups, _mesh=mesh
        )
    note = f"the file's unit is {metres:.9g} m, which has no name here: lengths are told in m"
    mesh = mesh._replace(vertices=mesh.vertices * metres)
    return FileContent(
        file, "COLLADA", unit="m", states_unit=True, notes=(*notes, note), groups=groups, _mesh=mesh
    )


def _by_trimesh(stream: BinaryIO, path: Path, budget: Budget) -> Mesh:
    # Imported when a file needs it: the formats of our own readers are opened sooner.
    from polhode.io.ply_off import read_by_trimesh

    return read_by_trimesh(stream, path, _MESH_SUFFIXES, budget)


def read_mesh(path: str | os.PathLike[str], *, index_base: int = 1, weld: float = 0.0) -> Mesh:
    """Read a triangle mesh.

    Parameters
    ----------
    path : str or os.PathLike
        A mesh, which may be packed with gzip (``.gz``). STL, ``v``/``f`` text and other plate models
        (``.obj``, ``.tab``, ``.txt``), DAE, 3MF, GLB and glTF are read without any further library. PLY and
        OFF are read by trimesh (extra ``mesh``), and VTK, VTU and VTP by PyVista (extra ``view``). (A body
        from a binary PLY needs no trimesh.) The meshes of a scene are placed by their transforms and joined.
        Coordinates are those in the file; :func:`load` tells the unit, if the file states one.
    index_base : {1, 0}
        Number of the first vertex in v/f text: 1 in OBJ and in most plate files, 0 in some.
    weld : float
        Corners at most this far from each other (in the unit of the file, in every coordinate) are one
        vertex. By default only equal corners are joined; STL needs this. Some exporters write the same corner
        with different last digits in each triangle, so that the mesh is open.

    Returns
    -------
    Mesh

    Raises
    ------
    FileFormatError
        If the file is empty, cut short, damaged or in another format than its suffix says.
    OSError
        If the file cannot be read.
    """
    if is_molecule(Path(path)):
        raise FileFormatError(f"{Path(path)}: holds atoms, not a mesh; read it with load(path).molecule")
    mesh = load(path, index_base=index_base).mesh
    return weld_within(mesh, weld) if weld != 0.0 else mesh


def _is_binary_ply(content: Content, suffix: str) -> bool:
    return suffix == ".ply" and content.format == "PLY" and b"\nformat binary" in content.head


class Whole(NamedTuple):
    """A body that a file holds whole.

    Attributes
    ----------
    body : RigidBody
        One, or a stack that was saved.
    kind : str
        ``"saved body"``, ``"report"`` or ``"assembly"``.
    has_units : bool
        Whether it is in kg and m; a saved body is in units that its file does not state.
    notes : tuple of str
        What is to be told of the parts of an assembly.
    overlaps : tuple of str
        Those of them that tell of parts that share matter.
    """

    body: RigidBody
    kind: str
    has_units: bool
    notes: tuple[str, ...] = ()
    overlaps: tuple[str, ...] = ()


def read_saved(path: str | os.PathLike[str], length_unit: str | None = None) -> Whole:
    """Read a saved body or a report of one.

    Parameters
    ----------
    path : str or os.PathLike
    length_unit : str, optional
        Unit of length of a saved body, which is then converted to metres.
    """
    file = Path(path)
    body = read_report(file)
    if body is not None:
        if length_unit is not None:
            raise PolhodeError(Argument("length_unit"), f": {file} is a report, in kg and m; leave it out")
        return Whole(body, "report", True)
    body = read_body(file)
    if length_unit is None:
        return Whole(body, "saved body", False)
    return Whole(body.scaled(length=metres_per(length_unit)), "saved body", True)


def check_arguments(path: str | os.PathLike[str], **given: bool) -> None:
    """Refuse arguments that a file of this kind, by its name, cannot use.

    Parameters
    ----------
    path : str or os.PathLike
    **given : bool
        For each argument, whether it is given.
    """
    file = Path(path)
    suffix = file.suffix.lower()
    unused: tuple[str, ...] = (*_OF_MESHES, *_OF_MOLECULES)
    if suffix == ASSEMBLY_SUFFIX:
        what, unused = "an assembly, whose parts state theirs", (*unused, "length_unit")
    elif suffix in SAVED_SUFFIXES:
        what = "a saved body, whole as it is"
    elif is_molecule(file):
        what, unused = "a molecule, not a mesh", _OF_MESHES
    elif is_image(file):
        what = "an image of voxels, not a mesh"
        unused = (*(name for name in _OF_MESHES if name not in ("density", "mass")), *_OF_MOLECULES)
    else:
        what, unused = "a mesh, not a molecule", _OF_MOLECULES
    name = next((name for name, is_given in given.items() if is_given and name in unused), None)
    if name is None:
        return
    if unused == _OF_MESHES and name in ("density", "mass"):
        what = "a molecule, whose atoms have their own masses"
    raise PolhodeError(Argument(name), f": {os.fspath(path)} is {what}; leave it out")


def warn(path: str | os.PathLike[str], lines: Iterable[str]) -> None:
    """Warn a caller who sees no notes."""
    for line in lines:
        warnings.warn(f"{os.fspath(path)}: {line}", stacklevel=4)


def body_of_molecule(
    path: str | os.PathLike[str], length_unit: str | None = None, masses: Masses = "most_common"
) -> tuple[RigidBody, tuple[str, ...], list[str]]:
    """Read the body of a molecule, with the notes of its file and words for what crosses its cell.

    Parameters
    ----------
    path : str or os.PathLike
    length_unit : str, optional
        As in :func:`body_from_file`.
    masses : {"most_common", "average"}
    """
    from polhode.molecules import ATOMIC_MASS_CONSTANT, body_of_atoms
    from polhode.molecules.bonding import crossings_of

    molecule = load(path).molecule
    atoms = molecule_isotopes(path, molecule, masses)
    metres, one = (1.0, 1.0) if length_unit is None else (metres_per(length_unit), ATOMIC_MASS_CONSTANT)
    found = [isotope.mass * one for isotope in atoms]
    with naming_file(path), np.errstate(over="ignore"):
        at = molecule.scaled(metres)
        body = body_of_atoms(found, at.positions, source=masses, rounding=at.rounding)
    crossed: list[str] = []
    if at.cell is not None:
        in_angstrom = 1.0 if length_unit is None else 1.0 / METRES["angstrom"]
        _, crossed = crossings_of(atoms, at.positions * in_angstrom, at.cell * in_angstrom)
    return body, molecule.notes, crossed


def molecule_isotopes(
    path: str | os.PathLike[str], molecule: Molecule, masses: Masses = "most_common"
) -> list[Isotope]:
    """Find the nuclides of a molecule's atoms; an error names the file.

    Parameters
    ----------
    path : str or os.PathLike
        Where the molecule comes from.
    molecule : Molecule
        What was read.
    masses : {"most_common", "average"}
        See :func:`polhode.molecules.isotopes`.

    Returns
    -------
    list of Isotope
        In the order of the atoms.
    """
    from polhode.molecules import isotopes

    try:
        return isotopes(molecule.labels, masses)
    except PolhodeError as error:
        raise FileFormatError(os.fspath(path), f": {error}") from None


def solid_from_file(
    path: str | os.PathLike[str],
    *,
    density: Number | None = None,
    mass: Number | None = None,
    scale: float | None = None,
    weld: float = 0.0,
    closure: Literal["caps", "hull"] | None = None,
    orient: bool = False,
    repair: bool = False,
    index_base: int = 1,
    progress: Callable[[float], object] | None = None,
) -> MeshSolid:
    """Make a solid from the mesh in a file; errors name the file.

    Binary STL and binary PLY are read block by block, so that a file may be larger than the memory. Of a PLY
    file only the vertices are kept in memory, since faces refer to them in any order. Other formats are read
    into memory as a whole. The same holds if corners are welded within a length, or if holes are closed.

    To find duplicate faces, a file that is read in blocks is read once more for every eight million
    triangles. A component whose faces are wound inward is a cavity if it lies inside another component. This
    is checked for meshes of up to a quarter of a million triangles. `RigidBody.provenance` lists the checks
    that were made.

    Parameters
    ----------
    path : str or os.PathLike
        See :func:`read_mesh`.
    density, mass : float or Uncertain, optional
        Exactly one of them.
    scale : float, optional
        Length of one unit of the coordinates, in the unit of the result. By default it is the unit of
        the file in metres, if the file or its format states the unit, and 1 otherwise.
    weld, index_base
        See :func:`read_mesh`.
    closure : {"caps", "hull"}, optional
        How to close an open mesh, see :meth:`polhode.RigidBody.from_mesh`. By default an open mesh is an
        error.
    orient : bool
        Whether to turn triangles that face inward. By default they are an error.
    repair : bool
        Whether to mend the mesh where there is need: weld corners, drop duplicate faces, turn faces so that
        all are wound alike, and fill holes. ``MeshSolid.steps`` tells what was done. It takes the place of
        `closure` and `orient`.
    progress : callable, optional
        A function that is called now and then with the fraction of the file that has been read.

    Returns
    -------
    MeshSolid

    Raises
    ------
    FileFormatError
        If the file is not what its name says, damaged or empty.
    MeshError
        If the mesh does not bound a solid.
    OSError
        If the file cannot be read.
    """
    loaded = load(path, index_base=index_base)
    warn(path, () if loaded.cad is None else loaded.cad.overlaps)
    own = 1.0 if loaded.unit is None else metres_per(loaded.unit)
    if scale is not None and scale != own and loaded.states_unit:
        raise PolhodeError(
            f"scale: {os.fspath(path)} says itself that its unit is {loaded.unit!r}; leave it out"
        )
    return solid_of(
        loaded,
        density=density,
        mass=mass,
        scale=own if scale is None else scale,
        weld=weld,
        closure=closure,
        orient=orient,
        repair=repair,
        progress=progress,
    )
