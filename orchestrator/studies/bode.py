"""Frequency response of a linearised scene as a picture."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ..errors import OutputError, printable
from .linear import Linear

MOST = 8


def draw(system: Linear, path: Path, frequency: float | None = None) -> Path:
    """Magnitude and phase from every input to the first outputs, two decades up to Nyquist.

    `frequency` [Hz], where a scene has one, is marked.
    """
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    nyquist = 0.5 / system.step
    low = min(0.01 * nyquist, 0.1 * frequency if frequency else np.inf)
    frequencies = np.geomspace(low, 0.5 * nyquist, 400)
    response = system.response(frequencies)
    figure, axes = pyplot.subplots(2, 1, sharex=True, figsize=(8.0, 6.0))
    for row, name in enumerate(system.outputs[:MOST]):
        for column, source in enumerate(system.inputs):
            curve = response[row, column]
            if not np.any(curve):
                continue
            label = printable(f"{source} to {name}").replace("$", r"\$")
            axes[0].loglog(frequencies, np.abs(curve), label=label)
            axes[1].semilogx(frequencies, np.degrees(np.unwrap(np.angle(curve))))
    axes[0].set_ylabel("magnitude (SI)")
    axes[1].set(ylabel="phase (deg)", xlabel="frequency (Hz)")
    for axis in axes:
        axis.grid(visible=True, which="both", alpha=0.2)
        if frequency:
            axis.axvline(frequency, color="k", ls=":", lw=0.8)
    axes[0].legend(fontsize=7)
    figure.tight_layout()
    try:
        figure.savefig(path, dpi=110)
    except (OSError, ValueError) as error:
        raise OutputError(f"{path}: cannot be drawn ({error})") from None
    finally:
        pyplot.close(figure)
    return path
