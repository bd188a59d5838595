"""The surveyed regions of the site as the API sends them, and the surveys that fly them again."""

from collections.abc import Iterator
from dataclasses import replace
from datetime import date, datetime, time
from pathlib import Path

import numpy as np
import shapely  # type: ignore[import-untyped, unused-ignore]

from recon.api import schema
from recon.guidance.survey.again import differences, on_rows_of, origin_fault
from recon.guidance.survey.plan import RULE
from recon.model.command import Refusal
from recon.model.flown_before import FlownCells
from recon.model.flown_region import NEVER_S, FlownRegion, SecondsArray
from recon.model.geo import LocalFrame
from recon.model.survey import CellState, Survey
from recon.model.units import NS_PER_S
from recon.record.files.flown_region_file import day_of
from recon.site import Site
from recon.station.api_views.photo_gaps import gap_cells, gaps_in
from recon.station.recovery.flown_regions import FlownRegions

QUARTER_S = 900
"""Every time zone is off by whole quarters of an hour: a quarter lies within one day."""

MOST_DAYS = 60
"""Days that are listed of a region, the newest."""


def flown_regions_view(
    flown: FlownRegions, site: Site, now_ns: int, gaps_file: Path | None
) -> schema.FlownRegionsView:
    """Return the surveyed regions; takes tens of milliseconds, and reads the disk."""
    gaps = gaps_in(gaps_file, site.frame)
    return schema.FlownRegionsView(
        today=datetime.fromtimestamp(now_ns // NS_PER_S).date(),
        regions=[_view(each, site, gaps) for each in flown.all],
        unreadable=list(flown.troubles),
    )


def survey_again(
    asked: schema.SurveyAgainRequest,
    number: int,
    flown: FlownRegions,
    site: Site,
    gaps_file: Path | None = None,
) -> Survey | Refusal:
    """Return the survey that flies a region again, or only what is left of it; or the gaps of its
    photos. Takes as long as `flown_regions_view`."""
    last = flown.get(asked.id)
    if last is None:
        known = ", ".join(f"{each.key} ({each.survey.region_name})" for each in flown.all)
        text = f"Surveyed region {asked.id!a} not found; available: {known or 'none'}"
        return Refusal(RULE, text)
    refusal = _refusal(last, site)
    if refusal is not None or site.frame is None:
        return Refusal(RULE, refusal or "the site has no origin")
    region = site.layers.survey_regions[last.survey.region_name or ""]
    survey = on_rows_of(last, replace(last.survey, id=number, region=region), site.frame, day_of)
    if asked.all_again:
        return survey
    since_s = last.begun_s if asked.since is None else _start_of(asked.since)
    cells: FlownCells | Refusal = last.cells_since(since_s)
    if asked.gaps:
        cells = _all_but_gaps(last, since_s, gaps_in(gaps_file, site.frame))
    if isinstance(cells, Refusal):
        return cells
    # Its origin is that of the site but for rounding, or it would be refused.
    return replace(survey, flown=replace(cells, grid=replace(cells.grid, frame=site.frame)))


def _all_but_gaps(
    last: FlownRegion, since_s: int, gaps: shapely.Geometry | None
) -> FlownCells | Refusal:
    """Return all cells as in sun but those in gaps, as the photos show them."""
    is_gap = None if gaps is None else gap_cells(last, gaps)
    if is_gap is None or not is_gap.any():
        name = last.survey.region_name
        return Refusal(RULE, f"no gap of the photos lies in region {name}: nothing is left of it")
    state = np.where(is_gap, np.uint8(CellState.NOT_YET), np.uint8(CellState.IN_SUN))
    return FlownCells(last.grid, state, ~is_gap, since_s, last.is_simulated)


def _start_of(day: date) -> int:
    return max(NEVER_S, int(datetime.combine(day, time()).timestamp()))


def _refusal(last: FlownRegion, site: Site) -> str | None:
    name = last.survey.region_name
    if name not in site.layers.survey_regions:
        known = ", ".join(site.layers.survey_regions) or "none"
        return f"the site has no survey region {name!a} any more; available: {known}"
    if site.frame is None:
        return "the site has no origin"
    moved = origin_fault(last, site.frame)
    return None if moved is None else f"{moved} since: plan it anew"


def _view(last: FlownRegion, site: Site, gaps: shapely.Geometry | None) -> schema.FlownRegionView:
    survey, cell_m2 = last.survey, last.grid.cell_m**2
    return schema.FlownRegionView(
        id=last.key,
        region=survey.region_name or "",
        is_simulated=last.is_simulated,
        planner=survey.planner,
        height_above_takeoff_m=survey.height_above_takeoff_m,
        height_above_ground_m=survey.height_above_ground_m,
        speed_mps=survey.speed_mps,
        camera_across_deg=survey.camera.across_deg,
        camera_along_deg=survey.camera.along_deg,
        row_spacing_m=last.lattice.spacing_m,
        row_bearing_deg=last.lattice.bearing_deg,
        begun_unix_s=last.begun_s,
        started_unix_s=last.started_s,
        reached_m2=float(last.is_reached.sum()) * cell_m2,
        left_m2=float(last.is_left(last.begun_s).sum()) * cell_m2,
        gaps_m2=None if gaps is None else float(gap_cells(last, gaps).sum()) * cell_m2,
        days=_days(last),
        changes=list(_changes(last, site.frame, site)),
        refusal=_refusal(last, site),
    )


def _changes(last: FlownRegion, frame: LocalFrame | None, site: Site) -> Iterator[str]:
    region = site.layers.survey_regions.get(last.survey.region_name or "")
    if frame is not None and region is not None:
        yield from differences(last, replace(last.survey, region=region), frame)


def _days(last: FlownRegion) -> list[schema.FlownDayView]:
    imaged, in_sun = (_cells_by_day(last, times_s) for times_s in (last.imaged_s, last.in_sun_s))
    cell_m2 = last.grid.cell_m**2
    return [
        schema.FlownDayView(
            day=day,
            imaged_m2=imaged.get(day, 0) * cell_m2,
            in_sun_m2=in_sun.get(day, 0) * cell_m2,
        )
        for day in sorted({*imaged, *in_sun}, reverse=True)[:MOST_DAYS]
    ]


def _cells_by_day(last: FlownRegion, times_s: SecondsArray) -> dict[date, int]:
    """How many of the reached cells were imaged last on each day."""
    known_s = times_s[last.is_reached & (times_s != NEVER_S)]
    quarters, counts = np.unique(known_s // QUARTER_S, return_counts=True)
    found: dict[date, int] = {}
    for quarter, count in zip(quarters.tolist(), counts.tolist(), strict=True):
        day = datetime.fromtimestamp(quarter * QUARTER_S).date()
        found[day] = found.get(day, 0) + count
    return found
