"""The commands: what each takes, and what it hands on.

What a command does is imported when it runs, so that the help appears without NumPy.
"""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Final

from cyclopts import App, Parameter

from polhode.cli.layout import held_and_shown, show, show_lines
from polhode.cli.options import (
    AssembleOptions,
    BodyOptions,
    CheckOptions,
    EnsembleOptions,
    FlybyOptions,
    LedgerOptions,
    MoleculeOptions,
    OutputOptions,
    ReportOptions,
    SpinOptions,
)
from polhode.cli.terminal import note

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
Body = Annotated[BodyOptions, Parameter(name="*")]
Output = Annotated[OutputOptions, Parameter(name="*")]
AS_STORED = BodyOptions()
SHOWN = OutputOptions()


@app.command
def report(
    file: Annotated[Path | None, Parameter(allow_leading_hyphen=True)] = None,
    /,
    *,
    body: Body = AS_STORED,
    extra: Annotated[ReportOptions, Parameter(name="*")] = ReportOptions(),  # noqa: B008
    output: Output = SHOWN,
) -> int:
    """Print mass, centre, inertia and principal axes of the body in a file.

    Parameters
    ----------
    file
        A mesh (STL, OBJ, PLY, DAE, 3MF, glTF, plates ...), CAD (STEP), a molecule (XYZ, PDB ...), a saved
        body (JSON, NPZ), an assembly (TOML), or - for standard input; without one, the numbers of --inertia.
    """
    from polhode.cli.files import check_outputs
    from polhode.cli.report import file_report, for_program
    from polhode.io.reading import files_read

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
    *,
    check: Annotated[CheckOptions, Parameter(name="*")] = CheckOptions(),  # noqa: B008
    output: Output = SHOWN,
) -> int:
    """Judge the inertia of every link of a robot: which law fails, by how much, and what its shape says.

    Parameters
    ----------
    file
        A robot or model (URDF, SDF, MJCF), or - for standard input.
    """
    from polhode.cli.check import check_report
    from polhode.cli.files import check_outputs
    from polhode.io.reading import files_read

    check_outputs([("--fix", check.fix), ("--output", output.output)], [file])
    with files_read() as read:
        told, is_good = check_report(file, check)
    check_outputs([("--output", output.output)], read)
    show(told, output)
    return GOOD if is_good else BAD_VERDICT


@app.command
def molecule(
    file: File,
    /,
    *,
    molecule: Annotated[MoleculeOptions, Parameter(name="*")] = MoleculeOptions(),  # noqa: B008
    output: Output = SHOWN,
) -> int:
    """Print rotational constants, class of top, inertial defect, planar moments and isotopologues.

    Parameters
    ----------
    file
        A molecule (XYZ, PDB, MOL, SDF), or - for standard input.
    """
    from polhode.cli.files import check_outputs
    from polhode.cli.molecule import molecule_report

    check_outputs([("--output", output.output)], [file])
    show(molecule_report(file, molecule), output)
    return GOOD


@app.command
def spin(
    file: Annotated[Path | None, Parameter(allow_leading_hyphen=True)] = None,
    /,
    *,
    spin: Annotated[SpinOptions, Parameter(name="*")] = SpinOptions(),  # noqa: B008
    body: Body = AS_STORED,
    output: Output = SHOWN,
) -> int:
    """Compute the motion of a free body, a body with wheels, or a top: mode, periods, stability.

    Parameters
    ----------
    file
        A mesh (STL, OBJ, PLY, DAE, 3MF, glTF, plates ...), CAD (STEP), a molecule (XYZ, PDB ...), a saved
        body (JSON, NPZ), an assembly (TOML), or - for standard input; without one, --moments or --inertia.
    """
    from polhode.cli.files import check_outputs
    from polhode.cli.spin import spin_report

    check_outputs([*(("--save", path) for path in spin.save), ("--output", output.output)], [file])
    show(spin_report(file, spin, body), output)
    return GOOD


