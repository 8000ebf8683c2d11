"""Where things stand: the repository, and the folders that tests import helpers from."""

from __future__ import annotations

import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
#: The folders on the search path of the tests, for processes that they start.
IMPORTED = [
    str(ROOT / folder)
    for folder in tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["tool"]["pytest"]["pythonpath"]
]
