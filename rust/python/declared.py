"""What Python declares of the functions that the extension has, written from the extension itself.

``python rust/python/declared.py`` writes for each function that makes a solid, a lamina, a rod or a load its
lines in the stubs and the names that its module of the package imports. A new one is declared in Rust alone:
name and arguments by its signature, their types by its docstring. ``--check`` writes nothing, and fails where
a file would change.
"""

from __future__ import annotations

import argparse
import inspect
import re
from pathlib import Path

from polhode import _core

ROOT = Path(__file__).resolve().parents[2]
RUST = ROOT / "rust" / "python" / "src"
PACKAGE = ROOT / "python" / "polhode"
STUBS = PACKAGE / "_core.pyi"
#: As the formatter breaks lines.
WIDTH = 110

#: Modules of the package, and where their functions are declared in Rust.
MODULES = {
    "loads": ["loads"],
    "solids": ["solids.rs"],
    "laminae": ["laminae.rs"],
    "rods": ["rods.rs"],
}
#: Classes beside the functions.
CLASSES = {"loads": ["Load"]}
#: Classes that functions return, by their module, or by their own name where it differs.
RETURNED = {"loads": "Load", "wheel": "Wheel"}

#: A function as an item of Rust, or as the macro of shapes declares it.
DECLARED = re.compile(
    r"#\[pyfunction\]\n(?P<attributes>(?:[ )]*#?\[?[^\n]*\n)*?)pub\(crate\) fn (?P<function>\w+)"
    r"|shape_function! \{\n(?P<lines>(?:    (?:///|#\[)[^\n]*\n)*)    (?P<shape>\w+)\("
)
NAME = re.compile(r'#\[pyo3\(name = "(\w+)"')

#: The words of docstrings for types, and what a type checker calls them.
WORDS = {
    "array_like": "ArrayLike",
    "rotation": "SupportsQuaternion",
    "Orbit": "Orbit",
    "SampledOrbit": "SampledOrbit",
    "DipoleField": "DipoleField",
    "Load": "Load",
    "float": "float",
    "int": "int",
    "str": "str",
    "bool": "bool",
    "object": "object",
}
#: What functions of Python are called with, which docstrings say in sentences.
CALLED = {
    "torque_callback": "Callable[[float, _Floats, _Floats], ArrayLike]",
    "callback": "Callable[[float, _Floats, _Floats, _Floats, _Floats], tuple[ArrayLike, ArrayLike]]",
    "with_states": "_WithStates",
    "thrusters": "_WithStates",
}


def names(module: str) -> list[str]:
    """List the functions of a module of the package, in the order of their declarations."""
    found = []
    for place in MODULES[module]:
        path = RUST / place
        for file in sorted(path.glob("*.rs")) if path.is_dir() else [path]:
            for one in DECLARED.finditer(file.read_text(encoding="utf-8")):
                given = NAME.search(one["attributes"] or one["lines"] or "")
                found.append(given[1] if given else one["function"] or one["shape"])
    return found


def documented(function: str) -> dict[str, str]:
    """Read the types of the parameters from the docstring, in words."""
    section = re.search(
        r"Parameters\n-+\n(.*?)\n\n\w+\n-+\n", inspect.getdoc(getattr(_core, function)) or "", re.DOTALL
    )
    types = {}
    for line in section[1].splitlines() if section else ():
        if one := re.match(r"(\w[\w, ]*) : (.+)", line):
            types |= dict.fromkeys(one[1].split(", "), one[2])
    return types


def typed(module: str, function: str, parameter: inspect.Parameter, words: str) -> str:
    """Return the type of a parameter."""
    if literal := re.match(r"\{(.+?)\}", words):
        kinds = [f"Literal[{literal[1]}]"]
    else:
        kinds = [WORDS[word] for word in re.findall(r"\w+", words) if word in WORDS]
        # Sizes, masses and densities may have sigmas; a count has none.
        if module != "loads" and "of int" not in words:
            kinds = ["_Numbers" if kind == "ArrayLike" else kind for kind in kinds]
    if "callable" in words:
        kinds.append(CALLED[function])
    if "object" in kinds:
        kinds = ["object"]
    if "ArrayLike" in kinds:
        kinds = [kind for kind in kinds if kind not in ("float", "int")]
    if "ArrayLike" in kinds and "SupportsQuaternion" in kinds:
        kinds = ["_Attitude", *(kind for kind in kinds if kind not in ("ArrayLike", "SupportsQuaternion"))]
    if not kinds:
        raise SystemExit(f"{function}: the type of {parameter.name} is not known from {words!r}")
    if parameter.default is None or "or None" in words:
        kinds.append("None")
    return " | ".join(dict.fromkeys(kinds))


