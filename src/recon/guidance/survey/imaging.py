"""Ground sampling distance, and how fast a camera may be flown.

All of it for a camera that looks straight down, over ground that lies `height_m` below it.
"""

from dataclasses import dataclass

from recon.guidance.survey.settings import DEFAULT
from recon.model.mission import DJI
from recon.model.survey import SurveyCamera
from recon.model.survey_camera import CameraModel

MOST_BLUR_PX = 0.5
"""Motion blur during an exposure below which an image is as sharp as its pixels allow."""

EXPOSURE_S = 1.0 / 1000.0
"""What surveys in sun are set to with shutter priority; in shade it gets longer."""


@dataclass(frozen=True, slots=True)
class SpeedLimit:
    """A speed that must not be exceeded, and why, for operators."""

    speed_mps: float
    reason: str


def height_for_gsd_m(camera: SurveyCamera, gsd_m: float) -> float | None:
    """Return the height above the ground that gives a pixel size; None: pixels unknown."""
    one_metre_up_m = camera.gsd_m(1.0)
    return None if one_metre_up_m is None else gsd_m / one_metre_up_m


def longest_photo_m(
    camera: SurveyCamera,
    height_m: float,
    front_overlap: float,
    *,
    stops_in_rows: bool,
) -> float:
    """Return how far apart two photos of a row may be for its front overlap.

    Where rows have waypoints within, a photo must show what lies beside a stop before the aircraft
    gets there, or after it has left: what it sees in a hover does not count.
    """
    along_m = camera.along_m(height_m)
    seen_m = along_m - 2.0 * DEFAULT.place_slack_m
    return min(along_m * (1.0 - front_overlap), seen_m / 2.0 if stops_in_rows else seen_m)


def speed_limits(
    camera: SurveyCamera,
    height_m: float,
    front_overlap: float,
    exposure_s: float = EXPOSURE_S,
    fastest_mps: float = DJI.max_speed_mps,
    *,
    stops_in_rows: bool = False,
) -> tuple[SpeedLimit, ...]:
    """Return every limit of the speed along rows, the lowest first.

    `fastest_mps` is the site's limit, or the aircraft's. The blur counts where pixels are known.
    """
    photo_m = longest_photo_m(camera, height_m, front_overlap, stops_in_rows=stops_in_rows)
    limits = [
        SpeedLimit(
            photo_m / camera.interval_s,
            f"{front_overlap:.0%} front overlap with a photo every {camera.interval_s:g} s",
        ),
        SpeedLimit(fastest_mps, "fastest allowed"),
    ]
    gsd_m = camera.gsd_m(height_m)
    if gsd_m is not None:
        limits.append(
            SpeedLimit(
                MOST_BLUR_PX * gsd_m / exposure_s,
                f"blur of {MOST_BLUR_PX:g} pixel at an exposure of {exposure_text(exposure_s)}",
            )
        )
    return tuple(sorted(limits, key=lambda limit: limit.speed_mps))


def best_interval_s(
    model: CameraModel,
    height_m: float,
    front_overlap: float,
    exposure_s: float = EXPOSURE_S,
    fastest_mps: float = DJI.max_speed_mps,
    *,
    stops_in_rows: bool = False,
) -> float:
    """Return the timer setting that allows the highest speed, and of those the longest.

    A shorter one takes more photos for the same mosaic.
    """

    def fastest(interval_s: float) -> float:
        camera = model.at_interval(interval_s)
        known = height_m, front_overlap, exposure_s, fastest_mps
        return speed_limits(camera, *known, stops_in_rows=stops_in_rows)[0].speed_mps

    return max(model.timer_s, key=lambda interval_s: (round(fastest(interval_s), 9), interval_s))


def exposure_text(exposure_s: float) -> str:
    """Return an exposure as cameras show it."""
    return f"1/{1.0 / exposure_s:.0f} s" if exposure_s < 0.5 else f"{exposure_s:g} s"


def blur_px(camera: SurveyCamera, height_m: float, speed_mps: float, exposure_s: float) -> float:
    """Return how far the ground moves during an exposure, in pixels; 0 without pixels."""
    gsd_m = camera.gsd_m(height_m)
    return 0.0 if gsd_m is None else speed_mps * exposure_s / gsd_m
