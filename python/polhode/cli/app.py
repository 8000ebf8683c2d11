"""The commands: what each takes, and what it hands on.

What a command does is imported when it runs, so that the help appears without NumPy.
"""

from __future__ import annotations

from inspect import cleandoc
from pathlib import Path
from textwrap import indent
from typing import Annotated, Final

from cyclopts import App, Parameter

from polhode.cli.options import (
    RESULTS,
    AssembleOptions,
    AuditOptions,
    BodyOptions,
    CheckOptions,
    EnsembleOptions,
    FindingsOptions,
    FlybyOptions,
    IdentifyOptions,
    LedgerOptions,
    MoleculeOptions,
    OutputOptions,
    ReportOptions,
    RollOptions,
    SpinOptions,
)
from polhode.cli.terminal import note
from polhode.errors import PolhodeError

__all__ = ["BAD_VERDICT", "GOOD", "app"]

GOOD: Final = 0
BAD_VERDICT: Final = 1


def _version() -> str:
    from polhode import __version__

    return f"polhode {__version__}"


app = App(
    name="polhode",
    help="One body in: an inertia you can trust, and exactly how it will spin.",
    version=_version,
    help_format="markdown",
    suppress_keyboard_interrupt=False,
)

File = Annotated[Path, Parameter(allow_leading_hyphen=True)]
MaybeFile = Annotated[Path | None, Parameter(allow_leading_hyphen=True)]
ALL: Final = Parameter(name="*")
Body = Annotated[BodyOptions, ALL]
Output = Annotated[OutputOptions, ALL]
AS_STORED = BodyOptions()
SHOWN = OutputOptions()


@app.command
def report(
    file: MaybeFile = None,
    /,
    *,
    body: Body = AS_STORED,
    extra: Annotated[ReportOptions, ALL] = ReportOptions(),  # noqa: B008
    output: Output = SHOWN,
) -> int:
    """Print mass, centre of mass, inertia and principal axes of a body.

    Parameters
    ----------
    file
        A mesh (STL, OBJ, PLY, DAE, 3MF, glTF, plates ...), CAD (STEP, IGES), a molecule (XYZ, PDB ...), a
        saved body (JSON, NPZ), an assembly (TOML), or - for standard input. Without a file: --inertia.

    Examples
    --------
    polhode report t-handle.stl --length-unit mm --density "7.85 g/cm^3"
    polhode report bracket.ply --length-unit in --mass "0.3 lb" --about "0 0 1 in"
    polhode report torus.obj --length-unit mm --mass "1 kg" --as urdf
    """
    from polhode.cli.files import check_outputs
    from polhode.cli.layout import held_and_shown, show_lines
    from polhode.cli.report import file_report, for_program
    from polhode.io.budget import files_read

    check_outputs([("--output", output.output)], [file, extra.expect])
    with files_read() as read:
        if extra.program is not None:
            text, notes = for_program(file, body, extra, output.form)
        else:
            told = file_report(file, body, extra)
    check_outputs([("--output", output.output)], read)
    if extra.program is not None:
        show_lines(text, output)
        note(notes)
        return GOOD
    return GOOD if held_and_shown(told, extra, output) else BAD_VERDICT


@app.command
def check(
    file: File,
    /,
    *more: File,
    check: Annotated[CheckOptions, ALL] = CheckOptions(),  # noqa: B008
    output: Annotated[FindingsOptions, ALL] = FindingsOptions(),  # noqa: B008
) -> int:
    """Check the inertia of a robot's links, and write a corrected copy.

    Parameters
    ----------
    file
        A robot or model (URDF, SDF, MJCF, xacro), or - for standard input.
    more
        More of them.

    Examples
    --------
    polhode check robot.urdf
    polhode check robot.urdf --fix better.urdf
    polhode check robot.sdf --strict --format json
    """
    from polhode.cli.check import check_files
    from polhode.cli.files import check_outputs
    from polhode.cli.layout import form_of, show, show_lines
    from polhode.io.budget import files_read

    places = [("--fix", check.fix), ("--baseline", check.baseline), ("--output", output.output)]
    check_outputs(places, [file, *more])
    form = form_of(output, ("json", "sarif"))
    with files_read() as read:
        told, is_good = check_files([file, *more], check, form)
    check_outputs([("--output", output.output)], read)
    if isinstance(told, str):
        show_lines(told, output)
    else:
        show(told, output)
    return GOOD if is_good else BAD_VERDICT


