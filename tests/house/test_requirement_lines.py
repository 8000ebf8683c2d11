"""Every line that says what to install, against the extras of the project and what the code there imports."""

from __future__ import annotations

import ast
import re
import sys
import tomllib
from collections.abc import Iterator
from functools import cache
from importlib.metadata import PackageNotFoundError, packages_distributions, requires
from pathlib import Path
from typing import NamedTuple

import pytest
from places import ROOT

PACKAGE = ROOT / "python" / "polhode"
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
EXTRAS: dict[str, list[str]] = PROJECT["optional-dependencies"]
FILES = sorted(PACKAGE.rglob("*.py"))
LINE = re.compile(r"(?:polhode|\.)\[([a-z{][^\]]*)\]")
OTHER_NAMES = {
    "OCP": "cadquery-ocp-novtk",
    "nrrd": "pynrrd",
    "PIL": "pillow",
    "imageio_ffmpeg": "imageio-ffmpeg",
    "mpl_toolkits": "matplotlib",
    "vtkmodules": "vtk",
}
"""Modules that are not named as what installs them."""
BRINGS = {
    "pyvista": {"vtk", "matplotlib"},
    "distributed": {"cloudpickle"},
    "matplotlib": {"contourpy", "pillow"},
}
"""What libraries bring that are asked for beside them; held against those that are installed."""


GIVEN = {"_elsewhere/kinds.py": {"dask"}}
"""Where a caller gave what a library made, which is then there."""


class Asked(NamedTuple):
    place: str
    module: str
    extra: str | None


def named(requirement: str) -> str:
    """The distribution of a requirement, in the form in which names are compared."""
    found = re.match(r"[A-Za-z0-9._-]+", requirement)
    assert found is not None
    return re.sub(r"[-_.]+", "-", found[0]).lower()


@cache
def brought_by(extra: str) -> frozenset[str]:
    """Every distribution that an extra installs, those that its own bring included."""
    found: set[str] = set()
    for requirement in EXTRAS[extra]:
        if (own := LINE.match(requirement)) is not None:
            found |= {name for each in own[1].split(",") for name in brought_by(each.strip())}
            continue
        name = named(requirement)
        found |= {name, *BRINGS.get(name, ())}
    return frozenset(found)


def library(module: str) -> str:
    top = module.partition(".")[0]
    return OTHER_NAMES.get(top, top)


def texts(node: ast.expr, tree: ast.Module) -> list[str]:
    """A constant, what an f-string begins with, or the constants that a name runs through."""
    if isinstance(node, ast.Constant):
        return [str(node.value)]
    if isinstance(node, ast.JoinedStr) and isinstance(node.values[0], ast.Constant):
        return [str(node.values[0].value)]
    assert isinstance(node, ast.Name), ast.dump(node)
    loops = [
        each.iter
        for each in ast.walk(tree)
        if isinstance(each, ast.comprehension)
        if isinstance(each.target, ast.Name) and each.target.id == node.id
    ]
    return [text for loop in loops for text in ast.literal_eval(loop)]


@cache
def asked(path: Path) -> tuple[Asked, ...]:
    """The calls of ``require`` in a file."""
    text = path.read_text("utf-8")
    if "require(" not in text:
        return ()
    tree = ast.parse(text)
    found = []
    for call in ast.walk(tree):
        if not (isinstance(call, ast.Call) and isinstance(call.func, ast.Name) and call.func.id == "require"):
            continue
        (extra,) = (word.value for word in call.keywords if word.arg == "extra")
        assert isinstance(extra, ast.Constant)
        where = f"{path.relative_to(PACKAGE).as_posix()}:{call.lineno}"
        found += [
            Asked(where, module, None if extra.value is None else str(extra.value))
            for module in texts(call.args[0], tree)
        ]
    return tuple(found)


@cache
def imports(path: Path) -> tuple[tuple[str, int], ...]:
    """Modules that a file imports when it runs, not for types alone."""
    return tuple(_imports(path))


