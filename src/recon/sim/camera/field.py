"""The farmland as the eye's camera sees it, under a sky of clouds.

A picture is a function of its view (pose, time, number) and the settings, to the bit. Ground
places and light are worked out on a coarse lattice of pixels and interpolated between.
"""

from dataclasses import dataclass, field

import numpy as np

from recon.camera import ImageCircle, OmnidirectionalCamera
from recon.model.imagery import CameraPose, RgbImage
from recon.sim.app.camera_feed import View
from recon.sim.camera.development import Scene, develop
from recon.sim.camera.exposure import exposure_stops, white_balance
from recon.sim.camera.hover import true_pose
from recon.sim.camera.land_picture import land_picture
from recon.sim.camera.lens import Lens
from recon.sim.camera.look import look
from recon.sim.camera.settings import ImagerSettings
from recon.sim.errors import FrameSourceError
from recon.sim.land.land_tiles import CELLS_M, land_of
from recon.sim.world import Sky, SkySettings
from recon.sim.world.keyframes import FloatArray
from recon.sim.world.relief import Relief
from recon.sim.world.sky_light import beam_share, light_under, metered_light


def _clear_sky() -> Sky:
    return Sky(SkySettings(layers=()))


@dataclass(slots=True)
class FieldFrames:
    """Renders views of the land; needs views with a pose.

    The ground's height 0 is that of the pose's frame; with relief it rolls about it.
    """

    camera: OmnidirectionalCamera
    image_circle: ImageCircle | None = None
    seed: int = 0
    sky: Sky = field(default_factory=_clear_sky)
    imager: ImagerSettings = field(default_factory=ImagerSettings)
    relief: Relief | None = None
    _lens: Lens | None = field(default=None, init=False)

    def render(self, view: View) -> RgbImage:
        """Return the picture (rows, cols, 3); may be called from several threads."""
        pose, time_s = self.true_pose(view), view.elapsed_s
        lens, land, sun = self.lens, land_of(self.seed), self.sky.sun_at(time_s)
        seen = look(lens, pose, self.relief)
        light = light_under(self.sky, time_s)
        east_m, north_m = (float(part) for part in pose.position_enu_m[:2])
        scene = Scene(
            seen,
            land_picture(lens, seen, lambda level: land.square(level, east_m, north_m, sun)),
            light,
            beam_share(self.sky, light, self.relief, seen.east_m, seen.north_m, time_s),
            self._gains(pose, time_s),
            view.number,
        )
        frame = np.zeros((self.camera.rows, self.camera.cols, 3), dtype=np.uint8)
        frame[lens.window] = develop(lens, self.imager, scene)
        return frame

    def prepare(self) -> None:
        """Draw the land around the origin, and the clouds of the first moment."""
        for level in range(len(CELLS_M)):
            land_of(self.seed).square(level, 0.0, 0.0, self.sky.sun_at(0.0))
        self.sky.transmittance(0.0, 0.0, 0.0)

    def true_pose(self, view: View) -> CameraPose:
        """Return where the camera truly was; `FrameSourceError` for a view without a pose."""
        if view.pose is None:
            raise FrameSourceError("expected a camera pose to render a field from, got none")
        return true_pose(view.pose, self.imager.hover, self.imager.seed, view.elapsed_s)

    def gains(self, view: View) -> FloatArray:
        """Return exposure and white balance of a view: light's factors (3,), 1 in full sun."""
        return self._gains(self.true_pose(view), view.elapsed_s)

    @property
    def lens(self) -> Lens:
        """The lens, worked out at the first call."""
        if self._lens is None:
            self._lens = Lens(self.camera, self.image_circle, self.imager.lens)
        return self._lens

    def _gains(self, pose: CameraPose, time_s: float) -> FloatArray:
        exposure, seed = self.imager.exposure, self.imager.seed
        stops = exposure_stops(
            exposure, seed, pose, time_s, lambda e, n, t: metered_light(self.sky, e, n, t)
        )
        gains: FloatArray = 2.0**stops * white_balance(exposure, seed, time_s)
        return gains
