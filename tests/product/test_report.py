"""`recon report` on flights made by construction: its figures, and pages that hold hostile text."""

import contextlib
import math
from dataclasses import replace
from datetime import UTC, datetime, timedelta, timezone
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from foxglove_schemas_protobuf.Grid_pb2 import Grid
from foxglove_schemas_protobuf.PackedElementField_pb2 import PackedElementField
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.product.made_flight import (
    GRID,
    HEIGHT_M,
    ONE,
    OTHER,
    START_NS,
    Rows,
    flight,
    sun,
    write_card,
    write_record,
)
from typer.testing import CliRunner

from recon.cli.commands import app
from recon.cli.report import BROWSERS, print_pdf
from recon.geo import cell_centres_m
from recon.model.errors import RecordError
from recon.model.units import NS_PER_S
from recon.product.exports import figures as figures_of
from recon.product.flight import RecordedTrack
from recon.product.flight_log import FlightLog, LogReader, read_log
from recon.product.flight_reader import read_flight
from recon.product.report import AlarmSpan, FlightReport, flight_report
from recon.product.report_page import report_html
from recon.product.tagged import tagged_photos
from recon.record.mcap.foxglove import SUN_TOPIC
from recon.record.mcap.mcap_read import RecordMessage

HOSTILE = "\"><script>alert(1)</script><img src=//x.example onerror=alert(2)>{{ 7*7 }}' &<b>"
PLACES = np.meshgrid(*cell_centres_m(GRID))
SIM_1 = "Drone 1"
MADE = flight(maps_every_s=60.0)
HOUR_NS = 3_600 * NS_PER_S


def entry(kind: str, text: str = "text", vehicle: str = SIM_1, **details: object) -> dict:
    return {"kind": kind, "text": text, "by": "Ann", "vehicle": vehicle, "details": details}


ENTRIES = [
    (0.0, entry("vehicle.position")),
    (5.0, entry("vehicle.took_off", "Drone 1: took off")),
    (6.0, entry("order.queued")),
    (20.0, entry("alarm.raised", "alarm: battery low", id=3, severity="warning")),
    (22.0, entry("alarm.worse", "alarm is worse: battery empty", id=3, severity="critical")),
    (30.0, entry("alarm.ended", "alarm ended: battery empty", id=3, severity="critical")),
    (31.0, entry("alarm.raised", "alarm: side-steps", id=4, severity="info")),
    (65.0, entry("vehicle.landed", "Drone 1: landed")),
    (70.0, entry("vehicle.took_off", "Drone 2: took off", "Drone 2")),
]


def persistence(at_s: float, _lead_s: float) -> np.ndarray:
    return (sun(*PLACES, at_s) >= 0.5).astype(float)


def perfect(at_s: float, lead_s: float) -> np.ndarray:
    return (sun(*PLACES, at_s + lead_s) >= 0.5).astype(float)


