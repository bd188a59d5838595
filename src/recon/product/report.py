"""The figures of a flight's report: coverage in sun, times in the air, alarms, decisions.

The report shows what the record states; without tagged photos the covered ground is estimated from
the tracks and the survey's camera, and called so.
"""

import heapq
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from math import cos, isfinite, radians, sin
from operator import itemgetter
from statistics import fmean

import numpy as np
import numpy.typing as npt
import shapely  # type: ignore[import-untyped, unused-ignore]
from shapely import affinity

from recon.geo import cell_centres_m
from recon.guidance.survey import SurveySettings
from recon.guidance.survey.lattice import axes
from recon.guidance.survey.plan import row_bearing_deg, survey_fault
from recon.guidance.survey.progress import is_flown_as_planned
from recon.light.agreement import MapAgreement
from recon.model.arrays import IntArray
from recon.model.errors import RecordError
from recon.model.severity import Severity
from recon.model.survey import Survey
from recon.model.units import NS_PER_S, seconds_to_ns
from recon.product.coverage import ENOUGH_VIEWS, region_of
from recon.product.flight import UNKNOWN, FlightData, FlownSurvey, RecordedTrack
from recon.product.flight_log import FlightLog, LogLine
from recon.product.shadow_record import (
    SUNLIT,
    PhotosByCell,
    SunByCell,
    grid_over,
    photos_by_cell,
    place_on,
    sun_by_cell,
)
from recon.product.sun_at import SunHistory
from recon.product.sun_sensor import agreement_of
from recon.product.tagged import TaggedPhoto

BoolMap = npt.NDArray[np.bool_]

MOST_PHOTOS = 100_000
"""Estimated: five hours of ten vehicles with a photo every two seconds."""
SEVERITY_RANK = {each.value: rank for rank, each in enumerate(Severity)}
NO_DECISION = ("alarm.", "link.", "app.", "vehicle.home_set")
STEPS_OF_AN_ORDER = frozenset(
    f"order.{phase}" for phase in ("queued", "sent", "acknowledged", "confirmed", "started")
)
"""Every order goes through them; its start is in the tracks, its end is listed."""


@dataclass(frozen=True, slots=True)
class AlarmSpan:
    """An alarm from its beginning to its end; None: it lasted to the record's end."""

    began_ns: int
    ended_ns: int | None
    severity: str
    text: str


@dataclass(frozen=True, slots=True, eq=False)
class Covered:
    """What was photographed of the region, by cell; arrays are (R, C).

    Cells are those of the shade maps, and as many around them as the region needs.
    """

    region: BoolMap
    """Cells of the region; all that photos show if no survey was flown."""
    photos: PhotosByCell
    sun: SunByCell
    is_estimated: bool
    """Whether coverage is estimated from tracks: no photos were tagged."""
    area_m2: float
    """Area of the region."""

    def share(self, least_sunlit: int) -> float:
        """Return the region's share that so many photos show in sun; 0 asks for photos at all."""
        is_shown = (
            self.photos.photos > 0 if least_sunlit == 0 else (self.photos.sunlit >= least_sunlit)
        )
        return float(is_shown[self.region].mean()) if self.region.any() else 0.0

    @property
    def enough(self) -> float:
        """The region's share with enough sunlit photos for a mosaic."""
        return self.share(ENOUGH_VIEWS)


@dataclass(frozen=True, slots=True, eq=False)
class FlightReport:
    """All figures of a report. Times are station time in ns."""

    flight: FlightData
    log: FlightLog
    begin_ns: int
    end_ns: int
    covered: Covered | None
    """None without shade maps."""
    area: shapely.Geometry | None
    """Area of the surveys, in east-north metres."""
    cover: tuple[tuple[int, float], ...] = ()
    """Time, and the share of the region in sun, for each shade map that shows any of it."""
    photo_states: Mapping[str, int] = field(default_factory=dict)
    by_sensors: MapAgreement = field(default_factory=MapAgreement)
    """How often the shade maps said what the photos' own sun sensors show."""
    airborne: Mapping[str, Sequence[tuple[int, int]]] = field(default_factory=dict)
    """Times in the air by vehicle's name."""
    alarms: Sequence[AlarmSpan] = ()
    decisions: Sequence[LogLine] = ()

    @property
    def airborne_s(self) -> float:
        """Return the time in the air of all vehicles together."""
        spans = [span for each in self.airborne.values() for span in each]
        return sum(end - begin for begin, end in spans) / NS_PER_S

    @property
    def mean_sun(self) -> float | None:
        """The share of the region in sun, mean over the shade maps; None without any."""
        return fmean(share for _at_ns, share in self.cover) if self.cover else None

    def name_of(self, serial: str) -> str:
        """Return a vehicle's name."""
        return self.flight.names.get(serial, serial)


