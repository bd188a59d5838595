"""A survey's flights of several drones come as an archive; a refusal is a sentence."""

import io
import zipfile

import pytest
from tests.plans.surveyed import survey_plan

from recon.guidance.survey import Surveyor
from recon.guidance.survey.estimate import Batteries, corner_of
from recon.plans.flight_plan import PlanExportError
from recon.station.api_views.survey_exports import SurveyExports
from recon.station.api_views.survey_preview import PreviewedFleet


def exports(level_s: float | None = None) -> SurveyExports:
    plan = survey_plan("bay")
    home_m = corner_of(plan)
    fleet = tuple(Surveyor(serial, home_m, home_m=home_m) for serial in ("A", "B"))
    names = {"A": "Ash", "B": "Birch / 2"}
    return SurveyExports(PreviewedFleet(plan, fleet, names, Batteries(level_s), None, 15.0))


def test_a_file_for_each_drone_comes_in_an_archive() -> None:
    file = exports().file("waypoints", None, None)
    assert (file.name, file.media_type) == ("survey-1.waypoints.zip", "application/zip")
    names = zipfile.ZipFile(io.BytesIO(file.data)).namelist()
    assert names == [
        "survey-1-Ash-flight-1.waypoints",
        "survey-1-Birch-2-flight-1.waypoints",
    ]
    counts = {each.kind: each.files for each in exports().view(None, None).formats}
    assert (counts["waypoints"], counts["kml"], counts["kmz"]) == (2, 1, 0)


def test_a_battery_too_small_is_every_formats_refusal() -> None:
    small = exports(level_s=5.0)
    with pytest.raises(PlanExportError, match="a full battery gives"):
        small.file("csv", None, None)
    refusals = [each.refusal or "" for each in small.view("Mavic 3E", None).formats]
    assert all("a full battery gives" in refusal for refusal in refusals)
