"""The lights of the world, which shine in the scene of every model that has cameras."""
import json

import numpy

from aras_visual_servo_sim import ArasError, light_entry

from .errors import BadValueError, SpawnError, UnknownEntityError

#: The light of a world that names none, model://sun: what the simulator has with `compatibility: gazebo`.
SUN = {"name": "sun", "type": "directional", "direction": [-0.5, 0.5, -1.0], "color_rgb": [204.0] * 3,
       "specular_rgb": [25.5] * 3, "casts_shadows": True}
MOST = 8  #: of one scene, as the simulator has it


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

    def take(self, lights, simulations):
        """These in place of those there are; the first ones, if there are too many.

        Args:
            lights: text of <light> by name.
        Returns:
            a line for each that is left out.
        """
        before, self._entries, warnings = self._entries, {}, []
        for name, xml in lights.items():
            try:
                entry = self.spawned(name, xml, numpy.eye(4))
                light_entry(json.dumps(entry))
            except (ArasError, SpawnError) as error:
                warnings.append("light '%s': %s: ignored" % (name, error))
                continue
            if len(self._entries) == MOST:
                warnings.append("light '%s': allowed are up to %d lights: ignored" % (name, MOST))
                continue
            self._entries[name] = entry
        after, self._entries = self._entries, before
        self._change(before, after, simulations)
        return warnings

    def set(self, entry, simulations):
        """Adds a light, or changes the one of its name. Raises: BadValueError; nothing changes then."""
        try:
            light_entry(json.dumps(entry))  # also where there is no camera whose simulation would refuse it
        except ArasError as error:
            raise BadValueError(str(error)) from error
        before, after = self._entries, {**self._entries, entry["name"]: entry}
        if len(after) > MOST:
            raise BadValueError("lights: found %d, allowed up to %d" % (len(after), MOST))
        self._change(before, after, simulations)

    def delete(self, name, simulations):
        """Raises: UnknownEntityError."""
        self.entry(name)
        after = {key: entry for key, entry in self._entries.items() if key != name}
        self._change(self._entries, after, simulations)

    def _change(self, before, after, simulations):
        self._entries = after
        try:
            for simulation in simulations:
                self.apply(simulation, before)
        except ArasError as error:
            self._entries = before
            for simulation in simulations:
                self.apply(simulation, after)
            raise BadValueError(str(error)) from error

    def apply(self, simulation, before=("sun",)):
        """Makes these the lights of a simulation, besides those of its links.

        Args:
            before: names of those that it has of the world.
        """
        there = simulation.lights
        for name in before:
            if name in there and name not in self._entries:
                simulation.delete_light(name)
        for name, entry in self._entries.items():
            if not self._shadows:
                entry = {**entry, "casts_shadows": False}
            if there.get(name) != entry:
                simulation.set_light(entry)


def turned(direction, rotation):
    """A direction in the axes of a pose (3, 3), in world axes."""
    return [float(x) for x in numpy.asarray(rotation) @ numpy.asarray(direction, float)]
