"""Authority, preflight, hazard area and steering of a vehicle, as the API sends them."""

from recon.api import schema
from recon.model.geo import LatLon
from recon.model.vehicle import VehicleState
from recon.safety import Situation
from recon.safety.check import Check
from recon.safety.checks import checklist
from recon.safety.datum import home
from recon.safety.prediction.motion import last_place
from recon.station.api_views.ages import since_s
from recon.station.api_views.failsafe_view import failsafe_view
from recon.station.control import operator_lease
from recon.station.control.preflight import facts
from recon.station.state.station import Station
from recon.station.traffic.known_traffic import dismissed_by, hazard


def authority_view(station: Station, serial: str | None, now_ns: int) -> schema.AuthorityView:
    """Return the authority over a vehicle; the default for a link without a serial."""
    control = station.control(serial)
    authority = control.authority
    age_s = since_s(authority.since_ns, now_ns) if control.is_taken else None
    return schema.AuthorityView(
        holder=authority.holder.value,
        holder_name=authority.holder_name,
        age_s=age_s,
        reason=authority.reason,
    )


def lease_view(station: Station, serial: str | None, now_ns: int) -> schema.LeaseView | None:
    """Return who operates a vehicle; None while it is free."""
    lease = station.control(serial).lease
    if lease is None:
        return None
    since_ns = operator_lease.absent_since_ns(station, lease)
    return schema.LeaseView(
        person=lease.person,
        age_s=since_s(lease.since_ns, now_ns),
        absent_s=None if since_ns is None else since_s(since_ns, now_ns),
    )


def doubt_views(vehicle: VehicleState, now_ns: int) -> list[schema.DoubtView]:
    """Return the doubts about a vehicle's telemetry that have not ended."""
    return [
        schema.DoubtView(
            kind=doubt.kind.value,
            text=doubt.text,
            age_s=since_s(doubt.since_ns, now_ns),
            packets=doubt.count,
        )
        for doubt in vehicle.trust.doubts
        if doubt.until_ns > now_ns
    ]


def override_view(station: Station, serial: str | None, now_ns: int) -> schema.OverrideView | None:
    """Return the override of a vehicle's checklist, if there is one."""
    given = station.control(serial).preflight_override
    if given is None:
        return None
    age_s = since_s(given.at_ns, now_ns)
    return schema.OverrideView(by=given.by, reason=given.reason, age_s=age_s)


def preflight_view(station: Station, serial: str, now_ns: int) -> schema.PreflightView | None:
    """Return a vehicle's checklist as of now; None for an unknown vehicle."""
    vehicle = station.fleet.vehicles.get(serial)
    if vehicle is None:
        return None
    situation = Situation(
        now_ns=now_ns,
        vehicle=vehicle,
        claiming_links=(),
        settings=station.settings.safety,
        airspace=station.airspace,
        facts=facts(station, vehicle),
    )
    checks = checklist(vehicle, situation)
    return schema.PreflightView(
        serial=serial,
        name=vehicle.display_name,
        is_passed=not any(check.holds_back for check in checks),
        override=override_view(station, serial, now_ns),
        points=[_point(check) for check in checks],
        failsafe=failsafe_view(station.settings.failsafe_matrix),
    )


def _point(check: Check) -> schema.CheckView:
    return schema.CheckView(
        key=check.key,
        name=check.name,
        state=check.state.value,
        text=check.text,
        to_do=check.to_do,
        holds_back=check.holds_back,
    )


def hazard_view(station: Station, vehicle: VehicleState, now_ns: int) -> schema.HazardView | None:
    """Return a vehicle's hazard area; None while it has contact, is on the ground or dismissed."""
    found = hazard(station, vehicle, now_ns)
    place, _at_ns = last_place(vehicle)
    if found is None or place is None:
        return None
    home_place = home(vehicle) if found.home_m is not None else None
    path = [] if home_place is None else [_lon_lat(place), _lon_lat(home_place)]
    return schema.HazardView(
        dismissal_name=dismissed_by(station, vehicle),
        age_s=found.age_s,
        latitude_deg=place.latitude_deg,
        longitude_deg=place.longitude_deg,
        radius_m=found.radius_m,
        growth_mps=found.growth_mps,
        largest_radius_m=found.largest_m,
        corridor=path,
        corridor_half_width_m=found.corridor_half_m,
    )


def _lon_lat(place: LatLon) -> tuple[float, float]:
    return place.longitude_deg, place.latitude_deg


def steering_view(station: Station, serial: str | None) -> schema.SteeringView | None:
    """Return the target of a steered order; None without one."""
    stream = station.control(serial).stream
    if stream is None:
        return None
    return schema.SteeringView(
        command_id=stream.command.id,
        latitude_deg=stream.goal.target.latitude_deg,
        longitude_deg=stream.goal.target.longitude_deg,
        height_above_takeoff_m=stream.goal.height_above_takeoff_m,
        speed_mps=stream.goal.speed_mps,
        has_arrived=stream.arrived_at_ns is not None,
        is_ending=stream.closing is not None,
    )
