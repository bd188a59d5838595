"""Ground images become shade maps and forecasts, in order, each frame once."""

from dataclasses import replace

import numpy as np
import pytest
from tests.station.station_world import HOME

from recon.model.event import DeadlineMissed, WorkerResult
from recon.model.geo import GroundGrid, LocalFrame
from recon.model.imagery import CameraPose, GroundImage
from recon.model.units import NS_PER_S
from recon.station.alarms.conditions import conditions
from recon.station.imaging.shade_told import view
from recon.station.imaging.shade_work import READ_SHADE, ReadShade, ShadeRead, read_task
from recon.station.kernel.step import step
from recon.station.kernel.worker import do_work
from recon.station.state.imaging import LAY_FRAME
from recon.station.state.outputs import Output, StartWork
from recon.station.state.shade import WAITING_KEPT
from recon.station.state.station import Station

GRID = GroundGrid(LocalFrame(HOME), -64.0, 64.0, 1.0, 128, 128)
POSE = CameraPose(np.eye(3), np.array([0.0, 0.0, 120.0]))
TEXTURE = np.random.default_rng(7).integers(90, 150, (128, 128, 1))


def ground_image(second: int, level: float = 1.0) -> GroundImage:
    """A field of a pattern of its own, darkened as a whole by a level; the east half is in sun."""
    light = np.where(np.arange(128) < 64, level, 1.0)[np.newaxis, :, np.newaxis]
    rgb = np.broadcast_to((TEXTURE * light**0.45).astype(np.uint8), (128, 128, 3)).copy()
    rgb[0, 0] = second % 200 + 20
    valid = np.ones((128, 128), dtype=np.bool_)
    return GroundImage(GRID, second, second * NS_PER_S, rgb, valid, POSE, serial="IMAGER")


def laid(image: GroundImage) -> WorkerResult:
    return WorkerResult(image.frame_id, LAY_FRAME, image)


def worked(outputs: tuple[Output, ...]) -> list[StartWork]:
    return [each for each in outputs if isinstance(each, StartWork)]


class Line:
    """A station whose worker does what it is given when the test says so."""

    def __init__(self, station: Station | None = None) -> None:
        self.station = station or Station()
        self.station = replace(
            self.station, imaging=replace(self.station.imaging, imager_serial="IMAGER")
        )
        self.given: list[StartWork] = []
        self.read: list[int] = []

    def happens(self, event: object, at_s: float = 0.0) -> None:
        self.station, outputs = step(self.station, event, round(at_s * NS_PER_S))  # type: ignore[arg-type]
        self.given += worked(outputs)

    def works(self) -> bool:
        if not self.given:
            return False
        work = self.given.pop(0)
        assert isinstance(work.payload, ReadShade)
        self.read.append(work.payload.image.frame_id)
        self.happens(do_work({READ_SHADE: read_task}, work))
        return True


@pytest.fixture
def line() -> Line:
    return Line()


def test_every_frame_is_read_once_and_in_order(line: Line) -> None:
    for second in range(1, 6):
        line.happens(laid(ground_image(second)))
    assert len(line.given) == 1, "one at a time: the memory travels with the work"
    while line.works():
        pass
    assert line.read == [1, 2, 3, 4, 5]
    assert line.station.shade.number == 5


def test_shade_is_told_where_it_fell(line: Line) -> None:
    for second in range(1, 61):
        line.happens(laid(ground_image(second, 0.25 if second > 40 else 1.0)))
        line.works()
    shade, sun = line.station.shade.shade, line.station.shade.sun
    assert shade is not None
    assert sun is not None
    assert shade.captured_at_ns == sun.issued_at_ns == 60 * NS_PER_S
    assert shade.valid.mean() > 0.9
    assert not shade.is_sunlit[:, :15].any()
    assert shade.is_sunlit[:, 17:].all()
    shown = view(line.station, 62 * NS_PER_S)
    assert shown is not None
    assert shown.map is not None
    assert shown.forecast is not None
    assert shown.map.captured_age_s == 2.0
    assert shown.map.sunlit_share == pytest.approx(0.5, abs=0.05)
    assert shown.forecast.number == shown.map.number


def test_a_worker_that_is_too_slow_drops_the_oldest_and_counts_them(line: Line) -> None:
    for second in range(1, WAITING_KEPT + 5):
        line.happens(laid(ground_image(second)))
    assert line.station.shade.frames_dropped == 3
    while line.works():
        pass
    assert line.read == [1, *range(5, WAITING_KEPT + 5)]


def test_a_black_frame_is_told_after_a_while_and_until_a_good_one(line: Line) -> None:
    black = replace(ground_image(1), rgb=np.zeros((128, 128, 3), np.uint8))
    line.happens(laid(black))
    line.works()
    assert line.station.shade.frames_rejected == 1
    (told,) = [each for each in conditions(line.station, 0) if each.rule == "shade"]
    assert "black" in told.text
    assert told.after_s > 0.0
    line.happens(laid(ground_image(2)))
    line.works()
    assert [each for each in conditions(line.station, 0) if each.rule == "shade"] == []


def test_a_method_that_there_is_none_of_is_an_error_with_the_names(line: Line) -> None:
    settings = line.station.settings
    detection = replace(settings.detection, method="best")
    line.station = replace(line.station, settings=replace(settings, detection=detection))
    line.happens(laid(ground_image(1)))
    line.works()
    assert line.station.shade.error is not None
    assert "brightness_ratio or otsu" in line.station.shade.error


def test_the_methods_are_the_settings(line: Line) -> None:
    settings = line.station.settings
    forecast = replace(settings.forecast, method="persistence")
    detection = replace(settings.detection, method="otsu")
    line.station = replace(
        line.station, settings=replace(settings, detection=detection, forecast=forecast)
    )
    line.happens(laid(ground_image(1, 0.25)))
    line.works()
    assert line.station.shade.sun is not None
    assert line.station.shade.sun.method == "persistence"
    assert line.station.shade.shade is not None


def test_work_that_was_dropped_goes_on_with_the_next(line: Line) -> None:
    for second in (1, 2):
        line.happens(laid(ground_image(second)))
    dropped = line.given.pop()
    line.happens(DeadlineMissed(dropped.job_id, READ_SHADE, "newer work came"))
    assert line.station.shade.frames_dropped == 1
    line.works()
    assert line.read == [2]


def test_an_answer_nobody_waits_for_changes_nothing(line: Line) -> None:
    before = line.station
    line.happens(WorkerResult(99, READ_SHADE, None, "late"))
    assert line.station is before


def test_the_same_results_give_the_same_station() -> None:
    """What a recording of the events holds is enough to run it again."""
    first = Line()
    events: list[object] = []
    for second in range(1, 6):
        first.happens(laid(ground_image(second)))
        events.append(laid(ground_image(second)))
        result = do_work({READ_SHADE: read_task}, first.given.pop(0))
        assert isinstance(result.result, ShadeRead)
        first.happens(result)
        events.append(result)
    again = Line()
    for event in events:
        again.happens(event)
    assert again.station.shade.number == 5
    assert again.station.shade.shade is first.station.shade.shade
