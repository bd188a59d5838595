"""The package's source files as syntax trees."""

import ast
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import TypeVar

PACKAGE = Path(__file__).parents[2] / "src" / "recon"

NodeT = TypeVar("NodeT", bound=ast.AST)


@cache
def tree(path: Path) -> ast.Module:
    return ast.parse(path.read_text(encoding="utf-8"), filename=str(path))


@cache
def _by_kind(path: Path) -> dict[type[ast.AST], list[ast.AST]]:
    """Walking is what takes time: each file is walked once for all tests."""
    found: dict[type[ast.AST], list[ast.AST]] = {}
    for node in ast.walk(tree(path)):
        found.setdefault(type(node), []).append(node)
    return found


def nodes(path: Path, kind: type[NodeT]) -> list[NodeT]:
    """Every node of a kind in a file."""
    return _by_kind(path).get(kind, [])  # type: ignore[return-value]


def files(*rooms: str) -> list[Path]:
    """Every Python file of these rooms (or single files); of the whole package without any."""
    chosen = [PACKAGE / room for room in rooms] or [PACKAGE]
    found = [p for c in chosen for p in ([c] if c.suffix == ".py" else sorted(c.rglob("*.py")))]
    assert found, f"no files in {rooms}"
    return found


def name_of(path: Path) -> str:
    return str(path.relative_to(PACKAGE))


def imports(path: Path) -> Iterator[str]:
    """Every module a file imports, wherever in it; `from a import b` as a.b."""
    for plain in nodes(path, ast.Import):
        yield from (alias.name for alias in plain.names)
    for node in nodes(path, ast.ImportFrom):
        assert node.level == 0, f"{path}: relative import"
        yield from (f"{node.module}.{alias.name}" for alias in node.names)


def dotted(node: ast.AST) -> str:
    """`a.b.c` of a name or attribute, what cannot be named as ''."""
    if isinstance(node, ast.Name):
        return node.id
    if isinstance(node, ast.Attribute):
        return f"{dotted(node.value)}.{node.attr}"
    return ""


def calls(path: Path) -> Iterator[tuple[ast.Call, str]]:
    """Every call in a file, with what it calls."""
    for node in nodes(path, ast.Call):
        yield node, dotted(node.func)
