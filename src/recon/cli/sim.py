"""`recon sim`: simulated companion apps; `recon sim scenario`: those of a scenario."""

import asyncio
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Annotated, NamedTuple

import typer

from recon.cli.commands import App
from recon.cli.foreground import print_now, until_stopped
from recon.cli.options import with_options
from recon.cli.own_files import ScenarioArgument
from recon.cli.sim_options import (
    FleetOptions,
    RunningOptions,
    check_numbers,
    parse_home,
    parse_size,
)
from recon.cli.sim_photos import photos_command
from recon.cli.sim_proxy import proxy_command
from recon.model.geo import GeoPoint, LatLon
from recon.model.vehicle import AltitudeReference
from recon.score import load_scenario
from recon.score.rehearsal import rehearsal_sky
from recon.score.simulation import go_home_heights_of, pads_of, rig_of, simulation_of
from recon.sim.app.fault_file import FaultScript, load_faults
from recon.sim.app.faults import parse_fault
from recon.sim.camera import CameraSettings
from recon.sim.camera.field import FieldRenderer
from recon.sim.camera.frames import FrameSource, folder_frames
from recon.sim.camera.replay import load_replay
from recon.sim.camera.rig import CameraRig
from recon.sim.errors import SimulationError
from recon.sim.fleet import IMAGER_SERIAL, Airborne, ImagerSetup, SimulationConfig
from recon.sim.flight.estimate import FIELD_DRIFT
from recon.sim.run import run_fleet
from recon.sim.world import WindSettings
from recon.site import Imager, Site, SiteError, demo_site_folder, load_site

MAX_FPS_HZ = 30.0

sim_app = App()


class ImagerWorld(NamedTuple):
    """Camera and pose of an imaging drone (None: above home), and the source of its frames."""

    rig: CameraRig | None
    source: FrameSource
    hover_m: float | None = None
    """Height at which it waits, where no marked frame states one."""


@sim_app.callback(invoke_without_command=True)
@with_options
def sim_command(context: typer.Context, fleet: FleetOptions, running: RunningOptions) -> None:
    """Run simulated companion apps that connect to a station.

    They run until Ctrl+C.
    """
    if context.invoked_subcommand is not None:
        return
    config = _config(fleet, running)
    asyncio.run(until_stopped(run_fleet(config, print_now), "simulation ended"))


def _config(fleet: FleetOptions, running: RunningOptions) -> SimulationConfig:
    """Return the simulation of the options; raises `ReconError`."""
    host, port = running.address
    check_numbers(running.fps, fleet.endurance_min, fleet.latency_s)
    script = FaultScript() if fleet.faults is None else load_faults(fleet.faults)
    place = _load_site(fleet.site)
    feed = replace(running.feed, latency_s=fleet.latency_s, starts_on=fleet.feed)
    worlds = _imager_worlds(place, fleet, running.seed)
    is_on_pads = fleet.home is None and fleet.replay_site is None
    return SimulationConfig(
        home=_home(fleet.home, place, worlds),
        station_host=host,
        station_port=port,
        vehicle_count=fleet.vehicles,
        imagers={s: ImagerSetup(w.source, feed, w.rig, w.hover_m) for s, w in worlds.items()},
        altitude_reference=AltitudeReference(fleet.altitude_reference.value),
        hover_on_ground=fleet.hover_on_ground,
        airborne=_AIRBORNE[fleet.airborne],
        wanders=fleet.wander,
        altitude_bias_m=fleet.altitude_bias_m,
        endurance_s=60.0 * fleet.endurance_min,
        endurances_s=dict.fromkeys(
            worlds, 60.0 * (fleet.imager_endurance_min or fleet.endurance_min)
        ),
        battery_swap_s=None if fleet.battery_swap_min is None else 60.0 * fleet.battery_swap_min,
        seed=running.seed,
        drift=FIELD_DRIFT,
        wind=_wind(fleet, running.seed),
        reports_mission_id=fleet.mission_ids,
        photo_interval_s=fleet.photo_interval_s,
        faults=(*(parse_fault(text) for text in fleet.fault or ()), *script.faults),
        chances=script.chances,
        pads=pads_of(place) if is_on_pads else {},
        go_home_heights_m=go_home_heights_of(place),
    )