@pytest.fixture(scope="module")
def record(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("report") / "flight.mcap"
    return write_record(
        flight(ONE, OTHER, maps_every_s=6.0), path, entries=ENTRIES, forecast=perfect
    )


def report_of(path: Path) -> FlightReport:
    read = read_flight(path)
    return flight_report(read, read_log(path, read), None)


@pytest.fixture(scope="module")
def report(record: Path) -> FlightReport:
    return report_of(record)


class Page(HTMLParser):
    """Tags, attributes and text of a page."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.tags: list[str] = []
        self.attributes: list[tuple[str, str]] = []
        self.text = ""
        self.feed(text)

    def handle_starttag(self, tag, attrs) -> None:
        self.tags.append(tag)
        self.attributes += [(name, value or "") for name, value in attrs]

    def handle_data(self, data) -> None:
        self.text += data


def test_a_perfect_forecast_has_skill_one_and_persistence_none(
    report: FlightReport, tmp_path: Path
) -> None:
    leads = report.log.leads
    # Leads between two of the forecast's are mixed of them, and may not be perfect.
    assert set(leads) == {15.0, 30.0, 60.0, 120.0}
    for lead_s in (60.0, 120.0):
        assert leads[lead_s].brier == 0.0
        assert leads[lead_s].skill == 1.0
        assert leads[lead_s].persistence_brier > 0.1
    path = write_record(flight(maps_every_s=12.0), tmp_path / "other.mcap", forecast=persistence)
    for figures in report_of(path).log.leads.values():
        assert figures.skill == pytest.approx(0.0, abs=1e-6)


def test_cover_and_coverage_are_those_of_the_construction(report: FlightReport) -> None:
    assert report.covered is not None
    region = report.covered.region
    east_m, north_m = PLACES
    assert np.array_equal(region, (np.abs(east_m) < 90.0) & (np.abs(north_m) < 90.0))
    for at_ns, share in report.cover[::6]:
        lit = sun(*PLACES, (at_ns - START_NS) / NS_PER_S) >= 0.5
        assert share == pytest.approx(lit[region].mean(), abs=1e-6)
    # Rows 25 m apart under a camera that shows 78 m: each cell is on several photos.
    assert report.covered.is_estimated
    assert report.covered.share(0) == 1.0
    assert report.covered.share(1) >= report.covered.enough > 0.5


def test_ground_beyond_the_shade_maps_is_of_the_region() -> None:
    made = flight(Rows(west_m=0.0), maps_every_s=60.0)
    outline = ((0.0, -90.0), (250.0, -90.0), (250.0, 90.0), (0.0, 90.0))
    made = replace(made, surveys=[replace(made.surveys[0], outline_m=outline)])
    covered = flight_report(made, FlightLog(), None).covered
    assert covered is not None
    assert covered.area_m2 == pytest.approx(250.0 * 180.0)
    # The last row is 200 m east, half a footprint is 39 m; the maps end 150 m east.
    assert covered.share(0) == pytest.approx(239.0 / 250.0, abs=0.01)
    assert 0.3 < covered.share(1) < 150.0 / 250.0
    # From no more than a few cells a region may not take all memory.
    far = ((0.0, 0.0), (9e6, 0.0), (9e6, 9e6))
    made = replace(made, surveys=[replace(made.surveys[0], outline_m=far)])
    with pytest.raises(RecordError, match="expected regions of surveys near the shade maps"):
        flight_report(made, FlightLog(), None)


@pytest.mark.parametrize(
    ("course", "height_m", "speed_mps", "is_photographed"),
    [
        ((0.0, 1.0), HEIGHT_M, 8.0, True),
        ((0.6, 0.8), HEIGHT_M, 8.0, False),
        ((0.0, 1.0), HEIGHT_M + 10.0, 8.0, False),
        ((0.0, 1.0), HEIGHT_M, 14.0, False),
    ],
)
def test_only_what_is_flown_along_rows_is_photographed(
    course: tuple[float, float], height_m: float, speed_mps: float, is_photographed: bool
) -> None:
    """The way to the first row and home, at their own height or speed, count for no survey."""
    made = flight(maps_every_s=60.0)
    at_s = np.arange(0.0, 20.0, 0.1)
    east_m, north_m = (each * speed_mps * at_s - 80.0 for each in course)
    yaw_deg = np.full_like(at_s, np.rad2deg(np.arctan2(*course)))
    at_ns = START_NS + np.rint(at_s * NS_PER_S).astype(np.int64)
    height = np.full_like(at_s, height_m)
    way = RecordedTrack("SIM-1", at_ns, east_m, north_m, height, yaw_deg)
    covered = flight_report(replace(made, tracks={"SIM-1": way}), FlightLog(), None).covered
    assert covered is not None
    assert (covered.share(0) > 0.1) == is_photographed


def test_only_surveys_that_were_started_count(tmp_path: Path) -> None:
    made = flight(maps_every_s=60.0)
    (flown,) = made.surveys
    far = tuple((east + 400.0, north) for east, north in flown.outline_m)
    idle = replace(flown, outline_m=far, height_above_takeoff_m=200.0, starts=())
    later = replace(flown, name="later", starts=((START_NS + 30 * NS_PER_S, frozenset({"SIM-1"})),))
    made = replace(made, surveys=[flown, idle, later])
    path = write_record(made, tmp_path / "a.mcap", refused_start_of=2)
    read = read_flight(path)
    assert [each.name for each in read.surveys] == ["field", "later"]
    track = read.tracks["SIM-1"]
    parts = [(each.name, part) for each, part in read.parts_by_survey(track)]
    assert parts == [("field", slice(0, 300)), ("later", slice(300, len(track.at_ns)))]
    assert read.parts_by_survey(replace(track, serial="SIM-2")) == []
    covered = report_of(path).covered
    assert covered is not None
    assert covered.share(0) == 1.0


def test_alarms_flights_and_decisions_of_the_log(report: FlightReport) -> None:
    seconds = [(each.text, each.severity, each.ended_ns) for each in report.alarms]
    ended_ns = START_NS + 30 * NS_PER_S
    assert seconds == [("battery empty", "critical", ended_ns), ("side-steps", "info", None)]
    spans = {
        name: [tuple(round((at - START_NS) / NS_PER_S) for at in span) for span in each]
        for name, each in report.airborne.items()
    }
    assert spans[SIM_1] == [(5, 65)]
    assert spans["Drone 2"] == [(70, round((report.end_ns - START_NS) / NS_PER_S))]
    assert [each.kind for each in report.decisions] == [
        "vehicle.took_off",
        "vehicle.landed",
        "vehicle.took_off",
    ]
    assert report.log.batteries["SIM-1"][0][1] == pytest.approx(0.8)
    assert report.log.settings() == {
        "detection.method": "made",
        "detection.lead_s": "[1.0, 2.5]",
        "is_on": "true",
    }


def test_the_page_states_what_the_report_holds(report: FlightReport) -> None:
    page = Page(report_html(report))
    text = " ".join(page.text.split())
    for part in ("made field", "battery empty", "Drone 1: took off", "+1.00", "detection.method"):
        assert part in text
    assert report.covered is not None
    assert f"In sun on 3 photos{100.0 * report.covered.enough:.0f} %estimated" in text
    assert page.tags.count("svg") == 5


def test_an_alarm_that_comes_again_is_one_row(report: FlightReport) -> None:
    late = "the station is late: no step for {} s"
    spans = [
        AlarmSpan(START_NS + at, START_NS + at + 3 * NS_PER_S, "error", late.format(each))
        for at, each in ((NS_PER_S, "0.7"), (9 * NS_PER_S, "0.5"), (20 * NS_PER_S, "2"))
    ]
    others = [
        AlarmSpan(START_NS, None, "error", f"Drone {each}: battery at 20 %") for each in (1, 2)
    ]
    page = Page(report_html(replace(report, alarms=[*spans, *others]), zone=UTC))
    text = " ".join(page.text.split())
    assert "3 times, 9 s together; the last: the station is late: no step for 2 s" in text
    assert text.count("the station is late") == 1
    assert "Drone 1: battery at 20 %" in text
    assert "Drone 2: battery at 20 %" in text


def test_local_time_is_beside_utc(report: FlightReport) -> None:
    five_and_a_half = timezone(timedelta(hours=5, minutes=30), "field")
    text = " ".join(Page(report_html(report, zone=five_and_a_half)).text.split())
    utc = datetime.fromisoformat(report.flight.utc(report.begin_ns))
    local = utc.astimezone(five_and_a_half)
    assert f"Flight report, {local:%Y-%m-%d}, {local:%H:%M:%S} to " in text
    assert "local time (UTC+05:30, field)" in text
    assert f"{utc:%H:%M:%S} to " in text
    assert "this computer's zone" in Page(report_html(report)).text


def test_light_that_few_maps_know_is_not_that_of_the_flight(report: FlightReport) -> None:
    few = replace(report, cover=report.cover[:2])
    text = " ".join(Page(report_html(few)).text.split())
    assert f"%known in 2 of {len(report.flight.maps)} shade maps" in text
    assert figures_of(few)["shade_maps_of_the_region"] == 2
    assert "share of the shade maps that show the place" in text


def test_hostile_text_stays_text(tmp_path: Path) -> None:
    made = flight(maps_every_s=20.0)
    made = replace(
        made,
        names={"SIM-1": HOSTILE},
        surveys=[replace(each, name=HOSTILE) for each in made.surveys],
        path=Path(f"{HOSTILE.replace('/', '')}.mcap"),
    )
    entries = [
        (20.0, entry("alarm.raised", f"alarm: {HOSTILE}", HOSTILE, id=3, severity=HOSTILE)),
        (21.0, entry("survey.started", HOSTILE, HOSTILE) | {"by": HOSTILE}),
        (22.0, entry("vehicle.took_off", HOSTILE, HOSTILE)),
    ]
    path = write_record(made, tmp_path / "a.mcap", site=HOSTILE, entries=entries)
    read = replace(read_flight(path), trouble=HOSTILE, path=made.path)
    page = Page(report_html(flight_report(read, read_log(path, read), None)))
    assert "script" not in page.tags
    assert "img" not in page.tags
    assert "b" not in page.tags
    for name, value in page.attributes:
        assert not name.startswith("on")
        assert name not in ("href", "src") or value.startswith("data:image/png;base64,")
    assert page.text.count(HOSTILE) >= 6


def test_a_flight_without_maps_or_surveys_has_a_report(tmp_path: Path) -> None:
    path = write_record(replace(flight(), maps=[], surveys=[]), tmp_path / "bare.mcap")
    report = report_of(path)
    assert report.covered is None
    page = Page(report_html(report))
    assert "No shade map was recorded" in page.text
    assert "No forecast could be compared" in page.text
    assert "Region" not in page.text


def test_the_command_takes_tagged_photos_for_coverage(record: Path, tmp_path: Path) -> None:
    write_card(tmp_path / "card", every=12)
    tag = ["tag", tmp_path / "card", "--flight", record, "--out", tmp_path / "tagged"]
    assert CliRunner().invoke(app, [str(word) for word in tag]).exit_code == 0
    words = ["report", record, "--tagged", tmp_path / "tagged", "--out", tmp_path / "r.html"]
    result = CliRunner().invoke(app, [str(word) for word in words])
    assert result.exit_code == 0, result.output
    text = Page((tmp_path / "r.html").read_text()).text
    count = len(tagged_photos(tmp_path / "tagged", read_flight(record)))
    assert f"Photos{count}" in "".join(text.split())
    assert "estimated" not in text


@pytest.mark.parametrize(
    ("fields", "row"),
    [
        ({"kind": 5, "text": "a"}, "kind"),
        ({"text": "a"}, "kind"),
        ({"kind": "a", "text": "a", "details": []}, "details"),
    ],
)
def test_a_damaged_log_is_refused_with_what_is_wrong(
    tmp_path: Path, fields: dict, row: str
) -> None:
    path = write_record(flight(maps_every_s=60.0), tmp_path / "a.mcap", entries=[(1.0, fields)])
    with pytest.raises(RecordError, match=f"the log is damaged: .*{row}"):
        read_log(path, read_flight(path))


def test_no_browser_is_a_clear_refusal(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(RecordError, match="needs Chromium, Chrome or Edge"):
        print_pdf(tmp_path / "r.html", tmp_path / "r.pdf")
    for name, script in ((BROWSERS[0], "#!/bin/sh\necho no display >&2\nexit 1\n"),):
        (tmp_path / name).write_text(script)
        (tmp_path / name).chmod(0o755)
        with pytest.raises(RecordError, match="did not print the page: 'no display'"):
            print_pdf(tmp_path / "r.html", tmp_path / "r.pdf")


def core(arrived_at_ns: object) -> dict[str, Any]:
    """A position report's event."""
    place = {"latitude_deg": 41.9, "longitude_deg": -93.6}
    report = {"_": "CoreReport", "position": place, "height_above_takeoff_m": 60.0}
    report["attitude"] = None
    return {"_": "PacketReceived", "link_id": 1, "report": report, "arrived_at_ns": arrived_at_ns}


@pytest.mark.parametrize(
    ("log_ns", "event", "why"),
    [
        (START_NS, core(2**62), "arrived"),
        (START_NS, core(2**63), "arrived"),
        (START_NS, core(1e300), "whole number"),
        (2 * HOUR_NS, core(2 * HOUR_NS - HOUR_NS - 1), "arrived"),
        (2**63, core(None), "station time"),
        (START_NS, {"_": "ClockRead", "wall_ns": math.inf}, "whole number"),
        (START_NS, {"_": "ClockRead", "wall_ns": -(2**63)}, "a clock"),
        (START_NS, {"_": "PacketReceived", "link_id": math.inf, "report": {}}, "infinity"),
    ],
)
def test_a_time_that_cannot_be_is_refused(
    log_ns: int, event: dict[str, Any], why: str, tmp_path: Path
) -> None:
    made = replace(MADE, maps=[], tracks={})
    path = write_record(made, tmp_path / "a.mcap", events=[(log_ns, event)])
    with pytest.raises(RecordError, match=f"step .* is damaged: .*{why}"):
        read_flight(path)


def test_photos_are_capped(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("recon.product.report.MOST_PHOTOS", 10)
    with pytest.raises(RecordError, match="expected at most 10 photos"):
        flight_report(MADE, FlightLog(), None)


NUMBERS = st.one_of(st.integers(-(2**31), 2**31 - 1), st.sampled_from([0, 1, 150]))


@given(st.binary(max_size=200), st.lists(st.text(max_size=12), max_size=4), NUMBERS, st.floats())
@settings(max_examples=80, deadline=None)
def test_no_forecast_breaks_the_reader(
    data: bytes, names: list[str], size: int, place: float
) -> None:
    grid = Grid(data=data, column_count=abs(size), cell_stride=len(names))
    grid.fields.extend(PackedElementField(name=name) for name in names)
    grid.cell_size.x = grid.pose.position.x = place
    for message in (data, grid.SerializeToString(), on_the_grid(names)):
        item = RecordMessage(SUN_TOPIC, "protobuf", "foxglove.Grid", 1, 0, message)
        reader = LogReader(Path("a.mcap"), MADE)
        with contextlib.suppress(RecordError):
            reader.take(item)


def on_the_grid(names: list[str]) -> bytes:
    """A forecast on the cells of the maps, with leads of any name."""
    grid = Grid(column_count=GRID.cols, cell_stride=len(names))
    grid.data = bytes(GRID.rows * GRID.cols * len(names))
    grid.fields.extend(PackedElementField(name=name) for name in names)
    grid.cell_size.x = grid.cell_size.y = GRID.cell_m
    grid.pose.position.x = GRID.west_m
    grid.pose.position.y = GRID.north_m - GRID.rows * GRID.cell_m
    grid.timestamp.FromNanoseconds(MADE.maps[0].at_ns)
    return grid.SerializeToString()
