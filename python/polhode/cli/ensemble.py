"""``polhode ensemble``: many motions with numbers that are drawn, their spread or their states."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

import numpy as np

from polhode import RigidBody, distributions, ensemble, loads
from polhode._quantities import quantity
from polhode.cli.cluster import client_at
from polhode.cli.drawn import drawn, drawn_number, middle_of
from polhode.cli.ensemble_files import check_place, saved
from polhode.cli.ensemble_numbers import kept, modes_table, numbers_table
from polhode.cli.layout import Column, Field, Report, Table
from polhode.cli.loading import LoadedBody
from polhode.cli.source import shown
from polhode.cli.spin_gyrostat import momentum_inside
from polhode.cli.whole import any_body, check_moments_alone
from polhode.ensembles.tree import BLOCK
from polhode.errors import PolhodeError
from polhode.euler_angles import to_quaternion

if TYPE_CHECKING:
    from pathlib import Path

    from polhode.cli.motion_options import EnsembleOptions
    from polhode.cli.options import BodyOptions
    from polhode.ensembles.result import Ensemble

__all__ = ["ensemble_report"]

MOST: Final = 2**62
"""More members have no number."""


def ensemble_report(file: Path | None, options: EnsembleOptions, body: BodyOptions) -> Report:
    """Run the members, save them as asked for and report on them."""
    _check(file, options, body)
    until = quantity(options.until or "", "s", "--until")
    if until == 0.0:
        raise PolhodeError(f"--until: expected a time other than 0, got {until:g}")
    if options.save is not None:
        check_place(options.save, resume=options.resume)
    given, notes = _arguments(file, options, body)
    with client_at(options.client) as client:
        many = ensemble(
            t=np.linspace(0.0, until, options.samples or 2),
            n=options.members,
            seed=options.seed,
            chunk=options.chunk,
            method=options.method,
            rtol=options.rtol,
            reduce=kept(has_modes=_is_free(options)) if options.save is None else None,
            client=client,
            **given,
        )
        if not many.plan.draws():
            raise PolhodeError(
                "ensemble: nothing is drawn, so that all members would be the same; write a number with a "
                'sigma or with bounds, as in --omega "0, 6.00 ± 0.05, 0.01", or let polhode spin tell of the '
                "one motion"
            )
        report = Report()
        report.section(
            "",
            Field("file", "file", _source(file, options)),
            Field("members", "members", options.members),
            Field("seed", "seed", options.seed),
            Field("drawn", "drawn", ", ".join(map(_option, many.plan.draws()))),
            Field("method", "method", str(many.plan.options["method"])),
            Field("time", "end", until, "s"),
        )
        if options.save is None:
            _tell_spread(report, many, options)
        else:
            _tell_saved(report, many, options.save)
    report.notes += notes
    return report


def _check(file: Path | None, options: EnsembleOptions, body: BodyOptions) -> None:
    """Refuse wrong options before anything is read or computed."""
    if file is None and not (options.moments or body.inertia):
        raise PolhodeError(
            "ensemble: give a file, or principal moments with --moments, or a tensor with --inertia"
        )
    if options.moments and body.inertia:
        raise PolhodeError("--moments and --inertia: both say what the body is; give one of the two")
    if file is not None and options.moments:
        raise PolhodeError(f"--moments: the body is that of {shown(file)}; give one of the two")
    if not options.omega:
        raise PolhodeError('--omega: state the start, as in --omega "0, 6.00 ± 0.05, 0.01 ± 0.01"')
    if options.until is None:
        raise PolhodeError('--until: state the time of the end, as in "20 s"')
    if not 0 < options.members < MOST:
        raise PolhodeError(f"--members: expected a number from 1 to 2^62 - 1, got {options.members}")
    if options.wheel and options.gravity is not None:
        raise PolhodeError(
            "--wheel: beside --gravity it is not taken; leave out one of the two, or add loads.rotor and "
            "loads.uniform_gravity in Python"
        )
    if options.save is None:
        _check_spread(options)
    elif options.checkpoint is not None:
        raise PolhodeError("--checkpoint: keeps a spread, and --save writes states; use --resume to go on")
    elif options.samples is not None and options.samples < 2:
        raise PolhodeError(
            f"--samples: {options.samples} is less than 2, the start and the end; give 2 or more"
        )


def _check_spread(options: EnsembleOptions) -> None:
    if options.resume:
        raise PolhodeError("--resume: goes on with what --save began; state --save, or use --checkpoint")
    if options.samples is not None:
        raise PolhodeError("--samples: the spread is told at the end alone; state --save, or leave it out")
    if options.chunk % BLOCK and 0 < options.chunk < options.members:
        raise PolhodeError(
            f"--chunk: expected a multiple of {BLOCK}, the members that are reduced together, got "
            f"{options.chunk}; {max(round(options.chunk / BLOCK), 1) * BLOCK} is one"
        )


def _arguments(
    file: Path | None, options: EnsembleOptions, body: BodyOptions
) -> tuple[dict[str, Any], list[str]]:
    """Give what `polhode.ensemble` takes of the body, the start and the load; and notes."""
    notes: list[str] = []
    if options.moments:
        given, one = _of_moments(options, body)
    else:
        one = any_body(file, body)
        given = one.body
        notes += one.notes
        if one.assumed:
            notes.append(
                "neither density nor mass was given: density 1 was used; the motion does not depend on it"
            )
        if one.body.covariance is not None:
            raise PolhodeError(
                "ensemble: the body has sigmas, and members draw --moments, --omega and --attitude; write "
                "the numbers of the body alone, or draw its --moments"
            )
    found = {"body": given, "omega": drawn(options.omega, 3, "rad/s", "--omega")}
    if options.attitude:
        found["attitude"] = _attitude(options.attitude)
    if options.gravity is not None:
        g = quantity(options.gravity, "m/s^2", "--gravity")
        found |= {"load": loads.uniform_gravity((0.0, 0.0, -g)), "about": "origin"}
        if options.method == "auto" and isinstance(given, distributions.Made):
            raise PolhodeError(
                "--method: with --gravity a body that is drawn needs one; state exact where all bodies are "
                "symmetric tops, else taylor or dop853"
            )
    if options.wheel:
        found["load"] = loads.rotor(momentum_inside(options.wheel, np.eye(3), one))
    return found, notes


def _of_moments(options: EnsembleOptions, body: BodyOptions) -> tuple[Any, Any]:
    """Make the body of --moments, --mass and --center, or what draws it; and whose axes have names."""
    check_moments_alone(body, "mass", "com")
    if options.gravity is not None and (body.mass is None or not body.com):
        raise PolhodeError("--gravity: the weight acts at the centre of mass; state --mass and --center too")
    mass: Any = 1.0 if body.mass is None else drawn_number(body.mass, "kg", "--mass")
    moments: Any = drawn(options.moments, 3, "kg m^2", "--moments")
    center: dict[str, Any] = {"center_of_mass": drawn(body.com, 3, "m", "--center")} if body.com else {}
    numbers = (mass, moments, *center.values())
    if any(isinstance(one, distributions.Distribution) for one in numbers):
        given: Any = distributions.made(RigidBody.from_principal, mass, moments, **center)
    else:
        given = RigidBody.from_principal(mass, moments, **center)
    if not options.wheel:
        return given, None
    middle = RigidBody.from_principal(1.0, middle_of(moments))
    return given, LoadedBody(body=middle, source=[], mass_unit="kg", length="m")


def _attitude(words: tuple[str, ...]) -> Any:
    if words == ("any",):
        return distributions.uniform_rotation()
    angles = drawn(words, 3, "rad", "--attitude")
    if isinstance(angles, distributions.Distribution):
        return distributions.made(to_quaternion, angles)
    return to_quaternion(angles)


def _option(place: str) -> str:
    """Give the option of what is drawn."""
    names = {"body.0": "mass", "body.1": "moments", "body.center_of_mass": "center"}
    return names.get(place, place.partition(".")[0])


def _is_free(options: EnsembleOptions) -> bool:
    return options.gravity is None and not options.wheel


def _tell_spread(report: Report, many: Ensemble, options: EnsembleOptions) -> None:
    found = many.compute(checkpoint=options.checkpoint)
    spread, shares = found["spread"], found["shares"]
    if not spread.members:
        raise PolhodeError(
            f"ensemble: none of {len(many)} members came to the end; write their states by --save, which "
            "tell the status of each, or ask Ensemble.member(k) in Python why"
        )
    report.section("at the end", numbers_table(found))
    if "modes" in found:
        report.section("modes", modes_table(found))
    if spread.left_out:
        report.notes.append(f"{spread.left_out} members failed and are in none of these numbers")
    if shares.rank_error:
        report.notes.append(f"the ranks of quantiles are right to {shares.rank_error:.1g} of all members")
    if options.checkpoint is not None:
        report.notes.append(f"kept in {options.checkpoint}")


def _tell_saved(report: Report, many: Ensemble, path: Path) -> None:
    rows = [{"status": name, "members": count} for name, count in saved(many, path).items()]
    columns = (Column("status", "status"), Column("members", "members"))
    report.section("how members ended", Table("status", columns, rows))
    report.notes.append(f"saved {path}")


def _source(file: Path | None, options: EnsembleOptions) -> str:
    if file is not None:
        return shown(file)
    return "(moments)" if options.moments else "(inertia)"
