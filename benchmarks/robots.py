"""Judge public robot files: ``python benchmarks/robots.py --mirrors FOLDER [--judge NAME] [OWNER/NAME ...]``.

``robots.toml`` lists the files and what is expected of their links; nothing of theirs is kept here. FOLDER
holds git repositories named ``owner+name`` or ``owner/name`` (a fork serves, if it has the commit);
``--fetch`` asks GitHub for those that are missing. Each is unpacked once into ``--scratch``. NAME is
``ours``, or who gave the expectations: ``law`` (ElementTree, NumPy, trimesh), ``mujoco``, ``pinocchio``;
these need ``pip install mujoco pin pycollada``. ``--processes 40`` also times ``polhode check`` as a process
on so many of the files, spread over the list. ``--renew`` writes into ``robots.toml`` what they say.
"""

from __future__ import annotations

import argparse
import os
import shutil
import subprocess
import sys
import tempfile
import time
import tomllib
from collections import Counter, defaultdict
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any

LIST = Path(__file__).with_name("robots.toml")
FAILING = frozenset({"missing", "placeholder", "impossible", "unreadable"})
PARTS = frozenset(
    f".{end}"
    for end in "urdf sdf world xml config stl obj mtl dae ply msh gltf glb bin skn png jpg jpeg".split()  # noqa: SIM905
)


@dataclass
class File:
    """A row: a file at a commit, and those of its links that are not expected to be good."""

    repository: str
    commit: str
    licence: str
    path: str
    links: int = 0
    by: str = ""
    words: dict[str, dict[str, list[str]]] = field(default_factory=dict)  # word, judges, links

    def expected(self, name: str) -> tuple[str, str]:
        """Give what is expected of a link, and by whom."""
        found = ((w, by) for w, said in self.words.items() for by, names in said.items() if name in names)
        return next(found, ("good", self.by))


@dataclass
class Judged:
    """What a judge made of a file: words of links, or why it is unread."""

    links: list[tuple[str, str, str]] = field(default_factory=list)  # name, word, rule
    unread: str = ""
    by: str = ""
    seconds: float = 0.0
    failing: frozenset[str] = FAILING


def listed() -> list[File]:
    """Read the list."""
    table = tomllib.loads(LIST.read_text(encoding="utf-8"))
    return [
        File(
            r["name"], r["commit"], r["licence"], row.pop("path"), row.pop("links", 0), row.pop("by", ""), row
        )
        for r in table["repository"]
        for row in r["files"]
    ]


# --- files ----------------------------------------------------------------------------------------


def mirror(folder: Path, repository: str, commit: str, may_fetch: bool) -> Path | None:
    """Find the repository that has a commit, or fetch it."""
    owner, name = repository.split("/")
    named = [folder / f"{owner}+{name}", folder / owner / name, *sorted(folder.glob(f"*+{name}"))]
    for top in named:
        for git in (top / "repo" / ".git", top / "repo", top / ".git", top, top.with_name(f"{top.name}.git")):
            if (git / "HEAD").is_file() and not _git(
                git, "cat-file", "-e", f"{commit}^{{commit}}"
            ).returncode:
                return git
    if not may_fetch:
        return None
    git = named[0]
    subprocess.run(["git", "init", "--quiet", "--bare", git], check=True)
    address = f"https://github.com/{repository}"
    return None if _git(git, "fetch", "--quiet", "--depth=1", address, commit).returncode else git


def _git(git: Path, *words: str) -> subprocess.CompletedProcess[bytes]:
    return subprocess.run(["git", "--git-dir", git, *words], capture_output=True, check=False)


