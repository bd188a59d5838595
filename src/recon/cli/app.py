"""The commands, registered."""

import typer

from recon.cli.audit import audit_app
from recon.cli.demo import demo_command
from recon.cli.inspect import inspect_command
from recon.cli.openapi import openapi_command
from recon.cli.operating import add_commands, new_app
from recon.cli.run import run_command
from recon.cli.score import score_command
from recon.cli.sim import sim_command
from recon.cli.sim_proxy import proxy_command
from recon.cli.sim_scenario import scenario_command

app = new_app()
add_commands(app)
app.add_typer(audit_app, name="audit")
app.command("run")(run_command)
app.command("demo")(demo_command)
app.command("score")(score_command)
sim_app = typer.Typer(pretty_exceptions_enable=False, add_completion=False)
sim_app.callback(invoke_without_command=True)(sim_command)
sim_app.command("proxy")(proxy_command)
sim_app.command("scenario")(scenario_command)
app.add_typer(sim_app, name="sim")
app.command("inspect")(inspect_command)
app.command("openapi")(openapi_command)
