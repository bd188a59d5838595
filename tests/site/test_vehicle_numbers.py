"""The numbers of vehicles: fixed by serial, read back as written, hostile files refused."""

import string
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.examples import examples

from recon.site import SiteError
from recon.site.vehicle_numbers import MAX_ENTRIES, numbers_text, read_numbers, with_new

SERIALS = st.text(string.ascii_letters + string.digits + "\"\\'=#-", min_size=1, max_size=20)


def refusal(folder: Path, text: str) -> str:
    path = folder / "numbers.toml"
    path.write_text(text)
    with pytest.raises(SiteError) as caught:
        read_numbers(path)
    return str(caught.value)


def test_the_lowest_free_number_and_the_one_of_the_name() -> None:
    met = [("C", "C"), ("A", "Drone 3"), ("B", "Birch"), ("D", "Drone 03"), ("E", "1581F5BKD22")]
    assert with_new({}, met) == {"A": 3, "C": 1, "B": 2, "D": 4, "E": 5}


def test_a_number_never_moves() -> None:
    first = with_new({}, [("A", "A"), ("B", "B")])
    later = with_new(first, [("B", "Drone 1"), ("C", "Drone 2"), ("A", "A")])
    assert later == {"A": 1, "B": 2, "C": 3}
    assert with_new(later, [("C", "any")]) is later


@given(st.lists(st.tuples(SERIALS, st.sampled_from(["", "Drone 1", "Drone 7", "x"])), max_size=30))
@settings(max_examples=examples(60))
def test_numbers_are_unique_and_start_at_one(met: list[tuple[str, str]]) -> None:
    numbers = with_new({}, met)
    assert set(numbers) == {serial for serial, _name in met}
    assert len(set(numbers.values())) == len(numbers)
    assert all(number >= 1 for number in numbers.values())


@given(st.dictionaries(SERIALS, st.integers(1, 9_999)))
@settings(max_examples=examples(60))
def test_what_is_written_is_read_back(numbers: dict[str, int]) -> None:
    unique = {number: serial for serial, number in numbers.items()}
    kept = {serial: number for number, serial in unique.items()}
    with TemporaryDirectory() as folder:
        path = Path(folder) / "numbers.toml"
        path.write_text(numbers_text(kept))
        assert read_numbers(path) == kept


def test_a_file_is_refused_with_its_entry(tmp_path: Path) -> None:
    entry = '[[vehicles]]\nserial = "{}"\nnumber = {}\n'
    assert "entry 2" in refusal(tmp_path, entry.format("A", 1) + entry.format("B", 1))
    assert "entry 2" in refusal(tmp_path, entry.format("A", 1) + entry.format("A", 2))
    assert "number" in refusal(tmp_path, entry.format("A", 0))
    assert "number" in refusal(tmp_path, entry.format("A", 10_000))
    assert "serial" in refusal(tmp_path, entry.format("has space", 1))
    assert "TOML" in refusal(tmp_path, "[[[")


def test_a_file_stays_bounded(tmp_path: Path) -> None:
    many = {f"S{number}": number for number in range(1, MAX_ENTRIES + 50)}
    path = tmp_path / "numbers.toml"
    path.write_text(numbers_text(many))
    assert len(read_numbers(path)) == MAX_ENTRIES
    assert read_numbers(tmp_path / "absent.toml") == {}
