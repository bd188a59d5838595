"""Return in layers in virtual time: one layer per vehicle, two waves below a low ceiling.

Run: uv run python examples/06_call_the_fleet_home.py             (prints the landing times)
     uv run python examples/06_call_the_fleet_home.py PICTURE.svg (also plots heights over time)
"""

import sys
from collections import defaultdict
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from recon.geo import point_from_enu
from recon.model.airspace import FlightLimits, Region
from recon.model.event import FleetReturnOrdered
from recon.model.geo import GeoPoint, LocalFrame
from recon.model.vehicle import AltitudeReference, Failsafe, VehicleProfile
from recon.sim.app.app import SimulatedApp
from recon.sim.fleet import Airborne, SimulationConfig, build_fleet
from recon.site import Site
from recon.site.site import Layers
from recon.station.kernel.build import first_state
from recon.station.kernel.virtual import VirtualDriver
from recon.station.kernel.worker import JobRunner

HOME = GeoPoint(41.9012, -93.6034, 275.0)
FRAME = LocalFrame(HOME)
CEILING_M = 43.0
"""Leaves three layers: 20, 30 and 40 m."""

FIELD_M = [(-60, 150, 30), (0, 160, 38), (60, 150, 30), (-80, 220, 34), (0, 240, 30), (80, 220, 34)]
"""Initial positions of the six vehicles: east, north, up."""
PADS_M = [(45, -20), (-15, -20), (-45, -20), (75, -20), (15, -20), (-75, -20)]
SERIALS = [f"SIM-{number}" for number in range(1, 7)]

Flown = Mapping[str, Sequence[tuple[float, float]]]
COLOURS = ("#0b6e99", "#c2410c", "#4d7c0f", "#7e22ce", "#b91c1c", "#0f766e")


def site_with(pads: Mapping[str, GeoPoint]) -> Site:
    """Return a fenced site with a low ceiling and six vehicles ready to fly."""
    profiles = {
        serial: VehicleProfile(
            serial,
            waypoint_altitude=AltitudeReference.TAKEOFF,
            pad=pad,
            endurance_s=1500.0,
            go_home_height_m=35.0,
            failsafe=Failsafe.HOVER,
            camera_interval_s=2.0,
        )
        for serial, pad in pads.items()
    }
    fence = Region(np.array([(-900.0, -900.0), (900.0, -900.0), (900.0, 900.0), (-900.0, 900.0)]))
    limits = FlightLimits(max_height_above_ground_m=CEILING_M)
    return Site(
        "fleet return", FRAME, profiles=profiles, layers=Layers(boundary=fence), limits=limits
    )


def fly_home(driver: VirtualDriver, apps: Sequence[SimulatedApp]) -> Flown:
    """Return all vehicles and wait until the return is over; return their heights over time."""
    heights: dict[str, list[tuple[float, float]]] = defaultdict(list)
    driver.handle(FleetReturnOrdered(1, tuple(SERIALS), "example"))
    started_ns = driver.now_ns
    while driver.station.fleet_return is None or not driver.station.fleet_return.is_over:
        driver.run_for(0.5)
        for app in apps:
            now_s = (driver.now_ns - started_ns) / 1e9
            if app.aircraft.is_flying:
                heights[app.settings.serial].append((now_s, app.aircraft.motion.height_m))
    return heights


def main(picture: Path | None) -> None:
    """Fly, print each vehicle's wave, layer and landing time, and plot them on request."""
    places = [point_from_enu(FRAME, (*pad, 0.0)) for pad in PADS_M]
    pads = dict(zip(SERIALS, places, strict=True))
    site = site_with(pads)
    driver = VirtualDriver(first_state(site), jobs=JobRunner(site))
    config = SimulationConfig(home=HOME, vehicle_count=6, airborne=Airborne.ALL, pads=pads)
    apps = build_fleet(config, start_ns=driver.now_ns)
    for app, position, pad in zip(apps, FIELD_M, PADS_M, strict=True):
        app.aircraft.motion = app.aircraft.motion._replace(
            east_m=position[0] - pad[0],
            north_m=position[1] - pad[1],
            height_m=position[2],
        )
        app.connected(driver.now_ns)
        driver.connect(app)
    driver.run_for(3.0)
    flown = fly_home(driver, apps)
    fleet_return = driver.station.fleet_return
    for member in () if fleet_return is None else fleet_return.members.values():
        if member.flight is not None:
            print(
                f"{member.name}: wave {member.flight.wave}, {member.flight.layer_up_m:.0f} m, "
                f"{member.stage.value} after {flown[member.serial][-1][0]:.0f} s"
            )
    if picture is not None:
        picture.write_text(drawing(flown), encoding="utf-8")


def drawing(flown: Flown) -> str:
    """Return an SVG of heights over time."""
    last_s = max(points[-1][0] for points in flown.values())

    def x(seconds: float) -> float:
        return 60.0 + 700.0 * seconds / last_s

    def y(height_m: float) -> float:
        return 330.0 - 7.0 * height_m

    parts = [
        f'<text x="{x(0):.0f}" y="22">height above the pads over time, m; '
        f"ceiling {CEILING_M:g} m, layers 10 m apart</text>"
    ]
    for height_m in (0, 20, 30, 40, 43):
        dash = "" if height_m in (0, 43) else ' stroke-dasharray="3 5"'
        parts.append(
            f'<path d="M60 {y(height_m):.0f}H760" stroke="#888"{dash}/>'
            f'<text x="52" y="{y(height_m) + 5:.0f}" text-anchor="end">{height_m}</text>'
        )
    for second in range(0, int(last_s) + 1, 30):
        parts.append(f'<text x="{x(second):.0f}" y="352" text-anchor="middle">{second} s</text>')
    for points, colour in zip(flown.values(), COLOURS, strict=True):
        line = " ".join(f"{x(s):.1f},{y(h):.1f}" for s, h in points)
        parts.append(
            f'<polyline points="{line}" fill="none" stroke="{colour}" stroke-width="2.5"/>'
        )
    for (serial, points), colour in zip(flown.items(), COLOURS, strict=True):
        label_s, label_m = [point for point in points if point[1] > 18.0][-20]
        parts.append(
            f'<text x="{x(label_s):.0f}" y="{y(label_m) - 7:.0f}" fill="{colour}" '
            f'stroke="#fff" stroke-width="5" paint-order="stroke">{serial}</text>'
        )
    body = "\n".join(parts)
    return (
        '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 800 365" '
        'font-family="sans-serif" font-size="14">\n'
        f'<rect width="800" height="365" fill="#fff"/>\n{body}\n</svg>\n'
    )


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else None)
