"""Draws the pictures of the page: `python -m tests.service.page.gallery docs/gallery`."""

import sys
import tempfile
import time
from pathlib import Path

from playwright.sync_api import Page, sync_playwright

from calib.forward.model import Model
from service.cli.simulated_recording import simulate_recording
from service.plan.model import Plan
from tests.service.page.filled import fill_store
from tests.service.page.serving import SIZE, Watched, browser, serving
from tests.service.page.story_of_results import choose_by_keyboard

RECORDED = """
name = "sixteen flats"
lines = 512
frame_lines = 64

[sweep]
type = "factorial"
exposures_us = [10.0, 20.0, 40.0, 60.0, 80.0, 100.0, 120.0, 150.0]
levels = [2.0, 4.0]

[camera]
line_period_us = 200.0
pixel_format = "Mono12"
columns = 1024
serial = "D0001"
band = "NIR"

[source]
radiance = { 2 = 20.1, 4 = 40.2 }
"""
SWEEP = """
name = "gallery sweep"
lines = 512
frame_lines = 16

[sweep]
type = "factorial"
exposures_us = [100.0, 200.0, 300.0, 400.0, 600.0, 800.0]
levels = [1, 2, 3]

[camera]
line_period_us = 1000.0
columns = 768

[settle]
tolerance_percent = 2.0
stable_for_s = 0.5
"""


def main() -> None:
    """Draw every view in both colour schemes."""
    out = Path(sys.argv[1])
    with tempfile.TemporaryDirectory() as folder:
        home = Path(folder) / "home"
        recording = Path(folder) / "recording.h5"
        scenes = Path(folder) / "scenes"
        plan = Plan.loads(RECORDED)
        simulate_recording(Model.preset("demo"), plan, recording, seed=17, scenes_folder=scenes)
        digest, set_id = fill_store(home, recording, name="sixteen flats")
        with serving(home) as url, sync_playwright() as playwright:
            started = browser(playwright)
            take_photon_transfer(started.new_page(base_url=url), digest)
            for scheme in ("light", "dark"):
                context = started.new_context(viewport=SIZE, base_url=url, color_scheme=scheme)
                page = context.new_page()
                page.set_default_timeout(120_000)
                draw(Watched(page, url), out, scheme, digest, set_id)
            started.close()


def take_photon_transfer(page: Page, digest: str) -> None:
    page.goto(f"/page/recordings?recording={digest}")
    page.get_by_role("button", name="Photon transfer").click()
    page.get_by_text("photon-transfer: succeeded").wait_for(timeout=300_000)


def draw(watched: Watched, out: Path, scheme: str, digest: str, set_id: str) -> None:
    page = watched.page

    def taken(name: str, *figures: str) -> None:
        """Take a picture once the figures are drawn."""
        for figure in figures:
            watched.wait_for_data(figure, 1)
        page.wait_for_timeout(1500)
        page.screenshot(path=out / f"page-{name}-{scheme}.png")

    page.goto("/page/runs")
    page.get_by_role("status").get_by_text("bench idle").wait_for(timeout=60_000)
    page.get_by_label("Plan (TOML or JSON)").fill(SWEEP)
    page.get_by_role("button", name="Start").click()
    page.get_by_role("button", name="Validate").click()
    page.get_by_text("recording 0").first.wait_for(timeout=60_000)
    taken("runs")
    page.goto("/page/")
    page.get_by_text("recording 00").first.wait_for(timeout=60_000)
    page.wait_for_timeout(6000)
    taken("bench", "Line profile", "Waterfall")
    page.goto(f"/page/recordings?recording={digest}")
    page.get_by_text("diagnose: succeeded").wait_for()
    taken("recordings")
    page.goto(f"/page/coefficient-sets?set={set_id}")
    taken("coefficient-sets", "DN0", "VE", "QE")
    choose_by_keyboard(page, "Compare with", "")
    taken("comparison", "Difference in DN0", "Difference in VE", "Difference in QE")
    page.goto(f"/page/correction?set={set_id}")
    taken("correction", "Before and after", "Radiance profile", "Radiance image")
    page.goto("/page/sensor")
    page.get_by_role("button", name="Show Photon transfer").first.click()
    taken("photon-transfer", "Photon transfer residuals", "Linearity residuals")
    page.get_by_role("button", name="Show MTF").first.click()
    taken("mtf", "MTF", "PTF", "Point spread")
    page.goto("/page/diagnosis")
    page.get_by_role("button", name="Show").first.click()
    taken("diagnosis", "Deviance before and after")
    page.goto("/page/audit")
    page.get_by_role("button", name="Verify").click()
    page.get_by_text("Whole: ").wait_for()
    taken("audit")
    page.get_by_role("button", name="Safe-off").click()
    page.get_by_text("Every lamp is off").wait_for()
    time.sleep(1.0)
    page.goto("/page/")
    page.get_by_role("button", name="Release the bench").click()


if __name__ == "__main__":
    main()
