"""What can be wrong with a scenario: one error, one sentence."""

from recon.model.errors import ReconError


class ScenarioError(ReconError):
    """A scenario cannot be read; the message names file, line, what was expected, what came."""
