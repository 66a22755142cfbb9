"""Draw the icons of the components: ``python ghuser/icons.py`` (needs Pillow).

Common style: ink lines of one width, sand for surfaces, teal for targets, red for supports.
"""

from __future__ import annotations

import math
from pathlib import Path

from PIL import Image
from PIL import ImageDraw

SIZE = 24
FINE = 16  # each pixel is the mean of so many squared
INK = (45, 45, 45, 255)
SAND = (232, 196, 143, 255)
CLAY = (207, 132, 101, 255)
TEAL = (74, 139, 150, 255)
RED = (200, 40, 40, 255)
PAPER = (255, 255, 255, 255)


class Pen:
    """A canvas of 24 x 24 units, the origin at the upper left."""

    def __init__(self) -> None:
        self.image = Image.new("RGBA", (SIZE * FINE, SIZE * FINE), (255, 255, 255, 0))
        self.draw = ImageDraw.Draw(self.image)

    def line(self, points, colour=INK, width=1.5):
        """Draw a polyline with round ends."""
        scaled = [(x * FINE, y * FINE) for x, y in points]
        self.draw.line(scaled, fill=colour, width=round(width * FINE), joint="curve")
        for x, y in points:
            self.dot(x, y, width / 2, colour)

    def area(self, points, colour=SAND):
        """Fill a polygon."""
        self.draw.polygon([(x * FINE, y * FINE) for x, y in points], fill=colour)

    def dot(self, x, y, radius, colour=INK):
        """Fill a circle."""
        self.draw.ellipse([(x - radius) * FINE, (y - radius) * FINE, (x + radius) * FINE, (y + radius) * FINE], fill=colour)

    def ring(self, x, y, radius, colour=INK, width=1.5):
        """Draw a circle."""
        self.line([(x + radius * math.cos(t / 12 * math.pi), y + radius * math.sin(t / 12 * math.pi)) for t in range(25)], colour, width)

    def icon(self, size=SIZE):
        """Return the picture in its final size [pixel]."""
        return self.image.resize((size, size), Image.Resampling.BOX)


def arc(left, right, base, height, count=16):
    """Return points of a dome's outline."""
    middle, half = (left + right) / 2, (right - left) / 2
    return [(middle - half * math.cos(math.pi * i / count), base - height * math.sin(math.pi * i / count)) for i in range(count + 1)]


def dome(pen, colour=SAND, base=20, height=13):
    """Draw the dome that most icons share."""
    outline = arc(2.5, 21.5, base, height)
    pen.area(outline, colour)
    pen.line([*outline, outline[0]])


def mesh(pen):
    """Triangles, held at three corners."""
    corners = [(3, 20), (21, 20), (12, 4), (12, 20), (7.5, 12), (16.5, 12)]
    pen.area([corners[i] for i in (0, 1, 2)])
    for i, j in ((0, 1), (1, 2), (2, 0), (3, 4), (4, 5), (5, 3)):
        pen.line([corners[i], corners[j]])
    for i in range(3):
        pen.dot(*corners[i], 2.4, RED)


def target(pen):
    """A target."""
    for radius, colour in ((9.5, TEAL), (6.5, PAPER), (3.5, TEAL)):
        pen.dot(12, 12, radius, colour)
    pen.ring(12, 12, 9.5)


def settings(pen):
    """Three sliders."""
    for y, x in ((6, 15), (12, 8), (18, 17)):
        pen.line([(3, y), (21, y)])
        pen.dot(x, y, 3, TEAL)
        pen.ring(x, y, 3)


def constraints(pen):
    """A point that slides along a curve."""
    pen.line([(2 + x, 17 - 11 * math.sin(x / 20 * math.pi / 1.4)) for x in range(21)], TEAL, 2.4)
    pen.line([(12, 7.5), (12, 21)], INK)
    pen.line([(7, 21), (17, 21)], INK)
    pen.dot(12, 7.2, 3.2, RED)


def server(pen):
    """A stack of machines."""
    for y, colour in ((4, TEAL), (10, SAND), (16, SAND)):
        box = [(3.5, y), (20.5, y), (20.5, y + 5), (3.5, y + 5)]
        pen.area(box, colour)
        pen.line([*box, box[0]])
        pen.dot(7, y + 2.5, 1.3)


