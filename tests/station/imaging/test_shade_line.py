"""Ground images become shade maps and forecasts, in order, each frame once."""

import pickle
from dataclasses import replace

import numpy as np
import pytest
from tests.station.imagers import with_imagers
from tests.station.station_world import HOME

from recon.detection import DETECTORS, DetectionSettings
from recon.model.event import Event
from recon.model.geo import GroundGrid, LocalFrame
from recon.model.imagery import CameraPose, GroundImage
from recon.model.units import NS_PER_S
from recon.record.mcap.digest import digest
from recon.site import Site
from recon.station.alarms.conditions import conditions
from recon.station.api_views.imaging_views import shade_view
from recon.station.imaging import shade as shade_room
from recon.station.imaging.frames import PROJECT_FRAME
from recon.station.imaging.projection import ProjectedFrame
from recon.station.imaging.shade import READ_SHADE, ReadShade, read_shade, seen_cells
from recon.station.kernel.method_process import packed
from recon.station.kernel.step import step
from recon.station.kernel.worker import AnyJob, JobRunner
from recon.station.state.imaging import TOGETHER_WITHIN_S, WAITING_KEPT
from recon.station.state.settings import StationSettings
from recon.station.state.station import Station
from recon.station.state.steps import Job, JobDone, JobDropped, JobFailed, Output

GRID = GroundGrid(LocalFrame(HOME), -64.0, 64.0, 1.0, 128, 128)
POSE = CameraPose(np.eye(3), np.array([0.0, 0.0, 120.0]))
TEXTURE = np.random.default_rng(7).integers(90, 150, (128, 128, 1))


def ground_image(second: int, level: float = 1.0) -> GroundImage:
    """A field of a pattern of its own, darkened as a whole by a level; the east half is in sun."""
    light = np.where(np.arange(128) < 64, level, 1.0)[np.newaxis, :, np.newaxis]
    rgb = np.broadcast_to((TEXTURE * light**0.45).astype(np.uint8), (128, 128, 3)).copy()
    rgb[0, 0] = rgb[0, -1] = second % 200 + 20
    valid = np.ones((128, 128), dtype=np.bool_)
    return GroundImage(GRID, second, second * NS_PER_S, rgb, valid, POSE, serial="IMAGER")


def half_image(second: float, serial: str, *, is_east: bool) -> GroundImage:
    """The east or the west half of the field alone, as another imaging drone shows it."""
    image = ground_image(round(10 * second))
    valid = image.valid.copy()
    valid[:, slice(0, 60) if is_east else slice(68, 128)] = False
    rgb = np.where(valid[..., np.newaxis], image.rgb, np.uint8(0))
    at_ns = round(second * NS_PER_S)
    return replace(image, captured_at_ns=at_ns, rgb=rgb, valid=valid, serial=serial)


def projected(image: GroundImage) -> Event:
    return JobDone(image.frame_id, PROJECT_FRAME, ProjectedFrame(image))


def jobs_of(outputs: tuple[Output, ...]) -> list[AnyJob]:
    return [each for each in outputs if isinstance(each, Job)]


RUNNER = JobRunner(Site(name="bare"))


class Line:
    """A station whose worker runs each job when the test asks it to."""

    def __init__(self, station: Station | None = None) -> None:
        self.station = with_imagers(station or Station(), "IMAGER")
        self.given: list[AnyJob] = []
        self.read: list[int] = []

    def happens(self, event: Event, at_s: float = 0.0) -> None:
        self.station, outputs = step(self.station, event, round(at_s * NS_PER_S))
        self.given += jobs_of(outputs)

    def works(self) -> bool:
        if not self.given:
            return False
        work = self.given.pop(0)
        assert isinstance(work.input, ReadShade)
        self.read.append(work.input.image.frame_id)
        self.happens(RUNNER.run(work))
        return True


@pytest.fixture
def line() -> Line:
    """With the method that maps a drawn field within a minute."""
    detection = DetectionSettings(method="brightness_ratio")
    return Line(Station(settings=StationSettings(detection=detection)))


def test_every_frame_is_read_once_and_in_order(line: Line) -> None:
    for second in range(1, 6):
        line.happens(projected(ground_image(second)))
    assert len(line.given) == 1, "one at a time: the memory travels with the job"
    while line.works():
        pass
    assert line.read == [1, 2, 3, 4, 5]
    assert line.station.shade.number == 5


