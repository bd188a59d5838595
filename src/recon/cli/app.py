"""The commands, registered."""

import typer

from recon.cli.demo import demo_command
from recon.cli.inspect import inspect_command
from recon.cli.openapi import openapi_command
from recon.cli.run import run_command
from recon.cli.sim import sim_command

app = typer.Typer(
    name="recon",
    help="A ground control station for several DJI drones over fields.",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    add_completion=False,
)
app.command("run")(run_command)
app.command("demo")(demo_command)
app.command("sim")(sim_command)
app.command("inspect")(inspect_command)
app.command("openapi")(openapi_command)
