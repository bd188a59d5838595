"""Lines of JSON by which a command tells the station how far it is (`photo_progress.py`)."""

LINES_WANTED, LINE_MARK = "RECON_JSON_LINES", "\x1e"
"""The environment's variable that asks for lines, and what each begins with."""
