"""The verb `export`."""

from ..command import EXPORT

VERBS = {"export": EXPORT}
