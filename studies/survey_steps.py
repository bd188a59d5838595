"""Draws one decision of `sunlit_first` step by step, as docs/survey.md numbers them.

    python -m studies.survey_steps --out survey-steps.png

Steps 1 to 5 are one decision in the flight of `survey_decisions`. The others have scenes of their
own: a sky that closes, a vehicle without telemetry, rows that come into shade.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import cv2
import numpy as np
import shapely
from tests.guidance.survey.decisions import decided, forecast
from tests.guidance.survey.flyers import BoolArray, Flights, FloatArray

from recon.guidance.survey import ClosedArea, Surveyor, SurveyState
from recon.guidance.survey.closed_areas import closed_ground
from recon.guidance.survey.lattice import EastNorth
from recon.guidance.survey.own_share import own_share
from recon.guidance.survey.route import Route
from recon.guidance.survey.segments import Segments, expected_sun, segments_of
from recon.guidance.survey.vehicle_choice import VehicleChoice
from recon.model.shade import SunForecast
from recon.model.survey import MissionAssignment
from recon.model.units import seconds_to_ns
from studies.survey_decisions import (
    COLOURS,
    EAST_M,
    EDGE_M,
    GROUND,
    IN_SUN,
    INK,
    NORTH_M,
    PAPER,
    PX_PER_M,
    SHADE,
    Picture,
    flights_under_bands,
    out_path,
    save,
    to_px,
    write,
)

FROM_S = 136.0
COLUMNS = 4
HIGH, WIDE = round((NORTH_M + 2 * EDGE_M) * PX_PER_M), round((EAST_M + 2 * EDGE_M) * PX_PER_M)
TEXT_PX, LINE_PX = 84, 22
AHEAD_S = 60.0
FADED = (190, 190, 190)
NO_TELEMETRY = (60, 60, 200)


@dataclass(slots=True)
class Panel:
    """A canvas over the field, with lines of text below."""

    canvas: Picture
    lines: int = 0

    @classmethod
    def of(cls, title: str) -> "Panel":
        """Return the field's outline under a title."""
        panel = cls(np.full((HIGH + TEXT_PX, WIDE, 3), PAPER, dtype=np.uint8))
        corners = np.array([(0.0, 0.0), (EAST_M, 0.0), (EAST_M, NORTH_M), (0.0, NORTH_M)])
        cv2.fillPoly(panel.canvas, [to_px(corners)], GROUND)
        write(panel.canvas, title, (10, 26), INK, 0.55)
        return panel

    def outline(self) -> Picture:
        """Draw the field's edge over all else; return the finished canvas."""
        corners = np.array([(0.0, 0.0), (EAST_M, 0.0), (EAST_M, NORTH_M), (0.0, NORTH_M)])
        cv2.polylines(self.canvas, [to_px(corners)], True, INK, 1, cv2.LINE_AA)
        return self.canvas

    def says(self, text: str, colour: tuple[int, int, int] = INK) -> None:
        """Add a line of text."""
        write(self.canvas, text, (10, HIGH + 18 + LINE_PX * self.lines), colour)
        self.lines += 1

    def fill(self, state: SurveyState, segments: Segments, number: int, colour: object) -> None:
        """Fill the band of a segment."""
        part, half_m = segments.parts[number], state.plan.lattice.spacing_m / 2.0 - 1.0
        low, high = part.across_m - half_m, part.across_m + half_m
        around = [(part.start_m, low), (part.end_m, low), (part.end_m, high), (part.start_m, high)]
        cv2.fillPoly(self.canvas, [to_px(state.plan.lattice.east_north_m(around))], colour)

    def rows(self, state: SurveyState, route: Route, colour: object, thick: int = 3) -> None:
        """Draw rows."""
        for leg in route:
            ends = state.plan.lattice.east_north_m(leg.ends_m(state.plan.lattice, 0.0))
            cv2.polylines(self.canvas, [to_px(ends)], False, colour, thick, cv2.LINE_AA)

    def way(self, places_m: Sequence[EastNorth], colour: object) -> None:
        """Draw a way, with a dot at each corner."""
        points = to_px(np.array(places_m))
        cv2.polylines(self.canvas, [points], False, colour, 1, cv2.LINE_AA)
        for point in points.tolist():
            cv2.circle(self.canvas, point, 3, colour, -1, cv2.LINE_AA)

    def vehicle(self, place_m: EastNorth, colour: object) -> None:
        """Draw a vehicle."""
        (at,) = to_px(np.array([place_m])).tolist()
        cv2.circle(self.canvas, at, 8, PAPER, -1, cv2.LINE_AA)
        cv2.circle(self.canvas, at, 6, colour, -1, cv2.LINE_AA)


