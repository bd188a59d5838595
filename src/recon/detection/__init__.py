"""Shade detection: orthorectified frames in, shade maps out.

A method is a pure function in a file of its own, chosen by name in `DETECTORS`; adding one needs
that file, a line in the registry and a row in docs/detection-and-forecast.md. Installed packages
add theirs as entry points (docs/how-to/bring-a-method.md). Every method begins
with `take_frame` (checks, sampling on the field grid) and returns a `ShadeMap` on that grid, or a
`RejectedFrame`.
"""

from collections.abc import Callable
from typing import TypeAlias

from recon.detection.brightness_ratio import brightness_ratio
from recon.detection.frame_step import FrameFault, RejectedFrame
from recon.detection.merged import merged
from recon.detection.otsu import otsu
from recon.detection.settings import DetectionSettings
from recon.detection.state import DetectionState
from recon.detection.sunlit_reference import sunlit_reference, sunlit_reference_of
from recon.model.imagery import GroundImage
from recon.model.methods import MethodRegistry
from recon.model.shade import ShadeMap

Detector: TypeAlias = Callable[
    [DetectionState, GroundImage, DetectionSettings],
    tuple[DetectionState, ShadeMap | RejectedFrame],
]
"""One frame: `(state, image, settings) -> (state, shade)`, starting from `DetectionState()`.

`image` is a `GroundImage` (R, C, 3) on any grid of the field's local frame. Frames must come in the
order they were taken. The shade map is on the field grid, the same for every frame of a flight. A
rejected frame leaves the state unchanged. Pure: no clock, no random numbers, no files.
"""

DETECTORS: MethodRegistry[Detector] = MethodRegistry(
    "recon.detectors",
    {
        "sunlit_reference": sunlit_reference,
        "brightness_ratio": brightness_ratio,
        "otsu": otsu,
    },
    callable,
)
"""The methods by name."""
