"""A scenario as the simulator flies it: the same sky, wind, places and faults, in real packets."""

from dataclasses import replace
from typing import TypeVar

from recon.model.geo import GeoPoint, LocalFrame
from recon.score.scenario import Scenario
from recon.sim.app.camera_feed import FeedSettings
from recon.sim.app.faults import InjectedFault, RandomFault
from recon.sim.app.telemetry import FIELD_SENSORS
from recon.sim.camera import CameraSettings
from recon.sim.camera.field import FieldRenderer
from recon.sim.camera.replay import rig_over
from recon.sim.camera.rig import CameraRig
from recon.sim.fleet import IMAGER_SERIAL, Airborne, ImagerSetup, SimulationConfig
from recon.sim.world import Sky, Wind
from recon.sim.world.relief import Relief, ReliefSettings
from recon.site import Imager, Site

Asked = TypeVar("Asked", InjectedFault, RandomFault)

IMAGER_ENDURANCE_S = 36_000.0
"""The eye stays up for as long as a scenario lasts: its change of batteries is not looked at."""


def simulation_of(
    scenario: Scenario, seed: int, feed: FeedSettings | None = None
) -> SimulationConfig:
    """Return the fleet of a scenario, drones on their pads and the eye in the air, for a station
    at the usual port; without a feed the eye sends no pictures."""
    site = scenario.site
    fleet = scenario.fleet
    frame, imager = scenario.frame, site.imager
    assert imager is not None  # or it would not have been read
    rig = rig_of(frame, imager)
    source = FieldRenderer(
        rig.camera,
        imager.image_circle,
        seed,
        sky_of(scenario, seed),
        CameraSettings(seed),
        _relief(scenario, seed),
    )
    silent = FeedSettings(starts_on=False)
    return SimulationConfig(
        home=frame.origin,
        vehicle_count=len(fleet.serials) + 1,
        imager=ImagerSetup(source, silent if feed is None else feed, rig),
        airborne=Airborne.IMAGER,
        endurance_s=fleet.endurance_s,
        endurances_s={IMAGER_SERIAL: IMAGER_ENDURANCE_S},
        battery_swap_s=fleet.swap_s,
        sensors=FIELD_SENSORS,
        wind=replace(scenario.wind, seed=seed),
        seed=seed,
        faults=tuple(_by_serial(fault, fleet.serials) for fault in scenario.faults),
        chances=tuple(_by_serial(chance, fleet.serials) for chance in scenario.chances),
        pads=pads_of(site),
        go_home_heights_m=go_home_heights_of(site),
    )


def pads_of(site: Site) -> dict[str, GeoPoint]:
    """Return the pads that a site's profiles tell, by serial."""
    return {s: profile.pad for s, profile in site.profiles.items() if profile.pad is not None}


def go_home_heights_of(site: Site) -> dict[str, float]:
    """Return what a site's profiles say is set in the aircraft, in metres, by serial."""
    told = {serial: profile.go_home_height_m for serial, profile in site.profiles.items()}
    return {serial: height_m for serial, height_m in told.items() if height_m is not None}


def sky_of(scenario: Scenario, seed: int) -> Sky:
    """Return a run's sky."""
    return Sky(replace(scenario.sky, seed=seed))


def wind_of(scenario: Scenario, seed: int) -> Wind:
    """Return a run's wind."""
    return Wind(replace(scenario.wind, seed=seed))


def rig_of(frame: LocalFrame, imager: Imager) -> CameraRig:
    """Return the eye's camera on its aircraft, over a site's frame."""
    pose = imager.solution.pose
    if imager.marked_frame is None:
        return rig_over(imager.camera, frame, pose)
    return CameraRig(imager.camera, frame, pose, imager.marked_frame)


def _relief(scenario: Scenario, seed: int) -> Relief | None:
    if scenario.relief_m == 0.0:
        return None
    return Relief(ReliefSettings(seed, scenario.relief_m))


def _by_serial(fault: Asked, serials: tuple[str, ...]) -> Asked:
    """A scenario counts its survey drones alone, the simulator counts the eye as the first."""
    named = dict(zip(map(str, range(1, len(serials) + 1)), serials, strict=True))
    return replace(fault, vehicle=named.get(fault.vehicle, fault.vehicle))
