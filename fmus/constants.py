"""Constants of nature that more than one part needs, SI."""

from __future__ import annotations

VACUUM_PERMITTIVITY = 8.8541878128e-12
"""F/m, CODATA 2018."""
