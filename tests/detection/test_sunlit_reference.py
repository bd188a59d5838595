"""Against a reference learned over the flight: known shade over known ground, and a moving sun."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
import pytest
from tests.detection.shaded_field import (
    FIELD,
    FOOTPRINT,
    GRID,
    HEIGHT_M,
    DriftingShade,
    Imager,
    Land,
    centres,
    shade_iou,
)
from tests.examples import family

from recon.detection import DETECTORS, DetectionSettings, DetectionState
from recon.detection.sunlit.belief import Belief, diffused, near, smoothed
from recon.detection.sunlit.colour import CellColour
from recon.detection.sunlit.contrast import Contrast, curve, explained
from recon.detection.sunlit.course import Course, Stack
from recon.detection.sunlit.drift import Drift, followed
from recon.detection.sunlit.hot_spot import FlatScene, HotSpot, hot_spot, with_detail
from recon.detection.sunlit.keyframes import MOST, Keyframe, SunlitLand, is_due, with_keyframe
from recon.detection.sunlit.land import land_of
from recon.detection.sunlit.levels import Level, Values
from recon.detection.sunlit.likelihood import REACH, STEPS
from recon.detection.sunlit.solution import DOUBT, HINT_SPREAD, solved
from recon.geo.sun import SunPosition
from recon.model.imagery import GroundImage
from recon.model.shade import SUNLIT_TRANSMITTANCE, ShadeMap
from recon.model.units import seconds_to_ns

METHOD = "sunlit_reference"
SHADE_RGB = np.array([0.21, 0.36, 0.50])
"""Shade over sun in linear light, measured on real frames."""
EVERY_S = 5.0
BLUE_OVER_RED = np.array([0.8, 1.0, 0.6])


@dataclass(frozen=True, slots=True)
class Flight:
    """A camera over a field whose shade is bluer than sun, as in real frames."""

    seed: int
    cover: float = 0.4
    lasts_s: float = 180.0
    every_s: float = EVERY_S
    gains: tuple[float, ...] = (1.0,)
    """Taken in turns of 30 s each."""
    balance: float = 0.0
    """Amplitude of a slow swing of blue against red."""
    hot_spot: float = 0.0
    direct: float | None = None
    """The same transmittance everywhere; None: drifting shade."""
    size_m: float = 90.0

    @property
    def shade(self) -> DriftingShade:
        return DriftingShade(self.seed + 60_000, self.cover, size_m=self.size_m, softness=0.4)

    def truth(self, at_s: float, shade: DriftingShade) -> np.ndarray:
        if self.direct is not None:
            return np.full((FIELD.rows, FIELD.cols), self.direct)
        return shade.transmittance(FIELD, at_s)

    def moments(self) -> Iterator[tuple[GroundImage, np.ndarray]]:
        """Each image and the true transmittance on the field."""
        shade, land = self.shade, Land(self.seed).reflectance(GRID)
        for at_s in np.arange(0.0, self.lasts_s, self.every_s):
            fine = (
                np.full((GRID.rows, GRID.cols), self.direct)
                if self.direct is not None
                else shade.transmittance(GRID, at_s)
            )
            yield self._image(at_s, land, fine), self.truth(at_s, shade)

    def _image(self, at_s: float, land: np.ndarray, direct: np.ndarray) -> GroundImage:
        # An afternoon's sun, 0.25 degrees a minute.
        sun = SunPosition(150.0 + 0.25 * at_s / 60.0, 55.0, 1.0).toward_enu
        east_m, north_m = centres(GRID)
        far_m = np.sqrt(east_m**2 + north_m**2 + HEIGHT_M**2)
        cosine = (HEIGHT_M * sun[2] - east_m * sun[0] - north_m * sun[1]) / far_m
        spot = self.hot_spot * np.exp(-np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0))) / 6.0)
        beam = direct[..., np.newaxis] * (1.0 + spot[..., np.newaxis])
        lit = SHADE_RGB + (1.0 - SHADE_RGB) * beam
        swing = 1.0 + self.balance * np.sin(at_s / 60.0) * np.array([-0.5, 0.0, 0.5])
        gain = self.gains[int(at_s // 30.0) % len(self.gains)]
        light = land[..., np.newaxis] * BLUE_OVER_RED * lit * 1.8 * gain * swing
        rng = np.random.default_rng([round(at_s * 1000.0), self.seed])
        levels = 255.0 * np.clip(light, 0.0, 1.0) ** (1.0 / 2.2) + rng.normal(0.0, 2.0, light.shape)
        rgb = np.clip(np.rint(levels), 0, 255).astype(np.uint8)
        return replace(Imager().image(rgb, float(at_s)), toward_sun_enu=sun)


def found_in(
    moments: Iterable[tuple[GroundImage, np.ndarray]], settings: DetectionSettings | None = None
) -> list[tuple[ShadeMap, np.ndarray]]:
    """Each shade map with the truth."""
    state, maps = DetectionState(), []
    for image, truth in moments:
        state, found = DETECTORS[METHOD](state, image, settings or DetectionSettings())
        assert isinstance(found, ShadeMap), found
        maps.append((found, truth))
    return maps


def mean_iou(maps: list[tuple[ShadeMap, np.ndarray]]) -> float:
    """Unknown counts as wrong."""
    return float(
        np.mean([shade_iou(m.is_sunlit, m.valid, t < SUNLIT_TRANSMITTANCE) for m, t in maps])
    )


def known_share(found: ShadeMap) -> float:
    return float(found.valid[FOOTPRINT].mean())


SEED = 9_200


class TestDriftingShade:
    @pytest.mark.parametrize(
        "changes",
        family({"gains": (1.0, 0.6, 1.3)}, {}, {"balance": 0.1}),
        ids=["gain", "still", "white"],
    )
    def test_shade_is_found_whatever_the_camera_does(self, changes: dict[str, object]) -> None:
        assert mean_iou(found_in(Flight(SEED, **changes).moments())[12:]) > 0.85

    @pytest.mark.flight
    def test_it_beats_the_recent_maximum_under_large_clouds(self) -> None:
        flight = Flight(9_210, cover=0.6, size_m=180.0)
        own = mean_iou(found_in(flight.moments())[12:])
        state, ratio = DetectionState(), []
        for image, truth in flight.moments():
            state, found = DETECTORS["brightness_ratio"](state, image, DetectionSettings())
            assert isinstance(found, ShadeMap)
            ratio.append((found, truth))
        assert own > mean_iou(ratio[12:]) + 0.02

    def test_transmittance_with_locked_exposure(self) -> None:
        images = (
            (replace(image, exposure_locked=True), truth)
            for image, truth in Flight(9_220).moments()
        )
        errors = [
            float(np.abs(m.transmittance - t)[FOOTPRINT & m.valid].mean())
            for m, t in found_in(images)[12:]
        ]
        assert np.mean(errors) < 0.07


def moving_shape(east_cells: float) -> np.ndarray:
    """The hot spot's shape on 40 x 40 cells, 8 cells to 1/e, so far east of the middle."""
    away = np.hypot(*np.meshgrid(np.arange(40) - 19.5 - east_cells, np.arange(40) - 19.5))
    return np.exp(-away / 8.0).astype(np.float32)


