"""Procedural farmland seen from above: laid out from a seed, drawn into tiles of pixels on demand.

Pixels carry the colour in full sun and the shadows of trees and roofs; clouds and the camera come
later. A tile is a function of seed and place, whatever was drawn before.
"""
