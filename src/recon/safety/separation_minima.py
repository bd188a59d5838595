"""The distances between vehicles: the site's limits, the watchdog's minima, the gate's minima.

    watchdog minima = site limits + watchdog margin
    gate minima = watchdog minima + track error

The site's limits must be kept. The watchdog acts on predictions before they are violated, so it
raises its alarm a margin earlier. The gate keeps the watchdog's minima, and in addition the track
error of a fault-free flight: the watchdog does not hold a mission that has just passed the gate.
"""

from dataclasses import dataclass

from recon.model.airspace import FlightLimits
from recon.safety.settings import SafetySettings, WatchdogSettings


@dataclass(frozen=True, slots=True)
class SeparationMinima:
    """Two vehicles keep the one horizontally or the other vertically."""

    horizontal_m: float
    vertical_m: float


def watchdog_minima(limits: FlightLimits, settings: WatchdogSettings) -> SeparationMinima:
    """Return the minima below which the separation watchdog raises an alarm."""
    return SeparationMinima(
        limits.min_separation_horizontal_m + settings.margin_horizontal_m,
        limits.min_separation_vertical_m + settings.margin_vertical_m,
    )


def gate_minima(limits: FlightLimits, settings: SafetySettings) -> SeparationMinima:
    """Return the minima that the gate keeps along a whole predicted path."""
    watchdog, prediction = watchdog_minima(limits, settings.watchdogs), settings.prediction
    return SeparationMinima(
        watchdog.horizontal_m + prediction.track_error_horizontal_m,
        watchdog.vertical_m + prediction.track_error_vertical_m,
    )
