"""Random numbers by counting: hashes of a counter, made normal and Poisson numbers.

Inlined into the compiled loops that use them; 32-bit integers and floats, so that sixteen numbers
fit one vector register.

Sources: Steele, Lea and Flood, Fast splittable pseudorandom number generators (2014), for
splitmix64; Ellis's search for three-round 32-bit hash functions (2018), for triple32; Giles,
Approximating the erfinv function (2010), for the variable of the quantile; Hoermann, The
transformed rejection method for generating Poisson random variables (1993).
"""

from math import floor, lgamma, log, sqrt

import numpy as np
from numba import njit

_f, _i, _u, _q = np.float32, np.int32, np.uint32, np.uint64
_INVERSION_BELOW_E = 30.0


@njit(cache=True, inline="always")
def mixed(x: np.uint64) -> np.uint64:
    """Finaliser of splitmix64 (Steele, Lea and Flood 2014): 64 bits in, 64 bits out."""
    x = _q((x ^ (x >> _q(30))) * _q(0xBF58476D1CE4E5B9))
    x = _q((x ^ (x >> _q(27))) * _q(0x94D049BB133111EB))
    return _q(x ^ (x >> _q(31)))


@njit(cache=True, inline="always")
def hashed(counter: np.uint32, key_low: np.uint32, key_high: np.uint32) -> np.uint32:
    """32 bits to 32 bits in three rounds of shift and multiply (Ellis 2018, triple32)."""
    x = _u(counter + key_low)
    x = _u(_u(x ^ (x >> _u(17))) * _u(0xED5AD4BB))
    x = _u(x + key_high)
    x = _u(_u(x ^ (x >> _u(11))) * _u(0xAC4C1B51))
    x = _u(_u(x ^ (x >> _u(15))) * _u(0x31848BAB))
    return _u(x ^ (x >> _u(14)))


@njit(cache=True, inline="always")
def normal_number(bits: np.uint32) -> np.float32:
    """Return the standard normal number of 32 random bits, to 5e-5 of itself, without a branch.

    The low 31 bits are q, twice the tail's probability, the highest is the sign. With
    x = 1 - q and w = -ln(1 - x^2), the quantile is x times a smooth function of sqrt(w + 4).
    """
    q = _f(_f(_i(bits & _u(0x7FFFFFFF))) + _f(0.5)) * _f(2.0**-31)
    y = _f(q * (_f(2) - q))
    shifted = _i(y.view(np.int32) - _i(0x3F3504F3))  # octaves from sqrt(1/2) to sqrt(2)
    octave = _f(_i(shifted >> _i(23)))
    r = _f(_i(_i(shifted & _i(0x7FFFFF)) + _i(0x3F3504F3)).view(np.float32)) - _f(1)
    ln = _f(-0.14021623) * r + _f(0.21965708)
    ln = ((ln * r + _f(-0.25433356)) * r + _f(0.33265907)) * r + _f(-0.4998948)
    ln = octave * _f(0.6931472) + (ln * r + _f(1.0000037)) * r
    s = np.sqrt(_f(4) - ln) - _f(3.5)
    z = (_f(-2.4162419e-03) * s + _f(3.3900226e-03)) * s + _f(1.2470833e-02)
    z = ((z * s + _f(-2.8325574e-02)) * s + _f(1.1824271e-02)) * s + _f(2.4098042e-02)
    z = ((z * s + _f(-9.2399605e-02)) * s + _f(1.7203034)) * s + _f(3.8257773)
    z = _f(z * (_f(1) - q))
    return _f(_u(z.view(np.uint32) | _u(bits & _u(0x80000000))).view(np.float32))


@njit(cache=True)
def uniform_number(state: np.uint64) -> tuple[np.uint64, float]:
    """Return (the next state, a number above 0 and below 1)."""
    state = _q(state + _q(0x9E3779B97F4A7C15))
    return state, (np.float64(mixed(state) >> _q(11)) + 0.5) * 2.0**-53


@njit(cache=True)
def poisson_number(mean: float, state: np.uint64) -> tuple[np.uint64, float]:
    """Return (the next state, a Poisson number): inversion when few, else Hoermann's PTRS."""
    if mean < _INVERSION_BELOW_E:
        state, left = uniform_number(state)
        k, chance = 0, np.exp(-mean)
        while left > chance and k < 400:
            left -= chance
            k += 1
            chance *= mean / k
        return state, float(k)
    b = 0.931 + 2.53 * sqrt(mean)
    a = -0.059 + 0.02483 * b
    alpha = 1.1239 + 1.1328 / (b - 3.4)
    while True:
        state, u = uniform_number(state)
        state, v = uniform_number(state)
        u -= 0.5
        us = 0.5 - abs(u)
        k = floor((2 * a / us + b) * u + mean + 0.43)
        if us >= 0.07 and v <= 0.9277 - 3.6224 / (b - 2):
            return state, float(k)
        if k < 0 or (us < 0.013 and v > us):
            continue
        height = log(v) + log(alpha) - log(a / (us * us) + b)
        if height <= -mean + k * log(mean) - lgamma(k + 1.0):
            return state, float(k)
