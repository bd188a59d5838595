"""The one picture all watchdogs look at."""

from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from recon.model.control import AuthorityHolder, Commanded, Intent
from recon.model.failsafe_matrix import FailsafeCondition
from recon.model.geo import LatLon
from recon.model.severity import Severity
from recon.model.units import NS_PER_S
from recon.model.vehicle import FlightMode, VehicleState
from recon.safety.airspace import PreparedAirspace
from recon.safety.prediction import (
    HazardArea,
    Plane,
    PredictionSettings,
    Predictor,
    VehicleMotion,
    hazard_area_of,
    vehicle_motion,
)
from recon.safety.prediction.trajectory import CURVE, RADIUS_0, RADIUS_1, Row
from recon.safety.separation_minima import SeparationMinima, watchdog_minima
from recon.safety.settings import EnergySettings, GoHomeSettings, SafetySettings, WatchdogSettings
from recon.safety.watchdogs.look_ahead import Braking, LookAhead, look_ahead, next_rows
from recon.safety.watchdogs.reach import Reach, reach_of

_COMING_DOWN_MODES = frozenset(
    {FlightMode.AUTO_LANDING, FlightMode.CONFIRM_LANDING, FlightMode.GO_HOME}
)


@dataclass(frozen=True, slots=True)
class Finding:
    """Something wrong now. The same `key` is the same cause.

    `holds` is the serial of a vehicle to be held for it. `after_s` is how long it must last before
    it is an alarm.
    """

    key: str
    rule: str
    severity: Severity
    vehicle_name: str
    text: str
    serial: str | None = None
    link_id: int | None = None
    holds: str | None = None
    after_s: float = 0.0


@dataclass(frozen=True, slots=True)
class CommandedHold:
    """The station has held a vehicle: since when, and how fast it was then."""

    since_ns: int
    speed_mps: float

    def holds_against(self, intent: Intent) -> bool:
        """Return whether nothing newer has been ordered."""
        return intent.since_ns <= self.since_ns or intent.commanded is Commanded.HOLD


def hold_outcome(held: CommandedHold | None, refused: str) -> str:
    """Return what became of a hold, to follow the vehicle's name; empty when none was given."""
    if refused:
        return f"could not be held ({refused})"
    return "" if held is None else "was ordered to hold"


class WatchedVehicle(NamedTuple):
    """A vehicle that flies or may, and what the station knows besides its state.

    `motion` is None while it has never reported a position; `hazard` is set while telemetry is
    lost. `stick_quiet_s` is the time since the last stick of a stream, None without a stream.
    `hold_refused` is the reason a hold could not be given to it just now. `alarm_only` has the
    conditions for which the site's failsafe matrix asks for an alarm without a hold.
    """

    state: VehicleState
    intent: Intent = Intent()
    holder: AuthorityHolder = AuthorityHolder.OPERATOR
    motion: VehicleMotion | None = None
    hazard: HazardArea | None = None
    held: CommandedHold | None = None
    is_imager: bool = False
    stick_quiet_s: float | None = None
    hold_refused: str = ""
    alarm_only: frozenset[FailsafeCondition] = frozenset()

    @property
    def key(self) -> str:
        """The key of its findings."""
        return self.state.serial or f"link {self.state.link_id}"

    @property
    def name(self) -> str:
        """The display name."""
        return self.state.display_name

    @property
    def is_flying_in_contact(self) -> bool:
        """Whether its telemetry is recent, with a position, and it flies or that is in doubt."""
        state = self.state
        in_doubt = state.is_flying.value is None and state.reported_is_flying.value is False
        is_up = state.is_flying.value is True or in_doubt
        return self.motion is not None and self.hazard is None and is_up

    @property
    def may_continue_mission(self) -> bool:
        """Whether telemetry is lost and its app may continue the mission it was sent."""
        return self.hazard is not None and self.intent.commanded is Commanded.MISSION

    @property
    def is_coming_down(self) -> bool:
        """Whether it lands or returns: it is on its way out of the air."""
        return (
            self.intent.commanded in (Commanded.LAND, Commanded.RETURN)
            or self.state.flight_mode.value in _COMING_DOWN_MODES
        )

    def may_be_held_for(self, condition: FailsafeCondition | None) -> bool:
        """Return whether a hold would be the station's to give: in the air, known, not the pilot's,
        and not left to an alarm by the site; None: no site may leave this to an alarm."""
        return (
            self.is_flying_in_contact
            and condition not in self.alarm_only
            and self.state.is_flying.value is True
            and self.state.serial is not None
            and self.holder is not AuthorityHolder.PILOT
            and not self.hold_refused
        )

    @property
    def hold_outcome(self) -> str:
        """What became of a hold for it, to follow its name; empty when none was given."""
        return hold_outcome(self.held, self.hold_refused)

    def was_held_within_s(self, now_ns: int, seconds: float) -> bool:
        """Return whether the station has held it so lately."""
        return self.held is not None and now_ns - self.held.since_ns < seconds * NS_PER_S

    def finding(
        self, rule: str, severity: Severity, text: str, *, about: str = "", after_s: float = 0.0
    ) -> Finding:
        """Return a finding about this vehicle, which its text names first."""
        return Finding(
            key=f"{rule}:{self.key}{about}",
            rule=rule,
            severity=severity,
            vehicle_name=self.name,
            text=f"{self.name}: {text}",
            serial=self.state.serial,
            link_id=self.state.link_id,
            after_s=after_s,
        )