def flight_report(
    flight: FlightData, log: FlightLog, photos: Sequence[TaggedPhoto] | None
) -> FlightReport:
    """Return the report of a flight; `photos` as tagged, None where no photos were tagged."""
    begin_ns, end_ns = flight.span_ns
    area, covered = region_of(flight.surveys), None
    if flight.grid is not None and flight.maps:
        covered = _covered(flight, SunHistory(flight.grid, flight.maps), area, photos)
    return FlightReport(
        flight,
        log,
        begin_ns,
        end_ns,
        covered,
        area,
        () if covered is None else tuple(_cover(flight, covered)),
        Counter(each.state for each in photos or ()),
        agreement_of(
            each.sun_by_maps_and_sensor
            for each in photos or ()
            if each.sun_by_maps_and_sensor is not None
        ),
        _airborne(log.lines, end_ns),
        _alarms(log.lines),
        [each for each in log.lines if _is_decision(each.kind)],
    )


def _covered(
    flight: FlightData,
    history: SunHistory,
    area: shapely.Geometry | None,
    photos: Sequence[TaggedPhoto] | None,
) -> Covered:
    shown = (
        list(_estimated(flight))
        if photos is None
        else [(each.at_ns, each.footprint) for each in photos]
    )
    grid = history.grid if area is None else grid_over(area, history.grid)
    by_cell, sun = photos_by_cell(history, shown, grid), sun_by_cell(history, grid)
    if area is None:
        region = by_cell.photos > 0
        return Covered(region, by_cell, sun, photos is None, float(region.sum()) * grid.cell_m**2)
    places = np.meshgrid(*cell_centres_m(grid))
    region = np.asarray(shapely.contains_xy(area, *places), dtype=np.bool_)
    return Covered(region, by_cell, sun, photos is None, float(area.area))


def _estimated(flight: FlightData) -> Iterator[tuple[int, shapely.Polygon]]:
    """Yield times and footprints of photos, as the survey's camera takes them along its rows.

    What counts as flown along rows is what counts for a running survey too. In the order of time;
    raises `RecordError` for more than `MOST_PHOTOS`.
    """
    parts = [
        _estimated_part(survey, track, part)
        for track in flight.survey_tracks.values()
        for survey, part in flight.parts_by_survey(track)
    ]
    for number, each in enumerate(heapq.merge(*parts, key=itemgetter(0))):
        if number >= MOST_PHOTOS:
            raise RecordError(f"{flight.path}: expected at most {MOST_PHOTOS} photos, got more")
        yield each


