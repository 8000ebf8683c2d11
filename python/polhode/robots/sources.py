"""Read the other files of a robot, safely.

Nothing is fetched from a network. An included file is XML under the same rules as the file itself, a file can
not include itself, and there is an end to how many are read and to what they add up to.
"""

from __future__ import annotations

import os
import re
import stat
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Final, NamedTuple

from polhode._format import Argument, Note
from polhode.errors import FileFormatError
from polhode.io.budget import LIMITS, Budget, LimitError, note_read, status_of
from polhode.io.xml_source import Element, parse_xml
from polhode.robots.model import shorten

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from typing import BinaryIO

    from polhode.robots.model import Joint

__all__ = [
    "Addresses",
    "LimitError",
    "Lookup",
    "Sources",
    "own_root",
    "read_source",
    "read_stream",
]

_MOST_BYTES: Final = LIMITS["included bytes"].least
_LONGEST_NAME: Final = 1000


class Sources:
    """Reads the XML of a robot.

    Parameters
    ----------
    folder : pathlib.Path
        Of the robot's file.
    addresses : Addresses
    """

    def __init__(self, folder: Path, addresses: Addresses) -> None:
        self.folder, self.addresses = folder, addresses
        self.budget = Budget("", 0)  # whose limits do not depend on the size of the robot's own file
        self.names: dict[str, set[Path]] = {}
        """The files that were read, by the names under which they were asked for."""
        self.notes: dict[str, None] = {}
        """What of them is not judged."""
        self.total_mass = 0.0
        """Of MJCF: what all bodies together are scaled to, if that is not 0."""
        self.joints: list[Joint] = []
        """What ties the links that were read."""
        self.frames: dict[str, str] = {}
        """Of SDF: what each frame is attached to."""
        self._open: set[Path] = set()

    def locate(self, address: str, folder: Path, at: Element) -> Path:
        """Find a file; raise an error if it is missing.

        Parameters
        ----------
        address : str
            As the file has it.
        folder : pathlib.Path
            Where it starts.
        at : Element
            That asks for it.

        Raises
        ------
        FileFormatError
            If it is not there, or not one that the model may name.
        """
        path, reason = self.addresses.find(address, folder)
        if reason:
            raise FileFormatError(f"{at.where}: {shorten(address)} ", reason)
        if path is None or not path.is_file():
            name = shorten(address)
            raise FileFormatError(f"{at.where}: there is no file {name}; put it at {folder / name}")
        return path

    def read(self, path: Path, address: str, at: Element) -> Element:
        """Read one of the files; elements of what is read name its address.

        Raises
        ------
        FileFormatError
            If it is not XML that may be read, or is one too many.
        """
        self.budget.spend("files", 1, f"{at.where}: {address}")
        try:
            source = read_source(path, self.budget.remaining("included bytes"))
        except OSError as error:
            raise FileFormatError(
                f"{at.where}: {address} cannot be read: {error.strerror}; check {path}"
            ) from None
        self.budget.spend("included bytes", len(source), at.where)
        self.names.setdefault(address, set()).add(path)
        try:
            return parse_xml(
                source, str(path), file=address, above=at.depth, budget=self.budget, remarks=self.notes
            )
        except FileFormatError as error:
            raise FileFormatError(f"{at.where}: ", *error.args) from None

    def count_copies(self, number: int, at: Element) -> None:
        """Count copies of elements, so that a small file does not become a boundless one."""
        self.budget.spend("copies", number, at.where)

    def count_copied(self, number: int, at: Element, *, keep: bool) -> None:
        """Count the elements within copies; those of nested copies are counted once."""
        of = self.budget if keep else Budget("", 0)
        of.spend("elements in copies", number, at.where)

    def name(self, prefix: str, own: str, at: Element) -> str:
        """Return the name of a link, a long one shortened; count the link.

        Raises
        ------
        FileFormatError
            If there are too many.
        """
        self.budget.spend("links", 1, at.where)
        return self.prefix(prefix + own)

    def prefix(self, text: str) -> str:
        """Return the prefix of the names of links, shortened, because every name holds it."""
        return shorten(text, _LONGEST_NAME)

    @contextmanager
    def inside(self, path: Path, address: str, at: Element) -> Iterator[None]:
        """Mark a file as being read; it may not include itself."""
        resolved = path.resolve()
        if resolved in self._open:
            raise FileFormatError(f"{at.where}: {address} is read within itself; take one of the two out")
        self._open.add(resolved)
        try:
            yield
        finally:
            self._open.remove(resolved)


