import numpy as np

from calib.kernels.residual_products import LINE_LAGS
from calib.kernels.scatter_products import scatter_products


def test_products_are_those_of_all_lines_made_in_full() -> None:
    rng = np.random.default_rng()
    between, few = rng.normal(0.0, 0.5, (30, 4)), rng.normal(0.0, 2.0, (4, 3, 12))
    # Of two blocks, one does not come into the other.
    partner = np.array([[11 - c if c < 6 else -1 for c in range(12)]])
    gram = np.stack([between[: 30 - d].T @ between[d:] for d in range(LINE_LAGS + 1)])
    times = rng.uniform(1.0, 9.0, 4)
    both = scatter_products(np.stack([np.ones_like(few), few]), gram, times, partner)
    found = [each[1] for each in both]
    lines = np.tensordot(between, few, 1)
    columns = np.zeros((4, 3, 12))
    for d in range(1, 5):
        columns[d - 1, :, :-d] = (lines[..., :-d] * lines[..., d:]).sum(axis=0)
    later = np.stack([(lines[:-d] * lines[d:]).sum(axis=0) for d in range(1, LINE_LAGS + 1)])
    rows = np.zeros((3, 12))
    rows[:-1] = (lines[:, :-1] * lines[:, 1:]).sum(axis=0)
    beside = np.where(partner >= 0, (lines * lines[..., partner[0]]).sum(axis=0), 0.0)[None]
    fourths = np.tensordot(times, few**4, 1)
    plain = ((lines**2).sum(axis=0), fourths, columns, later, rows, beside.reshape(1, 3, 12))
    for one, other in zip(found, plain, strict=True):
        # Sums of 30 products, or 16, of some hundred at most each.
        np.testing.assert_allclose(one, other, rtol=0, atol=1e-10)
