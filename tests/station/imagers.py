"""Imaging drones of stations that are not made from a site."""

from dataclasses import replace

from recon.station.state.imaging import ImagerFrames, Imaging
from recon.station.state.station import Station


def with_imagers(station: Station, *serials: str) -> Station:
    """Return the station with these imaging drones; a job of the first one's frame runs."""
    imagers = {serial: ImagerFrames(serial) for serial in serials}
    return replace(station, imaging=Imaging(imagers, job_id=1, job_serial=serials[0]))


def imager_of(station: Station) -> ImagerFrames:
    """Return the only imaging drone's frames."""
    (only,) = station.imaging.imagers.values()
    return only
