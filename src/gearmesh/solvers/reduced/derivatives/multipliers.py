"""Products of Floquet multipliers that are 0 where some are on the unit circle."""

from collections.abc import Callable

import numpy as np
from numba import njit

from gearmesh.solvers.compilation import persistent
from gearmesh.solvers.reduced.derivatives.curves import solve


def _build_products(key: str, cache: bool) -> Callable[..., None]:
    @njit(cache=cache, nogil=True)
    def compiled(matrices, pairs, room, found):  # type: ignore[no-untyped-def]
        key  # noqa: B018 (see persistent)
        n = matrices.shape[1]
        for number in range(len(matrices)):
            matrix = matrices[number]
            for i in range(n):
                for k in range(n):
                    room[i, k] = matrix[i, k]
                room[i, i] += 1.0
            found[0, number] = solve(room[:n, :n])
            for row in range(len(pairs)):
                i, k = pairs[row]
                for column in range(len(pairs)):
                    p, q = pairs[column]
                    room[row, column] = matrix[i, p] * matrix[k, q] - matrix[i, q] * matrix[k, p]
                room[row, row] -= 1.0
            found[1, number] = solve(room[: len(pairs), : len(pairs)])

    return compiled


_products = persistent(_build_products)


def products(matrices: np.ndarray) -> np.ndarray:
    """Return the products of all mu_i + 1, and of all mu_i mu_k - 1, i < k, of matrices.

    The mu_i mu_k are the eigenvalues of the second compound matrix, of the minors of order two.

    Parameters
    ----------
    matrices : ndarray, shape (n, k, k)
        Their eigenvalues are the mu_i.

    Returns
    -------
    ndarray, shape (2, n)
    """
    count, size = matrices.shape[:2]
    pairs = [(i, k) for i in range(size) for k in range(i + 1, size)]
    most = max(size, len(pairs))
    found = np.empty((2, count))
    _products(np.ascontiguousarray(matrices), np.array(pairs), np.empty((most, most)), found)
    return found
