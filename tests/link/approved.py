"""Commands that came through the real gate, and packets as apps send them."""

from dataclasses import replace

from tests.safety import cases

from recon import wire
from recon.model.command import Body, Command, FlyMission, StickFrame, VirtualStick
from recon.model.mission import Mission, Waypoint
from recon.model.units import seconds_to_ns
from recon.safety import ApprovedCommand, ClaimingLink, approve

LINK_ID = 7
MS = 1_000_000


def approved(
    command_id: int,
    body: Body,
    now_ns: int = 0,
    *,
    expires_after_s: float = 5.0,
    packet_gap_s: float | None = None,
    link_ids: tuple[int, ...] = (LINK_ID,),
) -> ApprovedCommand:
    """Let the gate approve a command for a vehicle that flies and is identified."""
    gap = {} if packet_gap_s is None else {"packet_gap_s": packet_gap_s}
    profile = replace(cases.TAKEOFF, **gap)
    vehicle = cases.vehicle(profile, now_ns=now_ns, age_s=0.0, link_id=link_ids[0])
    command = Command(
        id=command_id,
        body=body,
        issued_by="test",
        issued_at_ns=now_ns,
        expires_at_ns=now_ns + seconds_to_ns(expires_after_s),
        serial="A",
    )
    claiming_links = tuple(ClaimingLink(link_id, vehicle.is_flying) for link_id in link_ids)
    now = replace(cases.situation(vehicle), now_ns=now_ns, claiming_links=claiming_links)
    judged = approve(command, now)
    assert isinstance(judged, ApprovedCommand), judged
    return judged


def mission(waypoint_count: int = 2) -> FlyMission:
    """Return a mission that every rule allows."""
    waypoints = tuple(
        Waypoint(42.0 + 1e-4 * number, -93.6, 30.0, 5.0) for number in range(waypoint_count)
    )
    return FlyMission(Mission(waypoints))


def stick() -> VirtualStick:
    """Return a stick command that every rule allows."""
    return VirtualStick(StickFrame.GROUND, 0.0, 1.0, 0.0, 30.0, 1.0)


def core(**changes: float) -> bytes:
    """Return an encoded core telemetry packet of a vehicle that hovers at 30 m."""
    values: dict[str, float] = {
        "is_flying": 1,
        "latitude_deg": 42.0,
        "longitude_deg": -93.6,
        "altitude_m": 300.0,
        "height_above_takeoff_m": 30.0,
        "velocity_north_mps": 0.0,
        "velocity_east_mps": 0.0,
        "velocity_down_mps": 0.0,
        "yaw_deg": 0.0,
        "pitch_deg": 0.0,
        "roll_deg": 0.0,
    }
    return wire.encode(wire.CoreTelemetry(**{**values, **changes}))  # type: ignore[arg-type]


def extended(serial: bytes = b"A", flight_mode: int = 3) -> bytes:
    """Return an encoded extended telemetry packet."""
    return wire.encode(
        wire.ExtendedTelemetry(
            gnss_satellite_count=14,
            gnss_signal_level=4,
            max_height_reached=0,
            max_distance_reached=0,
            battery_percent=80,
            battery_warning=0,
            wind_level=0,
            camera_state=1,
            flight_mode=flight_mode,
            mission_id=0,
            serial=serial,
        )
    )


def ack(source_pid: int, positive: int = 1) -> bytes:
    """Return an encoded acknowledgment."""
    return wire.encode(wire.Acknowledgment(positive=positive, source_pid=source_pid))
