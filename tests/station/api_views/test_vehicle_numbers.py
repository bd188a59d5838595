"""The numbers in a running station: kept in a file, across runs, and never over a person's edit."""

from pathlib import Path

from recon.fleet.state import Fleet
from recon.model.vehicle import VehicleProfile
from recon.site.vehicle_numbers import read_numbers
from recon.station.api_views.vehicle_numbers import VehicleNumbers


def fleet(*serials: str) -> Fleet:
    return Fleet(profiles={serial: VehicleProfile(serial) for serial in serials})


def test_numbers_survive_a_restart_whatever_comes_first(tmp_path: Path) -> None:
    path = tmp_path / "numbers.toml"
    first = VehicleNumbers(path)
    assert first.of(fleet("A", "B", "C")) == {"A": 1, "B": 2, "C": 3}
    first.write()
    again = VehicleNumbers(path)
    assert again.of(fleet("C", "D", "A")) == {"A": 1, "B": 2, "C": 3, "D": 4}
    again.write()
    assert read_numbers(path) == {"A": 1, "B": 2, "C": 3, "D": 4}


def test_a_file_changed_by_hand_is_left_alone(tmp_path: Path) -> None:
    path = tmp_path / "numbers.toml"
    numbers = VehicleNumbers(path)
    numbers.of(fleet("A"))
    numbers.write()
    edited = path.read_text().replace("number = 1", "number = 9")
    path.write_text(edited)
    assert numbers.of(fleet("A", "B")) == {"A": 1, "B": 2}
    numbers.write()
    assert path.read_text() == edited


def test_without_a_file_numbers_hold_for_the_run(tmp_path: Path) -> None:
    numbers = VehicleNumbers()
    assert numbers.of(fleet("A")) == {"A": 1}
    numbers.write()
    assert numbers.of(fleet("B", "A")) == {"A": 1, "B": 2}


def test_a_folder_that_cannot_be_written_costs_the_file_only(tmp_path: Path) -> None:
    numbers = VehicleNumbers(tmp_path / "absent" / "numbers.toml")
    assert numbers.of(fleet("A")) == {"A": 1}
    numbers.write()
    assert not (tmp_path / "absent").exists()
