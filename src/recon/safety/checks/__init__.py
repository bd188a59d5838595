"""The points of the preflight checklist, each a function of a vehicle and a situation."""
