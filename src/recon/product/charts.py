"""The drawings of a report, as SVG without text from outside but times and escaped names.

Colours are classes of the page's style sheet, so that drawings follow its light and dark theme.
"""

import base64
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from math import ceil, floor, log10

import cv2
import numpy as np
import numpy.typing as npt
import shapely  # type: ignore[import-untyped, unused-ignore]
from markupsafe import Markup, escape

from recon.model.arrays import FloatArray
from recon.model.geo import GroundGrid
from recon.model.units import NS_PER_S
from recon.product.coverage import ENOUGH_VIEWS
from recon.product.report import AlarmSpan, Covered, FlightReport
from recon.record.mcap.tracks import utc_text

ByteMap = npt.NDArray[np.uint8]

COLOURS = 6
"""Number of vehicle colours; further vehicles reuse them, with their name."""
WIDTH, LEFT, RIGHT = 720.0, 92.0, 8.0
"""Width of the drawings over time and its margins, in pixels of the page."""
MAP_PX = 340.0
MARGIN_M = 12.0
SCALE_PX = 34.0
"""Height below a map for the bar of the scale and the arrow to north."""
MOST_POINTS = 1500
"""Most points of one line: more are not seen."""

NOT_SHOWN, SHADE_ONLY = (122, 44, 56, 255), (116, 134, 158, 255)
SUNLIT, WELL_SUNLIT = (240, 205, 120, 255), (226, 164, 30, 255)
"""Red, green, blue, alpha; distinct in grey too, from dark to bright."""
DARKEST, BRIGHTEST = np.array([54.0, 70.0, 104.0]), np.array([255.0, 236.0, 170.0])


@dataclass(frozen=True, slots=True)
class TimeAxis:
    """Station time in ns to pixels."""

    begin_ns: int
    end_ns: int
    utc_ahead_ns: int

    def x(self, at_ns: float) -> float:
        """Return a time's place."""
        share = (at_ns - self.begin_ns) / max(1, self.end_ns - self.begin_ns)
        return LEFT + min(1.0, max(0.0, share)) * (WIDTH - LEFT - RIGHT)

    def ticks(self) -> list[tuple[float, str]]:
        """Return the places and texts of whole times, UTC."""
        begin_s = (self.begin_ns + self.utc_ahead_ns) / NS_PER_S
        end_s = (self.end_ns + self.utc_ahead_ns) / NS_PER_S
        steps = (10, 30, 60, 120, 300, 600, 900, 1800, 3600, 7200, 14400)
        step_s = next((each for each in steps if (end_s - begin_s) / each <= 9.0), 86_400)
        first = ceil(begin_s / step_s) * step_s
        shown = slice(11, 19 if step_s < 60 else 16)
        return [
            (
                self.x(at_s * NS_PER_S - self.utc_ahead_ns),
                utc_text(round(at_s) * NS_PER_S)[shown],
            )
            for at_s in np.arange(first, end_s, step_s).tolist()
        ]


def axis_of(report: FlightReport) -> TimeAxis:
    """Return the axis that all drawings over time share."""
    return TimeAxis(report.begin_ns, report.end_ns, report.flight.utc_ahead_ns)


def timeline(report: FlightReport) -> Markup:
    """Return the share of the region in sun over time, and below it each vehicle in the air."""
    axis, top, tall = axis_of(report), 8.0, 110.0
    points = [(axis.x(at_ns), top + tall * (1.0 - share)) for at_ns, share in report.cover]
    parts = [_levels(top, tall)]
    if points:
        line = _path(_thinned(points))
        parts.append(
            f'<path class="sun-area" d="{line}L{points[-1][0]:.1f} {top + tall}'
            f'L{points[0][0]:.1f} {top + tall}Z"/><path class="sun-line" d="{line}"/>'
        )
    y, names = top + tall + 20.0, list(report.airborne)
    for name in names:
        parts.append(
            f'<text class="label" x="{LEFT - 8}" y="{y + 9}">{escape(_short(name))}</text>'
        )
        for begin, end in report.airborne[name]:
            x = axis.x(begin)
            wide = max(1.0, axis.x(end) - x)
            colour = _class(report, name)
            parts.append(
                f'<rect class="bar {colour}" x="{x:.1f}" y="{y}" width="{wide:.1f}" height="10"/>'
            )
        y += 18.0
    if report.alarms:
        parts.append(f'<text class="label" x="{LEFT - 8}" y="{y + 9}">Alarms</text>')
        parts += (_alarm_mark(axis, each, y) for each in report.alarms)
        y += 18.0
    return _drawing(
        parts, axis, y + 4.0, "Share of the region in sun over time; vehicles in the air"
    )


