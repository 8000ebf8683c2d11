"""Texts of robot files as errors and notes name them: a long one by its beginning and its length."""

from __future__ import annotations

__all__ = ["quoted", "shortened"]


def shortened(text: str, most: int = 200) -> str:
    """Give a text, or its beginning and how long it is."""
    return text if len(text) <= most else f"{text[:most]}... ({len(text)} characters)"


def quoted(text: str | None, most: int = 80) -> str:
    """Give a text between quotes alike; None where there is none."""
    if text is None or len(text) <= most:
        return repr(text)
    return f"{text[:most]!r}... ({len(text)} characters)"