@app.command
def flyby(
    file: Annotated[Path | None, Parameter(allow_leading_hyphen=True)] = None,
    /,
    *,
    flyby: Annotated[FlybyOptions, Parameter(name="*")] = FlybyOptions(),  # noqa: B008
    body: Body = AS_STORED,
    output: Output = SHOWN,
) -> int:
    """Simulate many copies of a tumbling asteroid, each with another rotation phase, past a planet.

    Parameters
    ----------
    file
        A mesh (STL, OBJ, PLY, DAE, 3MF, glTF, plates ...), CAD (STEP), or - for standard input.
    """
    from polhode.cli.files import check_outputs
    from polhode.cli.flyby import draw_flyby, flyby_report

    check_outputs([*(("--save", path) for path in flyby.save), ("--output", output.output)], [file])
    told, found = flyby_report(file, flyby, body)
    for path in flyby.save:
        draw_flyby(found, path)
        told.notes.append(f"saved {path}")
    show(told, output)
    return GOOD


@app.command
def ensemble(
    file: Annotated[Path | None, Parameter(allow_leading_hyphen=True)] = None,
    /,
    *,
    ensemble: Annotated[EnsembleOptions, Parameter(name="*")] = EnsembleOptions(),  # noqa: B008
    body: Body = AS_STORED,
    output: Output = SHOWN,
) -> int:
    """Run one motion many times with numbers that are drawn, and tell their spread or save all states.

    Parameters
    ----------
    file
        A mesh (STL, OBJ, PLY, DAE, 3MF, glTF, plates ...), CAD (STEP), a molecule (XYZ, PDB ...), a saved
        body (JSON, NPZ), an assembly (TOML), or - for standard input; without one, --moments or --inertia.
    """
    from polhode.cli.ensemble import ensemble_report
    from polhode.cli.files import check_outputs

    places = [("--save", ensemble.save), ("--checkpoint", ensemble.checkpoint), ("--output", output.output)]
    check_outputs(places, [file])
    show(ensemble_report(file, ensemble, body), output)
    return GOOD


@app.command
def assemble(
    file: File,
    /,
    *,
    assemble: Annotated[AssembleOptions, Parameter(name="*")] = AssembleOptions(),  # noqa: B008
    extra: Annotated[ReportOptions, Parameter(name="*")] = ReportOptions(),  # noqa: B008
    output: Output = SHOWN,
) -> int:
    """Put parts together, each with its shape, place and matter, and report on the whole.

    Parameters
    ----------
    file
        An assembly (TOML).
    """
    from polhode.cli.assemble import assembly_for_program, assembly_report, save_assembly
    from polhode.cli.files import check_outputs
    from polhode.io.reading import files_read

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
    ledger: Annotated[LedgerOptions, Parameter(name="*")] = LedgerOptions(),  # noqa: B008
    output: Output = SHOWN,
) -> int:
    """Roll up a tree of parts with its uncertainties, and tell who contributes to them.

    Parameters
    ----------
    file
        A table of parts (CSV, TSV), or - for standard input. --output writes every row where its name ends in
        .csv.
    """
    from polhode.cli.files import check_outputs
    from polhode.cli.ledger import ledger_report
    from polhode.io.reading import files_read

    places = [("--picture", ledger.picture), ("--output", output.output)]
    check_outputs(places, [file, ledger.tree])
    with files_read() as read:
        told, made = ledger_report(file, ledger)
    check_outputs(places, read)
    if ledger.picture is not None:
        from polhode.cli.ledger import draw_ledger

        draw_ledger(made, ledger)
    if output.form is None and output.output is not None and output.output.suffix.lower() == ".csv":
        made.to_csv(output.output)
    else:
        show(told, output)
    return GOOD


@app.command
def samples(folder: Path | None = None, /) -> int:
    """List the files to try things with, or put them into a folder: a mesh, molecules, a robot, an assembly.

    Parameters
    ----------
    folder
        Where they go; made where there is none.
    """
    from rich.console import Console

    from polhode.cli import samples as shipped

    shipped.run(folder, Console(highlight=False, soft_wrap=True))
    return GOOD


@app.command
def demo(*, output_dir: Path = Path("polhode-demo")) -> int:
    """Show it all without a file of your own: a T-handle that flips, and NASA's tumbling brick.

    Parameters
    ----------
    output_dir
        Where the mesh and the picture are written.
    """
    from rich.console import Console

    from polhode.cli import demo as demonstration

    return demonstration.run(output_dir, Console(highlight=False))


@app.command
def validate(*, output: Output = SHOWN) -> int:
    """Hold this build against NASA's check case, an asteroid, molecules, a CAD printout and closed forms."""
    from polhode.cli.files import check_outputs
    from polhode.cli.validate import validation

    check_outputs([("--output", output.output)], [])
    told, is_good = validation()
    show(told, output)
    return GOOD if is_good else BAD_VERDICT
