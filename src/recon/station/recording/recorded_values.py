"""How the station's values are recorded: the codec's special cases, and a file's start.

Pixels are in the topics of images; an event names its frame by number. The result of a job does
not enter the file: jobs are pure, so a replay runs them again; a digest of its input is at
its end. Orders are outputs: they are compared, and read for that only.
"""

import platform
import sys
from collections.abc import Iterable
from contextlib import suppress
from dataclasses import dataclass, field, fields, replace
from functools import cache
from ipaddress import IPv4Network, IPv6Network, ip_network
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
import shapely  # type: ignore[import-untyped, unused-ignore]

from recon import version
from recon.detection.cells import CellLight, CellSamples
from recon.detection.sunlit.colour import CellColour
from recon.fleet.step import CloseLink
from recon.guidance.survey.region_paths import RegionPaths
from recon.model.airspace import Airspace, Zone
from recon.model.command import Command
from recon.model.event import JobEnded
from recon.model.report import ImageReport
from recon.model.vehicle import VehicleProfile
from recon.record.audit.audit import AuditEntry
from recon.record.mcap.codec import Codec, CodecError, Custom
from recon.safety import ApprovedCommand, PreparedAirspace
from recon.safety.airspace import prepared_zone
from recon.site import Site
from recon.site.terrain_source import TerrainSource
from recon.station.audit.entries import Auditing
from recon.station.state.station import Station
from recon.station.state.steps import (
    Job,
    JobDone,
    JobDropped,
    JobFailed,
    Output,
    SendCommand,
    WithdrawMotion,
)
from recon.station.state.survey_record import SurveyRecord
from recon.station.state.vehicle_control import VehicleSnapshot

DONE, FAILED, DROPPED = "done", "failed", "dropped"


@dataclass(frozen=True, slots=True, eq=False)
class FlightStart:
    """What a record begins with: the site, the station, and what its audit remembers."""

    version: str
    python: str
    numpy: str
    machine: str
    """System and processor: libraries choose their instructions, and so last bits, by it."""
    started_at_ns: int
    site: Site
    station: Station
    auditing: Auditing = field(default_factory=Auditing)
    scenario: str = ""
    """The simulated world, as `score/truth.py` states it; empty for real aircraft."""
    running_jobs: int = 0
    """Jobs started before this record: it lacks their results, so a replay ends at the first."""

    @classmethod
    def now(
        cls,
        site: Site,
        station: Station,
        started_at_ns: int,
        auditing: Auditing | None = None,
        scenario: str = "",
        running_jobs: int = 0,
    ) -> "FlightStart":
        """Return the start of a record by this version on this computer."""
        return cls(
            version(),
            sys.version.split()[0],
            np.__version__,
            this_machine(),
            started_at_ns,
            site,
            station,
            Auditing() if auditing is None else auditing,
            scenario,
            running_jobs,
        )


@cache
def this_machine() -> str:
    """Return this computer's system and processor: its name and what it calculates with."""
    named = {"model name": platform.processor() or platform.machine()}
    with suppress(OSError):
        lines = Path("/proc/cpuinfo").read_text().splitlines()
        facts = (line.partition(":")[::2] for line in reversed(lines))
        named |= {name.strip(): value.strip() for name, value in facts}
    # Processors of one name have different instructions.
    details = [f"{name} {named[name]}" for name in ("cpu family", "model") if name in named]
    vectors: Any = np.show_config(mode="dicts")
    found = vectors["SIMD Extensions"]["found"][-1:]
    parts = (f"{platform.system()} {platform.machine()}", named["model name"], *details, *found)
    return ", ".join(parts)


@dataclass(frozen=True, slots=True)
class EndOfJob:
    """How a recorded job ended; what it returned is worked out again."""

    kind: str
    job_id: int
    how: str
    error: str = ""
    input: str = ""
    """The digest of what it depended on; empty for one that was dropped."""


@dataclass(frozen=True, slots=True, eq=False)
class FrameReport:
    """An image report as it is in the record: its pixels are in the frame of that number; 0:
    they were not recorded."""

    target_fps_hz: float | None
    frame: int


def values_codec() -> Codec:
    """Return the codec of a record."""

    def image(report: ImageReport) -> dict[str, Any]:
        # The writer puts the frame's number in: it finds the frame in the bytes of the link.
        return {"target_fps_hz": report.target_fps_hz, "frame": 0}

    customs: dict[type[Any], Custom] = {
        ImageReport: Custom(image, _frame_report),
        JobEnded: Custom(_end_of_job, _read_end_of_job),
        PreparedAirspace: Custom(
            lambda air: codec.to_builtins(_airspace_parts(air), _AirspaceParts),
            lambda value: _airspace(codec.from_builtins(value, _AirspaceParts)),
        ),
        VehicleSnapshot: Custom(
            msgspec.to_builtins, lambda value: msgspec.convert(value, VehicleSnapshot)
        ),
        TerrainSource: Custom(
            msgspec.to_builtins, lambda value: msgspec.convert(value, TerrainSource)
        ),
        RegionPaths: Custom(lambda ways: shapely.to_wkb(ways.area), _region_paths),
        CellSamples: Custom(
            lambda cells: codec.to_builtins(cells, CellLight | CellColour),
            lambda value: codec.from_builtins(value, CellLight | CellColour),
        ),
        **{kind: Custom(str, ip_network) for kind in (IPv4Network, IPv6Network)},
    }
    codec = Codec(customs)
    return codec


