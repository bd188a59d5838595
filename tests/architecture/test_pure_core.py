"""The core has no sockets, no event loop, no web framework, no clock and no unseeded chance."""

import ast
from pathlib import Path

import pytest
from tests.architecture.source import PACKAGE, calls, files, imports, name_of, tree

CORE = [
    room
    for room in (
        *("model", "geo", "camera", "wire", "vehicles", "fleet", "safety"),
        *("detection", "forecast", "guidance"),
    )
    if (PACKAGE / room).is_dir()
]
STATION_STEP = [
    *(
        f"station/{room}"
        for room in ("state", "traffic", "steering", "control", "imaging", "operations", "alarms")
    ),
    "station/kernel/step.py",
    "station/kernel/fault_isolation.py",
]
FORBIDDEN = {
    *("asyncio", "datetime", "select", "selectors", "signal", "socket", "socketserver", "ssl"),
    *("subprocess", "threading", "multiprocessing", "concurrent", "time", "secrets", "uuid"),
    *("fastapi", "starlette", "uvicorn", "uvloop", "websockets", "httpx", "requests", "http"),
    *("aiohttp", "anyio", "trio", "queue", "random"),
}
CLOCKS = ("now", "utcnow", "today", "time", "time_ns", "monotonic", "monotonic_ns", "perf_counter")
CORE_FILES = files(*CORE, *STATION_STEP)


def test_the_rooms_of_the_core_are_all_there() -> None:
    rooms = {"model", "geo", "camera", "wire", "vehicles", "fleet", "safety"}
    assert rooms | {"detection", "forecast", "guidance"} <= set(CORE)
    assert len(CORE_FILES) > 200


@pytest.mark.parametrize("path", CORE_FILES, ids=name_of)
class TestEveryFile:
    def test_imports_nothing_with_a_will_of_its_own(self, path: Path) -> None:
        assert {m.split(".")[0] for m in imports(path)} & FORBIDDEN == set()

    def test_never_awaits(self, path: Path) -> None:
        waiting = (ast.AsyncFunctionDef, ast.Await, ast.AsyncFor, ast.AsyncWith)
        assert not [n for n in ast.walk(tree(path)) if isinstance(n, waiting)]

    def test_asks_no_clock_and_draws_no_unseeded_number(self, path: Path) -> None:
        for line, name in calls(path):
            assert "." not in name or name.split(".")[-1] not in CLOCKS, (line, name)
            assert not name.startswith(("np.random.", "numpy.random.")) or _is_seeded(path, line), (
                line,
                name,
            )


def _is_seeded(path: Path, line: int) -> bool:
    """A generator made with a seed is allowed: `default_rng(seed)`."""
    return any(
        isinstance(node, ast.Call)
        and node.lineno == line
        and ast.unparse(node.func).endswith("default_rng")
        and bool(node.args or node.keywords)
        for node in ast.walk(tree(path))
    )


def test_the_scan_would_find_what_it_looks_for() -> None:
    connection = next(path for path in files("link") if path.name == "connection.py")
    assert {m.split(".")[0] for m in imports(connection)} & FORBIDDEN == {
        "asyncio",
        "select",
        "socket",
    }