def solve(pen):
    """A dome that rises."""
    dome(pen, base=21, height=11)
    pen.line([(12, 17.5), (12, 3)], TEAL, 2.4)
    pen.line([(7.5, 7.5), (12, 3), (16.5, 7.5)], TEAL, 2.4)


def analyse(pen):
    """A dome in the colours of curvature."""
    outline = arc(2.5, 21.5, 19, 13, 24)
    for i, colour in enumerate(((43, 123, 186), (166, 203, 227), (250, 246, 240), (246, 178, 154), (214, 64, 58))):
        part = [p for p in outline if 2.5 + 3.8 * i - 0.05 <= p[0] <= 2.5 + 3.8 * (i + 1) + 0.05]
        pen.area([(part[0][0], 19), *part, (part[-1][0], 19)], (*colour, 255))
    pen.line([*outline, outline[0]])


def regions(pen):
    """Nine regions."""
    for i in range(3):
        for j in range(3):
            x, y = 3 + 6 * i, 3 + 6 * j
            pen.area([(x, y), (x + 6, y), (x + 6, y + 6), (x, y + 6)], CLAY if (i, j) == (1, 1) else SAND)
    for k in range(4):
        pen.line([(3 + 6 * k, 3), (3 + 6 * k, 21)])
        pen.line([(3, 3 + 6 * k), (21, 3 + 6 * k)])


def history(pen):
    """A falling curve."""
    pen.line([(4, 3), (4, 20.5), (21, 20.5)])
    pen.line([(6 + x, 5 + 12.5 * (1 - math.exp(-x / 4))) for x in range(15)], TEAL, 2.2)


def mould(pen):
    """A panel lifted off its mould."""
    pen.area([*arc(2.5, 21.5, 21, 9), (21.5, 21)], SAND)
    outline = arc(2.5, 21.5, 21, 9)
    pen.line([*outline, outline[0]])
    pen.line([(x, y - 6.5) for x, y in outline[4:-4]], TEAL, 2.6)


def rationalise(pen):
    """A dome divided into panels of two moulds."""
    dome(pen)
    pen.area([(9, 20), (9, 8.5), (15, 8.5), (15, 20)], TEAL)
    for x, y in ((9, 8), (15, 8)):
        pen.line([(x, y), (x, 20)])
    pen.line([(4, 14.5), (20, 14.5)])


def sheet(pen):
    """Draw a sheet of paper."""
    outline = [(8, 2.5), (17, 2.5), (21.5, 7), (21.5, 21.5), (8, 21.5)]
    pen.area(outline, PAPER)
    pen.line([*outline, outline[0]])


def read_3dm(pen):
    """An arrow out of a sheet."""
    sheet(pen)
    pen.line([(15, 13), (2, 13)], TEAL, 2.4)
    pen.line([(6, 9), (2, 13), (6, 17)], TEAL, 2.4)


def write_3dm(pen):
    """An arrow into a sheet."""
    sheet(pen)
    pen.line([(2, 13), (15, 13)], CLAY, 2.4)
    pen.line([(11, 9), (15, 13), (11, 17)], CLAY, 2.4)


def example(pen):
    """Four domes to choose from."""
    for left, base, colour in ((2, 11, SAND), (13, 11, CLAY), (2, 21, TEAL), (13, 21, SAND)):
        outline = arc(left, left + 9, base, 7.5)
        pen.area(outline, colour)
        pen.line([*outline, outline[0]], width=1.2)


def unroll(pen):
    """A piece of paper that comes off a roll."""
    sheet_of = [(3, 21), (21, 21), (17, 11), (7, 11)]
    pen.area(sheet_of, SAND)
    pen.line([*sheet_of, sheet_of[0]])
    pen.line([(10, 12), (8.5, 20)], TEAL, 1.2)
    pen.line([(14, 12), (15.5, 20)], TEAL, 1.2)
    pen.dot(12, 7, 4.2, CLAY)
    pen.ring(12, 7, 4.2)


def membrane(pen):
    """A dome with the two forces in it."""
    dome(pen, base=21, height=15)
    pen.line([(7, 14), (17, 14)], RED, 2.2)
    pen.line([(12, 9.5), (12, 18.5)], TEAL, 2.2)


