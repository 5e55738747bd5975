"""Equality in kind, type, shape and every bit."""
import numpy as np


def same(a, b):
    """Whether two values, or nests of dicts, tuples and arrays, are equal so."""
    if isinstance(a, dict):
        return isinstance(b, dict) and a.keys() == b.keys() and all(same(a[k], b[k]) for k in a)
    if isinstance(a, np.ndarray):
        if not isinstance(b, np.ndarray) or a.dtype != b.dtype or a.shape != b.shape:
            return False
        return all(map(same, a.flat, b.flat)) if a.dtype == object else a.tobytes() == b.tobytes()
    if isinstance(a, (tuple, list)):
        return type(a) is type(b) and len(a) == len(b) and all(map(same, a, b))
    return type(a) is type(b) and a == b


def shaped(info):
    """Types, shapes and kinds of a dict's values."""
    return {key: (type(value), getattr(value, "shape", None), getattr(value, "dtype", None))
            for key, value in info.items()}