def next_choice(flights: Flights) -> tuple[VehicleChoice, MissionAssignment]:
    """Fly on until one vehicle alone is decided on; return what it had to choose from, and got."""
    while True:
        before, count = flights.state, len(flights.given)
        flights.run(1.0)
        if len(flights.given) == count + 1:
            break
    given = flights.given[-1]
    now_ns, segments = seconds_to_ns(flights.time_s), segments_of(flights.plan)
    sun = flights.forecast()
    expected = expected_sun(segments, flights.plan, flights.state.progress, sun, now_ns)
    assert expected is not None, "the flights have a forecast"
    vehicles = tuple(flyer.surveyor() for flyer in flights.flyers)
    own = next(each for each in vehicles if each.serial == given.serial)
    return VehicleChoice(before, segments, expected, vehicles, own, now_ns), given


def expected_panel(choice: VehicleChoice) -> Picture:
    panel = Panel.of(f"1 What is expected in {AHEAD_S:.0f} s")
    for number in np.flatnonzero(choice.expected.missing_m2 > 0.0).tolist():
        sun = choice.expected.at(number, AHEAD_S)
        mixed = sun * np.array(IN_SUN) + (1.0 - sun) * np.array(SHADE)
        panel.fill(choice.state, choice.segments, number, mixed.tolist())
    panel.says("Missing ground by segment: yellow in sun, grey in shade.")
    panel.says(f"{choice.expected.missing_m2.sum() / 1e4:.1f} ha are missing.")
    return panel.outline()


def share_panel(choice: VehicleChoice) -> Picture:
    panel = Panel.of("2 A share")
    free = choice.free()
    for index, vehicle in enumerate(choice.able):
        share = own_share(
            vehicle,
            choice.able,
            choice.state.flights,
            free,
            choice.expected,
            choice.plan,
            choice.now_ns,
        )
        for number in np.flatnonzero(share).tolist():
            panel.fill(choice.state, choice.segments, number, COLOURS[index])
        text = f"{vehicle.serial}: {choice.expected.missing_m2[share].sum() / 1e4:.2f} ha"
        panel.says(text, COLOURS[index])
    for index, vehicle in enumerate(choice.able):
        panel.vehicle(vehicle.place_m, COLOURS[index])
    return panel.outline()


def flight_panel(choice: VehicleChoice, colour: object) -> Picture:
    panel = Panel.of("3 The best flight")
    flight = choice.best(choice.share(choice.free()))
    for leg in flight.legs:
        panel.rows(choice.state, (leg.route,), colour)
        ends = choice.plan.lattice.east_north_m(leg.route.ends_m(choice.plan.lattice, 0.0))
        (at,) = to_px(ends[:1]).tolist()
        write(panel.canvas, f"{leg.from_s:.0f} s", (at[0] - 14, at[1] - 6), INK)
    panel.vehicle(choice.surveyor.place_m, colour)
    sun = np.mean([leg.probability for leg in flight.legs])
    panel.says(f"{len(flight.legs)} parts of rows in {flight.legs[-1].until_s:.0f} s,")
    panel.says(f"probability of sun {sun:.1f}. Numbers: when each begins.")
    return panel.outline()


def mission_panel(choice: VehicleChoice, colour: object) -> Picture:
    panel = Panel.of("4 A mission")
    flight = choice.best(choice.share(choice.free()))
    committed = choice.committed(flight)
    panel.rows(choice.state, [leg.route for leg in flight.legs], FADED)
    panel.rows(choice.state, choice.long_enough(committed), colour)
    panel.vehicle(choice.surveyor.place_m, colour)
    until_s = choice.settings.committed_s
    panel.says(f"What ends within {until_s:.0f} s, the first row always.")
    panel.says("Of the rest (grey) a newer forecast decides.")
    return panel.outline()


def way_panel(choice: VehicleChoice, state: SurveyState, colour: object) -> Picture:
    panel = Panel.of("5 The way there")
    flight = state.flights[choice.surveyor.serial]
    panel.rows(state, flight.route, colour)
    panel.way([choice.surveyor.place_m, *flight.corners_m], INK)
    panel.vehicle(choice.surveyor.place_m, colour)
    first = np.array(flight.corners_m[0])
    far_m = float(np.hypot(*(first - choice.surveyor.place_m)))
    near_m = choice.settings.near_m
    panel.says(
        f"{far_m:.0f} m to the first row: "
        + ("straight, at the rows' height." if far_m <= near_m else "through its own layer.")
    )
    panel.says(f"(straight within {near_m:.0f} m, if the gate approves it)")
    return panel.outline()


