"""What else a record states of a flight: software, settings, decisions, alarms, batteries, and how
good the forecasts were.

A second pass over the file, for `recon report`: forecasts are large, and each is compared with the
shade maps of the times it was made for as it is read.
"""

import json
import math
from bisect import bisect_left
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
import numpy.typing as npt
from foxglove_schemas_protobuf.Grid_pb2 import Grid
from google.protobuf.message import DecodeError

from recon.model.errors import RecordError
from recon.model.geo import GroundGrid
from recon.model.units import NS_PER_S
from recon.product.flight import UNKNOWN, FlightData, KeptMap
from recon.product.shadow_record import SUNLIT
from recon.record.mcap.foxglove import SUN_TOPIC
from recon.record.mcap.mcap_file import ABOUT_NAME, STEPS_TOPIC
from recon.record.mcap.mcap_read import McapReading, Opener, RecordAttachment, RecordMessage, opened

LEAD_PREFIX = "sun_in_"
MOST_LINES = 100_000
MOST_TEXT = 2_000
"""Characters of one text: a reason is a sentence."""
BATTERY_EVERY_NS = 2 * NS_PER_S
ROUTINE = frozenset({"vehicle.position"})
"""Written every five seconds; tracks show it better."""
LEADS_S = (15.0, 30.0, 60.0, 120.0, 180.0, 300.0)
NEAR_S = 3.0
"""A shade map this near to a forecast's time is what came."""
LONGEST_S = 3_600.0


@dataclass(frozen=True, slots=True)
class LogLine:
    """An entry of the audit."""

    at_ns: int
    kind: str
    text: str
    by: str
    vehicle: str
    alarm_id: int | None = None
    severity: str = ""


@dataclass(slots=True)
class LeadFigures:
    """Sums of squared errors over cells, of one lead time: forecast, and the sky as it was."""

    cells: int = 0
    squares: float = 0.0
    persistence_squares: float = 0.0

    @property
    def brier(self) -> float:
        """Mean squared error of the probability: 0 is perfect."""
        return self.squares / max(1, self.cells)

    @property
    def persistence_brier(self) -> float:
        """The same of the assumption that nothing changes."""
        return self.persistence_squares / max(1, self.cells)

    @property
    def skill(self) -> float | None:
        """1 perfect, 0 no better than that nothing changes; None where that was never wrong."""
        return 1.0 - self.brier / self.persistence_brier if self.persistence_brier > 0.0 else None


@dataclass(slots=True)
class FlightLog:
    """What a record states besides tracks and maps."""

    about: Mapping[str, Any] = field(default_factory=dict)
    lines: list[LogLine] = field(default_factory=list)
    batteries: dict[str, list[tuple[int, float]]] = field(default_factory=dict)
    """Time and the battery's fraction, by serial."""
    leads: dict[float, LeadFigures] = field(default_factory=dict)
    """Figures by lead in seconds; leads without a map of their time are absent."""

    def settings(self) -> dict[str, str]:
        """Return the settings by dotted name."""
        settings = self.about.get("settings", {})
        return dict(_flat(settings, "", 0)) if isinstance(settings, dict) else {}


def read_log(path: Path, flight: FlightData, open_record: Opener = opened) -> FlightLog:
    """Return the log of a flight's record; raises `RecordError` for a damaged one, and OSError."""
    reader = LogReader(path, flight)
    with open_record(path) as file:
        for item in McapReading(file).items():
            reader.take(item)
    reader.log.lines.sort(key=lambda line: line.at_ns)
    return reader.log


class _LoggedEntry(msgspec.Struct, frozen=True):
    kind: str
    text: str
    by: str = ""
    vehicle: str = ""
    details: dict[str, Any] | None = None


class _LoggedStep(msgspec.Struct, frozen=True):
    event: dict[str, Any]
    audit: list[_LoggedEntry] = []


