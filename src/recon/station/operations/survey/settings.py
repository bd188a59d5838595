"""The times and bounds of surveys carried on live, each with its reason."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class SurveyCarrying:
    """Times in seconds."""

    look_every_s: float = 1.0
    """A row takes half a minute; a battery's second counts for nothing."""

    answered_within_s: float = 30.0
    """A look takes milliseconds, behind a frame's work or two; the first of a round over 60 ha some
    tenths of a second. Longer than this it was lost."""

    seen_kept: int = 4_000
    """Positions between two looks: eight vehicles at 10 Hz for as long as a look may take."""

    shade_kept: int = 16
    """Shade maps between two looks: what a survey keeps itself."""

    home_waits_s: float = 60.0
    """A turn home comes within a minute; who waits longer is told to people, with why."""

    track_step_m: float = 5.0
    """A flown way is drawn with corners this far apart."""

    track_corners: int = 2_000
    """Of one mission: ten kilometres."""


SETTINGS = SurveyCarrying()
