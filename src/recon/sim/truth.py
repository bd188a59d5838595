"""Ground truth of the simulated world: for the score and for tests, never for the station.

All of it is a pure function of the world's settings, so nothing is recorded during a flight.
"""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from recon.model.geo import GroundGrid
from recon.model.imagery import CameraPose
from recon.model.shade import SUNLIT_TRANSMITTANCE
from recon.model.survey import SurveyCamera
from recon.model.units import NS_PER_S
from recon.sim.camera.field import FieldRenderer
from recon.sim.camera.frames import CameraView
from recon.sim.camera.survey_shutter import IntervalTimer, SurveyPhoto, TruePath, photos
from recon.sim.errors import SimulationError
from recon.sim.world import Sky, SunPosition
from recon.sim.world.keyframes import FloatImage


@dataclass(frozen=True, slots=True)
class WorldTruth:
    """True sky, imaging drone's pose and survey photos.

    Times are ns since the simulation's start; ground points are east and north metres in the site's
    local frame.
    """

    sky: Sky
    imager: FieldRenderer | None = None
    seed: int = 0
    """Seed of the fleet: the phases of survey cameras' timers are drawn from it."""

    def sun_at(self, time_ns: int) -> SunPosition:
        """Return the sun's position."""
        return self.sky.sun_at(time_ns / NS_PER_S)

    def transmittance(
        self, east_m: npt.ArrayLike, north_m: npt.ArrayLike, time_ns: int
    ) -> FloatImage:
        """Return the transmittance of the direct beam, 0 to 1, at points (broadcast together)."""
        return self.sky.transmittance(east_m, north_m, time_ns / NS_PER_S)

    def transmittance_on(self, grid: GroundGrid, time_ns: int) -> FloatImage:
        """Return the transmittance of the direct beam at a grid's cells (rows, cols)."""
        return self.sky.on_grid(grid, time_ns / NS_PER_S)

    def imager_pose(self, view: CameraView) -> CameraPose:
        """Return the true pose of the imaging drone's camera for a frame.

        Raises `SimulationError` in a world without an imaging drone.
        """
        if self.imager is None:
            raise SimulationError("true poses: expected an imaging drone in this world, got none")
        return self.imager.true_pose(view)

    def survey_photos(
        self,
        serial: str,
        camera: SurveyCamera,
        path: TruePath,
        span_ns: tuple[int, int],
        home_m: tuple[float, float, float] = (0.0, 0.0, 0.0),
    ) -> list[SurveyPhoto]:
        """Return the photos that a survey drone truly took within `span_ns` (end excluded).

        `path` gives its true motion relative to its home; `home_m` is that home, east, north and up
        of the site's origin.
        """
        timer = IntervalTimer(self.seed, serial, camera.interval_s)
        return photos(timer, camera, path, span_ns, home_m)

    def share_in_sun(self, photo: SurveyPhoto, points_to_a_side: int = 8) -> float:
        """Return the share of a photo's ground that was in sun, from a lattice of points."""
        steps = (np.arange(points_to_a_side) + 0.5) / points_to_a_side
        down, right = (grid.ravel()[:, np.newaxis] for grid in np.meshgrid(steps, steps))
        front_left, front_right, _, back_left = photo.corners_m
        places = front_left + right * (front_right - front_left) + down * (back_left - front_left)
        share = self.transmittance(places[:, 0], places[:, 1], photo.captured_at_ns)
        return float(np.mean(share >= SUNLIT_TRANSMITTANCE))
