"""Fault files: what is asked for, what chance makes of it, and what is wrong with a bad one."""

from dataclasses import replace
from math import inf
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from recon.model.geo import GeoPoint
from recon.sim.app.fault_file import load_faults, read_faults
from recon.sim.app.faults import FaultKind, InjectedFault, RandomFault, draw_faults
from recon.sim.errors import FaultError
from recon.sim.fleet import SimulationConfig, build_fleet

GOOD = b"""
# A storm.
[[fault]]
name = "gnss-loss"
vehicle = "SIM-2"
start_s = 30
duration_s = 10.5

[[fault]]
name = "no-ack"
vehicle = 3

[[chance]]
name = "telemetry-dropout"
per_hour = 60
duration_s = [1, 5]
from_s = 100
until_s = 3700
"""
DROPOUTS = RandomFault(
    kind=FaultKind.TELEMETRY_DROPOUT,
    vehicle="*",
    per_hour=60.0,
    shortest_s=1.0,
    longest_s=5.0,
    from_s=100.0,
    until_s=3_700.0,
    source="storm.toml: line 13: ",
)
CONFIG = SimulationConfig(home=GeoPoint(41.9, -93.6, 275.0), vehicle_count=3)


def test_a_file_is_read() -> None:
    script = read_faults(GOOD, "storm.toml")
    assert script.faults == (
        InjectedFault(FaultKind.GNSS_LOSS, "SIM-2", 30.0, 10.5),
        InjectedFault(FaultKind.NO_ACK, "3", 0.0, inf),
    )
    assert script.chances == (DROPOUTS,)
    assert [fault.source for fault in script.faults] == [
        "storm.toml: line 3: ",
        "storm.toml: line 9: ",
    ]


def test_every_fault_has_its_name_in_a_file() -> None:
    for kind in FaultKind:
        (fault,) = read_faults(f"[[fault]]\nname = '{kind.value}'".encode(), "f").faults
        assert fault.kind is kind


@pytest.mark.parametrize(
    ("text", "line", "words"),
    [
        ("[[fault]]\nname = 'gremlins'", 2, "name: expected one of ack-then-nothing"),
        ("[[fault]]\n\nvehicle = 'SIM-1'", 1, "name: expected one of"),
        ("[[fault]]\nname = 'no-ack'\nstart_s = -1", 3, "start_s: expected a number of 0 to"),
        ("[[fault]]\nname = 'no-ack'\nstart_s = true", 3, "start_s: expected a number"),
        ("[[fault]]\nname = 'no-ack'\nduration_s = nan", 3, "got nan"),
        ("[[fault]]\nname = 'no-ack'\nvehicle = 1.5", 3, "vehicle: expected a serial"),
        ("[[fault]]\nname = 'no-ack'\nwhen = 3", 3, "when: expected only the keys name, vehicle"),
        ("[[fault]]\nname = 'no-ack'\n[[chance]]\nname = 'no-ack'", 3, "per_hour: expected"),
        ("[[chance]]\nname = 'bursts'\nper_hour = 1", 1, "duration_s: expected seconds, or"),
        (
            "[[chance]]\nname = 'bursts'\nper_hour = 1\nduration_s = [5, 1]",
            4,
            "duration_s: expected seconds, or [least, most], got [5, 1]",
        ),
        (
            "[[chance]]\nname = 'bursts'\nper_hour = 1\nduration_s = 1\nfrom_s = 9\nuntil_s = 8",
            6,
            "until_s: expected 9 or more",
        ),
        ("\n[fault]\nname = 'no-ack'", 2, "expected [[fault]] and [[chance]] tables"),
        ("\n\nfaults = 3", 3, "expected [[fault]] and [[chance]] tables, got 'faults'"),
        ("fault = [3]", 1, "expected a [[fault]] table, got a value"),
        ("[[fault]]\nname = no-ack", 2, "expected TOML"),
        ("[[fault]]\nname = 'no-ack'\nname = 'bursts'", 3, "expected TOML"),
    ],
)
def test_a_bad_file_is_reported_by_line(text: str, line: int, words: str) -> None:
    with pytest.raises(FaultError) as caught:
        read_faults(text.encode(), "bad.toml")
    message = str(caught.value)
    assert message.startswith(f"bad.toml: line {line}: ")
    assert words in message


