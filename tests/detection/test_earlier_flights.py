"""What one flight learns of the land serves the next one over it, and only where it fits."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
import pytest
from tests.detection.shaded_field import FIELD, DriftingShade
from tests.detection.test_sunlit_reference import METHOD, Flight, known_share, mean_iou

from recon.detection import DETECTORS, DetectionSettings, DetectionState, sunlit_reference_of
from recon.model.imagery import GroundImage
from recon.model.shade import ShadeMap, SunlitReference

SEED = 9_240
SETTINGS = DetectionSettings()
Moments = Iterator[tuple[GroundImage, np.ndarray]]


@dataclass(frozen=True, slots=True)
class Later(Flight):
    """A flight over the land of another one, under another sky."""

    sky: int = 0
    is_locked: bool = False
    tint: float = 0.0
    """Of the white balance, constant: natural log of blue over red."""

    @property
    def shade(self) -> DriftingShade:
        return DriftingShade(self.seed + 60_000 + self.sky, self.cover, softness=0.4)

    def moments(self) -> Moments:
        for image, truth in super(Later, self).moments():
            rgb = image.rgb
            if self.tint:
                levels = rgb.astype(np.float64)
                levels[..., 2] *= np.exp(self.tint / 2.2)
                rgb = np.clip(np.rint(levels), 0, 255).astype(np.uint8)
            yield replace(image, rgb=rgb, exposure_locked=self.is_locked), truth


def flown(
    moments: Moments, state: DetectionState | None = None
) -> tuple[DetectionState, list[tuple[ShadeMap, np.ndarray]], GroundImage]:
    state, maps = state or DetectionState(), []
    for image, truth in moments:
        state, found = DETECTORS[METHOD](state, image, SETTINGS)
        assert isinstance(found, ShadeMap), found
        maps.append((found, truth))
    return state, maps, image


def reference_of(flight: Flight) -> SunlitReference:
    state, _, image = flown(flight.moments())
    reference = sunlit_reference_of(state, image)
    assert reference is not None
    return reference


def knowing(*references: SunlitReference) -> DetectionState:
    return DetectionState(references=references)


FIRST = Later(SEED, lasts_s=321.0, every_s=10.0)


@pytest.fixture(scope="module")
def reference() -> SunlitReference:
    return reference_of(FIRST)


@pytest.fixture(scope="module")
def locked_reference(reference: SunlitReference) -> SunlitReference:
    """The land does not depend on the lock."""
    return replace(reference, is_exposure_locked=True)


def note_of(state: DetectionState) -> str:
    assert state.sunlit is not None
    return state.sunlit.adopted.note


class TestTheNextFlight:
    def test_it_sees_shade_from_its_first_frame_on(self, reference: SunlitReference) -> None:
        later = Later(SEED, lasts_s=15.0, sky=5, gains=(0.8,))
        _, without, _ = flown(later.moments())
        state, maps, _ = flown(later.moments(), knowing(reference))
        assert known_share(without[0][0]) == 0.0
        assert known_share(maps[0][0]) > 0.99
        assert mean_iou(maps) > 0.9
        assert "of an earlier flight" in note_of(state)

    def test_it_learns_on_from_there(self, reference: SunlitReference) -> None:
        later = replace(FIRST, sky=5)
        state, maps, image = flown(later.moments(), knowing(reference))
        assert mean_iou(maps) > 0.9
        again = sunlit_reference_of(state, image)
        assert again is not None
        assert np.nanstd(again.light - reference.light) < 0.05

    @pytest.mark.parametrize("direct", [0.0, 1.0])
    def test_a_flat_view_is_decided_by_colour_if_both_cameras_are_locked(
        self, locked_reference: SunlitReference, direct: float
    ) -> None:
        flat = Later(SEED, lasts_s=15.0, direct=direct, gains=(0.7,), is_locked=True)
        _, maps, _ = flown(flat.moments(), knowing(locked_reference))
        found, _ = maps[-1]
        assert known_share(found) > 0.99
        assert float(found.is_sunlit[found.valid].mean()) == pytest.approx(direct, abs=0.01)

    @pytest.mark.parametrize("tint", [0.25, 0.35])
    def test_a_colour_between_sun_and_shade_decides_nothing(
        self, locked_reference: SunlitReference, tint: float
    ) -> None:
        flat = Later(SEED, lasts_s=15.0, direct=1.0, is_locked=True, tint=tint)
        _, maps, _ = flown(flat.moments(), knowing(locked_reference))
        assert known_share(maps[-1][0]) == 0.0

    def test_an_automatic_white_balance_decides_nothing(
        self, reference: SunlitReference, locked_reference: SunlitReference
    ) -> None:
        flat = Later(SEED, lasts_s=15.0, direct=1.0)
        for known, is_locked in ((reference, True), (locked_reference, False)):
            moments = replace(flat, is_locked=is_locked).moments()
            _, maps, _ = flown(moments, knowing(known))
            assert known_share(maps[-1][0]) == 0.0


class TestWhatDoesNotFit:
    def test_nothing_is_kept_of_a_short_flight(self) -> None:
        state, _, image = flown(Later(SEED, lasts_s=60.0).moments())
        assert sunlit_reference_of(state, image) is None
        assert sunlit_reference_of(DetectionState(), image) is None

    @pytest.mark.parametrize(
        ("change", "said"),
        [
            ({"serial": "ANOTHER"}, "expected one of"),
            ({"grid": replace(FIELD, cell_m=FIELD.cell_m / 2.0)}, "on this ground grid"),
            ({"camera_enu_m": (60.0, 0.0, 120.0)}, "within 30 m"),
            ({"toward_sun_enu": (0.6, 0.0, 0.8)}, "with the sun within 12 degrees"),
        ],
    )
    def test_a_reference_of_something_else_is_not_used(
        self, reference: SunlitReference, change: dict[str, object], said: str
    ) -> None:
        later = Later(SEED, lasts_s=5.0, sky=5)
        other = replace(reference, **change)  # type: ignore[arg-type]
        state, maps, _ = flown(later.moments(), knowing(other))
        assert known_share(maps[0][0]) == 0.0
        assert said in note_of(state)

    def test_a_reference_of_other_cells_is_not_used(self, reference: SunlitReference) -> None:
        later = Later(SEED, lasts_s=5.0, sky=5)
        fewer = replace(reference, light=reference.light[1:], colour=reference.colour[1:])
        state, maps, _ = flown(later.moments(), knowing(fewer))
        assert known_share(maps[0][0]) == 0.0
        assert "on this ground grid" in note_of(state)

    def test_a_field_that_has_changed_since_is_learned_anew(
        self, reference: SunlitReference
    ) -> None:
        later = Later(SEED + 1, lasts_s=5.0, sky=5)
        state, maps, _ = flown(later.moments(), knowing(reference))
        assert known_share(maps[0][0]) == 0.0
        assert "the land or the light has changed" in note_of(state)

    def test_without_the_suns_direction_none_is_used(self, reference: SunlitReference) -> None:
        image, truth = next(Later(SEED, lasts_s=5.0).moments())
        sunless = replace(image, toward_sun_enu=None)
        state, _, _ = flown(iter([(sunless, truth)]), knowing(reference))
        assert "direction of the sun is unknown" in note_of(state)

    def test_the_nearest_sun_is_taken(self, reference: SunlitReference) -> None:
        far = replace(reference, toward_sun_enu=(0.6, 0.0, 0.8))
        state, _, _ = flown(Later(SEED, lasts_s=5.0).moments(), knowing(far, reference))
        assert "sun 1 degrees" in note_of(state) or "sun 0 degrees" in note_of(state)


class TestALockThatIsNone:
    @pytest.mark.parametrize("seed", range(SEED, SEED + 2))
    def test_a_locked_camera_under_clouds_is_trusted(self, seed: int) -> None:
        state, _, _ = flown(Later(seed, lasts_s=150.0, is_locked=True).moments())
        assert state.sunlit is not None
        assert state.sunlit.lock_problem == ""

    @pytest.mark.parametrize(
        ("change", "said"),
        [({"gains": (1.0, 0.75)}, "exposure changed"), ({"balance": 0.2}, "white balance changed")],
    )
    def test_one_that_changes_is_found_and_no_longer_trusted(
        self, change: dict[str, object], said: str
    ) -> None:
        flight = replace(Later(SEED, lasts_s=150.0, is_locked=True), **change)  # type: ignore[arg-type]
        state, maps, _ = flown(flight.moments())
        assert state.sunlit is not None
        assert said in state.sunlit.lock_problem
        assert mean_iou(maps[-12:]) > 0.85