def test_memories_travel_to_another_process_and_back(line: Line) -> None:
    """Where a method of an installed package runs."""
    for second in range(1, 8):
        line.happens(projected(ground_image(second)))
        work = line.given[0].input
        there = pickle.loads(packed(read_shade(pickle.loads(packed(work)))))
        assert digest(there) == digest(read_shade(work))
        line.works()


def test_a_result_of_another_kind_is_refused(line: Line, monkeypatch: pytest.MonkeyPatch) -> None:
    """A package's method may return anything."""
    line.happens(projected(ground_image(1)))
    work = line.given[0].input
    monkeypatch.setattr(shade_room, "DETECTORS", {"brightness_ratio": lambda *_: (None, "sunny")})
    with pytest.raises(ValueError, match="expected a DetectionState and a ShadeMap, got 'sunny'"):
        read_shade(work)


def test_shade_is_mapped_where_it_fell(line: Line) -> None:
    for second in range(1, 61):
        line.happens(projected(ground_image(second, 0.25 if second > 40 else 1.0)))
        line.works()
    shade, sun = line.station.shade.shade, line.station.shade.sun
    assert shade is not None
    assert sun is not None
    assert shade.captured_at_ns == sun.issued_at_ns == 60 * NS_PER_S
    assert shade.valid.mean() > 0.9
    assert not shade.is_sunlit[:, :15].any()
    assert shade.is_sunlit[:, 17:].all()
    shown = shade_view(line.station, 62 * NS_PER_S)
    assert shown is not None
    assert shown.map is not None
    assert shown.forecast is not None
    assert shown.map.captured_age_s == 2.0
    assert shown.map.sunlit_share == pytest.approx(0.5, abs=0.05)
    assert shown.forecast.number == shown.map.number


def test_a_worker_that_is_too_slow_drops_the_oldest_and_counts_them(line: Line) -> None:
    for second in range(1, WAITING_KEPT + 5):
        line.happens(projected(ground_image(second)))
    assert line.station.shade.frames_dropped == 3
    while line.works():
        pass
    assert line.read == [1, *range(5, WAITING_KEPT + 5)]


def test_black_frames_are_an_alarm_until_a_good_one(line: Line) -> None:
    black = replace(ground_image(1), rgb=np.zeros((128, 128, 3), np.uint8))
    line.happens(projected(black))
    line.works()
    assert line.station.shade.frames_rejected == 1
    (alarm,) = [each for each in conditions(line.station, 0) if each.rule == "shade"]
    assert "black" in alarm.text
    assert alarm.after_s > 0.0
    line.happens(projected(ground_image(2)))
    line.works()
    assert [each for each in conditions(line.station, 0) if each.rule == "shade"] == []


def test_an_unknown_method_is_an_error_that_names_the_known_ones(line: Line) -> None:
    settings = line.station.settings
    detection = replace(settings.detection, method="best")
    line.station = replace(line.station, settings=replace(settings, detection=detection))
    line.happens(projected(ground_image(1)))
    line.works()
    assert line.station.shade.error is not None
    assert " or ".join(DETECTORS) in line.station.shade.error


def test_the_methods_are_the_settings(line: Line) -> None:
    settings = line.station.settings
    forecast = replace(settings.forecast, method="persistence")
    detection = replace(settings.detection, method="otsu")
    line.station = replace(
        line.station, settings=replace(settings, detection=detection, forecast=forecast)
    )
    line.happens(projected(ground_image(1, 0.25)))
    line.works()
    assert line.station.shade.sun is not None
    assert line.station.shade.sun.method == "persistence"
    assert line.station.shade.shade is not None


def test_after_a_dropped_job_the_next_image_is_read(line: Line) -> None:
    for second in (1, 2):
        line.happens(projected(ground_image(second)))
    dropped = line.given.pop()
    line.happens(JobDropped(dropped.id, READ_SHADE))
    assert line.station.shade.frames_dropped == 1
    line.works()
    assert line.read == [2]


def test_the_end_of_an_unknown_job_changes_nothing(line: Line) -> None:
    before = line.station
    line.happens(JobFailed(99, READ_SHADE, "late"))
    assert line.station is before


def test_the_same_results_give_the_same_station() -> None:
    """A recording of the events is enough to run it again."""
    first = Line()
    events: list[Event] = []
    for second in range(1, 6):
        first.happens(projected(ground_image(second)))
        events.append(projected(ground_image(second)))
        result = RUNNER.run(first.given.pop(0))
        assert isinstance(result, JobDone)
        first.happens(result)
        events.append(result)
    again = Line()
    for event in events:
        again.happens(event)
    assert again.station.shade.number == 5
    assert again.station.shade.shade is first.station.shade.shade


