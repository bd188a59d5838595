"""What a camera with a timer of unknown phase sees for sure of a row that is flown."""

from dataclasses import dataclass

from recon.guidance.survey.settings import SurveySettings
from recon.model.survey import Survey


@dataclass(frozen=True, slots=True)
class Swath:
    """`half_across_m` and `half_along_m` are what counts of the footprint, `photo_m` lies between
    two photos, and `least_row_m` is the shortest way that has a photo for sure."""

    half_across_m: float
    half_along_m: float
    photo_m: float
    widest_spacing_m: float

    @property
    def inset_m(self) -> float:
        """How far inside the end of what is to be seen a row may end; negative: beyond it.

        The last photo may lie a whole photo distance before the row's end, and sees half a
        footprint on.
        """
        return self.half_along_m - self.photo_m

    @property
    def lead_m(self) -> float:
        """How far beyond its piece a row is flown at both ends, so that the piece is seen."""
        return max(0.0, -self.inset_m)

    @property
    def beyond_m(self) -> float:
        """How far beyond the ends of a piece is seen for sure."""
        return max(0.0, self.inset_m)

    @property
    def least_row_m(self) -> float:
        """The shortest way flown: a little over one photo distance, so that one falls on it."""
        return 1.05 * self.photo_m


def swath_of(survey: Survey, settings: SurveySettings) -> Swath:
    """Return a survey's swath at its height and speed."""
    camera, height_m = survey.camera, survey.height_above_takeoff_m
    across_m, along_m = camera.across_m(height_m), camera.along_m(height_m)
    half_across_m = across_m / 2.0 - settings.place_slack_m
    return Swath(
        half_across_m=half_across_m,
        half_along_m=along_m / 2.0 - settings.place_slack_m,
        photo_m=survey.speed_mps * camera.interval_s,
        widest_spacing_m=min(across_m * (1.0 - survey.side_overlap), 2.0 * half_across_m),
    )
