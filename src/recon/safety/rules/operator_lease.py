"""One person operates a vehicle at a time; every person may stop it."""

from recon.model.command import Command, Refusal
from recon.model.control import AuthorityHolder, OperatorLease
from recon.model.units import ns_to_seconds
from recon.safety.situation import Situation

RULE = "operator_lease"


def operator_lease(command: Command, situation: Situation) -> Refusal | None:
    """Refuse an operator's order to move a vehicle that another person operates.

    Guidance acts for the person who gave it the vehicle: the rule `authority` judges its orders.
    """
    lease, vehicle = situation.lease, situation.vehicle
    if lease is None or vehicle is None or not command.moves:
        return None
    if command.role is not AuthorityHolder.OPERATOR or command.person == lease.person:
        return None
    return held_by_another(vehicle.display_name, lease, situation.now_ns)


def held_by_another(name: str, lease: OperatorLease, now_ns: int) -> Refusal:
    """Return the refusal of what would move a vehicle that another person operates."""
    age_s = ns_to_seconds(now_ns - lease.since_ns)
    return Refusal(
        RULE,
        f"{name} is operated by {lease.person}, since {age_s:.0f} s ago; ask {lease.person}, or "
        "take it over (console: Take over; shell: recon take --take-over). Hold, land and return "
        "home are always accepted",
        parameters={"person": lease.person, "age_s": age_s},
    )
