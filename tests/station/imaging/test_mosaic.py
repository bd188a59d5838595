"""The ground images of several imaging drones become one."""

from dataclasses import replace

import numpy as np

from recon.model.geo import GeoPoint, GroundGrid, LocalFrame
from recon.model.imagery import CameraPose, GroundImage, Registration
from recon.model.units import NS_PER_S
from recon.station.imaging.mosaic import mosaic, newest_images
from recon.station.state.imaging import ImagerFrames, Imaging

GRID = GroundGrid(LocalFrame(GeoPoint(41.9, -93.6, 300.0)), 0.0, 4.0, 1.0, 4, 4)


def image(serial: str, level: int, cols: slice, captured_at_s: float) -> GroundImage:
    valid = np.zeros((4, 4), np.bool_)
    valid[:, cols] = True
    rgb = np.where(valid[..., np.newaxis], np.uint8(level), np.uint8(0)).repeat(3, axis=2)
    pose = CameraPose(np.eye(3), np.array([0.0, 0.0, 120.0]))
    at_ns = round(captured_at_s * NS_PER_S)
    return GroundImage(GRID, level, at_ns, rgb, valid, pose, serial=serial)


def imaging(*images: GroundImage | None) -> Imaging:
    drones = {f"D{number}": each for number, each in enumerate(images)}
    return Imaging({s: ImagerFrames(s, ground_image=each) for s, each in drones.items()})


def test_before_any_there_is_none() -> None:
    assert newest_images(imaging(None, None)) == ()
    assert mosaic(()) is None


def test_one_alone_is_itself() -> None:
    only = image("A", 9, slice(0, 2), 5.0)
    assert mosaic(newest_images(imaging(None, only))) is only


def test_the_newest_lies_on_top_and_the_older_beside_it() -> None:
    old, new = image("A", 1, slice(0, 3), 5.0), image("B", 2, slice(2, 4), 6.0)
    images = newest_images(imaging(old, new))
    assert images == (new, old)
    one = mosaic(images)
    assert one is not None
    assert one.rgb[0, :, 0].tolist() == [1, 1, 2, 2]
    assert one.valid.all()
    assert new.rgb[0, :, 0].tolist() == [0, 0, 2, 2], "never changed in place"
    assert one.frame_id == 2
    assert one.captured_at_ns == 5 * NS_PER_S, "not younger than what it shows"


def test_it_is_aligned_as_badly_as_the_worst() -> None:
    good = replace(
        image("A", 1, slice(0, 2), 5.0),
        registration=Registration.REGISTERED,
        registration_residual_m=0.4,
        exposure_locked=True,
    )
    for worse in (Registration.LOST, Registration.UNREGISTERED):
        bad = replace(image("B", 2, slice(2, 4), 4.0), registration=worse)
        one = mosaic((good, bad))
        assert one is not None
        assert (one.registration, one.registration_residual_m) == (worse, 0.4)
        assert not one.exposure_locked


def test_an_image_far_older_is_excluded() -> None:
    """A drone that is lost leaves an image behind, which must not look like now."""
    old, new = image("A", 1, slice(0, 3), 5.0), image("B", 2, slice(2, 4), 15.1)
    assert newest_images(imaging(old, new)) == (new,)
    assert newest_images(imaging(replace(old, captured_at_ns=6 * NS_PER_S), new))[0] is new
    assert len(newest_images(imaging(replace(old, captured_at_ns=6 * NS_PER_S), new))) == 2
