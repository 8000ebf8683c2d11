"""Baselines of ``polhode check``: findings that a team has accepted, by file, link and law, not by lines."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import TYPE_CHECKING, Final, NamedTuple

from polhode.errors import FileFormatError
from polhode.io.budget import read_text
from polhode.io.writing import write_bytes

if TYPE_CHECKING:
    from collections.abc import Iterable

__all__ = ["Baseline", "Key"]

Key = tuple[str, str, str]
"""File (relative to the folder of the baseline), link by its name in that file, law."""
_FORMAT: Final = "polhode baseline"
_VERSION: Final = 1
_NAMES: Final = ("file", "link", "law")


class Baseline(NamedTuple):
    """Accepted findings.

    Attributes
    ----------
    path : pathlib.Path
    accepted : frozenset of tuple of str
    """

    path: Path
    accepted: frozenset[Key]

    @classmethod
    def read(cls, path: Path) -> Baseline:
        """Read a baseline.

        Raises
        ------
        FileFormatError
            If the file is none.
        OSError
            If it cannot be read.
        """
        try:
            found = json.loads(read_text(path, "baseline"))
        except ValueError as error:
            raise FileFormatError(f"--baseline: {path}: is not JSON ({error}); --accept writes one") from None
        if not isinstance(found, dict) or found.get("format") != _FORMAT:
            raise FileFormatError(f"--baseline: {path}: is no baseline; polhode check --accept writes one")
        if found.get("version") != _VERSION:
            version = str(found.get("version"))[:40]
            raise FileFormatError(f"--baseline: {path}: has version {version}, not {_VERSION}; write it anew")
        keys: set[Key] = set()
        rows = found.get("accepted")
        for number, row in enumerate(rows if isinstance(rows, list) else [None]):
            key = tuple(row.get(name) for name in _NAMES) if isinstance(row, dict) else ()
            if len(key) != len(_NAMES) or not all(isinstance(word, str) for word in key):
                raise FileFormatError(
                    f"--baseline: {path}: entry {number} of accepted needs the texts {', '.join(_NAMES)}; "
                    "--accept writes them"
                )
            keys.add((str(key[0]), str(key[1]), str(key[2])))
        return cls(path, frozenset(keys))

    def key(self, file: Path, link: str, law: str) -> Key:
        """Return what a finding is known by."""
        return self.name(file), link, law

    def name(self, file: Path) -> str:
        """Name a file from the folder of the baseline."""
        return Path(os.path.relpath(os.path.realpath(file), os.path.realpath(self.path.parent))).as_posix()

    def renew(self, files: Iterable[Path], keys: Iterable[Key]) -> Baseline:
        """Return the baseline with these findings in place of those of the files that were checked."""
        checked = {self.name(file) for file in files}
        left = {key for key in self.accepted if key[0] not in checked}
        return Baseline(self.path, frozenset({*left, *keys}))

    def write(self) -> None:
        """Write the baseline, an entry a line, in the order of files and links."""
        rows = [json.dumps(dict(zip(_NAMES, key, strict=True))) for key in sorted(self.accepted)]
        listed = "".join(f"\n    {row}," for row in rows).removesuffix(",")
        text = f'{{\n  "format": "{_FORMAT}",\n  "version": {_VERSION},\n  "accepted": [{listed}\n  ]\n}}\n'
        write_bytes(self.path, text.encode())
