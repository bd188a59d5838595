"""Files that come with Recon: inside the installed package, or in a checkout."""

from pathlib import Path
from typing import Annotated

import typer

import recon
from recon.model.errors import ReconError

PACKAGE = Path(recon.__file__).parent
CHECKOUT = PACKAGE.parent.parent
SCENARIO_SUFFIX = ".toml"


def console_folder() -> Path | None:
    """Return the folder of the built console; None where it is not built."""
    for folder in (PACKAGE / "console", CHECKOUT / "web" / "dist"):
        if (folder / "index.html").is_file():
            return folder
    return None


def scenarios_folder() -> Path:
    """Return the folder of Recon's own scenarios."""
    for folder in (PACKAGE / "scenarios", CHECKOUT / "scenarios"):
        if folder.is_dir():
            return folder
    raise ReconError(f"{PACKAGE}: expected scenarios beside the package, got none: install again")


def scenario_file(named: str) -> Path:
    """Return a scenario's file: of this path, else Recon's own, as `cumulus-40`."""
    name = named.removeprefix("scenarios/").removesuffix(SCENARIO_SUFFIX)
    path, own = Path(named), scenarios_folder() / f"{name}{SCENARIO_SUFFIX}"
    return own if own.is_file() and not path.is_file() else path


ScenarioArgument = Annotated[
    Path,
    typer.Argument(
        parser=scenario_file,
        metavar="SCENARIO",
        help="Scenario file, or name of one of Recon's own, as cumulus-40.",
    ),
]
