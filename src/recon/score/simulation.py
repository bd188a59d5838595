"""A scenario as the simulator's configuration: fleet, sky, wind, pads and faults."""

from dataclasses import replace
from typing import TypeVar

from recon.model.geo import GeoPoint, LocalFrame
from recon.score.scenario import Scenario
from recon.score.scenario_conditions import conditions_of
from recon.score.scenario_sky import sky_of
from recon.sim.app.camera_feed import FeedSettings
from recon.sim.app.faults import InjectedFault, RandomFault
from recon.sim.app.telemetry import TelemetrySensorSettings
from recon.sim.camera.field import FieldRenderer
from recon.sim.camera.replay import rig_over
from recon.sim.camera.rig import CameraRig
from recon.sim.fleet import Airborne, ImagerSetup, SimulationConfig
from recon.sim.flight.estimate import FIELD_DRIFT
from recon.sim.world.relief import Relief, ReliefSettings
from recon.site import Imager, Site

FaultOrChance = TypeVar("FaultOrChance", InjectedFault, RandomFault)

APART = 1_000_003
"""Difference between the seeds of two cameras."""
IMAGER_ENDURANCE_S = 36_000.0
"""The imaging drone stays up for the whole scenario: its battery changes are not modelled."""


def simulation_of(
    scenario: Scenario, seed: int, feed: FeedSettings | None = None
) -> SimulationConfig:
    """Return a scenario's fleet: drones on their pads, the imaging drone in the air.

    Without a feed the imaging drone sends no frames.
    """
    site = scenario.site
    fleet = scenario.fleet
    conditions = conditions_of(scenario, seed)
    sent = FeedSettings(starts_on=False) if feed is None else feed
    imagers = {
        serial: _setup(scenario, imager, number, seed, sent)
        for number, (serial, imager) in enumerate(site.imagers.items())
    }
    return SimulationConfig(
        home=scenario.frame.origin,
        vehicle_count=len(fleet.serials) + len(imagers),
        imagers=imagers,
        airborne=Airborne.IMAGER,
        takes_missions=fleet.takes_missions,
        endurance_s=fleet.endurance_s,
        endurances_s=dict.fromkeys(imagers, IMAGER_ENDURANCE_S),
        battery_swap_s=fleet.swap_s,
        battery_kept_share=fleet.kept_share,
        drift=FIELD_DRIFT,
        sensors=TelemetrySensorSettings(yaw_error_deg=conditions.yaw_error_deg),
        wind=replace(scenario.wind, seed=seed),
        seed=seed,
        faults=tuple(_by_serial(fault, fleet.serials) for fault in scenario.faults),
        chances=tuple(_by_serial(chance, fleet.serials) for chance in scenario.chances),
        pads=pads_of(site),
        go_home_heights_m=go_home_heights_of(site),
    )


def _setup(
    scenario: Scenario, imager: Imager, number: int, seed: int, feed: FeedSettings
) -> ImagerSetup:
    """Return one imaging drone's frames; all see the same land and sky, each wobbles on its own."""
    rig, conditions = rig_of(scenario.frame, imager), conditions_of(scenario, seed)
    camera = replace(conditions.camera, seed=conditions.camera.seed + APART * number)
    source = FieldRenderer(
        rig.camera,
        imager.image_circle,
        seed,
        sky_of(scenario, seed),
        camera,
        _relief(conditions.relief_m, seed),
        conditions.light,
    )
    return ImagerSetup(source, feed, rig)


def pads_of(site: Site) -> dict[str, GeoPoint]:
    """Return the pads of a site's vehicle profiles, by serial."""
    return {s: profile.pad for s, profile in site.profiles.items() if profile.pad is not None}


def go_home_heights_of(site: Site) -> dict[str, float]:
    """Return the go-home heights of a site's vehicle profiles in metres, by serial."""
    heights_m = {serial: profile.go_home_height_m for serial, profile in site.profiles.items()}
    return {serial: height_m for serial, height_m in heights_m.items() if height_m is not None}


def rig_of(frame: LocalFrame, imager: Imager) -> CameraRig:
    """Return the imaging drone's camera in a site's frame."""
    pose = imager.marked_pose
    if imager.marked_frame is None:
        return rig_over(imager.camera, frame, pose)
    return CameraRig(imager.camera, frame, pose, imager.marked_frame)


def _relief(height_m: float, seed: int) -> Relief | None:
    return None if height_m == 0.0 else Relief(ReliefSettings(seed, height_m))


def _by_serial(fault: FaultOrChance, serials: tuple[str, ...]) -> FaultOrChance:
    """Name drones by serial: the simulator counts the imaging drone as number 1, a scenario not."""
    named = dict(zip(map(str, range(1, len(serials) + 1)), serials, strict=True))
    return replace(fault, vehicle=named.get(fault.vehicle, fault.vehicle))
