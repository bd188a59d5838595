"""A site's air made ready for many questions."""

from recon.model.airspace import Airspace


class PreparedAirspace:
    """An airspace whose polygons are prepared once; build one for each site and keep it."""

    def __init__(self, airspace: Airspace) -> None:
        self.airspace = airspace


OPEN_AIRSPACE = PreparedAirspace(Airspace())
"""No site: no fence is known, the limits' defaults hold."""
