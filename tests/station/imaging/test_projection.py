"""The worker's part of a frame: frames of known poses aligned over a site."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from tests.camera.registered_scenes import CAMERA, displacements_m, seen

from recon.camera import TelemetryReference, mounted_pose
from recon.camera.registration import RegistrationState
from recon.geo import point_from_enu
from recon.model.imagery import CameraPose, Frame, Registration, RgbImage
from recon.model.units import seconds_to_ns
from recon.site import Site, demo_site_folder, load_site
from recon.station.api_views.imaging_views import ground_image_view
from recon.station.imaging.projection import ProjectedFrame, projection
from recon.station.kernel.build import first_state
from recon.station.state.imaging import ProjectFrame


@pytest.fixture(scope="module")
def site() -> Site:
    return load_site(demo_site_folder())


class Worker:
    """Lays frame after frame, a second apart, all with the marked frame's telemetry."""

    def __init__(self, site: Site) -> None:
        assert site.imager is not None
        self.marked_pose = site.imager.marked_pose
        self.marked = site.imager.marked_frame
        self.project = projection(site)
        self.state = RegistrationState()
        self.number = 0

    def projects(self, rgb: RgbImage) -> ProjectedFrame:
        assert self.marked is not None
        self.number += 1
        at_ns = seconds_to_ns(self.number)
        frame = Frame(self.number, "SIM-IMAGER", at_ns, at_ns, 0.25, rgb=rgb)
        projected = self.project(
            ProjectFrame(frame, self.marked, self.marked, registration=self.state)
        )
        self.state = projected.registration
        return projected


def moved(pose: CameraPose) -> CameraPose:
    turn = Rotation.from_rotvec(np.deg2rad((1.0, -1.5, 0.8))).as_matrix()
    shift_m = np.array((3.0, -2.0, 0.5))
    return CameraPose(turn @ pose.rotation_enu_camera, pose.position_enu_m + shift_m)


def test_a_frame_is_projected_where_its_content_shows(site: Site) -> None:
    worker = Worker(site)
    start = seen(worker.marked_pose)
    for _ in range(2):
        first = worker.projects(start)
        assert first.image.registration is Registration.UNREGISTERED
        assert first.problem
    true = moved(worker.marked_pose)
    projected = worker.projects(seen(true))
    assert projected.image.registration is Registration.REGISTERED
    assert projected.problem == ""
    assert projected.image.registration_residual_m is not None
    off_m = displacements_m(projected.image.pose, true, worker.marked_pose, worker.marked_pose)
    assert np.percentile(off_m, 95) < 0.6


def test_frames_of_another_size_begin_with_a_reference_of_their_own(site: Site) -> None:
    worker = Worker(site)
    small = seen(worker.marked_pose)
    worker.projects(small)
    worker.projects(small)
    large = np.repeat(np.repeat(small, 2, axis=0), 2, axis=1)
    worker.projects(large)
    worker.projects(large)
    assert worker.projects(large).image.registration is Registration.REGISTERED


def test_a_lens_without_a_known_circle_is_registered_once_it_is_found(site: Site) -> None:
    assert site.imager is not None
    bare = site.with_imager(replace(site.imager, image_circle=None))
    worker = Worker(bare)
    black = np.zeros((CAMERA.rows, CAMERA.cols, 3), dtype=np.uint8)
    assert "image circle" in worker.projects(black).problem
    start = seen(worker.marked_pose)
    statuses = [worker.projects(start).image.registration for _ in range(3)]
    assert statuses[-1] is Registration.REGISTERED


def test_without_control_points_the_frame_lies_where_telemetry_has_the_drone(site: Site) -> None:
    assert site.imager is not None
    assert site.frame is not None
    origin = site.frame.origin
    start = TelemetryReference(origin.latitude_deg, origin.longitude_deg, 0.0, 0.0)
    level = mounted_pose(start, np.zeros(3))
    imager = replace(site.imager, marked_pose=level, marked_frame=start, solution=None)
    bare = site.with_imager(imager)
    place = point_from_enu(site.frame, (30.0, -40.0, 0.0))
    now = TelemetryReference(place.latitude_deg, place.longitude_deg, 110.0, 90.0)
    frame = Frame(1, "SIM-IMAGER", 10, 5, 0.25, rgb=seen(Worker(site).marked_pose))
    pose = projection(bare)(ProjectFrame(frame, now, start)).image.pose
    assert pose.position_enu_m == pytest.approx([30.0, -40.0, 110.0], abs=0.05)
    # The rows run away from the top, which is the drone's front; the third axis is the optical one.
    assert -pose.rotation_enu_camera[:, 1] == pytest.approx([1.0, 0.0, 0.0], abs=1e-6)
    assert pose.rotation_enu_camera[:, 2] == pytest.approx([0.0, 0.0, -1.0], abs=1e-6)


def test_the_ground_image_states_that_telemetry_alone_places_it(site: Site) -> None:
    assert site.imager is not None
    bare = site.with_imager(replace(site.imager, solution=None))
    projected = Worker(site).projects(seen(Worker(site).marked_pose))
    for shown, expected in ((bare, "telemetry and mount alone"), (site, "of the marked frame")):
        station = first_state(shown)
        ((serial, imager),) = station.imaging.imagers.items()
        imagers = {serial: replace(imager, ground_image=projected.image)}
        imaging = replace(station.imaging, imagers=imagers)
        view = ground_image_view(replace(station, imaging=imaging), seconds_to_ns(2))
        assert view is not None
        assert expected in view.reference