_AIRBORNE = {None: Airborne.IMAGER, True: Airborne.ALL, False: Airborne.NONE}


@sim_app.command("scenario")
@with_options
def scenario_command(
    running: RunningOptions,
    scenario: ScenarioArgument,
    start_ns: Annotated[
        int | None, typer.Option(hidden=True, help="Zero of the world's time (monotonic clock).")
    ] = None,
) -> None:
    """Run a scenario's drones, sky, wind and faults.

    They run until Ctrl+C. The station should run the scenario's site.
    """
    host, port = running.address
    if not 0.0 < running.fps <= MAX_FPS_HZ:
        raise SimulationError(
            f"--fps: expected up to {MAX_FPS_HZ:g} per second, got {running.fps:g}"
        )
    config = simulation_of(load_scenario(scenario), abs(running.seed), running.feed)
    config = replace(config, station_host=host, station_port=port)
    asyncio.run(until_stopped(run_fleet(config, print_now, start_ns), "simulation ended"))


sim_app.command("proxy")(proxy_command)
sim_app.command("photos")(photos_command)


def _wind(fleet: FleetOptions, seed: int) -> WindSettings | None:
    if fleet.wind_mps == 0.0:
        return None
    speed_mps, heading_deg = fleet.wind_mps, fleet.wind_to_deg
    return WindSettings(seed=abs(seed), speed_10m_mps=speed_mps, heading_deg=heading_deg)


def _load_site(folder: Path | None) -> Site:
    place = load_site(demo_site_folder() if folder is None else folder)
    if place.frame is None:
        raise SiteError(f"{folder}: expected a site with an origin, got none")
    return place


def _home(text: str | None, place: Site, worlds: Mapping[str, ImagerWorld]) -> GeoPoint:
    rigs = (world.rig for world in worlds.values())
    frame = next((rig.frame for rig in rigs if rig is not None), place.frame)
    assert frame is not None
    if text is None:
        return frame.origin
    return GeoPoint(*parse_home(text), frame.origin.ellipsoid_height_m)


def _imager_worlds(place: Site, fleet: FleetOptions, seed: int) -> dict[str, ImagerWorld]:
    """Return the imaging drones' rigs and frames: of a real field, a folder, or rendered land."""
    replay, frames = fleet.replay_site, fleet.frames
    if not fleet.imager:
        if frames is not None or replay is not None:
            raise SimulationError(
                "--no-imager: expected neither --frames nor --replay-site, got one"
            )
        return {}
    if replay is not None and frames is not None:
        raise SimulationError("expected --replay-site or --frames, got both")
    if replay is not None:
        return {IMAGER_SERIAL: ImagerWorld(*load_replay(replay))}
    cols, rows = parse_size(fleet.frame_size)
    rigs = {serial: _rig(place, imager) for serial, imager in place.imagers.items()}
    if frames is not None:
        still = folder_frames(frames, rows, cols)
        return {s: ImagerWorld(rigs.get(s), still) for s in rigs or (IMAGER_SERIAL,)}
    if not rigs:
        raise SimulationError(
            "expected a site with an [imager], or --frames, or --no-imager, got none"
        )
    assert place.frame is not None, "a site with an imaging drone has an origin"
    origin, camera = place.frame.origin, CameraSettings(seed)
    middle = LatLon(origin.latitude_deg, origin.longitude_deg)
    sky = rehearsal_sky(middle, fleet.cover / 100.0, _wind(fleet, seed), abs(seed))
    worlds = {}
    for serial, rig in rigs.items():
        circle = place.imagers[serial].image_circle
        source = FieldRenderer(rig.camera, circle, seed, sky, camera)
        worlds[serial] = ImagerWorld(rig, source, _hover_m(place, place.imagers[serial]))
    return worlds


HIGHEST_HOVER_M, BELOW_LIMIT_M = 110.0, 10.0
"""Height of an imaging drone over one's own site: below what most countries allow."""


def _hover_m(place: Site, imager: Imager) -> float | None:
    """Return where an imaging drone hovers that telemetry places; a marked frame states it."""
    if imager.solution is not None:
        return None
    return min(HIGHEST_HOVER_M, place.limits.max_height_above_ground_m - BELOW_LIMIT_M)


def _rig(place: Site, imager: Imager) -> CameraRig:
    assert place.frame is not None
    return rig_of(place.frame, imager)