def read_source(path: Path, most: int = _MOST_BYTES) -> bytes:
    """Read a file, or a pipe into which something writes, of at most so many bytes.

    Raises
    ------
    FileFormatError
        If it is larger, or neither of them.
    OSError
        If it cannot be read.
    """
    mode = status_of(path).st_mode
    if stat.S_ISDIR(mode):
        raise FileFormatError(f"{path}: is a directory; name a file in it")
    if not (stat.S_ISREG(mode) or stat.S_ISFIFO(mode)):
        raise FileFormatError(f"{path}: is a device or a socket, which may never end; name a file")
    # Without O_NONBLOCK a pipe into which nobody writes would be waited for, for ever, when it is opened.
    flags = os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0)
    with os.fdopen(os.open(path, flags), "rb") as stream:
        if stat.S_ISFIFO(mode):
            os.set_blocking(stream.fileno(), True)
        source = read_stream(stream, str(path), most)
    if not source and stat.S_ISFIFO(mode):
        raise FileFormatError(f"{path}: is a pipe into which nothing writes; start first what writes")
    note_read(path)
    return source


def read_stream(stream: BinaryIO, name: str, most: int = _MOST_BYTES) -> bytes:
    """Read a stream to its end, at most so many bytes.

    Raises
    ------
    FileFormatError
        If it is more.
    """
    source = stream.read(most + 1)
    if len(source) > most:
        raise FileFormatError(f"{name}: has more than {most} bytes, the most that is read; divide the model")
    return source


_SEARCH_PATHS: Final = (
    *(
        "ROS_PACKAGE_PATH",
        "GZ_SIM_RESOURCE_PATH",
        "IGN_GAZEBO_RESOURCE_PATH",
        "GAZEBO_MODEL_PATH",
        "SDF_PATH",
    ),
)
_PACKAGES: Final = ("package.xml", "manifest.xml", "model.config")
_CHECKOUTS: Final = (".git", ".hg")
_PYTHON: Final = ("__init__.py",)
_BESIDE_MESHES: Final = frozenset({"urdf", "sdf", "mjcf", "xml", "robots", "worlds"})
_NAME: Final = re.compile(rb"<name>\s*([^<>\s]{1,200})\s*</name>")
# Packages are looked for by the names that they give themselves, so deep and among so many folders.
_DEEPEST: Final = 4
_MOST_FOLDERS: Final = 5000
# Beyond this no system opens a file; it also bounds the work on a name.
_LONGEST: Final = 4096


class Lookup(NamedTuple):
    """Result of the search for an address.

    Attributes
    ----------
    path : pathlib.Path or None
        The file or folder; None where there is none, or none that is read.
    fault : str
        Why what is there is not read, and the way out; "" where nothing is there.
    """

    path: Path | None
    fault: str = ""


