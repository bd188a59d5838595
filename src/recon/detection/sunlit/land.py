"""The land's own light, from frames in which shadows move over it.

Y. Weiss, Deriving intrinsic images from image sequences, ICCV 2001: the edges of the land stand
still, those of shadows move, so the median over time of the difference between two neighbours is
the land's. The land follows from the differences by least squares, up to one constant.
"""

from functools import lru_cache

import numpy as np
import numpy.typing as npt

from recon.model.shade import FloatMap, MaskMap

FloatStack = npt.NDArray[np.float32]
GAUGE = 1e-6
"""Weight that pulls the free constant of each connected piece to zero."""


def land_of(frames: FloatStack, known: MaskMap) -> FloatMap:
    """Return the land (R, C) of frames (K, R, C), NaN where not `known`; its mean is about 0."""
    across = median(np.diff(frames, axis=2))
    down = median(np.diff(frames, axis=1))
    solver = _solver(known.tobytes(), known.shape)
    land = np.full(known.shape, np.nan, dtype=np.float32)
    land[known] = solver.solve(across, down)
    return land


def median(values: FloatStack) -> FloatMap:
    """Return (R, C): the median over the first axis, without NaN; 0 where there is nothing."""
    # Contiguous along the sorted axis: several times faster.
    ordered = np.sort(np.ascontiguousarray(np.moveaxis(values, 0, -1)), axis=-1)
    count = np.count_nonzero(np.isfinite(ordered), axis=-1)
    high = np.maximum(count // 2, 0)
    low = np.maximum((count - 1) // 2, 0)
    below, above = (
        np.take_along_axis(ordered, i[..., np.newaxis], axis=-1)[..., 0] for i in (low, high)
    )
    middle: FloatMap = np.nan_to_num(0.5 * (below + above)).astype(np.float32)
    return middle


class _Solver:
    """Least squares over one mask: factorised once."""

    def __init__(self, known: MaskMap) -> None:
        from scipy.sparse import csr_array, eye_array
        from scipy.sparse.linalg import splu

        number = np.cumsum(known.ravel()).reshape(known.shape) - 1
        self._across: MaskMap = known[:, 1:] & known[:, :-1]
        self._down: MaskMap = known[1:] & known[:-1]
        first = np.concatenate([number[:, :-1][self._across], number[:-1][self._down]])
        second = np.concatenate([number[:, 1:][self._across], number[1:][self._down]])
        pairs = np.arange(len(first))
        shape = (len(first), int(known.sum()))
        ones = np.ones(len(first))
        differences = csr_array(
            (
                np.concatenate([-ones, ones]),
                (np.concatenate([pairs, pairs]), np.concatenate([first, second])),
            ),
            shape=shape,
        )
        self._transposed = differences.T.tocsr()
        normal = self._transposed @ differences + GAUGE * eye_array(shape[1])
        self._factors = splu(normal.tocsc(), permc_spec="MMD_AT_PLUS_A")

    def solve(self, across: FloatMap, down: FloatMap) -> npt.NDArray[np.float64]:
        """Return the values (N,) of the mask's cells."""
        wanted = np.concatenate([across[self._across], down[self._down]]).astype(np.float64)
        found: npt.NDArray[np.float64] = self._factors.solve(self._transposed @ wanted)
        return found


@lru_cache(maxsize=4)
def _solver(mask: bytes, shape: tuple[int, int]) -> _Solver:
    return _Solver(np.frombuffer(mask, dtype=np.bool_).reshape(shape))
