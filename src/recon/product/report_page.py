"""A flight's report as one HTML file that needs nothing else: no script, no font, no address.

All text from the record passes the template's escaping; the page forbids scripts and addresses too.
"""

from collections.abc import Sequence
from datetime import tzinfo
from importlib.resources import files
from typing import Any

from jinja2 import Environment, StrictUndefined

from recon import version
from recon.model.severity import Severity
from recon.model.units import HECTARE_M2, NS_PER_S
from recon.product import charts
from recon.product.alarm_groups import AlarmGroup, grouped
from recon.product.coverage import ENOUGH_VIEWS
from recon.product.flight_log import LEADS_S
from recon.product.local_time import LocalTime
from recon.product.mosaic.choice import Light
from recon.product.mosaic.finished import FinishedMosaic
from recon.product.report import FlightReport
from recon.product.sun_sensor import agreement_lines

MOST_DECISIONS, MOST_ALARMS = 300, 100
LEVELS = frozenset(each.value for each in Severity)
STATES = ("sunlit", "mixed", "shaded", "unknown")


def report_html(
    report: FlightReport, mosaic: FinishedMosaic | None = None, zone: tzinfo | None = None
) -> str:
    """Return the page, with a mosaic's picture if it has one.

    `zone` is of the local times; None: that of this computer.
    """
    environment = Environment(autoescape=True, undefined=StrictUndefined, trim_blocks=True)
    template = environment.from_string(
        files("recon.product").joinpath("report.html").read_text(encoding="utf-8")
    )
    return template.render(**_context(report, zone), mosaic=_mosaic(mosaic))


def _context(report: FlightReport, zone: tzinfo | None) -> dict[str, Any]:
    flight, covered = report.flight, report.covered
    local, alarms = LocalTime(zone, flight.utc_ahead_ns), grouped(report.alarms)
    classes = charts.vehicle_classes(report)
    settings = report.log.settings()
    return {
        "site": str(report.log.about.get("site") or "Flight"),
        "day": f"{local.at(report.begin_ns):%Y-%m-%d}",
        "local_begin": local.clock(report.begin_ns),
        "local_end": local.clock(report.end_ns),
        "zone": local.name(report.begin_ns),
        "begin": flight.utc(report.begin_ns)[11:19],
        "end": flight.utc(report.end_ns)[11:19],
        "trouble": flight.trouble,
        "figures": list(_figures(report)),
        "covered": covered,
        "enough": ENOUGH_VIEWS,
        "coverage_map": "" if covered is None else charts.coverage_map(report, covered),
        "sun_map": "" if covered is None else charts.sun_map(report, covered),
        "track_map": charts.track_map(report),
        "timeline": charts.timeline(report),
        "has_region": report.area is not None,
        "vehicles": list(classes.items()),
        "batteries": [_battery(report, serial) for serial in sorted(report.log.batteries)],
        "battery_chart": charts.batteries(report),
        "leads": [_lead(report, lead_s) for lead_s in sorted(report.log.leads)],
        "by_sensors": list(agreement_lines(report.by_sensors)),
        "shortest_lead": f"{LEADS_S[0]:g} s",
        "alarms": [_alarm(report, local, each) for each in alarms[:MOST_ALARMS]],
        "more_alarms": max(0, len(alarms) - MOST_ALARMS),
        "decisions": [
            {
                "local": local.clock(each.at_ns),
                "at": flight.utc(each.at_ns)[11:19],
                "text": each.text,
                "by": each.by,
            }
            for each in report.decisions[:MOST_DECISIONS]
        ],
        "more_decisions": max(0, len(report.decisions) - MOST_DECISIONS),
        "facts": list(_facts(report, settings)),
        "settings": sorted(settings.items()),
        "record": flight.path.name,
        "version": version(),
    }


def _mosaic(mosaic: FinishedMosaic | None) -> dict[str, Any] | None:
    if mosaic is None:
        return None
    return {
        "preview": mosaic.preview,
        "pixel": f"{100.0 * mosaic.resolution_m:g} cm",
        "used": mosaic.photos_used,
        "photos": mosaic.photos,
        "brightness": mosaic.brightness,
        "filled": f"{mosaic.filled_m2 / HECTARE_M2:.2f} ha" if mosaic.filled_m2 else "",
        "shares": [
            (text, f"{mosaic.percent(light):.1f}")
            for light, text in (
                (Light.SUN, "in sun"),
                (Light.SHADE, "photographed in shade only"),
                (Light.UNKNOWN, "in unknown light only"),
                (Light.MISSING, "on no photo"),
            )
        ],
    }


