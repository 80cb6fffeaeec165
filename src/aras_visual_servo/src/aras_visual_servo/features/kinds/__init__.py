"""More kinds of features, each in a file of its own: whoever loads the room `features` loads these, too."""

from ...config.plugins import load_room

load_room(__name__)
