"""One layer of clouds: its drift and its transmittance."""

from dataclasses import dataclass
from functools import cached_property
from math import cos, radians, sin
from statistics import NormalDist

import numpy as np

from recon.model.arrays import FloatArray
from recon.sim.world.fractal_field import AT_ONCE, ROW_POINTS, FractalField, IndexArray
from recon.sim.world.keyframes import FloatImage, gaussian, generator
from recon.sim.world.penumbra import Penumbra, extinction_table, look_up, spread
from recon.sim.world.settings import LayerSettings
from recon.sim.world.wind import velocity

OCTAVES, MODULATION, AXES = 0, 1, 2
"""Streams of a layer's random numbers."""


@dataclass(frozen=True)
class CloudLayer:
    """A layer; its clouds are drawn from `stream`, all else is in the settings."""

    stream: tuple[int, ...]
    settings: LayerSettings

    @cached_property
    def field(self) -> FractalField:
        """The field: cloud where it exceeds the threshold."""
        at = self.settings
        return FractalField(
            (*self.stream, OCTAVES),
            at.spectral_slope,
            at.outer_scale_m,
            at.finest_scale_m,
            at.lifetime_s,
            at.lifetime_exponent,
        )

    def transmittance(
        self,
        east_m: FloatArray,
        north_m: FloatArray,
        time_s: FloatArray,
        edge: Penumbra,
        moment: IndexArray = AT_ONCE,
    ) -> FloatImage:
        """Return the direct beam's share (N,) at N ground points at K moments.

        Times and penumbrae (those of this layer's height at these times) are (K,); `moment` (N,) is
        the number of each point's, or (1,) if that is one for all.
        """
        # A threshold at infinity would make NaN.
        if self.settings.cover in (0.0, 1.0):
            return np.full(east_m.size, self._even_share, dtype=np.float32)
        # Frozen drift: sample the field where the cloud was at time 0.
        off_east_m, off_north_m = self.offset_m(time_s, edge)
        x_m, y_m = self._field_place(east_m + off_east_m[moment], north_m + off_north_m[moment])
        found = self.field.sample(x_m, y_m, time_s, edge.across_m * edge.along_m, moment)
        per_softness = np.float32(1.0 / self.settings.softness)
        threshold = self._threshold(time_s).astype(np.float32)
        excess = (found.value - threshold[moment]) * per_softness
        spreads = spread(edge.at(moment), self._axes_rad, found) * per_softness
        return _by_rows(self._table, excess, spreads)

    @property
    def _even_share(self) -> float:
        """Transmittance of a layer without edges: 1, or that of its thickest cloud."""
        return 1.0 if self.settings.cover == 0.0 else float(self._table[-1, 0])

    def offset_m(self, time_s: FloatArray, edge: Penumbra) -> tuple[FloatArray, FloatArray]:
        """Return the offset from a ground point to where the cloud that shades it was at time 0."""
        drift_east_m, drift_north_m = drift_m(self.settings, time_s)
        return (
            edge.offset_m * edge.toward_east - drift_east_m,
            edge.offset_m * edge.toward_north - drift_north_m,
        )

    def _field_place(self, east: FloatArray, north: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return coordinates along the field's own axes, which have a random direction: the
        periodic tiles must not repeat along north or east."""
        to_x, to_y = cos(self._axes_rad), sin(self._axes_rad)
        return east * to_x - north * to_y, east * to_y + north * to_x

    def _threshold(self, time_s: FloatArray) -> FloatArray:
        """Return the field's value at cloud edges; it varies slowly, so that the cover does."""
        at = self.settings
        # The modulated threshold widens the distribution: scale it, so that the mean cover is kept.
        middle = NormalDist().inv_cdf(1.0 - at.cover) * (1.0 + at.modulation**2) ** 0.5
        wandering = gaussian((*self.stream, MODULATION), time_s, at.modulation_s)
        threshold: FloatArray = middle - at.modulation * wandering
        return threshold

    @cached_property
    def _axes_rad(self) -> float:
        return radians(float(generator((*self.stream, AXES), 0).uniform(0.0, 360.0)))

    @cached_property
    def _table(self) -> FloatImage:
        return extinction_table(self.settings.largest_optical_depth)


def _by_rows(table: FloatImage, excess: FloatImage, spreads: FloatImage) -> FloatImage:
    """Look up N points in rows of a fixed length, as all sampling here is done."""
    full = np.zeros((2, -(-excess.size // ROW_POINTS) * ROW_POINTS), dtype=np.float32)
    full[0, : excess.size], full[1, : excess.size] = excess, spreads
    found = look_up(table, full[0].reshape(-1, ROW_POINTS), full[1].reshape(-1, ROW_POINTS))
    return found.ravel()[: excess.size]


def drift_m(layer: LayerSettings, time_s: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return how far east and north the clouds have moved since time 0; before it: negative."""
    east_mps, north_mps = velocity(layer.speed_mps, layer.heading_deg)
    east_m, north_m = east_mps * time_s, north_mps * time_s
    for shift in layer.shifts:
        to_east, to_north = velocity(shift.speed_mps, shift.heading_deg)
        # The velocity changes linearly: its integral is a parabola, then a straight line.
        during_s = np.clip(time_s - shift.start_s, 0.0, shift.duration_s)
        after_s = np.maximum(time_s - shift.start_s - shift.duration_s, 0.0)
        lasting_s = during_s * during_s / (2.0 * shift.duration_s) + after_s
        east_m = east_m + (to_east - east_mps) * lasting_s
        north_m = north_m + (to_north - north_mps) * lasting_s
        east_mps, north_mps = to_east, to_north
    return east_m, north_m