def _alarm_mark(axis: TimeAxis, alarm: AlarmSpan, y: float) -> str:
    x = axis.x(alarm.began_ns)
    grave = "grave" if alarm.severity in ("critical", "error") else "mild"
    return f'<path class="alarm {grave}" d="M{x:.1f} {y}l5 10h-10Z"/>'


def batteries(report: FlightReport) -> Markup:
    """Return each vehicle's battery over time."""
    axis, top, tall = axis_of(report), 8.0, 120.0
    parts = [_levels(top, tall)]
    for serial, points in sorted(report.log.batteries.items()):
        line = [(axis.x(at_ns), top + tall * (1.0 - level)) for at_ns, level in points]
        colour = _class(report, report.name_of(serial))
        parts.append(f'<path class="line {colour}" d="{_path(_thinned(line))}"/>')
    return _drawing(parts, axis, top + tall + 6.0, "Batteries over time")


def _levels(top: float, tall: float) -> str:
    """Return the lines of 0, 50 and 100 %."""
    return "".join(
        f'<path class="grid" d="M{LEFT} {y:.1f}H{WIDTH - RIGHT}"/>'
        f'<text class="label" x="{LEFT - 8}" y="{y + 4:.1f}">{percent} %</text>'
        for percent in (0, 50, 100)
        for y in (top + tall * (1.0 - percent / 100.0),)
    )


def _drawing(parts: Iterable[str], axis: TimeAxis, bottom: float, title: str) -> Markup:
    ticks = "".join(
        f'<path class="grid" d="M{x:.1f} 8V{bottom:.1f}"/>'
        f'<text class="tick" x="{x:.1f}" y="{bottom + 14:.1f}">{text}</text>'
        for x, text in axis.ticks()
    )
    return Markup(
        f'<svg viewBox="0 0 {WIDTH:.0f} {bottom + 20:.0f}" role="img" aria-label="{title}">'
        f"{ticks}{''.join(parts)}</svg>"
    )


@dataclass(frozen=True, slots=True)
class MapFrame:
    """East and north in metres to pixels of a map."""

    west_m: float
    north_m: float
    px_per_m: float
    wide_px: float
    tall_px: float

    def path(self, points: FloatArray) -> str:
        """Return the path of points (N, 2)."""
        x = (points[:, 0] - self.west_m) * self.px_per_m
        y = (self.north_m - points[:, 1]) * self.px_per_m
        return _path(list(zip(x.tolist(), y.tolist(), strict=True)))


def map_frame(report: FlightReport) -> MapFrame:
    """Return the frame of all maps: the surveys' region, or all that was flown over."""
    if report.area is not None:
        west, south, east, north = report.area.bounds
    else:
        tracks = report.flight.tracks.values()
        west, east = (f(float(f(t.east_m)) for t in tracks) for f in (min, max))
        south, north = (f(float(f(t.north_m)) for t in tracks) for f in (min, max))
    west, south, east, north = west - MARGIN_M, south - MARGIN_M, east + MARGIN_M, north + MARGIN_M
    scale = MAP_PX / max(east - west, north - south)
    return MapFrame(west, north, scale, scale * (east - west), scale * (north - south))


def coverage_map(report: FlightReport, covered: Covered) -> Markup:
    """Return where photos show the region in sun."""
    image = _image(_coverage_pixels(covered), covered.sun.grid, map_frame(report))
    return _map(report, "Coverage in sun", image)


def _coverage_pixels(covered: Covered) -> ByteMap:
    shown, sunlit = covered.photos.photos, covered.photos.sunlit
    pixels = np.full((*shown.shape, 4), NOT_SHOWN, dtype=np.uint8)
    pixels[shown > 0] = SHADE_ONLY
    pixels[sunlit > 0] = SUNLIT
    pixels[sunlit >= ENOUGH_VIEWS] = WELL_SUNLIT
    pixels[~covered.region] = 0
    return pixels


def coverage_png(covered: Covered) -> bytes:
    """Return the coverage map's cells as a picture, cut to the region; one pixel if it is empty."""
    rows, cols = np.nonzero(covered.region)
    part = np.s_[min(rows, default=0) : max(rows, default=0) + 1,
                 min(cols, default=0) : max(cols, default=0) + 1]  # fmt: skip
    return _png(_coverage_pixels(covered)[part])