@dataclass(frozen=True, slots=True, eq=False)
class _AirspaceParts:
    site: Airspace
    temporary: tuple[Zone, ...]


def _airspace_parts(air: PreparedAirspace) -> _AirspaceParts:
    temporary = tuple(each.zone for each in air.temporary_zones)
    zones = air.airspace.zones
    own = zones[: len(zones) - len(temporary)]
    return _AirspaceParts(replace(air.airspace, zones=own), temporary)


def _airspace(parts: _AirspaceParts) -> PreparedAirspace:
    air = PreparedAirspace(parts.site)
    if not parts.temporary:
        return air
    return air.with_temporary_zones(prepared_zone(zone) for zone in parts.temporary)


def _region_paths(value: Any) -> RegionPaths:
    if not isinstance(value, bytes):
        raise CodecError(f"expected an area as WKB, got {type(value).__name__}")
    try:
        area = shapely.from_wkb(value)
    except shapely.errors.ShapelyError as problem:
        raise CodecError(f"expected an area as WKB, got: {problem}") from problem
    if not isinstance(area, shapely.Polygon | shapely.MultiPolygon) or not area.is_valid:
        raise CodecError(f"expected a valid area, got a {area.geom_type}")
    return RegionPaths(area)


def _frame_report(value: Any) -> FrameReport:
    frame, fps_hz = value.get("frame"), value.get("target_fps_hz")
    if type(frame) is not int or type(fps_hz) not in (float, int, type(None)):
        raise CodecError(f"expected the number of a frame, got {value!a:.80}")
    return FrameReport(fps_hz, frame)


def _end_of_job(event: Any) -> dict[str, Any]:
    ways = {JobDone: DONE, JobFailed: FAILED, JobDropped: DROPPED}
    error = event.error if isinstance(event, JobFailed) else ""
    return {
        "kind": event.kind.name,
        "job_id": event.job_id,
        "how": ways[type(event)],
        "error": error,
        "input": event.input_digest,
    }


_END_CODEC = Codec()


def _read_end_of_job(value: Any) -> EndOfJob:
    end: EndOfJob = _END_CODEC.from_builtins(value, EndOfJob)
    return end


@dataclass(frozen=True, slots=True, eq=False)
class _Sent:
    """An order as an output."""

    command: Command
    link_ids: tuple[int, ...]
    profile: VehicleProfile | None
    altitude_offset_m: float | None
    approved_at_ns: int


def output_builtins(codec: Codec, output: Output) -> dict[str, Any]:
    """Return an output of a step as maps and lists, with the name of its kind."""
    match output:
        case SendCommand(approved):
            return {"send": codec.to_builtins(_sent(approved), _Sent)}
        case Job():
            return {"job": {"kind": output.kind.name, "id": output.id}}
        case CloseLink():
            return {"close_link": codec.to_builtins(output, CloseLink)}
        case WithdrawMotion():
            return {"withdraw_motion": codec.to_builtins(output, WithdrawMotion)}


_OUTPUTS = {"send": _Sent, "close_link": CloseLink, "withdraw_motion": WithdrawMotion}


def output_with_defaults(codec: Codec, recorded: Any) -> Any:
    """Return a recorded output as this version records it: with the fields that it lacks.

    Raises `RecordError` for a damaged one.
    """
    if not isinstance(recorded, dict):
        return recorded
    return {
        name: codec.to_builtins(codec.from_builtins(value, hint), hint)
        if (hint := _OUTPUTS.get(name)) is not None
        else value
        for name, value in recorded.items()
    }


def _sent(approved: ApprovedCommand) -> _Sent:
    return _Sent(
        approved.command,
        approved.link_ids,
        approved.profile,
        approved.altitude_offset_m,
        approved.approved_at_ns,
    )


def survey_facts(record: SurveyRecord) -> dict[str, Any]:
    """Return a survey that was requested before the file, for readers of any version.

    `flown_by` are the vehicles that fly for it as the file begins; none while it does not run.
    """
    survey, state = record.survey, record.state
    return {
        **{each.name: getattr(survey, each.name) for each in fields(survey)},
        "region": {
            "outline_m": survey.region.outline_m.tolist(),
            "holes_m": [hole.tolist() for hole in survey.region.holes_m],
        },
        "flown_by": state.serials if state is not None and record.is_running else (),
    }


def audit_builtins(entries: Iterable[AuditEntry]) -> list[dict[str, Any]]:
    """Return audit entries as maps and lists."""
    return [
        {
            "kind": each.kind,
            "text": each.text,
            "by": each.by,
            "serial": each.serial,
            "vehicle": each.vehicle,
            "details": msgspec.to_builtins(each.details),
        }
        for each in entries
    ]
