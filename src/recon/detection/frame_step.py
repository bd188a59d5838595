"""What every method does with a frame: check it, bring it onto the field's grid, tell the shade."""

from dataclasses import replace

import numpy as np

from recon.detection.cells import CellLight, cell_light, field_grid
from recon.detection.check import cells_fault, picture_fault
from recon.detection.rejected import RejectedFrame
from recon.detection.resolution import metres_per_pixel
from recon.detection.settings import DetectionSettings
from recon.detection.state import DetectionState
from recon.model.geo import GroundGrid
from recon.model.imagery import GroundImage
from recon.model.shade import FloatMap, MaskMap, ShadeMap


def take_frame(
    state: DetectionState, image: GroundImage, settings: DetectionSettings
) -> tuple[DetectionState, GroundGrid, CellLight] | RejectedFrame:
    """Return the state with this frame as its latest, the field's grid, and each cell's light.

    Another camera, or another grid in the settings, starts anew.
    """
    grid = state.grid
    if grid is None or (settings.grid is not None and grid != settings.grid):
        grid = field_grid(image.grid, settings)
    if grid != state.grid or image.serial != state.serial:
        state = DetectionState(grid, image.serial)
    fault = picture_fault(image, state.latest_ns, grid, settings)
    if fault is not None:
        return fault
    cells = cell_light(image, grid, settings)
    fault = cells_fault(image, cells, state.latest, settings)
    if fault is not None:
        return fault
    return replace(state, latest=cells, latest_ns=image.captured_at_ns), grid, cells


def shade_map(
    image: GroundImage,
    grid: GroundGrid,
    found: tuple[FloatMap, MaskMap, FloatMap],
    settings: DetectionSettings,
) -> ShadeMap:
    """Return the map of what a method found: transmittance, validity and confidence, each (R, C).

    What is not valid is made NaN and of no confidence.
    """
    transmittance, valid, confidence = found
    coarser_m = metres_per_pixel(grid, image.pose, settings.pixels_per_radian)
    nowhere = np.float32(np.nan)
    return ShadeMap(
        grid=grid,
        captured_at_ns=image.captured_at_ns,
        source_serials=(image.serial,) if image.serial else (),
        transmittance=np.where(valid, np.clip(transmittance, 0.0, 1.0), nowhere),
        valid=valid,
        confidence=np.where(valid, np.clip(confidence, 0.0, 1.0), np.float32(0.0)),
        metres_per_pixel=np.where(valid, coarser_m, nowhere),
    )
