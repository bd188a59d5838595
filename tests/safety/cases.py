"""Commands and situations for the gate, by construction."""

from dataclasses import replace

from recon.model.command import Body, Command, FlyMission, Refusal, StickFrame, VirtualStick
from recon.model.mission import Mission, Waypoint
from recon.model.stamped import Stamped
from recon.model.vehicle import AltitudeReference, VehicleProfile, VehicleState
from recon.safety import ApprovedCommand, Claimant, Situation

S = 1_000_000_000
NOW = 100 * S

TAKEOFF = VehicleProfile("A", waypoint_altitude=AltitudeReference.TAKEOFF)
WGS84 = VehicleProfile("A", waypoint_altitude=AltitudeReference.WGS84)

STICK = VirtualStick(StickFrame.GROUND, 90.0, 1.0, 2.0, 30.0, 1.0)


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


def command(body: Body, *, takeoff: bool = False, expires_at_ns: int = NOW + 5 * S) -> Command:
    return Command(1, body, "test", NOW, expires_at_ns, serial="A", takeoff=takeoff)


def vehicle(
    profile: VehicleProfile | None = TAKEOFF,
    *,
    flying: bool | None = True,
    age_s: float = 0.1,
    offset_m: float | None = 260.0,
    offset_at_takeoff_m: float | None = 260.0,
) -> VehicleState:
    at_ns = NOW - round(age_s * S)
    return VehicleState(
        serial="A",
        link_id=1,
        profile=profile,
        is_flying=Stamped(flying, at_ns),
        altitude_offset_m=Stamped(offset_m, at_ns),
        altitude_offset_at_takeoff_m=offset_at_takeoff_m,
    )


def situation(state: VehicleState | None = None, *rivals: Stamped[bool]) -> Situation:
    """The vehicle on link 1; each rival on link 2, 3, ..."""
    state = state or vehicle()
    others = tuple(Claimant(number, flying) for number, flying in enumerate(rivals, start=2))
    state = replace(state, rival_link_ids=tuple(claimant.link_id for claimant in others))
    return Situation(NOW, state, (Claimant(1, state.is_flying), *others))


def approved(judged: ApprovedCommand | Refusal) -> ApprovedCommand:
    assert isinstance(judged, ApprovedCommand), judged
    return judged


def refused_by(judged: ApprovedCommand | Refusal) -> str:
    assert isinstance(judged, Refusal), judged
    assert judged.reason
    return judged.rule
