"""Runs simulated recordings with each effect of the catalogue and prints what is named.

    python -m tests.calib.diagnosis.trial [runs] [effect ...]

`clean` stands for recordings without any.
"""

import sys
import time
from collections.abc import Sequence
from secrets import randbits

import numpy as np
from numpy.random import default_rng

from calib.diagnosis.diagnose import examine
from calib.forward.effect import Effect
from calib.forward.effects.catalogue import effect_named
from tests.calib.diagnosis.recordings import plain_model, plan, recorded

CASES: tuple[tuple[str, dict[str, object]], ...] = (
    ("clean", {}),
    ("lamp_drift", {"amplitude": 0.002, "time_constant_s": 5.0}),
    ("lamp_flicker", {"amplitude": 0.001, "mains_hz": 50.0}),
    ("level_nonadditivity", {"loss_per_lamp": 0.0005}),
    ("stray_light", {"radiance": 0.0008}),
    ("exposure_offset", {"offset_us": 0.2}),
    ("exposure_jitter", {"relative_std": 0.0008}),
    ("reciprocity_failure", {"exponent": 0.001, "reference_radiance": 1.0}),
    ("dark_current", {"electrons_per_us": 0.002, "dsnu_std_e_per_us": 0.0002}),
    ("dark_current_temperature", {"electrons_per_us": 0.002, "dsnu_std_e_per_us": 0.0002}),
    ("hot_pixels", {"share": 0.02, "electrons_per_us": 0.2}),
    ("amplifier_glow", {"electrons_per_us": 0.006, "decay_columns": 40.0}),
    ("cosmic_rays", {"per_pixel_s": 0.1, "electrons": 1000.0}),
    ("brighter_fatter", {"row_per_e": 1e-6}),
    ("saturation_knee", {"threshold_e": 20_000.0, "room_e": 3e6}),
    ("lag", {"share": 0.001}),
    ("persistence", {"share": 0.001, "time_constant_s": 2.0}),
    ("cti", {"per_transfer": 1e-4, "partition_noise": 0.0}),
    ("interpixel_capacitance", {"column_coupling": 0.012}),
    ("tap_crosstalk", {"fraction": 0.012, "tap_layout": "odd_even"}),
    (
        "tap_gain_drift",
        {"amplitude": (0.0, 0.002), "time_constant_s": 5.0, "tap_layout": "odd_even"},
    ),
    ("gain_drift", {"amplitude": 0.002, "time_constant_s": 5.0}),
    ("nonlinearity", {"beta_per_dn": 3e-7}),
    ("line_noise", {"std_dn": 0.11}),
    ("banding", {"amplitude_dn": 0.05}),
    ("rts_pixels", {"amplitude_dn": 6.0}),
    ("offset_drift", {"amplitude_dn": 0.25, "time_constant_s": 5.0}),
    ("offset_temperature", {"dn_per_k": 0.01}),
    ("heavy_tailed_noise", {"share": 0.0005, "std_e": 60.0}),
    ("adc_inl", {"s_dn": 0.3, "w_dn": 0.15}),
    ("adc_dnl", {"width_std_dn": 0.05}),
    ("stuck_bit", {"probability": 0.01, "bit": 1}),
    ("black_clip", {"level_dn": 62}),
    ("duplicated_lines", {"probability": 0.02}),
)


def effects_of(name: str, values: dict[str, object], seed: int) -> Sequence[Effect]:
    """Return the effect, on a sensor of chance."""
    if name == "clean":
        return ()
    kind = effect_named(name)
    seeds = {key: seed for key in ("seed", "pattern_seed", "dsnu_seed") if hasattr(kind(), key)}
    return (kind(**values, **seeds),)


def main() -> None:
    """Print a line per effect: how often it is named first, is among the names, alone; and why."""
    runs = int(sys.argv[1]) if len(sys.argv) > 1 else 2
    entropy = randbits(32)
    print(f"entropy {entropy}")
    print(f"{'effect':26s} first among alone  sigma  unexpl  z            s   others")
    for k, (name, values) in enumerate(CASES):
        if len(sys.argv) > 2 and name not in sys.argv[2:]:
            continue
        first = among = alone = unexplained = 0
        sigmas, z, seconds, said = [], [], [], []
        for run in range(runs):
            rng = default_rng([entropy, k, run])
            taps = name in {"tap_crosstalk", "tap_gain_drift"}
            model = plain_model(taps=2, layout="odd_even") if taps else plain_model()
            evidence = recorded(
                model, plan(rng), rng, effects_of(name, values, int(rng.integers(99)))
            )
            started = time.process_time()
            found = examine(evidence).diagnosis
            seconds.append(time.process_time() - started)
            names = [f.effect.name for f in found.findings]
            known = {c.effect for f in found.findings for c in f.candidates}
            first += (bool(names) and names[0] == name) or (name == "clean" and not names)
            among += name in known
            alone += len(names) == 1
            unexplained += found.unexplained is not None
            for f in found.findings:
                if f.effect.name == name:
                    sigmas.append(f.significance_sigma)
                    for key, e in f.parameters.items():
                        if isinstance(values.get(key), float) and e.std > 0:
                            z.append((e.value - values[key]) / e.std)
                            break
            said.append(
                "+".join(names)
                + ("?" + found.unexplained.where.statistic if found.unexplained else "")
            )
        told = " ".join(s for s in said if s != name)
        zs = f"{np.mean(z):5.1f}±{np.std(z):4.1f}" if z else "     -    "
        sigma = f"{np.mean(sigmas):6.1f}" if sigmas else "     -"
        print(
            f"{name:26s} {first:5d} {among:5d} {alone:5d} {sigma} {unexplained:6d}  {zs} "
            f"{np.mean(seconds):6.1f}   {told}", flush=True,
        )  # fmt: skip


if __name__ == "__main__":
    main()
