"""How commands are called and how they end: with an exit code, and after an error with one line on stderr."""

from __future__ import annotations

import re
import sys
from contextlib import suppress
from difflib import get_close_matches
from functools import cache, partial
from pathlib import Path
from typing import TYPE_CHECKING, Final

from cyclopts import CycloptsError, UnusedCliTokensError

from polhode.cli.app import GOOD, app
from polhode.cli.terminal import ClosedPipe, in_options, printable, standard_output
from polhode.io.budget import words_of

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from rich.console import Console

__all__ = ["run"]

CHAPTERS: Final = {
    "To begin": ("demo", "samples"),
    "One body": ("report", "spin", "roll", "molecule"),
    "Bodies of parts": ("assemble", "ledger", "check"),
    "Many motions": ("ensemble", "flyby"),
    "Motions of other programs": ("audit",),
    "Measurements": ("identify",),
    "This installation": ("validate",),
}
"""The commands, in the order in which somebody new needs them."""
COMMANDS: Final = tuple(name for names in CHAPTERS.values() for name in names)
WIDTH: Final = 80
"""Columns of the help, at most."""
BAD_INPUT: Final = 2
INTERRUPTED: Final = 130
OTHER_OPTIONS: Final = (
    ("--length-unit mm", "--unit --units --lunit --length-units"),
    ("--format json", "--json --output-format --fmt -f"),
    ("--format table", "--table --text"),
    ("--save FILE.csv", "--csv --export --write"),
    ("--save FILE.png", "--plot --png --picture --figure --image --draw"),
    ("--save FILE.html", "--animate --animation --html --movie --video --film"),
    ("--save FOLDER", "--output-dir --folder --dir"),
    ("--fix FILE", "--repair --correct --save --write --in-place -i"),
    ("--output FILE", "--out --outfile --output-file --to --save -o"),
    ("--save FILE", "--out --outfile --output --output-file -o"),
    ("--end TIME", "--until --time --tmax --t-max --t-end --duration --stop --length --T -t"),
    ("--span TIME", "--end --until --time --times --tmax --duration"),
    ("--times NUMBER", "--samples --steps --frames --dt --step --fps"),
    ("--n NUMBER", "--members --clones --samples --count --num --number --points --size -n"),
    ("--times NUMBER", "--points --num --number --n -n"),
    ("--axes principal", "--axis --frame --principal --principal-axes --body"),
    ("--degrees", "--deg --degree"),
    ("--omega", "--rate --rates --w --angular-velocity --angular-rate --spin --gyro"),
    ("--attitude", "--euler --euler-angles --quaternion --orientation --rotation --angles -q"),
    ("--gravity 9.81", "-g --g --weight"),
    ("--wheel", "--wheels --rotor --flywheel --momentum"),
    ("--moments", "--inertia --principal-moments --moment"),
    ("--inertia", "--tensor --inertia-tensor --moi"),
    ("--periods", "--period"),
    ("--center-of-mass", "--center --cog --centre --centre-of-mass --center-of-gravity"),
    ("--density", "--rho --material --densities"),
    ("--mass", "--weight -m"),
    ("--weld 1e-6", "--merge --tolerance --tol --merge-vertices"),
    ("--rtol 1e-10", "--tol --tolerance --precision --eps --accuracy"),
    ("--closure caps", "--close --fill --cap --fill-holes --watertight"),
    ("--orient", "--flip --fix-normals --normals --reorient"),
    ("--repair", "--heal --mend --fix"),
    ("--as urdf", "--urdf --sdf --mjcf --export --program --to"),
    ("--about", "--point --origin --reference"),
    ("--tilt 52deg", "--inclination --lean --angle"),
    ("--surface disk", "--shape --contact --disk --sphere --ball --coin"),
    ("--slope 10deg", "--incline"),
    ("--expect FILE", "--compare --diff --reference"),
    ("--packages FOLDER", "--package --package-path --package-dir --include -I"),
    ("--isotopes", "--isotope --deuterate --isotopologue"),
    ("--client ADDRESS", "--scheduler --cluster --dask"),
    ("--seed NUMBER", "--random-seed --rng"),
    ("--depth NUMBER", "--levels --level"),
    ("--all", "--every --full"),
    ("--index-base 0", "--zero-based --base"),
)  # fmt: skip
"""What to write, and the names under which people look for it; the first that a command has is meant."""
OTHER_COMMANDS: Final = (
    ("report FILE", "inertia mass properties massprops principal axes moments info tensor show read print"),
    ("report FILE --length-unit UNIT --as PROGRAM", "convert export"),
    ("report FILE --expect REPORT.json", "compare diff"),
    ("spin FILE", "motion rotate period periods tumble top"),
    ("spin FILE --end TIME --save FILE.csv", "simulate integrate run trajectory"),
    ("spin FILE --end TIME --save FILE.png", "plot draw picture"),
    ("spin FILE --end TIME --save FILE.html", "animate animation view movie"),
    ("roll --surface disk", "rolling coin disk ball wheel rattleback tippe-top contact plane"),
    ("check FILE", "robot urdf sdf mjcf verify fix .urdf .mjcf .xml"),
    ("assemble FILE", "assembly combine add box sphere cylinder solid solids"),
    ("molecule FILE", "rotor constants spectrum isotopes"),
    ("ensemble FILE", "monte-carlo montecarlo clones members sample"),
    ("ledger FILE", "sum rollup parts budget .csv .tsv"),
    ("identify LOG.csv --kind tumble", "fit estimate identification gyro log throw"),
    ("samples FOLDER", "examples data files"),
    ("demo", "tour tutorial example"),
    ("validate", "test selftest doctor"),
)
"""What to write, and the words and the endings of files with which people begin."""
REMARKS: Final = (
    ("polhode report OTHER --output REPORT.json writes the report of the other file", "compare diff"),
    (
        'a [[part]] of the file may be solid = "box"; in Python solids.box((x, y, z), mass=MASS) is one',
        "box",
    ),
    (
        'a [[part]] of the file may be solid = "cylinder"; in Python solids.cylinder(radius, height, '
        "density=DENSITY) is one",
        "cylinder sphere solid solids",
    ),
    (
        "a load acts in Python: body.simulate(t, omega, load=loads.damping(0.01))",
        "--damping --drag --torque --load --loads --force --friction",
    ),
)
"""What else there is to know, by the words and options with which people begin."""
COMPANIONS: Final = {"--inertia": {"--mass": "MASS"}}
"""Options without which another one is refused."""
WITHOUT_FILE: Final = ("--moments", "--inertia")
OPTION: Final = re.compile(r"--[A-Za-z][\w-]*|-[A-Za-z]")


