"""What functions of the extension take, by the words of their docstrings."""

from __future__ import annotations

import inspect
import re
from typing import Any

#: A value for each kind of array that docstrings name, as one row; numbers that float32 has too.
KINDS: dict[str, Any] = {
    "(...)": 0.5,
    "(..., 3)": [0.5, 0.0, 0.25],
    "(..., 3, 3)": [[0.5, 0.0, 0.0], [0.0, 0.25, 0.0], [0.0, 0.0, 0.5]],
}


def arrays(function: Any) -> dict[str, Any]:
    """A value for each argument that is an array of one of these kinds, by its name."""
    section = re.search(r"Parameters\n-+\n(.*?)\n\n\w+\n-+\n", inspect.getdoc(function) or "", re.DOTALL)
    found = re.findall(r"^(\w+) : array_like, shape (\(.*?\))", section[1] if section else "", re.MULTILINE)
    return {name: KINDS[shape] for name, shape in found if shape in KINDS}


def takes_arrays_alone(function: Any) -> bool:
    """Whether all its arguments are such arrays."""
    parameters = set(inspect.signature(function).parameters)
    return bool(parameters) and parameters == set(arrays(function))
