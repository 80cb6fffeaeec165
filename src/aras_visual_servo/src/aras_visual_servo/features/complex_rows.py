"""Products of complex numbers and complex rows that are the same bytes on every processor."""

import numpy as np


def times(factor, row):
    """factor * row, (n,) complex.

    numpy multiplies arrays of complex numbers with fused products on processors with AVX-512 and without on others, so
    that its last bits, and the run hash with them, would depend on the processor.
    Args: factor: complex.  row: (n,) complex.
    """
    a, b, x, y = factor.real, factor.imag, row.real, row.imag
    product = np.empty_like(row)
    product.real, product.imag = a * x - b * y, a * y + b * x
    return product
