"""What an extra of the package needs, for pip: ``python packaging/needs.py all | pip install -r /dev/stdin``.

`make build` installs it while the extension is compiled, which pip alone does one after the other.
"""

from __future__ import annotations

import re
import sys
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]


def needs(project: dict[str, Any], extra: str) -> Iterator[str]:
    """The requirements of an extra, with those of the extras that it names."""
    for requirement in project["optional-dependencies"][extra]:
        own = re.fullmatch(rf"{project['name']}\[(.*)\]", requirement)
        for name in own[1].split(",") if own else []:
            yield from needs(project, name)
        if not own:
            yield requirement


if __name__ == "__main__":
    table = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    print(*table["dependencies"], *needs(table, sys.argv[1]), sep="\n")
