"""Vehicles in the air of one flat site, in metres north and east of its origin."""

from recon.geo.distance import moved_m
from recon.model.airspace import Airspace
from recon.model.command import Body, Command, FlyMission, Refusal
from recon.model.control import Commanded, Intent
from recon.model.geo import GeoPoint, LatLon, LocalFrame
from recon.model.mission import Mission, Waypoint
from recon.model.units import Stamped
from recon.model.vehicle import (
    Attitude,
    Failsafe,
    FlightMode,
    VehicleProfile,
    VehicleState,
    VelocityNed,
)
from recon.safety import ClaimingLink, PreparedAirspace, Situation, Traffic
from recon.safety.prediction import Plane, PredictionSettings, VehicleMotion, vehicle_motion
from recon.safety.rules.separation import separation

S = 1_000_000_000
NOW = 100 * S
ORIGIN = LatLon(42.0, -93.6)
FRAME = LocalFrame(GeoPoint(42.0, -93.6, 275.0))
AIR = PreparedAirspace(Airspace(frame=FRAME))
SETTINGS = PredictionSettings()
PLANE = Plane(FRAME.origin)
NOTHING = Intent()

Place = tuple[float, float]


def at(north_m: float, east_m: float) -> LatLon:
    return moved_m(ORIGIN, north_m, east_m)


def aircraft(
    serial: str = "B",
    place: Place | None = (0.0, 0.0),
    height_m: float | None = 40.0,
    velocity: tuple[float, float, float] | None = (0.0, 0.0, 0.0),
    *,
    home: Place | None = (0.0, 0.0),
    age_s: float = 0.0,
    yaw_deg: float | None = 0.0,
    flying: bool | None = True,
    mode: FlightMode | None = FlightMode.GPS_ATTI,
    go_home_m: float | None = 60.0,
    failsafe: Failsafe | None = Failsafe.GO_HOME,
    priority: int = 0,
    now_ns: int = NOW,
) -> VehicleState:
    """A vehicle; velocity is north, east, up."""
    at_ns = now_ns - round(age_s * S)
    north_east_down = None
    if velocity is not None:
        north_east_down = VelocityNed(velocity[0], velocity[1], -velocity[2])
    return VehicleState(
        serial,
        link_id=1,
        profile=VehicleProfile(
            serial, go_home_height_m=go_home_m, failsafe=failsafe, priority=priority
        ),
        is_flying=Stamped(flying, at_ns),
        position=Stamped(None if place is None else at(*place), at_ns),
        height_above_takeoff_m=Stamped(height_m, at_ns),
        velocity_ned=Stamped(north_east_down, at_ns),
        attitude=Stamped(None if yaw_deg is None else Attitude(yaw_deg, 0.0, 0.0), at_ns),
        flight_mode=Stamped(mode, at_ns),
        core_received_at_ns=at_ns,
        extended_received_at_ns=at_ns,
        takeoff_point=None if home is None else at(*home),
    )


def waypoint(north_m: float, east_m: float, height_m: float = 40.0, **changes: object) -> Waypoint:
    place = at(north_m, east_m)
    values: dict[str, object] = {"speed_mps": 5.0, **changes}
    return Waypoint(
        place.latitude_deg,
        place.longitude_deg,
        height_m,
        **values,  # type: ignore[arg-type]
    )


def route(*places: tuple[float, ...], land: bool = False, curved: bool = False) -> Mission:
    """A mission past (north, east[, height]) places at 5 m/s."""
    return Mission(tuple(waypoint(*place) for place in places), land_at_end=land, curved=curved)


def flies(mission: Mission, passed: int = 0) -> Intent:
    return Intent(Commanded.MISSION, mission=mission, passed=passed)


def seen(state: VehicleState) -> VehicleMotion:
    """The vehicle in the plane; it must have a position."""
    found = vehicle_motion(state, AIR, PLANE, NOW, SETTINGS)
    assert found is not None
    return found


def judged(
    body: Body | Mission,
    own: VehicleState,
    *traffic: VehicleState | Traffic,
    airspace: PreparedAirspace = AIR,
) -> Refusal | None:
    """The rule's refusal of an order for `own` among others."""
    others = tuple(t if isinstance(t, Traffic) else Traffic(t) for t in traffic)
    claiming_links = (ClaimingLink(1, own.is_flying),)
    situation = Situation(NOW, own, claiming_links, airspace=airspace, traffic=others)
    asked = FlyMission(body) if isinstance(body, Mission) else body
    return separation(Command(1, asked, "test", NOW, NOW + 5 * S, serial="A"), situation)
