"""Each cell against its own brightest: known shade over known ground, on seeds never tuned on."""

from dataclasses import replace

import numpy as np
import pytest
from tests.detection.flights import Watch, shade_of
from tests.detection.shaded_field import FIELD, FOOTPRINT, GRID, DriftingShade, Imager, Land

from recon.detection import DETECTORS, DetectionSettings, DetectionState
from recon.model.geo import GroundGrid
from recon.model.shade import ShadeMap

SEEDS = range(9_000, 9_002)
METHOD = "brightness_ratio"


class TestAgainstOtsu:
    """The ground's pattern is no shade; Otsu's threshold mixes the two, the ratio does not."""

    def test_few_shadows_on_a_patterned_field(self) -> None:
        ratio, single = [], []
        for seed in SEEDS:
            watch = Watch(seed, cover=0.15)
            images = watch.images()
            ratio.append(watch.mean_iou(shade_of(images, METHOD)))
            single.append(watch.mean_iou(shade_of(images, "otsu")))
        assert np.mean(ratio) > 0.8, (ratio, single)
        assert np.mean(ratio) > 2.0 * np.mean(single), (ratio, single)

    def test_many_shadows_placed_two_metres_off(self) -> None:
        ratio, single = [], []
        for seed in SEEDS:
            watch = Watch(seed, cover=0.4, placed_m=2.0)
            images = watch.images()
            ratio.append(watch.mean_iou(shade_of(images, METHOD)))
            single.append(watch.mean_iou(shade_of(images, "otsu")))
        assert np.mean(ratio) > 0.8, (ratio, single)
        assert np.mean(ratio) > np.mean(single) + 0.15, (ratio, single)


class TestExposure:
    @pytest.mark.flight
    def test_a_camera_that_halves_its_exposure_casts_no_shade(self) -> None:
        steady, followed, locked = [], [], []
        for seed in SEEDS:
            watch = Watch(seed, gains=(1.0, 0.5))
            images = watch.images()
            steady.append(watch.mean_iou(shade_of(Watch(seed).images(), METHOD)))
            followed.append(watch.mean_iou(shade_of(images, METHOD)))
            settings = DetectionSettings(follows_exposure=False)
            locked.append(watch.mean_iou(shade_of(images, METHOD, settings)))
        assert np.mean(followed) > np.mean(steady) - 0.05, (steady, followed, locked)
        assert np.mean(followed) > np.mean(locked) + 0.1, (steady, followed, locked)

    def test_an_even_dimming_of_everything_counts_as_the_cameras_unless_it_is_locked(self) -> None:
        """A documented limit; a setting decides."""
        land, clear = Land(1), DriftingShade(1, cover=0.001)
        imager = Imager()
        images = [imager.see(land, clear, 5.0 * i, 0.5 if i == 20 else 1.0) for i in range(21)]
        followed = shade_of(images, METHOD)[-1]
        locked = shade_of(images, METHOD, DetectionSettings(follows_exposure=False))[-1]
        assert followed.is_sunlit[FOOTPRINT].mean() > 0.99
        assert locked.is_sunlit[FOOTPRINT].mean() < 0.05


