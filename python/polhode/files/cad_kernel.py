"""OCCT, the geometry kernel that reads CAD files: the module OCP of the extra ``cad``."""

from __future__ import annotations

from functools import cache
from importlib.util import find_spec
from typing import Any

from polhode._extras import require

__all__ = ["check_occt", "occt"]


@cache
def occt(module: str, purpose: str = "reading CAD files (STEP, IGES)") -> Any:
    """Import a module of OCP by its short name, as in ``occt("TopoDS")``."""
    return require(f"OCP.{module}", extra="cad", purpose=purpose)


def check_occt(purpose: str) -> None:
    """Refuse with the line that installs OCCT where it is absent; it is not imported."""
    if find_spec("OCP") is None:
        require("OCP", extra="cad", purpose=purpose)
