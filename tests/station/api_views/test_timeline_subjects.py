"""The timeline's subjects: each entry that the station writes is listed under one of them."""

import ast
import re
from collections.abc import Iterator
from typing import get_args

from tests.architecture.source import files, tree

from recon.station.api_views.audit_service import KINDS_OF
from recon.station.state.imager_motion import AnyMotion

RULES = tuple(kind.rule for kind in get_args(AnyMotion))
FROM_NAMES = {
    "{what}": ("authority", "preflight"),
    "{motion.rule}": RULES,
    "{kind.rule}": RULES,
}
"""What begins a kind that a function is given, by the expression."""

KIND = re.compile(r"([a-z_]+|\{[a-z_.]+\})\.[a-z_{}.]+")


def strings(node: ast.AST) -> Iterator[str]:
    for each in ast.walk(node):
        if isinstance(each, ast.JoinedStr):
            yield ast.unparse(each)[2:-1]
        elif isinstance(each, ast.Constant) and isinstance(each.value, str):
            yield each.value


def kinds() -> Iterator[str]:
    """Every kind in the modules that write entries, with braces where a value is filled in."""
    for path in files("station", "record/audit/audit.py", "record/audit/audit_log.py"):
        module = tree(path)
        names = {each.id for each in ast.walk(module) if isinstance(each, ast.Name)}
        if "AuditEntry" in names or path.name == "audit.py":
            found = (KIND.fullmatch(text) for text in strings(module))
            for match in filter(None, found):
                for begins in FROM_NAMES.get(match[1], (match[1],)):
                    yield match[0].replace(match[1], begins, 1)


def test_each_kind_that_is_written_has_exactly_one_subject() -> None:
    written = set(kinds())
    assert {"lease.taken_over", "move_upwind.{stage}", "survey.is_{phase}"} <= written
    assert {"authority.refused", "station.started", "audit.lost", "site.redrawn"} <= written
    subjects = {
        kind: [subject for subject, begins in KINDS_OF.items() if kind.startswith(begins)]
        for kind in written
    }
    assert {kind: found for kind, found in subjects.items() if len(found) != 1} == {}


def test_each_subject_begins_as_a_kind_that_is_written() -> None:
    written = set(kinds())
    begins = {each for kinds in KINDS_OF.values() for each in kinds}
    assert {each for each in begins if not any(kind.startswith(each) for kind in written)} == set()
