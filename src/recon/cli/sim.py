"""`recon sim`: simulated companion apps."""

import asyncio
import sys
from pathlib import Path
from typing import NamedTuple

import typer

from recon.cli.places import parse_place
from recon.cli.sim_options import (
    AirborneOption,
    AltitudeBiasMOption,
    AltitudeReferenceOption,
    EnduranceMinOption,
    FaultOption,
    FaultsOption,
    FeedOption,
    FpsOption,
    FrameSizeOption,
    FramesOption,
    HomeOption,
    HoverOnGroundOption,
    ImageFormatOption,
    ImagerOption,
    LatencySOption,
    MissionIdsOption,
    ReplaySiteOption,
    SeedOption,
    SiteOption,
    StationOption,
    VehiclesOption,
    WanderOption,
    WaypointAltitude,
    WindMpsOption,
    WindToDegOption,
)
from recon.cli.until_stopped import say_at_once, until_stopped
from recon.model.errors import ReconError
from recon.model.geo import GeoPoint, LatLon
from recon.model.vehicle import AltitudeReference
from recon.score.simulation import go_home_heights_of, pads_of, rig_of
from recon.sim.app.camera_feed import FeedSettings, ImageFormat
from recon.sim.app.commands import HoverOnGround
from recon.sim.app.fault_file import FaultScript, load_faults
from recon.sim.app.faults import parse_fault
from recon.sim.app.telemetry import FIELD_SENSORS
from recon.sim.camera import CameraSettings
from recon.sim.camera.field import FieldRenderer
from recon.sim.camera.frames import FrameSource, folder_frames
from recon.sim.camera.replay import load_replay
from recon.sim.camera.rig import CameraRig
from recon.sim.errors import SimulationError
from recon.sim.fleet import Airborne, ImagerSetup, SimulationConfig
from recon.sim.run import run_fleet
from recon.sim.world import LayerSettings, Sky, SkySettings, SunSettings, WindSettings
from recon.site import Imager, Site, SiteError, demo_site_folder, load_site

LONGEST_LATENCY_S = 60.0


class ImagerWorld(NamedTuple):
    """Where the eye hangs (None: above home) and what it sees."""

    rig: CameraRig | None
    source: FrameSource


def sim_command(
    context: typer.Context,
    vehicles: VehiclesOption = 4,
    station: StationOption = "127.0.0.1:3001",
    altitude_reference: AltitudeReferenceOption = WaypointAltitude.TAKEOFF,
    hover_on_ground: HoverOnGroundOption = HoverOnGround.NOTHING,
    imager: ImagerOption = True,
    airborne: AirborneOption = None,
    wander: WanderOption = False,
    home: HomeOption = None,
    site: SiteOption = None,
    replay_site: ReplaySiteOption = None,
    frames: FramesOption = None,
    frame_size: FrameSizeOption = "1280x720",
    fps: FpsOption = 1.0,
    image_format: ImageFormatOption = ImageFormat.RAW,
    latency_s: LatencySOption = None,
    feed: FeedOption = True,
    altitude_bias_m: AltitudeBiasMOption = None,
    endurance_min: EnduranceMinOption = 25.0,
    fault: FaultOption = None,
    faults: FaultsOption = None,
    wind_mps: WindMpsOption = 0.0,
    wind_to_deg: WindToDegOption = 50.0,
    mission_ids: MissionIdsOption = True,
    seed: SeedOption = 0,
) -> None:
    """Run simulated companion apps that connect to a station, until Ctrl+C."""
    if context.invoked_subcommand is not None:
        return
    try:
        host, port = parse_station(station)
        _refuse_bad_numbers(fps, endurance_min, latency_s)
        script = FaultScript() if faults is None else load_faults(faults)
        place = _place(site)
        feed_settings = FeedSettings(fps, image_format, latency_s, feed)
        if not imager and (frames is not None or replay_site is not None):
            raise SimulationError("--no-eye: expected neither --frames nor --replay-site, got one")
        world = _imager_world(place, replay_site, frames, frame_size, seed) if imager else None
        config = SimulationConfig(
            home=_home(home, place, world),
            station_host=host,
            station_port=port,
            vehicle_count=vehicles,
            imager=None if world is None else ImagerSetup(world.source, feed_settings, world.rig),
            altitude_reference=AltitudeReference(altitude_reference.value),
            hover_on_ground=hover_on_ground,
            airborne=_AIRBORNE[airborne],
            wanders=wander,
            altitude_bias_m=altitude_bias_m,
            endurance_s=60.0 * endurance_min,
            seed=seed,
            sensors=FIELD_SENSORS,
            wind=_wind(wind_mps, wind_to_deg, seed),
            reports_mission_id=mission_ids,
            faults=(*(parse_fault(text) for text in fault or ()), *script.faults),
            chances=script.chances,
            pads=pads_of(place) if home is None and replay_site is None else {},
            go_home_heights_m=go_home_heights_of(place),
        )
        asyncio.run(until_stopped(run_fleet(config, say_at_once), "simulation ended"))
    except ReconError as problem:
        print(f"recon sim: {problem}", file=sys.stderr)
        raise typer.Exit(2) from None


