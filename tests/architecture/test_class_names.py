"""One class name stands for one thing: a reader finds it by its name alone."""

import ast
from collections import defaultdict

from tests.architecture.source import files, name_of, nodes

SHARED = {
    "Station": "client/station.py is the public handle, station/state/station.py the state",
}


def test_class_names_are_unique() -> None:
    places = defaultdict(list)
    for path in files():
        for node in nodes(path, ast.ClassDef):
            places[node.name].append(f"{name_of(path)}:{node.lineno}")
    shared = {name: where for name, where in places.items() if len(where) > 1}
    assert shared.keys() == SHARED.keys(), shared
