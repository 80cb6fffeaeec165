"""The world and its models."""
import dataclasses
import xml.etree.ElementTree as ElementTree

import numpy

from aras_visual_servo_sim import Simulation

from . import things
from .description import located
from .errors import BadValueError, SpawnError, UnknownEntityError
from .lights import Lights
from .model import Model
from .poses import IDENTITY
from .pushes import Pushes
from .rays import Rays
from ..sdf.document import NoFolders, expanded
from ..sdf.materials import resolve_scripts
from ..sdf.model import model_of
from ..sdf.world import GROUND, height_of
from ..urdf.properties import with_joint, with_link
from .settings import WorldSettings

#: Names of a frame that is none of a model.
WORLD_FRAMES = ("", "world", "map")


class World:
    """Models under one clock of integer nanoseconds. Not thread-safe.

    Each model is a simulation of its own. In it are the links of others that its cameras see, those of fixed models
    that it touches, and things (things.py). Simulations are stepped together, so that what moves in them touches.

    Attributes:
        settings: WorldSettings.
        models: dict of name -> Model, in the order in which they were spawned.
        lights: Lights.
        pushes: Pushes, wrenches and efforts from outside.
        rays: Rays, what lasers see.
    """

    def __init__(self, settings=None, folders=NoFolders()):
        """
        Args:
            folders: where packages, models and resources are, as NoFolders has it.
        """
        self.settings = settings or WorldSettings()
        self.models, self.lights = {}, Lights(shadows=self.settings.shadows)
        self.pushes = Pushes(self.models)
        self.rays = Rays(self)
        self._folders = folders
        self._ticks = 0
        self._epoch_ns = 0  #: time at which the period became what it is

    @property
    def period_ns(self):
        return round(1e9 * self.settings.period_s)

    @property
    def time_ns(self):
        """Simulated time, int [ns]."""
        return self._epoch_ns + self._ticks * self.period_ns

    def step(self, ticks=1):
        """Advances time by periods. Raises: BadValueError."""
        if ticks < 0:
            raise BadValueError("step: found %d periods, allowed >= 0" % ticks)
        for name in self.pushes.pushed:
            if self.models[name].host is not None:
                self._let_go(self.models[name])
        Simulation.step_together([model.simulation for model in self.models.values() if model.host is None], ticks)
        for model in self.models.values():
            if model.host is not None:
                things.follow(model, self.models[model.host])
        self._ticks += ticks

    def set_physics(self, period_s, gravity_m_s2):
        """From now on. Another period lets the joints rest where they are, and their controllers begin anew.

        Raises:
            BadValueError: the period cannot be; nothing changes then.
        """
        if not 1e-6 <= period_s <= 0.1:
            raise BadValueError("time_step: found %g s, allowed is 0.000001 to 0.1 s" % period_s)
        settings = dataclasses.replace(self.settings, gravity_m_s2=tuple(gravity_m_s2))
        if settings != self.settings:
            self._change_settings(settings)
        if period_s != self.settings.period_s:
            self._change_period(period_s)

    def remove_ground(self):
        """Takes the ground plane out. Raises: UnknownEntityError: there is none."""
        if not self.settings.ground:
            raise UnknownEntityError("DeleteModel: model does not exist")
        self._change_settings(dataclasses.replace(self.settings, ground=False))

    def change_link(self, name, link, properties):
        """Gives a link another mass. Args: properties: LinkProperties. Raises: as Model.remade."""
        model = self.model(name)
        self._change(model, model.remade(with_link(model.spawned[1], link, properties), self.settings))

    def change_joint(self, name, joint, properties):
        """Gives a joint other limits. Args: properties: JointProperties. Raises: as Model.remade."""
        model = self.model(name)
        self._change(model, model.remade(with_joint(model.spawned[1], joint, properties), self.settings))

    def _change(self, model, made):
        if model.host is not None:  # which simulates it as it was
            things.leave(model, self.models[model.host])
        model.become(made)
        self._find_hosts()
        self.pushes.act(self.time_ns)

    def _change_settings(self, settings):
        made = [model.remade(model.spawned[1], settings) for model in self.models.values()]  # all of them, or none
        self.settings = settings
        for model, other in zip(self.models.values(), made):
            model.become(other)
        self.pushes.act(self.time_ns)

    def _change_period(self, period_s):
        now_ns = self.time_ns
        self.settings = dataclasses.replace(self.settings, period_s=period_s)
        self._epoch_ns, self._ticks = now_ns, 0
        for model in self.models.values():
            model.begin_anew(self.settings, now_ns)
        self._introduce_all()
        self.pushes.act(now_ns)

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
        X_WM = self._free_place(name, frame) @ pose
        xml, warnings = painted(xml, self._folders)
        return self._add(Model(name, located(xml, self._folders), namespace, X_WM, self.settings, self.time_ns,
                               warnings=warnings))

    def spawn_sdf(self, name, xml, namespace="", pose=IDENTITY, frame="", transmissions=""):
        """Adds what an SDF document describes, a model or a light.

        Args:
            name: in place of the document's own.  pose: (4, 4), of the frame that the document's pose is given in.
            transmissions: a URDF whose <transmission>s tell which joints controllers may have.
        Returns:
            Model, None for a light.
        Raises:
            as spawn().
        """
        X_WF = self._free_place(name, frame)
        bare = xml.lstrip().startswith(("<model", "<light"))
        root, warnings = expanded("<sdf version='1.6'>%s</sdf>" % xml if bare else xml, False, self._folders)
        root = root.find("world") if root.find("world") is not None else root  # a world's first model, as Gazebo has it
        light, element = root.find("light"), root.find("model")
        if element is None and light is not None:
            self.spawn_light(name, ElementTree.tostring(light, encoding="unicode"), pose, frame)
            return None
        if element is None:
            raise SpawnError("SpawnModel: Failure - entity format is invalid: %s" %
                             ("; ".join(warnings) or "found neither <model> nor <light>"))
        model = model_of(element, self._folders)
        planes = [height_of(X_WF @ pose @ model.pose @ plane) for plane in model.planes]
        if name == GROUND and planes == [0.0]:  # it was deleted before
            self._change_settings(dataclasses.replace(self.settings, ground=True))
            return None
        return self.place_sdf(name, model, X_WF @ pose @ model.pose, namespace, transmissions, warnings)

    def place_sdf(self, name, model, X_WM, namespace="", transmissions="", warnings=()):
        """Adds a model as it was read.

        Args:
            model: SdfModel.  X_WM: (4, 4).
        Returns:
            Model
        Raises:
            SpawnError: the name is taken, what cannot be simulated.
        """
        self._free_place(name, "")
        urdf, said = painted(with_transmissions(model.urdf, transmissions), self._folders)
        warnings = (*warnings, *said)
        for height_m in filter(lambda each: each is not None, (height_of(X_WM @ plane) for plane in model.planes)):
            self.settings = dataclasses.replace(self.settings, floor_m=height_m)
        if any(height_of(X_WM @ plane) is None for plane in model.planes):
            warnings = (*warnings, "planes that are not horizontal cannot be touched")
        return self._add(Model(name, located(urdf, self._folders), namespace, X_WM, self.settings, self.time_ns,
                               model.X_MR, (*warnings, *model.warnings)))

    def _free_place(self, name, frame):
        """X_WF of a new model. Raises: SpawnError: the name cannot be, no such frame."""
        if not name or "::" in name:
            raise SpawnError("SpawnModel: Failure - found the name '%s', allowed is a name without ::" % name)
        if name in self.models or name == GROUND and self.settings.ground:
            raise SpawnError("SpawnModel: Failure - entity already exists.")
        try:
            return self.frame(frame)[0]
        except UnknownEntityError as error:
            raise SpawnError("SpawnModel: reference reference_frame not found, did you forget to scope the link by "
                             "model name?") from error

    def _add(self, model):
        self._introduce(model)
        if model.simulation.camera_names:
            self.lights.apply(model.simulation)
        self.models[model.name] = model
        self._find_hosts()
        return model

    def _find_hosts(self):
        """Gives a host to each thing that has none, or has had another thing where there is a robot now."""
        for thing in [model for model in self.models.values() if model.thing is not None and not model.alone]:
            host = things.host_for(thing, self.models.values())
            kept = thing.host is not None and (host is None or host.thing is not None or
                                               self.models[thing.host].thing is None)
            if host is None or kept:
                continue
            if thing.host is not None:
                things.leave(thing, self.models[thing.host])
            for guest in [each for each in self.models.values() if each.host == thing.name]:
                things.leave(guest, thing)
            things.enter(thing, host)

    def delete(self, name):
        """Removes a model. Raises: UnknownEntityError."""
        gone = self.model(name)
        if gone.host is not None:
            things.leave(gone, self.models[gone.host])
        for thing in self.models.values():
            if thing.host == name:
                things.leave(thing, gone)
        del self.models[name]
        self.pushes.forget(name)
        for other in self.models.values():
            for link in other.guests.pop(name, {}):
                other.simulation.delete_model(guest_name(name, link))
        self._find_hosts()

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
        model, _, link = name.partition("::") if name.partition("::")[0] in self.models else name.rpartition("::")
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

    def take_lights(self, lights):
        """These in place of those there are; text of <light> by name. Returns a line for each that is left out."""
        return self.lights.take(lights, self._viewers())

    def set_light(self, entry):
        """Adds a light, or changes the one of its name; a dict as sim.scene.lighting.lights[]. Raises: BadValueError.
        """
        self.lights.set(entry, self._viewers())

    def delete_light(self, name):
        """Raises: UnknownEntityError."""
        self.lights.delete(name, self._viewers())

    # --- what models have of each other

    def _introduce(self, newcomer):
        """Gives each model those links of the others that its cameras see or its own links touch."""
        newcomer.placed = lambda thrown: self._follow(newcomer, thrown)
        for other in self.models.values():
            self._receive(other, newcomer)
            self._receive(newcomer, other)

    @staticmethod
    def _receive(host, guest):
        seen, touched = bool(host.simulation.camera_names), host.touches(guest)
        links = host.guests.setdefault(guest.name, {})
        for link in guest.links if seen or touched else ():
            solid = guest.solid(link, seen, touched)
            if solid is None:
                continue
            host.simulation.spawn_model(solid)
            links[link] = "touches" in solid
            World._put(host, guest, link)

    def _let_go(self, thing):
        """Lets a thing leave its host for good."""
        thing.alone = True
        things.leave(thing, self.models[thing.host])

    def _follow(self, guest, thrown):
        """Puts what others touch of a model to where it is now."""
        if guest.host is not None and thrown:
            self._let_go(guest)
        elif guest.host is not None:
            things.put(guest, self.models[guest.host])
        for host in self.models.values():
            for link, touched in host.guests.get(guest.name, {}).items():
                if touched:  # what is only seen is put there before it is drawn
                    self._put(host, guest, link)

    @staticmethod
    def _put(host, guest, link):
        host.simulation.set_model_pose(guest_name(guest.name, link), *guest.place_of(link))

    def look(self, viewer):
        """Puts what the cameras of a model see of the others to where it is now; to be called before drawing."""
        for name, links in viewer.guests.items():
            viewer.simulation.follow_links(self.models[name].simulation,
                                           {guest_name(name, link): link for link in links})

    # --- the whole state

    @property
    def ticks(self):
        """Periods since the start, the last reset, or the last change of the period."""
        return self._ticks

    @property
    def epoch_ns(self):
        """Time of tick 0: when the period became what it is, int [ns]."""
        return self._epoch_ns

    def take(self, epoch_ns, ticks, settings, models, lights, pushes):
        """Makes this the world of another time; for snapshots."""
        self._epoch_ns, self._ticks, self.settings = epoch_ns, ticks, settings
        self.models.clear()
        self.models.update(models)
        self.lights.become(lights)
        self.pushes.become(pushes, self.time_ns)
        for model in models.values():
            model.placed = lambda thrown, model=model: self._follow(model, thrown)

    # --- starting again

    def reset_world(self):
        """Models back to where they were spawned, at rest; time goes on."""
        self.pushes.forget()
        for model in self.models.values():
            model.reset(self.time_ns, False)
        for model in self.models.values():  # what they have of each other began elsewhere
            for guest, links in model.guests.items():
                for link in links:
                    self._put(model, self.models[guest], link)
            if model.host is not None:
                things.put(model, self.models[model.host])

    def reset_simulation(self):
        """Time back to 0, models back to where they were spawned. Controllers that run begin anew."""
        self._ticks = self._epoch_ns = 0
        self.pushes.forget()
        for model in self.models.values():
            model.reset(0, True)
        self._introduce_all()

    def _introduce_all(self):
        """Gives models what they have of each other, when their simulations are new and have nothing."""
        known = dict(self.models)
        self.models.clear()
        for model in known.values():
            model.guests.clear()
            model.host, model.alone = None, False
        for name, model in known.items():  # a reset takes out what was spawned, other models and lights among it
            self._introduce(model)
            if model.simulation.camera_names:
                self.lights.apply(model.simulation)
            self.models[name] = model
        self._find_hosts()


def guest_name(model, link):
    """Name of a link in the scene of another model."""
    return "%s::%s" % (model, link)


def painted(xml, folders):
    """A URDF with what scripts of materials say in their place, and a list of what is ignored of them."""
    if "<script" not in xml:
        return xml, []
    try:
        robot = ElementTree.fromstring(xml)
    except ElementTree.ParseError:
        return xml, []  # who reads it says what is wrong
    warnings = []
    resolve_scripts(robot, folders, warnings)
    return ElementTree.tostring(robot, encoding="unicode"), warnings


def with_transmissions(urdf, described):
    """A URDF with the <transmission>s that another one has of its joints."""
    if not described:
        return urdf
    robot = ElementTree.fromstring(urdf)
    joints = {joint.get("name") for joint in robot.findall("joint")}
    try:
        robot.extend(each for each in ElementTree.fromstring(described).findall("transmission")
                     if joints.issuperset(end.get("name") for end in each.findall("joint")))
    except ElementTree.ParseError:
        return urdf  # no URDF: then it has none
    return ElementTree.tostring(robot, encoding="unicode")
