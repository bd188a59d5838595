"""Who leads a vehicle, and whether it is ready to fly, as the API says it."""

from recon.api import schema
from recon.model.units import ns_to_seconds
from recon.safety import Situation
from recon.safety.check import Check
from recon.safety.preflight import checklist
from recon.station.control.preflight import facts
from recon.station.state.station import Station


def authority_view(station: Station, serial: str | None, now_ns: int) -> schema.AuthorityView:
    """Return who leads a vehicle, or a link without a serial."""
    control = station.control(serial)
    authority = control.authority
    age_s = ns_to_seconds(now_ns - authority.since_ns) if control.is_taken else None
    return schema.AuthorityView(
        holder=authority.holder.value,
        holder_name=authority.holder_name,
        age_s=age_s,
        reason=authority.reason,
    )


def override_view(station: Station, serial: str | None, now_ns: int) -> schema.OverrideView | None:
    """Return somebody's override of a vehicle's checklist, if there is one."""
    given = station.control(serial).preflight_override
    if given is None:
        return None
    age_s = ns_to_seconds(now_ns - given.at_ns)
    return schema.OverrideView(by=given.by, reason=given.reason, age_s=age_s)


def preflight_view(station: Station, serial: str, now_ns: int) -> schema.PreflightView | None:
    """Return a vehicle's checklist as of now; None for a vehicle that is not known."""
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
