"""The station's first state, made from a site."""

from recon.fleet.admission import Admission, AllowedApp
from recon.fleet.state import Fleet
from recon.safety import PreparedAirspace
from recon.site import Imager, Site
from recon.station.state.imaging import ImagerFrames, Imaging
from recon.station.state.settings import StationSettings
from recon.station.state.station import Station


def first_state(
    site: Site,
    settings: StationSettings | None = None,
    apps: tuple[AllowedApp, ...] | None = None,
) -> Station:
    """Return the station before its first event; `apps` None: without a list of apps."""
    chosen = settings or StationSettings(failsafe_matrix=site.failsafe)
    return Station(
        settings=chosen,
        airspace=PreparedAirspace(site.airspace),
        fleet=Fleet(settings=chosen.fleet, profiles=site.profiles, admission=Admission(apps)),
        imaging=Imaging({each.serial: _frames_of(each) for each in site.imagers.values()}),
    )


def _frames_of(imager: Imager) -> ImagerFrames:
    return ImagerFrames(
        imager.serial,
        reference=imager.marked_frame,
        is_reference_assumed=imager.marked_frame is None,
        is_placed_by_telemetry=imager.solution is None,
        outlook=imager.outlook,
    )
