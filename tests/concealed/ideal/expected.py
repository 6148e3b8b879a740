"""Expected signals, block by block, with something hidden and without."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from tests.concealed.generator.chain import Chain, scans
from tests.concealed.generator.mechanism import Mechanism
from tests.concealed.generator.scan import Scan
from tests.concealed.generator.setting import Setting
from tests.concealed.ideal.quiet import Floats, quiet

_ROUNDING = 1.0 / 12


@dataclass(frozen=True)
class Expected:
    """A block without noise, each (n_samples, n_rows, n_columns).

    Attributes:
        electrons: That reach the output.
        dn: That the converter sees.
        gain: Its derivative by the electrons, DN/e-.
    """

    scan: Scan
    electrons: Floats
    dn: Floats
    gain: Floats

    @property
    def variance(self) -> Floats:
        """Of shot noise, read noise and rounding, DN²."""
        noise = self.electrons + self.scan.sensor.read_noise_e**2
        return np.asarray(self.gain**2 * noise + _ROUNDING)

    @property
    def signal(self) -> Floats:
        """DN above the offset."""
        return np.asarray(self.dn - self.scan.sensor.offset_dn)


def expected(setting: Setting, mechanisms: Sequence[Mechanism]) -> Iterator[Expected]:
    """Yield the blocks in their order."""
    chain = Chain(mechanisms, {}, quiet())
    for scan in scans(setting.sensor, setting.plan):
        electrons = np.array(np.broadcast_to(chain.electrons(scan)[0], scan.shape), dtype=float)
        step = 1.0 + 1e-4 * electrons
        more = chain.aside(quiet()).volts(electrons + step, scan)
        dn = np.array(np.broadcast_to(chain.volts(electrons, scan), scan.shape))
        yield Expected(scan, electrons, dn, (more - dn) / step)
