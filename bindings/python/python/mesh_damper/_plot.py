"""Pictures of a trace, with matplotlib."""

from __future__ import annotations

from importlib import import_module
from typing import Any, Literal

import numpy as np

from ._errors import InputError

#: These colours are distinguishable with any colour vision, on a light and a dark background.
MEASURED, BEFORE, AFTER = "#8a8a8a", "#d55e00", "#0072b2"
_NAMES = {"before": ("law alone", BEFORE), "after": ("augmented model", AFTER)}


def _pyplot() -> Any:
    try:
        return import_module("matplotlib.pyplot")
    except ImportError as error:
        raise ImportError("pictures need matplotlib; install it with `pip install matplotlib`") from error


def worst_block(series: dict[str, Any]) -> int:
    """Return the block with the largest error of the law alone in its representative cycle; 0 if there is no block."""
    errors = []
    for (start, stop), *_ in series["blocks"]:
        force, before = series["force"][start:stop], series["before"][start:stop]
        size = float(np.sum(force**2))
        errors.append(float(np.sum((force - before) ** 2)) / size if size > 0 else 0.0)
    return int(np.argmax(errors)) if errors else 0


def cycle_of(series: dict[str, Any], block: int | None) -> tuple[slice, str]:
    """Return the samples of a block's loop and a description of it; for a motion without blocks, all samples."""
    blocks = series["blocks"]
    if not blocks:
        return slice(None), "whole recording"
    number = worst_block(series) if block is None else block
    if not -len(blocks) <= number < len(blocks):
        raise InputError(f"block: there is no block {number}; give 0 to {len(blocks) - 1}")
    (start, stop), amplitude, frequency, held_out = blocks[number]
    return slice(start, stop), f"{amplitude:.3g} mm, {frequency:.3g} Hz" + (", held out" if held_out else "")


def traced(series: dict[str, Any], kind: Literal["all", "loop", "residual"], block: int | None, ax: Any, noise: float) -> Any:
    """Plot the loop and the residual of one recording."""
    if kind not in ("all", "loop", "residual"):
        raise InputError(f"kind: no picture is called {kind!r}; give all, loop or residual")
    if kind == "all":
        if ax is not None:
            raise InputError("ax: two pictures need two axes; give kind='loop' or kind='residual' with it")
        figure, axes = _pyplot().subplots(1, 2, figsize=(11.5, 4.2), layout="constrained", width_ratios=[1, 1.6])
        _loop(axes[0], series, block)
        _residual(axes[1], series, noise)
        return figure
    if ax is None:
        size = (5.0, 4.2) if kind == "loop" else (8.0, 3.6)
        _, ax = _pyplot().subplots(figsize=size, layout="constrained")
    if kind == "loop":
        _loop(ax, series, block)
    else:
        _residual(ax, series, noise)
    return ax.figure


def _loop(ax: Any, series: dict[str, Any], block: int | None) -> None:
    samples, what = cycle_of(series, block)
    y = series["displacement"][samples]
    ax.plot(y, series["force"][samples], color=MEASURED, linewidth=3.0, label="measured")
    for name, (label, colour) in _NAMES.items():
        ax.plot(
            y,
            series[name][samples],
            color=colour,
            linewidth=1.3,
            linestyle="--" if name == "before" else "-",
            label=label,
        )
    ax.set(xlabel="displacement, mm", ylabel="force, kN", title=f"Loop: {what}")
    ax.legend(frameon=False, fontsize="small")
    ax.grid(alpha=0.25)


def _residual(ax: Any, series: dict[str, Any], noise: float) -> None:
    time, force = series["time"], series["force"]
    for name, (label, colour) in _NAMES.items():
        left = np.where(series["measured"], force - series[name], np.nan)
        ax.plot(time, left, color=colour, linewidth=0.7, label=f"{label}: {_rms(left):.3g} kN RMS")
    ink = import_module("matplotlib").rcParams["text.color"]
    ax.axhline(2 * noise, color=ink, linewidth=0.9, linestyle=":", label="noise, ±2 deviations")
    ax.axhline(-2 * noise, color=ink, linewidth=0.9, linestyle=":")
    ax.set(xlabel="time, s", ylabel="measured − model, kN", title="Residual")
    ax.margins(x=0.01)
    ax.grid(alpha=0.25)
    legend = ax.legend(frameon=False, fontsize="small", loc="upper center", bbox_to_anchor=(0.5, -0.16), ncols=3)
    for line in legend.get_lines():
        line.set_linewidth(2.0)


def _rms(values: Any) -> float:
    return float(np.sqrt(np.nanmean(np.square(values))))


def characterized(measured: Any, line: Any, what: str, ax: Any) -> Any:
    """Plot a measured loop and the line computed from it."""
    if ax is None:
        _, ax = _pyplot().subplots(figsize=(5.0, 4.2), layout="constrained")
    ax.plot(measured[:, 0], measured[:, 1], color=MEASURED, linewidth=1.0, label="measured")
    ax.plot(line[:, 0], line[:, 1], color=AFTER, linewidth=1.8, label=what)
    ax.set(xlabel="displacement, mm", ylabel="force, kN")
    ax.legend(frameon=False, fontsize="small")
    ax.grid(alpha=0.25)
    return ax.figure
