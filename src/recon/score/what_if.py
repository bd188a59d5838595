"""Other methods of detection and forecast over the ground images of a recorded flight.

A replay runs the recorded flight again, to the bit. Each ground image that it reads for shade is
read once more by the methods asked for, with memories of their own, so that all differences are the
methods'. Nothing of it comes back into the flight: the survey stays as it was flown.

Where the flight was simulated, maps and forecasts are compared with the true sky. Elsewhere each
forecast is compared with the method's own later map, and the maps of both methods with each other.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

from recon.detection import DETECTORS, DetectionState, RejectedFrame
from recon.forecast import FORECASTERS, ForecastSettings, ForecastState
from recon.model.errors import ReconError
from recon.model.event import Event
from recon.model.shade import ShadeMap
from recon.model.units import ns_to_seconds
from recon.score.forecast_figures import LeadScore
from recon.score.forecast_scoring import ForecastKey, ForecastScoring
from recon.score.forecast_tables import forecast_tables, leads_table
from recon.score.run_score import MapsScore
from recon.score.settings import SCORE
from recon.score.shade_figures import Overlap, overlap
from recon.score.shade_scoring import ScoredGround, scored_ground
from recon.score.table_rows import NOTHING, fine, percent, table
from recon.score.tables import shade_table
from recon.score.truth import Truth
from recon.score.verification import Verification
from recon.station.imaging.shade import READ_SHADE, ReadShade, ShadeRead, read_shade
from recon.station.kernel.worker import AnyJob
from recon.station.state.imaging import SeenShade, ShadePipeline
from recon.station.state.steps import JobDone

RECORDED, ASKED = "as recorded", "what if"


@dataclass(slots=True)
class MethodPair:
    """One pair of methods, the maps they gave, and their score."""

    detection: str
    forecast: str
    maps: int = 0
    rejected: int = 0
    newest: ShadeMap | None = None
    score: MapsScore = field(default_factory=MapsScore)
    _truth: Truth | None = None
    _ground: ScoredGround | None = None
    _forecasts: ForecastScoring | None = None
    _verified: Verification | None = None
    _map_due_s: float = 0.0

    @property
    def names(self) -> str:
        """Both names."""
        return f"detection {self.detection}, forecast {self.forecast}"

    def compare_with(self, truth: Truth) -> None:
        """Score against the simulated sky from now on."""
        self._truth, self._ground = truth, scored_ground(truth.scenario)
        self._forecasts = ForecastScoring(
            truth.sky,
            self._ground.grid,
            self._ground.counted,
            self.forecast,
            (),
            ForecastSettings(),
            zero_ns=truth.zero_ns,
            sums=self.score.forecasts,
        )

    def take(self, read: ShadeRead) -> None:
        """Score what an image has shown."""
        self.rejected += isinstance(read.own, RejectedFrame)
        if read.merged is None:
            return
        seen, sun = read.merged
        self.maps, self.newest = self.maps + 1, seen.shade
        if self._truth is None or self._ground is None or self._forecasts is None:
            self._verify(seen.shade)
            return
        at_s = ns_to_seconds(seen.shade.captured_at_ns - self._truth.zero_ns)
        self.score.simulated_s = at_s
        if at_s >= self._map_due_s:
            self._map_due_s = at_s + SCORE.score_maps_every_s
            self.score.shade += self._ground.figures(
                read.forecast.followed or seen.shade, self._truth.sky, at_s
            )
        line = ShadePipeline(
            number=self.maps, shade=seen.shade, seen=seen.seen, sun=sun, forecast=read.forecast
        )
        self._forecasts.update(line, at_s)
        self.score.changes = self._forecasts.changes

    def _verify(self, shade: ShadeMap) -> None:
        if self._verified is None:
            self._verified = Verification((self.forecast,))
        self._verified.observe(shade)

    def verified(self) -> dict[ForecastKey, LeadScore]:
        """Return the sums of the forecasts against the method's own later maps."""
        if self._verified is None:
            return {}
        self._verified.finish()
        return self._verified.sums


