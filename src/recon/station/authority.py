"""Who leads each vehicle. Taking over is explicit; the pilot's sticks always win."""

from dataclasses import replace

from recon.model.authority import Lead
from recon.model.event import AuthorityTaken
from recon.station.state import Station


def take(station: Station, event: AuthorityTaken, now_ns: int) -> Station:
    """Return the station after somebody took a vehicle over, or gave it away."""
    lead = Lead(event.leader, event.by, now_ns, f"taken over by {event.by}")
    return replace(station, leads={**station.leads, event.serial: lead})