def test_bytes_that_are_not_text_are_reported_by_line() -> None:
    with pytest.raises(FaultError, match=r"x: line 3: expected text in UTF-8"):
        read_faults(b"# one\n# two\n# \xff", "x")


def test_a_missing_or_too_large_file_is_reported(tmp_path: Path) -> None:
    with pytest.raises(FaultError, match="expected a readable file"):
        load_faults(tmp_path / "none.toml")
    large = tmp_path / "large.toml"
    large.write_bytes(b"#" * 2_000_000)
    with pytest.raises(FaultError, match="expected at most"):
        load_faults(large)


words = st.sampled_from(
    ["[[fault]]", "[[chance]]", "[fault]", "name = 'bursts'", "per_hour = 2", "duration_s = 1"]
)
keys = st.sampled_from(["name", "vehicle", "start_s", "duration_s", "per_hour", "until_s", "x"])
values = st.sampled_from(["1", "-1", "1e400", "nan", "[1,2]", "[]", "{}", "''", "9" * 400])
lines = words | st.builds("{} = {}".format, keys, values) | st.text(max_size=20)


@given(st.lists(lines, max_size=8).map("\n".join).map(str.encode) | st.binary(max_size=80))
def test_any_file_is_read_or_reported(data: bytes) -> None:
    message = ""
    try:
        read_faults(data, "any.toml")
    except FaultError as problem:
        message = str(problem)
    assert not message or (message.startswith("any.toml: ") and "expected" in message)


def test_unclosed_brackets_are_reported() -> None:
    with pytest.raises(FaultError, match="expected TOML"):
        read_faults(b"fault = " + b"[" * 100_000, "deep.toml")


def test_random_faults_have_the_configured_rate_and_duration() -> None:
    drawn = [draw_faults((DROPOUTS,), seed, "SIM-1", 1) for seed in range(100)]
    faults = [fault for one in drawn for fault in one]
    assert len(faults) / 100 == pytest.approx(60.0, abs=3.0)
    assert all(100.0 < fault.start_s < 3_700.0 for fault in faults)
    assert all(1.0 <= fault.duration_s <= 5.0 for fault in faults)
    assert sum(fault.duration_s for fault in faults) / len(faults) == pytest.approx(3.0, abs=0.1)


def test_random_faults_depend_on_seed_and_vehicle() -> None:
    def drawn(seed: int) -> list[tuple[InjectedFault, ...]]:
        config = replace(CONFIG, seed=seed, chances=(DROPOUTS,))
        return [app.settings.faults for app in build_fleet(config, 0)]

    assert drawn(1) == drawn(1)
    assert drawn(1) != drawn(2)
    assert len(set(drawn(1))) == 3


def test_random_entries_are_independent() -> None:
    other = replace(DROPOUTS, kind=FaultKind.BURSTS)
    alone = draw_faults((DROPOUTS,), 1, "SIM-1", 1)
    beside = draw_faults((DROPOUTS, other), 1, "SIM-1", 1)
    assert beside[: len(alone)] == alone


@pytest.mark.parametrize("kind", ["faults", "chances"])
def test_an_unknown_vehicle_is_reported_with_its_line(kind: str) -> None:
    script = read_faults(GOOD.replace(b'"SIM-2"', b'"SIM-9"'), "storm.toml")
    asked = {
        "faults": script.faults,
        "chances": tuple(replace(one, vehicle="SIM-9") for one in script.chances),
    }
    line = {"faults": 3, "chances": 13}[kind]
    with pytest.raises(FaultError, match=f"storm.toml: line {line}: fault .*expected a vehicle"):
        build_fleet(replace(CONFIG, **{kind: asked[kind]}), 0)
