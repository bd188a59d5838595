"""One shade map from those of several imaging drones."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from recon.model.shade import MaskMap, ShadeMap


def merged(shades: Sequence[ShadeMap]) -> ShadeMap:
    """Return one map of maps on one grid, at the time of the first.

    A cell is the mean of the maps that know it, weighted by their confidence and by the number of
    pixels with which they see it. One map alone is returned as it is. Raises `ValueError` for maps
    on different grids.
    """
    first = shades[0]
    if any(each.grid != first.grid for each in shades):
        raise ValueError("merged: expected shade maps on one grid, got several grids")
    if len(shades) == 1:
        return first
    valid = np.stack([each.valid for each in shades])
    confidence = np.stack([each.confidence for each in shades])
    coarser_m = np.stack([each.metres_per_pixel for each in shades])
    transmittance = np.stack([each.transmittance for each in shades])
    known: MaskMap = np.logical_or.reduce(valid, axis=0)
    weight = np.where(valid, np.maximum(confidence, 1e-6) / coarser_m**2, 0.0)
    weight /= np.maximum(weight.sum(axis=0), np.finfo(np.float64).tiny)
    values = (transmittance, confidence)
    mean, sure = ((weight * np.where(valid, each, 0.0)).sum(axis=0) for each in values)
    finest_m = np.where(valid, coarser_m, np.inf).min(axis=0)
    nowhere = np.float32(np.nan)
    return replace(
        first,
        source_serials=tuple(dict.fromkeys(s for each in shades for s in each.source_serials)),
        transmittance=np.where(known, mean, nowhere).astype(np.float32),
        valid=known,
        confidence=sure.astype(np.float32),
        metres_per_pixel=np.where(known, finest_m, nowhere).astype(np.float32),
    )