class Addresses:
    """Finds files by the addresses that robot files use.

    Parameters
    ----------
    folder : pathlib.Path
        Of the robot's file.
    packages : sequence of pathlib.Path
        Folders that hold the packages of ``package://`` and ``model://`` addresses, by the names of their
        folders or by those in their ``package.xml``; folders above the file, ``ROS_PACKAGE_PATH``,
        ``GZ_SIM_RESOURCE_PATH``, ``SDF_PATH`` and ``AMENT_PREFIX_PATH`` are searched too.
    allow_outside : bool
        Whether addresses may lead anywhere.
    """

    def __init__(self, folder: Path, packages: Sequence[Path] = (), *, allow_outside: bool = False) -> None:
        above = _absolute(folder)
        self._declared = [_absolute(each) for each in [*packages, *_from_environment()]]
        self._above = [above, *above.parents]
        self._allow_outside = allow_outside
        self._roots: dict[Path, tuple[Path, ...]] = {}
        self._named: dict[Path, dict[str, Path]] = {}

    def find(self, address: str, folder: Path) -> Lookup:
        """Find a file or a folder.

        Parameters
        ----------
        address : str
            A path, or one after ``file://``, ``package://NAME`` or ``model://NAME``.
        folder : pathlib.Path
            Where a relative path starts.
        """
        if len(address) > _LONGEST:
            return Lookup(None, f"is a name of {len(address)} characters, more than files have; shorten it")
        if "\0" in address:
            return Lookup(None, "holds a character of code 0, which no file has; take it out")
        fault = ""
        for path, roots in self._candidates(address, folder):
            if not self._allow_outside and _is_outside(path, roots):
                # Of folders that merely might be meant, only one that is there is worth telling.
                if "://" not in address or address.startswith("file:") or _kind(path)[0] is not None:
                    fault = fault or Note(
                        f"lies outside {roots[0]}, where the model's files are, and is not read; "
                        "name the folder of its package with --packages, or pass ",
                        Argument("allow_outside", True),
                    )
                continue
            is_readable, reason = _kind(path)
            if is_readable:
                return Lookup(path)
            fault = fault or reason
        return Lookup(None, fault)

    def _candidates(self, address: str, folder: Path) -> Iterator[tuple[Path, tuple[Path, ...]]]:
        """Return each path that an address may stand for, and the folders that it has to lie in."""
        scheme, separator, rest = address.partition("://")
        if not separator or scheme == "file":
            plain = rest if separator else address
            # As the system takes "..": from where the folder is in truth.
            base = Path(os.path.realpath(folder))
            for name in _spellings(plain):
                yield base / name, self._own(folder)
        elif scheme in ("package", "model"):
            name, _, inside = rest.replace("\\", "/").lstrip("/").partition("/")
            if name in ("", ".", "..") or Path(name).name != name:
                return
            searched = [*self._declared, *self._above]
            homes = [root / name for root in searched] + [root for root in searched if root.name == name]
            for home in (each for each in homes if _kind(each)[0]):
                yield home / inside.lstrip("/"), self._of_package(home, folder)
            called = self._by_own_name(folder).get(name)
            if called is not None:
                yield called / inside.lstrip("/"), self._of_package(called, folder)

    def _by_own_name(self, folder: Path) -> dict[str, Path]:
        """Return packages above a model, and those within its roots, by what ``package.xml`` calls them."""
        if folder not in self._named:
            names: dict[str, Path] = {}
            wide = _wide(folder)
            for home in [each for each in self._above if each not in wide] + _folders_within(
                self._own(folder)
            ):
                name = _own_name(home / "package.xml")
                if name:
                    names.setdefault(name, home)
            self._named[folder] = names
        return self._named[folder]

    def _own(self, folder: Path) -> tuple[Path, ...]:
        """Return the folders that a model in this folder may name files in: its own and the declared ones."""
        if folder not in self._roots:
            places = dict.fromkeys((Path(os.path.realpath(folder)), _absolute(folder)))
            inside = [own_root(place) for place in places]
            self._roots[folder] = tuple(dict.fromkeys(_with_real([*inside, *self._declared])))
        return self._roots[folder]

    def _of_package(self, home: Path, folder: Path) -> tuple[Path, ...]:
        """Return the folders that a file of a package may lie in; the model's own where it is no package."""
        own = self._own(folder)
        marks = [home / mark for mark in _PACKAGES if _kind(home / mark)[0]]
        if not marks and not any(home.is_relative_to(root) for root in own):
            return own
        # An installed package may be made of links to its source, its mark among them.
        sources = (Path(os.path.realpath(mark)) for mark in marks)
        return (*_with_real([home]), *(each.parent for each in sources if each.name in _PACKAGES), *own)


