"""The command line: `recon run`, `demo`, `sim`, `all-stop`, `fly` and more; see `recon --help`."""

import sys
from importlib import import_module

import typer

from recon.cli.operating import COMMANDS, GROUPS, operating_app
from recon.client.errors import ClientError
from recon.model.errors import ReconError


def main() -> None:
    """Run the command line; what goes wrong is one sentence and an exit code, no traceback."""
    try:
        _app(sys.argv[1:2])()
    except ClientError as problem:
        print(f"recon: {problem}", file=sys.stderr)
        sys.exit(2)
    except ReconError as problem:
        print(f"recon: {problem}", file=sys.stderr)
        sys.exit(1)
    except KeyboardInterrupt:
        sys.exit(130)


def _app(first_word: list[str]) -> typer.Typer:
    """Return the commands of a running station alone when one of them is meant: see `operating`."""
    if first_word and first_word[0] in (*COMMANDS, *GROUPS):
        return operating_app()
    if first_word == ["audit"]:
        reading = operating_app()
        reading.add_typer(import_module("recon.cli.audit").audit_app, name="audit")
        return reading
    # Loaded only when it is needed: the station, its libraries and the simulator take seconds.
    app: typer.Typer = import_module("recon.cli.app").app
    return app
