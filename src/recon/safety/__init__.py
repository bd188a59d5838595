"""The one door to the aircraft: a command is approved here or it is not sent.

`approve(command, situation) -> ApprovedCommand | Refusal` is pure and denies by default.
"""

from recon.safety.gate import ApprovedCommand, approve
from recon.safety.settings import SafetySettings
from recon.safety.situation import Claimant, Situation

__all__ = ["ApprovedCommand", "Claimant", "SafetySettings", "Situation", "approve"]