class TestFlatScenes:
    """All sun or all shade: unknown, until the hot spot tells."""

    @pytest.mark.parametrize("direct", [1.0, 0.0])
    def test_without_a_hot_spot_or_an_edge_nothing_is_known_of_the_sun(self, direct: float) -> None:
        flight = Flight(9_230, direct=direct, lasts_s=120.0)
        images = ((replace(image, toward_sun_enu=None), t) for image, t in flight.moments())
        assert max(known_share(found) for found, _ in found_in(images)) == 0.0

    @pytest.mark.flight
    def test_a_moving_hot_spot_shows_sun(self) -> None:
        last, _ = found_in(
            Flight(9_231, direct=1.0, hot_spot=0.5, lasts_s=600.0, every_s=10.0).moments()
        )[-1]
        assert known_share(last) > 0.95
        assert last.is_sunlit[FOOTPRINT & last.valid].mean() > 0.99

    @pytest.mark.flight
    def test_in_shade_sun_is_never_seen(self) -> None:
        maps = found_in(
            Flight(9_232, direct=0.0, hot_spot=0.5, lasts_s=600.0, every_s=10.0).moments()
        )
        assert max(float(found.is_sunlit[FOOTPRINT].mean()) for found, _ in maps) == 0.0

    def test_a_hot_spot_is_believed_only_with_a_small_error(self) -> None:
        assert HotSpot(0.4, 0.05, 0.3, 0.5).scene is FlatScene.UNKNOWN
        assert HotSpot(0.3, 0.02, 0.2, 0.4).scene is FlatScene.SUN
        assert HotSpot(0.0, 0.01, -0.05, 0.05).scene is FlatScene.SHADE
        assert HotSpot(0.08, 0.02, 0.05, 0.11).scene is FlatScene.UNKNOWN
        assert HotSpot(0.0, 0.03, -0.05, 0.05).scene is FlatScene.UNKNOWN

    def test_a_weak_hot_spot_is_one(self) -> None:
        """Over bright soil a tone curve leaves half of what crops have."""
        assert HotSpot(0.09, 0.003, 0.08, 0.10).scene is FlatScene.SUN

    def test_a_hot_spot_is_believed_only_with_all_its_sides(self) -> None:
        assert HotSpot(0.3, 0.02, 0.05, 0.4).scene is FlatScene.UNKNOWN
        assert HotSpot(0.0, 0.02, -0.05, 0.11).scene is FlatScene.UNKNOWN

    @pytest.mark.parametrize(("east", "scene"), [(1.0, "sun"), (0.0, "unknown")])
    def test_what_brightens_one_side_alone_is_no_hot_spot(self, east: float, scene: str) -> None:
        """Shade that leaves one side of the middle imitates a hot spot that comes there."""
        rng = np.random.default_rng(9_234)
        shapes = [moving_shape(0.5 * step) for step in range(12)]
        share = np.where(np.arange(40) < 20, 1.0, east).astype(np.float32)
        light = np.stack([0.4 * share * shape for shape in shapes])
        light += rng.normal(0.0, 0.02, light.shape).astype(np.float32)
        found = hot_spot(light, shapes)
        assert found is not None
        assert found.scene is FlatScene(scene)

    def test_frames_with_passing_shade_do_not_hide_it(self) -> None:
        rng = np.random.default_rng(9_235)
        shapes = [moving_shape(0.5 * step) for step in range(12)]
        light = np.stack([0.4 * shape for shape in shapes])
        light += rng.normal(0.0, 0.02, light.shape).astype(np.float32)
        clear = hot_spot(light, shapes)
        light[:4] += rng.normal(0.0, 0.2, (4, 40, 40)).astype(np.float32)
        disturbed = hot_spot(light, shapes)
        assert clear is not None
        assert disturbed is not None
        assert disturbed.scene is clear.scene is FlatScene.SUN
        assert disturbed.strength == pytest.approx(0.4, abs=3.0 * disturbed.standard_error)


