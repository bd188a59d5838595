"""Times and bounds of the operations, each with its reason."""

from dataclasses import dataclass, field

from recon.guidance.fleet_return import FleetReturnSettings


@dataclass(frozen=True, slots=True)
class ReturnSettings:
    """Settings of fleet returns; times in seconds."""

    plan: FleetReturnSettings = field(default_factory=FleetReturnSettings)

    step_every_s: float = 0.2
    """How often the turns are checked; each flight lasts a minute or so."""

    stands_within_s: float = 12.0
    """Longest time until a held aircraft hovers: 6 s from 15 m/s, and up to 2 s to the hold."""

    telemetry_within_s: float = 3.0
    """A waiting vehicle without telemetry for so long may do anything: it is excluded."""

    judged_again_s: float = 1.0
    """A flight that the gate refuses for now is judged again after this."""

    planned_within_s: float = 20.0
    """A plan takes a tenth of a second, behind one frame's job or two. After this the worker counts
    as broken, and vehicles that hover must not wait for it."""

    planned_again_s: float = 2.0
    """Shortest time between two plans for the same vehicles, when another blocks their way."""

    gate_waits_s: float = 30.0
    """Longest time that a mission waits for telemetry or for other vehicles while no vehicle of the
    return flies before it; then the gate's refusal is final."""

    pad_clearing_s: float = 30.0
    """Shortest time between two landings at the same pad: time to carry the first vehicle away. An
    alarm requests it."""

    same_pad_m: float = 5.0
    """Pads nearer than this count as one: two vehicles do not fit."""

    moved_m: float = 10.0
    """A waiting vehicle this far from where it was has been moved by its pilot, or drifts without
    holding its position; either way it is excluded."""

    hovers_after_s: float = 3.0
    """A flight out of its mission and its landing for so long was ended by the pilot, the app or
    the aircraft."""


@dataclass(frozen=True, slots=True)
class SurveyTimes:
    """Settings of running surveys; times in seconds."""

    step_every_s: float = 1.0
    """A row takes half a minute; a second of battery counts for nothing."""

    answered_within_s: float = 30.0
    """A step takes milliseconds, behind a frame's job or two; the first of a round over 60 ha some
    tenths of a second. After this it counts as lost."""

    positions_kept: int = 4_000
    """Most positions kept between two steps: eight vehicles at 10 Hz for a step's longest time."""

    shade_maps_kept: int = 16
    """Most shade maps kept between two steps: as many as a survey itself keeps."""

    photo_overdue_intervals: float = 1.7
    """No photo on a row for so many intervals of the camera is an alarm: within two, with a look
    each half second; and a report may be late by seven tenths of one."""

    unsent_within_s: float = 60.0
    """A vehicle whose missions could not be sent for so long, for reasons that time ends otherwise,
    is stopped: its telemetry or link needs attention, and no takeoff comes as a surprise."""

    asked_again_within_s: float = 5.0
    """A planner that still needs a refused mission asks within a step or two after it may."""

    takeoff_waits_s: float = 10.0
    """A person who starts a survey expects its vehicles to take off now. One that waits longer and
    may still take off automatically is an alarm."""

    home_waits_s: float = 60.0
    """A turn to fly home comes within a minute; a vehicle that waits longer raises an alarm."""

    track_step_m: float = 5.0
    """A flown path is drawn with corners this far apart."""

    track_corners: int = 2_000
    """Most corners of one mission's track: ten kilometres."""


RETURN_SETTINGS = ReturnSettings()
SURVEY_TIMES = SurveyTimes()
