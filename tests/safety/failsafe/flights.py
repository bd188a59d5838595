"""Facts of one vehicle in flight, for the rows of the failsafe matrix."""

from dataclasses import replace
from typing import Any

from recon.model.geo import LatLon
from recon.model.units import NS_PER_S, Stamped
from recon.model.vehicle import Attitude, VehicleState
from recon.safety.failsafe import FailsafeLimits, FlightFacts, SharedFacts

NOW_NS = 100 * NS_PER_S
LIMITS = FailsafeLimits(0.25, 0.10, 2, 45.0)
HEALTHY = VehicleState(
    serial="A",
    link_id=1,
    is_flying=Stamped(True, NOW_NS),
    position=Stamped(LatLon(41.0, -93.0), NOW_NS),
    attitude=Stamped(Attitude(0.0, 5.0, -5.0), NOW_NS),
    battery_fraction=Stamped(0.8, NOW_NS),
    gnss_signal_level=Stamped(4, NOW_NS),
    core_received_at_ns=NOW_NS,
    extended_received_at_ns=NOW_NS,
)


def facts(
    *,
    station: SharedFacts | None = None,
    opened_at_ns: int | None = 0,
    findings: Any = None,
    **changes: Any,
) -> FlightFacts:
    """Facts of a healthy flight with these values changed; plain values are stamped now."""
    values = {
        name: value if name.endswith("_ns") or name == "serial" else Stamped(value, NOW_NS)
        for name, value in changes.items()
    }
    vehicle = replace(HEALTHY, **values)
    return FlightFacts(
        vehicle, NOW_NS, opened_at_ns, LIMITS, station or SharedFacts(), findings or {}
    )


def ago_ns(seconds: float) -> int:
    """A time so many seconds ago."""
    return NOW_NS - round(seconds * NS_PER_S)
