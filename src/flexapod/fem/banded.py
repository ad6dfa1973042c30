"""Solutions with stiff matrices of slender bodies, whose numbering along the axis keeps them banded."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.sparse import csr_array

from flexapod.errors import ComputationError
from flexapod.typing import Array

__all__ = ["banded_solver"]


def banded_solver(matrix: csr_array) -> Callable[[Array], Array]:
    """Cholesky factors of a symmetric positive definite banded matrix, as a function right-hand side -> solution.

    Raises
    ------
    ComputationError
        The matrix is not positive definite: the body is not held.
    """
    from scipy.linalg import LinAlgError, cho_solve_banded, cholesky_banded

    parts = matrix.tocoo()
    size, width = len(matrix.indptr) - 1, int((parts.row - parts.col).max())
    lower = parts.row >= parts.col
    band = np.zeros((width + 1, size))
    band[(parts.row - parts.col)[lower], parts.col[lower]] = parts.data[lower]
    try:
        factor = cholesky_banded(band, lower=True, overwrite_ab=True, check_finite=False)
    except LinAlgError as error:
        raise ComputationError(
            "the stiffness of the solid is singular", next_step="Check that its nodes are held and joined"
        ) from error
    return lambda load: cho_solve_banded((factor, True), load, check_finite=False)
