"""How long a running survey will have light, as the API sends it."""

from collections.abc import Sequence

from recon.api import schema
from recon.guidance.imager_relief import RELIEF_SETTINGS
from recon.guidance.survey import figures
from recon.model.units import ns_to_seconds
from recon.station.api_views.ages import since_s
from recon.station.imaging.at_work import imagers_at_work, is_in_the_air
from recon.station.state.imager_relief import SurveyOutlook
from recon.station.state.station import Station
from recon.station.state.survey_record import SurveyRecord


def light_view(
    station: Station, record: SurveyRecord, now_ns: int
) -> schema.SurveyLightView | None:
    """Return what is predicted for a survey; None unless it runs, at a site with imaging drones."""
    outlook = station.reliefs.surveys.get(record.survey.id)
    if not record.is_running or outlook is None:
        return None
    at_work = imagers_at_work(station)
    imagers = [_imager(station, serial, now_ns) for serial in at_work]
    unknown_in_s = unknown_from_s([each.return_due_in_s for each in imagers], outlook.needs_s)
    unknown_for_s = None
    if unknown_in_s is not None and outlook.needs_s is not None:
        unknown_for_s = outlook.needs_s - unknown_in_s
    without_age_s, without_m2 = _without(record, outlook, now_ns)
    return schema.SurveyLightView(
        needs_s=outlook.needs_s,
        imagers=imagers,
        absent=_absent(station, now_ns),
        unknown_in_s=unknown_in_s,
        unknown_for_s=unknown_for_s,
        without_age_s=without_age_s,
        without_m2=without_m2,
    )


def _imager(station: Station, serial: str, now_ns: int) -> schema.ImagerOutlookView:
    outlook = station.reliefs.outlooks.get(serial)
    at_ns = None if outlook is None else outlook.return_due_ns
    return schema.ImagerOutlookView(
        serial=serial,
        vehicle_name=_name(station, serial),
        return_due_in_s=None if at_ns is None else max(0.0, ns_to_seconds(at_ns - now_ns)),
        unknown=None if outlook is None or at_ns is not None else outlook.unknown,
    )


def _absent(station: Station, now_ns: int) -> list[schema.AbsentImagerView]:
    """Return the imaging drones with a place that do not hover there."""
    at_work = imagers_at_work(station)
    return [
        schema.AbsentImagerView(
            serial=serial,
            vehicle_name=_name(station, serial),
            gone_age_s=since_s(place.until_ns, now_ns),
            is_on_ground=not is_in_the_air(station, serial),
        )
        for serial, place in station.reliefs.places.items()
        if serial not in at_work
    ]


def unknown_from_s(leaves_s: Sequence[float | None], needs_s: float | None) -> float | None:
    """Return when the last imaging drone must return, if the survey still runs then; else None.

    None where one's time is not known. What a survey needs is not known for its first minutes: then
    only what is near is stated, or every survey would begin with a warning.
    """
    known_s = [each for each in leaves_s if each is not None]
    if not known_s or len(known_s) < len(leaves_s):
        return None
    last_s = max(known_s)
    if needs_s is None:
        return last_s if last_s <= RELIEF_SETTINGS.warned_before_s else None
    return last_s if needs_s > last_s else None


def _without(
    record: SurveyRecord, outlook: SurveyOutlook, now_ns: int
) -> tuple[float | None, float | None]:
    """Return since when it has no shade map, and the area imaged since in unknown light."""
    without = outlook.without_light
    if without is None or record.state is None:
        return None, None
    grown_m2 = figures(record.state).sun_unknown_m2 - without.sun_unknown_m2
    return since_s(without.since_ns, now_ns), max(0.0, grown_m2)


def _name(station: Station, serial: str) -> str:
    vehicle = station.fleet.vehicles.get(serial)
    return serial if vehicle is None else vehicle.display_name
