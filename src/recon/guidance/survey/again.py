"""A region surveyed again: on the same rows, and what differs from the last time.

Rows are the same where the region's outline, its origin and what decides their distance are the
same. Where something differs they are new unless the operator asks for those of then: those are
kept where they lay, and continued over what the region has grown by.
"""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from math import hypot

import shapely  # type: ignore[import-untyped, unused-ignore]

from recon.geo import enu_from_points, shape_of
from recon.guidance.survey.lattice import RowLattice
from recon.guidance.survey.plan import RULE
from recon.guidance.survey.rows import OUTLINE_SLACK_M
from recon.model.command import Refusal
from recon.model.flown_before import KeptLattice
from recon.model.flown_region import FlownRegion, region_key
from recon.model.geo import LocalFrame
from recon.model.survey import RowChoice, Survey, SurveyCamera
from recon.model.units import HECTARE_M2

DayOf = Callable[[int], str]
"""Returns the day of a moment in seconds since 1970, for operators."""

ORIGIN_SLACK_M = 0.005
BEARING_SLACK_DEG = 0.01


def kept_lattice(lattice: RowLattice) -> KeptLattice:
    """Return what is kept of a survey's rows."""
    return KeptLattice(
        lattice.bearing_deg,
        lattice.first_row_m,
        lattice.spacing_m,
        lattice.rows,
        lattice.first_mark_m,
    )


def with_rows(
    survey: Survey,
    frame: LocalFrame,
    known: Iterable[FlownRegion],
    choice: RowChoice,
    day_of: DayOf,
) -> Survey | Refusal:
    """Return a survey with the rows of an earlier one, or with new ones; and a note of which."""
    last = _last(survey, known)
    if last is None:
        if choice is RowChoice.AS_BEFORE:
            where = survey.region_name or "a drawn region"
            return Refusal(RULE, f"no rows of an earlier survey are kept of {where}")
        return survey
    day, found = day_of(last.started_s), tuple(differences(last, survey, frame))
    if choice is RowChoice.NEW or (found and choice is RowChoice.AUTO):
        asked = "asked for" if choice is RowChoice.NEW else f"since {day} {'; '.join(found)}"
        return replace(survey, rows_note=f"New rows: {asked}")
    moved = origin_fault(last, frame)
    if moved is not None:
        return Refusal(RULE, f"the rows of {day} cannot be flown again: {moved}")
    return on_rows_of(last, survey, frame, day_of)


def on_rows_of(last: FlownRegion, survey: Survey, frame: LocalFrame, day_of: DayOf) -> Survey:
    """Return a survey on the rows of an earlier one at the same origin, with a note of it."""
    found = "; ".join(differences(last, survey, frame))
    if _outline_off_m(last.survey, survey) <= OUTLINE_SLACK_M:
        # The outline of then, so that a rounding of its corners moves no row's end.
        survey = replace(survey, region=last.survey.region)
    note = f"Same rows as on {day_of(last.started_s)}"
    note = f"{note}; since then {found}" if found else note
    return replace(survey, lattice=last.lattice, rows_note=note)


def _last(survey: Survey, known: Iterable[FlownRegion]) -> FlownRegion | None:
    """The newest earlier survey of the region: first one alike, and one by real drones."""
    name = survey.region_name
    same = [each for each in known if name is not None and each.survey.region_name == name]

    def rank(each: FlownRegion) -> tuple[bool, bool, int]:
        is_alike = each.key == region_key(survey, is_simulated=each.is_simulated)
        return is_alike, not each.is_simulated, each.started_s

    return max(same, key=rank, default=None)


def origin_fault(last: FlownRegion, frame: LocalFrame) -> str | None:
    """Return why rows and cells cannot be found again in a frame; None where they can."""
    if last.grid.frame == frame:
        return None
    east_m, north_m, _up_m = enu_from_points(frame, [last.grid.frame.origin])[0].tolist()
    off_m = hypot(east_m, north_m)
    # Its height alone moves no place by a centimetre.
    return f"the site's origin has moved by {off_m:.2f} m" if off_m > ORIGIN_SLACK_M else None


def differences(last: FlownRegion, survey: Survey, frame: LocalFrame) -> Iterator[str]:
    """Yield what differs from an earlier survey of the region, in words."""
    moved = origin_fault(last, frame)
    if moved is not None:
        yield moved
    else:
        yield from _outline(last.survey, survey)
    before, now = last.survey, survey
    if before.height_text != now.height_text:
        yield f"the height was {before.height_text} and is {now.height_text}"
    if _field_of_view(before.camera) != _field_of_view(now.camera):
        yield f"the camera was {_camera(before.camera)} and is {_camera(now.camera)}"
    if (before.front_overlap, before.side_overlap) != (now.front_overlap, now.side_overlap):
        yield f"the overlap was {_overlap(before)} and is {_overlap(now)}"
    asked_deg = now.row_bearing_deg
    if asked_deg is not None:
        off_deg = (asked_deg - last.lattice.bearing_deg + 90.0) % 180.0 - 90.0
        if abs(off_deg) > BEARING_SLACK_DEG:
            yield f"rows ran at {last.lattice.bearing_deg:.1f}° and {asked_deg:.1f}° is asked for"


def _outline(before: Survey, now: Survey) -> Iterator[str]:
    off_m = _outline_off_m(before, now)
    if off_m <= OUTLINE_SLACK_M:
        return
    both = (shape_of(each.region).area / HECTARE_M2 for each in (before, now))
    areas = " and is ".join(f"{area_ha:.2f} ha" for area_ha in both)
    yield f"the region's outline has moved by up to {off_m:.1f} m: it was {areas}"


def _outline_off_m(before: Survey, now: Survey) -> float:
    one, other = shape_of(before.region).boundary, shape_of(now.region).boundary
    return float(shapely.hausdorff_distance(one, other))


def _field_of_view(camera: SurveyCamera) -> tuple[float, float, int | None]:
    return camera.across_deg, camera.along_deg, camera.across_px


def _camera(camera: SurveyCamera) -> str:
    pixels = "" if camera.across_px is None else f", {camera.across_px} pixels across"
    return f"{camera.across_deg:.1f}° x {camera.along_deg:.1f}°{pixels}"


def _overlap(survey: Survey) -> str:
    return f"{survey.front_overlap:.0%} front, {survey.side_overlap:.0%} side"
