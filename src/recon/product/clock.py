"""Offset of a camera's clock, from the positions of its photos.

A photo's position is where its vehicle was at the photo's true time. So of all offsets the right
one puts the photos on the vehicle's recorded track. Theory of operation, for the photos of one
camera:

1. All offsets up to `LARGEST_OFFSET_S`, at steps of a second, against each vehicle's track: how
   many photos lie on the track, a near one counts more than a far one.
2. The best offsets are refined: the sum of squared distances of the photos on the track is least.
3. The offset is refused if another one, of this vehicle or of another, fits nearly as well (a
   hovering drone, a row flown to and fro), if the photos fix it too loosely, or if they are too
   few.
4. Photos that are off the track are looked at again without the others: one card may hold the
   photos of several drones.

The clock of a file is often in whole seconds: half a step is added to each, and the step's own
uncertainty falls with the number of photos.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np

from recon.model.arrays import BoolArray, FloatArray, IntArray
from recon.model.units import NS_PER_S
from recon.product.flight import RecordedTrack

LARGEST_OFFSET_S = 15 * 3600.0
"""Zones reach from -12 to +14 hours, daylight saving adds one; a clock 12 hours off is within."""
COARSE_STEP_S = 1.0
SCAN_STEP_S = 0.1
COARSE_M = 10.0
"""A photo this far off a track counts for e^-1/2 while offsets are searched: a drone flies so far
in a step."""
ON_TRACK_M = 6.0
"""GNSS of photo and telemetry differ by metres, telemetry is a few tenths of a second late."""
MOST_SEARCHED = 150
"""Photos are enough to find an offset's neighbourhood; all of them refine it."""
FEWEST = 5
LEAST_SHARE = 0.15
"""Share of the remaining photos that must lie on the track: else they are of another flight."""
MOST_RIVAL = 0.85
"""Share of the best offset's photos that another one may put on a track too."""
APART_S = 8.0
"""Offsets nearer than this are one."""
LARGEST_SIGMA_S = 0.5
"""Two standard deviations are a second then: shadows move 10 m."""
LONGEST_GAP_S = 3.0
"""Longest gap in a track: over a longer one the path is unknown."""
SYSTEMATIC_S = 0.1
"""Telemetry is later than the aircraft by this much, more or less."""
LEAST_SIGMA_M = 0.3
SHIFT_M = 1.5
"""Standard deviation of the shift between the positions of photos and of telemetry."""
ALIKE = 4.0
COARSEST_EXACT_S = 0.2
STATED_WITHIN_M = 30.0
"""Largest distance from the nearest vehicle for a photo with a stated offset to belong to it."""
SLOWEST_MPS = 2.0
"""Speed below which drones count as being in one place for the whole step."""


@dataclass(frozen=True, slots=True, eq=False)
class Shots:
    """Photos of one camera: time by its clock (N,), east and north (N,), step of the clock."""

    clock_ns: IntArray
    east_m: FloatArray
    north_m: FloatArray
    step_s: float

    def __len__(self) -> int:
        return len(self.clock_ns)

    def chosen(self, which: BoolArray | IntArray) -> "Shots":
        """Return some of them."""
        return Shots(self.clock_ns[which], self.east_m[which], self.north_m[which], self.step_s)


@dataclass(frozen=True, slots=True, eq=False)
class ClockFit:
    """Photos that lie on a vehicle's track when `offset_s` is added to their clock."""

    serial: str
    offset_s: float
    sigma_s: float
    """Standard deviation."""
    photos: IntArray
    """Indices of those on the track."""
    distance_m: float
    """Their median distance from the track."""
    at_ns: IntArray | None = None
    """Their station times, where their app has reported each of them."""


@dataclass(frozen=True, slots=True, eq=False)
class Clocks:
    """What was found for one camera: fits, and why the photos in no fit have none."""

    fits: tuple[ClockFit, ...]
    left: IntArray
    reason: str


