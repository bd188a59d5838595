"""Methods by name: `recon methods` lists them, and other commands check the names given."""

from collections.abc import Mapping
from typing import Any

from recon.cli.output import print_line, print_warning, printable
from recon.detection import DETECTORS
from recon.forecast import FORECASTERS
from recon.guidance.survey import PLANNERS
from recon.model.errors import RecordError
from recon.model.methods import MethodRegistry

KINDS: Mapping[str, MethodRegistry[Any]] = {
    "detection": DETECTORS,
    "forecast": FORECASTERS,
    "planner": PLANNERS,
}


def methods_command() -> None:
    """List the methods of detection, forecast and planning, with those of installed packages."""
    for kind, methods in KINDS.items():
        for name in methods:
            point = methods.outside.get(name)
            source = None if point is None else point.dist
            package = "" if source is None else f" ({source.name} {source.version})"
            print_line(printable(f"{kind}: {name}{package}"))
    warn_of_methods()


def warn_of_methods() -> None:
    """Print why methods of installed packages are left out."""
    for methods in KINDS.values():
        for problem in methods.problems:
            print_warning(printable(problem))


def check_methods(detection: str, forecast: str) -> None:
    """Raise `RecordError` for a name of no method, and `MethodError` for one of no use.

    Prints which names of installed packages are not taken; of theirs only these two are imported.
    """
    for each in KINDS.values():
        for refusal in each.refusals:
            print_warning(printable(refusal))
    for option, methods, name in (
        ("--detection", DETECTORS, detection),
        ("--forecast", FORECASTERS, forecast),
    ):
        if name not in methods:
            raise RecordError(f"{option}: expected {' or '.join(methods)}, got {name!a}")
        methods[name]
