"""Limits of a file that anyone may have written."""

LARGEST_FILE_BYTES = 16 * 1024 * 1024
LARGEST_UNPACKED_BYTES = 32 * 1024 * 1024
MOST_MEMBERS = 2_000
MOST_FEATURES = 5_000
"""More than a farm's register of fields; a site's layer holds 1,000."""
MOST_CORNERS = 10_000
"""Most corners of one shape, as in a site's layer."""
MOST_CORNERS_IN_ALL = 250_000
MOST_NAMED = 200
"""Most shapes that are named as excluded; the others are counted."""
SIMPLIFIED_WITHIN_M = 0.02
"""An outline with more corners is one driven or walked with RTK, every few centimetres."""