@app.command
def molecule(
    file: File,
    /,
    *,
    molecule: Annotated[MoleculeOptions, ALL] = MoleculeOptions(),  # noqa: B008
    output: Output = SHOWN,
) -> int:
    """Print rotational constants and class of top of a molecule.

    Parameters
    ----------
    file
        A molecule (XYZ, PDB, MOL, SDF), or - for standard input.

    Examples
    --------
    polhode molecule water.xyz
    polhode molecule water.xyz --isotopes D --isotopes 18O --isotopes 2=D
    polhode molecule benzene.xyz --mass-sigmas --format json
    """
    from polhode.cli.files import check_outputs
    from polhode.cli.layout import show
    from polhode.cli.molecule import molecule_report

    check_outputs([("--output", output.output)], [file])
    show(molecule_report(file, molecule), output)
    return GOOD


@app.command
def spin(
    file: MaybeFile = None,
    /,
    *,
    spin: Annotated[SpinOptions, ALL] = SpinOptions(),  # noqa: B008
    body: Body = AS_STORED,
    output: Output = SHOWN,
) -> int:
    """Compute the motion of a free body, a body with wheels, or a top.

    Parameters
    ----------
    file
        A mesh (STL, OBJ, PLY, DAE, 3MF, glTF, plates ...), CAD (STEP, IGES), a molecule (XYZ, PDB ...), a
        saved body (JSON, NPZ), an assembly (TOML), or - for standard input. Without a file: --moments or
        --inertia.

    Examples
    --------
    polhode spin --moments "1 2 3" --omega "0.01 5 0" --end 20 --save flip.html
    polhode spin t-handle.stl --axes principal --omega "0.5 60 0 deg/s"
    polhode spin --moments "1 3 3.2" --periods "5.41 d, 7.35 d" --mode long-axis
    """
    from polhode.cli.files import check_outputs
    from polhode.cli.layout import show
    from polhode.cli.spin import spin_report

    check_outputs([*(("--save", path) for path in spin.save), ("--output", output.output)], [file])
    show(spin_report(file, spin, body), output)
    return GOOD


@app.command
def roll(
    file: MaybeFile = None,
    /,
    *,
    roll: Annotated[RollOptions, ALL] = RollOptions(),  # noqa: B008
    body: Body = AS_STORED,
    output: Output = SHOWN,
) -> int:
    r"""Compute the motion of a body that rolls on a plane.

    Parameters
    ----------
    file
        A mesh (STL, OBJ, PLY, DAE, 3MF, glTF, plates ...), CAD (STEP, IGES), a saved body (JSON, NPZ), an
        assembly (TOML), or - for standard input, for mass and inertia. Without a file: --moments, --inertia,
        or a homogeneous body.

    Examples
    --------
    polhode roll --surface disk --radius 0.05 --mass 0.2 --omega 0 12 7 \
        --tilt 52deg --end 3 --save coin.html
    polhode roll --surface sphere --radius "2 cm" --mass "30 g" --omega 0 9 0 \
        --turntable "33.3 rpm" --end 10
    polhode roll --surface ellipsoid --semi-axes "20 3 2 cm" --mass 1 \
        --inertia "2 16 17 0.2 0 0 g m^2" --products negative --omega 0.1 0 3 --end 5
    """
    from polhode.cli.files import check_outputs
    from polhode.cli.layout import show
    from polhode.cli.roll import roll_report

    check_outputs([*(("--save", path) for path in roll.save), ("--output", output.output)], [file])
    told, is_kept = roll_report(file, roll, body)
    show(told, output)
    return GOOD if is_kept else BAD_VERDICT


@app.command
def flyby(
    file: MaybeFile = None,
    /,
    *,
    flyby: Annotated[FlybyOptions, ALL] = FlybyOptions(),  # noqa: B008
    body: Body = AS_STORED,
    output: Output = SHOWN,
) -> int:
    r"""Simulate many copies of a tumbling asteroid that pass a planet.

    Parameters
    ----------
    file
        A mesh (STL, OBJ, PLY, DAE, 3MF, glTF, plates ...), CAD (STEP, IGES), or - for standard input. Without
        a file: --moments.

    Examples
    --------
    polhode flyby --moments "0.64 0.97 1" --periods "264.2 h, 27.39 h" \
        --mode short-axis --n 50
    polhode flyby asteroid.obj --periods "5 h, 3 h" --mode long-axis \
        --eccentricity 4.25 --periapsis "38011 km" --n 50 --save flyby.png
    polhode flyby --moments "0.64 0.97 1" --periods "263 ± 6 h, 27.38(7) h" \
        --mode short-axis --pole 0 0 1 --pole-sigma "5 deg" --n 50
    """
    from polhode.cli.files import check_outputs
    from polhode.cli.flyby import draw_flyby, flyby_report
    from polhode.cli.layout import show

    check_outputs([*(("--save", path) for path in flyby.save), ("--output", output.output)], [file])
    told, found = flyby_report(file, flyby, body)
    for path in flyby.save:
        draw_flyby(found, path)
        told.notes.append(f"saved {path}")
    show(told, output)
    return GOOD