class TestWhatIsNotKnown:
    def test_a_cell_is_invalid_until_it_was_visible_long_enough(self) -> None:
        watch = Watch(9_100, lasts_s=30.0)
        maps = shade_of(watch.images(), METHOD)
        known = [(m.captured_at_ns / 1e9, bool(m.valid[FOOTPRINT].any())) for m in maps]
        assert [is_known for at_s, is_known in known if at_s < 15.0] == [False] * 4
        assert all(is_known for at_s, is_known in known if at_s >= 15.0)
        assert all((m.confidence[~m.valid] == 0.0).all() for m in maps)

    def test_a_field_that_does_not_change_is_never_surer_than_the_settings_say(self) -> None:
        """Clear sky, or one shadow over everything: its own past does not tell which."""
        for transmittance in (0.001, 0.999):
            land, still = Land(2), DriftingShade(2, cover=transmittance, velocity_mps=(0.0, 0.0))
            maps = shade_of([Imager().see(land, still, 2.5 * i) for i in range(60)], METHOD)
            flat = DetectionSettings().flat_confidence
            assert maps[-1].confidence[FOOTPRINT].max() < flat + 0.25
            assert np.median(maps[-1].confidence[FOOTPRINT]) < flat + 0.05
            assert maps[8].confidence[FOOTPRINT].max() < flat

    def test_where_it_is_surer_it_errs_less(self) -> None:
        sure, unsure = [], []
        for seed in SEEDS:
            watch = Watch(seed, cover=0.45, lasts_s=120.0)
            for found in shade_of(watch.images(), METHOD)[14::4]:
                is_sure = found.confidence >= np.median(found.confidence[FOOTPRINT])
                sure.append(watch.wrong_share(found, is_sure))
                unsure.append(watch.wrong_share(found, ~is_sure))
        assert np.mean(sure) < np.mean(unsure), (np.mean(sure), np.mean(unsure))

    def test_what_lies_outside_the_frames_is_never_known(self) -> None:
        for found in shade_of(Watch(9_101, lasts_s=60.0).images(), METHOD):
            assert not found.valid[:8, :8].any()
            assert np.isnan(found.transmittance[:8, :8]).all()


class TestOneGridForAll:
    def test_frames_projected_where_the_imager_drifts_to_give_maps_that_line_up(self) -> None:
        watch = Watch(9_102, lasts_s=90.0)
        land, shade = Land(watch.seed), watch.shade()
        drift_m = np.random.default_rng(5).uniform(-30.0, 30.0, (100, 2))
        images = []
        for i, at_s in enumerate(np.arange(0.0, 90.0, 2.5)):
            west_m, north_m = -256.0 + drift_m[i, 0], 256.0 + drift_m[i, 1]
            projected = GroundGrid(GRID.frame, west_m, north_m, 2.0, 256, 256)
            images.append(Imager(grid=projected).see(land, shade, at_s))
        fixed = shade_of(watch.images(), METHOD, DetectionSettings(grid=FIELD))
        moved = shade_of(images, METHOD, DetectionSettings(grid=FIELD))
        assert {m.grid for m in (*fixed, *moved)} == {FIELD}
        middle = np.s_[30:98, 30:98]
        assert moved[-1].valid[middle].all()
        assert np.mean(moved[-1].is_sunlit[middle] != fixed[-1].is_sunlit[middle]) < 0.02

    def test_without_a_grid_the_first_frames_is_kept(self) -> None:
        imager = Imager()
        images = [imager.see(Land(3), DriftingShade(3), 5.0 * i) for i in range(3)]
        shifted = replace(images[2], grid=replace(GRID, west_m=-200.0))
        maps = shade_of([*images[:2], shifted], METHOD)
        assert {m.grid for m in maps} == {FIELD}
        assert not maps[2].valid[:, :10].any()

    def test_another_imager_begins_anew(self) -> None:
        land, shade = Land(4), DriftingShade(4)
        first = [Imager().see(land, shade, 5.0 * i) for i in range(6)]
        second = [Imager(serial="IMAGER-2").see(land, shade, 30.0 + 5.0 * i) for i in range(6)]
        maps = shade_of([*first, *second], METHOD)
        assert [m.source_serials for m in maps[5:7]] == [("IMAGER",), ("IMAGER-2",)]
        assert maps[5].valid.any()
        assert not maps[6].valid.any()
        assert maps[11].valid.any()


@pytest.mark.parametrize("method", sorted(DETECTORS))
def test_memory_is_bounded(method: str) -> None:
    settings = DetectionSettings(window_s=20.0, samples=5)
    state = DetectionState()
    imager = Imager(grid=GroundGrid(GRID.frame, -256.0, 256.0, 16.0, 32, 32))
    land, shade = Land(5), DriftingShade(5)
    for i in range(120):
        image = imager.see(land, shade, 1.0 * i)
        state, found = DETECTORS[method](state, image, settings)
        assert isinstance(found, ShadeMap), found
        assert state.history is None or len(state.history.samples) <= 5
    if state.history is not None:
        assert len(state.history.samples) == 5
        assert state.history.samples[0][0] > 98e9
