"""Take the pictures of the page: ``python -m tests.support.page_pictures`` from the root of the repository.

Those of the examples are part of the page, the one of the whole page is in the documents.
"""

from __future__ import annotations

import argparse
import base64
import io
import tempfile
import time
from pathlib import Path

from PIL import Image
from selenium.webdriver.common.by import By
from selenium.webdriver.support.ui import WebDriverWait

from compas_cgc.server.page.gallery import GALLERY

from .browser import open_browser
from .freeform import LENGTH
from .freeform import WIDTH
from .freeform import bumpy
from .freeform import nurbs_file
from .server_process import running_server

ROOT = Path(__file__).parents[2]
EXAMPLES = ROOT / "compas_cgc" / "server" / "page" / "static" / "examples"
PAGE = ROOT / "docs" / "images" / "page.png"
DIALOG = ROOT / "docs" / "images" / "rationalise.png"
SLIDE = (
    "const slider = document.querySelector('#rationalise-slider'); slider.value = arguments[0]; slider.dispatchEvent(new Event('input'))"
)
ALONE = (
    "header, .panel, .tools, .hand, .crown, .marks, .legend { display: none !important }",
    "main { position: fixed !important; inset: 0; display: block !important }",
    ".view { position: absolute !important; inset: 0; background: none !important }",
    "body { background: none !important }",
)


def solved(window, url, name):
    """Open an example and solve it."""
    window.get(url)
    WebDriverWait(window, 20).until(lambda _: window.find_elements(By.CSS_SELECTOR, f"[data-example={name}]"))[0].click()
    WebDriverWait(window, 20).until(lambda _: window.find_element(By.ID, "solve").is_displayed())
    window.find_element(By.ID, "solve").click()
    WebDriverWait(window, 20).until(lambda _: window.find_elements(By.CSS_SELECTOR, ".verdict.good"))
    time.sleep(1.5)


def small(png):
    """Return a picture with fewer pixels and colours, still transparent."""
    picture = Image.open(io.BytesIO(png)).resize((480, 300), Image.LANCZOS)
    file = io.BytesIO()
    picture.quantize(128, Image.Quantize.FASTOCTREE, dither=Image.Dither.NONE).save(file, "PNG", optimize=True)
    return file.getvalue()


def dithered(png):
    """Return a picture with fewer colours whose gradients stay smooth."""
    file = io.BytesIO()
    picture = Image.open(io.BytesIO(png)).convert("RGB")
    palette = picture.quantize(256, Image.Quantize.FASTOCTREE)
    picture.quantize(palette=palette, dither=Image.Dither.FLOYDSTEINBERG).save(file, "PNG", optimize=True)
    return file.getvalue()


def example(window, url, name):
    """Return the picture of a solved example, alone on the page."""
    solved(window, url, name)
    for rule in ALONE:
        window.execute_script("[...document.styleSheets].at(-1).insertRule(arguments[0])", rule)
    window.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", dict(width=960, height=600, deviceScaleFactor=1, mobile=False))
    window.execute_cdp_cmd("Emulation.setDefaultBackgroundColorOverride", dict(color=dict(r=0, g=0, b=0, a=0)))
    time.sleep(0.5)
    window.execute_script("document.getElementById('fit').click()")
    window.find_element(By.ID, "canvas").send_keys("+")
    window.execute_script("document.activeElement.blur()")
    time.sleep(1.0)
    return small(base64.b64decode(window.execute_cdp_cmd("Page.captureScreenshot", dict(format="png"))["data"]))


def whole(window, url):
    """Return the picture of the whole page."""
    solved(window, url, "example4_a")
    window.execute_script("document.querySelector('[name=colours][value=curvature]').click()")
    time.sleep(1.0)
    return dithered(window.get_screenshot_as_png())


def dialog(window, url, folder):
    """Return the picture of a freeform design on few moulds."""
    path = folder / "hall.3dm"
    nurbs_file(path, bumpy("soft", 1), LENGTH, WIDTH)
    window.get(url)
    WebDriverWait(window, 20).until(lambda _: window.find_element(By.ID, "rationalise-begin")).click()
    WebDriverWait(window, 20).until(lambda _: window.find_element(By.ID, "rationalise").is_displayed())
    window.find_element(By.ID, "rationalise-file").send_keys(str(path))
    start = window.find_element(By.ID, "rationalise-start")
    WebDriverWait(window, 20).until(lambda _: start.is_displayed())
    for number, words in ((2, "on 2 moulds"), (6, "on 6 moulds"), (4, "on 4 moulds")):
        window.execute_script(SLIDE, number)
        start.click()
        WebDriverWait(window, 60).until(lambda _, words=words: words in window.find_element(By.ID, "rationalise-verdict").text)
    time.sleep(1.5)
    return dithered(window.find_element(By.ID, "rationalise").screenshot_as_png)


def take():
    """Take all pictures, each in a browser of its own, as a page keeps the last design."""
    with tempfile.TemporaryDirectory() as folder, running_server(Path(folder) / "jobs.sqlite") as server:
        for name in GALLERY:
            with open_browser(Path(folder), 1280, 940) as window:
                (EXAMPLES / f"{name}.png").write_bytes(example(window, server.url, name))
        with open_browser(Path(folder), 1360, 940) as window:
            PAGE.write_bytes(whole(window, server.url))
        with open_browser(Path(folder), 1360, 860) as window:
            DIALOG.write_bytes(dialog(window, server.url, Path(folder)))


if __name__ == "__main__":
    argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter).parse_args()
    take()
