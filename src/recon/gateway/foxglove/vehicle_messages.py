"""Locations and states of vehicles: of live telemetry alone, and each sample once. Pure."""

from collections.abc import Iterator, Mapping
from typing import Any

import msgspec
from msgspec import UNSET, UnsetType

from recon.client.messages import StateMessage
from recon.client.telemetry import Aged, EulerAngles, Telemetry, Velocity
from recon.gateway.foxglove.live_message import LOCATION, LiveMessage, TopicKind
from recon.gateway.samples import SAME_SAMPLE_NS, is_live, taken_ns
from recon.model.geo import LatLon
from recon.model.units import NS_PER_S
from recon.model.vehicle import LATE_UNDER_S
from recon.record.mcap import foxglove

Shown = Mapping[str, int]
"""The time of the newest sample of each topic."""


class ShownState(msgspec.Struct, frozen=True, kw_only=True):
    """A vehicle's state; what is not known, or no longer, is absent. Yaw clockwise from north."""

    name: str
    number: int
    is_simulated: bool
    authority: str
    is_flying: bool | UnsetType = UNSET
    flight_mode: str | UnsetType = UNSET
    height_above_takeoff_m: float | UnsetType = UNSET
    velocity_north_mps: float | UnsetType = UNSET
    velocity_east_mps: float | UnsetType = UNSET
    velocity_down_mps: float | UnsetType = UNSET
    yaw_deg: float | UnsetType = UNSET
    pitch_deg: float | UnsetType = UNSET
    roll_deg: float | UnsetType = UNSET
    battery_fraction: float | UnsetType = UNSET
    battery_warning: str | UnsetType = UNSET
    gnss_satellite_count: float | UnsetType = UNSET
    mission_id: float | UnsetType = UNSET
    camera_state: str | UnsetType = UNSET


def _state_kind() -> TopicKind:
    """Return the kind of `ShownState`; clients read no schema with references."""
    schema = msgspec.json.schema(ShownState)["$defs"]["ShownState"]
    data = msgspec.json.encode({**schema, "title": "recon.VehicleState"})
    return TopicKind("json", "recon.VehicleState", "jsonschema", data)


STATE = _state_kind()


def new_samples(
    shown: Shown, seen: StateMessage, state_age_s: float
) -> tuple[Shown, list[LiveMessage]]:
    """Return what is shown after a state of the station, and the messages of its new samples."""
    messages: list[LiveMessage] = []
    newest: dict[str, int] = {}
    for telemetry in seen.vehicles:
        name = _name(telemetry)
        if name is None:
            continue
        for topic, at_ns, message in _samples(name, telemetry, seen.time_ns, state_age_s):
            known_ns = newest[topic] = shown.get(topic, 0)
            if at_ns > known_ns + SAME_SAMPLE_NS:
                newest[topic] = at_ns
                messages.append(message)
    return newest, messages


def is_another_run(before: StateMessage, after: StateMessage) -> bool:
    """Return whether two states are of different runs of the station.

    The start of a run is the difference of two rounded numbers.
    """
    return abs(after.run_started_ns - before.run_started_ns) > NS_PER_S


def _name(telemetry: Telemetry) -> str | None:
    """Return what a vehicle's topics are called, as in a record; None without a link."""
    if telemetry.serial is not None or telemetry.link_id is None:
        return telemetry.serial
    return f"link-{telemetry.link_id}"


def _samples(
    name: str, telemetry: Telemetry, time_ns: int, state_age_s: float
) -> Iterator[tuple[str, int, LiveMessage]]:
    """Yield a vehicle's live samples: topic, time and message."""
    if not is_live(telemetry, state_age_s):
        return
    place = telemetry.position
    at_ns = taken_ns(place.age_s, time_ns, state_age_s)
    if at_ns is not None and place.latitude_deg is not None and place.longitude_deg is not None:
        altitude = telemetry.reported_altitude_m
        # Of the same packet: an older altitude is not that of this place.
        altitude_m = altitude.value if altitude.age_s == place.age_s else None
        point = LatLon(place.latitude_deg, place.longitude_deg)
        fix = foxglove.location(point, altitude_m, name, at_ns)
        topic = foxglove.vehicle_topic(name, "location")
        yield topic, at_ns, LiveMessage(topic, LOCATION, at_ns, fix.SerializeToString())
    at_ns = taken_ns(telemetry.telemetry_age_s, time_ns, state_age_s)
    if at_ns is not None:
        topic = foxglove.vehicle_topic(name, "state")
        state = msgspec.json.encode(_state(telemetry, state_age_s))
        yield topic, at_ns, LiveMessage(topic, STATE, at_ns, state)


def _state(telemetry: Telemetry, state_age_s: float) -> ShownState:
    def known(part: Aged[Any] | Velocity | EulerAngles, name: str = "value") -> Any:
        value = getattr(part, name)
        is_old = part.age_s is None or part.age_s + state_age_s >= LATE_UNDER_S
        return UNSET if value is None or is_old else value

    velocity, attitude = telemetry.velocity_ned, telemetry.attitude
    return ShownState(
        name=telemetry.name,
        number=telemetry.number,
        is_simulated=telemetry.is_simulated,
        authority=telemetry.authority.holder,
        is_flying=known(telemetry.is_flying),
        flight_mode=known(telemetry.flight_mode),
        height_above_takeoff_m=known(telemetry.height_above_takeoff_m),
        velocity_north_mps=known(velocity, "north_mps"),
        velocity_east_mps=known(velocity, "east_mps"),
        velocity_down_mps=known(velocity, "down_mps"),
        yaw_deg=known(attitude, "yaw_deg"),
        pitch_deg=known(attitude, "pitch_deg"),
        roll_deg=known(attitude, "roll_deg"),
        battery_fraction=known(telemetry.battery_fraction),
        battery_warning=known(telemetry.battery_warning),
        gnss_satellite_count=known(telemetry.gnss_satellite_count),
        mission_id=known(telemetry.mission_id),
        camera_state=known(telemetry.camera_state),
    )
