"""The notebooks as pages: each is run when the site is built, and what its cells show stands below them."""

from __future__ import annotations

import ast
import contextlib
import html
import io
import json
import re
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any
from unittest import mock

from written import keep

if TYPE_CHECKING:
    from sphinx.application import Sphinx

ROOT = Path(__file__).resolve().parents[2]
FOLDER = ROOT / "docs" / "notebooks"
FRAME = re.compile(r'<iframe title="([^"]*)" srcdoc="([^"]*)"[^>]*></iframe>')

moving: dict[str, str] = {}
"""The moving pages by the names of their files."""


def setup(app: Sphinx) -> dict[str, bool]:
    """Write the pages before Sphinx looks for them, and the moving pages beside them."""
    app.connect("builder-inited", lambda _: keep(FOLDER, pages()))
    app.connect("build-finished", lambda app, error: error or copy(Path(app.outdir)))
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def copy(site: Path) -> None:
    """Put the moving pages where the pages look for them."""
    for name, text in moving.items():
        (site / "notebooks" / name).write_text(text, "utf-8")


def pages() -> dict[str, str]:
    """Return the names and the texts of the pages."""
    names = sorted(path.stem for path in FOLDER.glob("*.ipynb"))
    found = {f"{name}.md": page(name) for name in names}
    rows = [
        f"| [{text.partition(chr(10))[0].removeprefix('# ')}]({file}) | {{download}}`{file[:-3]}.ipynb` |"
        for file, text in found.items()
    ]
    listing = [
        "# Notebooks\n",
        "Each notebook is a page here, with what its cells show. Download the file to run it yourself.\n",
        "| notebook | file |\n|---|---|",
        *rows,
        "\n```{toctree}\n:hidden:\n",
        *names,
        "```\n",
    ]
    return found | {"index.md": "\n".join(listing)}


def page(name: str) -> str:
    """Return the page of a notebook: its text, its code, and below the code what it prints and shows."""
    cells = json.loads((FOLDER / f"{name}.ipynb").read_text("utf-8"))["cells"]
    names: dict[str, Any] = {}
    lines = []
    for cell in cells:
        source = "".join(cell["source"])
        if cell["cell_type"] == "markdown":
            lines.append(source)
            continue
        lines.append(f"```python\n{source}\n```")
        printed, value = run(source, names)
        if printed:
            lines.append(f"```text\n{printed.rstrip()}\n```")
        if value is not None:
            lines.append(shown(value._repr_html_(), name))
    return "\n\n".join([*lines, f"Download this notebook: {{download}}`{name}.ipynb`", ""])


def run(source: str, names: dict[str, Any]) -> tuple[str, Any]:
    """Run a cell as a notebook does: give what it prints, and the value of its last expression."""
    tree = ast.parse(source)
    last = tree.body.pop() if isinstance(tree.body[-1], ast.Expr) else None
    value = None
    with (
        contextlib.redirect_stdout(io.StringIO()) as printed,
        mock.patch.dict(sys.modules, {"ipykernel": sys}),  # as where a notebook runs
    ):
        exec(compile(tree, "cell", "exec"), names)
        if isinstance(last, ast.Expr):
            value = eval(compile(ast.Expression(last.value), "cell", "eval"), names)
    return printed.getvalue(), value


def shown(text: str, name: str) -> str:
    """Return what a cell shows, with its moving pages as files of their own."""

    def framed(found: re.Match[str]) -> str:
        file = f"{name}.{sum(one.startswith(name + '.') for one in moving) + 1}.live.html"
        moving[file] = html.unescape(found[2])
        return (
            f'<iframe class="live" src="{file}" title="{found[1]}" loading="lazy" allowfullscreen></iframe>'
        )

    text = FRAME.sub(framed, text)
    return f'```{{raw}} html\n<div class="shown">{text}</div>\n```'
