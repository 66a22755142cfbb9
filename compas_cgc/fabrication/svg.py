"""SVG output of sheets in real units, for laser cutters and browsers."""

from __future__ import annotations

from xml.sax.saxutils import escape

from .drawing import LAYERS
from .drawing import Drawing

__all__ = ["svg_text"]

_UNITS = {"Millimeters": "mm", "Centimeters": "cm", "Inches": "in"}
_LETTERS = 100
_IN_MM = {"Meters": 1000.0, "Kilometers": 1e6, "Feet": 304.8, "Yards": 914.4}


def svg_text(drawing: Drawing) -> str:
    """Return a drawing as SVG in real units, with one group per layer."""
    width, height = drawing.size
    top = 0.02 * max(width, height)
    units = drawing.units or "Meters"
    scale, suffix = (1.0, _UNITS[units]) if units in _UNITS else (_IN_MM.get(units, 1000.0), "mm")
    stroke = 5e-4 * max(width, height) / max(1.0, (len(drawing.lines) / 200) ** 0.5)
    lines = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width * scale:.9g}{suffix}" height="{(height + top) * scale:.9g}{suffix}" '
        f'viewBox="0 0 {width!r} {height + top!r}">'
    ]
    for layer, colour in LAYERS.items():
        lines.append(f'<g id="{layer}" fill="none" stroke="{_paint(colour)}" stroke-width="{stroke:.3g}">')
        for line in drawing.lines:
            if line.layer == layer:
                tag = "polygon" if line.closed else "polyline"
                points = " ".join(f"{x!r},{height + top - y!r}" for x, y in line.points.tolist())
                lines.append(f'<{tag} points="{points}"/>')
        for text in drawing.texts:
            if text.layer == layer and text.height > 0:
                x, y = text.place.tolist()
                words = escape(text.text)
                # Many programs render font sizes below one unit badly, so texts are large and scaled down.
                size = text.height / _LETTERS
                anchor, paint = "start" if text.starts else "middle", _paint(LAYERS[text.colour or layer])
                lines.append(
                    f'<text transform="translate({x:.6g} {height + top - y + 0.35 * text.height:.6g}) scale({size:.6g})" '
                    f'font-size="{_LETTERS}" text-anchor="{anchor}" font-family="sans-serif" fill="{paint}" stroke="none">{words}</text>'
                )
        lines.append("</g>")
    return "\n".join([*lines, "</svg>", ""])


def _paint(colour: tuple[int, int, int]) -> str:
    return "#{:02x}{:02x}{:02x}".format(*colour)
