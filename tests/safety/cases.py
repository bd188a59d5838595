"""Commands and situations for the gate, by construction."""

from dataclasses import replace

from tests.ready import ready_airspace

from recon.model.command import (
    Body,
    Command,
    FlyMission,
    GoTo,
    HoldPosition,
    Hover,
    LandNow,
    Nudge,
    Refusal,
    ReturnHome,
    StartCamera,
    StickFrame,
    StopCamera,
    VirtualStick,
)
from recon.model.geo import GeoPoint, LatLon
from recon.model.mission import Mission, Waypoint
from recon.model.units import Stamped
from recon.model.vehicle import (
    AltitudeReference,
    Attitude,
    BatteryWarning,
    Failsafe,
    FlightMode,
    VehicleProfile,
    VehicleState,
    VelocityNed,
)
from recon.safety import ApprovedCommand, ClaimingLink, PreparedAirspace, Situation
from recon.safety.situation import ClockReading, StationFacts

S = 1_000_000_000
NOW = 100 * S

PLACE = LatLon(42.0, -93.6)
"""Where the vehicle is, and where it took off."""

TAKEOFF = VehicleProfile(
    "A",
    waypoint_altitude=AltitudeReference.TAKEOFF,
    endurance_s=1_500.0,
    go_home_height_m=60.0,
    failsafe=Failsafe.GO_HOME,
    camera_interval_s=2.0,
)
WGS84 = replace(TAKEOFF, waypoint_altitude=AltitudeReference.WGS84)

AIRSPACE = PreparedAirspace(ready_airspace(GeoPoint(42.0, -93.6, 270.0)))
FACTS = StationFacts(clock=ClockReading(1_780_000_000 * S))
"""A fence far away, and a clock that was set: nothing on the checklist fails."""

STICK = VirtualStick(StickFrame.GROUND, 90.0, 1.0, 2.0, 30.0, 1.0)
ZERO = replace(STICK, velocity_x_mps=0.0, velocity_y_mps=0.0, height_above_takeoff_m=40.0)


def waypoint(north_m: float = 0.0, **changes: object) -> Waypoint:
    """A waypoint this far north of a fixed place; 1 m is about 9.0e-6 degrees of latitude."""
    values: dict[str, object] = {
        "latitude_deg": 42.0 + north_m / 111_070.7,
        "longitude_deg": -93.6,
        "height_above_takeoff_m": 40.0,
        "speed_mps": 5.0,
    }
    return Waypoint(**{**values, **changes})  # type: ignore[arg-type]


def mission(*waypoints: Waypoint, curved: bool = False) -> FlyMission:
    return FlyMission(Mission(waypoints or (waypoint(0.0), waypoint(50.0)), curved=curved))


MOVES: list[Body] = [
    mission(),
    STICK,
    GoTo(PLACE, 40.0, 5.0),
    Nudge(1.0, 0.0, 0.0),
    HoldPosition(),
]
STOPS: list[Body] = [Hover(), LandNow(), ReturnHome(), StartCamera(1.0), StopCamera()]
"""An order of each kind that sets a vehicle in motion, and of each that does not."""


def command(body: Body, *, takeoff: bool = False, expires_at_ns: int = NOW + 5 * S) -> Command:
    return Command(1, body, "test", NOW, expires_at_ns, serial="A", takeoff=takeoff)


def vehicle(
    profile: VehicleProfile | None = TAKEOFF,
    *,
    flying: bool | None = True,
    age_s: float = 0.1,
    now_ns: int = NOW,
    offset_m: float | None = 260.0,
    offset_at_takeoff_m: float | None = 260.0,
    **changes: object,
) -> VehicleState:
    """A vehicle 40 m over the place where it took off, or there on the ground; all values of one
    age. `changes` are fields of its state, made stamped with that age where they must be."""
    at_ns = now_ns - round(age_s * S)
    state = VehicleState(
        serial="A",
        link_id=1,
        profile=profile,
        is_flying=Stamped(flying, at_ns),
        position=Stamped(PLACE, at_ns),
        height_above_takeoff_m=Stamped(0.0 if flying is False else 40.0, at_ns),
        velocity_ned=Stamped(VelocityNed(0.0, 0.0, 0.0), at_ns),
        attitude=Stamped(Attitude(0.0, 0.0, 0.0), at_ns),
        battery_fraction=Stamped(0.9, at_ns),
        battery_warning=Stamped(BatteryWarning.NONE, at_ns),
        gnss_satellite_count=Stamped(14, at_ns),
        gnss_signal_level=Stamped(4, at_ns),
        wind_level=Stamped(0, at_ns),
        flight_mode=Stamped(FlightMode.GPS_ATTI, at_ns),
        core_received_at_ns=at_ns,
        extended_received_at_ns=at_ns,
        altitude_offset_m=Stamped(offset_m, at_ns),
        altitude_offset_at_takeoff_m=offset_at_takeoff_m,
        takeoff_point=PLACE,
    )
    stamped = {
        name: Stamped(value, at_ns)
        for name, value in changes.items()
        if isinstance(getattr(state, name), Stamped) and not isinstance(value, Stamped)
    }
    return replace(state, **{**changes, **stamped})  # type: ignore[arg-type]


def situation(state: VehicleState | None = None, *rivals: Stamped[bool]) -> Situation:
    """The vehicle on link 1; each rival on link 2, 3, ..."""
    state = state or vehicle()
    others = tuple(ClaimingLink(number, flying) for number, flying in enumerate(rivals, start=2))
    state = replace(state, rival_link_ids=tuple(claiming_link.link_id for claiming_link in others))
    claiming_links = (ClaimingLink(1, state.is_flying), *others)
    return Situation(NOW, state, claiming_links, airspace=AIRSPACE, facts=FACTS)


def approved(judged: ApprovedCommand | Refusal) -> ApprovedCommand:
    assert isinstance(judged, ApprovedCommand), judged
    return judged


def refused_by(judged: ApprovedCommand | Refusal) -> str:
    assert isinstance(judged, Refusal), judged
    assert judged.reason
    return judged.rule