def cells(level: Level, contrast: Contrast, shares: Sequence[float]) -> list[Values]:
    """Light and colour of a thousand cells, so many in shade, in between and in sun."""
    rng = np.random.default_rng(1)
    by_light, by_colour = curve(contrast)
    at = rng.choice([0, 20, 40], size=1000, p=shares)
    noise = rng.normal(size=(2, 1000))
    return [
        (level.light + by_light[at] + 0.05 * noise[0]).astype(np.float32),
        (level.colour + by_colour[at] + 0.035 * noise[1]).astype(np.float32),
    ]


ANYWHERE = np.zeros([2 * reach + 1 for reach in REACH], np.float32)


class TestBelief:
    """In the level of sun, of frames whose level is known."""

    TRUTH, CONTRAST = Level(-1.0, 0.2), Contrast(1.04, 0.6)

    def seen(self, shares: Sequence[float], before: Belief) -> Belief:
        frame = cells(self.TRUTH, self.CONTRAST, shares)
        return before.seen(*frame, self.CONTRAST, 10.0)

    def before(self, level: Level, spread: tuple[float, float]) -> Belief:
        return Belief(level, near(level, level, spread, 1e-9))

    @pytest.mark.parametrize("shares", [(0.4, 0.2, 0.4), (0.9, 0.05, 0.05), (0.1, 0.1, 0.8)])
    def test_an_edge_shows_the_level_whatever_was_believed(self, shares: Sequence[float]) -> None:
        found = self.seen(shares, Belief(Level(-0.7, 0.0), ANYWHERE)).estimate(self.CONTRAST)
        assert found.level.light == pytest.approx(self.TRUTH.light, abs=0.1)
        assert found.level.colour == pytest.approx(self.TRUTH.colour, abs=0.06)

    @pytest.mark.parametrize("at", [0, 2])
    def test_a_flat_frame_may_be_sun_or_shade(self, at: int) -> None:
        shares = [0.0, 0.0, 0.0]
        shares[at] = 1.0
        belief = Belief(Level(-0.7, 0.0), ANYWHERE)
        for _ in range(30):
            belief = self.seen(shares, belief.later(Level(0.0, 0.0), (0.05, 0.01)))
        assert belief.estimate(self.CONTRAST).doubt > DOUBT, "frames alike must not add up"

    @pytest.mark.parametrize("at", [0, 2])
    def test_a_flat_frame_stays_what_it_was(self, at: int) -> None:
        shares = [0.0, 0.0, 0.0]
        shares[at] = 1.0
        found = self.seen(shares, self.before(self.TRUTH, HINT_SPREAD)).estimate(self.CONTRAST)
        assert found.level.light == pytest.approx(self.TRUTH.light, abs=0.1)
        assert found.doubt < 0.01

    def test_an_edge_turns_a_frame_around(self) -> None:
        """The level before was one contrast too low: what it calls sun is shade."""
        low = Level(self.TRUTH.light - self.CONTRAST.light, self.TRUTH.colour + 0.6)
        belief = self.before(low, (0.1, 0.06))
        for _ in range(3):
            belief = self.seen((0.5, 0.1, 0.4), belief.later(Level(0.0, 0.0), (0.05, 0.01)))
        found = belief.estimate(self.CONTRAST)
        assert found.level.light == pytest.approx(self.TRUTH.light, abs=0.1)

    def test_a_later_edge_shows_what_an_earlier_flat_frame_was(self) -> None:
        """Of three frames only the last shows an edge; the camera changed by little meanwhile."""
        flat = ANYWHERE.copy()
        edge = np.full_like(ANYWHERE, -50.0)
        edge[REACH[0] + 3, REACH[1] + 2] = 0.0
        found = smoothed(np.stack([flat, flat, edge]), [(0.05, 0.02)] * 2, ANYWHERE)
        for belief in found:
            row, col = np.unravel_index(belief.argmax(), belief.shape)
            assert (row, col) == (REACH[0] + 3, REACH[1] + 2)

    @pytest.mark.parametrize("spread", [(0.0, 0.0), (0.03, 0.01), (0.2, 0.1), (0.9, 0.4)])
    def test_a_step_costs_the_more_the_farther_it_is(self, spread: tuple[float, float]) -> None:
        """As a normal distribution of that spread has it, give or take the grid."""
        known = np.full_like(ANYWHERE, -1e4)
        known[REACH] = 0.0
        found = diffused(known, spread)
        assert found[REACH] == found.max()
        along = found[REACH[0] :, REACH[1]]
        assert (np.diff(along) <= 0.0).all()
        if spread[0] > 0.1:
            steps = round(2.0 * spread[0] / STEPS[0])
            if steps < len(along):
                assert along[steps] == pytest.approx(-2.0, abs=1.5)
        assert found.min() >= -14.1, "the camera may leap"


