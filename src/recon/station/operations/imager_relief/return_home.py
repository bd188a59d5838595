"""An imaging drone is recalled under guidance, for the person who ordered it or the survey."""

from recon.model.command import Phase, Refusal
from recon.model.control import AuthorityHolder
from recon.model.event import AuthorityTaken
from recon.station.control import handover
from recon.station.operations.fleet_return import commands
from recon.station.operations.guidance_hold import guidance_hold
from recon.station.state.station import Station
from recon.station.state.steps import Stepped


def refusal(station: Station, serial: str, by: str, person: str, now_ns: int) -> Refusal | None:
    """Return why guidance cannot recall an imaging drone; the gate judges its hold."""
    taken = AuthorityTaken(serial, AuthorityHolder.GUIDANCE, by, person)
    return commands.refusal(station, serial) or handover.refusal(station, taken, now_ns)


def recall(station: Station, serial: str, by: str, person: str, now_ns: int) -> Stepped | Refusal:
    """Have an imaging drone join the fleet return: a hold, then a landing mission in a layer."""
    why = refusal(station, serial, by, person, now_ns)
    if why is not None:
        return why
    taken = AuthorityTaken(serial, AuthorityHolder.GUIDANCE, by, person)
    called, withdrawn = handover.take(station, taken, now_ns)
    called, hold = guidance_hold(called, serial, f"{by}: relief")
    called, sent = commands.join(called, hold, by, now_ns)
    placed = called.orders.records[hold.command_id]
    if placed.phase is Phase.REFUSED_BY_STATION:
        assert placed.refusal is not None, "a refused order has its refusal"
        return placed.refusal
    return called, (*withdrawn, *sent)
