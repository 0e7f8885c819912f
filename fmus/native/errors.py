"""What keeps a part from being built without Python."""

from __future__ import annotations


class NativeError(Exception):
    """Names the part, platform or package, and the way out."""