_AIRBORNE = {None: Airborne.IMAGER, True: Airborne.ALL, False: Airborne.NONE}


def parse_station(text: str) -> tuple[str, int]:
    """Return host and port of `HOST:PORT` ([..] around an IPv6 address); `SimulationError`."""
    return parse_place("--station", text)


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
    """Return columns and rows of `COLSxROWS`, as large as the wire allows; `SimulationError`."""
    cols, _, rows = text.partition("x")
    is_number = cols.isascii() and cols.isdigit() and rows.isascii() and rows.isdigit()
    if not (is_number and 0 < int(cols) <= 3840 and 0 < int(rows) <= 2160):
        raise SimulationError(
            f"--frame-size: expected COLSxROWS up to 3840x2160, like 1280x720, got {text!r}"
        )
    return int(cols), int(rows)


def _refuse_bad_numbers(fps: float, endurance_min: float, latency_s: float | None) -> None:
    _refuse_non_positive("--fps", fps)
    _refuse_non_positive("--endurance-min", endurance_min)
    if latency_s is not None and not 0.0 <= latency_s <= LONGEST_LATENCY_S:
        raise SimulationError(
            f"--latency-s: expected 0 to {LONGEST_LATENCY_S:g} seconds, got {latency_s:g}"
        )


def _refuse_non_positive(option: str, value: float) -> None:
    if not 0.0 < value < 1e6:
        raise SimulationError(f"{option}: expected a positive number, got {value:g}")


def _wind(speed_mps: float, heading_deg: float, seed: int) -> WindSettings | None:
    if speed_mps == 0.0:
        return None
    return WindSettings(seed=abs(seed), speed_10m_mps=speed_mps, heading_deg=heading_deg)


def _place(folder: Path | None) -> Site:
    place = load_site(demo_site_folder() if folder is None else folder)
    if place.frame is None:
        raise SiteError(f"{folder}: expected a site with an origin, got none")
    return place


def _home(text: str | None, place: Site, world: ImagerWorld | None) -> GeoPoint:
    frame = place.frame if world is None or world.rig is None else world.rig.frame
    assert frame is not None
    if text is None:
        return frame.origin
    return GeoPoint(*parse_home(text), frame.origin.ellipsoid_height_m)


def _imager_world(
    place: Site, replay: Path | None, frames: Path | None, frame_size: str, seed: int
) -> ImagerWorld:
    """Return where the eye hangs and what it sees: a real field, a folder, or made-up land."""
    if replay is not None and frames is not None:
        raise SimulationError("expected --replay-site or --frames, got both")
    if replay is not None:
        return ImagerWorld(*load_replay(replay))
    cols, rows = parse_size(frame_size)
    rig = None if place.imager is None else _rig(place, place.imager)
    if frames is not None:
        return ImagerWorld(rig, folder_frames(frames, rows, cols))
    if rig is None or place.imager is None:
        raise SimulationError(
            "expected a site with an [imager], or --frames, or --no-eye, got none"
        )
    sky, imager = _sky(rig.frame.origin, seed), CameraSettings(seed)
    land = FieldRenderer(rig.camera, place.imager.image_circle, seed, sky, imager)
    return ImagerWorld(rig, land)


def _sky(origin: GeoPoint, seed: int) -> Sky:
    """Return fair weather over a place: many small clouds, so that shadows come and go."""
    sun = SunSettings(LatLon(origin.latitude_deg, origin.longitude_deg))
    clouds = LayerSettings(cover=0.35, outer_scale_m=2_500.0, softness=0.15)
    return Sky(SkySettings(seed, sun, (clouds,)))


def _rig(place: Site, imager: Imager) -> CameraRig:
    assert place.frame is not None
    return rig_of(place.frame, imager)