def unpacked(git: Path, repository: str, commit: str, scratch: Path) -> Path:
    """Write the parts of robots at a commit into a folder, as in a clone; what a mirror lacks stays out."""
    folder = scratch / f"{repository.replace('/', '+')}@{commit[:12]}" / repository.split("/")[1]
    if folder.exists():
        return folder
    half = folder.with_name(f"{folder.name}.half")
    shutil.rmtree(half, ignore_errors=True)
    (half / ".git").mkdir(parents=True)
    tree = _git(git, "ls-tree", "-r", "-z", commit).stdout.decode(errors="replace")
    entries = [(*line.split("\t")[0].split(), line.split("\t")[1]) for line in tree.split("\0") if line]
    wanted = [e for e in entries if e[0] == "120000" or Path(e[3]).suffix.lower() in PARTS]
    with tempfile.TemporaryFile() as names:
        names.write("".join(f"{blob}\n" for _, _, blob, _ in wanted).encode())
        names.seek(0)
        command = ["git", "--git-dir", git, "cat-file", "--batch"]
        with subprocess.Popen(
            command, stdin=names, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL
        ) as batch:
            assert batch.stdout is not None  # it is a pipe
            for mode, _, _, name in wanted:
                told = batch.stdout.readline().split()
                if len(told) < 3:
                    continue
                content = batch.stdout.read(int(told[2]) + 1)[:-1]
                path = half / name
                path.parent.mkdir(parents=True, exist_ok=True)
                if mode == "120000":
                    path.symlink_to(content.decode())
                else:
                    path.write_bytes(content)
    return half.rename(folder)


# --- judges ---------------------------------------------------------------------------------------


def named(name: str, place: int) -> str:
    """Give the name of a link without those of the models around it; bodies without one are counted."""
    return f"#{place}" if name.startswith("(body of ") else name.split("::")[-1]


@cache
def sourced(folder: Path) -> tuple[Path, ...]:
    """Give the folders that hold packages, as in a workspace whose setup was sourced."""
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


# --- what comes out -------------------------------------------------------------------------------


def compare(file: File, judged: Judged) -> list[tuple[str, str, str, str, str]]:
    """Give kind, link, what was expected, by whom, and what was said with its reason."""
    if judged.unread:
        return [("unread", "", "", "", judged.unread)]
    told = {name for name, _, _ in unique(judged.links)}
    if judged.by in ("mujoco", "pinocchio"):  # they tell only what they refuse
        refused = [(name, file.expected(name), f"{word}: {why}") for name, word, why in judged.links]
        return [("refused", name, *told, said) for name, told, said in refused if told[0] not in FAILING]
    if len(judged.links) != file.links and not file.path.endswith(".xml"):
        return [("other links", "", str(file.links), file.by, str(len(judged.links)))]
    found = [
        ("not judged", name, word, by, "")  # bodies of <replicate>, <composite> and <flexcomp>
        for word, said in file.words.items()
        for by, names in said.items()
        for name in names
        if word in FAILING and name not in told
    ]
    for name, word, reason in unique(judged.links):
        expected, by = file.expected(name)
        fails, should = word in judged.failing, expected in FAILING
        said = f"{word}: {reason}"
        if expected == "disputed":
            continue
        if should and not fails:
            found.append(("false good", name, expected, by, said))
        elif fails and not should:
            found.append(("false alarm", name, expected, by, said))
        elif (word == "suspect") != (expected == "suspect") and not fails:
            found.append(("other word", name, expected, by, said))
    return found


def written(files: list[File]) -> str:
    """Give the list as it stands in its file."""
    rows = defaultdict(list)
    for file in files:
        rows[file.repository, file.commit, file.licence].append(file)
    lines = [LIST.read_text(encoding="utf-8").split("\n[[", 1)[0].rstrip()]
    for (repository, commit, licence), held in rows.items():
        lines += [
            "",
            "[[repository]]",
            f'name = "{repository}"',
            f'commit = "{commit}"',
            f'licence = "{licence}"',
            "files = [",
        ]
        for file in held:
            said = [
                f"{w} = {{ {', '.join(f'{by!r} = {names}' for by, names in d.items())} }}"
                for w, d in file.words.items()
            ]
            parts = [f"path = {file.path!r}", f"links = {file.links}", f"by = {file.by!r}", *said]
            lines.append(f"  {{ {', '.join(parts)} }},".replace("'", '"'))
        lines.append("]")
    return "\n".join(lines) + "\n"


def renewed(file: File, path: Path, folder: Path) -> File | None:
    """Give a row with what the judges say now; None where they cannot read the file."""
    judged = expectation(path, folder)
    if judged.unread or not judged.links:
        print(f"left out: {file.repository}: {file.path}: {judged.unread or 'no links'}")
        return None
    words: dict[str, dict[str, list[str]]] = defaultdict(lambda: defaultdict(list))
    for name, word, rule in judged.links:
        if word != "good":
            words[word][rule].append(name)
    return File(file.repository, file.commit, file.licence, file.path, len(judged.links), judged.by, words)