def test_the_cells_in_view_are_those_whose_middle_the_image_shows() -> None:
    """Also on a coarser grid that reaches farther than the image on two sides."""
    image = ground_image(1)
    image.valid[:, 100:] = False
    grid = GroundGrid(image.grid.frame, -68.0, 64.0, 4.0, 36, 20)
    seen = seen_cells(image, grid)
    assert not seen[:, 0].any()
    assert not seen[32:].any()
    assert seen[:32, 1:].all()
    east = GroundGrid(image.grid.frame, 20.0, 64.0, 4.0, 4, 6)
    assert seen_cells(image, east).tolist() == [[True] * 4 + [False] * 2] * 4


def test_a_forecast_of_unknown_ground_covers_nothing(line: Line) -> None:
    """The first frame of a method that needs several: no cell is known, none is predicted."""
    line.happens(projected(ground_image(1)))
    line.works()
    shown = shade_view(line.station, 2 * NS_PER_S)
    assert shown is not None
    assert shown.map is not None
    assert shown.map.known_share == 0.0
    assert shown.forecast is not None
    assert set(shown.forecast.predicted_share) == {0.0}


class TestSeveralImagingDrones:
    """WEST and EAST each show a half of the field."""

    @pytest.fixture
    def two(self) -> Line:
        line = Line(Station(settings=StationSettings(detection=DetectionSettings(method="otsu"))))
        line.station = with_imagers(line.station, "WEST", "EAST")
        return line

    @staticmethod
    def shown(line: Line) -> tuple[bool, bool]:
        """Whether the map shows the far west and the far east of the field."""
        shade = line.station.shade.shade
        assert shade is not None
        return bool(shade.valid[5, 2]), bool(shade.valid[5, -3])

    def sees(self, line: Line, second: float, serial: str) -> None:
        line.happens(projected(half_image(second, serial, is_east=serial == "EAST")))
        line.works()

    def test_one_map_shows_both_halves(self, two: Line) -> None:
        self.sees(two, 1.0, "WEST")
        assert self.shown(two) == (True, False)
        self.sees(two, 1.4, "EAST")
        assert self.shown(two) == (True, True)
        pipeline = two.station.shade
        assert pipeline.shade is not None
        assert pipeline.shade.source_serials == ("EAST", "WEST")
        assert pipeline.shade.captured_at_ns == round(1.4 * NS_PER_S)
        assert pipeline.seen is not None
        assert pipeline.seen[5, 2]
        assert pipeline.sun is not None
        assert pipeline.sun.horizon_s.shape == pipeline.shade.valid.shape
        self.sees(two, 2.0, "WEST")
        assert self.shown(two) == (True, True)

    def test_each_is_read_by_its_own_memory(self, two: Line) -> None:
        for second in (1.0, 2.0, 3.0):
            self.sees(two, second, "WEST")
            self.sees(two, second + 0.4, "EAST")
        detections = two.station.shade.detections
        assert {serial: each.serial for serial, each in detections.items()} == {
            "WEST": "WEST",
            "EAST": "EAST",
        }
        assert two.station.shade.frames_rejected == 0
        assert two.station.shade.number == 6

    def test_a_map_that_is_too_old_is_excluded(self, two: Line) -> None:
        self.sees(two, 1.0, "WEST")
        self.sees(two, 1.0 + TOGETHER_WITHIN_S, "EAST")
        assert self.shown(two) == (True, True)
        self.sees(two, 1.1 + TOGETHER_WITHIN_S, "EAST")
        assert self.shown(two) == (False, True)

    def test_an_image_taken_before_the_others_waits_for_the_next(self, two: Line) -> None:
        """Latencies differ: forecasts go forward in time only."""
        self.sees(two, 2.0, "EAST")
        self.sees(two, 1.8, "WEST")
        assert two.station.shade.number == 1
        assert self.shown(two) == (False, True)
        self.sees(two, 3.0, "EAST")
        assert self.shown(two) == (True, True)

    def test_each_has_its_own_alarm(self, two: Line) -> None:
        black = replace(
            half_image(1.0, "EAST", is_east=True), rgb=np.zeros((128, 128, 3), np.uint8)
        )
        two.happens(projected(black))
        two.works()
        self.sees(two, 1.2, "WEST")
        (alarm,) = [each for each in conditions(two.station, 0) if each.rule == "shade"]
        assert (alarm.serial, "black" in alarm.text) == ("EAST", True)
        shown = shade_view(two.station, 2 * NS_PER_S)
        assert shown is not None
        assert shown.rejected is not None
        assert shown.rejected.startswith("EAST: ")
