"""Copies of a photo count once; two photos of one second are two."""

from pathlib import Path

from tests.product.made_flight import write_photo

from recon.model.units import NS_PER_S
from recon.product.photos.copies import without_copies
from recon.product.photos.photo import Photo, read_photo_facts

CLOCK_NS = 1_750_001_234 * NS_PER_S


def photo(path: Path, **changes: object) -> Photo:
    path.parent.mkdir(exist_ok=True)
    facts = {"place_m": (12.0, -34.0), "clock_ns": CLOCK_NS, "size": (16, 12)} | changes
    return read_photo_facts(write_photo(path, **facts), path.as_posix())


def kept(*photos: Photo) -> list[str]:
    left, copies = without_copies(photos)
    assert len(left) + len(copies) == len(photos)
    assert set(copies.values()) <= {each.name for each in left}
    return [Path(each.name).name for each in left]


def test_the_same_content_counts_once(tmp_path: Path) -> None:
    first = photo(tmp_path / "a.JPG", camera="")
    again = photo(tmp_path / "a copy.JPG", camera="")
    assert kept(first, again) == ["a.JPG"]


def test_an_edited_copy_counts_once_where_the_camera_has_a_serial_number(tmp_path: Path) -> None:
    first = photo(tmp_path / "a.JPG")
    edited = photo(tmp_path / "edited/a.JPG", orientation=6)
    assert kept(first, edited) == ["a.JPG"]
    nameless = (
        photo(tmp_path / "b.JPG", camera=""),
        photo(tmp_path / "more/b.JPG", camera="", orientation=6),
    )
    assert kept(*nameless) == ["b.JPG", "b.JPG"]


def test_an_edited_copy_of_another_name_is_known_by_a_clock_finer_than_a_second(
    tmp_path: Path,
) -> None:
    first = photo(tmp_path / "a.JPG", subsec="25")
    assert kept(first, photo(tmp_path / "b.JPG", subsec="25", orientation=6)) == ["a.JPG"]
    assert kept(first, photo(tmp_path / "c.JPG", subsec="75", orientation=6)) == ["a.JPG", "c.JPG"]


def test_two_photos_of_a_second_over_one_place_are_two(tmp_path: Path) -> None:
    first = photo(tmp_path / "a.JPG")
    second = photo(tmp_path / "b.JPG", orientation=6)
    third = photo(tmp_path / "c.JPG", place_m=(13.0, -34.0))
    assert kept(first, second, third) == ["a.JPG", "b.JPG", "c.JPG"]
