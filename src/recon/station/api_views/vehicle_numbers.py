"""The vehicles' numbers in a running station."""

from collections.abc import Callable, Mapping

from recon.fleet.state import Fleet
from recon.site.vehicle_numbers import with_new


class VehicleNumbers:
    """Gives each serial its number, once."""

    def __init__(
        self,
        numbers: Mapping[str, int] | None = None,
        changed: Callable[[Mapping[str, int]], None] = lambda numbers: None,
    ) -> None:
        """Take the numbers that are given already; `changed` is called with all after a new one."""
        self._numbers: Mapping[str, int] = numbers or {}
        self._changed = changed

    def of(self, fleet: Fleet) -> Mapping[str, int]:
        """Return the number of each serial: the site's vehicles first, then by first contact."""
        named = [(serial, profile.display_name) for serial, profile in fleet.profiles.items()]
        named += [(serial, vehicle.display_name) for serial, vehicle in fleet.vehicles.items()]
        numbers = with_new(self._numbers, named)
        if numbers is not self._numbers:
            self._numbers = numbers
            self._changed(numbers)
        return numbers