def battery_panel() -> Picture:
    """The sky closes in half a minute, for four; most of the battery is used."""
    closing = forecast(lambda east, _north, lead: (east < 120.0) & (lead > 240.0) | (lead < 30.0))
    own = Surveyor("S-1", (60.0, 60.0), time_left_s=500.0, keeps_battery=False)
    others = Surveyor("S-2", (180.0, 120.0)), Surveyor("S-3", (300.0, 200.0))
    state, _missions = decided(closing, own, *others)
    choice = _choice(state, closing, own, *others)
    free = choice.expected.missing_m2 > 0.0
    now, later = choice.landing_cost_and_gain(free)
    panel = Panel.of("6 When a battery is changed")
    missing_m2 = choice.expected.missing_m2[free]
    sun = missing_m2 @ choice.expected.probability[free] / missing_m2.sum()
    east = choice.expected.moments_s / choice.expected.moments_s[-1] * EAST_M
    under = [(0.0, 0.0), *zip(east.tolist(), (sun * NORTH_M).tolist(), strict=True), (EAST_M, 0.0)]
    cv2.fillPoly(panel.canvas, [to_px(np.array(under))], IN_SUN)
    write(panel.canvas, "1", (EDGE_PX - 16, EDGE_PX + 6), INK)
    write(panel.canvas, "0", (EDGE_PX - 16, HIGH - EDGE_PX), INK)
    write(panel.canvas, "now", (EDGE_PX, HIGH - EDGE_PX + 18), INK)
    write(panel.canvas, "in 5 min", (WIDE - EDGE_PX - 60, HIGH - EDGE_PX + 18), INK)
    panel.says("Sun expected on its ground (yellow) is what a change costs:")
    panel.says(f"now {now:.2f} of its time, later {later:.2f}:")
    panel.says("it " + ("returns." if now < later else "stays."))
    return panel.outline()


EDGE_PX = round(EDGE_M * PX_PER_M)


def closed_panel() -> Picture:
    """A vehicle is lost over the middle of the field; the other flies what is open."""
    clear = forecast(lambda _east, _north, _lead: True)
    own = Surveyor("S-1", (0.0, 0.0))
    lost = ClosedArea("Drone 2", "S-2", (200.0, 130.0), 60.0, (200.0, -40.0), 20.0)
    state, _missions = decided(clear, own, closed=(lost,))
    panel = Panel.of("7 Without telemetry")
    ground = shapely.get_coordinates(closed_ground([lost]).exterior)
    overlay = panel.canvas.copy()
    cv2.fillPoly(overlay, [to_px(ground)], NO_TELEMETRY)
    cv2.addWeighted(overlay, 0.35, panel.canvas, 0.65, 0.0, panel.canvas)
    panel.rows(state, state.flights["S-1"].route, COLOURS[0])
    panel.vehicle(own.place_m, COLOURS[0])
    panel.says(f"{state.decisions['S-1'].text}.", COLOURS[0])
    panel.says("Red: where Drone 2 may be, and its way home.", NO_TELEMETRY)
    return panel.outline()


def replaced_panel() -> Picture:
    """At the end of its first row the next ones lie in shade."""
    own = Surveyor("S-1", (0.0, 0.0))
    state, _missions = decided(forecast(lambda _east, _north, _lead: True), own)
    before = state.flights["S-1"]

    def shaded(_east_m: FloatArray, north_m: FloatArray, _lead_s: float) -> BoolArray:
        return np.asarray((north_m < 30.0) | (north_m > 170.0))

    lattice, swath = state.plan.lattice, state.plan.swath
    ends = lattice.east_north_m(before.route[0].ends_m(lattice, swath.lead_m)).tolist()
    for now_s, (east_m, north_m) in enumerate(ends, start=1):
        own = replace(own, place_m=(east_m, north_m))
        sun = forecast(shaded, float(now_s))
        state, _missions = decided(sun, own, state=state, now_s=float(now_s))
    panel = Panel.of("8 At the end of a row")
    band = [(0.0, 30.0), (EAST_M, 30.0), (EAST_M, 170.0), (0.0, 170.0)]
    cv2.fillPoly(panel.canvas, [to_px(np.array(band))], SHADE)
    panel.rows(state, before.route, FADED)
    panel.rows(state, state.flights["S-1"].route, COLOURS[0])
    panel.vehicle(own.place_m, COLOURS[0])
    panel.says(f"{state.decisions['S-1'].text}.", COLOURS[0])
    panel.says("Light grey: the rows that it leaves, in shade by now.")
    return panel.outline()


def _choice(state: SurveyState, sun: SunForecast, *vehicles: Surveyor) -> VehicleChoice:
    """Return what the first of the vehicles has to choose from."""
    segments = segments_of(state.plan)
    expected = expected_sun(segments, state.plan, state.progress, sun, sun.issued_at_ns)
    assert expected is not None, "there is a forecast"
    return VehicleChoice(state, segments, expected, vehicles, vehicles[0], sun.issued_at_ns)


def main() -> None:
    """Draw all steps into one file."""
    out = out_path(__doc__, "survey-steps.png")
    flights = flights_under_bands()
    flights.run(FROM_S)
    choice, given = next_choice(flights)
    colour = COLOURS[choice.able.index(choice.surveyor)]
    print(f"{flights.time_s:.0f} s, {given.serial}: {flights.state.decisions[given.serial].text}")
    panels = [
        expected_panel(choice),
        share_panel(choice),
        flight_panel(choice, colour),
        mission_panel(choice, colour),
        way_panel(choice, flights.state, colour),
        battery_panel(),
        closed_panel(),
        replaced_panel(),
    ]
    save(panels, COLUMNS, out)


if __name__ == "__main__":
    main()