@app.command
def ensemble(
    file: MaybeFile = None,
    /,
    *,
    ensemble: Annotated[EnsembleOptions, ALL] = EnsembleOptions(),  # noqa: B008
    body: Body = AS_STORED,
    output: Output = SHOWN,
) -> int:
    """Compute one motion many times, with numbers drawn at random.

    The numbers of --moments, --omega, --attitude, --mass and --center-of-mass are the same for all members,
    or drawn: "1.00 ± 0.01" or "1.00(1)" from a normal distribution, "0.9 to 1.1" from a uniform one. The
    report gives their spread at the end; --save writes the states of all members instead.

    Parameters
    ----------
    file
        A mesh (STL, OBJ, PLY, DAE, 3MF, glTF, plates ...), CAD (STEP, IGES), a molecule (XYZ, PDB ...), a
        saved body (JSON, NPZ), an assembly (TOML), or - for standard input. Without a file: --moments or
        --inertia.

    Examples
    --------
    polhode ensemble --moments "1.00 ± 0.01, 2, 2.5" --omega "0 1 0" --end 20
    polhode ensemble --moments "1 2 3" --omega "0 1 0" --attitude any --end 20
    polhode ensemble t-handle.stl --omega "0, 5 to 6, 0" --end 20 --save runs.npz
    """
    from polhode.cli.ensemble import ensemble_report
    from polhode.cli.files import check_outputs
    from polhode.cli.layout import show

    places = [("--save", ensemble.save), ("--checkpoint", ensemble.checkpoint), ("--output", output.output)]
    check_outputs(places, [file])
    show(ensemble_report(file, ensemble, body), output)
    return GOOD


@app.command
def assemble(
    file: File,
    /,
    *,
    assemble: Annotated[AssembleOptions, ALL] = AssembleOptions(),  # noqa: B008
    extra: Annotated[ReportOptions, ALL] = ReportOptions(),  # noqa: B008
    output: Output = SHOWN,
) -> int:
    """Put parts together, and report on the whole.

    Parameters
    ----------
    file
        An assembly (TOML).

    Examples
    --------
    polhode assemble rover.toml
    polhode assemble rover.toml --depth 3 --all --save rover.png
    polhode assemble rover.toml --as mujoco
    """
    from polhode.cli.assemble import assembly_for_program, assembly_report, save_assembly
    from polhode.cli.files import check_outputs
    from polhode.cli.layout import held_and_shown, show_lines
    from polhode.io.budget import files_read

    places = [*(("--save", path) for path in assemble.save), ("--output", output.output)]
    check_outputs(places, [file, extra.expect])
    with files_read() as read:
        if extra.program is not None:
            text, notes = assembly_for_program(file, assemble, extra, output.form)
        else:
            told, made = assembly_report(file, assemble, extra)
    check_outputs(places, read)
    if extra.program is not None:
        show_lines(text, output)
        note(notes)
        return GOOD
    saved = (line for path in assemble.save for line in save_assembly(made, path))
    return GOOD if held_and_shown(told, extra, output, saved) else BAD_VERDICT


@app.command
def ledger(
    file: File,
    /,
    *,
    ledger: Annotated[LedgerOptions, ALL] = LedgerOptions(),  # noqa: B008
    output: Output = SHOWN,
) -> int:
    """Sum up a table of parts, and show what its uncertainty comes from.

    Parameters
    ----------
    file
        A table of parts (CSV, TSV), or - for standard input.

    Examples
    --------
    polhode ledger craft.csv
    polhode ledger craft.csv --at bus --of Cx
    polhode ledger craft.csv --of Izz --save shares.png --save rows.csv
    """
    from polhode.cli.files import check_outputs
    from polhode.cli.layout import show
    from polhode.cli.ledger import ledger_report, save_ledger
    from polhode.io.budget import files_read

    places = [*(("--save", path) for path in ledger.save), ("--output", output.output)]
    check_outputs(places, [file, ledger.tree])
    if output.form is None and output.output is not None and output.output.suffix.lower() == ".csv":
        raise PolhodeError(f"--output: it is for text; --save {output.output} writes the rows as a table")
    with files_read() as read:
        told, made = ledger_report(file, ledger)
    check_outputs(places, read)
    for path in ledger.save:
        save_ledger(made, ledger, path)
        told.notes.append(f"saved {path}")
    show(told, output)
    return GOOD