@dataclass(slots=True)
class LogReader:
    """Collects the log of a file's items."""

    path: Path
    flight: FlightData
    log: FlightLog = field(default_factory=FlightLog)
    _serials: dict[int, str] = field(default_factory=dict)
    _times: list[int] = field(init=False)
    _decoder: msgspec.msgpack.Decoder[_LoggedStep] = field(
        default_factory=lambda: msgspec.msgpack.Decoder(_LoggedStep)
    )

    def __post_init__(self) -> None:
        self._times = [each.at_ns for each in self.flight.maps]

    def take(self, item: RecordMessage | RecordAttachment) -> None:
        """Take the next item; raises `RecordError` for one that is damaged."""
        try:
            if isinstance(item, RecordAttachment):
                if item.name == ABOUT_NAME:
                    self.log.about = json.loads(item.data)
            elif item.topic == STEPS_TOPIC:
                self._step(self._decoder.decode(item.data), item.log_ns)
            elif item.topic == SUN_TOPIC:
                self._forecast(Grid.FromString(item.data))
        except (msgspec.MsgspecError, DecodeError, ValueError, TypeError, KeyError) as problem:
            raise RecordError(f"{self.path}: the log is damaged: {problem}") from problem

    def _step(self, step: _LoggedStep, at_ns: int) -> None:
        for entry in step.audit:
            if entry.kind in ROUTINE or len(self.log.lines) >= MOST_LINES:
                continue
            details = entry.details or {}
            number = details.get("id") if entry.kind.startswith("alarm.") else None
            self.log.lines.append(
                LogLine(
                    at_ns,
                    entry.kind,
                    entry.text[:MOST_TEXT],
                    entry.by[:MOST_TEXT],
                    entry.vehicle[:MOST_TEXT],
                    number if isinstance(number, int) else None,
                    str(details.get("severity", "")),
                )
            )
        report = step.event.get("report")
        if isinstance(report, dict) and report.get("_") == "ExtendedReport":
            self._battery(report, int(step.event["link_id"]), at_ns)

    def _battery(self, report: Mapping[str, Any], link: int, at_ns: int) -> None:
        if report["serial"]:
            self._serials[link] = str(report["serial"])
        fraction, serial = report["battery_fraction"], self._serials.get(link)
        if fraction is None or serial is None:
            return
        points = self.log.batteries.setdefault(serial, [])
        if not points or at_ns - points[-1][0] >= BATTERY_EVERY_NS:
            points.append((at_ns, min(1.0, max(0.0, float(fraction)))))

    def _forecast(self, message: Grid) -> None:
        flight, issued_ns = self.flight, message.timestamp.ToNanoseconds()
        if flight.grid is None or not is_on(message, flight.grid):
            return
        by_lead = forecast_leads(message, flight.grid)
        now = self._map_near(issued_ns)
        if now is None:
            return
        for lead_s in LEADS_S:
            later = self._map_near(issued_ns + round(lead_s * NS_PER_S))
            if later is None or not min(by_lead) <= lead_s <= max(by_lead):
                continue
            is_known = (later.sun != UNKNOWN) & (now.sun != UNKNOWN)
            is_lit = (later.sun[is_known] >= SUNLIT).astype(np.float64)
            was_lit = (now.sun[is_known] >= SUNLIT).astype(np.float64)
            figures = self.log.leads.setdefault(lead_s, LeadFigures())
            figures.cells += len(is_lit)
            figures.squares += float(((_between(by_lead, lead_s)[is_known] - is_lit) ** 2).sum())
            figures.persistence_squares += float(((was_lit - is_lit) ** 2).sum())

    def _map_near(self, at_ns: int) -> KeptMap | None:
        after = bisect_left(self._times, at_ns)
        around = self.flight.maps[max(0, after - 1) : after + 1]
        nearest = min(around, key=lambda each: abs(each.at_ns - at_ns), default=None)
        if nearest is None or abs(nearest.at_ns - at_ns) > NEAR_S * NS_PER_S:
            return None
        return nearest


def is_on(message: Grid, grid: GroundGrid) -> bool:
    """Return whether a forecast is on the cells of the shade maps; others are not read."""
    south_m = grid.north_m - grid.rows * grid.cell_m
    place = message.pose.position
    return (
        message.column_count == grid.cols
        and 0 < len(message.fields) <= message.cell_stride
        and len(message.data) == grid.rows * grid.cols * message.cell_stride
        and math.isclose(message.cell_size.x, grid.cell_m)
        and math.isclose(place.x, grid.west_m, abs_tol=0.01)
        and math.isclose(place.y, south_m, abs_tol=0.01)
    )


def forecast_leads(message: Grid, grid: GroundGrid) -> dict[float, npt.NDArray[np.uint8]]:
    """Return the probability of sun in 255ths (R, C), row 0 north, by lead in seconds.

    Raises `ValueError` for a message without leads, or with one that is not in its cells.
    """
    values = np.frombuffer(message.data, np.uint8).reshape(grid.rows, grid.cols, -1)[::-1]
    found = {}
    for each in message.fields:
        if not each.name.startswith(LEAD_PREFIX):
            continue  # the horizon
        lead_s = float(each.name.removeprefix(LEAD_PREFIX).removesuffix("_s"))
        if not 0.0 <= lead_s <= LONGEST_S or each.offset >= message.cell_stride:
            raise ValueError(f"a forecast {lead_s:g} s ahead at byte {each.offset} of a cell")
        found[lead_s] = values[..., each.offset]
    if not found:
        raise ValueError("a forecast without leads")
    return found


def _between(
    by_lead: Mapping[float, npt.NDArray[np.uint8]], lead_s: float
) -> npt.NDArray[np.float64]:
    """Return the probability at a lead, between the two nearest."""
    before = max(each for each in by_lead if each <= lead_s)
    after = min(each for each in by_lead if each >= lead_s)
    share = (lead_s - before) / (after - before) if after > before else 0.0
    mixed: npt.NDArray[np.float64] = by_lead[before] * (1.0 - share) + by_lead[after] * share
    return mixed / 255.0


MOST_DEPTH = 12


def _flat(values: Mapping[str, Any], above: str, depth: int) -> Sequence[tuple[str, str]]:
    found: list[tuple[str, str]] = []
    for name, value in values.items():
        dotted = f"{above}{name}"
        if isinstance(value, dict) and value and depth < MOST_DEPTH:
            found += _flat(value, f"{dotted}.", depth + 1)
        else:
            found.append((dotted, _plain(value)))
    return found


def _plain(value: Any) -> str:
    if isinstance(value, float):
        return f"{value:g}"
    return (
        json.dumps(value) if isinstance(value, (list, dict, bool)) or value is None else str(value)
    )