def clocks_of(shots: Shots, tracks: Mapping[str, RecordedTrack], utc_ahead_ns: int) -> Clocks:
    """Return the offsets of one camera's photos to station time, in a fit for each vehicle."""
    shots = replace(
        shots, clock_ns=shots.clock_ns - utc_ahead_ns + round(shots.step_s / 2.0 * NS_PER_S)
    )
    left = np.arange(len(shots))
    fits: list[ClockFit] = []
    reason = ""
    while len(left) >= FEWEST:
        found = _best(shots.chosen(left), tracks)
        if isinstance(found, str):
            reason = found
            break
        photos = left[found.photos]
        fits.append(ClockFit(found.serial, found.offset_s, found.sigma_s, photos, found.distance_m))
        left = np.setdiff1d(left, photos)
    if len(left) and not reason:
        reason = (
            f"{len(left)} photos are off the track by more than {ON_TRACK_M:g} m"
            if fits
            else f"expected at least {FEWEST} photos of a camera, got {len(left)}"
        )
    return Clocks(tuple(fits), left, reason)


def stated_clock(
    shots: Shots, tracks: Mapping[str, RecordedTrack], utc_ahead_ns: int, offset_s: float
) -> Clocks:
    """Return the fits of a stated offset: each photo to the vehicle that was nearest then."""
    step_ns = round((offset_s + shots.step_s / 2.0) * NS_PER_S)
    at_ns = shots.clock_ns - utc_ahead_ns + step_ns
    far_m = []
    for track in tracks.values():
        east, north = places_at(track, at_ns)
        far_m.append(np.nan_to_num(np.hypot(shots.east_m - east, shots.north_m - north), nan=1e9))
    distances = np.array(far_m)
    nearest = np.argmin(distances, axis=0)
    is_near = distances.min(axis=0) <= STATED_WITHIN_M
    fits = []
    for number, serial in enumerate(tracks):
        mine = np.flatnonzero((nearest == number) & is_near)
        if len(mine):
            far = float(np.median(distances[number, mine]))
            fits.append(ClockFit(serial, offset_s, shots.step_s / np.sqrt(12.0), mine, far))
    reason = f"with the stated clock offset no vehicle was within {STATED_WITHIN_M:g} m"
    return Clocks(tuple(fits), np.flatnonzero(~is_near), reason)


@dataclass(frozen=True, slots=True)
class _Candidate:
    serial: str
    offset_s: float
    score: float


def _best(shots: Shots, tracks: Mapping[str, RecordedTrack]) -> ClockFit | str:
    """Return the one offset that fits, or the reason why not."""
    candidates = sorted(
        (each for serial, track in tracks.items() for each in _candidates(shots, serial, track)),
        key=lambda each: -each.score,
    )
    tried = (_refined(shots, tracks[each.serial], each) for each in candidates[:4])
    refined = sorted((fit for fit in tried if fit), key=lambda fit: -len(fit.photos))
    if not refined or len(refined[0].photos) < max(FEWEST, LEAST_SHARE * len(shots)):
        return _why_none(shots, tracks)
    best = refined[0]
    for other in refined[1:]:
        is_same = other.serial == best.serial and abs(other.offset_s - best.offset_s) < APART_S
        both = np.intersect1d(best.photos, other.photos)
        if not is_same and len(both) >= MOST_RIVAL * len(best.photos):
            return (
                f"two clock offsets fit equally well: {offset_text(best.offset_s)} on the track of "
                f"{best.serial} and {offset_text(other.offset_s)} on that of {other.serial}; state "
                "one with --clock-offset"
            )
    if best.sigma_s > LARGEST_SIGMA_S:
        return (
            f"the positions fix the clock offset only to {2.0 * best.sigma_s:.1f} s: the drone "
            "hardly moved; state it with --clock-offset"
        )
    return best


def _why_none(shots: Shots, tracks: Mapping[str, RecordedTrack]) -> str:
    nearest_m = min(
        float(np.hypot(t.east_m - e, t.north_m - n).min())
        for t in tracks.values()
        for e, n in zip(shots.east_m[:50].tolist(), shots.north_m[:50].tolist(), strict=True)
    )
    if nearest_m > 500.0:
        return (
            f"the photos are of another field: the nearest is {nearest_m / 1000.0:.1f} km away; "
            "choose the record of their flight"
        )
    begins = min(int(t.at_ns[0]) for t in tracks.values())
    ends = max(int(t.at_ns[-1]) for t in tracks.values())
    early_s = (begins - int(shots.clock_ns.max())) / NS_PER_S
    late_s = (int(shots.clock_ns.min()) - ends) / NS_PER_S
    if max(early_s, late_s) > LARGEST_OFFSET_S:
        side = "before" if early_s > late_s else "after"
        hours = max(early_s, late_s) / 3600.0
        return (
            f"the photos are of another day: by the camera's clock {hours:.0f} h {side} the flight"
            "; choose the record of theirs, or state the offset with --clock-offset"
        )
    return (
        "no clock offset puts the photos on a recorded track: they are of another flight; choose "
        "the record of theirs"
    )


