"""Settings of registration, each with its reason. Pixels are of a frame 1280 columns wide."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class RegistrationSettings:
    """Tracking, fit, acceptance and references."""

    working_cols: int = 1280
    """Wider frames are shrunk: hundreds of features give centimetres at this size already."""
    contrast_px: int = 15
    """Width of the window of local contrast: wide enough for the texture of fields, narrow against
    the edges of cloud shadow, which vanish as slow gradients."""
    contrast_floor: float = 2.0
    """Grey levels of contrast (standard deviation) below which texture is noise and stays faint."""
    most_features: int = 400
    features_apart_px: float = 12.0
    """Spreads the features over the frame: one farm does not hold most of them."""
    feature_quality: float = 0.01
    """Share of the strongest corner."""
    largest_nadir_deg: float = 66.0
    """Largest angle of features from nadir: beyond, pixels cover metres; relief displaces most."""
    rim_px: int = 8
    """Inside the image circle: a patch must not reach over its edge."""
    window_px: int = 21
    """Side of a tracked patch."""
    near_levels: int = 1
    """Halvings of the frame where a pose is roughly known: a feature may be some 10 px away."""
    coarse_levels: int = 2
    """Halvings where the pose is that of the best correlation: some 20 px."""
    far_levels: int = 3
    """Halvings where nothing better than telemetry is known: some 40 px."""
    back_px: float = 0.7
    """A feature tracked to the frame and back must end this near to where it began."""

    rotation_sigma_rad: float = 0.05
    """Error of telemetry's rotation about each axis: a gimbal in wind, a compass."""
    horizontal_sigma_m: float = 5.0
    """Error of telemetry's position against the reference frame's: the drift of GNSS."""
    vertical_sigma_m: float = 3.0
    """Error of telemetry's height against the reference frame's: the drift of the barometer."""
    feature_sigma_px: float = 0.5
    """Error of a tracked feature, relative to the prior."""

    inlier_px: float = 1.0
    """A feature farther from the fit does not support it: shadow edges, vehicles, wrong corners."""
    fewest_inliers: int = 40
    least_inlier_share: float = 0.2
    """Share of the features in view. Wrong tracks agree by chance within a pixel at 1 in 1000."""
    fewest_quadrants: int = 3
    """Fewest quadrants with inliers: fewer do not fix the tilt, as in a torn frame."""
    quadrant_inliers: int = 4
    largest_turn_rad: float = 0.2
    """Largest rotation against telemetry; more is a wrong fit."""
    largest_shift_m: float = 25.0
    """Largest shift against telemetry; more is a wrong fit."""

    lost_after_s: float = 3.0
    """Time without a registered frame."""
    new_start_after_s: float = 30.0
    """Time lost after which a new reference begins from telemetry: the drone flew elsewhere."""
    largest_speed_mps: float = 2.0
    """Largest speed of the drone where a reference begins from telemetry: a frame's capture time is
    known to a quarter of a second only, in which it would move by metres."""
    least_height_m: float = 20.0
    """Least height of the camera where a reference begins: lower, an error of height in telemetry
    is too large a share of it, and the ground seen too small."""
    references: int = 5
    """References kept; each takes about 1 MB."""
    hand_on_share: float = 0.45
    """A frame with a smaller share of inliers becomes a reference as well, while it still fits."""
    hand_on_apart_s: float = 5.0
    """Time between new references, so that one dark frame does not displace all the older ones."""
    residual_within_m: float = 195.0
    """Distance from the point below the camera: the residual is stated for the ground in use."""
