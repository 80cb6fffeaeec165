"""The lights of the world, besides those of links."""
import numpy

from aras_visual_servo_sim import ArasError, light_entry

from .errors import BadValueError, SpawnError, UnknownEntityError

#: The light of a world that names none, model://sun: what the simulator has with `compatibility: gazebo`.
SUN = {"name": "sun", "type": "directional", "direction": [-0.5, 0.5, -1.0], "color_rgb": [204.0] * 3,
       "specular_rgb": [25.5] * 3, "casts_shadows": True}


class Lights:
    """Entries of the simulator's sim.scene.lighting.lights by name. Not thread-safe."""

    def __init__(self, entries=(SUN,), shadows=True):
        """
        Args:
            shadows: False: none of them casts any, whatever it says itself.
        """
        self._entries = {entry["name"]: entry for entry in entries}
        self._shadows = shadows

    def names(self):
        return list(self._entries)

    def entries(self):
        return list(self._entries.values())

    def become(self, entries):
        """Makes these the lights; simulations have them already."""
        self._entries = {entry["name"]: entry for entry in entries}

    def entry(self, name):
        """A copy, to be changed and given to set(). Raises: UnknownEntityError."""
        try:
            return dict(self._entries[name])
        except KeyError:
            raise UnknownEntityError("Requested light %s not found!" % name) from None

    def spawned(self, name, xml, pose):
        """The entry of a light that is new.

        Args:
            xml: <light> of SDF.  pose: (4, 4), of the frame that the element stands in.
        Raises:
            SpawnError: the name is taken, what is wrong with the text.
        """
        if name in self._entries:
            raise SpawnError("SpawnModel: Failure - entity already exists.")
        try:
            entry = light_entry(xml)
        except ArasError as error:
            raise SpawnError("SpawnModel: Failure - entity format is invalid: %s" % error) from error
        entry["name"] = name
        if "position_m" in entry:
            entry["position_m"] = [float(x) for x in (pose @ (*entry["position_m"], 1.0))[:3]]
        if "direction" in entry:
            entry["direction"] = [float(x) for x in pose[:3, :3] @ entry["direction"]]
        return entry

    def take(self, lights, core):
        """These in place of those there are; the first ones, if there are too many.

        Args:
            lights: text of <light> by name.  core: aras_visual_servo_sim.World.
        Returns:
            a line for each that is left out.
        """
        for name in self.names():
            self.delete(name, core)
        warnings = []
        for name, xml in lights.items():
            try:
                self.set(self.spawned(name, xml, numpy.eye(4)), core)
            except (BadValueError, SpawnError) as error:
                warnings.append("light '%s': %s: ignored" % (name, error))
        return warnings

    def set(self, entry, core):
        """Adds a light, or changes the one of its name. Raises: BadValueError; nothing changes then."""
        try:
            core.set_light(entry if self._shadows else {**entry, "casts_shadows": False})
        except ArasError as error:
            raise BadValueError(str(error)) from error
        self._entries[entry["name"]] = entry

    def delete(self, name, core):
        """Raises: UnknownEntityError."""
        self.entry(name)
        core.delete_light(name)
        del self._entries[name]

    def apply(self, core):
        """Makes these the lights of a world that has the one of its start, the sun."""
        if "sun" not in self._entries and "sun" in core.lights:
            core.delete_light("sun")
        for entry in self.entries():
            self.set(entry, core)


def turned(direction, rotation):
    """A direction in the axes of a pose (3, 3), in world axes."""
    return [float(x) for x in numpy.asarray(rotation) @ numpy.asarray(direction, float)]