def keyframes(
    contrast: Contrast, levels: Sequence[Level], at: Sequence[np.ndarray]
) -> tuple[Keyframe, ...]:
    """Frames over even land, with these transmittances (R, C) each."""
    rng = np.random.default_rng(6)
    by_light, by_colour = curve(contrast)
    made = []
    for i, (level, transmittance) in enumerate(zip(levels, at, strict=True)):
        index = np.rint(40.0 * transmittance).astype(int)
        noise = rng.normal(0.0, 0.02, (2, *index.shape))
        light = (level.light + by_light[index] + noise[0]).astype(np.float32)
        colour = (level.colour + by_colour[index] + noise[1]).astype(np.float32)
        frame = CellColour(light, colour, np.ones(index.shape, np.bool_), np.exp(light))
        made.append(Keyframe(seconds_to_ns(10.0 * i), frame, Level(0.0, 0.0), None))
    return tuple(made)


def moving_edge(count: int, lowest: float, highest: float) -> list[np.ndarray]:
    """A broad edge of shade that moves over the view."""
    east = np.linspace(-1.0, 1.0, 40)
    parts = [np.clip(0.5 + east + 1.5 - 3.0 * i / (count - 1), 0.0, 1.0) for i in range(count)]
    return [np.tile(lowest + (highest - lowest) * part, (40, 1)) for part in parts]


