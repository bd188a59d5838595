"""A recorded flight as the product needs it: tracks, shade maps, surveys, place and time.

`flight_reader` reads it from a record.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path

import numpy as np
import numpy.typing as npt

from recon.geo import geo_from_enu
from recon.model.airspace import Region
from recon.model.arrays import FloatArray, IntArray
from recon.model.geo import GroundGrid, LocalFrame
from recon.model.light import LightReading
from recon.model.survey import Survey, SurveyCamera
from recon.product.reported_shots import ReportedShots
from recon.record.mcap.tracks import utc_text

ByteMap = npt.NDArray[np.uint8]

UNKNOWN = 255
"""Value of unknown cells in a `KeptMap`; 0 to 250 are transmittances of 0 to 1."""
FULL = 250

MOST_CELLS = 16_000_000


@dataclass(frozen=True, slots=True, eq=False)
class RecordedTrack:
    """Where one vehicle was, by its telemetry; all arrays are (N,), times rise strictly.

    Heights are above takeoff, headings of the aircraft's front clockwise from north; NaN where
    its app reported none.
    """

    serial: str
    at_ns: IntArray
    east_m: FloatArray
    north_m: FloatArray
    height_m: FloatArray
    yaw_deg: FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class KeptMap:
    """A shade map in a quarter of the memory; arrays are (R, C), row 0 is north."""

    at_ns: int
    """Time of the capture."""
    sun: ByteMap
    """Transmittance in 250ths; `UNKNOWN` where nothing is known."""
    confidence: ByteMap
    """Confidence in 255ths."""


@dataclass(frozen=True, slots=True)
class FlownSurvey:
    """A survey as it was requested and started; rings in east-north metres."""

    outline_m: tuple[tuple[float, float], ...]
    holes_m: tuple[tuple[tuple[float, float], ...], ...]
    height_above_takeoff_m: float | None
    """None: it was above ground."""
    speed_mps: float
    name: str = ""
    camera: SurveyCamera = field(default_factory=SurveyCamera)
    side_overlap: float = 0.6
    row_bearing_deg: float | None = None
    starts: tuple[tuple[int, frozenset[str]], ...] = ()
    """Each start in this record, in order: its time, and the serials it names."""
    height_above_ground_m: float | None = None

    def request(self) -> Survey:
        """Return it as guidance plans it."""
        return Survey(
            0,
            self.name,
            Region(np.array(self.outline_m), tuple(np.array(hole) for hole in self.holes_m)),
            self.height_above_takeoff_m,
            self.speed_mps,
            self.camera,
            side_overlap=self.side_overlap,
            row_bearing_deg=self.row_bearing_deg,
            height_above_ground_m=self.height_above_ground_m,
        )


@dataclass(frozen=True, slots=True, eq=False)
class FlightData:
    """One recorded flight. Times are station time; `utc_ahead_ns` added to it gives UTC."""

    path: Path
    frame: LocalFrame
    tracks: Mapping[str, RecordedTrack]
    names: Mapping[str, str] = field(default_factory=dict)
    """Names of vehicles by serial."""
    imagers: frozenset[str] = frozenset()
    grid: GroundGrid | None = None
    """Grid of all maps; None without any."""
    maps: Sequence[KeptMap] = ()
    """Maps in the order of time."""
    surveys: Sequence[FlownSurvey] = ()
    """Surveys that were started, or were running when the record began."""
    utc_ahead_ns: int = 0
    trouble: str = ""
    """Why reading ended early; empty if it did not."""
    scenario: str = ""
    """What the record states of its simulated world; empty for a flight of real aircraft."""
    reported: Sequence[ReportedShots] = ()
    """Photos that apps have reported one by one, by vehicle and series."""
    light: Sequence[LightReading] = ()
    """Readings of light sensors on the ground, as their loggers sent them."""

    def utc(self, at_ns: int) -> str:
        """Return a station time as ISO 8601 in UTC."""
        return utc_text(at_ns + self.utc_ahead_ns)

    def lon_lat(self, points_m: FloatArray) -> list[tuple[float, float]]:
        """Return longitude and latitude of points (N, 2), east and north."""
        level = np.column_stack([points_m, np.zeros(len(points_m))])
        latitude_deg, longitude_deg, _height = geo_from_enu(self.frame, level)
        return list(zip(longitude_deg.tolist(), latitude_deg.tolist(), strict=True))

    @property
    def span_ns(self) -> tuple[int, int]:
        """The first and the last time of any track."""
        tracks = self.tracks.values()
        return min(int(t.at_ns[0]) for t in tracks), max(int(t.at_ns[-1]) for t in tracks)

    def parts_by_survey(self, track: RecordedTrack) -> list[tuple[FlownSurvey, slice]]:
        """Return the parts of a track, each with the survey its vehicle was last started for."""
        starts = sorted(
            (start_ns, number)
            for number, each in enumerate(self.surveys)
            for start_ns, serials in each.starts
            if track.serial in serials
        )
        cuts = np.searchsorted(track.at_ns, [start_ns for start_ns, _number in starts]).tolist()
        return [
            (self.surveys[number], slice(cut, end))
            for (_start_ns, number), (cut, end) in zip(
                starts, pairwise([*cuts, len(track.at_ns)]), strict=True
            )
        ]

    def survey_at(self, track: RecordedTrack, at_ns: int) -> FlownSurvey | None:
        """Return the survey that a track's vehicle was last started for by then."""
        before = [
            (start_ns, number)
            for number, each in enumerate(self.surveys)
            for start_ns, serials in each.starts
            if track.serial in serials and start_ns <= at_ns
        ]
        return self.surveys[max(before)[1]] if before else None

    @property
    def survey_tracks(self) -> dict[str, RecordedTrack]:
        """The tracks of all vehicles but the imaging drones."""
        return {s: track for s, track in self.tracks.items() if s not in self.imagers}
