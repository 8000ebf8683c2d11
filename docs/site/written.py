"""Pages that the site makes itself, written where they differ: Sphinx reads again only what is new."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pathlib import Path

    from sphinx.application import Sphinx


def setup(app: Sphinx) -> dict[str, bool]:
    """Leave a mark of the last build without an error, for the tests of the site."""
    app.connect("build-finished", lambda app, error: error or (app.outdir / "built").touch())
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def keep(folder: Path, texts: dict[str, str]) -> None:
    """Make the Markdown files of a folder these."""
    folder.mkdir(exist_ok=True)
    for gone in set(folder.glob("*.md")) - {folder / name for name in texts}:
        gone.unlink()
    for name, text in texts.items():
        file = folder / name
        if not file.exists() or file.read_text("utf-8") != text:
            file.write_text(text, "utf-8")
