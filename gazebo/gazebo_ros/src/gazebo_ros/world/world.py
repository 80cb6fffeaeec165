"""The world that is empty at first."""
import dataclasses

import numpy

from .description import located
from .errors import BadValueError, SpawnError, UnknownEntityError
from .lights import Lights
from .model import Model
from .poses import IDENTITY
from .pushes import Pushes

#: Names of a frame that is none of a model.
WORLD_FRAMES = ("", "world", "map")


@dataclasses.dataclass
class WorldSettings:
    """Physics of the world, as a .world file and set_physics_properties have it."""
    period_s: float = 0.001
    gravity_m_s2: tuple = (0.0, 0.0, -9.81)
    ground: bool = True  #: a horizontal plane at z = 0 on which free models come to rest


class World:
    """Models under one clock of integer nanoseconds. Not thread-safe.

    Each model is simulated by itself: its joints, its contacts with the ground and its cameras; models do not touch
    each other, but their cameras see each other.

    Attributes:
        settings: WorldSettings.
        models: dict of name -> Model, in the order in which they were spawned.
        lights: Lights.
        pushes: Pushes, wrenches and efforts from outside.
    """

    def __init__(self, settings=None, find_folder=lambda name: None):
        """
        Args:
            find_folder: where a package:// or model:// of this name is, None if nowhere.
        """
        self.settings = settings or WorldSettings()
        self.models, self.lights = {}, Lights()
        self.pushes = Pushes(self.models)
        self._find_folder = find_folder
        self._ticks = 0

    @property
    def period_ns(self):
        return round(1e9 * self.settings.period_s)

    @property
    def time_ns(self):
        """Simulated time, int [ns]."""
        return self._ticks * self.period_ns

    def step(self, ticks=1):
        """Advances time by periods. Raises: BadValueError."""
        if ticks < 0:
            raise BadValueError("step: found %d periods, allowed >= 0" % ticks)
        for model in self.models.values():
            model.step(ticks)
        self._ticks += ticks

    def set_physics(self, period_s, gravity_m_s2):
        """Of models that are spawned from now on. The period can change before time has gone on.

        Raises: BadValueError.
        """
        if not 1e-6 <= period_s <= 0.1 or (self._ticks and period_s != self.settings.period_s):
            raise BadValueError("time_step: found %g s, allowed is %s" %
                                (period_s, "%g s: time has gone on" % self.settings.period_s if self._ticks else
                                 "0.000001 to 0.1 s"))
        self.settings = dataclasses.replace(self.settings, period_s=period_s, gravity_m_s2=tuple(gravity_m_s2))

    # --- models

    def spawn(self, name, xml, namespace="", pose=IDENTITY, frame=""):
        """Adds a model.

        Args:
            xml: a URDF document.  namespace: of its plugins.  pose: (4, 4), in the frame.
            frame: "" or world, or MODEL or MODEL::LINK.
        Returns:
            Model
        Raises:
            SpawnError: the name is empty or taken, what is wrong with the URDF.  UnknownEntityError: no such frame.
        """
        if not name or "::" in name:
            raise SpawnError("SpawnModel: Failure - found the name '%s', allowed is a name without ::" % name)
        if name in self.models or name == "ground_plane":
            raise SpawnError("SpawnModel: Failure - entity already exists.")
        try:
            X_WF = self.frame(frame)[0]
        except UnknownEntityError as error:
            raise SpawnError("SpawnModel: reference reference_frame not found, did you forget to scope the link by "
                             "model name?") from error
        model = Model(name, located(xml, self._find_folder), namespace, X_WF @ pose, self.settings, self.time_ns)
        self._introduce(model)
        if model.simulation.camera_names:
            self.lights.apply(model.simulation)
        self.models[name] = model
        return model

    def delete(self, name):
        """Removes a model. Raises: UnknownEntityError."""
        gone = self.model(name)
        del self.models[name]
        self.pushes.forget(name)
        for other in self.models.values():
            if other.simulation.camera_names:
                for link in gone.drawn_links:
                    other.simulation.delete_model(guest_name(name, link))

    def model(self, name):
        """Raises: UnknownEntityError."""
        try:
            return self.models[name]
        except KeyError:
            raise UnknownEntityError("model '%s' does not exist, models are: %s" %
                                     (name, ", ".join(self.models) or "none")) from None

    def frame(self, name):
        """X_WF (4, 4) and twist (6,) [v; w] in world axes of the world, a MODEL, a MODEL::LINK, or a LINK.

        Raises: UnknownEntityError.
        """
        if name in WORLD_FRAMES:
            return IDENTITY, numpy.zeros(6)
        if name in self.models:
            return self.models[name].pose(), self.models[name].twist()
        model, link = self.scoped(name)
        return model.link_pose(link), model.link_twist(link)

    def scoped(self, name):
        """Model and link of MODEL::LINK, or of the name of a link that one model alone has. Raises: UnknownEntityError.
        """
        model, _, link = name.rpartition("::")
        owners = [self.model(model)] if model else [each for each in self.models.values() if link in each.links]
        if not link or not owners or link not in owners[0].links:
            raise UnknownEntityError("link '%s' does not exist" % name)
        return owners[0], link

    def joint_owner(self, joint):
        """The model that has a joint. Raises: UnknownEntityError."""
        for model in self.models.values():
            if joint in model.simulation.joint_names:
                return model
        raise UnknownEntityError("joint '%s' does not exist" % joint)

    # --- lights

    def _viewers(self):
        return [model.simulation for model in self.models.values() if model.simulation.camera_names]

    def spawn_light(self, name, xml, pose=IDENTITY, frame=""):
        """Adds a light.

        Args:
            xml: a <light> of SDF.  pose: (4, 4), in the frame.  frame: as in spawn(); the light does not follow it.
        Raises:
            SpawnError, UnknownEntityError, BadValueError.
        """
        self.set_light(self.lights.spawned(name, xml, self.frame(frame)[0] @ pose))

    def set_light(self, entry):
        """Adds a light, or changes the one of its name; a dict as sim.scene.lighting.lights[]. Raises: BadValueError.
        """
        self.lights.set(entry, self._viewers())

    def delete_light(self, name):
        """Raises: UnknownEntityError."""
        self.lights.delete(name, self._viewers())

    # --- what cameras see of other models

    def _introduce(self, newcomer):
        """Lets the cameras of each model see the others: their links are solids of its scene."""
        for other in self.models.values():
            for viewer, guest in ((other, newcomer), (newcomer, other)):
                if viewer.simulation.camera_names:
                    for link in guest.drawn_links:
                        viewer.simulation.spawn_model({"name": guest_name(guest.name, link),
                                                       "urdf": guest.one_link(link)})

    def look(self, viewer):
        """Puts what the cameras of a model see of the others to where it is now; to be called before drawing."""
        for guest in self.models.values():
            if guest is not viewer:
                for link in guest.drawn_links:
                    pose = guest.simulation.link_pose(link)
                    viewer.simulation.set_model_pose(guest_name(guest.name, link), pose[:3, 3], guest.quaternion(pose))

    # --- starting again

    def reset_world(self):
        """Models back to where they were spawned, at rest; time goes on."""
        self.pushes.forget()
        for model in self.models.values():
            model.reset(self.time_ns, False)

    def reset_simulation(self):
        """Time back to 0, models back to where they were spawned. Controllers that run begin anew."""
        self._ticks = 0
        self.pushes.forget()
        for model in self.models.values():
            model.reset(0, True)
        known = dict(self.models)
        self.models.clear()
        for name, model in known.items():  # a reset takes out what was spawned, other models and lights among it
            self._introduce(model)
            if model.simulation.camera_names:
                self.lights.apply(model.simulation)
            self.models[name] = model


def guest_name(model, link):
    """Name of a link in the scene of another model."""
    return "%s::%s" % (model, link)