def _version_in_full() -> None:
    """Print what a bug report needs."""
    from polhode.cli.validate import as_text

    print(as_text())


def overview() -> str:
    """List the commands, each with the first line of its docstring."""
    lines = ["Usage: polhode COMMAND [FILE] [OPTIONS]", "", app.help]
    for title, names in CHAPTERS.items():
        lines += ["", f"{title}:"]
        for name in names:
            document = app[name].default_command.__doc__ or ""
            lines.append(f"  {name:<10}{document.partition(chr(10))[0]}")
    lines += ["", "polhode COMMAND --help lists the options, with three examples."]
    lines += ["polhode --version --verbose prints what a bug report needs."]
    lines += ["Exit codes: 0 good, 1 the verdict is bad, 2 bad input."]
    return "\n".join(lines)


def unknown_command(arguments: list[str]) -> str | None:
    """Find a first word that is no command, and say which one is meant."""
    word = next(iter(arguments), "-")
    if word in COMMANDS or word.startswith("-"):
        return None
    meant = _row(OTHER_COMMANDS, word.lower())
    suffix = Path(word).suffix.lower()
    if meant is None and suffix:
        whole = _in_full(_row(OTHER_COMMANDS, suffix) or "report FILE", arguments)
        return f"{word}: a command stands before the file; did you mean polhode {whole}?"
    if meant is None:
        near = get_close_matches(word.lower(), COMMANDS, 1, 0.7)
        meant = next((there for there, _ in OTHER_COMMANDS if there.split()[0] in near), None)
    if meant is None:
        return f"{word}: there is no such command; choose one of {', '.join(COMMANDS)}"
    way_out = f"did you mean polhode {_in_full(meant, arguments[1:])}?"
    remarks = [f"({one})" for one in map(partial(_row, REMARKS), [word.lower(), *arguments[1:]]) if one]
    return " ".join([f"{word}: there is no such command;", way_out, *dict.fromkeys(remarks)])


def _row(table: Iterable[tuple[str, str]], word: str) -> str | None:
    """Return what to write instead of a word; None if the table does not have it."""
    return next((there for there, others in table if word in others.split()), None)


