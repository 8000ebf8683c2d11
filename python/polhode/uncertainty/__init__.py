"""Uncertainty: what comes from one source stays one source."""

from __future__ import annotations

from polhode.uncertainty.ledger import Ledger, Part, Shares, Sigmas, ledger

__all__ = ["Ledger", "Part", "Shares", "Sigmas", "ledger"]
