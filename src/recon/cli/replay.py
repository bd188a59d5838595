"""`recon replay`: a recorded flight in the console, compared, or read by other methods.

Without an option it serves the console with the flight. `--check` compares every output with the
recorded one; `--what-if` also reads each image by other methods and prints their scores.
"""

import platform
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import numpy as np
import typer

from recon import version
from recon.model.errors import RecordError
from recon.record.audit.audit import shown
from recon.station.recording.recorded_values import FlightStart, this_machine
from recon.station.recording.replay import Checked, check

DIFFERS, CUT_SHORT = 1, 3
METHODS = ("detection", "forecast")


def replay_command(
    words: Annotated[
        list[str],
        typer.Argument(
            metavar="[detection=NAME] [forecast=NAME] FILE", help="A flight record (MCAP)."
        ),
    ],
    checks: Annotated[
        bool, typer.Option("--check", help="Compare every output with the recorded one.")
    ] = False,
    asks: Annotated[
        bool, typer.Option("--what-if", help="Score other methods on the flight's images.")
    ] = False,
    scenario: Annotated[
        Path | None,
        typer.Option(help="Scenario of a simulated flight, where --what-if does not find it."),
    ] = None,
    http_port: Annotated[
        int,
        typer.Option(min=0, max=65535, help="Port of the console; 0: any free port."),
    ] = 0,
    site: Annotated[
        Path | None,
        typer.Option(
            exists=True,
            file_okay=False,
            help="Folder of the site, whose base maps the console shows.",
        ),
    ] = None,
) -> None:
    """Show a recorded flight in the console, compare its outputs, or score other methods on it.

    The console plays it at 0.1 to 50 times its speed; nothing can be ordered.

    Exit code of --check and --what-if 0: equal to the bit; 1: a difference; 2: no record; 3: equal
    as far as the record could be compared.
    """
    file, methods = _file_and_methods(words, asks)
    if not (checks or asks):
        _show(file, http_port, site)
        return
    try:
        found = _asked(file, methods, scenario) if asks else check(file, _report)
    except OSError as problem:
        raise RecordError(f"cannot read {file}: {problem.strerror}") from problem
    for line in lines(found):
        typer.echo(line)
    if found.differences:
        raise typer.Exit(DIFFERS)
    if found.trouble:
        raise typer.Exit(CUT_SHORT)


def _show(file: Path, http_port: int, site: Path | None) -> None:
    """Serve the console with a recorded flight until Ctrl+C.

    By default on any free port: the usual address stays a live station's, where stops go.
    """
    from recon.cli.foreground import print_now, run_in_loop
    from recon.cli.own_files import console_folder
    from recon.station.host.replay_run import ReplayStation, run_replay

    async def started(url: str, station: ReplayStation) -> None:
        replay = station.view()
        minutes, seconds = divmod(round(replay.duration_s), 60)
        print_now(f"REPLAY of {shown(replay.file)}, {minutes} min {seconds} s: no orders possible")
        if replay.trouble is not None:
            print_now(f"the record ends early: {shown(replay.trouble)}")
        for line in _skipped(station.playback.skipped):
            print_now(line)
        print_now(f"console: {url}")

    try:
        run_in_loop(run_replay(file, http_port, console_folder(), started, site))
    except OSError as problem:
        raise RecordError(f"cannot read {file}: {problem.strerror}") from problem


def _file_and_methods(words: list[str], asks: bool) -> tuple[Path, dict[str, str]]:
    """Return the file, and the method of each kind that was asked for."""
    files, methods = [], {}
    for word in words:
        kind, equals, name = word.partition("=")
        if asks and equals and kind in METHODS:
            methods[kind] = name
        else:
            files.append(word)
    if len(files) != 1:
        raise typer.BadParameter(
            f"expected one FILE, for each is one flight; got {len(files)}: {shown(' '.join(files))}"
        )
    if asks and not methods:
        raise typer.BadParameter("--what-if: expected detection=NAME, forecast=NAME or both")
    return Path(files[0]), methods


def _asked(file: Path, methods: dict[str, str], scenario: Path | None) -> Checked:
    """Run a flight again, and print what other methods find in its images."""
    from recon.cli.own_files import scenarios_folder
    from recon.score.truth import truth_of
    from recon.score.what_if import WhatIf

    other = WhatIf(methods.get("detection"), methods.get("forecast"))

    def begin(start: FlightStart) -> None:
        other.truth = truth_of(start.scenario, scenario, scenarios_folder())

    found = check(file, _report, begin, other.take)
    for line in other.report().splitlines():
        typer.echo(shown(line))
    return found


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
    text += _skipped(sorted(found.skipped))
    if found.start is not None and found.differences:
        text += _other_versions(found.start)
    return text


def _skipped(names: Sequence[str]) -> list[str]:
    if not names:
        return []
    return [f"warning: skipped, for another version wrote them: {shown(', '.join(names))}"]


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
