"""The formats: their writers, how many flights a file holds, and how many waypoints a flight."""

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType

from recon.plans.aircraft import AircraftModel
from recon.plans.features import FormatName, by_hand
from recon.plans.flight_plan import ExportedPlan, PlanExportError, plan_fault
from recon.plans.gpx import gpx_of
from recon.plans.kml import kml_of
from recon.plans.kmz import kmz_of
from recon.plans.litchi import MOST_WAYPOINTS as MOST_OF_LITCHI
from recon.plans.litchi import litchi_csv
from recon.plans.parts import parts_of
from recon.plans.qgc import qgc_mission, qgc_survey
from recon.plans.waypoints import waypoints_of
from recon.plans.wpml import WpmlOptions

MOST_OF_MAVLINK = 5_000
"""Items that a mission file is written with; autopilots hold from 700 to some thousand."""
MOST_FILES = 500


@dataclass(frozen=True, slots=True)
class Format:
    """How a format is written: `write` for one flight, or `write_all` for all of them."""

    title: str
    most_waypoints: int
    write: Callable[[ExportedPlan], bytes] | None = None
    write_all: Callable[[Sequence[ExportedPlan]], bytes] | None = None


FORMATS: Mapping[FormatName, Format] = MappingProxyType(
    {
        FormatName.WPML: Format("DJI Pilot 2 and DJI Fly (WPML)", 65_535),
        FormatName.QGC_MISSION: Format("QGroundControl, mission", MOST_OF_MAVLINK, qgc_mission),
        FormatName.QGC_SURVEY: Format("QGroundControl, survey", MOST_OF_MAVLINK, qgc_survey),
        FormatName.WAYPOINTS: Format("Mission Planner", MOST_OF_MAVLINK, waypoints_of),
        FormatName.LITCHI: Format("Litchi", MOST_OF_LITCHI, litchi_csv),
        FormatName.KML: Format("KML", 65_535, write_all=kml_of),
        FormatName.GPX: Format("GPX", 65_535, write_all=gpx_of),
    }
)


@dataclass(frozen=True, slots=True)
class FileFacts:
    """What files state beside the flights: when they were made, and for .kmz the aircraft."""

    created_ms: int
    aircraft: AircraftModel | None = None


@dataclass(frozen=True, slots=True)
class ExportedPlans:
    """Files by their names, the waypoints in each, and what the pilot sets in the program."""

    files: Mapping[str, bytes]
    waypoints: Mapping[str, int]
    by_hand: tuple[str, ...]


def format_of(file_name: str) -> FormatName:
    """Return the format of a file by its suffix, the longest that fits.

    Raises `PlanExportError` with the suffixes that are known.
    """
    fitting = [each for each in FormatName if file_name.lower().endswith(each.value)]
    if not fitting:
        known = ", ".join(each.value for each in FormatName)
        raise PlanExportError(f"expected a file named {known}, got {file_name[-60:]!a}")
    return max(fitting, key=lambda each: len(each.value))


def exported(
    name: FormatName, plans: Sequence[ExportedPlan], stem: str, options: FileFacts
) -> ExportedPlans:
    """Return the files of flights: one for all where the format holds several, else one each.

    Raises `PlanExportError` with what the format cannot hold.
    """
    if not plans:
        raise PlanExportError("there are no rows to write: the plan has no flight")
    fault = next((fault for plan in plans if (fault := plan_fault(plan)) is not None), None)
    if fault is not None:
        raise PlanExportError(fault)
    sentences = by_hand(name, plans)
    form = FORMATS[name]
    if form.write_all is not None:
        file_name = f"{stem}{name.value}"
        count = sum(len(plan.waypoints) for plan in plans)
        return ExportedPlans({file_name: form.write_all(plans)}, {file_name: count}, sentences)
    if name is FormatName.WPML:
        form, plans, sentences = _for_aircraft(form, plans, options, sentences)
    return _one_each(name, form, plans, stem, sentences)


def _for_aircraft(
    form: Format, plans: Sequence[ExportedPlan], options: FileFacts, sentences: tuple[str, ...]
) -> tuple[Format, Sequence[ExportedPlan], tuple[str, ...]]:
    """Return the writer, the flights and the sentences for the aircraft that is named."""
    aircraft = options.aircraft
    if aircraft is None:
        raise PlanExportError("a .kmz names its aircraft: name one")
    stated = WpmlOptions(options.created_ms, aircraft)
    form = replace(
        form,
        most_waypoints=aircraft.most_waypoints,
        write=lambda plan: kmz_of(plan, stated),
    )
    photos = plans[0].photos
    if photos is None or aircraft.photos:
        return form, plans, sentences
    every_s = photos.every_s or photos.distance_m(1.0) / plans[0].waypoints[0].speed_mps
    said = (
        f"photos: DJI Fly is not known to take a plan's; set the camera's timer to {every_s:.1f} s"
    )
    return form, [replace(plan, photos=None) for plan in plans], (*sentences, said)


def _one_each(
    name: FormatName,
    form: Format,
    plans: Sequence[ExportedPlan],
    stem: str,
    sentences: tuple[str, ...],
) -> ExportedPlans:
    assert form.write is not None  # a writer of all flights is used before
    parts = [part for p in plans for part in parts_of(p, form.most_waypoints, form.title)]
    if len(parts) > MOST_FILES:
        raise PlanExportError(f"expected at most {MOST_FILES} flights, got {len(parts)}")
    files: dict[str, bytes] = {}
    waypoints: dict[str, int] = {}
    for number, part in enumerate(parts, start=1):
        file_name = f"{stem}{name.value}"
        if len(parts) > 1:
            file_name = f"{stem}-{_slug(part.name)}{name.value}"
        if file_name in files:
            file_name = f"{stem}-{_slug(part.name)}-{number}{name.value}"
        files[file_name] = form.write(part)
        waypoints[file_name] = len(part.waypoints)
    return ExportedPlans(files, waypoints, sentences)


def _slug(name: str) -> str:
    """Return a name as part of a file's: letters, digits and hyphens."""
    return re.sub(r"[^A-Za-z0-9]+", "-", name).strip("-")[:80] or "flight"
