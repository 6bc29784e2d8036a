"""The view of a result in a notebook: small, and readable on a light and a dark background."""

from __future__ import annotations

from html import escape
from typing import TYPE_CHECKING, Any

import numpy as np

from ._plot import cycle_of
from ._words import interval, percent, unit_in_words

if TYPE_CHECKING:
    from ._characterize import Characterization
    from ._trace import Trace

#: The colours of the pictures, slightly lighter for a dark background.
MEASURED, BEFORE, AFTER = "#909090", "#e0701a", "#2b8cd6"
#: All other colours are those of the notebook.
_STYLE = (
    ".md-damper{font-size:13px;line-height:1.45;color:inherit;max-width:58em}"
    ".md-damper .md-row{display:flex;flex-wrap:wrap;gap:4px 28px;align-items:flex-start}"
    ".md-damper h4{margin:2px 0 2px;font-size:1.12em}.md-damper p{margin:2px 0 6px}"
    ".md-damper table{border-collapse:collapse;margin:2px 0;font-variant-numeric:tabular-nums}"
    ".md-damper th,.md-damper td{padding:2px 10px 2px 0!important;text-align:right;border:0;background:none}"
    ".md-damper th:first-child,.md-damper td:first-child,.md-damper .md-left{text-align:left!important}"
    ".md-damper tr{background:none!important}.md-damper thead th{border-bottom:1px solid currentColor!important}"
    ".md-damper figure{margin:0}.md-damper figcaption,.md-damper .md-small{font-size:.88em;opacity:.8}"
    ".md-damper ul{margin:2px 0;padding-left:1.3em}"
)


def trace(found: Trace) -> str:
    """Show verdict, effects, errors, a loop, and notes."""
    heading, sentence = found._core.verdict_in_words()
    notes = "".join(f"<li>{escape(text)}</li>" for text in [*found.assumed, *found.warnings])
    return (
        f'<div class="md-damper"><style>{_STYLE}</style><h4>{escape(heading)}</h4><p>{escape(sentence)}</p>'
        f'<div class="md-row"><div>{_effects(found)}{_errors(found)}</div>{_loop(found)}</div>'
        + (f'<ul class="md-small">{notes}</ul>' if notes else "")
        + "</div>"
    )


def _effects(found: Trace) -> str:
    effects = found.to_dict()["effects"]
    if not effects:
        return ""
    rows = [
        f"<tr><td>{escape(effect['family'].replace('_', '-')) if first else ''}</td>"
        f'<td class="md-left">{escape(name.replace("_", " "))}</td><td>{value}</td><td style="white-space:nowrap">{low} … {high}</td>'
        f'<td class="md-left">{escape(unit_in_words(estimate["unit"]))}</td></tr>'
        for effect in effects
        for first, (name, estimate) in _firsts(effect["parameters"].items())
        for low, value, high in [interval(estimate["low"], estimate["value"], estimate["high"])]
    ]
    return (
        '<table><thead><tr><th>effect</th><th class="md-left">parameter</th><th>value</th><th>90 % interval</th><th></th></tr></thead>'
        f"<tbody>{''.join(rows)}</tbody></table>"
    )


def _firsts(items: Any) -> Any:
    return ((place == 0, item) for place, item in enumerate(items))


def _errors(found: Trace) -> str:
    rows = [
        (BEFORE, "law alone", found.baseline.nrmse_held_out),
        (AFTER, "augmented model", found.augmented.nrmse_held_out),
        (AFTER, "augmented model in firmware, f32", found.on_target.nrmse_held_out),
        (MEASURED, "noise", found.noise_floor),
    ]
    most = max(value for *_, value in rows) or 1.0
    cells = "".join(
        f"<tr><td>{name}</td><td>{percent(value)}</td>"
        f'<td class="md-left"><div style="background:{colour};height:9px;width:{max(1.0, 130 * value / most):.0f}px"></div></td></tr>'
        for colour, name, value in rows
    )
    return f"<table><thead><tr><th>error of the force</th><th>held out</th><th></th></tr></thead><tbody>{cells}</tbody></table>"


def _loop(found: Trace) -> str:
    """Draw one loop as a picture of a few kilobytes."""
    series = found._core.series()[0]
    samples, what = cycle_of(series, None)
    y = series["displacement"][samples]
    step = max(1, len(y) // 120)
    forces = [series[name][samples] for name in ("force", "before", "after")]
    width, height, edge = 230.0, 170.0, 6.0
    every = np.concatenate(forces)

    def scaled(values: Any, low: float, high: float, size: float) -> Any:
        return edge + (values - low) / ((high - low) or 1.0) * (size - 2 * edge)

    x = scaled(y, float(y.min()), float(y.max()), width)
    lines = []
    for values, colour, thick, dash in zip(forces, (MEASURED, BEFORE, AFTER), (4, 1.5, 1.5), ("", "4 3", "")):
        up = height - scaled(values, float(every.min()), float(every.max()), height)
        points = " ".join(f"{a:.1f},{b:.1f}" for a, b in zip(x[::step], up[::step]))
        dashed = f' stroke-dasharray="{dash}"' if dash else ""
        lines.append(f'<polyline points="{points}" fill="none" stroke="{colour}" stroke-width="{thick}"{dashed}/>')
    key = " · ".join(
        f'<span style="color:{colour}">{mark}</span> {name}'
        for colour, mark, name in ((MEASURED, "━", "measured"), (BEFORE, "╍", "law alone"), (AFTER, "━", "augmented model"))
    )
    return (
        f'<figure><svg viewBox="0 0 {width:.0f} {height:.0f}" width="{width:.0f}" height="{height:.0f}" role="img" '
        f'aria-label="Force over displacement, {escape(what)}: measured, law alone, augmented model">{"".join(lines)}</svg>'
        f"<figcaption>force over displacement, {escape(what)}<br>{key}</figcaption></figure>"
    )


def characterization(found: Characterization) -> str:
    """Show blocks or cycles as a table."""
    rows = found.blocks if found.kind == "dynamic" else found.cycles
    table = rows._repr_html_() if hasattr(rows, "_repr_html_") else f"<pre>{escape(str(rows))}</pre>"
    notes = "".join(f"<li>{escape(text)}</li>" for text in found.notes)
    return f"<div><b>{escape(repr(found))}</b>{table}" + (f"<ul>{notes}</ul>" if notes else "") + "</div>"


def framed(page: str, height: int) -> str:
    """Embed a whole page in a notebook."""
    return (
        f'<iframe srcdoc="{escape(page, quote=True)}" title="Report" '
        f'style="box-sizing:border-box;width:100%;height:{height}px;border:1px solid rgba(128,128,128,.5)"></iframe>'
    )
