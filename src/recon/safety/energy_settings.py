"""The energy model's numbers, each with its reason."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class EnergySettings:
    """Loads count in hovering: 1.0 empties a full battery in the profile's endurance.

    They are on the careful side: what multirotors are measured to use, and a little more.
    """

    level_load: float = 1.25
    """Level flight: at moderate speeds cheaper than hovering, at 15 m/s up to a quarter dearer."""

    climb_load: float = 1.6
    """Lifting a drone at 2 m/s takes a quarter to a half more than holding it up."""

    sink_load: float = 1.0
    """Sinking is a little cheaper than hovering; in a gust it is not."""

    climb_mps: float = 2.0
    sink_mps: float = 2.0
    """Slower than aircraft can (2.6 and 3.2 m/s and more), for what takes longer costs more."""

    landing_mps: float = 1.5
    """Go-home's landing on average: 3 m/s high up, under 1 m/s near the ground."""

    touchdown_s: float = 15.0
    """The stop at 0.3 m, until the app has confirmed the landing, and the last of the descent."""

    home_mps: float = 8.0
    """Go-home flies at about 10 m/s, against the wind slower over the ground."""

    brake_mps2: float = 2.5
    """What the separation watchdog counts with too; a stop at a waypoint costs speed over this."""

    slowest_mps: float = 0.1
    """No leg is flown slower than this: nothing is divided by zero."""

    gimbal_s: float = 3.0
    """A mission waits at a waypoint until the gimbal has turned: 90 degrees at 30 a second."""

    wind_loads: tuple[float, ...] = (1.0, 1.2, 1.5)
    """By the aircraft's wind warning (none, wind, strong wind and worse): it leans, and flies
    farther through the air than over the ground."""

    unknown_wind_load: float = 1.2
    """An app that tells no wind is taken to be in some."""

    landing_fraction: float = 0.10
    """Left when a way home ends, reserve or not: at about this charge aircraft land by themselves,
    wherever they are."""

    nearer_m: float = 1.0
    """An order that ends this much farther from home at most does not lead away from it: a place
    being held, with its corrections."""