def _in_full(meant: str, words: list[str]) -> str:
    """Complete a command with the file and the options that were given, under the names that it has."""
    groups: list[list[str]] = [[]]
    for word in words:
        name, _, value = word.partition("=")
        if OPTION.fullmatch(name):
            groups.append([name, value] if value else [name])
        else:
            groups[-1].append(f'"{word}"' if " " in word else word)
    files, *options = groups
    command, *rest = meant.split()
    missing = {rest[at]: rest[at + 1] for at in range(len(rest) - 1) if rest[at].startswith("--")}
    file = [word for word in files[:1] if Path(word).suffix and "FILE" in rest]
    if not file and not any(name in WITHOUT_FILE for name, *_ in options):
        return meant
    known = _options(command)
    wanted = [row for row in OTHER_OPTIONS if row[0].split()[0] in missing]
    possible = [row for row in OTHER_OPTIONS if row[0].split()[0] in known]
    call = [command, *file]
    for name, *values in options:
        there = _row(wanted, name) or (name if name in known else _row(possible, name))
        if there is None:
            continue
        option = there.split()[0]
        call += [option, *values] if values else [there]
        missing.pop(option, None)
        missing |= COMPANIONS.get(option, {})
    given = {name for name, *_ in options}
    return " ".join([*call, *(f"{name} {value}" for name, value in missing.items() if name not in given)])


@cache
def _options(command: str) -> frozenset[str]:
    names = {name for one in app[command].assemble_argument_collection() for name in one.names}
    return frozenset(name for name in names if name.startswith("-"))


def unknown_option(arguments: list[str]) -> str | None:
    """Find an option that the command does not have, and say which one is meant."""
    command = next((word for word in arguments[:1] if word in COMMANDS), None)
    if command is None:
        return None
    known = _options(command) | {*app.help_flags, *app.version_flags}
    for word in arguments[1:]:
        name = word.partition("=")[0]
        if not OPTION.fullmatch(name) or name in known or Path(word).exists():
            continue
        meant = next(
            (
                there
                for there, others in OTHER_OPTIONS
                if there.split()[0] in known and name in others.split()
            ),
            next(iter(get_close_matches(name, sorted(known), 1, 0.7)), None),
        )
        elsewhere = [other for other in COMMANDS if name in _options(other)]
        way_out = _row(REMARKS, name) or f"choose one that it has (see polhode {command} --help)"
        if meant:
            way_out = f"did you mean {meant}?"
        elif elsewhere and name in WITHOUT_FILE:
            way_out = f"did you mean polhode {_in_full(elsewhere[0], arguments[1:])}?"
        elif elsewhere:
            way_out = f"did you mean polhode {elsewhere[0]}?"
        return f"{name}: {command} has no such option; {way_out}"
    return None


def run(arguments: list[str]) -> int:
    """Run one command and turn every foreseen error into one line and an exit code."""
    is_overview = arguments in ([], ["--help"], ["-h"])
    is_help = not is_overview and any(flag in arguments for flag in app.help_flags)
    command: Callable[[], object] = partial(
        app,
        [_as_value(argument) for argument in arguments],
        console=_console() if is_help else None,
        exit_on_error=False,
        print_error=False,
        result_action="return_value",
    )
    if is_overview:
        command = partial(print, overview())
    if sorted(arguments) == ["--verbose", "--version"]:
        command = _version_in_full
    unknown = unknown_command(arguments) or unknown_option(arguments)
    if unknown is not None:
        return _fail(unknown)
    try:
        with standard_output():
            code = command()
    except UnusedCliTokensError as error:
        rest = " ".join(error.unused_tokens or ())
        return _fail(
            f"{rest}: more than {arguments[0]} takes; give one file, and put quotes around words with spaces "
            f"(see polhode {arguments[0]} --help)"
        )
    except CycloptsError as error:
        return _fail(f"{error} (see polhode --help)")
    except ClosedPipe:
        return GOOD
    except OSError as error:
        return _fail(words_of(error))
    except MemoryError as error:
        return _fail(f"there is not enough memory ({error})")
    except (ValueError, ModuleNotFoundError) as error:
        return _fail(in_options(error))
    except KeyboardInterrupt:
        return _fail("interrupted", code=INTERRUPTED)
    return code if isinstance(code, int) else 0


def _console() -> Console:
    """Return a console that is no wider than people read."""
    from rich.console import Console

    console = Console()
    console.width = min(console.width, WIDTH)
    return console


def _as_value(argument: str) -> str:
    """Keep ``"-1 0 0 deg/s"`` from being taken for an option, and the file ``./-`` for standard input."""
    if argument == "./-":  # a path without its "./" would be "-"
        return str(Path.cwd() / "-")
    return f" {argument}" if re.match(r"-\.?\d", argument) else argument


def _fail(message: str, code: int = BAD_INPUT) -> int:
    if sys.stderr is not None:
        with suppress(OSError):  # nobody reads it: the exit code remains
            print("polhode:", printable(" ".join(message.split())), file=sys.stderr, flush=True)
    return code
