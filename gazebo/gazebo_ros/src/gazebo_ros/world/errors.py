"""What the world refuses."""

import contextlib


class GazeboError(Exception):
    """Base of what is refused; the text is the answer that Gazebo's services give."""


class SpawnError(GazeboError):
    """A model that cannot be spawned."""


class UnknownEntityError(GazeboError):
    """A model, link or joint that is not there."""


@contextlib.contextmanager
def unknown_as(answer):
    """What is not there is told in these words, Gazebo's own, where it is looked for inside the block."""
    try:
        yield
    except UnknownEntityError as error:
        raise UnknownEntityError(answer) from error


class BadValueError(GazeboError):
    """A number that is not finite, or lists that do not fit each other."""
