"""Whether the station gave an order automatically: worded and read in one place."""

import ast

from tests.architecture.source import files, name_of, nodes

from recon.model.command import issued_by_station

KERNEL = "station/kernel/"
"""Words three of its orders itself."""


def test_one_module_words_the_stations_own_orders() -> None:
    found = {
        name_of(path)
        for path in files()
        for node in nodes(path, ast.Constant)
        if str(node.value).startswith(issued_by_station(""))
    }
    assert {path for path in found if not path.startswith(KERNEL)} == {"model/command.py"}


def test_no_other_module_reads_it_from_the_text() -> None:
    found = {
        name_of(path)
        for path in files()
        for node in nodes(path, ast.Attribute)
        if node.attr == "startswith" and ast.unparse(node.value).endswith("issued_by")
    }
    assert found == {"model/command.py"}
