"""Judge public robot files: ``python benchmarks/robots.py --mirrors FOLDER [--judge NAME] [OWNER/NAME ...]``.

``robots.toml`` lists the files and what is expected of their links; nothing of theirs is kept here. FOLDER
holds git repositories named ``owner+name`` or ``owner/name`` (a fork serves, if it has the commit);
``--fetch`` asks GitHub for those that are missing. Each is unpacked once into ``--scratch``. NAME is
``ours``, or who gave the expectations: ``law`` (ElementTree, NumPy, trimesh), ``mujoco``, ``pinocchio``;
these need ``pip install mujoco pin pycollada``. ``--processes 40`` also times ``polhode check`` as a process
on so many of the files, spread over the list. ``--renew`` writes into ``robots.toml`` what they say.
``--fixes`` asks the engines whether what they load they also load after ``--fix``.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
import time
from collections import Counter, defaultdict
from pathlib import Path

from robots_judges import FAILING, JUDGES, Judged, ask, expectation, sourced, unique
from robots_list import LIST, File, listed, written
from robots_mirrors import mirror, unpacked


def compare(file: File, judged: Judged) -> list[tuple[str, str, str, str, str]]:
    """Return kind, link, what was expected, by whom, and what was said with its reason."""
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


def count_fix(file: File, folder: Path, counts: Counter[str]) -> None:
    """Count the engines that load a file before --fix and after it, and print those that do not after it."""
    from robots_engines import lost_by_fix

    path = folder / file.path
    if path.suffix not in (".urdf", ".xml"):
        return
    counts["files"] += 1
    try:
        loaded, lost = lost_by_fix(path, sourced(folder))
    except (ValueError, OSError) as error:
        print(f"unread: {file.repository}: {file.path}: {error}")
        counts["unread"] += 1
        return
    counts["loaded before, by one engine"] += loaded
    counts["lost by --fix"] += len(lost)
    for why in lost:
        print(f"lost: {file.repository}: {file.path}: {why}")


def renewed(file: File, path: Path, folder: Path) -> File | None:
    """Return a row with what the judges say now; None where they cannot read the file."""
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
    parser.add_argument("--fixes", action="store_true", help="load the files before and after --fix")
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
        if options.fixes:
            count_fix(file, folder, counts)
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
                [sys.executable, "-m", "polhode", "check", path],
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