@dataclass(frozen=True)
class TrafficPicture:
    """Everything that is watched, at one moment.

    `flying` report flight. `lost` have lost telemetry and may continue a mission. `since_ns` is
    the time of each finding's first occurrence, by its key.
    """

    now_ns: int
    watched: tuple[WatchedVehicle, ...]
    flying: tuple[WatchedVehicle, ...]
    lost: tuple[WatchedVehicle, ...]
    airspace: PreparedAirspace
    settings: WatchdogSettings = field(default_factory=WatchdogSettings)
    prediction: PredictionSettings = field(default_factory=PredictionSettings)
    energy: EnergySettings = field(default_factory=EnergySettings)
    go_home: GoHomeSettings = field(default_factory=GoHomeSettings)
    since_ns: Mapping[str, int] = field(default_factory=dict)
    is_hold_on: bool = True

    @property
    def predicted(self) -> tuple[WatchedVehicle, ...]:
        """Return the vehicles of `ahead`."""
        return self.flying + self.lost

    @cached_property
    def reaches(self) -> tuple[Reach, ...] | None:
        """The bounds on `flying`; None while one has none or any vehicle is lost."""
        if any(watched.hazard is not None for watched in self.watched):
            return None
        reaches: list[Reach] = []
        for watched in self.flying:
            motion = watched.motion
            assert motion is not None  # a vehicle in contact has a position
            horizon_s = self.settings.horizon_s
            reach = reach_of(motion, watched.intent, horizon_s, self.prediction)
            if reach is None:
                return None
            reaches.append(reach)
        return tuple(reaches)

    def only(self, numbers: Collection[int]) -> "TrafficPicture":
        """Return the picture with these of `flying` alone, by index: only they are predicted."""
        if len(numbers) == len(self.flying):
            return self  # with what is predicted already
        return replace(self, flying=tuple(self.flying[number] for number in sorted(numbers)))

    @cached_property
    def ahead(self) -> LookAhead:
        """The next seconds of `predicted`, in order."""
        rows = [_next_rows(one, self) for one in self.flying]
        rows += [_lost_rows(one, self) for one in self.lost]
        return look_ahead(rows, self.settings, self.prediction)

    @cached_property
    def ahead_apart(self) -> LookAhead:
        """The same with heights as uncertain as barometers drift: for comparing vehicles."""
        drift_m = [0.0 if one.motion is None else one.motion.drift_m for one in self.predicted]
        if not any(drift_m):
            return self.ahead
        flies, by_m = self.ahead.as_it_flies, np.array(drift_m)[:, np.newaxis]
        wider = replace(flies, low_m=flies.low_m - by_m, high_m=flies.high_m + by_m)
        return replace(self.ahead, as_it_flies=wider)

    @property
    def minima(self) -> SeparationMinima:
        """The minima below which the separation watchdog raises an alarm."""
        return watchdog_minima(self.airspace.airspace.limits, self.settings)

    def lasted_s(self, key: str) -> float:
        """Return how long a finding has been made, 0 for a new one."""
        since_ns = self.since_ns.get(key)
        return 0.0 if since_ns is None else (self.now_ns - since_ns) / NS_PER_S


