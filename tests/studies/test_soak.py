"""The arithmetic and the tables of the soak, on samples by construction; and its site."""

from pathlib import Path

import pytest
from studies.soak.all_stop import AuditTail
from studies.soak.field import drones_and_imagers, write_faults, write_site
from studies.soak.figures import (
    AllStop,
    ProcessSample,
    Sizes,
    Soak,
    faults_of,
    growth_lines,
    growths,
    window_lines,
)
from studies.soak.virtual_days import Tally

from recon.sim.app.fault_file import load_faults
from recon.site import load_site

HOUR_S = 3_600.0
START_BYTES = 200_000_000


def samples(
    share_per_hour: float, role: str = "station", pid: int = 7, from_s: float = 0.0
) -> list[ProcessSample]:
    """A process whose memory grows by this share of its first in an hour, a look a minute."""
    return [
        ProcessSample(
            60.0 * minute,
            role,
            pid,
            round(START_BYTES * (1.0 + share_per_hour * minute / 60.0)),
            30 + minute,
            8,
        )
        for minute in range(61)
        if 60.0 * minute >= from_s
    ]


def stops(*times_ms: float) -> list[AllStop]:
    return [AllStop(60.0 * n, ms) for n, ms in enumerate(times_ms)]


def test_growth_is_that_after_settling_whatever_came_before() -> None:
    settling = [ProcessSample(each.at_s, "station", 7, 10_000_000, 1, 1) for each in samples(0.0)]
    measured = [each for each in settling if each.at_s < 600.0] + samples(0.05, from_s=600.0)
    (found,) = growths(measured, 600.0)
    assert found.share_per_hour == pytest.approx(0.05, rel=0.05)
    assert not found.is_flat


def test_one_large_look_at_the_end_is_no_growth() -> None:
    measured = samples(0.0)
    last = measured[-1]
    measured[-1] = ProcessSample(last.at_s, "station", 7, round(1.04 * START_BYTES), 30, 8)
    assert growths(measured, 600.0)[0].is_flat


@pytest.mark.parametrize(
    ("soak", "word"),
    [
        (Soak(samples(0.005), stops(20.0, 30.0)), None),
        (Soak(samples(-0.3), stops(20.0)), None),
        (Soak(samples(0.02), stops(20.0)), "grows by 2"),
        (Soak(samples(0.0), stops(*[20.0] * 50, 400.0)), "all stop p99"),
        (Soak(samples(0.0)), "not measured"),
        (Soak(samples(0.0), [AllStop(1.0, 20.0, unsent=2)]), "2 packets"),
        (Soak(samples(0.0)[:12], stops(20.0)), "fewer than"),
        (Soak(samples(0.0) + samples(0.0, pid=8), stops(20.0)), "started again, 1 times"),
        (Soak(samples(0.0) + samples(0.0, pid=8)[:9], stops(20.0)), None),
    ],
)
def test_the_verdict_names_each_figure_that_misses(soak: Soak, word: str | None) -> None:
    faults = faults_of(soak, HOUR_S)
    assert len(faults) == (word is not None)
    assert word is None or word in faults[0]


def test_a_part_of_the_run_shows_its_own_all_stops_and_its_last_look() -> None:
    soak = Soak(samples(0.0), stops(10.0, 20.0, 900.0), [Sizes(30.0, 52_000, 9_000_000)])
    lines = window_lines(soak, 0.0, 120.0)
    assert lines[0] == "minutes 0.0 to 2.0"
    assert "state 52 kB, record 9 MB" in lines[1]
    assert "2 all stops: p50 15.0 ms, p99 19.9 ms" in lines[2]
    assert lines[-1].split() == ["station", "200.0", "31", "8"]
    assert growth_lines(soak, HOUR_S)[0].split()[:3] == ["station", "200.0", "MB,"]


def test_the_audit_is_read_on_from_whole_line_to_whole_line(tmp_path: Path) -> None:
    path, tail = tmp_path / "run-000001.jsonl", AuditTail(tmp_path)
    sent = '{"kind":"order.sent","utc":"2026-01-01T00:00:0%d+00:00","details":{"id":%d}}\n'
    path.write_text((sent % (1, 5)).replace(" ", "") + '{"kind":"order.se', "ascii")
    tail.read_on()
    assert set(tail.sent_utc_s) == {5}
    with path.open("a", encoding="ascii") as file:
        file.write('nt","utc":"2026-01-01T00:00:03+00:00","details":{"id":6}}\n' + sent % (4, 5))
    tail.read_on()
    assert tail.lacks({5, 6, 7}) == {7}
    assert tail.sent_utc_s[6] - tail.sent_utc_s[5] == pytest.approx(2.0)


def test_a_fuller_battery_was_changed() -> None:
    tally = Tally()
    for share in (0.9, 0.5, None, 0.4, 1.0, 0.9, 0.95):
        tally.see_batteries({"SIM-1": share})
    assert tally.battery_changes == 1


def test_the_site_has_a_pad_and_a_go_home_height_for_each_vehicle(tmp_path: Path) -> None:
    write_site(tmp_path / "site", 32)
    site = load_site(tmp_path / "site")
    drones, imagers = drones_and_imagers(32)
    assert list(site.imagers) == imagers
    assert {each for each in site.profiles if site.profiles[each].pad} == {*drones, *imagers}
    heights = {site.profiles[each].go_home_height_m for each in drones}
    assert len(heights) == len(drones)


def test_the_fault_script_is_one_that_the_simulator_reads(tmp_path: Path) -> None:
    write_faults(tmp_path / "faults.toml", 60.0, 2.0)
    assert len(load_faults(tmp_path / "faults.toml").chances) == 8
