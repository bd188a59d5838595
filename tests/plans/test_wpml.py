"""WPML keeps the rules of DJI's reference, and the documents that the companion app writes."""

import io
import subprocess
import sys
import zipfile
from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree

import pytest
from tests.plans.surveyed import FIELDS, flights
from tests.plans.wpml_rules import TEMPLATE, WAYLINES, violations

from recon.plans.aircraft import AIRCRAFT, PAYLOADS, aircraft_named
from recon.plans.flight_plan import AtEnd, ExportedPlan, PhotoTrigger, PlanExportError
from recon.plans.kmz import kmz_of
from recon.plans.wpml import WpmlOptions, template_kml, waylines_wpml

VECTORS = Path(__file__).parents[2] / "vectors"
OPTIONS = WpmlOptions(1_700_000_000_000, aircraft_named("Mavic 3M", None))
SPACES = {"w": "http://www.dji.com/wpmz/1.0.2"}


def slope(plan: ExportedPlan) -> ExportedPlan:
    heights = (
        replace(each, height_above_takeoff_m=30.0 + k) for k, each in enumerate(plan.waypoints)
    )
    return replace(plan, waypoints=tuple(heights))


@pytest.mark.parametrize("field", FIELDS)
@pytest.mark.parametrize("at_end", AtEnd)
@pytest.mark.parametrize("photos", [None, PhotoTrigger(every_s=0.7), PhotoTrigger(every_m=8.0)])
def test_both_documents_keep_the_rules(
    field: str, at_end: AtEnd, photos: PhotoTrigger | None
) -> None:
    (plan,) = flights(field)
    stays = replace(plan.waypoints[2], loiter_s=1.5)
    waypoints = (*plan.waypoints[:2], stays, *plan.waypoints[3:])
    plan = replace(plan, waypoints=waypoints, at_end=at_end, photos=photos)
    for each in (plan, slope(plan), replace(slope(plan), takeoff_ellipsoid_height_m=None)):
        template = ElementTree.fromstring(template_kml(each, OPTIONS))
        waylines = ElementTree.fromstring(waylines_wpml(each, OPTIONS))
        assert list(violations(template, TEMPLATE)) == []
        assert list(violations(waylines, WAYLINES)) == []
        for document in (template, waylines):
            groups = [int(g.text or "") for g in document.iterfind(".//w:actionGroupId", SPACES)]
            assert groups == list(range(2 + (photos is not None)))


def test_rules_are_broken_by_what_is_missing_unknown_repeated_or_out_of_range() -> None:
    (plan,) = flights("triangle")
    text = waylines_wpml(plan, OPTIONS).decode()
    for old, new, expected in (
        ("<wpml:waylineId>0</wpml:waylineId>", "", "Folder lacks waylineId"),
        ("<wpml:waylineId>", "<wpml:x/><wpml:waylineId>", "unknown x in Folder"),
        ("relativeToStartPoint", "aboveSea", "executeHeightMode is aboveSea"),
        ("<wpml:executeHeight>35.000", "<wpml:executeHeight>nan", "executeHeight is nan"),
    ):
        root = ElementTree.fromstring(text.replace(old, new, 1))
        assert list(violations(root, WAYLINES)) == [expected]


def test_an_ellipsoid_height_is_that_of_the_place_or_is_not_written() -> None:
    (plan,) = flights("rectangle")
    ground_m = plan.takeoff_ellipsoid_height_m
    assert ground_m == pytest.approx(275.0, abs=0.01)
    root = ElementTree.fromstring(template_kml(slope(plan), OPTIONS))
    heights = [
        tuple(float(p.findtext(f"w:{name}", "", SPACES)) for name in ("ellipsoidHeight", "height"))
        for p in root.iter("{http://www.opengis.net/kml/2.2}Placemark")
    ]
    assert heights
    assert all(above == pytest.approx(ground_m + m, abs=0.002) for above, m in heights)
    unknown = replace(slope(plan), takeoff_ellipsoid_height_m=None)
    for each in (plan, unknown):
        assert b"ellipsoidHeight" not in template_kml(each, OPTIONS)
    assert b"globalRTHHeight" not in waylines_wpml(plan, OPTIONS)


