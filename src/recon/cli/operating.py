"""The commands that speak to a running station, apart: they start in a fraction of the time that
loading the station itself takes, and one of them is `recon all-stop`."""

from collections.abc import Callable

import typer

from recon.cli.authority import preflight_command, release_command, take_command
from recon.cli.flying import camera_command, fly_command
from recon.cli.hazards import dismiss_command, separation_hold_command
from recon.cli.negative_numbers import TakesNegativeNumbers
from recon.cli.returning import fleet_return_command
from recon.cli.steering import goto_command, nudge_command
from recon.cli.stop_commands import all_stop_command, hold_command, land_command, return_command
from recon.cli.surveying import survey_app
from recon.cli.watching import alarms_command, commands_command, status_command

COMMANDS: dict[str, Callable[..., None]] = {
    "status": status_command,
    "all-stop": all_stop_command,
    "hold": hold_command,
    "land": land_command,
    "return": return_command,
    "goto": goto_command,
    "nudge": nudge_command,
    "fly": fly_command,
    "camera": camera_command,
    "take": take_command,
    "release": release_command,
    "preflight": preflight_command,
    "fleet-return": fleet_return_command,
    "dismiss": dismiss_command,
    "separation-hold": separation_hold_command,
    "alarms": alarms_command,
    "commands": commands_command,
}

GROUPS: dict[str, typer.Typer] = {"survey": survey_app}
"""Commands of several words."""

WITH_COORDINATES = frozenset({"goto"})
"""Commands whose arguments may be negative."""


def operating_app() -> typer.Typer:
    """Return an application of these commands alone."""
    app = new_app()
    add_commands(app)
    return app


def new_app() -> typer.Typer:
    """Return `recon` without commands."""
    return typer.Typer(
        name="recon",
        help="A ground control station for several DJI drones over fields.",
        no_args_is_help=True,
        pretty_exceptions_enable=False,
        add_completion=False,
    )


def add_commands(app: typer.Typer) -> None:
    """Register these commands."""
    for name, command in COMMANDS.items():
        takes_negative = name in WITH_COORDINATES
        app.command(name, cls=TakesNegativeNumbers if takes_negative else None)(command)

    for name, words in GROUPS.items():
        app.add_typer(words, name=name)

    @app.callback()
    def group() -> None:
        """A ground control station for several DJI drones over fields."""
