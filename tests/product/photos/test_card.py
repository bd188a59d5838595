"""Which files of a card are photos, and what is said of the others."""

from pathlib import Path

import pytest

from recon.model.errors import RecordError
from recon.product.photos.card import begin_own, card_of, is_own


def touched(top: Path, *names: str) -> None:
    for name in names:
        (top / name).parent.mkdir(parents=True, exist_ok=True)
        (top / name).touch()


def found(top: Path) -> tuple[list[str], dict[str, list[str]]]:
    card = card_of([top])
    left = {
        reason: [p.relative_to(top).as_posix() for p in paths]
        for reason, paths in card.left.items()
    }
    return [path.relative_to(top).as_posix() for path in card.photos], left


def test_what_systems_and_cameras_put_on_cards_is_left_out_and_named(tmp_path: Path) -> None:
    photos = ("DCIM/100MEDIA/DJI_0001.JPG", "DCIM/100MEDIA/DJI_0002.jpeg", "misc/a.jpg")
    touched(
        tmp_path,
        *photos,
        "DCIM/100MEDIA/._DJI_0001.JPG",
        "DCIM/100MEDIA/DJI_0003.MP4",
        "DCIM/100MEDIA/DJI_0001_mask.JPG",
        "__MACOSX/DCIM/DJI_0001.JPG",
        ".Trashes/501/DJI_0009.JPG",
        "$RECYCLE.BIN/x.jpg",
        "MISC/THM/100/DJI_0001.JPG",
        "DCIM/Thumbs.db",
    )
    read, left = found(tmp_path)
    assert sorted(read) == sorted(photos)
    assert {name for names in left.values() for name in names} == {
        "DCIM/100MEDIA/._DJI_0001.JPG",
        "DCIM/100MEDIA/DJI_0003.MP4",
        "DCIM/100MEDIA/DJI_0001_mask.JPG",
        "__MACOSX",
        ".Trashes",
        "$RECYCLE.BIN",
        "MISC/THM",
        "DCIM/Thumbs.db",
    }
    assert "no photos that Recon reads (.mp4)" in left


@pytest.mark.parametrize("signs", [(), (".recon-tagged",), ("progress.jsonl", "masks/a_mask.JPG")])
def test_what_recon_wrote_is_never_read_whatever_it_is_called(
    tmp_path: Path, signs: tuple[str, ...]
) -> None:
    touched(tmp_path, "a.jpg", "deep/results of May/odm/images/a.jpg")
    own = tmp_path / "deep/results of May"
    touched(own, *signs)
    if not signs:
        begin_own(own)
    assert is_own(own)
    assert not is_own(tmp_path)
    assert found(tmp_path) == (["a.jpg"], {"written by Recon": ["deep/results of May"]})
    for named in (own, own / "odm", own / "odm/images/a.jpg"):
        with pytest.raises(RecordError, match="what Recon wrote"):
            card_of([named])


def test_a_file_below_two_folders_counts_once(tmp_path: Path) -> None:
    touched(tmp_path, "card/a.jpg", "card/b.jpg")
    card = card_of([tmp_path / "card/b.jpg", tmp_path, tmp_path / "card"])
    assert card.photos == [tmp_path / "card/b.jpg", tmp_path / "card/a.jpg"]


def test_a_folder_without_photos_is_refused(tmp_path: Path) -> None:
    touched(tmp_path, ".hidden/a.jpg", "a.mp4")
    with pytest.raises(RecordError, match=r"expected photos .*got none"):
        card_of([tmp_path])
    with pytest.raises(RecordError, match="no such file"):
        card_of([tmp_path / "none"])
