"""Offsets of cameras' clocks against tracks by construction."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.product.made_flight import (
    ONE,
    OTHER,
    START_NS,
    Rows,
    times_s,
    track,
)

from recon.model.units import NS_PER_S
from recon.product.clock import Clocks, Shots, clocks_of, offset_text, times_of
from recon.product.flight import RecordedTrack

TRACKS = {way.serial: track(way) for way in (ONE, OTHER)}


def shots(
    ahead_s: float, way: Rows = ONE, step_s: float = 1.0, sigma_m: float = 1.0, seed: int = 1
) -> tuple[Shots, np.ndarray]:
    """Photos by a clock so far ahead, and their true times since the start."""
    at_s = times_s(way)
    east, north, _yaw = way.place(at_s)
    random = np.random.default_rng(seed)
    east, north = (each + random.normal(0.0, sigma_m, len(at_s)) for each in (east, north))
    clock_ns = START_NS + np.rint((at_s + ahead_s) * NS_PER_S).astype(np.int64)
    if step_s:
        clock_ns = clock_ns // round(step_s * NS_PER_S) * round(step_s * NS_PER_S)
    return Shots(clock_ns, east, north, step_s), at_s


def only(found: Clocks) -> float:
    assert found.reason == ""
    (fit,) = found.fits
    return fit.offset_s


@settings(max_examples=25, deadline=None)
@given(st.floats(-43_200.0, 43_200.0), st.integers(0, 1000))
def test_any_clock_within_twelve_hours_is_found_to_a_second(ahead_s: float, seed: int) -> None:
    taken, at_s = shots(ahead_s, seed=seed)
    found = clocks_of(taken, TRACKS, 0)
    assert only(found) == pytest.approx(-ahead_s, abs=0.8)
    (fit,) = found.fits
    assert fit.serial == "SIM-1"
    assert abs(fit.offset_s + ahead_s) < 3.0 * fit.sigma_s
    true_ns = START_NS + np.rint(at_s * NS_PER_S)
    late_s = (times_of(taken, TRACKS["SIM-1"], fit, 0) - true_ns[fit.photos]) / NS_PER_S
    assert np.abs(late_s).mean() < 0.3


@pytest.mark.parametrize("zone_s", [-43_200, -18_000, 3_600, 7_200, 19_800, 50_400])
def test_time_zones_and_daylight_saving_are_found(zone_s: int) -> None:
    taken, _at_s = shots(float(zone_s), OTHER, step_s=0.001)
    assert only(clocks_of(taken, TRACKS, 0)) == pytest.approx(-zone_s, abs=0.3)


def test_utc_ahead_of_station_time_is_taken_off() -> None:
    taken, _at_s = shots(12.0)
    ahead_ns = 1_750_000_000 * NS_PER_S
    taken = replace(taken, clock_ns=taken.clock_ns + ahead_ns)
    assert only(clocks_of(taken, TRACKS, ahead_ns)) == pytest.approx(-12.0, abs=0.8)


def test_a_drone_that_hovers_fixes_no_offset() -> None:
    at_ns = START_NS + np.arange(0, 600 * NS_PER_S, NS_PER_S // 10)
    hover = RecordedTrack("SIM-1", at_ns, *(np.full(len(at_ns), v) for v in (3.0, 4.0, 60.0, 0.0)))
    clock_ns = START_NS + (100 + 2 * np.arange(40)) * NS_PER_S
    found = clocks_of(Shots(clock_ns, np.full(40, 3.2), np.full(40, 4.1), 1.0), {"SIM-1": hover}, 0)
    assert found.fits == ()
    assert "two clock offsets fit" in found.reason or "only to" in found.reason
    assert "--clock-offset" in found.reason


def test_rows_flown_twice_alike_are_refused_rather_than_guessed() -> None:
    once = track(ONE)
    again_ns = once.at_ns + 900 * NS_PER_S
    both = RecordedTrack(
        "SIM-1",
        np.concatenate([once.at_ns, again_ns]),
        *(np.tile(each, 2) for each in (once.east_m, once.north_m, once.height_m, once.yaw_deg)),
    )
    taken, _at_s = shots(3_600.0)
    found = clocks_of(taken, {"SIM-1": both}, 0)
    assert found.fits == ()
    assert "two clock offsets fit equally well" in found.reason


def test_photos_of_two_drones_on_one_card_are_separated() -> None:
    one, _times = shots(40.0)
    other, _times = shots(40.0, OTHER)
    mixed = Shots(
        *(
            np.concatenate([getattr(one, name), getattr(other, name)])
            for name in ("clock_ns", "east_m", "north_m")
        ),
        1.0,
    )
    found = clocks_of(mixed, TRACKS, 0)
    assert sorted(fit.serial for fit in found.fits) == ["SIM-1", "SIM-2"]
    assert all(abs(fit.offset_s + 40.0) < 0.8 for fit in found.fits)
    by_serial = {fit.serial: set(fit.photos.tolist()) for fit in found.fits}
    assert len(by_serial["SIM-1"] & set(range(len(one)))) > 0.95 * len(one)
    assert len(by_serial["SIM-2"] - set(range(len(one)))) > 0.95 * len(other)


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        (lambda s: replace(s, clock_ns=s.clock_ns + 50 * 3600 * NS_PER_S), "another day"),
        (lambda s: replace(s, clock_ns=s.clock_ns - 50 * 3600 * NS_PER_S), "another day"),
        (lambda s: replace(s, east_m=s.east_m + 20_000.0), "another field"),
        (lambda s: replace(s, east_m=s.north_m, north_m=-s.east_m + 13.0), "another flight"),
        (lambda s: s.chosen(np.arange(3)), "at least 5 photos"),
    ],
)
def test_photos_of_elsewhere_are_refused_with_a_reason(change, sentence: str) -> None:
    taken, _at_s = shots(0.0)
    found = clocks_of(change(taken), TRACKS, 0)
    assert found.fits == ()
    assert sentence in found.reason
    assert len(found.left) == len(change(taken))


@pytest.mark.parametrize(
    ("seconds", "text"),
    [
        (3_599.97, "+1 h 00 min 00.0 s"),
        (-18_037.42, "-5 h 00 min 37.4 s"),
        (0.04, "+0 h 00 min 00.0 s"),
    ],
)
def test_offsets_are_shown_in_hours(seconds: float, text: str) -> None:
    assert offset_text(seconds) == text
