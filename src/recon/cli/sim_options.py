"""The options of `recon sim`, and the parsing of their values."""

from dataclasses import dataclass
from enum import Enum
from pathlib import Path
from typing import Annotated

import typer

from recon.cli.endpoints import host_and_port
from recon.sim.app.camera_feed import FeedSettings, ImageFormat
from recon.sim.app.commands import HoverOnGround
from recon.sim.app.faults import FaultKind
from recon.sim.errors import SimulationError

MAX_VEHICLES = 256
MAX_LATENCY_S = 60.0
DEFAULT_STATION = "127.0.0.1:3001"


class WaypointAltitude(Enum):
    """Altitude reference of waypoints in the simulated apps."""

    WGS84 = "wgs84"
    TAKEOFF = "takeoff"


@dataclass(frozen=True, slots=True, kw_only=True)
class FleetOptions:
    """The simulated aircraft, their apps and what they fly over."""

    vehicles: Annotated[
        int,
        typer.Option(
            min=1, max=MAX_VEHICLES, help="Number of vehicles, the imaging drone included."
        ),
    ] = 4
    altitude_reference: Annotated[
        WaypointAltitude, typer.Option(help="Altitude reference of waypoints in the apps.")
    ] = WaypointAltitude.TAKEOFF
    hover_on_ground: Annotated[
        HoverOnGround, typer.Option(help="Effect of hover and return on the ground.")
    ] = HoverOnGround.NOTHING
    imager: Annotated[
        bool,
        typer.Option("--imager/--no-imager", help="Whether the first vehicle is an imaging drone."),
    ] = True
    airborne: Annotated[
        bool | None,
        typer.Option(
            "--airborne/--grounded",
            help="All start in the air, or none; default: only the imaging drone.",
        ),
    ] = None
    wander: Annotated[
        bool, typer.Option(help="Survey drones fly back and forth until commanded otherwise.")
    ] = False
    home: Annotated[
        str | None, typer.Option(help="LAT,LON to start from; default: the site's origin.")
    ] = None
    site: Annotated[
        Path | None, typer.Option(help="Folder with a site.toml: origin, imaging drone, pads.")
    ] = None
    replay_site: Annotated[
        Path | None,
        typer.Option(help="Folder with RefFrame.jpeg and GCPs.txt: frames of a real field."),
    ] = None
    frames: Annotated[
        Path | None, typer.Option(help="Folder of images for the imaging drone to send in turn.")
    ] = None
    frame_size: Annotated[str, typer.Option(help="COLSxROWS of frames from a folder.")] = "1280x720"
    latency_s: Annotated[
        float | None,
        typer.Option(help="Seconds from capture to sending; default: random, 0.2 to 1 s."),
    ] = None
    feed: Annotated[
        bool, typer.Option("--feed/--no-feed", help="Whether the image stream is on at the start.")
    ] = True
    altitude_bias_m: Annotated[
        float | None, typer.Option(help="Error of the reported altitude, m; default: random.")
    ] = None
    endurance_min: Annotated[float, typer.Option(help="Hover time of a full battery, minutes.")] = (
        25.0
    )
    imager_endurance_min: Annotated[
        float | None, typer.Option(help="The same of imaging drones; default: as the others'.")
    ] = None
    battery_swap_min: Annotated[
        float | None,
        typer.Option(help="Minutes from landing to a full battery; default: it stays as it is."),
    ] = None
    fault: Annotated[
        list[str] | None,
        typer.Option(
            help="NAME[:vehicle[:start_s[:duration_s]]]; may be repeated. Names: "
            + ", ".join(kind.value for kind in FaultKind)
        ),
    ] = None
    faults: Annotated[
        Path | None, typer.Option(help="TOML file with scripted and random faults.")
    ] = None
    wind_mps: Annotated[
        float, typer.Option(help="Mean wind 10 m above ground, with gusts, m/s; 0: calm.")
    ] = 0.0
    wind_to_deg: Annotated[
        float, typer.Option(help="Direction the wind blows to, degrees clockwise from north.")
    ] = 50.0
    cover: Annotated[
        float, typer.Option(min=0.0, max=100.0, help="Share of the sky with clouds, percent.")
    ] = 40.0
    photo_interval_s: Annotated[
        float | None,
        typer.Option(
            min=0.5,
            max=60.0,
            help="Apps report facts and photos, one every so many seconds of a mission; "
            "default: plain apps.",
        ),
    ] = None
    mission_ids: Annotated[
        bool,
        typer.Option(
            "--mission-ids/--no-mission-ids", help="Whether apps report MissionID, or always 0."
        ),
    ] = True


@dataclass(frozen=True, slots=True, kw_only=True)
class RunningOptions:
    """Where simulated apps connect to, what they send, and the seed of the run."""

    station: Annotated[str, typer.Option(help="HOST:PORT of the station.")] = DEFAULT_STATION
    fps: Annotated[float, typer.Option(help="Frames per second of the imaging drone, at most.")] = (
        1.0
    )
    image_format: Annotated[
        ImageFormat, typer.Option(help="Format of frames: raw (packet 2) or JPEG (packet 5).")
    ] = ImageFormat.RAW
    jpeg_quality: Annotated[int, typer.Option(min=1, max=100, help="Quality of JPEG frames.")] = 85
    seed: Annotated[int, typer.Option(help="The same seed gives the same run.")] = 0

    @property
    def address(self) -> tuple[str, int]:
        """Host and port of the station; raises `SimulationError`."""
        return host_and_port("--station", self.station)

    @property
    def feed(self) -> FeedSettings:
        """The feed of each imaging drone."""
        return FeedSettings(self.fps, self.image_format, jpeg_quality=self.jpeg_quality)


def parse_home(text: str) -> tuple[float, float]:
    """Return latitude and longitude of `LAT,LON` in degrees; raises `SimulationError`."""
    try:
        latitude, longitude = (float(word) for word in text.split(","))
    except ValueError:
        latitude = longitude = 999.0
    if not (abs(latitude) <= 89.0 and abs(longitude) <= 180.0):
        raise SimulationError(f"--home: expected LAT,LON in degrees like 41.9,-93.6, got {text!r}")
    return latitude, longitude


def parse_size(text: str) -> tuple[int, int]:
    """Return columns and rows of `COLSxROWS`, within the protocol's limits; `SimulationError`."""
    cols, _, rows = text.partition("x")
    is_number = cols.isascii() and cols.isdigit() and rows.isascii() and rows.isdigit()
    if not (is_number and 0 < int(cols) <= 3840 and 0 < int(rows) <= 2160):
        raise SimulationError(
            f"--frame-size: expected COLSxROWS up to 3840x2160, like 1280x720, got {text!r}"
        )
    return int(cols), int(rows)


def check_numbers(fps: float, endurance_min: float, latency_s: float | None) -> None:
    """Raise `SimulationError` for a number out of range."""
    for option, value in (("--fps", fps), ("--endurance-min", endurance_min)):
        if not 0.0 < value < 1e6:
            raise SimulationError(f"{option}: expected a positive number, got {value:g}")
    if latency_s is not None and not 0.0 <= latency_s <= MAX_LATENCY_S:
        raise SimulationError(
            f"--latency-s: expected 0 to {MAX_LATENCY_S:g} seconds, got {latency_s:g}"
        )
