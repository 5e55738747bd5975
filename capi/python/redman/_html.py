"""What notebooks show: players, images, and tables, as HTML that is complete by itself and outlives an export."""
from __future__ import annotations

import base64
import gzip
import html
import math
from typing import Any, Optional, Sequence

# A page within a page, packed: a browser of 2023 or later unpacks it.
_UNPACK = """<!doctype html><meta charset="utf-8"><title>{title}</title><body style="font:13px sans-serif">
<p id="wait">The player needs a browser that runs scripts, of 2023 or later.</p><script>
(async () => {{
  const packed = Uint8Array.from(atob("{packed}"), c => c.charCodeAt(0));
  const text = await new Response(new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"))).text();
  document.open(); document.write(text); document.close();
}})();
</script>"""
_HEIGHT = 760  # of a player, pixels


def player(page: str, title: str) -> str:
    """A page in a frame of its own, which can reach nothing of the page around it."""
    packed = base64.b64encode(gzip.compress(page.encode(), 9, mtime=0)).decode()
    inner = _UNPACK.format(title=html.escape(title), packed=packed)
    return (f'<iframe srcdoc="{html.escape(inner)}" sandbox="allow-scripts allow-downloads" loading="lazy" '
            f'title="{html.escape(title)}" style="width:100%;height:{_HEIGHT}px;border:1px solid #d9dfe5;border-radius:8px"></iframe>')


def image(kind: str, data: bytes) -> str:
    """An image that contains its bytes. kind: "png" or "svg+xml"; exports drop the lines of an SVG that is no image."""
    return f'<img src="data:image/{kind};base64,{base64.b64encode(data).decode()}">'


def table(heads: Sequence[str], rows: Sequence[Sequence[str]], caption: str = "") -> str:
    """Texts in rows, the first of each its name."""
    said = f"<caption>{html.escape(caption)}</caption>" if caption else ""
    top = "".join(f"<th>{html.escape(head)}</th>" for head in heads)
    body = "".join("<tr><th>" + html.escape(row[0]) + "</th>" + "".join(f"<td>{html.escape(cell)}</td>" for cell in row[1:]) + "</tr>"
                   for row in rows)
    return f"<table>{said}<thead><tr>{top}</tr></thead><tbody>{body}</tbody></table>"


def number(value: Optional[float]) -> str:
    """Four digits at most; "" for none."""
    if value is None or math.isnan(value):
        return ""
    return f"{value:.0f}" if abs(value) >= 1000 else f"{value:.4g}"


def share(value: float) -> str:
    """In per cent."""
    return "" if math.isnan(value) else f"{100 * value:.4g} %"


def pair(ends: Any, written: Any = number) -> str:
    """An interval."""
    low, high = ends
    return "" if math.isnan(low) else f"{written(low)} to {written(high)}"
