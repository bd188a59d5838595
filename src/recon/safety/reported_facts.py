"""The facts that an app reports, while they are fresh. A plain app reports none."""

from recon.model.app_report import AppFacts
from recon.model.vehicle import VehicleState

FRESH_FACTS_S = 30.0
"""An app sends its facts every 10 s in any case (docs/icd.md): three of them are missing."""

NO_APP_FACTS = AppFacts()


def reported_facts(vehicle: VehicleState | None, now_ns: int) -> AppFacts:
    """Return what a vehicle's app reports of its aircraft; nothing known when that is old."""
    if vehicle is None:
        return NO_APP_FACTS
    age_s, facts = vehicle.app_facts.age_s(now_ns), vehicle.app_facts.value
    is_fresh = age_s is not None and age_s <= FRESH_FACTS_S
    return facts if facts is not None and is_fresh else NO_APP_FACTS
