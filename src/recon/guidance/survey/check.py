"""What keeps a survey from being flown as it is asked for, in a grower's words."""

from collections.abc import Iterator

from recon.geo import region_fault
from recon.guidance.survey.settings import DEFAULT, SurveySettings
from recon.guidance.survey.swath import swath_of
from recon.model.survey import Survey
from recon.model.units import is_finite

MOST_CELLS = 4_000_000
"""400 ha in cells of 1 m: more takes memory and is no field."""

MOST_ROWS = 2_000
"""A region this many rows wide is a mistake in the height or in the region."""


def survey_fault(survey: Survey, settings: SurveySettings = DEFAULT) -> str | None:
    """Return the first thing wrong with a survey, with what to do; None when it can be flown."""
    return next(_faults(survey, settings), None)


def _faults(survey: Survey, settings: SurveySettings) -> Iterator[str]:
    fault = region_fault(survey.region)
    if fault is not None:
        yield f"the region {survey.name} cannot be surveyed: {fault}"
        return
    yield from _number_faults(survey)
    yield from _overlap_faults(survey, settings)
    yield from _size_faults(survey, settings)


def _number_faults(survey: Survey) -> Iterator[str]:
    camera = survey.camera
    numbers = (
        ("height", survey.height_above_takeoff_m, 1.0, 500.0, " m"),
        ("speed", survey.speed_mps, 0.5, 15.0, " m/s"),
        ("camera's field of view across", camera.across_deg, 5.0, 150.0, " degrees"),
        ("camera's field of view along", camera.along_deg, 5.0, 150.0, " degrees"),
        ("camera's interval", camera.interval_s, 0.1, 60.0, " s"),
        ("front overlap", survey.front_overlap, 0.0, 0.95, ""),
        ("side overlap", survey.side_overlap, 0.0, 0.95, ""),
        ("cell", survey.cell_m, 0.5, 50.0, " m"),
        ("row bearing", survey.row_bearing_deg or 0.0, -360.0, 360.0, " degrees"),
    )
    for name, value, least, most, unit in numbers:
        if not (is_finite(value) and least <= value <= most):
            yield f"the {name} is {value:g}{unit}: {least:g} to {most:g}{unit} are possible"
    if survey.budget.rounds < 1:
        yield f"{survey.budget.rounds} rounds are allowed: at least 1 is needed"


def _overlap_faults(survey: Survey, settings: SurveySettings) -> Iterator[str]:
    camera, height_m = survey.camera, survey.height_above_takeoff_m
    slack_m = 2.0 * settings.place_slack_m
    across_m, along_m = camera.across_m(height_m), camera.along_m(height_m)
    if min(across_m, along_m) < 2.0 * slack_m:
        yield (
            f"from {height_m:g} m a photo shows {across_m:.1f} x {along_m:.1f} m, too little "
            f"beside the {slack_m:g} m that a drone may be off its place: fly higher"
        )
        return
    photo_m = survey.speed_mps * camera.interval_s
    longest_m = min(along_m * (1.0 - survey.front_overlap), along_m - slack_m)
    if photo_m > longest_m * (1.0 + 1e-9):
        yield (
            f"at {survey.speed_mps:g} m/s a photo every {camera.interval_s:g} s comes every "
            f"{photo_m:.1f} m; {survey.front_overlap:.0%} front overlap from {height_m:g} m needs "
            f"one every {longest_m:.1f} m: fly at {longest_m / camera.interval_s:.1f} m/s at most"
        )


def _size_faults(survey: Survey, settings: SurveySettings) -> Iterator[str]:
    outline_m = survey.region.outline_m
    wide_m, high_m = outline_m.max(axis=0) - outline_m.min(axis=0)
    if wide_m * high_m / survey.cell_m**2 > MOST_CELLS:
        yield (
            f"the region is {wide_m / 1000:.1f} x {high_m / 1000:.1f} km: too large for cells of "
            f"{survey.cell_m:g} m"
        )
    spacing_m = swath_of(survey, settings).widest_spacing_m
    if max(wide_m, high_m) / spacing_m > MOST_ROWS:
        yield f"rows {spacing_m:.1f} m apart are more than {MOST_ROWS} in this region"
