"""The messages of the API. The console's types are generated from these models.

Ages are seconds at the moment the message was made (`StationState.time_ns`); a reader adds the time
since. `value: null` means unknown. Heights are above the vehicle's own takeoff point unless named
otherwise.
"""

from recon.api.schema.access import *
from recon.api.schema.flights import *
from recon.api.schema.maps import *
from recon.api.schema.message import *
from recon.api.schema.new_site import *
from recon.api.schema.orders import *
from recon.api.schema.photos import *
from recon.api.schema.replay import *
from recon.api.schema.requests import *
from recon.api.schema.site import *
from recon.api.schema.site_drawing import *
from recon.api.schema.station import *
from recon.api.schema.surveys import *
from recon.api.schema.vehicles import *
from recon.api.schema.zones import *
