"""What the detection of shade goes by, each with its reason."""

from dataclasses import dataclass

from recon.model.geo import GroundGrid


@dataclass(frozen=True, slots=True)
class DetectionSettings:
    """Times in seconds, light as a share of the sensor's full scale, levels of 255."""

    method: str = "brightness_ratio"
    """A name in `recon.detection.DETECTORS`."""

    grid: GroundGrid | None = None
    """The field's grid: all shade maps are on it, wherever the frames were laid. Without one it is
    the first frame's grid in cells of `cell_m`."""

    cell_m: float = 4.0
    """Frames placed by telemetry are metres off, and shadows' edges are tens of metres wide."""

    least_seen: float = 0.5
    """Share of a cell that a frame must show."""

    gamma: float = 2.2
    """Cameras write sRGB: light is about the level to this power."""

    diffuse_share: float = 0.25
    """The sky's part of full light on the ground. Clear sky with a high sun gives 0.15, broken
    cloud or a low sun 0.35; what is left of the light in deep shade."""

    window_s: float = 120.0
    """Two minutes: longer than the middle shadow (88 s), short against the sun's own way."""

    samples: int = 24
    """Kept of each cell in the window: one in 5 s, in which a shadow moves less than its edge."""

    sunlit_quantile: float = 0.9
    """Of a cell's samples, taken for its light in full sun; above it are glints and noise."""

    least_samples: int = 4
    """PositionSample for less than 15 s nothing is said of a cell: most shadows stay longer."""

    flat_confidence: float = 0.4
    """Of a cell that did not change for the whole window: it may have been in shade throughout."""

    unshaded_contrast: float = 0.1
    """By this share a cell darkens without shade: sensor noise, and frames placed metres off."""

    follows_exposure: bool = True
    """Off for cameras whose exposure is locked: then a dimming of the whole view is shade."""

    exposure_step_s: float = 2.0
    """Frames up to this far apart are compared: in it shadows move less than their edges are wide,
    and what is told wrongly does not add up as fast as from frame to frame."""

    exposure_gap_s: float = 10.0
    """Across a longer gap most cells may have changed their light; no exposure is told then."""

    exposure_spread: float = 0.04
    """How alike a third of the cells must have changed (natural log of light) for it to be taken
    for the camera's doing: noise and shifts of placement stay below, moving soft cloud above."""

    least_image: float = 0.01
    """Share of the grid that a frame must show at all."""

    black_level: int = 16
    """A picture whose brightest tenth is darker than this is black."""

    flat_share: float = 0.2
    """More than this of a picture at one and the same level is no ground, which noise spreads over
    many: decoders fill what is missing with one grey, and sensors run full at one white."""

    pixels_per_radian: float = 250.0
    """Of the eye's lens at 1280 columns: a fisheye of 170 degrees."""
