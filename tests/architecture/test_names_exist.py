"""Benches, studies, examples and tools import names that exist: no test run loads all of them."""

import ast
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
SCRIPTS = [
    path
    for folder in ("benches", "studies", "examples", "tools")
    for path in sorted((ROOT / folder).rglob("*.py"))
]


OURS = ("recon", "tests", "benches", "studies")


@pytest.mark.parametrize("path", SCRIPTS, ids=lambda path: str(path.relative_to(ROOT)))
def test_every_name_imported_from_the_project_exists(path: Path) -> None:
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if not isinstance(node, ast.ImportFrom) or node.module is None:
            continue
        if node.module.split(".")[0] not in OURS:
            continue
        module = import_module(node.module)
        for alias in node.names:
            known = hasattr(module, alias.name) or find_spec(f"{node.module}.{alias.name}")
            assert known, f"line {node.lineno}: {node.module} has no {alias.name}"
