"""The ``polhode`` command (extra ``cli``)."""

from __future__ import annotations

import sys

__all__ = ["main"]


def main(arguments: list[str] | None = None) -> int:
    """Run the command line.

    Parameters
    ----------
    arguments : list of str, optional
        What follows the word ``polhode``; from the process by default.

    Returns
    -------
    int
        Exit code: 0 good, 1 the verdict is bad, 2 bad input.
    """
    words = sys.argv[1:] if arguments is None else arguments
    try:
        import rich  # noqa: F401  (the commands import it when they print)

        from polhode.cli.running import run
    except ModuleNotFoundError as error:
        if (error.name or "").partition(".")[0] not in ("cyclopts", "rich"):
            raise
        if words == ["--version"]:
            from polhode import __version__

            print(f"polhode {__version__}")
            return 0
        print('polhode: the command line needs its extra: pip install "polhode[cli]"', file=sys.stderr)
        return 2
    return run(words)
