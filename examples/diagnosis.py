"""What a diagnosis sees of pixels that share their signal, and what it had hidden as.

    python examples/diagnosis.py [--coupling 0.012] [--out docs/gallery] [--page page.html]

A simulated camera couples neighbouring columns after collection; nobody tells the diagnosis.
"""

import argparse
from pathlib import Path
from tempfile import TemporaryDirectory
from textwrap import fill

from matplotlib.figure import Figure
from numpy.random import Generator, default_rng

from calib.diagnosis.diagnose import Examination, diagnose
from calib.diagnosis.report.compared import Compared
from calib.diagnosis.report.groups import groups_of
from calib.diagnosis.report.page import save_page
from calib.forward.effects.interpixel_capacitance import InterpixelCapacitance
from calib.forward.model import Model
from calib.forward.simulate import simulate
from calib.recording.header import Block, RecordingHeader
from calib.recording.open import open_recording
from calib.recording.writer import RecordingWriter
from calib.report.style import house_style, new_figure

LINES = 400
SHOWN = ("columns-by-lag", "columns-by-signal", "photon-transfer", "columns-along")


def examined(model: Model, rng: Generator) -> Examination:
    """Record darks and flats with a simulated camera and diagnose them."""
    conditions = [("dark", t, 0) for t in (20.0, 50.0, 80.0)]
    conditions += [("flat", t, level) for level in (2, 4, 6) for t in (20.0, 50.0, 80.0)]
    blocks = [
        Block(block=f"{k:03d}", kind=kind, exposure_us=t, level=level, lines=LINES)
        for k, (kind, t, level) in enumerate(conditions)
    ]
    with TemporaryDirectory() as folder:
        path = Path(folder) / "sweep.h5"
        header = RecordingHeader(camera=model.camera, source=model.source)
        with RecordingWriter.create(path, header, LINES) as writer:
            for block, frames in simulate(model, blocks, rng, frame_lines=LINES):
                writer.begin_block(block)
                for frame in frames:
                    writer.append(frame)
                writer.end_block(block)
        return diagnose(open_recording(path))


def drawn(found: Examination) -> Figure:
    """Draw the panels that tell the most, with the sentence above them."""
    shown, folded = groups_of(Compared(found))
    panels = {panel.name: panel for group in (*shown, *folded) for panel in group.panels}
    figure = new_figure(7.4, 5.4)
    for part, name in zip(figure.subfigures(2, 2).flat, SHOWN, strict=True):
        panels[name].draw(part)
    first = found.diagnosis.findings[0] if found.diagnosis.findings else None
    title = found.diagnosis.summary if first is None else f"{first.sentence} {first.hid_as}"
    figure.suptitle(fill(title, 88), fontsize=9.5, fontweight="bold")
    return figure


def main() -> None:
    """Draw the figure, and write the page where one is asked for."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--coupling", type=float, default=0.012)
    parser.add_argument("--seed", type=int, default=2010)
    parser.add_argument("--out", type=Path, default=Path("docs/gallery"))
    parser.add_argument("--page", type=Path)
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    model = Model.preset("demo").with_effect(InterpixelCapacitance(options.coupling))
    found = examined(model, default_rng(options.seed))
    print(found.diagnosis.summary)
    for finding in found.diagnosis.findings:
        print(finding.sentence, finding.hid_as)
    path = options.out / "diagnosis.png"
    with house_style():
        drawn(found).savefig(path)
    print(path)
    if options.page is not None:
        save_page(found.diagnosis, options.page, "Diagnosis", model.camera, found)


if __name__ == "__main__":
    main()
