"""Missions that pass the gate's separation rule raise no finding of the separation watchdog.

Fleets are drawn, each mission is judged among those that passed before it, and the accepted ones
are flown as predicted: each starts up to 6 s late and flies a constant track error off its path.
"""

from dataclasses import replace
from random import Random

import numpy as np
import pytest
from tests.examples import family
from tests.safety.traffic import AIR, NOW, SETTINGS, S, aircraft, flies, judged, route, seen

from recon.model.arrays import FloatArray
from recon.model.control import Commanded, Intent
from recon.model.mission import Mission
from recon.model.vehicle import FlightMode, VehicleState
from recon.safety import Traffic
from recon.safety.prediction import Predictor, Trajectory
from recon.safety.prediction.trajectory import END_S, PART, sample
from recon.safety.separation_minima import gate_minima, watchdog_minima
from recon.safety.settings import SafetySettings
from recon.safety.watchdogs import Finding, WatchedVehicle, build_traffic_picture
from recon.safety.watchdogs.separation import separation as separation_watchdog

Place = tuple[float, float, float]
LOOK_S = 0.5
OFF_TRACK_M = 0.3
"""On each axis: two vehicles are 0.85 m nearer than planned, less than the gate's track error."""


class Member:
    """A vehicle and the mission it was approved for."""

    def __init__(self, state: VehicleState, mission: Mission, rng: Random) -> None:
        self.state, self.mission = state, mission
        predictor = Predictor(seen(state), SETTINGS, exactly=True)
        predictor.fly_mission(mission, 0)
        self.trajectory: Trajectory = predictor.writer.trajectory(state.display_name)
        self.starts_s = rng.choice((0.0, rng.uniform(0.0, 6.0)))
        self.off_m = [rng.uniform(-OFF_TRACK_M, OFF_TRACK_M) for _ in range(2)]
        self.off_m.append(rng.uniform(-0.2, 0.2))

    def watched(self, now_s: float) -> WatchedVehicle:
        """Return the vehicle as its telemetry shows it after this time."""
        flown_s = max(0.0, now_s - self.starts_s)
        place, after = self._at(flown_s), self._at(flown_s + 0.01)
        velocity = (after - place) / 0.01 if now_s >= self.starts_s else np.zeros(3)
        rows = self.trajectory.rows
        passed = int(rows[np.searchsorted(rows[:, END_S], flown_s, side="right"), PART])
        passed = passed if passed >= 0 else len(self.mission.waypoints)
        north_m, east_m, up_m = place + self.off_m
        assert self.state.serial is not None
        state = aircraft(
            self.state.serial,
            (north_m, east_m),
            up_m,
            tuple(float(each) for each in velocity),  # type: ignore[arg-type]
            mode=FlightMode.GPS_WAYPOINT if now_s >= self.starts_s else FlightMode.GPS_ATTI,
            now_ns=NOW + round(now_s * S),
        )
        return WatchedVehicle(state, Intent(Commanded.MISSION, mission=self.mission, passed=passed))

    def _at(self, flown_s: float) -> FloatArray:
        found = sample([self.trajectory.rows], [flown_s])
        up_m = 0.5 * (found.low_m + found.high_m)
        return np.array([found.north_m[0, 0], found.east_m[0, 0], up_m[0, 0]])


def rows_mission(rng: Random, row_m: float, height_m: float) -> Mission:
    """Two rows of a survey, one of them on a lane of its own."""
    from_m, to_m = rng.uniform(-80.0, 0.0), rng.uniform(40.0, 160.0)
    ends = [(from_m, row_m), (to_m, row_m)]
    if rng.random() < 0.5:
        ends.reverse()
    return route(*((north, east, height_m) for north, east in ends))


def drawn_mission(rng: Random, height_m: float) -> Mission:
    count = rng.randint(2, 4)
    places = [
        (rng.uniform(-90.0, 90.0), rng.uniform(-90.0, 90.0), height_m + rng.choice((0.0, 0.0, 8.0)))
        for _ in range(count)
    ]
    return route(*places, curved=False)


def approved_members(rng: Random, kind: str) -> list[Member]:
    """Vehicles whose missions passed the rule one after the other; the rest do not fly."""
    members: list[Member] = []
    spacing_m = rng.choice((15.2, 17.1, 17.9, 18.1, 19.0, 22.0))
    for number in range(rng.randint(2, 4)):
        if kind == "rows":
            mission = rows_mission(rng, number * spacing_m, 40.0)
        else:
            mission = drawn_mission(rng, 40.0 + rng.choice((0.0, 6.2, 7.2, 7.6, 9.0)))
        first = mission.waypoints[0]
        state = aircraft(chr(ord("A") + number), (0.0, 0.0), first.height_above_takeoff_m)
        state = replace(
            state, position=replace(state.position, value=_place_of(mission)), link_id=number
        )
        traffic = [Traffic(one.state, flies(one.mission)) for one in members]
        if judged(mission, state, *traffic) is None:
            members.append(Member(state, mission, rng))
    return members


def _place_of(mission: Mission) -> object:
    from recon.model.geo import LatLon

    first = mission.waypoints[0]
    return LatLon(first.latitude_deg, first.longitude_deg)


def findings(members: list[Member], now_s: float) -> list[Finding]:
    watched = [member.watched(now_s) for member in members]
    picture = build_traffic_picture(watched, AIR, SafetySettings(), NOW + round(now_s * S), {})
    return list(separation_watchdog(picture))


@pytest.mark.parametrize("kind", ["rows", "drawn"])
@pytest.mark.parametrize("seeds", family(range(12), range(12, 60)))
def test_approved_missions_fly_without_a_finding(kind: str, seeds: range) -> None:
    flown = 0
    for seed in seeds:
        rng = Random(f"{kind}:{seed}")
        members = approved_members(rng, kind)
        if len(members) < 2:
            continue
        flown += 1
        for look in range(round(60.0 / LOOK_S)):
            found = findings(members, look * LOOK_S)
            assert found == [], (seed, look * LOOK_S, [each.text for each in found])
    assert flown > len(seeds) / 3


def test_the_gate_keeps_more_than_the_watchdog_watches_for() -> None:
    limits, settings = AIR.airspace.limits, SafetySettings()
    gate, watchdog = gate_minima(limits, settings), watchdog_minima(limits, settings.watchdogs)
    assert (watchdog.horizontal_m, watchdog.vertical_m) == (17.0, 7.0)
    assert (gate.horizontal_m, gate.vertical_m) == (18.0, 7.5)


@pytest.mark.parametrize("spacing_m", [15.5, 16.5, 17.5])
def test_rows_within_the_watchdogs_margin_are_refused(spacing_m: float) -> None:
    """The control: the watchdog would hold one of these, so the gate must not pass them."""
    north, beside = route((0.0, 0.0), (200.0, 0.0)), route((0.0, spacing_m), (200.0, spacing_m))
    other = Traffic(aircraft("B", (0.0, spacing_m)), flies(beside))
    assert judged(north, aircraft("A"), other) is not None
