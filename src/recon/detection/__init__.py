"""Where the ground lies in shade: frames on the ground in, shade maps out.

A method is a pure function of one file, chosen by its name in `DETECTORS`. All of them check the
frame first (`check`), bring it onto the field's own grid (`cells`), and answer with a `ShadeMap` on
that grid, or with a `RejectedFrame`.
"""

from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import TypeAlias

from recon.detection.brightness_ratio import brightness_ratio
from recon.detection.frame_step import FrameFault, RejectedFrame
from recon.detection.otsu import otsu
from recon.detection.settings import DetectionSettings
from recon.detection.state import DetectionState
from recon.model.imagery import GroundImage
from recon.model.shade import ShadeMap

__all__ = [
    "DETECTORS",
    "DetectionSettings",
    "DetectionState",
    "Detector",
    "FrameFault",
    "RejectedFrame",
]

Detector: TypeAlias = Callable[
    [DetectionState, GroundImage, DetectionSettings],
    tuple[DetectionState, ShadeMap | RejectedFrame],
]
"""One frame: `(state, image, settings) -> (state, shade)`, beginning with `DetectionState()`.

Frames come in the order they were taken. The shade map is on the field's grid, the same for every
frame of a flight. A rejected frame leaves the state as it was.
"""

DETECTORS: Mapping[str, Detector] = MappingProxyType(
    {"brightness_ratio": brightness_ratio, "otsu": otsu}
)
"""The methods by name."""
