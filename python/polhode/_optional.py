"""Import optional libraries where they are used. If one is absent, the error says how to install it."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from types import ModuleType

__all__ = ["require"]


def require(module: str, *, extra: str | None, purpose: str) -> ModuleType:
    """Import a library that polhode does not depend on.

    Parameters
    ----------
    module : str
        Dotted name of the module.
    extra : str or None
        The extra of polhode that installs it; None if it is installed under its own name.
    purpose : str
        What it is needed for, to complete "... needs `module`".

    Raises
    ------
    ModuleNotFoundError
        With the one line that installs the library.
    """
    library = module.partition(".")[0]
    try:
        return import_module(module)
    except ModuleNotFoundError as error:
        if error.name is None or error.name.partition(".")[0] != library:
            raise  # the library is there; something inside it is broken, which its own message tells best
        package = library if extra is None else f'"polhode[{extra}]"'
        message = f"{purpose} needs {library}: pip install {package}"
        raise ModuleNotFoundError(message, name=library) from None