def _estimated_part(
    survey: FlownSurvey, track: RecordedTrack, part: slice
) -> Iterator[tuple[int, shapely.Polygon]]:
    request, settings = survey.request(), SurveySettings()
    if survey_fault(request) is not None:
        return
    turn = axes(row_bearing_deg(request)).T
    every_ns = seconds_to_ns(survey.camera.interval_s)
    values = np.column_stack([track.east_m, track.north_m, track.height_m])
    for a, b in pairwise(_thinned(track.at_ns, part, seconds_to_ns(settings.least_step_s))):
        begin_ns, end_ns = int(track.at_ns[a]), int(track.at_ns[b])
        along_m, across_m = ((values[b, :2] - values[a, :2]) @ turn).tolist()
        # What the height above ground was is not known here: such a survey's is taken as flown.
        off_m = 0.0 if request.is_above_ground else _off_height_m(request, values[[a, b], 2])
        if not is_flown_as_planned(
            request, settings, (begin_ns, end_ns), (along_m, across_m), off_m
        ):
            continue
        yaw_deg = float(track.yaw_deg[b])
        for at_ns in range(-(-begin_ns // every_ns) * every_ns, end_ns, every_ns):
            share = (at_ns - begin_ns) / (end_ns - begin_ns)
            east_m, north_m, height_m = (values[a] + share * (values[b] - values[a])).tolist()
            height_m = request.height_m if request.is_above_ground else height_m
            if isfinite(yaw_deg):
                yield at_ns, _footprint(survey, east_m, north_m, height_m, yaw_deg)


def _off_height_m(request: Survey, heights_m: npt.NDArray[np.float64]) -> float:
    return float(np.abs(heights_m - request.height_m).max())


def _thinned(at_ns: IntArray, part: slice, least_ns: int) -> Iterator[int]:
    """Yield the indices of times that are at least `least_ns` apart."""
    last_ns = None
    for index, each_ns in enumerate(at_ns[part].tolist(), start=part.start):
        if last_ns is None or each_ns - last_ns >= least_ns:
            last_ns = each_ns
            yield index


def _footprint(
    survey: FlownSurvey, east_m: float, north_m: float, height_m: float, yaw_deg: float
) -> shapely.Polygon:
    half_across = survey.camera.across_m(height_m) / 2.0
    half_along = survey.camera.along_m(height_m) / 2.0
    box = shapely.box(-half_across, -half_along, half_across, half_along)
    c, s = cos(radians(yaw_deg)), sin(radians(yaw_deg))
    return affinity.affine_transform(box, (c, s, -s, c, east_m, north_m))


def _cover(flight: FlightData, covered: Covered) -> Iterator[tuple[int, float]]:
    assert flight.grid is not None  # or nothing is covered
    region = covered.region[place_on(covered.sun.grid, flight.grid)]
    for each in flight.maps:
        is_known = (each.sun != UNKNOWN) & region
        if is_known.any():
            yield each.at_ns, float((each.sun[is_known] >= SUNLIT).mean())


def _airborne(lines: Sequence[LogLine], end_ns: int) -> dict[str, list[tuple[int, int]]]:
    """Return when each vehicle was in the air, by takeoffs and landings of the log."""
    spans: dict[str, list[tuple[int, int]]] = {}
    began: dict[str, int] = {}
    for line in lines:
        if line.kind in ("vehicle.took_off", "vehicle.flying"):
            began.setdefault(line.vehicle, line.at_ns)
        elif line.kind == "vehicle.landed" and line.vehicle in began:
            spans.setdefault(line.vehicle, []).append((began.pop(line.vehicle), line.at_ns))
    for vehicle, at_ns in began.items():
        spans.setdefault(vehicle, []).append((at_ns, end_ns))
    return dict(sorted(spans.items()))


def _alarms(lines: Sequence[LogLine]) -> list[AlarmSpan]:
    """Return the alarms from beginning to end, the gravest first."""
    found, open_at = list[AlarmSpan](), dict[int, int]()
    for line in lines:
        if line.alarm_id is None or line.kind == "alarm.acknowledged":
            continue
        text = line.text.partition(": ")[2] or line.text
        index = open_at.get(line.alarm_id)
        if line.kind == "alarm.ended":
            if index is not None:
                began = found[open_at.pop(line.alarm_id)]
                found[index] = AlarmSpan(began.began_ns, line.at_ns, began.severity, began.text)
        elif index is None:
            open_at[line.alarm_id] = len(found)
            found.append(AlarmSpan(line.at_ns, None, line.severity, text))
        else:
            found[index] = AlarmSpan(found[index].began_ns, None, line.severity, text)
    return sorted(found, key=lambda a: (SEVERITY_RANK.get(a.severity, 9), a.began_ns))


def _is_decision(kind: str) -> bool:
    return not kind.startswith(NO_DECISION) and kind not in STEPS_OF_AN_ORDER