def sun_map(report: FlightReport, covered: Covered) -> Markup:
    """Return the share of the maps of each place that show it in sun, dark to bright."""
    share = covered.sun.share
    is_known = np.isfinite(share) & covered.region
    mixed = DARKEST + (BRIGHTEST - DARKEST) * np.nan_to_num(share)[..., np.newaxis]
    pixels = np.dstack([mixed, np.where(is_known, 255.0, 0.0)]).astype(np.uint8)
    return _map(report, "Time in sun", _image(pixels, covered.sun.grid, map_frame(report)))


def track_map(report: FlightReport) -> Markup:
    """Return the tracks of all vehicles."""
    frame, parts = map_frame(report), []
    for serial, track in report.flight.tracks.items():
        step = max(1, len(track.at_ns) // MOST_POINTS)
        points = np.column_stack([track.east_m, track.north_m])[::step]
        colour = _class(report, report.name_of(serial))
        parts.append(f'<path class="line {colour}" d="{frame.path(points)}"/>')
    return _map(report, "Tracks", "".join(parts))


def _map(report: FlightReport, title: str, inside: str) -> Markup:
    frame = map_frame(report)
    rings: list[FloatArray] = []
    if report.area is not None:
        for part in shapely.get_parts(report.area):
            if part.geom_type == "Polygon":
                rings += (np.asarray(r.coords)[:, :2] for r in (part.exterior, *part.interiors))
    outline = "".join(f'<path class="outline" d="{frame.path(ring)}Z"/>' for ring in rings)
    size = f"{frame.wide_px:.0f} {frame.tall_px + SCALE_PX:.0f}"
    return Markup(
        f'<svg class="map" viewBox="0 0 {size}" role="img" aria-label="{title}">'
        f"{inside}{outline}{_scale_bar(frame)}</svg>"
    )


def _scale_bar(frame: MapFrame) -> str:
    """Return a bar of a round length, a quarter of the map at most, and north up."""
    longest_m = frame.wide_px / frame.px_per_m / 4.0
    unit = 10.0 ** floor(log10(max(longest_m, 1.0)))
    length_m = max(each * unit for each in (1.0, 2.0, 5.0) if each * unit <= max(longest_m, unit))
    x, y, wide = 8.0, frame.tall_px + 20.0, length_m * frame.px_per_m
    north_x = frame.wide_px - 16.0
    return (
        f'<path class="scale" d="M{x} {y - 5:.1f}v5h{wide:.1f}v-5"/>'
        f'<text x="{x + wide + 8:.1f}" y="{y + 1:.1f}">{length_m:g} m</text>'
        f'<path class="north" d="M{north_x:.1f} {y - 12:.1f}l5 15l-5 -4l-5 4Z"/>'
        f'<text x="{north_x - 22:.1f}" y="{y + 1:.1f}">N</text>'
    )


def _image(pixels: ByteMap, grid: GroundGrid, frame: MapFrame) -> str:
    """Return RGBA cells (R, C, 4) as a picture at their place."""
    x = (grid.west_m - frame.west_m) * frame.px_per_m
    y = (frame.north_m - grid.north_m) * frame.px_per_m
    wide, tall = (n * grid.cell_m * frame.px_per_m for n in (grid.cols, grid.rows))
    address = "data:image/png;base64," + base64.b64encode(_png(pixels)).decode()
    return (
        f'<image class="cells" x="{x:.1f}" y="{y:.1f}" width="{wide:.1f}" height="{tall:.1f}" '
        f'preserveAspectRatio="none" href="{address}"/>'
    )


def _png(pixels: ByteMap) -> bytes:
    """Return RGBA pixels (R, C, 4) as PNG."""
    done, data = cv2.imencode(".png", cv2.cvtColor(pixels, cv2.COLOR_RGBA2BGRA))
    assert done
    return data.tobytes()


def vehicle_classes(report: FlightReport) -> Mapping[str, str]:
    """Return the colour's class of each vehicle by name."""
    names = sorted({report.name_of(serial) for serial in report.flight.tracks})
    return {name: f"v{number % COLOURS}" for number, name in enumerate(names)}


def _class(report: FlightReport, name: str) -> str:
    return vehicle_classes(report).get(name, "v-none")


def _short(name: str) -> str:
    return name if len(name) <= 14 else f"{name[:13]}…"


def _thinned(points: Sequence[tuple[float, float]]) -> Sequence[tuple[float, float]]:
    step = max(1, len(points) // MOST_POINTS)
    return [*points[::step], points[-1]] if points else []


def _path(points: Sequence[tuple[float, float]]) -> str:
    return "M" + "L".join(f"{x:.1f} {y:.1f}" for x, y in points) if points else ""
