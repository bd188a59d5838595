"""The one door to the aircraft: a command is approved here or it is not sent.

`approve(command, situation) -> ApprovedCommand | Refusal` is pure and denies by default.
"""

from recon.safety.airspace import OPEN_AIRSPACE, PreparedAirspace
from recon.safety.gate import ApprovedCommand, approve, judge, judge_parts
from recon.safety.settings import SafetySettings
from recon.safety.situation import ClaimingLink, Override, Situation, Traffic