class WhatIf:
    """Reads each image of a replayed flight again, by other methods."""

    def __init__(self, detection: str | None, forecast: str | None) -> None:
        """None keeps the recorded method; raises `ReconError` for an unknown name."""
        _require(detection, tuple(DETECTORS), "detection")
        _require(forecast, tuple(FORECASTERS), "forecast")
        self._asked = detection, forecast
        self.truth: Truth | None = None
        self.images = 0
        self.recorded: MethodPair | None = None
        self.asked: MethodPair | None = None
        self.agreement = Overlap()
        """Overlap of the shade that both pairs of methods found in the same images."""
        self.same_cells = self.known_cells = 0
        self._detections: dict[str, DetectionState] = {}
        self._forecast: ForecastState | None = None
        self._own: dict[str, SeenShade] = {}
        self._velocity_mps: tuple[float, float] | None = None

    def take(self, job: AnyJob, ended: Event) -> None:
        """Take a job that the replay has run, and its end."""
        if job.kind is not READ_SHADE or not isinstance(ended, JobDone):
            return
        recorded, asked = self._methods(job.input)
        self.images += 1
        recorded.take(ended.result)
        asked.take(self._read(job.input))
        self._compare(recorded.newest, asked.newest)

    def _methods(self, work: ReadShade) -> tuple[MethodPair, MethodPair]:
        if self.recorded is None or self.asked is None:
            detection, forecast = work.detection_settings.method, work.forecast_settings.method
            self.recorded = MethodPair(detection, forecast)
            self.asked = MethodPair(self._asked[0] or detection, self._asked[1] or forecast)
            if self.truth is not None:
                self.recorded.compare_with(self.truth)
                self.asked.compare_with(self.truth)
        return self.recorded, self.asked

    def _read(self, work: ReadShade) -> ShadeRead:
        """Read an image as the recorded job did, by the methods asked for.

        A method that was recorded begins with what the flight knew, in a file that begins in
        flight; another one begins with nothing.
        """
        assert self.asked is not None
        assert self.recorded is not None
        serial, detection, forecast = work.image.serial, work.detection, work.forecast
        if self.asked.detection != self.recorded.detection:
            detection = DetectionState(references=work.detection.references)
        if self.asked.forecast != self.recorded.forecast:
            forecast = ForecastState()
        mine = replace(
            work,
            detection=self._detections.get(serial, detection),
            detection_settings=replace(work.detection_settings, method=self.asked.detection),
            forecast_settings=replace(work.forecast_settings, method=self.asked.forecast),
            forecast=self._forecast or forecast,
            others=tuple(each for other, each in self._own.items() if other != serial),
            velocity_mps=self._velocity_mps,
        )
        read = read_shade(mine)
        self._detections[serial], self._forecast = read.detection, read.forecast
        if isinstance(read.own, SeenShade):
            self._own[serial] = read.own
        if read.merged is not None:
            _, sun = read.merged
            self._velocity_mps = None if sun is None else sun.velocity_mps
        return read

    def _compare(self, recorded: ShadeMap | None, asked: ShadeMap | None) -> None:
        if recorded is None or asked is None or recorded.captured_at_ns != asked.captured_at_ns:
            return
        both = recorded.valid & asked.valid
        was, is_now = ~recorded.is_sunlit, ~asked.is_sunlit
        self.agreement += overlap(is_now, was, both)
        self.same_cells += int((both & (was == is_now)).sum())
        self.known_cells += int(both.sum())

    def report(self) -> str:
        """Return the tables of both pairs of methods; raises `ReconError` without an image."""
        if self.recorded is None or self.asked is None:
            raise ReconError("expected a flight with frames of an imaging drone, got none")
        parts = []
        for title, methods in ((RECORDED, self.recorded), (ASKED, self.asked)):
            parts.append(
                f"{title}: {methods.names}; {self.images} ground images, {methods.maps} shade maps,"
                f" {methods.rejected} images rejected"
            )
            parts += self._tables(methods)
        parts.append(self._agreement())
        return "\n\n".join(parts)

    def _tables(self, methods: MethodPair) -> list[str]:
        if self.truth is not None:
            runs = [methods.score]
            return [shade_table(runs), *forecast_tables(runs, methods.forecast, None)]
        found = leads_table(methods.verified(), (methods.forecast,))
        if found is None:
            shortest_s = SCORE.lead_s[0]
            return [f"forecasts are not compared: maps over more than {shortest_s:g} s are needed"]
        return ["truth is the method's own map of the lead's time", found]

    def _agreement(self) -> str:
        iou, known = self.agreement.iou, self.known_cells
        rows = [
            ("shade IoU", NOTHING if iou is None else fine(iou)),
            ("cells called the same, %", percent(self.same_cells / known) if known else NOTHING),
        ]
        return table(("maps of both", "figure"), rows)


def _require(name: str | None, known: Sequence[str], what: str) -> None:
    if name is not None and name not in known:
        raise ReconError(f"{what}: expected {', '.join(known)}, got {name!a:.40}")