class TestCourse:
    EVEN = SunlitLand(
        np.zeros((40, 40), np.float32),
        np.zeros((40, 40), np.float32),
        np.ones((40, 40), np.bool_),
        Contrast(),
    )

    @pytest.mark.parametrize("truth", [Contrast(0.9, 0.8), Contrast(1.3, 0.5)])
    def test_contrast_and_levels_are_found_together(self, truth: Contrast) -> None:
        levels = [Level(-0.5 + 0.02 * i, 0.1) for i in range(10)]
        kept = keyframes(truth, levels, moving_edge(10, 0.0, 1.0))
        course = Course.over(Stack.of(kept, is_locked=False), self.EVEN, None)
        contrast = Contrast()
        for _ in range(6):
            contrast = course.best_contrast(contrast, Contrast())
        assert contrast.light == pytest.approx(truth.light, abs=0.15)
        assert contrast.colour == pytest.approx(truth.colour, abs=0.15)
        for belief, level in zip(course.beliefs(contrast, ANYWHERE), levels, strict=True):
            found = belief.estimate(contrast)
            assert found.level.light == pytest.approx(level.light, abs=0.12)
            assert found.doubt < 0.01

    def test_thin_cloud_in_sun_is_not_read_as_shade(self) -> None:
        """From full sun to a transmittance of 0.6: dimmer, but hardly bluer."""
        level = Level(-0.5, 0.1)
        kept = keyframes(Contrast(), [level] * 10, moving_edge(10, 0.6, 1.0))
        course = Course.over(Stack.of(kept, is_locked=False), self.EVEN, None)
        found = course.beliefs(Contrast(), ANYWHERE)[-1].estimate(Contrast())
        assert found.level.light == pytest.approx(level.light, abs=0.12)

    def test_the_brightest_ground_of_a_view_without_full_sun_is_not_taken_for_it(self) -> None:
        level = Level(-0.5, 0.1)
        kept = keyframes(Contrast(), [level] * 10, moving_edge(10, 0.1, 0.85))
        course = Course.over(Stack.of(kept, is_locked=False), self.EVEN, None)
        decided = [b.estimate(Contrast()).level for b in course.beliefs(Contrast(), ANYWHERE)]
        refined = course.refined(Contrast(), decided)[-1]
        assert refined is not None
        assert abs(refined.light - level.light) < 0.5 * abs(decided[-1].light - level.light)

    def test_levels_of_views_with_full_sun_and_full_shade_stay(self) -> None:
        level = Level(-0.5, 0.1)
        kept = keyframes(Contrast(), [level] * 10, moving_edge(10, 0.0, 1.0))
        course = Course.over(Stack.of(kept, is_locked=False), self.EVEN, None)
        for refined in course.refined(Contrast(), [level] * 10):
            assert refined is not None
            assert refined.light == pytest.approx(level.light, abs=0.06)

    def test_an_open_level_stays_open(self) -> None:
        kept = keyframes(Contrast(), [Level(-0.5, 0.1)] * 10, moving_edge(10, 0.0, 1.0))
        course = Course.over(Stack.of(kept, is_locked=False), self.EVEN, None)
        assert course.refined(Contrast(), [None] * 10) == [None] * 10


