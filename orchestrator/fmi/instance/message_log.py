"""What an instance has reported: of many messages, the first ones and the last."""

from __future__ import annotations

from ...errors import printable

WARNING = 1
FAULTY = (3, 4)
MOST_MESSAGES = 200


class MessageLog:
    """Messages of one instance with their status; `warning` is the first text of a warning."""

    def __init__(self, name: str) -> None:
        self.name = name
        self.count = 0
        self.warning = ""
        self._first: list[tuple[int, str]] = []
        self._last: tuple[int, str] | None = None
        self._last_error = ""

    def add(self, status: int, message: str) -> None:
        """Keep a message, if it has a text."""
        if not message:
            return
        self.count += 1
        if len(self._first) < MOST_MESSAGES - 1:
            self._first.append((status, self._shown(message)))
        else:
            self._last = (status, message)
        if status in FAULTY:
            self._last_error = self._shown(message)
        elif status == WARNING and not self.warning:
            self.warning = self._shown(message)

    @property
    def entries(self) -> list[tuple[int, str]]:
        """Status and text of the messages that were kept, safe to print."""
        last = [(self._last[0], self._shown(self._last[1]))] if self._last else []
        return self._first + last

    @property
    def texts(self) -> list[str]:
        """The messages that were kept, safe to print."""
        return [text for _, text in self.entries]

    def ending(self) -> str:
        """`: ` and the last error, then the last message; "" without messages."""
        if not self.count:
            return ""
        last = self.texts[-1]
        if self._last_error in ("", last):
            return f": {last}"
        return f": {self._last_error}; last message: {last}"

    def _shown(self, message: str) -> str:
        return printable(message, most=500).removeprefix(f"{self.name}: ")
