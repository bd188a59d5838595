"""Numbers for the commands the station gives by itself: below zero, each used once.

Orders of operators and programs are numbered from 1 up, so the two never meet.
"""

from recon.model.replacing import replace
from recon.station.state.station import Station


def take_id(station: Station) -> tuple[Station, int]:
    """Return the station without its next own number, and that number."""
    return replace(station, next_own_id=station.next_own_id - 1), station.next_own_id
