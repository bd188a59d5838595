"""The numbers in a running station: each serial keeps its own, and a new one is announced."""

from collections.abc import Mapping

from recon.fleet.state import Fleet
from recon.model.vehicle import VehicleProfile
from recon.station.api_views.vehicle_numbers import VehicleNumbers


def fleet(*serials: str) -> Fleet:
    return Fleet(profiles={serial: VehicleProfile(serial) for serial in serials})


def test_a_serial_keeps_its_number_whatever_comes_first() -> None:
    assert VehicleNumbers().of(fleet("A", "B", "C")) == {"A": 1, "B": 2, "C": 3}
    again = VehicleNumbers({"A": 1, "B": 2, "C": 3})
    assert again.of(fleet("C", "D", "A")) == {"A": 1, "B": 2, "C": 3, "D": 4}


def test_a_profiles_number_comes_first_and_the_given_one_returns_without_it() -> None:
    announced: list[Mapping[str, int]] = []
    numbers = VehicleNumbers({"A": 1, "B": 2, "GONE": 7}, announced.append)
    fixed = Fleet(profiles={"A": VehicleProfile("A", number=7), "B": VehicleProfile("B")})
    assert numbers.of(fixed) == {"A": 7, "B": 2}
    assert numbers.of(fleet("A", "B")) == {"A": 1, "B": 2, "GONE": 7}
    # GONE connects while its number is taken: it is given one that is free.
    both = Fleet(profiles={**fixed.profiles, "GONE": VehicleProfile("GONE")})
    assert numbers.of(both) == {"A": 7, "B": 2, "GONE": 1}
    assert announced == [{"B": 2, "GONE": 1}]


def test_only_a_new_vehicle_is_announced() -> None:
    announced: list[Mapping[str, int]] = []
    numbers = VehicleNumbers({"A": 1}, announced.append)
    numbers.of(fleet("A"))
    assert announced == []
    numbers.of(fleet("B", "A"))
    numbers.of(fleet("A", "B"))
    assert announced == [{"A": 1, "B": 2}]
