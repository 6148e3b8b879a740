"""What is worked out of recordings, by hand: jobs, figures, sets, and the log."""

import pytest
from playwright.sync_api import Page, expect

from service.store.store import Store
from tests.service.page.serving import Watched


def a_recording_is_calibrated(watched: Watched, store: Store) -> None:
    watched.open("recordings")
    watched.press("Show six flats")
    detail = watched.page.get_by_role("region", name="The chosen recording")
    expect(detail.get_by_text("256 columns, 12 bits")).to_be_visible()
    watched.press("Calibrate")
    expect(watched.page.get_by_text("calibrate: succeeded")).to_be_visible(timeout=60_000)
    watched.press("Photon transfer")
    expect(watched.page.get_by_text("photon-transfer: succeeded")).to_be_visible(timeout=60_000)
    with watched.page.expect_popup() as popup:
        watched.page.get_by_role("link", name="report.html").click()
    expect(popup.value.get_by_role("heading").first).to_be_visible()
    popup.value.close()
    watched.press("Diagnose")
    watched.press("Cancel diagnose")
    expect(watched.page.get_by_text("diagnose: cancelled")).to_be_visible()
    assert len(store.sets.list().items) == 3


def a_correction_is_seen(watched: Watched, store: Store) -> None:
    """The newest set on the recording that it was made of, by what its calibration said."""
    page = watched.page
    (told,) = (j.result for j in store.jobs.list().items if j.kind == "calibrate")
    assert told is not None
    watched.open("recordings")
    watched.press("Show six flats")
    page.get_by_role("link", name="Before and after a correction").click()
    for name in ("Before and after", "Raw profile", "Radiance profile", "Raw image"):
        watched.wait_for_data(name, 256)
    choose_by_keyboard(page, "Block", f"{told['cov_block']}: ")
    expect(page.get_by_text(f"{told['cov_lines']}, none in the fit")).to_be_visible()
    shown = {name: nonuniformity(page, name) for name in ("before: DN / VE", "after: radiance")}
    before, after = shown.values()
    assert before == pytest.approx(told["cov_before_percent"], abs=0.00051)  # shown: 3 decimals
    assert after == pytest.approx(told["cov_after_percent"], abs=0.00051)
    other = store.sets.list().items[-1]
    choose_by_keyboard(page, "Coefficient set", other.id[:8], key="Shift+Tab")
    expect(page.get_by_role("table", name="Nonuniformity before and after")).not_to_contain_text(
        f"{before:.3f}"
    )
    watched.wait_for_data("Radiance image", 256)
    watched.open(f"coefficient-sets?set={other.id}")
    page.get_by_role("link", name="Before and after its correction").click()
    expect(page.get_by_label("Coefficient set")).to_have_value(f"{other.id[:8]} (draft)")
    watched.wait_for_data("Before and after", 256)


def choose_by_keyboard(page: Page, label: str, begins: str, *, key: str = "Tab") -> None:
    """Go to a list with the Tab key, open it, and go down to an option."""
    field = page.get_by_label(label, exact=True)
    for _ in range(40):
        if field.evaluate("e => e === document.activeElement"):
            break
        page.keyboard.press(key)
    page.keyboard.press("ArrowDown")
    option = page.get_by_role("option").filter(has_text=begins)
    for _ in range(40):
        if "q-manual-focusable--focused" in (option.get_attribute("class") or ""):
            break
        page.keyboard.press("ArrowDown")
    page.keyboard.press("Enter")
    expect(page.get_by_role("option")).to_have_count(0)


def nonuniformity(page: Page, name: str) -> float:
    """Return what the table says of the mean line, percent."""
    row = page.get_by_role("row").filter(has_text=name)
    return float(row.get_by_role("cell").nth(1).inner_text())


def the_sensor_is_seen(watched: Watched, store: Store) -> None:
    page = watched.page
    watched.open("recordings")
    page.get_by_role("link", name="Figures").first.click()
    for name in ("Photon transfer", "Linearity"):
        watched.wait_for_data(name, 6)
        watched.wait_for_data(f"{name} residuals", 6)
    for job in (job for job in store.jobs.list().items if job.kind == "transfer-function"):
        watched.press(f"Show MTF {job.id[:8]}")
        chosen = page.get_by_role("region", name="The chosen result")
        expect(chosen.get_by_text(f"MTF {job.id[:8]}, succeeded")).to_be_visible()
        expect(page.get_by_label("PTF", exact=True)).to_be_visible()
        is_edge = (job.result or {})["method"] == "slanted edge"
        for name in ("Line spread",) if is_edge else ("Transfer function", "Point spread"):
            watched.wait_for_data(name, 20)
        watched.wait_for_data("MTF", 15)
        watched.wait_for_data("PTF", 15)


def sets_are_compared(watched: Watched, store: Store) -> None:
    newest, other = store.sets.list().items[:2]
    watched.open("coefficient-sets")
    watched.press(f"Show {newest.id[:8]}")
    for name in ("DN0", "VE", "QE"):
        watched.wait_for_data(name, 256)
    watched.page.get_by_label("Compare with").click()
    watched.page.get_by_role("option", name=other.id[:8]).click()
    for name in ("DN0", "VE", "QE"):
        watched.wait_for_data(f"Difference in {name}", 256)
    watched.press("Clear")
    expect(watched.page.locator(".js-plotly-plot")).to_have_count(3)


def a_set_lives(watched: Watched, store: Store) -> None:
    page, (newest, *_) = watched.page, store.sets.list().items
    watched.press("Verify")
    chosen = page.get_by_role("region", name="The chosen set")
    expect(chosen.get_by_text(", verified")).to_be_visible()
    watched.press("Certify")
    expect(page.get_by_role("alert").get_by_text("reason")).to_be_visible()
    watched.press("Close")
    page.get_by_label("Reason").fill("lamp certificate 17")
    watched.press("Certify")
    expect(chosen.get_by_text(", certified")).to_be_visible()
    page.get_by_label("Reason").fill("the lamp had aged")
    watched.press("Revoke")
    expect(chosen.get_by_text(", revoked")).to_be_visible()
    life = [(each.after, each.by, each.reason) for each in store.sets.get(newest.id).transitions]
    assert life[1:] == [
        ("verified", "local", ""),
        ("certified", "local", "lamp certificate 17"),
        ("revoked", "local", "the lamp had aged"),
    ]


def a_diagnosis_is_read(watched: Watched, store: Store) -> None:
    watched.open("diagnosis")
    digest = store.recordings.list().items[-1].digest
    watched.press(f"Show {digest[:8]}")
    expect(watched.page.get_by_text("Verdict: cancelled")).to_be_visible()
    watched.page.get_by_role("button", name=f"Show {digest[:8]}").last.click()
    expect(watched.page.get_by_text("Verdict: explained")).to_be_visible()
    expect(watched.page.get_by_text("interpixel_capacitance 3 %")).to_be_visible()
    watched.wait_for_data("Deviance before and after", 1)


def the_log_is_proven(watched: Watched, store: Store) -> None:
    watched.open("audit")
    watched.press("Verify")
    number, digest = store.audit.verify()
    expect(watched.page.get_by_text(f"Whole: {number} entries")).to_be_visible()
    expect(watched.page.get_by_text(digest)).to_be_visible()
    watched.press("Next page")
    watched.press("Previous page")
    watched.press("Last page")
    watched.press("First page")


RESULTS = (
    a_recording_is_calibrated,
    a_correction_is_seen,
    the_sensor_is_seen,
    sets_are_compared,
    a_set_lives,
    a_diagnosis_is_read,
    the_log_is_proven,
)