class TestContradiction:
    """An even view, known as what it is not: the hot spot has the last word."""

    def newest(self, transmittance: float, strength: float, known_off: float) -> float | None:
        """Return the level found of an even view, relative to the true one.

        All frames before were known at a level that is off by so much.
        """
        true = Level(-0.5, 0.1)
        even = [np.full((40, 40), transmittance)] * 12
        shapes = [moving_shape(0.5 * i) for i in range(12)]
        known = Level(true.light + known_off, true.colour - 0.6 * known_off)
        kept = tuple(
            replace(
                each,
                cells=replace(each.cells, light=each.cells.light + np.float32(strength) * shape),
                hot_spot=shape,
                level=known,
            )
            for each, shape in zip(keyframes(Contrast(), [true] * 12, even), shapes, strict=True)
        )
        found = solved(kept, TestCourse.EVEN, None, is_locked=False).keyframes[-1].level
        return None if found is None else found.light - true.light

    def test_what_is_known_and_not_contradicted_stays(self) -> None:
        assert self.newest(1.0, 0.3, 0.0) == pytest.approx(0.0, abs=0.1)
        assert self.newest(0.0, 0.0, 0.0) == pytest.approx(0.0, abs=0.1)

    def test_sun_that_was_known_as_shade_is_sun(self) -> None:
        assert self.newest(1.0, 0.3, Contrast().light) == pytest.approx(0.0, abs=0.2)

    def test_shade_that_was_known_as_sun_is_shade(self) -> None:
        assert self.newest(0.0, 0.0, -Contrast().light) == pytest.approx(0.0, abs=0.2)


class TestDrift:
    def frame(self, gain: float, west_by: float) -> CellColour:
        """A slope of shade that moves over even land, and an exposure."""
        east = np.arange(60.0)
        shade = np.tile(0.5 * np.sin((east + west_by) / 12.0), (50, 1))
        light = (gain - shade).astype(np.float32)
        seen = np.ones(light.shape, np.bool_)
        return CellColour(light, (0.6 * shade).astype(np.float32), seen, np.exp(light))

    def test_shade_that_moves_is_no_change_of_exposure(self) -> None:
        """One and the same slope moves on in all frames; only the last ones are exposed longer."""
        even = np.zeros((50, 60), np.float32)
        land = SunlitLand(even, even, np.ones(even.shape, np.bool_), Contrast())
        drift: Drift | None = None
        for i in range(13):
            drift = followed(drift, self.frame(0.03 * i, 3.0 * i), land, seconds_to_ns(5.0 * i))
        assert drift is not None
        assert drift.total.light == pytest.approx(0.36, abs=0.05)
        assert drift.total.colour == pytest.approx(0.0, abs=0.04)
        assert drift.motion.velocity == pytest.approx([-0.6, 0.0], abs=0.1)

    def test_across_a_gap_nothing_is_known(self) -> None:
        first = followed(None, self.frame(0.0, 0.0), None, 0)
        later = followed(first, self.frame(0.5, 0.0), None, seconds_to_ns(25.0))
        assert later.total == first.total
        soon = followed(first, self.frame(0.5, 0.0), None, seconds_to_ns(5.0))
        assert soon.total.light == pytest.approx(0.5, abs=1e-4)