def build_traffic_picture(
    vehicles: Iterable[WatchedVehicle],
    airspace: PreparedAirspace,
    settings: SafetySettings,
    now_ns: int,
    since_ns: Mapping[str, int],
    *,
    is_hold_on: bool = True,
) -> TrafficPicture:
    """Return the picture of vehicles that fly or may; those on the ground must not be among them.

    Their motions and hazard areas are worked out here.
    """
    known = tuple(vehicles)
    plane = plane_of(airspace, (one.state for one in known))
    watched = tuple(_placed(one, airspace, settings, plane, now_ns) for one in known)
    flying = tuple(one for one in watched if one.is_flying_in_contact)
    lost = tuple(one for one in watched if one.may_continue_mission)
    return TrafficPicture(
        now_ns=now_ns,
        watched=watched,
        flying=flying,
        lost=lost,
        airspace=airspace,
        settings=settings.watchdogs,
        prediction=settings.prediction,
        energy=settings.energy,
        go_home=settings.go_home,
        since_ns=since_ns,
        is_hold_on=is_hold_on,
    )


def plane_of(airspace: PreparedAirspace, states: Iterable[VehicleState]) -> Plane:
    """Return the plane at the site's origin; without a site, at the first vehicle that has a place.

    Where no vehicle has one, it lies anywhere.
    """
    frame = airspace.airspace.frame
    if frame is not None:
        return Plane(frame.origin)
    places = (state.position.value for state in states)
    first = next((place for place in places if place is not None), None)
    return Plane(first or LatLon(0.0, 0.0))


def _placed(
    one: WatchedVehicle,
    airspace: PreparedAirspace,
    settings: SafetySettings,
    plane: Plane,
    now_ns: int,
) -> WatchedVehicle:
    seen = vehicle_motion(one.state, airspace, plane, now_ns, settings.prediction)
    hazard = None if seen is None else hazard_area_of(seen, one.intent, settings.prediction)
    return one._replace(motion=seen, hazard=hazard)


def _next_rows(one: WatchedVehicle, picture: TrafficPicture) -> list[Row]:
    """A hold that the station gave counts from its giving on, until a newer order."""
    assert one.motion is not None  # a vehicle in contact has a position
    intent, braking, held = one.intent, None, one.held
    if held is not None and held.holds_against(intent):
        if not one.is_coming_down:
            intent = Intent(Commanded.HOLD, held.since_ns)
        braking = Braking((picture.now_ns - held.since_ns) / NS_PER_S, held.speed_mps)
    horizon_s, now_ns = picture.settings.horizon_s, picture.now_ns
    return next_rows(one.motion, intent, braking, horizon_s, now_ns, picture.prediction)


def _lost_rows(one: WatchedVehicle, picture: TrafficPicture) -> list[Row]:
    """The mission it was sent, flown on: anywhere within what time has made of its place."""
    motion, prediction = one.motion, picture.prediction
    assert motion is not None  # only a vehicle with a position has a hazard area
    predictor = Predictor(motion, prediction, until_s=picture.settings.horizon_s)
    predictor.follow(one.intent)
    off_m = prediction.time_uncertainty * motion.age_s * motion.speed_mps
    return [
        (*row[:RADIUS_0], row[RADIUS_0] + off_m, row[RADIUS_1] + off_m, *row[CURVE:])
        for row in predictor.writer.rows
    ]