def _imports(path: Path) -> Iterator[tuple[str, int]]:
    tree = ast.parse(path.read_text("utf-8"))
    for_types = {
        id(inner)
        for each in ast.walk(tree)
        if isinstance(each, ast.If) and isinstance(each.test, ast.Name) and each.test.id == "TYPE_CHECKING"
        for statement in each.body
        for inner in ast.walk(statement)
    }
    for each in ast.walk(tree):
        if id(each) in for_types:
            continue
        if isinstance(each, ast.Import):
            yield from ((name.name, each.lineno) for name in each.names)
        elif isinstance(each, ast.ImportFrom) and each.module and not each.level:
            yield each.module, each.lineno


ASKED = [each for path in FILES for each in asked(path)]


def test_there_are_such_lines() -> None:
    assert len(ASKED) >= 40
    assert {each.extra for each in ASKED} >= set(EXTRAS) - {"cli", "all"}


@pytest.mark.parametrize("each", ASKED, ids=lambda each: f"{each.place} {each.module}")
def test_the_extra_brings_what_is_asked_for(each: Asked) -> None:
    if each.extra is None:  # then the line installs the module under its own name
        assert library(each.module) == each.module.partition(".")[0]
        return
    assert each.extra in EXTRAS
    assert named(library(each.module)) in brought_by(each.extra)


def test_modules_are_of_the_libraries_that_they_are_taken_for() -> None:
    """Of what is installed here, its own records tell."""
    known = packages_distributions()
    for module in {each.module.partition(".")[0] for each in ASKED}:
        if module in known:
            assert named(library(module)) in {named(name) for name in known[module]}


@pytest.mark.parametrize("name", BRINGS)
def test_what_libraries_bring(name: str) -> None:
    try:
        own = requires(name) or []
    except PackageNotFoundError:
        pytest.skip(f"{name} is not installed")
    assert BRINGS[name] <= {named(each) for each in own if "extra ==" not in each}


def test_nothing_is_imported_that_no_line_names() -> None:
    """A file imports NumPy, what it asked for by ``require``, and the command line what its extra brings."""
    of_all = {named(each) for each in PROJECT["dependencies"]}
    strangers = []
    for path in FILES:
        inside = path.relative_to(PACKAGE).as_posix()
        known = of_all | {named(library(each.module)) for each in asked(path)}
        known |= GIVEN.get(inside, set())
        known |= brought_by("cli") if inside.startswith("cli/") else set()
        for module, line in imports(path):
            top = module.partition(".")[0]
            if top not in (*sys.stdlib_module_names, "polhode") and named(library(module)) not in known:
                strangers.append(f"{inside}:{line} {module}")
    assert strangers == []


def test_lines_in_words_name_extras_that_are_there() -> None:
    """In all that ships or is read: code, pages, notebooks, the README, the core."""
    folders = (PACKAGE, ROOT / "docs", ROOT / "rust", ROOT / "examples", ROOT / "packaging")
    endings = {".py", ".pyi", ".md", ".toml", ".js", ".html", ".ipynb", ".rs"}
    pages = [path for folder in folders for path in folder.rglob("*") if path.suffix in endings]
    lines = 0
    for path in (*pages, *ROOT.glob("*.md")):
        for found in LINE.finditer(path.read_text("utf-8")):
            if "{" in found[1]:  # put together from what was asked for
                continue
            lines += 1
            assert {name.strip() for name in found[1].split(",")} <= set(EXTRAS), f"{path}: {found[0]}"
    assert lines >= 4


def test_lines_in_words_name_what_their_file_needs() -> None:
    """The extra brings something that the file, or one that it imports from, asks for or imports."""
    seen = set()
    for path in FILES:
        text = path.read_text("utf-8")
        homes = [path]
        for module, _ in imports(path):
            if module.startswith("polhode."):
                home = PACKAGE.joinpath(*module.split(".")[1:])
                homes += [each for each in (home.with_suffix(".py"), home / "__init__.py") if each.is_file()]
        needed = {named(library(each.module)) for home in homes for each in asked(home)}
        needed |= {named(library(module)) for home in homes for module, _ in imports(home)}
        for found in LINE.finditer(text):
            if "{" not in found[1]:
                seen.add(found[1])
                assert brought_by(found[1]) & needed, f"{path}: {found[0]}"
    assert seen >= {"cli", "union", "film"}


def test_the_readme_lists_every_extra() -> None:
    rows = re.findall(r"^\| `(\w+)` \|", (ROOT / "README.md").read_text("utf-8"), re.MULTILINE)
    assert set(EXTRAS) <= set(rows)