def offset_text(seconds: float) -> str:
    """Return an offset as hours, minutes and seconds with its sign."""
    tenths = round(abs(seconds) * 10.0)
    hours, tenths = divmod(tenths, 36_000)
    minutes, tenths = divmod(tenths, 600)
    return f"{'-' if seconds < 0 else '+'}{hours} h {minutes:02d} min {tenths / 10.0:04.1f} s"


def _candidates(shots: Shots, serial: str, track: RecordedTrack) -> Iterator[_Candidate]:
    """Yield the best offsets on a vehicle's track, no two of them near each other."""
    if len(track.at_ns) < 2:
        return
    few = shots
    if len(shots) > MOST_SEARCHED:
        few = shots.chosen(np.linspace(0, len(shots) - 1, MOST_SEARCHED).astype(np.int64))
    clock_s = (few.clock_ns - track.at_ns[0]) / NS_PER_S
    table_e, table_n = _each_second(track)
    # Whole seconds of the track that each photo may be at; offsets are looked up as table indices.
    first = max(-LARGEST_OFFSET_S, float(-clock_s.max()))
    last = min(LARGEST_OFFSET_S, float(len(table_e) - clock_s.min()))
    offsets = np.arange(first, last + COARSE_STEP_S, COARSE_STEP_S)
    if len(offsets) == 0:
        return
    score = np.zeros(len(offsets))
    for at_s, east, north in zip(
        clock_s.tolist(), few.east_m.tolist(), few.north_m.tolist(), strict=True
    ):
        index = np.rint(offsets + at_s).astype(np.int64)
        is_on = (index >= 0) & (index < len(table_e))
        squared = (table_e[index[is_on]] - east) ** 2 + (table_n[index[is_on]] - north) ** 2
        score[is_on] += np.exp(-squared / (2.0 * COARSE_M**2))
    for _ in range(3):
        best = int(np.argmax(score))
        if score[best] <= 0.0:
            return
        yield _Candidate(serial, float(offsets[best]), float(score[best]))
        score[np.abs(offsets - offsets[best]) < APART_S] = 0.0


def _each_second(track: RecordedTrack) -> tuple[FloatArray, FloatArray]:
    """Return a track's places at whole seconds from its start; NaN-free, far off in gaps."""
    seconds = np.arange(0.0, (track.at_ns[-1] - track.at_ns[0]) / NS_PER_S + 1.0, COARSE_STEP_S)
    east, north = places_at(track, track.at_ns[0] + np.rint(seconds * NS_PER_S).astype(np.int64))
    return np.nan_to_num(east, nan=1e9), np.nan_to_num(north, nan=1e9)


def places_at(track: RecordedTrack, at_ns: IntArray) -> tuple[FloatArray, FloatArray]:
    """Return a track's east and north (N,) at times (N,); NaN off its ends and in gaps."""
    east = np.interp(at_ns, track.at_ns, track.east_m)
    north = np.interp(at_ns, track.at_ns, track.north_m)
    after = np.clip(np.searchsorted(track.at_ns, at_ns), 1, len(track.at_ns) - 1)
    gap_ns = track.at_ns[after] - track.at_ns[after - 1]
    is_off = (at_ns < track.at_ns[0]) | (at_ns > track.at_ns[-1])
    is_off |= gap_ns > LONGEST_GAP_S * NS_PER_S
    east[is_off], north[is_off] = np.nan, np.nan
    return east, north


