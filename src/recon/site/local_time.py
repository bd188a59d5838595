"""Times as people at a site read them, with the offset to UTC stated."""

from datetime import UTC, date, datetime, timedelta


def local_time(utc_s: float, offset_s: float) -> datetime:
    """Return a time in UTC as the clock there shows it."""
    return datetime.fromtimestamp(utc_s, UTC).replace(tzinfo=None) + timedelta(seconds=offset_s)


def clock_text(utc_s: float, offset_s: float) -> str:
    """Return date and time there: 2025-06-01 07:40."""
    return local_time(utc_s, offset_s).strftime("%Y-%m-%d %H:%M")


def midnight_utc_s(day: date, offset_s: float) -> float:
    """Return when a day there begins, seconds after 1970 in UTC."""
    return datetime(day.year, day.month, day.day, tzinfo=UTC).timestamp() - offset_s


def offset_text(offset_s: float) -> str:
    """Return an offset to UTC: UTC+05:30."""
    minutes = round(abs(offset_s) / 60.0)
    return f"UTC{'-' if offset_s < 0 else '+'}{minutes // 60:02}:{minutes % 60:02}"
