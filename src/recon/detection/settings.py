"""Settings of shade detection, each with its reason."""

from dataclasses import dataclass

from recon.model.geo import GroundGrid


@dataclass(frozen=True, slots=True)
class DetectionSettings:
    """Times in seconds, light as a share of the sensor's full scale, levels of 255."""

    method: str = "sunlit_reference"
    """A name in `recon.detection.DETECTORS`."""

    grid: GroundGrid | None = None
    """The field grid of all shade maps. None: the area of the first frame's grid, in cells of
    `cell_m`."""

    cell_m: float = 4.0
    """Frames positioned by telemetry are metres off, and shadow edges are tens of metres wide."""

    least_seen: float = 0.5
    """Share of a cell that a frame must show."""

    gamma: float = 2.2
    """Cameras output sRGB: light is about the level to this power."""

    diffuse_share: float = 0.25
    """Diffuse share of full light on the ground, which remains in deep shade. Clear sky with a high
    sun gives 0.15, broken cloud or a low sun 0.35."""

    window_s: float = 120.0
    """Time window: longer than the median shadow (88 s), short compared with the sun's motion."""

    samples: int = 24
    """Samples per cell in the window: one per 5 s, in which a shadow moves less than its edge."""

    sunlit_quantile: float = 0.9
    """Quantile of a cell's samples taken as its light in full sun; above it: glints and noise."""

    least_samples: int = 4
    """Fewer samples (15 s) leave a cell invalid: most shadows stay longer than that."""

    flat_confidence: float = 0.4
    """Confidence of a cell that did not change over the window: it may be in shade throughout."""

    unshaded_contrast: float = 0.1
    """Share by which a cell darkens without shade: sensor noise, and frames metres off."""

    follows_exposure: bool = True
    """False for cameras with locked exposure: then a dimming of the whole view is shade."""

    exposure_step_s: float = 2.0
    """Least time between reference frames: shadows move less than the width of their edges, and
    errors add up more slowly than from frame to frame."""

    exposure_gap_s: float = 10.0
    """Longest gap across which the exposure is estimated: in a longer one most cells may change."""

    exposure_spread: float = 0.04
    """Largest spread (natural log of light) of the changes of a third of the cells to be taken as
    an exposure change: noise and position errors stay below, moving soft clouds above."""

    least_image: float = 0.01
    """Share of the grid that a frame must show."""

    black_level: int = 16
    """A frame whose brightest tenth is darker than this level is black."""

    flat_share: float = 0.2
    """A larger share at one single level is not ground, which noise spreads over many levels:
    decoders fill missing parts with one grey, and saturated sensors give one white."""
