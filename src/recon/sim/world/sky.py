"""The sky: transmittance of the sun's direct beam, at any place and time.

A pure function of its settings (seed, place, time, layers): the same point at the same time has
the same value to the bit, whatever was asked before or is asked with it.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt

from recon.geo import cell_centres_m
from recon.geo.sun import SunPosition, sun_position
from recon.model.arrays import FloatArray
from recon.model.geo import GroundGrid
from recon.sim.world.fractal_field import AT_ONCE, IndexArray
from recon.sim.world.keyframes import FloatImage
from recon.sim.world.layer import CloudLayer
from recon.sim.world.penumbra import penumbra
from recon.sim.world.settings import SkySettings

POINTS_AT_ONCE = 65_536
"""Points computed together: their arrays fit the processor's cache."""


@dataclass(frozen=True)
class Sky:
    """Sun and clouds over a site; ground points are east and north metres of the site's frame."""

    settings: SkySettings

    @cached_property
    def layers(self) -> tuple[CloudLayer, ...]:
        """The clouds, the lower layer first."""
        return tuple(
            CloudLayer((self.settings.seed, number), layer)
            for number, layer in enumerate(self.settings.layers)
        )

    def sun_at(self, time_s: float) -> SunPosition:
        """Return the sun's position, `time_s` after the scenario's start."""
        sun = self.settings.sun
        return sun_position(sun.place, sun.start_utc_s + time_s)

    def transmittance(
        self, east_m: npt.ArrayLike, north_m: npt.ArrayLike, time_s: npt.ArrayLike
    ) -> FloatImage:
        """Return the transmittance, 0 to 1, at ground points and times (broadcast together).

        A single number for the time is fastest.
        """
        east, north, time = (np.asarray(v, dtype=np.float64) for v in (east_m, north_m, time_s))
        shape = np.broadcast_shapes(east.shape, north.shape, time.shape)
        flat = [np.broadcast_to(v, shape).ravel() for v in (east, north)]
        times = time.reshape(1) if time.size == 1 else np.broadcast_to(time, shape).ravel()
        return self._in_pieces(flat[0], flat[1], times, self._still).reshape(shape)

    def _in_pieces(
        self, east_m: FloatArray, north_m: FloatArray, time_s: FloatArray, moved_m: FloatArray
    ) -> FloatImage:
        found = np.ones(east_m.size, dtype=np.float32)
        for start in range(0, found.size, POINTS_AT_ONCE):
            part = slice(start, start + POINTS_AT_ONCE)
            times_s = time_s if time_s.size == 1 else time_s[part]
            found[part] = self._piece(east_m[part], north_m[part], times_s, moved_m)
        return found

    @property
    def _still(self) -> FloatArray:
        return np.zeros((len(self.layers), 2))

    def _piece(
        self, east_m: FloatArray, north_m: FloatArray, time_s: FloatArray, moved_m: FloatArray
    ) -> FloatImage:
        """Return the transmittance (N,) at N points; times are (N,) or (1,).

        Each layer is read `moved_m` (layers, 2) east and north of them.
        """
        times_s, moment = _moments(time_s)
        suns = [self.sun_at(float(one_s)) for one_s in times_s]
        clouds_s = times_s + self.settings.clouds_ahead_s
        share = np.ones(east_m.size, dtype=np.float32)
        for layer, (right_m, up_m) in zip(self.layers, moved_m.tolist(), strict=True):
            edge = penumbra(suns, layer.settings.base_height_m)
            share *= layer.transmittance(east_m + right_m, north_m + up_m, clouds_s, edge, moment)
        return share

    def origins_m(self, at_s: float, later_s: float) -> FloatArray:
        """Return, by layer, how far east and north of a place the shadow is at a time that will lie
        on it later, (layers, 2): the clouds' motion and the sun's."""
        offsets = [self._offsets_m(time_s) for time_s in (at_s, later_s)]
        return offsets[1] - offsets[0]

    def _offsets_m(self, time_s: float) -> FloatArray:
        sun, cloud_s = self.sun_at(time_s), np.array([time_s + self.settings.clouds_ahead_s])
        offsets = [
            layer.offset_m(cloud_s, penumbra([sun], layer.settings.base_height_m))
            for layer in self.layers
        ]
        return np.array(offsets, dtype=np.float64).reshape(len(self.layers), 2)

    def drifted(self, grid: GroundGrid, at_s: float, later_s: float) -> FloatImage:
        """Return the transmittance (rows, cols) later, had the shadows of a time only moved."""
        east_m, north_m = (part.ravel() for part in np.meshgrid(*cell_centres_m(grid)))
        moved_m = self.origins_m(at_s, later_s)
        found = self._in_pieces(east_m, north_m, np.array([at_s]), moved_m)
        return found.reshape(grid.rows, grid.cols)

    def on_grid(self, grid: GroundGrid, time_s: float) -> FloatImage:
        """Return the transmittance at the centres of a grid's cells, (rows, cols)."""
        east_m, north_m = cell_centres_m(grid)
        return self.transmittance(east_m[np.newaxis, :], north_m[:, np.newaxis], time_s)


def _moments(time_s: FloatArray) -> tuple[FloatArray, IndexArray]:
    """Return the moments (K,) among times (N,), and for each time the number of its moment."""
    if time_s.size == 1:
        return time_s, AT_ONCE
    # Callers with many times have runs of points with equal time: look up one per run.
    heads = np.flatnonzero(np.diff(time_s, prepend=np.nan) != 0.0)
    moments, of_head = np.unique(time_s[heads], return_inverse=True)
    return moments, np.repeat(of_head, np.diff(heads, append=time_s.size))