def stub(module: str, function: str) -> str:
    """Write the lines of a function in the stubs."""
    types = documented(function)
    parts, keyword = [], False
    for parameter in inspect.signature(getattr(_core, function)).parameters.values():
        if parameter.kind is parameter.KEYWORD_ONLY and not keyword:
            parts.append("*")
            keyword = True
        words = types.get(parameter.name)
        if words is None:
            raise SystemExit(f"{function}: the docstring has no line for {parameter.name}")
        default = "" if parameter.default is parameter.empty else f" = {quoted(parameter.default)}"
        parts.append(f"{parameter.name}: {typed(module, function, parameter, words)}{default}")
    returned = RETURNED.get(function, RETURNED.get(module, "RigidBody"))
    line = f"def {function}({', '.join(parts)}) -> {returned}: ..."
    # A letter of the formula as the name of an argument needs a word to the linter.
    noted = [f"{part},{'  # noqa: N803' if part[0].isupper() else ''}" for part in parts]
    if len(line) <= WIDTH and noted == [f"{part}," for part in parts]:
        return line
    inner = f"    {', '.join(parts)}"
    if len(inner) <= WIDTH and noted == [f"{part}," for part in parts] and len(parts) > 1:
        return f"def {function}(\n{inner}\n) -> {returned}: ..."
    lines = "\n".join(f"    {part}" for part in noted)
    return f"def {function}(\n{lines}\n) -> {returned}: ..."


def quoted(value: object) -> str:
    """Write a default as it stands in the source."""
    return f'"{value}"' if isinstance(value, str) else repr(value)


def listed(before: str, entries: list[str], after: str) -> str:
    """Put entries between brackets, in one line where they fit."""
    line = f"{before}{', '.join(entries)}{after}"
    if len(line) <= WIDTH:
        return line
    lines = "\n".join(f"    {entry}," for entry in entries)
    return f"{before or '('}\n{lines}\n{after}"


def of_module(module: str, text: str) -> str:
    """Write the names that a module has now into the text of its file."""
    public = sorted([*CLASSES.get(module, ()), *names(module)])
    imported = f"from polhode._core import {', '.join(public)}"
    if len(imported) > WIDTH:
        imported = listed("from polhode._core import (", public, ")")
    every = listed("__all__ = [", [f'"{name}"' for name in public], "]")
    text = re.sub(
        r"^from polhode\._core import (?:\(.*?\)|[^\n(]*)",
        imported,
        text,
        count=1,
        flags=re.DOTALL | re.MULTILINE,
    )
    return re.sub(r"^__all__ = \[.*?\]", every, text, count=1, flags=re.DOTALL | re.MULTILINE)


def of_stubs(text: str) -> str:
    """Write the functions that the extension has now into the stubs; all else stays as it is."""
    for module in MODULES:
        every = "\n".join(stub(module, name) for name in names(module))
        begins, ends = f"# {module}: written by rust/python/declared.py\n", f"\n# end of {module}\n"
        before, rest = text.split(begins)
        text = f"{before}{begins}{every}\n{ends}{rest.split(ends)[1]}"
    public = ["__version__", *(name for name in dir(_core) if not name.startswith("_"))]
    every = listed("__all__ = [", [f'"{name}"' for name in sorted(public)], "]")
    return re.sub(r"^__all__ = \[.*?\]", lambda _: every, text, count=1, flags=re.DOTALL | re.MULTILINE)


def changed() -> dict[Path, str]:
    """Return the files that would change, and what would stand in them."""
    files = {STUBS: of_stubs(STUBS.read_text(encoding="utf-8"))}
    for module in MODULES:
        file = PACKAGE / f"{module}.py"
        files[file] = of_module(module, file.read_text(encoding="utf-8"))
    return {file: text for file, text in files.items() if text != file.read_text(encoding="utf-8")}


def main() -> None:
    """Write the files, or say which are not as they would be."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--check", action="store_true", help="write nothing; fail where a file would change")
    check = parser.parse_args().check
    files = changed()
    for file, text in files.items():
        print(f"{file.relative_to(ROOT)}: {'not as the extension is declared' if check else 'written'}")
        if not check:
            file.write_text(text, encoding="utf-8")
    if check and files:
        raise SystemExit("run python rust/python/declared.py")


if __name__ == "__main__":
    main()
