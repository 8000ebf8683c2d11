"""What the sources of a release have beside those of the repository: absolute links, addresses, licences.

Their distribution holds all files of the repository, so that it tests itself. The address of the project
stands in ``Cargo.toml`` as ``repository``, and nowhere else.
"""

from __future__ import annotations

import json
import os
import re
import subprocess
import tomllib
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
THIRD_PARTY = "LICENSE-THIRD-PARTY"
#: What a source distribution holds besides what is compiled, when it is made in a checkout.
SOME = 'include = [{ path = "LICENSE-*", format = "sdist" }]'
#: A link within the repository, as Markdown writes it; also of a picture.
LINK = re.compile(r"(!?)\[((?:[^][]|\[[^][]*\])*)\]\((?!\w+:|#)([^)\s]+)\)")


def manifest() -> dict[str, Any]:
    """``Cargo.toml`` of the workspace: its package."""
    package: dict[str, Any] = tomllib.loads((ROOT / "Cargo.toml").read_text("utf-8"))["workspace"]["package"]
    return package


def address() -> str:
    """The address of the project."""
    return str(manifest()["repository"])


def addresses() -> dict[str, str]:
    """The addresses that a package index shows."""
    home = address()
    return {
        "Repository": home,
        "Documentation": f"{home}/blob/v{manifest()['version']}/docs/index.md",
        "Changelog": f"{home}/blob/v{manifest()['version']}/CHANGELOG.md",
        "Issues": f"{home}/issues",
    }


def absolute(text: str) -> str:
    """Markdown of the root of the repository, its links as they lead from anywhere."""
    tag = f"v{manifest()['version']}"

    def lead(found: re.Match[str]) -> str:
        is_picture, words, target = found.groups()
        kind = "raw" if is_picture else "tree" if (ROOT / target.split("#")[0]).is_dir() else "blob"
        return f"{is_picture}[{words}]({address()}/{kind}/{tag}/{target})"

    return LINK.sub(lead, text)


def dressed(sources: Path) -> None:
    """Make the copy of the repository one that leads and tells everywhere."""
    readme = sources / "README.md"
    readme.write_text(absolute(readme.read_text("utf-8")), "utf-8")
    (sources / THIRD_PARTY).write_text(third_party(), "utf-8")
    project = sources / "pyproject.toml"
    lines = "".join(f'{name} = "{target}"\n' for name, target in addresses().items())
    text = project.read_text("utf-8").replace(
        "[project.scripts]", f"[project.urls]\n{lines}\n[project.scripts]"
    )
    text = text.replace('"LICENSE-APACHE"]', f'"LICENSE-APACHE", "{THIRD_PARTY}"]')
    text = text.replace(SOME, f"include = [\n{everything(sources)}]")
    own = str(manifest()["license"])
    text = text.replace(f'\nlicense = "{own}"', f'\nlicense = "{expression(own, linked())}"')
    project.write_text(text, "utf-8")


def everything(sources: Path) -> str:
    """All files of the copy, as maturin is told what else a source distribution holds."""
    names = (path.name if path.is_file() else f"{path.name}/**/*" for path in sorted(sources.iterdir()))
    return "".join(f'    {{ path = "{name}", format = "sdist" }},\n' for name in names)


def linked() -> list[dict[str, Any]]:
    """The crates that are compiled into the extension on some system, by name and version."""
    calm = {**os.environ, "CARGO_TERM_COLOR": "never"}
    tree = ["cargo", "tree", "--locked", "--package", "polhode-python", "--edges", "normal,no-proc-macro"]
    tree += ["--target", "all", "--prefix", "none", "--format", "{p}"]
    told = subprocess.check_output(tree, cwd=ROOT, env=calm, text=True)
    within = {tuple(line.split()[:2]) for line in told.splitlines()}
    metadata = ["cargo", "metadata", "--locked", "--format-version", "1"]
    packages = json.loads(subprocess.check_output(metadata, cwd=ROOT, env=calm))["packages"]
    crates = [each for each in packages if each["source"] and (each["name"], f"v{each['version']}") in within]
    return sorted(crates, key=lambda crate: (crate["name"], crate["version"]))


def expression(own: str, crates: list[dict[str, Any]]) -> str:
    """The licence of the package together with those of crates that leave no choice of its own."""
    choices = {tuple(sorted(re.split(r" OR |/", crate["license"]))) for crate in crates}
    others = sorted(" OR ".join(choice) for choice in choices if not set(own.split(" OR ")) <= set(choice))
    return " AND ".join([f"({own})", *(f"({other})" if " OR " in other else other for other in others)])


def third_party() -> str:
    """The licences of the crates that are compiled into the extension."""
    parts = [
        "The extension of polhode contains, besides its own code, the standard library of Rust\n"
        "(MIT OR Apache-2.0) and parts of these crates, on any system.\nTheir licences follow, each once.\n"
    ]
    texts: dict[str, list[str]] = {}
    for crate in linked():
        name = f"{crate['name']} {crate['version']} ({crate['license']})"
        files = sorted(
            file
            for file in Path(crate["manifest_path"]).parent.iterdir()
            if re.match(r"(LICEN[CS]E|COPYING|NOTICE|UNLICENSE)", file.name, re.IGNORECASE) and file.is_file()
        )
        parts.append(f"- {name}" + ("" if files else ", which ships no text of it"))
        for file in files:
            texts.setdefault(file.read_text("utf-8").strip(), []).append(f"{crate['name']}: {file.name}")
    rule = "=" * 80
    parts += [f"\n{rule}\n" + "\n".join(names) + f"\n{rule}\n\n{text}" for text, names in texts.items()]
    return "\n".join(parts) + "\n"


if __name__ == "__main__":  # for a channel whose sources are a checkout
    (ROOT / THIRD_PARTY).write_text(third_party(), "utf-8")
