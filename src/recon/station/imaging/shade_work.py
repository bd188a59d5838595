"""One frame's way to a shade map and a forecast: what the worker does."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TypeVar

from recon.detection import DETECTORS, DetectionSettings, DetectionState, RejectedFrame
from recon.forecast import FORECASTERS, ForecastSettings, ForecastState
from recon.model.imagery import GroundImage
from recon.model.shade import ShadeMap, SunForecast

Method = TypeVar("Method")

READ_SHADE = "read_shade"
"""The kind of work that reads one ground image."""


@dataclass(frozen=True, slots=True, eq=False)
class ReadShade:
    """The work: the next ground image, and what the methods remember of those before it."""

    image: GroundImage
    detection: DetectionState
    forecast: ForecastState
    detection_settings: DetectionSettings
    forecast_settings: ForecastSettings


@dataclass(frozen=True, slots=True, eq=False)
class ShadeRead:
    """The result: a shade map with its forecast, or a rejected frame; and the new memories."""

    detection: DetectionState
    forecast: ForecastState
    found: tuple[ShadeMap, SunForecast] | RejectedFrame


def read_task(payload: object) -> ShadeRead:
    """Read one frame by the methods that the settings name; raises `ValueError` for none of it."""
    assert isinstance(payload, ReadShade)
    detect = _method(DETECTORS, payload.detection_settings.method, "detection")
    foresee = _method(FORECASTERS, payload.forecast_settings.method, "forecast")
    seen, shade = detect(payload.detection, payload.image, payload.detection_settings)
    if isinstance(shade, RejectedFrame):
        return ShadeRead(seen, payload.forecast, shade)
    foreseen, sun = foresee(payload.forecast, shade, payload.forecast_settings)
    return ShadeRead(seen, foreseen, (shade, sun))


def _method(methods: Mapping[str, Method], name: str, what: str) -> Method:
    if name not in methods:
        raise ValueError(f"{what}: expected the method {' or '.join(methods)}, got {name}")
    return methods[name]
