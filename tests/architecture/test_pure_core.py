"""The core has no sockets, no event loop, no clock and no unseeded chance.

import-linter forbids rooms what `pyproject.toml` names; here are single files of the station too,
what needs no import, and more modules.
"""

import ast

from tests.architecture.source import PACKAGE, calls, files, imports, name_of, nodes

CORE = (
    *("model", "geo", "camera", "wire", "vehicles", "fleet", "safety"),
    *("detection", "forecast", "guidance"),
)
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
WAITING = (ast.AsyncFunctionDef, ast.Await, ast.AsyncFor, ast.AsyncWith)
GATEWAY_SHELL = {"run.py", "peers.py"}
GATEWAY_STEP = [path for path in files("gateway/mavlink") if path.name not in GATEWAY_SHELL]
CORE_FILES = [*files(*CORE, *STATION_STEP), *GATEWAY_STEP]


def test_it_imports_no_clock_socket_thread_or_chance_and_never_awaits() -> None:
    assert len(CORE_FILES) > 200
    for path in CORE_FILES:
        found = {module.split(".")[0] for module in imports(path)} & FORBIDDEN
        found |= {kind.__name__ for kind in WAITING if nodes(path, kind)}
        assert found == set(), name_of(path)


def test_it_asks_no_clock_and_draws_no_unseeded_number() -> None:
    for path in CORE_FILES:
        for call, name in calls(path):
            where = f"{name_of(path)}:{call.lineno} {name}"
            assert "." not in name or name.split(".")[-1] not in CLOCKS, where
            is_drawn = name.startswith(("np.random.", "numpy.random."))
            is_seeded = name.endswith("default_rng") and bool(call.args or call.keywords)
            assert not is_drawn or is_seeded, where


def test_the_scan_would_find_what_it_looks_for() -> None:
    connection = PACKAGE / "link/connection.py"
    assert {m.split(".")[0] for m in imports(connection)} & FORBIDDEN == {
        "asyncio",
        "select",
        "socket",
    }
