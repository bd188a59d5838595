"""`recon replay --check`: run the step again on a recorded flight and compare every output."""

import platform
from pathlib import Path
from typing import Annotated

import numpy as np
import typer

from recon import version
from recon.record.audit import shown
from recon.station.kernel.recorded_values import FlightStart, this_machine
from recon.station.kernel.replay import Checked, check

DIFFERS, CUT_SHORT = 1, 3


def replay_command(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="A flight record (MCAP).")],
    checks: Annotated[
        bool, typer.Option("--check", help="Compare every output with the recorded one.")
    ] = False,
) -> None:
    """Run a recorded flight again and compare every output.

    Exit code 0: equal to the bit; 1: a difference, or no record; 3: equal as far as the record
    could be compared.
    """
    if not checks:
        raise typer.BadParameter("give --check: a replay in the console is not there yet")
    try:
        found = check(file, _report)
    except OSError as problem:
        typer.echo(f"recon replay: cannot read {file}: {problem.strerror}", err=True)
        raise typer.Exit(2) from None
    for line in lines(found):
        typer.echo(line)
    if found.differences:
        raise typer.Exit(DIFFERS)
    if found.trouble:
        raise typer.Exit(CUT_SHORT)


def _report(found: Checked) -> None:
    typer.echo(f"{found.steps} steps, {found.lasted_s:.0f} s of the flight ...", err=True)


def lines(found: Checked) -> list[str]:
    """Return what a check found, for a terminal."""
    text = [shown(str(each)) for each in found.differences]
    what = f"{found.steps} steps and {found.jobs} jobs of {found.lasted_s:.1f} s"
    if found.differences:
        text.append(f"{len(found.differences)} differences within {what}")
    else:
        text.append(f"equal to the bit: {what}")
    if found.trouble:
        text.append(f"ended before the record's end: {shown(found.trouble)}")
    if found.start is not None and found.differences:
        text += _other_versions(found.start)
    return text


def _other_versions(start: FlightStart) -> list[str]:
    """Numbers may differ in their last bits between versions of libraries and processors."""
    here = {
        "version": version(),
        "python": platform.python_version(),
        "numpy": np.__version__,
        "machine": this_machine(),
    }
    return [
        f"recorded with {name} {shown(getattr(start, name))}, compared with {now}"
        for name, now in here.items()
        if getattr(start, name) != now
    ]