class TestBrightLand:
    """Where the sensor is at its limit in full sun, a hot spot does not show."""

    def frames(self, most: float) -> tuple[list[CellColour], list[np.ndarray]]:
        down, across = np.mgrid[0:40, 0:40]
        made, shapes = [], []
        for i in range(12):
            shape = np.exp(-np.hypot(down - 20, across - 8 - 2 * i) / 5.0).astype(np.float32)
            sky = np.where(across < 24, 0.9, 0.3) * (1.0 + 0.4 * shape)
            linear = np.minimum(sky, most)
            light = np.log(linear).astype(np.float32)
            seen = np.ones(light.shape, np.bool_)
            made.append(CellColour(light, light * 0, seen, linear.astype(np.float32)))
            shapes.append(shape)
        return made, shapes

    def test_it_is_not_taken_for_shade(self) -> None:
        frames, shapes = self.frames(most=0.95)
        found = hot_spot(np.stack([with_detail(each) for each in frames]), shapes)
        assert found is None or found.scene is not FlatScene.SHADE
        plain = hot_spot(np.stack([each.light for each in frames]), shapes)
        assert plain is not None
        assert plain.strength < 0.25, "what such land shows on its own"


class TestParts:
    def test_land_is_what_stands_still(self) -> None:
        """A dark square moves over a step; the median of differences is the step alone."""
        land = np.zeros((12, 20), np.float32)
        land[:, 10:] = -0.7
        frames = np.repeat(land[np.newaxis], 9, axis=0)
        for i in range(9):
            frames[i, 3:9, 2 * i : 2 * i + 3] -= 1.0
        found = land_of(frames, np.ones((12, 20), np.bool_))
        assert np.abs(found - found[0, 0] - land).max() < 1e-3

    def test_the_curve_ends_at_the_contrast(self) -> None:
        light, colour = curve(Contrast(1.0, 0.6))
        assert (light[-1], colour[-1]) == pytest.approx((0.0, 0.0))
        assert (light[0], colour[0]) == pytest.approx((-1.0, 0.6))

    def test_light_on_the_curve_gives_its_transmittance(self) -> None:
        contrast = Contrast(1.04, 0.6)
        light, colour = (part.astype(np.float32)[np.newaxis] for part in curve(contrast))
        found, _, _ = explained(light, colour, contrast)
        assert np.abs(found[0] - np.linspace(0.0, 1.0, 41)).max() < 0.12
        assert np.abs(found[0, [0, 20, 40]] - [0.0, 0.5, 1.0]).max() < 0.04

    def test_keyframes_are_bounded_and_span_the_flight(self) -> None:
        kept: tuple[Keyframe, ...] = ()
        cells = None
        for i in range(200):
            new = Keyframe(seconds_to_ns(10.0 * i), cells, Level(0.0, 0.0), None)  # type: ignore[arg-type]
            kept = with_keyframe(kept, new)
        times_s = [each.at_ns / 1e9 for each in kept]
        assert len(kept) == MOST
        assert times_s[0] == 0.0
        assert times_s[-1] == 1990.0
        assert max(np.diff(times_s)) < 200.0

    def test_a_hot_spot_that_moves_is_kept_more_often(self) -> None:
        """A side-step lasts twenty seconds: with a keyframe in ten it would hardly be seen."""
        still, moved = np.zeros((8, 8), np.float32), np.zeros((8, 8), np.float32)
        still[2, 2] = moved[2, 4] = 1.0
        level = Level(0.0, 0.0)
        kept = tuple(
            Keyframe(seconds_to_ns(10.0 * i), None, level, still)  # type: ignore[arg-type]
            for i in range(10)
        )
        assert not is_due(kept, seconds_to_ns(94.0), still)
        assert not is_due(kept, seconds_to_ns(94.0), None)
        assert not is_due(kept, seconds_to_ns(91.9), moved)
        assert is_due(kept, seconds_to_ns(92.0), moved)
        assert is_due(kept, seconds_to_ns(100.0), still)
