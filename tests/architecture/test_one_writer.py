"""Each field of a vehicle's control state is written by one module."""

import ast
from collections.abc import Iterator
from dataclasses import fields
from pathlib import Path

from tests.architecture.source import calls, files, name_of, nodes

from recon.station.state.vehicle_control import ControlChanges, VehicleControl

WRITERS = {
    "authority": "station/control/authority.py",
    "lease": "station/control/operator_lease.py",
    "intent": "station/control/intents.py",
    "tracking": "station/control/mode_tracking.py",
    "stream": "station/steering/stream_ends.py",
    "neutral": "station/steering/neutral_setpoint.py",
    "preflight_override": "station/control/preflight.py",
    "restored": "station/recovery/restart.py",
}
STATION = "station/state/station.py"
CONTROL = "station/state/vehicle_control.py"


def writes(path: Path) -> Iterator[tuple[str, str | None]]:
    """Every field that a call of `with_control` names, with its file; None for `**changes`."""
    for node in nodes(path, ast.Call):
        if isinstance(node.func, ast.Attribute) and node.func.attr == "with_control":
            assert len(node.args) == 1, f"{name_of(path)}: with_control(serial, field=value)"
            yield from ((name_of(path), keyword.arg) for keyword in node.keywords)


def test_each_field_has_one_writer() -> None:
    written = [write for path in files() for write in writes(path)]
    assert {(path, field) for path, field in written} == {
        (path, field) for field, path in WRITERS.items()
    }


def test_every_field_is_named_here_and_in_the_changes() -> None:
    names = {field.name for field in fields(VehicleControl)}
    assert names == set(WRITERS) == set(ControlChanges.__annotations__)


def test_with_control_is_called_where_it_is_named() -> None:
    for path in files():
        called = {id(node.func) for node in nodes(path, ast.Call)}
        named = [node for node in nodes(path, ast.Attribute) if node.attr == "with_control"]
        assert all(id(node) in called for node in named), name_of(path)


def test_nothing_else_makes_or_stores_a_control_state() -> None:
    makers = {
        name_of(path)
        for path in files()
        for _, name in calls(path)
        if name.split(".")[-1] == "VehicleControl"
    }
    assert makers == {CONTROL}
    stored = {"controls", "streaming", "neutral_pending"}
    storing = {
        name_of(path)
        for path in files("station")
        for node in nodes(path, ast.Call)
        if stored & {keyword.arg for keyword in node.keywords}
    }
    assert storing == {STATION}
