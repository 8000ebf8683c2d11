"""Draw mutants, run tests on them, print the score: see the package's first lines."""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tomllib
from collections import defaultdict
from datetime import UTC, datetime
from pathlib import Path

from quick import tests_of

from mutants import build, draw
from mutants.draw import HERE, Mutant

RECORD = build.TARGET / "mutants.jsonl"
RUN = """\
A mutant of the core meets the unit tests of its modules; then those that live, and those of bindings and
package, meet the tests in Python that are named like their files, of 1.5 s at most and for a minute each.
What was killed once is not run again."""


def recorded() -> dict[str, str]:
    """What killed each dead mutant, by its key. A test that was begun on it and did not end has."""
    dead, begun = {}, {}
    for line in RECORD.read_text(encoding="utf-8").splitlines() if RECORD.exists() else []:
        row = json.loads(line)
        if "begun" in row:
            begun[row["key"]] = row["begun"]
        else:
            begun.pop(row["key"], None)
        if row.get("killed"):
            dead[row["key"]] = row["killed"]
    return dead | {key: f"{test} (did not end)" for key, test in begun.items()}


def met() -> dict[str, int]:
    """How many tests in Python each mutant has met that did not kill it."""
    tests: dict[str, set[str]] = defaultdict(set)
    for line in RECORD.read_text(encoding="utf-8").splitlines() if RECORD.exists() else []:
        row = json.loads(line)
        if "ended" in row and not row.get("killed"):
            tests[row["key"]].add(row["ended"])
    return {key: len(names) for key, names in tests.items()}


def note(key: str, killed: str | None) -> None:
    """Add a line to the record."""
    with RECORD.open("a", encoding="utf-8") as file:
        file.write(json.dumps({"key": key, "killed": killed}) + "\n")


def rooms_of(mutant: Mutant) -> list[str]:
    """The modules that a mutant of the core lies in, the narrowest first: their tests are the nearest."""
    parts = list(Path(mutant.file).relative_to("rust/core/src").with_suffix("").parts)
    parts = parts[:-1] if parts[-1] == "mod" else parts
    return ["::".join(parts[:depth]) for depth in range(len(parts), 0, -1)][:2]


def by_cargo(living: dict[int, Mutant], programs: list[Path], most: float, *, near: bool) -> None:
    """The tests of its rooms, or all of the core, on each mutant; one that takes too long has found it."""
    for number, mutant in living.items():
        killed = None
        words = (
            [[str(programs[0]), "-q", room] for room in rooms_of(mutant)]
            if near
            else [[str(program), "-q"] for program in programs]
        )
        for command in words:
            environment = {**os.environ, "POLHODE_MUTANT": str(number)}
            core = build.TREE / "rust" / "core"
            name = Path(command[0]).stem.rsplit("-", 1)[0]
            try:
                told = subprocess.run(
                    command, cwd=core, env=environment, capture_output=True, timeout=most, check=False
                )
            except subprocess.TimeoutExpired:
                killed = f"{name} (did not end)"
                break
            if told.returncode:
                failed = [line for line in told.stdout.decode().splitlines() if line.startswith("    ")]
                killed = f"{name}: {failed[-1].strip() if failed else 'crash'}"
                break
        note(mutant.key, killed)
        print(f"{mutant.what}: {killed or 'lives'}", flush=True)


def by_pytest(living: dict[int, Mutant], tests: list[str], seconds: float, longest: float) -> None:
    """Tests of the package on all mutants, one process after the other as long as one dies of a mutant."""
    task = build.TARGET / "mutants.json"
    while True:
        dead = recorded()
        left = {number: mutant.key for number, mutant in living.items() if mutant.key not in dead}
        task.write_text(
            json.dumps({"living": left, "seconds": seconds, "longest": longest, "record": str(RECORD)}),
            encoding="utf-8",
        )
        command = [sys.executable, "-m", "pytest", "-q", "-p", "mutants.in_pytest", "-p", "no:cacheprovider"]
        command += ["-m", "not long and not alone", "-o", "timeout=0", *tests]
        python = os.pathsep.join([str(build.TREE / "python"), str(build.TREE / "tests")])
        told = subprocess.run(
            command,
            cwd=build.TREE,
            env={**os.environ, "PYTHONPATH": python, "POLHODE_MUTANTS": str(task)},
            check=False,
        )
        if told.returncode in (0, 1, 5):
            return
        if told.returncode in (2, 3, 4):  # it was stopped, or could not begin: no mutant's doing
            raise SystemExit(f"pytest ended with {told.returncode}")
        print(f"pytest ended with {told.returncode}; on without those that are dead", flush=True)


