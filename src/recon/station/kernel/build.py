"""The station's first state, made from a site."""

from dataclasses import replace

import numpy as np

from recon.fleet.admission import Admission, AllowedApp
from recon.fleet.state import Fleet
from recon.safety import PreparedAirspace
from recon.site import Site
from recon.station.state.imaging import Imaging
from recon.station.state.settings import StationSettings
from recon.station.state.station import Station

NEAR_AXIS_RAD = 0.3
"""Within this angle a fisheye's pixels per radian hardly change."""


def first_state(
    site: Site,
    settings: StationSettings | None = None,
    apps: tuple[AllowedApp, ...] | None = None,
) -> Station:
    """Return the station before its first event; `apps` None: without a list of apps."""
    chosen = _with_lens(settings or StationSettings(failsafe_matrix=site.failsafe), site)
    marked = None if site.imager is None else site.imager.marked_frame
    return Station(
        settings=chosen,
        airspace=PreparedAirspace(site.airspace),
        fleet=Fleet(settings=chosen.fleet, profiles=site.profiles, admission=Admission(apps)),
        imaging=Imaging(
            imager_serial=None if site.imager is None else site.imager.serial,
            reference=marked,
            is_reference_assumed=marked is None,
            is_placed_by_telemetry=site.imager is not None and site.imager.solution is None,
        ),
    )


def _with_lens(settings: StationSettings, site: Site) -> StationSettings:
    """Set the lens's pixels per radian near its axis, where most of the field is."""
    if site.imager is None:
        return settings
    pixels = (
        float(site.imager.camera.profile.radius_px(np.array([NEAR_AXIS_RAD]))[0]) / NEAR_AXIS_RAD
    )
    return replace(settings, detection=replace(settings.detection, pixels_per_radian=pixels))
