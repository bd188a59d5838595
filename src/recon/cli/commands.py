"""The commands of `recon`, each loaded only when it is called or its own help is asked.

The station, its libraries and the simulator take seconds to load; `recon all-stop` must not wait
for them, nor `recon --help`.
"""

import gc
import re
from collections.abc import Callable
from importlib import import_module
from typing import Any, NamedTuple, TypeVar

import typer
from typer.core import TyperCommand, TyperGroup

from recon.cli.exit_codes import report_error
from recon.model.errors import ReconError
from recon.model.units import is_finite

Function = TypeVar("Function", bound=Callable[..., Any])


class CommandSource(NamedTuple):
    """Where a command is defined: `module:name` of its function, or of a group of commands."""

    target: str
    summary: str
    """First line of the command's own help; a test compares them."""
    takes_negative_numbers: bool = False

    def load(self) -> Any:
        """Import the module; return the function or the `typer.Typer`.

        Nearly all that is imported lives as long as the process: to search it for garbage takes a
        fifth of the time of loading, and again of every later collection.
        """
        module, _, name = self.target.partition(":")
        gc.disable()
        try:
            return getattr(import_module(f"recon.cli.{module}"), name)
        finally:
            gc.freeze()
            gc.enable()


COMMANDS = {
    "run": CommandSource("run:run_command", "Run the station until Ctrl+C."),
    "user": CommandSource("users:user_app", "Manage the users of the console on other computers."),
    "status": CommandSource("status:status_command", "Show every vehicle and its telemetry's age."),
    "all-stop": CommandSource(
        "stop_commands:all_stop_command",
        "Hold every vehicle in the air, identified or not. Never stops motors.",
    ),
    "release-stop": CommandSource(
        "stop_commands:release_stop_command", "Release vehicles from an all stop."
    ),
    "hold": CommandSource("stop_commands:hold_command", "Stop vehicles and hold position."),
    "land": CommandSource("stop_commands:land_command", "Land vehicles where they are."),
    "return": CommandSource(
        "stop_commands:return_command",
        "Return vehicles to home, each at its own go-home height, and land.",
    ),
    "fleet-return": CommandSource(
        "fleet_return:fleet_return_command",
        "Return vehicles in separate height layers; they land one at a time.",
    ),
    "side-step": CommandSource(
        "imaging_drone:side_step_command",
        "Fly 25 m aside and back, to tell whether a uniform scene is all sun or all shade.",
    ),
    "relieve": CommandSource(
        "imaging_drone:relieve_command",
        "Relieve an imaging drone, or send it back to its place with a fresh battery.",
    ),
    "goto": CommandSource(
        "steering:goto_command",
        "Fly a vehicle straight to a position.",
        takes_negative_numbers=True,
    ),
    "nudge": CommandSource("steering:nudge_command", "Move a vehicle by a few metres."),
    "fly": CommandSource("missions:fly_command", "Fly a mission from a file."),
    "camera": CommandSource("missions:camera_command", "Start or stop a vehicle's image stream."),
    "plan": CommandSource(
        "plan:plan_command",
        "Plan a survey without a station: rows, speed, time, photos, batteries.",
    ),
    "survey": CommandSource(
        "survey:survey_app",
        "Survey a region: create, resume, estimate, start, pause, abort, status.",
    ),
    "site": CommandSource("site:site_app", "Make, check and fill a site's folder: import, fetch."),
    "when": CommandSource(
        "when:when_command",
        "Show in which hours of the next days sun, hot spot and clouds fit a survey.",
    ),
    "maps": CommandSource(
        "maps:maps_app", "Bring base maps for the console: fetch tiles, check coverage."
    ),
    "zone": CommandSource(
        "zone:zone_app",
        "Keep drones out of a place at once: add, end and list temporary zones.",
    ),
    "take": CommandSource("authority:take_command", "Take control authority for the operator."),
    "release": CommandSource(
        "authority:release_command", "Hand control authority to the pilot or to guidance."
    ),
    "pair": CommandSource(
        "pairing:pair_command",
        "List the apps that wait to be admitted; admit or refuse one.",
    ),
    "preflight": CommandSource("authority:preflight_command", "Show a vehicle's checklist."),
    "dismiss": CommandSource("authority:dismiss_command", "Clear a lost vehicle's hazard area."),
    "separation-hold": CommandSource(
        "authority:separation_hold_command",
        "Turn automatic holds for vehicles on conflicting paths on or off.",
    ),
    "alarms": CommandSource("status:alarms_command", "Show alarms, and acknowledge them."),
    "commands": CommandSource("status:commands_command", "Show recent orders and their outcomes."),
    "audit": CommandSource("audit:audit_app", "Read a station's audit and verify its integrity."),
    "demo": CommandSource(
        "demo:demo_command", "Run the station with simulated drones that survey a field."
    ),
    "sim": CommandSource("sim:sim_app", "Run simulated companion apps that connect to a station."),
    "gateway": CommandSource("gateway:gateway_app", "Show the vehicles to other ground stations."),
    "methods": CommandSource(
        "methods:methods_command",
        "List the methods of detection, forecast and planning, with those of installed packages.",
    ),
    "score": CommandSource(
        "score:score_command",
        "Fly a scenario by the whole station in virtual time and score its methods.",
    ),
    "calibrate": CommandSource(
        "calibrate:calibrate_command",
        "Fit a lens to photos of a chessboard, for `camera-model.txt` of a site.",
    ),
    "detect": CommandSource(
        "detect:detect_command",
        "Find shade in a recorded flight: GeoTIFFs, a contact sheet, cover over time.",
    ),
    "forecast": CommandSource(
        "forecast:forecast_command",
        "Forecast the sun after the newest of recorded maps: a GeoTIFF for each lead.",
    ),
    "verify": CommandSource(
        "verify:verify_command",
        "Run all forecast methods over recorded maps or light sensors, against what came.",
    ),
    "replay": CommandSource(
        "replay:replay_command",
        "Show a recorded flight in the console, compare its outputs, or score other methods on it.",
    ),
    "export": CommandSource(
        "export:export_command",
        "Write a flight's tracks, surveys, maps or figures for other programs.",
    ),
    "tag": CommandSource(
        "tag:tag_command",
        "Tag the photos of a flight: sunlit share, masks, the photos to keep, what to fly again.",
    ),
    "mosaic": CommandSource(
        "mosaic:mosaic_command",
        "Make a mosaic of photos in sun, with what each pixel was taken from.",
    ),
    "shadow-record": CommandSource(
        "shadow_record:shadow_record_command",
        "Write a flight's shade maps, and when each cell was in sun, as GeoTIFFs.",
    ),
    "report": CommandSource(
        "report:report_command",
        "Write a flight's report: coverage in sun, sky, tracks, decisions, alarms, forecasts.",
    ),
    "inspect": CommandSource(
        "inspect:inspect_command",
        "Print the packets of a flight record or of bare bytes, or the lines of the app's log.",
    ),
    "openapi": CommandSource("run:openapi_command", "Print the API's OpenAPI document."),
}
"""Commands in the order of `recon --help`."""


