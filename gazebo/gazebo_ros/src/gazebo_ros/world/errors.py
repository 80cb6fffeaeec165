"""What the world refuses."""


class GazeboError(Exception):
    """Base of what is refused; the text is the answer that Gazebo's services give."""


class SpawnError(GazeboError):
    """A model that cannot be spawned."""


class UnknownEntityError(GazeboError):
    """A model, link or joint that is not there."""


class BadValueError(GazeboError):
    """A number that is not finite, or lists that do not fit each other."""
