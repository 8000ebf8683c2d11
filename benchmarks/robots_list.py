"""The rows of ``robots.toml``: public robot files, and what is expected of their links."""

from __future__ import annotations

import tomllib
from collections import defaultdict
from dataclasses import dataclass, field
from pathlib import Path

LIST = Path(__file__).with_name("robots.toml")


@dataclass
class File:
    """A row: a file at a commit, and those of its links that are not expected to be good."""

    repository: str
    commit: str
    licence: str
    path: str
    links: int = 0
    by: str = ""
    words: dict[str, dict[str, list[str]]] = field(default_factory=dict)  # word, judges, links

    def expected(self, name: str) -> tuple[str, str]:
        """Return what is expected of a link, and by whom."""
        found = ((w, by) for w, said in self.words.items() for by, names in said.items() if name in names)
        return next(found, ("good", self.by))


def listed() -> list[File]:
    """Read the list."""
    table = tomllib.loads(LIST.read_text(encoding="utf-8"))
    return [
        File(
            r["name"], r["commit"], r["licence"], row.pop("path"), row.pop("links", 0), row.pop("by", ""), row
        )
        for r in table["repository"]
        for row in r["files"]
    ]


def written(files: list[File]) -> str:
    """Return the list as it stands in its file."""
    rows = defaultdict(list)
    for file in files:
        rows[file.repository, file.commit, file.licence].append(file)
    lines = [LIST.read_text(encoding="utf-8").split("\n[[", 1)[0].rstrip()]
    for (repository, commit, licence), held in rows.items():
        lines += [
            "",
            "[[repository]]",
            f'name = "{repository}"',
            f'commit = "{commit}"',
            f'licence = "{licence}"',
            "files = [",
        ]
        for file in held:
            said = [
                f"{w} = {{ {', '.join(f'{by!r} = {names}' for by, names in d.items())} }}"
                for w, d in file.words.items()
            ]
            parts = [f"path = {file.path!r}", f"links = {file.links}", f"by = {file.by!r}", *said]
            lines.append(f"  {{ {', '.join(parts)} }},".replace("'", '"'))
        lines.append("]")
    return "\n".join(lines) + "\n"
