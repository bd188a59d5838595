"""The only composition root: one pure step over one queue of events, and the drivers around it."""
