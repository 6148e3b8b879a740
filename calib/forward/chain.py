"""Runs effects one after the other."""

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np
from numpy.random import Generator, default_rng
from numpy.typing import NDArray

from calib.arrays import Columns, Lines, Pixels, by_line
from calib.forward.conditions import Conditions
from calib.forward.effect import Effect, Stage
from calib.forward.left import Left
from calib.forward.remembering import Remembering


@dataclass(frozen=True)
class ExpectedElectrons:
    """line_factor[n] x light[n or 0, i] + dark[i]: the charge of pixel i before shot noise.

    Attributes:
        light: (1, *sample) where all lines are alike but for their factor, else
            (n_lines, *sample).
        line_factor: (n_lines,).
        dark: (*sample,).
    """

    light: NDArray[np.float64]
    line_factor: Columns
    dark: Pixels

    def by_line(self) -> NDArray[np.float64]:
        """Return the expected electrons, (n_lines, *sample)."""
        return np.asarray(self.light * by_line(self.line_factor, self.light.ndim) + self.dark)


def run(
    effects: Iterable[Effect],
    signal: Lines,
    at: Conditions,
    rng: Generator,
    *,
    entered: Stage = Stage.SOURCE,
) -> Lines:
    """Return `signal`, which stands before stage `entered`, after all of `effects`.

    Radiance becomes radiance x us on leaving the source.
    """
    return run_on(effects, signal, at, rng, entered=entered)[0]


def run_on(
    effects: Iterable[Effect],
    signal: Lines,
    at: Conditions,
    rng: Generator,
    *,
    entered: Stage = Stage.SOURCE,
) -> tuple[Lines, Left | None]:
    """Return what `run` does, and what the lines leave; None where no effect has memory."""
    exposed, states = entered > Stage.SOURCE, {}
    for effect in effects:
        if not exposed and effect.stage > Stage.SOURCE:
            signal = signal * at.exposure_us
            exposed = True
        if isinstance(effect, Remembering):
            signal, states[effect.name] = effect.carry(signal, at, rng)
        else:
            signal = effect.apply(signal, at, rng)
        at = effect.conditions_after(at)
    return signal, Left(at.ended_s, states, drawn=True) if states else None


def conditions_after(effects: Iterable[Effect], at: Conditions) -> Conditions:
    """Return the conditions that links behind `effects` see."""
    for effect in effects:
        at = effect.conditions_after(at)
    return at


def without_noise(effects: Iterable[Effect]) -> tuple[Effect, ...]:
    """Return the effects that draw no random numbers."""
    return tuple(effect for effect in effects if not effect.stochastic)


def expected_left(effects: tuple[Effect, ...], scene: Lines, at: Conditions) -> Left | None:
    """Return what lines of `scene` leave on average, without drawing them; None: no memory.

    Args:
        effects: The whole chain, in order.
        scene: Radiance, (1, *sample) where all lines see the same, else (n_lines, *sample); in the
            first case, the lines are taken to be as the one in the middle.
        at: The conditions of all lines, and what was left before them.
    """
    remembering = [(k, e) for k, e in enumerate(effects) if isinstance(e, Remembering)]
    if not remembering:
        return None
    middle = np.array([at.line_times_s.mean()])
    seen = at if len(scene) > 1 else replace(at, line_times_s=middle)
    states, rng = {}, default_rng(0)  # no link draws from it
    for k, effect in remembering:
        states[effect.name] = effect.expected_left(
            run(without_noise(effects[:k]), scene, seen, rng), at
        )
    return Left(at.ended_s, states, drawn=False)


def expected_electrons(
    effects: tuple[Effect, ...], scene: Lines, at: Conditions, rng: Generator
) -> ExpectedElectrons:
    """Return the charge that `effects`, all links before shot noise, make of `scene`.

    Args:
        effects: In the order of the chain.
        scene: Radiance, (1, *sample) where all lines see the same, else (n_lines, *sample).
        at: The conditions.
        rng: For links that scatter the light, such as a jittering exposure.
    """
    sample = scene.shape[1:]
    if not all(effect.separable for effect in effects) or not _one_factor_holds(effects):
        full = run(effects, _every_line(scene, at), at, rng)
        ones = np.ones(at.n_lines)
        return ExpectedElectrons(np.asarray(full, np.float64), ones, np.zeros(sample))
    factor = np.ones(at.n_lines)
    alike = []
    for effect in effects:
        of_lines = effect.line_factor(at, rng)
        if of_lines is None:
            alike.append(effect)
        else:
            factor = factor * of_lines
    # Affine in the light: a capped lens shows the part that the lines' factors leave alone.
    dark = run(alike, np.zeros((1, *sample)), replace(at, capped=True), rng)
    light = run(alike, scene, at, rng) - dark
    return ExpectedElectrons(np.asarray(light, np.float64), factor, np.asarray(dark[0], np.float64))


def _one_factor_holds(effects: tuple[Effect, ...]) -> bool:
    """Return whether a line's factors scale all its light: none of it comes in behind them."""
    scales = [type(effect).line_factor is not Effect.line_factor for effect in effects]
    adds = [k for k, effect in enumerate(effects) if effect.adds_light]
    return not any(scales[: max(adds, default=0)])


def _every_line(scene: Lines, at: Conditions) -> Lines:
    return np.array(np.broadcast_to(scene, (at.n_lines, *scene.shape[1:])), dtype=np.float64)
