"""The gallery: each script of ``examples`` is run once; its picture, moving page and code are a page.

What a script has drawn is kept in ``docs/_build/gallery`` for as long as script and package stay as they are.
"""

from __future__ import annotations

import ast
import contextlib
import hashlib
import io
import os
import runpy
import shutil
import tomllib
import warnings
from concurrent.futures import ProcessPoolExecutor
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING

import thumbnails
from written import keep

if TYPE_CHECKING:
    from collections.abc import Iterator

    from sphinx.application import Sphinx

ROOT = Path(__file__).resolve().parents[2]
KEPT = ROOT / "docs" / "_build" / "gallery"
PICTURES = ROOT / "docs" / "gallery"


def setup(app: Sphinx) -> dict[str, bool]:
    """Write the pages before Sphinx looks for them, and copy the moving pages beside them."""
    app.connect("builder-inited", lambda app: write(Path(app.srcdir)))
    app.connect("build-finished", lambda app, error: error or copy(Path(app.outdir)))
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def write(docs: Path) -> None:
    """Run what is not kept, and write the pages."""
    table = tomllib.loads((docs / "gallery.toml").read_text("utf-8"))
    groups, shown = table["groups"], table["thumbnails"]
    names = [name for group in groups.values() for name in group]
    stamp = of_package()
    missing = [name for name in names if not done(name, stamp)]
    if missing:
        with ProcessPoolExecutor(min(len(missing), os.cpu_count() or 1)) as pool:
            for _ in pool.map(run, missing, [stamp] * len(missing)):
                pass
    keep(docs / "gallery", dict(pages(groups, {name: words for name, (_, words) in shown.items()})))
    for gone in {folder for folder in KEPT.iterdir() if folder.name not in names}:
        shutil.rmtree(gone)
    for gone in set(PICTURES.glob("*.png")) - {PICTURES / f"{name}.png" for name in names}:
        gone.unlink()
    for name in names:
        shutil.copy2(KEPT / name / f"{name}.png", PICTURES)


def copy(site: Path) -> None:
    """Put moving pages and small pictures where the pages look for them; take away those of names gone."""
    if (site / "gallery").is_dir():
        names = {"index", *(folder.name for folder in KEPT.iterdir())}
        for file in (site / "gallery").iterdir():
            if file.name.partition(".")[0] not in names:
                file.unlink()
        for kind in ("live.html", "light.png", "dark.png"):
            for file in KEPT.glob(f"*/{kind}"):
                shutil.copy2(file, site / "gallery" / f"{file.parent.name}.{kind}")


def of_package() -> str:
    """Return a mark that changes with the package, its files and their times, and with what draws."""
    mark = hashlib.sha256(f"{version('numpy')} {version('matplotlib')}".encode())
    package = ROOT / "python" / "polhode"
    for file in sorted(
        [
            *package.rglob("*.py"),
            *package.rglob("*.html"),
            *package.glob("*.so"),
            *(ROOT / "docs" / name for name in ("gallery.toml", "site/gallery.py", "site/thumbnails.py")),
        ]
    ):
        mark.update(f"{file.name}{file.stat().st_mtime_ns}".encode())
    return mark.hexdigest()


def done(name: str, stamp: str) -> bool:
    """Whether what is kept is of this script and this package."""
    mark = KEPT / name / "mark"
    return mark.exists() and mark.read_text() == stamp + text_mark(name)


def text_mark(name: str) -> str:
    """Return a mark of the text of a script."""
    return hashlib.sha256(script(name).read_bytes()).hexdigest()


def script(name: str) -> Path:
    """Return the file of an entry."""
    return ROOT / "examples" / f"{name}.py"


def run(name: str, stamp: str) -> None:
    """Draw the picture of an entry and its moving page, and keep what it prints."""
    folder = KEPT / name
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed), warnings.catch_warnings(action="error"):
        made = runpy.run_path(str(script(name)))
        figure = made["draw"]()
        figure.savefig(folder / f"{name}.png", dpi=96)
        thumbnails.save(figure, view(name), folder)
    (folder / "printed.txt").write_text(printed.getvalue(), "utf-8")
    if "animate" in made:
        made["animate"](str(folder / "live.html"))
    (folder / "mark").write_text(stamp + text_mark(name))


def view(name: str) -> int:
    """Return the number of the view of a figure that stands in the gallery."""
    table = tomllib.loads((ROOT / "docs" / "gallery.toml").read_text("utf-8"))
    number, _ = table["thumbnails"][name]
    return int(number)


def title(name: str) -> str:
    """Return the heading of an entry: the name of its file."""
    return name.replace("_", " ").capitalize().replace("T handle", "T-handle").replace("lagrange", "Lagrange")


def says(name: str) -> str:
    """Return what a script says of itself, on one line."""
    return " ".join((ast.get_docstring(ast.parse(script(name).read_text("utf-8"))) or "").split())


def pages(groups: dict[str, list[str]], shown: dict[str, str]) -> Iterator[tuple[str, str]]:
    """Return the name and the text of each page."""
    listing = [
        "# Gallery\n",
        "Each picture leads to its code. Entries with ▶ also show the motion in the browser.",
        "The others have a picture alone.\n",
    ]
    for group, names in groups.items():
        listing += [f"## {group}\n", '<div class="gallery">']
        for name in names:
            live = " ▶" if (KEPT / name / "live.html").exists() else ""
            listing.append(
                f'<a class="entry" href="{name}.html">{small(name, shown[name])}'
                f"<span><b>{title(name)}{live}</b>{says(name)}</span></a>"
            )
            yield f"{name}.md", entry(name)
        listing.append("</div>\n")
    listing += ["```{toctree}\n:hidden:\n", *(name for group in groups.values() for name in group), "```\n"]
    yield "index.md", "\n".join(listing)


def small(name: str, words: str) -> str:
    """Return the small picture of an entry, in the colours of both modes of the page."""
    return "".join(
        f'<img class="only-{mode}" src="{name}.{mode}.png" alt="{words}" width="320" height="200"'
        ' loading="lazy">'
        for mode in thumbnails.THEMES
    )


def entry(name: str) -> str:
    """Return the page of an entry."""
    lines = [f"# {title(name)}\n", f"{says(name)}\n"]
    if (KEPT / name / "live.html").exists():
        lines.append(
            f'<iframe class="live" src="{name}.live.html" title="{title(name)}, moving"'
            ' loading="lazy" allowfullscreen></iframe>\n\n'
            f'<p><a href="{name}.live.html">The moving page by itself</a></p>\n'
        )
    drawn = made_of(name, "draw") or f"Picture of {title(name)}"
    lines += [
        f"![{drawn}]({name}.png)\n",
        f"```{{literalinclude}} ../../examples/{name}.py\n:language: python\n```\n",
    ]
    printed = (KEPT / name / "printed.txt").read_text("utf-8").rstrip()
    lines += [f"It prints\n\n```text\n{printed}\n```\n"] if printed else []
    return "\n".join(lines)


def made_of(name: str, function: str) -> str:
    """Return the first line of the docstring of a function of an entry."""
    for node in ast.parse(script(name).read_text("utf-8")).body:
        if isinstance(node, ast.FunctionDef) and node.name == function:
            return described(ast.get_docstring(node) or "")
    return ""


def described(docstring: str) -> str:
    """Return what a figure shows: the first line of the function that draws it, as a noun."""
    text = docstring.partition("\n")[0].rstrip(".").removeprefix("Draw ")
    return text[:1].upper() + text[1:]