def _refined(shots: Shots, track: RecordedTrack, start: _Candidate) -> ClockFit | None:
    """Return the offset near a candidate that puts the most photos nearest to the track."""
    around_s = start.offset_s + np.arange(-2.0, 2.0, SCAN_STEP_S)
    costs = [_cost(shots, track, offset_s) for offset_s in around_s.tolist()]
    offset_s = float(around_s[int(np.argmin(costs))])
    for _ in range(4):
        residual_m, speed_mps = _residuals(shots, track, offset_s)
        limit_m = ON_TRACK_M + np.hypot(*speed_mps.T) * shots.step_s / 2.0
        is_on = np.hypot(*residual_m.T) <= limit_m
        if is_on.sum() < FEWEST:
            return None
        change_s, sigma_s = _least_squares(residual_m[is_on], speed_mps[is_on])
        offset_s += change_s
    distance_m = float(np.median(np.hypot(*residual_m[is_on].T)))
    # A timer may keep all photos at one place within the clock's step.
    sigma_s = float(np.hypot(sigma_s, shots.step_s / np.sqrt(12.0)))
    return ClockFit(start.serial, offset_s, sigma_s, np.flatnonzero(is_on), distance_m)


def _least_squares(residual_m: FloatArray, speed_mps: FloatArray) -> tuple[float, float]:
    """Return the change of the offset, and its standard deviation.

    residual = speed x change + shift: the receivers of photo and telemetry may differ by a constant
    shift, which a drone that flies in one direction only cannot tell from an offset.
    """
    count = len(residual_m)
    design = np.zeros((2 * count, 3))
    design[:count, 0], design[count:, 0] = speed_mps[:, 0], speed_mps[:, 1]
    design[:count, 1] = design[count:, 2] = 1.0
    values = np.concatenate([residual_m[:, 0], residual_m[:, 1]])
    sigma_m = max(LEAST_SIGMA_M, float(np.sqrt(np.mean(values**2))))
    normal = design.T @ design / sigma_m**2 + np.diag([1e-12, SHIFT_M**-2, SHIFT_M**-2])
    inverse = np.linalg.inv(normal)
    change_s = float((inverse @ (design.T @ values))[0] / sigma_m**2)
    # Errors of neighbouring photos are alike: a few of them count as one.
    sigma_s = float(np.sqrt(ALIKE * inverse[0, 0] + SYSTEMATIC_S**2))
    return change_s, sigma_s


def _cost(shots: Shots, track: RecordedTrack, offset_s: float) -> float:
    residual_m, speed_mps = _residuals(shots, track, offset_s)
    limit_m = ON_TRACK_M + np.hypot(*speed_mps.T) * shots.step_s / 2.0
    far_m = np.minimum(np.hypot(*residual_m.T), limit_m)
    return float((far_m**2 - limit_m**2).sum())


def _residuals(
    shots: Shots, track: RecordedTrack, offset_s: float
) -> tuple[FloatArray, FloatArray]:
    """Return from track to photo, and the vehicle's velocity, each (N, 2) east and north; photos
    off the track's times are infinitely far."""
    at_ns = shots.clock_ns + round(offset_s * NS_PER_S)
    east, north = places_at(track, at_ns)
    residual_m = np.stack([shots.east_m - east, shots.north_m - north], axis=1)
    residual_m[~np.isfinite(residual_m).all(axis=1)] = np.inf
    half_ns = NS_PER_S // 2
    before, after = (places_at(track, at_ns + shift) for shift in (-half_ns, half_ns))
    speed = np.stack([after[0] - before[0], after[1] - before[1]], axis=1)
    return residual_m, np.nan_to_num(speed)


def times_of(shots: Shots, track: RecordedTrack, fit: ClockFit, utc_ahead_ns: int) -> IntArray:
    """Return the station times (N,) of a fit's photos.

    Within the step of the clock a photo was taken where its position is nearest to the track.
    """
    if fit.at_ns is not None:
        return fit.at_ns
    mine = shots.chosen(fit.photos)
    half_step_s = mine.step_s / 2.0
    at_ns = mine.clock_ns - utc_ahead_ns + round((fit.offset_s + half_step_s) * NS_PER_S)
    if mine.step_s < COARSEST_EXACT_S:
        return at_ns
    exact = Shots(at_ns, mine.east_m, mine.north_m, 0.0)
    residual_m, speed_mps = _residuals(exact, track, 0.0)
    squared = (speed_mps**2).sum(axis=1)
    along_s = (np.where(np.isfinite(residual_m), residual_m, 0.0) * speed_mps).sum(axis=1)
    along_s = np.where(squared > SLOWEST_MPS**2, along_s / np.maximum(squared, 1e-9), 0.0)
    shift_s = np.clip(along_s, -half_step_s, half_step_s)
    refined: IntArray = at_ns + np.rint(shift_s * NS_PER_S).astype(np.int64)
    return refined
