"""The files that a robot is made of besides its own, read safely.

Nothing is fetched from a network. What is included is XML under the same rules as the file itself, a file can
not include itself, and there is an end to how many are read and to what they add up to.
"""

from __future__ import annotations

import os
import stat
from contextlib import contextmanager
from typing import TYPE_CHECKING, Final

from polhode.errors import FileFormatError
from polhode.files.budget import LIMITS, Budget, LimitError
from polhode.files.reading import note_read, status_of
from polhode.files.xml_source import Element, parse_xml
from polhode.robots.words import shortened

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path
    from typing import BinaryIO

    from polhode.robots.addresses import Addresses
    from polhode.robots.model import Joint

__all__ = ["LimitError", "Sources", "read_source", "read_stream"]

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
        self.names: dict[str, None] = {}
        """Of the files that were read, as they were asked for."""
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
        """Find a file that has to be there.

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
        path, fault = self.addresses.find(address, folder)
        if fault:
            raise FileFormatError(f"{at.where}: {shortened(address)} {fault}")
        if path is None or not path.is_file():
            name = shortened(address)
            raise FileFormatError(f"{at.where}: there is no file {name}; put it at {folder / name}")
        return path

    def read(self, path: Path, address: str, at: Element) -> Element:
        """Read one of the files; elements of what is read name its address.

        Raises
        ------
        FileFormatError
            If it is not XML that may be read, or is one too many.
        """
        self.budget.spend("files", where=f"{at.where}: {address}")
        try:
            source = read_source(path, self.budget.left("included bytes"))
        except OSError as error:
            raise FileFormatError(
                f"{at.where}: {address} cannot be read: {error.strerror}; check {path}"
            ) from None
        self.budget.spend("included bytes", len(source), at.where)
        self.names[address] = None
        try:
            return parse_xml(
                source, str(path), file=address, above=at.depth, budget=self.budget, remarks=self.notes
            )
        except FileFormatError as error:
            raise FileFormatError(f"{at.where}: {error}") from None

    def count_copies(self, number: int, at: Element) -> None:
        """Count copies of elements, so that a small file does not become a boundless one."""
        self.budget.spend("copies", number, at.where)

    def count_copied(self, number: int, at: Element, *, keep: bool) -> None:
        """Count the elements within copies, alike; those of copies within copies are not kept twice."""
        of = self.budget if keep else Budget("", 0)
        of.spend("elements in copies", number, at.where)

    def name(self, prefix: str, own: str, at: Element) -> str:
        """Give a link its name; a long one is cut, and links are counted.

        Raises
        ------
        FileFormatError
            If there are too many.
        """
        self.budget.spend("links", where=at.where)
        return self.prefix(prefix + own)

    def prefix(self, text: str) -> str:
        """Give what names of links begin with, cut where it is long: they all hold it."""
        return shortened(text, _LONGEST_NAME)

    @contextmanager
    def inside(self, path: Path, address: str, at: Element) -> Iterator[None]:
        """Be within a file, which may then not be asked for again."""
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