def net(pen):
    """Laths that cross at equal distances."""
    for k in range(3):
        pen.line([(3 + 6 * k, 3), (9 + 6 * k, 21)], TEAL, 1.8)
        pen.line([(21 - 6 * k, 3), (15 - 6 * k, 21)], CLAY, 1.8)


def quads(pen):
    """Four plane quads that meet in a node."""
    rim = [[(3, 8), (11, 4), (21, 6)], [(3, 14), (12, 12), (21, 11)], [(5, 21), (13, 20), (20, 17)]]
    for i, j, colour in ((0, 0, SAND), (0, 1, TEAL), (1, 0, CLAY), (1, 1, SAND)):
        pen.area([rim[i][j], rim[i][j + 1], rim[i + 1][j + 1], rim[i + 1][j]], colour)
    for row in [*rim, *zip(*rim)]:
        pen.line(list(row), width=1.3)


def info(pen):
    """An i."""
    pen.dot(12, 12, 9.5, TEAL)
    pen.ring(12, 12, 9.5)
    pen.dot(12, 7, 1.6, PAPER)
    pen.line([(12, 11), (12, 17)], PAPER, 2.6)


def bake(pen):
    """A dome that is laid onto layers."""
    for y, colour in ((21, CLAY), (17.5, SAND)):
        layer = [(2, y), (12, y - 4), (22, y), (12, y + 2)]
        pen.area(layer, colour)
        pen.line([*layer, layer[0]], width=1.2)
    outline = arc(6, 18, 12, 8)
    pen.area(outline, TEAL)
    pen.line([*outline, outline[0]])


def goals(pen):
    """A dome, and how high it shall be."""
    outline = arc(2, 17, 20, 14)
    pen.area(outline, SAND)
    pen.line([*outline, outline[0]], width=1.3)
    pen.line([(20.5, 6), (20.5, 20)], TEAL, 1.8)
    pen.line([(18.5, 8.5), (20.5, 6), (22.5, 8.5)], TEAL, 1.8)
    pen.line([(18.5, 17.5), (20.5, 20), (22.5, 17.5)], TEAL, 1.8)


def study(pen):
    """Domes of growing height, side by side."""
    for k, (x, y) in enumerate([(2, 11), (13, 11), (2, 22), (13, 22)]):
        outline = arc(x, x + 9, y, 3 + 2 * k)
        pen.area(outline, TEAL if k == 3 else SAND)
        pen.line([*outline, outline[0]], width=1.2)


def install(pen):
    """An arrow into a tray."""
    pen.line([(12, 3), (12, 15)], TEAL, 2.6)
    pen.line([(7, 10.5), (12, 15.5), (17, 10.5)], TEAL, 2.6)
    pen.line([(3.5, 15), (3.5, 20.5), (20.5, 20.5), (20.5, 15)])


ICONS = {
    "CGC_Analyse": analyse,
    "CGC_Bake": bake,
    "CGC_Constraints": constraints,
    "CGC_Example": example,
    "CGC_Goals": goals,
    "CGC_History": history,
    "CGC_Info": info,
    "CGC_Install": install,
    "CGC_Membrane": membrane,
    "CGC_Mesh": mesh,
    "CGC_Mould": mould,
    "CGC_Net": net,
    "CGC_Quads": quads,
    "CGC_Rationalise": rationalise,
    "CGC_Read3dm": read_3dm,
    "CGC_Regions": regions,
    "CGC_Settings": settings,
    "CGC_Server": server,
    "CGC_Solve": solve,
    "CGC_Study": study,
    "CGC_Target": target,
    "CGC_Unroll": unroll,
    "CGC_Write3dm": write_3dm,
}


def main() -> None:
    """Draw all icons into the folders of the components, and that of the package beside them."""
    folder = Path(__file__).parent / "components"
    for name, draw in ICONS.items():
        pen = Pen()
        draw(pen)
        pen.icon().save(folder / name / "icon.png", optimize=True)
    pen = Pen()
    solve(pen)
    pen.icon(64).save(folder.parent / "icon.png", optimize=True)


if __name__ == "__main__":
    main()
