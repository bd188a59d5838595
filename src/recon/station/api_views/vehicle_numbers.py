"""The vehicles' numbers in a running station."""

from collections.abc import Callable, Mapping

from recon.fleet.state import Fleet
from recon.model.vehicle import VehicleProfile
from recon.site.vehicle_numbers import with_new

NO_PROFILES: Mapping[str, VehicleProfile] = {}


class VehicleNumbers:
    """Gives each serial its number, once; one that its profile has comes first.

    A profile's number does not replace the given one: without it the vehicle has that again.
    """

    def __init__(
        self,
        numbers: Mapping[str, int] | None = None,
        changed: Callable[[Mapping[str, int]], None] = lambda numbers: None,
    ) -> None:
        """Take the numbers that are given already; `changed` is called with all after a new one."""
        self._given: Mapping[str, int] = numbers or {}
        self._changed = changed
        self._profiles = NO_PROFILES
        self._numbers = self._given
        """Numbers in force."""

    def of(self, fleet: Fleet) -> Mapping[str, int]:
        """Return the number of each serial: the site's vehicles first, then by first contact."""
        if fleet.profiles is not self._profiles:
            self._profiles = fleet.profiles
            self._numbers = _with_fixed(self._given, fleet.profiles)
        named = [(serial, profile.display_name) for serial, profile in fleet.profiles.items()]
        named += [(serial, vehicle.display_name) for serial, vehicle in fleet.vehicles.items()]
        numbers = with_new(self._numbers, named)
        if numbers is not self._numbers:
            new = {s: n for s, n in numbers.items() if s not in self._numbers}
            self._numbers = numbers
            taken = set(new.values())
            kept = {s: n for s, n in self._given.items() if n not in taken}
            self._given = {**kept, **new}
            self._changed(self._given)
        return numbers


def _with_fixed(
    given: Mapping[str, int], profiles: Mapping[str, VehicleProfile]
) -> Mapping[str, int]:
    """Return the numbers in force, without given ones that a profile now has."""
    fixed = {serial: p.number for serial, p in profiles.items() if p.number is not None}
    if not fixed:
        return given
    taken = set(fixed.values())
    kept = {s: n for s, n in given.items() if s not in fixed and n not in taken}
    return {**kept, **fixed}
