"""Who judges the links of a robot: polhode, the laws, MuJoCo, Pinocchio; and what they say together."""

from __future__ import annotations

import time
from collections import Counter
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any

FAILING = frozenset({"missing", "placeholder", "impossible", "unreadable"})


@dataclass
class Judged:
    """What a judge made of a file: words of links, or why it is unread."""

    links: list[tuple[str, str, str]] = field(default_factory=list)  # name, word, rule
    unread: str = ""
    by: str = ""
    seconds: float = 0.0
    failing: frozenset[str] = FAILING


def named(name: str, place: int) -> str:
    """Return the name of a link without those of the models around it; bodies without one are counted."""
    return f"#{place}" if name.startswith("(body of ") else name.split("::")[-1]


@cache
def sourced(folder: Path) -> tuple[Path, ...]:
    """Return the folders that hold packages, as in a workspace whose setup was sourced."""
    marks = (path for mark in ("package.xml", "manifest.xml", "model.config") for path in folder.rglob(mark))
    return tuple(sorted({path.parent.parent for path in marks if path.parent != folder}))


def by_ours(path: Path, folder: Path) -> Judged:
    """Judge by polhode."""
    from polhode import robots
    from polhode.errors import PolhodeError

    packages = sourced(folder)
    start = time.process_time()
    try:
        verdicts = robots.check(robots.read_robot(path, packages), packages)
    except (PolhodeError, OSError) as error:
        return Judged(unread=str(error).replace(str(folder), ""), seconds=time.process_time() - start)
    taken = time.process_time() - start
    own = [v for v in verdicts if path.suffix == ".xml" or not (v.file or v.name.startswith("(include"))]
    return Judged(
        [(named(v.name, i), v.verdict, v.reason) for i, v in enumerate(own, 1)],
        by="ours",
        seconds=taken,
        failing=robots.FAILURES,
    )


_meshes: dict[Path, Any] = {}


def by_law(path: Path, folder: Path) -> Judged:
    """Judge by the laws, what the joints move and the room of the shapes; of MJCF as MuJoCo reads it."""
    import robots_engines as engines
    import robots_files as files
    import robots_law as law

    if path.suffix == ".xml":
        said, unread = engines.mjcf(path)
        return Judged(unique(said), unread, "law mujoco")
    if folder not in _meshes:
        _meshes.clear()
        files.mesh_of.cache_clear()
        _meshes[folder] = files.Meshes(folder)
    robot = files.read(path, _meshes[folder])
    said = [
        (link.name.split("::")[-1], *one) for link, one in zip(robot.links, law.judged(robot), strict=True)
    ]
    return Judged(unique(said), by="law")


def by_mujoco(path: Path, folder: Path) -> Judged:
    """Judge by MuJoCo's errors about mass and inertia."""
    import robots_engines as engines

    if path.suffix == ".xml":
        return by_law(path, folder)
    refused = engines.refused_by_mujoco(path)
    unread = refused.pop("", "")
    return Judged([(name, "impossible", words) for name, words in refused.items()], unread, "mujoco")


def by_pinocchio(path: Path, _: Path) -> Judged:
    """Judge by the diagonal of Pinocchio's mass matrix."""
    import robots_engines as engines

    idle, is_singular = engines.idle_in_pinocchio(path)
    said = [(name, "missing", "moved without inertia") for name in idle]
    return Judged(said or ([("", "singular", "mass matrix")] if is_singular else []), by="pinocchio")


JUDGES = {"ours": by_ours, "law": by_law, "mujoco": by_mujoco, "pinocchio": by_pinocchio}


def ask(judge: str, path: Path, folder: Path) -> Judged:
    """Ask a judge, who may fail on the file."""
    try:
        return JUDGES[judge](path, folder)
    except Exception as error:  # what breaks a judge is its answer
        return Judged(unread=f"{type(error).__name__}: {error}".splitlines()[0])


def unique(said: list[tuple[str, str, str]]) -> list[tuple[str, str, str]]:
    """Number the links that share a name."""
    count: Counter[str] = Counter()
    found = []
    for name, word, rule in said:
        count[name] += 1
        found.append((name if count[name] == 1 else f"{name}#{count[name]}", word, rule))
    return found


def expectation(path: Path, folder: Path) -> Judged:
    """Put together what the judges but ours say."""
    law = ask("law", path, folder)
    if path.suffix != ".urdf" or law.unread:
        return law
    others = {name: ask(name, path, folder) for name in ("mujoco", "pinocchio")}
    heard = [name for name, judged in others.items() if not judged.unread]
    links = []
    for name, word, rule in law.links:
        also = [n for n in heard if any(name == each for each, _, _ in others[n].links)]
        if also and word not in FAILING:
            # Whatever hangs below: a joint moves no inertia. MuJoCo alone also refuses what carries mass.
            word, rule = ("missing" if "pinocchio" in also else "disputed"), " ".join(also)
        elif word in FAILING:
            rule = " ".join([rule, *also])
        links.append((name, word, rule))
    return Judged(links, by=" ".join([law.by, *heard]))
