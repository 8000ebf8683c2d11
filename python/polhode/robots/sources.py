"""The other files that a robot's file names: where they are found, and that they are read safely.

Nothing is fetched from a network. What is included is XML under the same rules as the file itself, a file can
not include itself, and there is an end to how many are read.
"""

from __future__ import annotations

import os
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Final

from polhode._files.reading import read_bytes
from polhode._files.xml_source import Element, parse_xml
from polhode.errors import FileFormatError

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

__all__ = ["Addresses", "Sources"]

_SEARCH_PATHS: Final = ("ROS_PACKAGE_PATH", "GZ_SIM_RESOURCE_PATH", "GAZEBO_MODEL_PATH")
_MOST_FILES: Final = 1000
_MOST_COPIES: Final = 10_000


class Addresses:
    """Finds files by the addresses that robot files use.

    Parameters
    ----------
    folder : pathlib.Path
        Of the robot's file.
    packages : sequence of pathlib.Path
        Folders that hold the packages of ``package://`` and ``model://`` addresses; folders above the file,
        ``ROS_PACKAGE_PATH`` and ``GZ_SIM_RESOURCE_PATH`` are searched too.
    """

    def __init__(self, folder: Path, packages: Sequence[Path] = ()) -> None:
        from_environment = [
            Path(entry)
            for name in _SEARCH_PATHS
            for entry in os.environ.get(name, "").split(os.pathsep)
            if entry
        ]
        self._roots = [*packages, *from_environment, folder, *folder.parents]

    def find(self, address: str, folder: Path) -> Path | None:
        """Find a file or a folder that exists; `folder` is where a relative address starts."""
        scheme, separator, rest = address.partition("://")
        candidates: list[Path] = []
        if not separator:
            candidates = [folder / address] if address else []
        elif scheme == "file":
            candidates = [Path(rest)]
        elif scheme in ("package", "model"):
            name, _, inside = rest.partition("/")
            candidates = [root / name / inside for root in self._roots]
            candidates += [root / inside for root in self._roots if root.name == name]
        return next((path for path in candidates if path.is_file() or path.is_dir()), None)


class Sources:
    """Reads the files that a robot is made of besides its own.

    Parameters
    ----------
    folder : pathlib.Path
        Of the robot's file.
    addresses : Addresses
    """

    def __init__(self, folder: Path, addresses: Addresses) -> None:
        self.folder, self.addresses = folder, addresses
        self.names: dict[str, None] = {}
        """Of the files that were read, as they were asked for."""
        self.notes: dict[str, None] = {}
        """What of them is not judged."""
        self._count = self._copies = 0
        self._open: set[Path] = set()

    def read(self, path: Path, address: str, at: Element) -> Element:
        """Read one of them.

        Parameters
        ----------
        path : pathlib.Path
        address : str
            As the file has it; elements of what is read name it.
        at : Element
            That asks for it.

        Raises
        ------
        FileFormatError
            If it is not there, is not XML that may be read, or is one too many.
        """
        if not path.is_file():
            raise FileFormatError(f"{at.where}: there is no file {address}; put it at {path}")
        self._count += 1
        if self._count > _MOST_FILES:
            raise FileFormatError(f"{at.where}: {address} is one of more than {_MOST_FILES} files to be read")
        self.names[address] = None
        return parse_xml(read_bytes(path), str(path), file=address)

    def count_copy(self, at: Element) -> None:
        """Count a copy of elements, so that a small file does not become a boundless one."""
        self._copies += 1
        if self._copies > _MOST_COPIES:
            raise FileFormatError(
                f"{at.where}: more than {_MOST_COPIES} copies are to be made; lower the count"
            )

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