def by_text(mutants: list[Mutant]) -> None:
    """Mutants of the package, one after the other in the copy, each with the tests of its row."""
    for mutant in mutants:
        file = build.TREE / mutant.file
        data, source = file.read_bytes(), (draw.ROOT / mutant.file).read_bytes()
        try:
            file.write_bytes(source[: mutant.start] + mutant.text.encode() + source[mutant.end :])
            command = [
                sys.executable,
                "-m",
                "pytest",
                "-q",
                "-x",
                "-p",
                "no:cacheprovider",
                *(f"tests/{name}" for name in mutant.tests),
            ]
            environment = {**os.environ, "PYTHONPATH": str(build.TREE / "python")}
            told = subprocess.run(
                command, cwd=build.TREE, env=environment, capture_output=True, text=True, check=False
            )
        finally:
            file.write_bytes(data)
        killed = next((line for line in told.stdout.splitlines() if line.startswith("FAILED")), None)
        note(mutant.key, killed)
        print(f"{mutant.key}: {killed or 'lives'}", flush=True)


def unkilled(count: int) -> str:
    """What is told of a mutant that lives without a reason that is known."""
    if count == 0:
        return "no test has met it: those that were run do not reach it."
    return f"it has met {count} test{'s' if count > 1 else ''}; none kills it."


def score(mutants: list[Mutant], seed: int) -> None:
    """Print which are not dead; write how many are into the table, by part and kind, and those that live."""
    told = tomllib.loads((HERE / "equivalent.toml").read_text(encoding="utf-8"))
    same = {row["key"] for row in told["mutant"]}
    reasons = {row["key"]: row["why"] for row in [*told["mutant"], *told["living"]]}
    dead = recorded()
    groups: dict[tuple[str, str], list[Mutant]] = defaultdict(list)
    for mutant in mutants:
        groups[mutant.part, mutant.kind].append(mutant)
        groups[mutant.part, "all"].append(mutant)
        groups["all", "all"].append(mutant)
    order = ["named", *draw.PARTS, "all"]
    rows = []
    for (part, kind), ones in sorted(
        groups.items(), key=lambda row: (order.index(row[0][0]), row[0][1] == "all")
    ):
        if (part, kind) == ("named", "named"):
            continue
        killed = sum(one.key in dead for one in ones)
        alike = sum(one.key in same and one.key not in dead for one in ones)
        rows.append(f"| {part} | {kind} | {killed} | {alike} | {len(ones) - killed - alike} | {len(ones)} |")
    tests = met()
    living = [
        f"- `{mutant.key}` `{mutant.what}`: {reasons.get(mutant.key) or unkilled(tests.get(mutant.key, 0))}"
        for mutant in mutants
        if mutant.key not in dead
    ]
    head = (
        f"Mutants on {datetime.now(UTC):%Y-%m-%d}, drawn with seed {seed}; `make mutants` writes this table."
    )
    columns = ["| part | kind | killed | equivalent | neither so far | all |", "|---|---|---|---|---|---|"]
    core = [mutant for mutant in mutants if mutant.part == "core"]
    killed = sum(mutant.key in dead for mutant in core)
    alike = sum(mutant.key in same and mutant.key not in dead for mutant in core)
    share = (
        f"Killed of those of the core that are not equivalent: {killed} of {len(core) - alike}, "
        f"{killed / max(len(core) - alike, 1):.1%}."
    )
    text = "\n".join([head, RUN, "", *columns, *rows, "", share, "", "Those that live:", "", *living, ""])
    print(text)
    (HERE / "score.md").write_text(text, encoding="utf-8")


def main() -> None:
    """Run what is not recorded yet."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--score", action="store_true", help="print the score of the record alone")
    parser.add_argument("--seconds", type=float, default=60.0, help="of tests in Python on one mutant")
    parser.add_argument("--longest", type=float, default=1.5, help="no test that takes more seconds")
    parser.add_argument("--only", choices=("text", "rooms", "pytest", "cargo"), help="this part alone")
    parser.add_argument(
        "tests", nargs="*", help="these tests in Python, instead of those of the mutants' names"
    )
    given = parser.parse_args()
    os.chdir(draw.ROOT)
    named = draw.named()
    drawn = [row for part, (_, count) in draw.PARTS.items() for row in draw.drawn(part, count, given.seed)]
    numbers = build.compiling(build.apart([mutant for mutant in [*named, *drawn] if not mutant.is_text]))
    if not given.score:
        programs = build.build()
        dead = recorded()
        living = {number: mutant for number, mutant in numbers.items() if mutant.key not in dead}
        if given.only in (None, "text"):
            by_text([mutant for mutant in named if mutant.is_text and mutant.key not in dead])
        near = {number: mutant for number, mutant in living.items() if mutant.file.startswith("rust/core/")}
        if given.only in (None, "rooms"):
            by_cargo(near, programs, 120.0, near=True)
        if given.only in (None, "pytest"):
            tests = given.tests or [
                test
                for mutant in living.values()
                for test in [f"tests/{name}" for name in mutant.tests]
                or map(str, tests_of(Path(mutant.file)))
            ]
            by_pytest(living, list(dict.fromkeys(tests)), given.seconds, given.longest)
        if given.only in (None, "cargo"):
            dead = recorded()
            left = {number: mutant for number, mutant in near.items() if mutant.key not in dead}
            by_cargo(left, programs, 300.0, near=False)
    score([*named, *(mutant for mutant in numbers.values() if mutant in drawn)], given.seed)


if __name__ == "__main__":
    main()
