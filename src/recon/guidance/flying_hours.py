"""When a survey fits: the sun high enough, no hot spot in the picture, not too much cloud. Pure.

Opposite the sun, ground hides its own shadows and is brighter (the hot spot). A camera that looks
straight down sees that place as far from the picture's middle as the sun is from the zenith: with
the sun high it lies in the picture, and each photo of a mosaic has its own.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from enum import Enum
from math import atan, degrees, hypot, radians, tan

from recon.geo.sun import sun_position
from recon.model.geo import LatLon
from recon.model.weather import Weather

STEP_S = 300.0
"""The sun moves by about a degree in it."""


@dataclass(frozen=True, slots=True)
class FlyingLimits:
    """What a survey's photos need."""

    corner_deg: float
    """Angle from the camera's axis to the corners of its picture: which way rows run is open."""
    lowest_sun_deg: float = 30.0
    """Below it shadows are 1.7 times as long as what throws them, and grow fast."""
    most_cloud_share: float = 0.6
    """With more, less ground is in sun than in shade for most of the time."""

    @property
    def highest_sun_deg(self) -> float:
        """The sun's elevation from which on the hot spot's middle is in the picture."""
        return 90.0 - self.corner_deg


class Fit(Enum):
    """Why a time fits, or the first reason why not."""

    FITS = "fits"
    LOW_SUN = "low sun"
    HOT_SPOT = "hot spot"
    CLOUD = "cloud"


@dataclass(frozen=True, slots=True)
class FlyingSpan:
    """A time with one answer; least and most of the sun's elevation and of the cloud cover in it.

    `cloud_share` None: no weather for it, so the sun alone decides.
    """

    from_utc_s: float
    to_utc_s: float
    fit: Fit
    sun_deg: tuple[float, float]
    cloud_share: tuple[float, float] | None = None


def corner_deg(across_deg: float, along_deg: float) -> float:
    """Return the angle from a camera's axis to its picture's corners, of its fields of view."""
    across, along = (tan(radians(each) / 2.0) for each in (across_deg, along_deg))
    return degrees(atan(hypot(across, along)))


def flying_spans(
    place: LatLon, from_utc_s: float, to_utc_s: float, limits: FlyingLimits, weather: Weather | None
) -> tuple[FlyingSpan, ...]:
    """Return the spans of a time, in order and without gaps, each judged every `STEP_S`."""
    spans: list[FlyingSpan] = []
    for step in _steps(place, from_utc_s, to_utc_s, limits, weather):
        last = spans[-1] if spans else None
        is_alike = last is not None and last.fit is step.fit
        if (
            last is not None
            and is_alike
            and (last.cloud_share is None) is (step.cloud_share is None)
        ):
            spans[-1] = _joined(last, step)
        else:
            spans.append(step)
    return tuple(spans)


def _steps(
    place: LatLon, from_utc_s: float, to_utc_s: float, limits: FlyingLimits, weather: Weather | None
) -> Iterator[FlyingSpan]:
    begins_s = from_utc_s
    while begins_s < to_utc_s:
        # Whole steps of the clock, whenever it is asked.
        ends_s = min((begins_s // STEP_S + 1.0) * STEP_S, to_utc_s)
        middle_s = (begins_s + ends_s) / 2.0
        sun_deg = sun_position(place, middle_s).elevation_deg
        hour = None if weather is None else weather.at(middle_s)
        cloud = None if hour is None else hour.cloud_share
        fit = _fit(sun_deg, cloud, limits)
        shares = None if cloud is None else (cloud, cloud)
        yield FlyingSpan(begins_s, ends_s, fit, (sun_deg, sun_deg), shares)
        begins_s = ends_s


def _fit(sun_deg: float, cloud_share: float | None, limits: FlyingLimits) -> Fit:
    if sun_deg < limits.lowest_sun_deg:
        return Fit.LOW_SUN
    if sun_deg > limits.highest_sun_deg:
        return Fit.HOT_SPOT
    if cloud_share is not None and cloud_share > limits.most_cloud_share:
        return Fit.CLOUD
    return Fit.FITS


def _joined(first: FlyingSpan, then: FlyingSpan) -> FlyingSpan:
    cloud = None
    if first.cloud_share is not None and then.cloud_share is not None:
        cloud = _range(first.cloud_share, then.cloud_share)
    sun_deg = _range(first.sun_deg, then.sun_deg)
    return FlyingSpan(first.from_utc_s, then.to_utc_s, first.fit, sun_deg, cloud)


def _range(first: tuple[float, float], then: tuple[float, float]) -> tuple[float, float]:
    return min(first[0], then[0]), max(first[1], then[1])
