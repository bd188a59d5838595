"""Which samples of a state are live: no old one is ever shown as a new one."""

from recon.client.telemetry import Telemetry
from recon.model.units import NS_PER_S
from recon.model.vehicle import LIVE_UNDER_S

SAME_SAMPLE_NS = 5_000_000
"""Ages are in milliseconds; samples are at least 20 ms apart."""


def is_live(telemetry: Telemetry, state_age_s: float) -> bool:
    """Return whether a vehicle's telemetry is live: it and the state that shows it are young."""
    age_s = telemetry.telemetry_age_s
    return telemetry.is_live and age_s is not None and age_s + state_age_s < LIVE_UNDER_S


def taken_ns(age_s: float | None, state_time_ns: int, state_age_s: float) -> int | None:
    """Return the station's time of a live sample; None of an old one."""
    if age_s is None or age_s + state_age_s >= LIVE_UNDER_S:
        return None
    return state_time_ns - round(age_s * NS_PER_S)