def own_root(folder: Path) -> Path:
    """Find the folder that a model's own files lie in.

    It is the package that encloses the file (a folder with ``package.xml``, ``manifest.xml`` or
    ``model.config``, the outermost), else its checkout (``.git``, ``.hg``), else its Python package, else,
    for a file in ``urdf/``, ``sdf/`` and the like, the folder that holds that one and ``meshes/`` beside it,
    else the file's own folder. The user's home and the folders above it are none of these.

    Parameters
    ----------
    folder : pathlib.Path
        Of the file, absolute.
    """
    wide = _wide(folder)
    above = [each for each in (folder, *folder.parents) if each not in wide]
    for marks, which in ((_PACKAGES, -1), (_CHECKOUTS, 0), (_PYTHON, 0)):
        marked = [each for each in above if any(os.path.lexists(each / mark) for mark in marks)]
        if marked:
            return marked[which]
    is_beside = folder.name.lower() in _BESIDE_MESHES and folder.parent in above
    return folder.parent if is_beside else folder


def _wide(folder: Path) -> set[Path]:
    """Return the folders that hold everything: the user's home and those above it."""
    try:
        home = Path(os.path.realpath(Path.home()))
    except RuntimeError:  # of a user without one
        home = Path(folder.anchor)
    return {Path(folder.anchor), home, *home.parents}


def _folders_within(roots: Sequence[Path]) -> list[Path]:
    """Return the folders in these, level by level; those within a package, and links, are not entered."""
    level, found = list(dict.fromkeys(roots)), []
    for depth in range(_DEEPEST + 1):
        found += level
        inner: list[Path] = []
        for folder in level if depth < _DEEPEST else ():
            if depth and os.path.lexists(folder / "package.xml"):
                continue
            with suppress(OSError), os.scandir(folder) as entries:
                names = [
                    e.name for e in entries if not e.name.startswith(".") and e.is_dir(follow_symlinks=False)
                ]
                inner += [folder / name for name in sorted(names)]
            if len(found) + len(inner) > _MOST_FOLDERS:
                break
        level = inner
    return found


def _own_name(mark: Path) -> str:
    """Return the name that a ``package.xml`` states; "" where there is none."""
    # A link to something else is not opened; that of an installed package leads to the source's own.
    if not _kind(mark)[0] or Path(os.path.realpath(mark)).name != mark.name:
        return ""
    with suppress(OSError), mark.open("rb") as stream:
        match = _NAME.search(stream.read(1 << 16))
        return match[1].decode("utf-8", "replace") if match else ""
    return ""


def _absolute(folder: Path) -> Path:
    """Write a path without dots, links on it left as they are."""
    return Path(os.path.normpath(folder.absolute()))


def _from_environment() -> Iterator[Path]:
    for name in _SEARCH_PATHS:
        yield from (Path(entry) for entry in os.environ.get(name, "").split(os.pathsep) if entry)
    prefixes = os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep)
    yield from (Path(entry, "share") for entry in prefixes if entry)


def _spellings(name: str) -> tuple[str, ...]:
    """Return a path, and the same path with the separators of Windows replaced."""
    if not name:
        return ()
    return (name, name.replace("\\", "/")) if "\\" in name else (name,)


def _is_outside(path: Path, roots: Sequence[Path]) -> bool:
    """Return whether a path leads out of all these folders, also through symbolic links."""
    written = Path(os.path.normpath(path))
    if not any(written.is_relative_to(root) for root in roots):
        return True
    real = Path(os.path.realpath(path))
    return not any(real.is_relative_to(root) for root in roots)


def _with_real(folders: Sequence[Path]) -> Iterator[Path]:
    for folder in folders:
        yield folder
        yield Path(os.path.realpath(folder))


def _kind(path: Path) -> tuple[bool | None, str]:
    """Return whether a path is a file or a folder (None: nothing is there), and why it is not read."""
    try:
        mode = path.stat().st_mode
    except (FileNotFoundError, NotADirectoryError):
        return None, ""
    except OSError as error:
        return False, f"cannot be read ({error.strerror}); correct its name or its permissions"
    if stat.S_ISREG(mode) or stat.S_ISDIR(mode):
        return True, ""
    return False, "is a pipe, a socket or a device; name a file"
