"""Photos registered to each other: headings of their tops, places, fields of view.

from recon.product.registration import read_grey, register

found = register(photos, read_grey)
found.views, found.residual_m, found.warnings
"""

from recon.product.registration.grey import read_grey
from recon.product.registration.heading import CameraHeading
from recon.product.registration.match import GreyImage
from recon.product.registration.registered import PhotoRegistration, register, with_headings

__all__ = [
    "CameraHeading",
    "GreyImage",
    "PhotoRegistration",
    "read_grey",
    "register",
    "with_headings",
]
