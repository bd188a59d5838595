"""The order of guidance to hold a vehicle, as every operation gives it."""

from recon.model.command import Hover
from recon.model.control import AuthorityHolder
from recon.model.event import OperatorOrder
from recon.station.state.station import Station, take_id


def guidance_hold(station: Station, serial: str, by: str) -> tuple[Station, OperatorOrder]:
    """Return the station with a number taken, and the order of guidance to hold a vehicle."""
    station, number = take_id(station)
    return station, OperatorOrder(number, Hover(), by, serial=serial, role=AuthorityHolder.GUIDANCE)