class LazyGroup(TyperGroup):
    """A group that lists its commands by name and summary, and loads the one that is called.

    `ctx` and `formatter` are click's, of the copy of click inside typer.
    """

    def __init__(self, **options: Any) -> None:
        """Register the names, from which a mistyped command gets its suggestions."""
        super().__init__(**{**options, "commands": dict.fromkeys(COMMANDS)})

    def list_commands(self, ctx: Any) -> list[str]:
        """Return every name, without loading anything."""
        return list(COMMANDS)

    def get_command(self, ctx: Any, cmd_name: str) -> Any:
        """Load one command; None when the name is unknown."""
        source = COMMANDS.get(cmd_name)
        if source is None:
            return None
        loaded = source.load()
        app = loaded if isinstance(loaded, typer.Typer) else _app_of(loaded, source)
        command = typer.main.get_command(app)
        command.name = cmd_name
        return command

    def invoke(self, ctx: Any) -> Any:
        """Run a command; an expected error is one sentence and an exit code, no traceback."""
        try:
            return super().invoke(ctx)
        except ReconError as problem:
            code = report_error(problem, f"recon {ctx.invoked_subcommand}")
        raise typer.Exit(code)

    def format_commands(self, ctx: Any, formatter: Any) -> None:
        """Write the summaries into the help page."""
        with formatter.section("Commands"):
            formatter.write_dl([(name, source.summary) for name, source in COMMANDS.items()])


NUMBER = re.compile(r"-(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?")


class ShellCommand(TyperCommand):
    """A command that refuses NaN and infinity, also as a default: bounds let NaN pass."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Check every number that was read."""
        rest: list[str] = super().parse_args(ctx, args)
        for param in self.params:
            value = ctx.params.get(param.name)
            if isinstance(value, float) and not is_finite(value):
                raise typer.BadParameter(f"expected a number, got {value:g}", ctx, param)
        return rest


class TakesNegativeNumbers(ShellCommand):
    """A command whose arguments may be negative numbers, without a `--` before them.

    Western longitudes look like options to a shell. Any other word that begins with a hyphen and
    is not an option is refused as usual.
    """

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Allow unknown options only when all of them are numbers."""
        known = {"--", *ctx.help_option_names}
        known.update(word for param in self.params for word in param.opts)
        odd = [a for a in args if a.startswith("-") and a.partition("=")[0] not in known]
        ctx.ignore_unknown_options = all(NUMBER.fullmatch(word) for word in odd)
        return super().parse_args(ctx, args)


class App(typer.Typer):
    """Commands with plain help pages: formatted ones take longer to load than a stop may wait."""

    def __init__(self, **options: Any) -> None:
        """Take the options of `typer.Typer`."""
        super().__init__(
            rich_markup_mode=None, pretty_exceptions_enable=False, add_completion=False, **options
        )

    def command(self, name: str | None = None, **options: Any) -> Callable[[Function], Function]:
        """Register a function as a command whose numbers are finite."""
        return super().command(name, **{"cls": ShellCommand, **options})


def _app_of(function: Any, source: CommandSource) -> typer.Typer:
    app = App()
    app.command(cls=TakesNegativeNumbers if source.takes_negative_numbers else ShellCommand)(
        function
    )
    return app


app = App(name="recon", cls=LazyGroup, no_args_is_help=True)


@app.callback()
def recon() -> None:
    """A ground control station for several DJI drones over fields."""
