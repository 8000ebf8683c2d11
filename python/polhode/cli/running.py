"""How commands are called and how they end: with an exit code, and after an error with one line on stderr."""

from __future__ import annotations

import re
import sys
from contextlib import suppress
from difflib import get_close_matches
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Final

from cyclopts import CycloptsError, UnusedCliTokensError

from polhode.cli.app import GOOD, app
from polhode.cli.terminal import ReaderLeft, in_options, printable, standard_output
from polhode.io.reading import words_of

if TYPE_CHECKING:
    from collections.abc import Callable

__all__ = ["run"]

COMMANDS: Final = (
    "report", "check", "molecule", "spin", "flyby", "ensemble", "assemble", "ledger", "samples", "demo",
    "validate",
)  # fmt: skip
BAD_INPUT: Final = 2
INTERRUPTED: Final = 130
OTHER_OPTIONS: Final = (
    ("--length-unit mm", "--unit --units --lunit --length-units"),
    ("--format json", "--json --output-format --fmt -f"),
    ("--format table", "--table --text"),
    ("--save FILE.csv", "--csv --export --write"),
    ("--save FILE.png", "--plot --png --picture --figure --image --draw"),
    ("--picture FILE.png", "--plot --png --save --figure --image --draw"),
    ("--save FILE.html", "--animate --animation --html --movie --video --film"),
    ("--output FILE", "--out --outfile --output-file --to --save -o"),
    ("--save FILE", "--out --outfile --output --output-file -o"),
    ("--output-dir FOLDER", "--out --output --save -o"),
    ("--until TIME", "--time --times --end --tmax --t-max --t-end --duration --stop --length --T -t"),
    ("--span TIME", "--time --until --end --tmax --duration"),
    ("--samples NUMBER", "--steps --points --frames --num --dt --step --fps --n -n"),
    ("--members NUMBER", "--n --clones --count --num --samples --size -n"),
    ("--clones NUMBER", "--n --members --count --num --samples --size -n"),
    ("--axes principal", "--axis --frame --principal --principal-axes --body"),
    ("--degrees", "--deg --degree"),
    ("--omega", "--rate --rates --w --angular-velocity --angular-rate --spin --gyro"),
    ("--attitude", "--euler --euler-angles --quaternion --orientation --rotation --angles -q"),
    ("--gravity 9.81", "-g --g --weight"),
    ("--wheel", "--wheels --rotor --flywheel --momentum"),
    ("--moments", "--inertia --principal-moments --moment"),
    ("--inertia", "--tensor --inertia-tensor --moi"),
    ("--periods", "--period"),
    ("--com", "--cog --center-of-mass --centre --centre-of-mass --center-of-gravity"),
    ("--density", "--rho --material --densities"),
    ("--mass", "--weight -m"),
    ("--weld 1e-6", "--merge --tolerance --tol --merge-vertices"),
    ("--rtol 1e-10", "--tol --tolerance --precision --eps --accuracy"),
    ("--closure caps", "--close --fill --cap --fill-holes --watertight"),
    ("--orient", "--flip --fix-normals --normals --reorient"),
    ("--repair", "--heal --mend --fix"),
    ("--fix FILE", "--repair --correct --write --in-place -i"),
    ("--as urdf", "--urdf --sdf --mjcf --export --program"),
    ("--about", "--point --origin --reference"),
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


def _version_in_full() -> None:
    """Print what a report of a fault has to tell."""
    from polhode.cli.validate import as_text

    print(as_text())


def overview() -> str:
    """List the commands, each with the first line of its docstring."""
    lines = ["Usage: polhode COMMAND", "", app.help, "", "Commands:"]
    for name in COMMANDS:
        document = app[name].default_command.__doc__ or ""
        lines.append(f"  {name:<12}{document.partition(chr(10))[0]}")
    lines += ["", "polhode COMMAND --help tells what a command takes; polhode --version the version."]
    lines += ["polhode --version --verbose tells of the machine too, for reports of faults."]
    lines += ["Exit codes: 0 good, 1 the verdict is bad, 2 bad input."]
    return "\n".join(lines)


def unknown_option(arguments: list[str]) -> str | None:
    """Find an option that the command does not have, and say which one is meant."""
    command = next((word for word in arguments[:1] if word in COMMANDS), None)
    if command is None:
        return None
    known = {name for one in app[command].assemble_argument_collection() for name in one.names}
    known = {name for name in known if name.startswith("-")} | {*app.help_flags, *app.version_flags}
    for word in arguments[1:]:
        name = word.partition("=")[0]
        if not re.fullmatch(r"--[A-Za-z][\w-]*|-[A-Za-z]", name) or name in known or Path(word).exists():
            continue
        meant = next(
            (
                there
                for there, others in OTHER_OPTIONS
                if there.split()[0] in known and name in others.split()
            ),
            next(iter(get_close_matches(name, sorted(known), 1, 0.7)), None),
        )
        way_out = (
            f"did you mean {meant}?" if meant else f"choose one that it has (see polhode {command} --help)"
        )
        return f"{name}: {command} has no such option; {way_out}"
    return None


def run(arguments: list[str]) -> int:
    """Run one command and turn every foreseen error into one line and an exit code."""
    command: Callable[[], object] = partial(
        app,
        [_as_value(argument) for argument in arguments],
        exit_on_error=False,
        print_error=False,
        result_action="return_value",
    )
    if arguments in ([], ["--help"], ["-h"]):
        command = partial(print, overview())
    if sorted(arguments) == ["--verbose", "--version"]:
        command = _version_in_full
    unknown = unknown_option(arguments)
    if unknown is not None:
        return _fail(unknown)
    try:
        with standard_output():
            code = command()
    except UnusedCliTokensError as error:
        rest = " ".join(error.unused_tokens or ())
        return _fail(
            f"{rest}: more than {arguments[0]} takes; give one file, and in quotes what holds spaces "
            f"(see polhode {arguments[0]} --help)"
        )
    except CycloptsError as error:
        return _fail(f"{error} (see polhode --help)")
    except ReaderLeft:
        return GOOD
    except OSError as error:
        return _fail(words_of(error))
    except MemoryError as error:
        return _fail(f"there is not enough memory for it ({error})")
    except (ValueError, ModuleNotFoundError) as error:
        return _fail(in_options(error))
    except KeyboardInterrupt:
        return _fail("interrupted", code=INTERRUPTED)
    return code if isinstance(code, int) else 0


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
