"""Rooms put together: a site becomes the station's first state and the worker's tasks."""

from dataclasses import replace

import cv2
import numpy as np

from recon.camera.ground import GroundProjector
from recon.camera.motion import displaced_pose
from recon.fleet.state import Fleet
from recon.geo import shift_east_north_m
from recon.model.imagery import GroundImage
from recon.model.vehicle import VehicleProfile
from recon.safety import PreparedAirspace
from recon.site import Site
from recon.station.imaging.shade_work import READ_SHADE, read_task
from recon.station.kernel.worker import Task
from recon.station.operations.fleet_return.planning import PLAN_RETURN, plan_task
from recon.station.operations.survey.planning import PLAN_SURVEY, STEP_SURVEY, step_task
from recon.station.operations.survey.planning import plan_task as plan_survey_task
from recon.station.state.imaging import LAY_FRAME, Imaging, LayFrame
from recon.station.state.settings import StationSettings
from recon.station.state.station import Station

NEAR_AXIS_RAD = 0.3
"""Over this angle a fisheye's pixels per radian hardly change."""


def first_state(site: Site, settings: StationSettings | None = None) -> Station:
    """Return the station before anything has happened."""
    chosen = _with_lens(settings or StationSettings(), site)
    marked = None if site.imager is None else site.imager.marked_frame
    return Station(
        settings=chosen,
        airspace=PreparedAirspace(site.airspace),
        fleet=Fleet(settings=chosen.fleet, profiles=site.profiles),
        imaging=Imaging(
            imager_serial=None if site.imager is None else site.imager.serial,
            reference=marked,
            is_reference_assumed=marked is None,
        ),
    )


def worker_tasks(site: Site) -> dict[str, Task]:
    """Return what the worker can do for a site: plan the fleet's return; with an eye, lay its
    frames on the ground; read shade from them; plan surveys and carry them on."""
    cv2.setNumThreads(1)
    tasks: dict[str, Task] = {
        PLAN_RETURN: plan_task,
        READ_SHADE: read_task,
        PLAN_SURVEY: plan_survey_task,
        STEP_SURVEY: step_task,
    }
    if site.imager is None or site.frame is None or site.ground_grid is None:
        return tasks
    imager, frame = site.imager, site.frame
    projector = GroundProjector(site.ground_grid, imager.camera, imager.image_circle)
    mount = site.profiles.get(imager.serial, VehicleProfile(imager.serial)).mount

    def lay(payload: object) -> GroundImage:
        assert isinstance(payload, LayFrame)
        marked, now = payload.reference, payload.telemetry
        shift_m = shift_east_north_m(frame, marked, now)
        pose = displaced_pose(imager.solution.pose, marked, now, shift_m, mount)
        return projector.lay(payload.frame, pose)

    return {LAY_FRAME: lay, **tasks}


def _with_lens(settings: StationSettings, site: Site) -> StationSettings:
    """With what a pixel of this eye's lens covers; near its axis, where most of the field is."""
    if site.imager is None:
        return settings
    pixels = (
        float(site.imager.camera.profile.radius_px(np.array([NEAR_AXIS_RAD]))[0]) / NEAR_AXIS_RAD
    )
    return replace(settings, detection=replace(settings.detection, pixels_per_radian=pixels))