def main() -> None:
    """Fetch, judge and count."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("names", nargs="*", metavar="OWNER/NAME", help="repositories; all of them by default")
    parser.add_argument("--mirrors", type=Path, required=True, metavar="FOLDER")
    parser.add_argument("--fetch", action="store_true", help="get what is missing from GitHub")
    parser.add_argument("--scratch", type=Path, default=Path(tempfile.gettempdir()) / "polhode-robots")
    parser.add_argument("--judge", choices=JUDGES, default="ours")
    parser.add_argument("--processes", type=int, default=0, metavar="N", help="time N files as processes")
    parser.add_argument("--renew", action="store_true", help="write what the judges say into robots.toml")
    options = parser.parse_args()
    options.mirrors, options.scratch = options.mirrors.resolve(), options.scratch.resolve()
    options.scratch.mkdir(parents=True, exist_ok=True)
    os.chdir(options.scratch)  # where MuJoCo leaves its log
    counts: Counter[str] = Counter()
    seconds, rows, paths = [], [], []
    for file in listed():
        if options.names and file.repository not in options.names:
            rows.append(file)
            continue
        git = mirror(options.mirrors, file.repository, file.commit, options.fetch)
        if git is None:
            counts["absent"] += 1
            rows.append(file)
            print(f"absent: {file.repository}@{file.commit[:12]}: {file.path}")
            continue
        folder = unpacked(git, file.repository, file.commit, options.scratch)
        if options.renew:
            rows += filter(None, [renewed(file, folder / file.path, folder)])
            continue
        judged = ask(options.judge, folder / file.path, folder)
        paths.append(folder / file.path)
        seconds.append((judged.seconds, f"{file.repository}: {file.path}"))
        counts["files"] += 1
        counts["links"] += len(judged.links)
        differing = compare(file, judged)
        counts.update({f"files with {kind}" for kind, *_ in differing if kind != "unread"})
        counts.update(kind for kind, *_ in differing)
        for kind, link, expected, by, said in differing:
            print(f"{kind}: {file.repository}: {file.path}: {link}: {expected} by {by}; {said}")
    if options.renew:
        LIST.write_text(written(rows), encoding="utf-8")
        return
    print("\n".join(f"{count:7d}  {kind}" for kind, count in sorted(counts.items())))
    if seconds:
        worst, name = max(seconds)
        middle = sorted(seconds)[len(seconds) // 2][0]
        print(f"CPU: median {middle * 1e3:.0f} ms, worst {worst:.2f} s, {name}")
    if options.processes and paths:
        print_processes(paths[:: max(1, len(paths) // options.processes)])


def print_processes(paths: list[Path]) -> None:
    """Time `polhode check` as a process on each file: the better of two runs, of modules compiled before."""
    # As installed: pip compiles modules, PYTHONDONTWRITEBYTECODE would compile them in each run.
    env = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    rows = []
    for path in paths:
        runs = []
        for _ in range(2):
            start, before = time.perf_counter(), os.times()
            done = subprocess.run(
                [sys.executable, "-m", "polhode.cli", "check", path],
                capture_output=True,
                check=False,
                env=env,
            )
            wall, after = time.perf_counter() - start, os.times()
            cpu = sum(after[2:4]) - sum(before[2:4])  # of children: the load of the machine is not in it
            runs.append((wall, cpu))
            if done.returncode not in (0, 1, 2) or b"No module named" in done.stderr:
                raise SystemExit(f"{path}: {done.stderr.decode(errors='replace')}")
        rows.append((*map(min, zip(*runs, strict=True)), path.name))
    for name, column in (("wall", 0), ("CPU", 1)):
        taken = sorted((row[column], row[2]) for row in rows)
        within = sum(seconds <= 0.6 for seconds, _ in taken)
        print(
            f"processes, {name}: median {taken[len(taken) // 2][0]:.2f} s, {within} of {len(taken)} within "
            f"0.6 s, worst {taken[-1][0]:.2f} s, {taken[-1][1]}"
        )


if __name__ == "__main__":
    main()
