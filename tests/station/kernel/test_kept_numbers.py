"""Vehicle numbers are kept in a file: across runs, and never over a person's edit."""

from contextlib import ExitStack
from pathlib import Path

from recon.fleet.state import Fleet
from recon.model.vehicle import VehicleProfile
from recon.site.vehicle_numbers import read_numbers
from recon.station.host.run import kept_numbers


def fleet(*serials: str) -> Fleet:
    return Fleet(profiles={serial: VehicleProfile(serial) for serial in serials})


def test_numbers_survive_a_restart_right_after_they_are_given(tmp_path: Path) -> None:
    path = tmp_path / "numbers.toml"
    with ExitStack() as stack:
        assert kept_numbers({}, path, stack).of(fleet("A", "B")) == {"A": 1, "B": 2}
    with ExitStack() as stack:
        assert kept_numbers(read_numbers(path), path, stack).of(fleet("C", "B")) == {
            "A": 1,
            "B": 2,
            "C": 3,
        }
    assert read_numbers(path) == {"A": 1, "B": 2, "C": 3}


def test_a_file_changed_by_hand_is_left_alone(tmp_path: Path) -> None:
    path = tmp_path / "numbers.toml"
    with ExitStack() as stack:
        numbers = kept_numbers({}, path, stack)
        edited = '[[vehicles]]\nserial = "A"\nnumber = 9\n'
        path.write_text(edited)
        assert numbers.of(fleet("A")) == {"A": 1}
    assert path.read_text() == edited


def test_a_folder_that_cannot_be_written_costs_the_file_only(tmp_path: Path) -> None:
    with ExitStack() as stack:
        numbers = kept_numbers({}, tmp_path / "absent" / "numbers.toml", stack)
        assert numbers.of(fleet("A")) == {"A": 1}
    assert not (tmp_path / "absent").exists()