def test_photos_are_taken_from_the_first_waypoint_to_the_last() -> None:
    (plan,) = flights("bay")
    root = ElementTree.fromstring(waylines_wpml(plan, OPTIONS))
    (group,) = (
        group
        for group in root.iterfind(".//w:actionGroup", SPACES)
        if group.findtext(".//w:actionTriggerType", "", SPACES) == "multipleTiming"
    )
    said = {each: group.findtext(f".//w:{each}", None, SPACES) for each in GROUP}
    assert said == {
        "actionGroupStartIndex": "0",
        "actionGroupEndIndex": str(len(plan.waypoints) - 1),
        "actionTriggerParam": "2.000",
        "actionActuatorFunc": "takePhoto",
        "payloadLensIndex": "visable",
    }


GROUP = (
    *("actionGroupStartIndex", "actionGroupEndIndex", "actionTriggerParam"),
    *("actionActuatorFunc", "payloadLensIndex"),
)


def test_a_lost_signal_returns_home_and_never_continues() -> None:
    (plan,) = flights("triangle")
    for document in (template_kml(plan, OPTIONS), waylines_wpml(plan, OPTIONS)):
        assert b"<wpml:exitOnRCLost>executeLostAction<" in document
        assert b"<wpml:executeRCLostAction>goBack<" in document


def test_the_archive_holds_both_documents_and_is_the_same_each_time() -> None:
    (plan,) = flights("triangle")
    data = kmz_of(plan, OPTIONS)
    names = zipfile.ZipFile(io.BytesIO(data)).namelist()
    assert names == ["wpmz/template.kml", "wpmz/waylines.wpml"]
    assert kmz_of(plan, OPTIONS) == data


def test_the_vectors_are_what_the_writer_writes(tmp_path: Path) -> None:
    script = VECTORS / "make_wpml.py"
    subprocess.run([sys.executable, str(script), str(tmp_path)], check=True)
    written = {path.name: path.read_bytes() for path in (tmp_path / "wpml").iterdir()}
    assert written == {path.name: path.read_bytes() for path in (VECTORS / "wpml").iterdir()}
    for name, data in written.items():
        rules = TEMPLATE if name.endswith(".kml") else WAYLINES
        if not name.endswith(".json"):
            assert list(violations(ElementTree.fromstring(data), rules)) == []


def test_every_aircraft_has_numbers_of_its_own() -> None:
    numbers = [(each.enum_value, each.sub_enum_value) for each in AIRCRAFT.values()]
    assert len(set(numbers)) == len(numbers)
    cameras = [each.payload.enum_value for each in AIRCRAFT.values() if each.payload]
    cameras += [each.enum_value for each in PAYLOADS.values()]
    assert len(set(cameras)) == len(cameras)


@pytest.mark.parametrize(
    ("name", "payload", "expected"),
    [
        (None, None, "a .kmz names its aircraft: choose one of Mavic 3E"),
        ("Mavic 3", None, "did you mean 'Mavic 3"),
        ("Mavic 3E", "H20", "Mavic 3E has its own camera"),
        ("Matrice 350", None, "Matrice 350 carries a camera: name one of H20"),
        ("Matrice 350", "P1", "no payload 'P1': known are H20"),
    ],
)
def test_an_aircraft_or_camera_that_is_not_known_is_refused(
    name: str | None, payload: str | None, expected: str
) -> None:
    with pytest.raises(PlanExportError, match=expected):
        aircraft_named(name, payload)


def test_a_named_camera_is_the_aircrafts() -> None:
    found = aircraft_named(" matrice 350 ", "h20t")
    assert found.payload is not None
    assert (found.enum_value, found.sub_enum_value, found.payload.enum_value) == (89, 0, 43)