@app.command
def audit(
    file: File,
    /,
    *,
    audit: Annotated[AuditOptions, ALL] = AuditOptions(),  # noqa: B008
    body: Body = AS_STORED,
    output: Output = SHOWN,
) -> int:
    """Compare a recorded motion with the exact one, and find mistakes.

    Parameters
    ----------
    file
        A record (CSV), a row for each time, or - for standard input.

    Examples
    --------
    polhode audit tumble.csv --moments "2 3 4"
    polhode audit tumble.csv --moments "2 3 4" --attitude "qx,qy,qz,qw" --format json
    polhode audit tumble.csv --moments "2 3 4" --rtol 1e-4 --save drifts.png
    """
    from polhode.cli.audit import audit_report, draw_audit
    from polhode.cli.files import check_outputs
    from polhode.cli.layout import show

    places = [*(("--save", path) for path in audit.save), ("--output", output.output)]
    check_outputs(places, [file, audit.finer, audit.body])
    told, found = audit_report(file, audit, body)
    for path in audit.save:
        draw_audit(found, path)
        told.notes.append(f"saved {path}")
    show(told, output)
    return GOOD if found.agrees else BAD_VERDICT


@app.command
def identify(
    file: File,
    /,
    *,
    identify: Annotated[IdentifyOptions, ALL] = IdentifyOptions(),  # noqa: B008
    output: Output = SHOWN,
) -> int:
    """Find the body that explains a log of measurements.

    Parameters
    ----------
    file
        A log of a sensor (CSV), a row for each time; or a table of pendulums; or - for standard input.

    Examples
    --------
    polhode identify tumble.csv --kind tumble
    polhode identify tumble.csv --kind tumble --omega wx,wy,wz --rate-unit rad/s --save fit.png
    polhode identify tumble.csv --kind tumble --bias --save body.json --format json
    """
    from polhode.cli.files import check_outputs
    from polhode.cli.identify import identify_report
    from polhode.cli.layout import show

    places = [*(("--save", path) for path in identify.save), ("--output", output.output)]
    check_outputs(places, [file])
    told, is_good = identify_report(file, identify)
    show(told, output)
    return GOOD if is_good else BAD_VERDICT


@app.command
def samples(folder: Path | None = None, /) -> int:
    """List the sample files, or write them into a folder.

    Parameters
    ----------
    folder
        Folder for the files; it is made if it does not exist. Without it, the files are listed.

    Examples
    --------
    polhode samples
    polhode samples .
    polhode samples trials
    """
    from rich.console import Console

    from polhode.cli import samples as shipped

    shipped.run(folder, Console(highlight=False, soft_wrap=True))
    return GOOD


@app.command
def demo(*, save: Annotated[Path, RESULTS] = Path("polhode-demo")) -> int:
    """Show a tour: a T-handle that flips over, and NASA's tumbling brick.

    Parameters
    ----------
    save
        Folder for the mesh and the picture; it is made if it does not exist.

    Examples
    --------
    polhode demo
    polhode demo --save tour
    polhode demo --save figures/t-handle
    """
    from rich.console import Console

    from polhode.cli import demo as demonstration

    return demonstration.run(save, Console(highlight=False))


@app.command
def validate(*, output: Output = SHOWN) -> int:
    """Compare the results of this installation with published ones.

    Examples
    --------
    polhode validate
    polhode validate --format json
    polhode validate --output validation.json
    """
    from polhode.cli.files import check_outputs
    from polhode.cli.layout import show
    from polhode.cli.validate import validation

    check_outputs([("--output", output.output)], [])
    told, is_good = validation()
    show(told, output)
    return GOOD if is_good else BAD_VERDICT


def _examples(document: str) -> str:
    """Return the examples of a docstring as a block of code, of which the help keeps the lines."""
    return "Examples:\n\n" + indent(cleandoc(document).partition("Examples\n--------\n")[2], "    ")


for _command in (
    report, check, molecule, spin, roll, flyby, ensemble, assemble, ledger, audit, identify, samples, demo,
    validate,
):  # fmt: skip
    app[_command.__name__].help_epilogue = _examples(_command.__doc__ or "")
