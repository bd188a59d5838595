"""The field of view of a camera, from what EXIF states of its lens and sensor."""

import math

from PIL.ExifTags import Base

from recon.product.photos.exif import Tags, number_of, text_of

DIAGONAL_OF_FULL_FRAME_MM = 43.2666
UNIT_MM = {2: 25.4, 3: 10.0, 4: 1.0, 5: 0.001}
"""Millimetres per unit of FocalPlaneResolutionUnit."""
DRONE_MAKES = ("dji", "hasselblad", "autel")
"""Makers of drones whose sensors are 4:3, but for those named below."""
FILM_LIKE_MODELS = frozenset(
    ("FC6310", "FC6310R", "FC6310S", "FC3411", "FC6540", "L1D-20C", "ZENMUSEP1")
)
"""Their cameras with sensors of 3:2: of one inch, APS-C and full frame."""
FILM_LIKE_PX = 5472
"""Longer side of photos from one-inch sensors of 20 megapixels, which are 3:2, of any maker."""
FOUR_TO_THREE, FILM = 4.0 / 3.0, 3.0 / 2.0
SAME_SHAPE = 0.03
"""Pictures of 4000 x 3000 and 5280 x 3956 both count as 4:3."""


def field_deg(exif: Tags, details: Tags, cols: int, rows: int) -> float | None:
    """Return the field of view along the longer side, in degrees; None where EXIF has no lens.

    By the sensor's pixels, or by the equivalent focal length on film, which is of the diagonal of
    the whole sensor, also where the picture is cut from it.
    """
    longer, shorter = max(cols, rows), min(cols, rows)
    focal_mm = number_of(details.get(Base.FocalLength))
    wide_mm = _wide_on_sensor_mm(details, longer, shorter)
    if focal_mm and wide_mm and 1.0 <= wide_mm <= 100.0:
        return math.degrees(2.0 * math.atan(wide_mm / 2.0 / focal_mm))
    film_mm = number_of(details.get(Base.FocalLengthIn35mmFilm))
    if not film_mm:
        return None
    wide_mm = _wide_on_film_mm(longer / shorter, _sensor_shape(exif, longer, shorter))
    return math.degrees(2.0 * math.atan(wide_mm / 2.0 / film_mm))


def _wide_on_sensor_mm(details: Tags, longer: int, shorter: int) -> float | None:
    per_unit = number_of(details.get(Base.FocalPlaneXResolution))
    unit_mm = UNIT_MM.get(int(number_of(details.get(Base.FocalPlaneResolutionUnit)) or 0))
    if not per_unit or not unit_mm:
        return None
    # A picture that software made smaller keeps the resolution of the sensor, and its size there.
    sides = [number_of(details.get(tag)) for tag in (Base.ExifImageWidth, Base.ExifImageHeight)]
    taken = [each for each in sides if each is not None]
    if len(taken) == 2 and abs(max(taken) / min(taken) - longer / shorter) <= SAME_SHAPE:
        longer = max(longer, round(max(taken)))
    return longer / per_unit * unit_mm


def _sensor_shape(exif: Tags, longer: int, shorter: int) -> float:
    """Return the longer by the shorter side of the sensor that a picture was cut from."""
    make, model = (text_of(exif.get(tag)).lower() for tag in (Base.Make, Base.Model))
    picture = longer / shorter
    is_film_like = model.upper() in FILM_LIKE_MODELS or longer == FILM_LIKE_PX
    if make.startswith(DRONE_MAKES):
        return FILM if is_film_like else min(picture, FOUR_TO_THREE)
    # Other cameras' pictures are whole but for those wider than any sensor.
    return min(picture, FILM)


def _wide_on_film_mm(picture: float, sensor: float) -> float:
    """Return the picture's longer side where the sensor's diagonal is that of film."""
    wide_mm = DIAGONAL_OF_FULL_FRAME_MM * sensor / math.hypot(sensor, 1.0)
    # Wider than the sensor: cut above and below. Narrower: cut at the sides, as high as it.
    return wide_mm if picture >= sensor else wide_mm / sensor * picture