def _figures(report: FlightReport) -> Sequence[tuple[str, str, str, str]]:
    """Return the figures at the top: label, value, unit, and a note below them."""
    covered, rows = report.covered, list[tuple[str, str, str, str]]()
    if covered is not None and covered.region.any():
        note = "estimated" if covered.is_estimated else ""
        rows += [
            ("Region", f"{covered.area_m2 / HECTARE_M2:.1f}", "ha", ""),
            ("Photographed", f"{100.0 * covered.share(0):.0f}", "%", note),
            ("In sun on a photo", f"{100.0 * covered.share(1):.0f}", "%", note),
            (f"In sun on {ENOUGH_VIEWS} photos", f"{100.0 * covered.enough:.0f}", "%", note),
        ]
    if report.photo_states:
        sunlit = f"{report.photo_states.get('sunlit', 0)} sunlit"
        rows.append(("Photos", f"{sum(report.photo_states.values())}", "", sunlit))
    if report.mean_sun is not None:
        known, maps = len(report.cover), len(report.flight.maps)
        note = "" if known == maps else f"known in {known} of {maps} shade maps"
        rows.append(("Mean sun on the region", f"{100.0 * report.mean_sun:.0f}", "%", note))
    rows.append(("Duration", _minutes((report.end_ns - report.begin_ns) / NS_PER_S), "min", ""))
    rows.append(("In the air, together", _minutes(report.airborne_s), "min", ""))
    return rows


def _minutes(seconds: float) -> str:
    return f"{seconds / 60.0:.0f}"


def _battery(report: FlightReport, serial: str) -> dict[str, str]:
    levels = [level for _at_ns, level in report.log.batteries[serial]]
    name = report.name_of(serial)
    airborne_s = sum(end - begin for begin, end in report.airborne.get(name, ())) / NS_PER_S
    return {
        "name": name,
        "colour": charts.vehicle_classes(report).get(name, ""),
        "first": f"{100.0 * levels[0]:.0f} %",
        "lowest": f"{100.0 * min(levels):.0f} %",
        "last": f"{100.0 * levels[-1]:.0f} %",
        "airborne": f"{_minutes(airborne_s)} min" if airborne_s else "-",
    }


def _lead(report: FlightReport, lead_s: float) -> dict[str, str]:
    figures = report.log.leads[lead_s]
    return {
        "ahead": f"{lead_s:g} s" if lead_s < 60.0 else f"{lead_s / 60.0:g} min",
        "brier": f"{figures.brier:.3f}",
        "persistence": f"{figures.persistence_brier:.3f}",
        "skill": "-" if figures.skill is None else f"{figures.skill:+.2f}",
    }


def _alarm(report: FlightReport, local: LocalTime, group: AlarmGroup) -> dict[str, str]:
    first, last = group.spans[0], group.spans[-1]
    lasted_s = group.lasted_ns(report.end_ns) / NS_PER_S
    ended = "at the end" if last.ended_ns is None else local.clock(last.ended_ns)
    times = f"{len(group.spans)} times, {lasted_s:.0f} s together; the last: "
    return {
        "local": local.clock(first.began_ns),
        "began": report.flight.utc(first.began_ns)[11:19],
        "ended": ended,
        "severity": first.severity,
        "level": first.severity if first.severity in LEVELS else "",
        "count": times if len(group.spans) > 1 else "",
        "text": last.text,
    }


def _facts(report: FlightReport, settings: dict[str, str]) -> Sequence[tuple[str, str]]:
    about, flight, rows = report.log.about, report.flight, list[tuple[str, str]]()
    for each in flight.surveys:
        text = f"{each.request().height_text}, {each.speed_mps:g} m/s"
        rows.append((f"Survey {each.name}".rstrip(), text))
    if report.photo_states:
        counts = (f"{report.photo_states.get(s, 0)} {s}" for s in STATES)
        rows.append(("Photos", ", ".join(counts)))
    origin = flight.frame.origin
    rows.append(
        ("Site's origin", f"{origin.latitude_deg:.6f}, {origin.longitude_deg:.6f} (WGS84), "
         f"ground {origin.ellipsoid_height_m:g} m above the ellipsoid")
    )  # fmt: skip
    for label, name in (
        ("Shade detection", "detection.method"),
        ("Sun forecast", "forecast.method"),
    ):
        if name in settings:
            rows.append((label, settings[name]))
    rows.append(("Shade maps", f"{len(flight.maps)}"))
    software = [f"Recon {about.get('version', 'unknown')}"]
    software += (
        f"{n} {about[k]}" for n, k in (("Python", "python"), ("numpy", "numpy")) if k in about
    )
    rows.append(("Recorded by", ", ".join(software)))
    if "machine" in about:
        rows.append(("Computer", str(about["machine"])))
    return rows
