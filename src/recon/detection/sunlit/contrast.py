"""What shade does to light and colour, and the transmittance that explains a cell."""

from dataclasses import dataclass
from functools import lru_cache

import cv2
import numpy as np
import numpy.typing as npt

from recon.model.arrays import FloatArray
from recon.model.shade import FloatMap

LIGHT_SPAN, LIGHT_STEP = (-2.4, 0.8), 0.04
COLOUR_SPAN, COLOUR_STEP = (-0.8, 1.6), 0.03
TRANSMITTANCES = np.linspace(0.0, 1.0, 41)
ENDS_WEIGHT = 4.0
"""Full sun and full shade are this many times as frequent as any step of 1/40 between them."""
LIGHT_NOISE, COLOUR_NOISE = 0.06, 0.045
"""Standard deviations of a cell against its reference, frames some decimetres off."""
RED_SHARE, BLUE_SHARE = -0.55, 0.45
"""How the shift of blue over red divides over the two channels."""
BRIGHTEST_SHADE = 0.95


@dataclass(frozen=True, slots=True)
class Contrast:
    """Shade against sun: natural logs, both positive."""

    light: float = 1.05
    """Log ratio of green in sun to shade, which keeps 0.35 of full light."""
    colour: float = 0.6
    """Log ratio of blue over red in shade to sun: 1.4 to 2.4 times in real frames."""

    LEAST = (0.8, 0.3)
    MOST = (1.9, 1.1)
    """Bounds (light, colour) of what is learned."""

    STEPS = (0.1, 0.08)

    def stepped(self, light: int, colour: int) -> "Contrast":
        """Return a neighbouring contrast, within the bounds."""
        return Contrast(
            self.light + light * self.STEPS[0], self.colour + colour * self.STEPS[1]
        ).bounded()

    def bounded(self) -> "Contrast":
        """Return the contrast within the bounds."""
        light, colour = np.clip((self.light, self.colour), self.LEAST, self.MOST)
        return Contrast(float(light), float(colour))


def curve(contrast: Contrast) -> tuple[FloatArray, FloatArray]:
    """Return light and colour (41,) at each of TRANSMITTANCES, relative to full sun.

    Light adds linearly: diffuse share + (1 - diffuse share) x transmittance, in each channel.
    """
    parts = []
    for share in (0.0, RED_SHARE, BLUE_SHARE):
        diffuse = min(np.exp(share * contrast.colour - contrast.light), BRIGHTEST_SHADE)
        parts.append(np.log(diffuse + (1.0 - diffuse) * TRANSMITTANCES))
    green, red, blue = parts
    return green, blue - red


@lru_cache(maxsize=32)
def _table(light: float, colour: float) -> npt.NDArray[np.float32]:
    """Return (light steps, colour steps, 3): expected transmittance, light and colour."""
    lights = np.arange(*LIGHT_SPAN, LIGHT_STEP)[:, np.newaxis, np.newaxis]
    colours = np.arange(*COLOUR_SPAN, COLOUR_STEP)[np.newaxis, :, np.newaxis]
    by_light, by_colour = curve(Contrast(light, colour))
    cost = ((lights - by_light) / LIGHT_NOISE) ** 2 + ((colours - by_colour) / COLOUR_NOISE) ** 2
    weight = np.exp(-0.5 * (cost - cost.min(axis=-1, keepdims=True)))
    weight[..., [0, -1]] *= ENDS_WEIGHT
    weight /= weight.sum(axis=-1, keepdims=True)
    means = [weight @ values for values in (TRANSMITTANCES, by_light, by_colour)]
    return np.stack(means, axis=-1).astype(np.float32)


def explained(
    light: FloatMap, colour: FloatMap, contrast: Contrast
) -> tuple[FloatMap, FloatMap, FloatMap]:
    """Return transmittance, and the light and colour that it explains, for (R, C) cells.

    Light and colour are relative to full sun. NaN gives any value.
    """
    # Rounded: few tables are ever made.
    table = _table(*(0.04 * round(part / 0.04) for part in (contrast.light, contrast.colour)))
    cols = (colour - np.float32(COLOUR_SPAN[0])) * np.float32(1.0 / COLOUR_STEP)
    rows = (light - np.float32(LIGHT_SPAN[0])) * np.float32(1.0 / LIGHT_STEP)
    found = cv2.remap(
        table,
        np.nan_to_num(cols),
        np.nan_to_num(rows),
        cv2.INTER_LINEAR,
        borderMode=cv2.BORDER_REPLICATE,
    )
    planes = cv2.split(found)
    transmittance, by_light, by_colour = (np.asarray(p, dtype=np.float32) for p in planes)
    return transmittance, by_light, by_colour
