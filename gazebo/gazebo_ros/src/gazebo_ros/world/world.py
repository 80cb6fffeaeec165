"""The world and its models."""
import contextlib
import dataclasses
import typing
import xml.etree.ElementTree as ElementTree

import numpy

from aras_visual_servo_sim import ArasError, ModelError, ParameterError, UnknownNameError
from aras_visual_servo_sim import World as CoreWorld

from .description import located
from .model import Model
from .poses import IDENTITY
from .pushes import Pushes
from ..sdf.document import NoFolders, expanded
from ..sdf.materials import painted, with_transmissions
from ..sdf.model import SdfModel, model_of
from ..sdf.world import GROUND, height_of
from ..urdf.properties import LinkProperties, with_joint, with_link
from .settings import GROUND_FRICTION, GROUND_PLANE, WorldSettings, light_of, world_of

Entry = typing.Dict[str, typing.Any]  #: of a light or a push, as JSON has it
#: Names of a frame that is none of a model.
WORLD_FRAMES = ("", "world", "map")


@dataclasses.dataclass(frozen=True)
class Touch:
    """A point of contact of a link, in the world.

    Attributes:
        other: MODEL::LINK that it touches, or ground_plane.  point (3,) [m].  normal: (3,) from the other to the link.
        depth_m: how far they are in each other.  force: (3,) on the link [N].
    """
    other: str
    point: numpy.ndarray
    normal: numpy.ndarray
    depth_m: float
    force: numpy.ndarray


class World:
    """Models under one clock of integer nanoseconds. Not thread-safe.

    Attributes:
        settings: WorldSettings.
        core: aras_visual_servo_sim.World, whose robots are the models.
        models: dict of name -> Model, in the order in which they were spawned.
        pushes: Pushes, wrenches and efforts from outside.
    """

    def __init__(self, settings: typing.Optional[WorldSettings] = None, folders: NoFolders = NoFolders()) -> None:
        """Args: folders: where packages, models and resources are, as NoFolders has it."""
        self.settings = settings or WorldSettings()
        self.core, self.models = world_of(self.settings), {}
        self.pushes = Pushes(self.models)
        self._folders = folders
        self.before_ground = set()  #: names of the models that were there before the ground plane
        self.epoch_ns = 0  #: time of tick 0: start of the current period, int [ns]

    @property
    def period_ns(self) -> int:
        return self.core.period_ns

    @property
    def time_ns(self) -> int:
        """Simulated time, int [ns]."""
        return self.epoch_ns + self.core.time_ns

    def core_s(self, time_ns: int) -> float:
        """The simulator's own time at a time of this world [s]."""
        return 1e-9 * (time_ns - self.epoch_ns)

    def step(self, ticks: int = 1) -> None:
        """Advances time by periods. Raises: ParameterError."""
        if ticks < 0:
            raise ParameterError("step: found %d periods, allowed >= 0" % ticks)
        self.core.step(ticks)

    def set_physics(self, period_s: float, gravity_m_s2: typing.Sequence[float]) -> None:
        """From now on. Another period lets the joints rest where they are, and their controllers begin anew.

        Raises: ParameterError: the period cannot be; nothing changes then.
        """
        if not 1e-6 <= period_s <= 0.1:
            raise ParameterError("time_step: found %g s, allowed is 0.000001 to 0.1 s" % period_s)
        self.settings = dataclasses.replace(self.settings, gravity_m_s2=tuple(gravity_m_s2))
        for model in self.models.values():
            self._renew(model, model.spawned[1])
        if period_s != self.settings.period_s:
            self._change_period(period_s)

    def remove_ground(self) -> None:
        """Takes the ground plane out. Raises: UnknownNameError: there is none."""
        if not self.settings.ground:
            raise UnknownNameError("DeleteModel: model does not exist")
        self.core.delete_model(GROUND_PLANE["name"])
        self._change_ground(ground=False)

    def _change_ground(self, **keys: typing.Any) -> None:
        self.settings = dataclasses.replace(self.settings, **keys)
        self.core.set_ground(self.settings.plane_m, GROUND_FRICTION)

    def change_link(self, name: str, link: str, properties: LinkProperties) -> None:
        """Gives a link another mass. Args: properties: LinkProperties. Raises: as Model.renew."""
        model = self.model(name)
        self._renew(model, with_link(model.spawned[1], link, properties))

    def change_joint(self, name: str, joint: str, properties: typing.Dict[str, float]) -> None:
        """Gives a joint other damping, friction or limits. Args: properties: dict of them. Raises: as Model.renew."""
        model = self.model(name)
        self._renew(model, with_joint(model.spawned[1], joint, properties))

    def _renew(self, model: Model, xml: str) -> None:
        model.renew(self.core, xml, self.settings.gravity_m_s2)
        self.pushes.act(self.time_ns)

    def _change_period(self, period_s: float) -> None:
        self.epoch_ns = self.time_ns
        self.settings = dataclasses.replace(self.settings, period_s=period_s)
        lights, welds, self.core = self.lights, self.core.welds, world_of(self.settings)
        self._restore_lights(lights)
        for model in self.models.values():
            model.begin_anew(self.core, self.settings.gravity_m_s2)
        for one, other in welds:
            self.core.weld(one, other)
        self.pushes.act(self.time_ns)

    # --- models

    @property
    def names(self) -> typing.List[str]:
        """Of the models and the ground plane, in the order in which they came into the world, as Gazebo counts them
        (World::ModelByIndex)."""
        before = [name for name in self.models if name in self.before_ground]
        after = [name for name in self.models if name not in self.before_ground]
        return before + [GROUND] * self.settings.ground + after

    def spawn(self, name: str, xml: str, namespace: str = "", pose: numpy.ndarray = IDENTITY, frame: str = "") -> Model:
        """Adds a model.

        Args:
            xml: a URDF document.  namespace: of its plugins.  pose: (4, 4), in the frame.
            frame: "" or world, or MODEL or MODEL::LINK.
        Returns: Model
        Raises: ModelError: the name is empty or taken, or a fault of the URDF.  UnknownNameError: no such frame.
        """
        X_WM = self._free_place(name, frame) @ pose
        xml, warnings = painted(xml, self._folders)
        return self._add(name, located(xml, self._folders), namespace, X_WM, warnings=warnings)

    def spawn_sdf(self, name: str, xml: str, namespace: str = "", pose: numpy.ndarray = IDENTITY, frame: str = "",
                  transmissions: str = "") -> typing.Optional[Model]:
        """Adds the model or light of an SDF document.

        Args:
            name: in place of the document's own.  pose: (4, 4), of the frame that the document's pose is given in.
            transmissions: a URDF whose <transmission>s tell which joints controllers may have.
        Returns: Model, None for a light.
        Raises: as spawn().
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
            raise ModelError("SpawnModel: Failure - entity format is invalid: %s" %
                             ("; ".join(warnings) or "found neither <model> nor <light>"))
        model = model_of(element, self._folders)
        planes = [height_of(X_WF @ pose @ model.pose @ plane) for plane in model.planes]
        if name == GROUND and planes == [0.0]:  # it was deleted before
            self.core.spawn_model(GROUND_PLANE)
            self._change_ground(ground=True)
            self.before_ground = set(self.models)
            return None
        return self.place_sdf(name, model, X_WF @ pose @ model.pose, namespace, transmissions, warnings)

    def place_sdf(self, name: str, model: SdfModel, X_WM: numpy.ndarray, namespace: str = "", transmissions: str = "",
                  warnings: typing.Sequence[str] = ()) -> Model:
        """Adds a model as it was read.

        Args: model: SdfModel.  X_WM: (4, 4).
        Returns: Model
        Raises: ModelError: the name is taken, or the document cannot be simulated.
        """
        self._free_place(name, "")
        urdf, said = painted(with_transmissions(model.urdf, transmissions), self._folders)
        warnings = (*warnings, *said)
        for height_m in filter(lambda each: each is not None, (height_of(X_WM @ plane) for plane in model.planes)):
            self._change_ground(floor_m=height_m)
        if any(height_of(X_WM @ plane) is None for plane in model.planes):
            warnings = (*warnings, "planes that are not horizontal cannot be touched")
        return self._add(name, located(urdf, self._folders), namespace, X_WM, model.X_MR,
                         (*warnings, *model.warnings))

    def _free_place(self, name: str, frame: str) -> numpy.ndarray:
        """X_WF of a new model. Raises: ModelError: the name cannot be, no such frame."""
        if not name or "::" in name:
            raise ModelError("SpawnModel: Failure - found the name '%s', allowed is a name without ::" % name)
        if name in self.models or name == GROUND and self.settings.ground:
            raise ModelError("SpawnModel: Failure - entity already exists.")
        try:
            return self.frame(frame)[0]
        except UnknownNameError as error:
            raise ModelError("SpawnModel: reference reference_frame not found, did you forget to scope the link by "
                             "model name?") from error

    def _add(self, name: str, xml: str, namespace: str, X_WM: numpy.ndarray, X_MR: numpy.ndarray = IDENTITY,
             warnings: typing.Sequence[str] = ()) -> Model:
        try:
            model = Model(self.core, name, xml, namespace, X_WM, self.settings.gravity_m_s2, X_MR, warnings)
        except Exception as error:
            with contextlib.suppress(ArasError):
                self.core.delete(name)
            if isinstance(error, ArasError):
                raise
            raise ModelError("SpawnModel: Failure - model '%s': unexpected error: %s: %s" %
                             (name, type(error).__name__, error)) from error
        self.models[name] = model
        return model

    def delete(self, name: str) -> None:
        """Removes a model. Raises: UnknownNameError."""
        self.model(name)
        self.core.delete(name)
        del self.models[name]
        self.before_ground.discard(name)
        self.pushes.forget(name)

    def model(self, name: str) -> Model:
        """Raises: UnknownNameError."""
        try:
            return self.models[name]
        except KeyError:
            raise UnknownNameError("model '%s' does not exist, models are: %s" %
                                   (name, ", ".join(self.models) or "none")) from None

    def frame(self, name: str) -> typing.Tuple[numpy.ndarray, numpy.ndarray]:
        """X_WF (4, 4) and twist (6,) [v; w] in world axes of the world, a MODEL, a MODEL::LINK, or a LINK.

        Raises: UnknownNameError.
        """
        if name in WORLD_FRAMES:
            return IDENTITY, numpy.zeros(6)
        if name in self.models:
            return self.models[name].pose(), self.models[name].twist()
        model, link = self.scoped(name)
        return model.link_pose(link), model.link_twist(link)

    def scoped(self, name: str) -> typing.Tuple[Model, str]:
        """Model and link of MODEL::LINK, or of the name of a link that one model alone has. Raises: UnknownNameError.
        """
        model, _, link = name.partition("::") if name.partition("::")[0] in self.models else name.rpartition("::")
        owners = [self.model(model)] if model else [each for each in self.models.values() if link in each.links]
        if not link or not owners or link not in owners[0].links:
            raise UnknownNameError("link '%s' does not exist" % name)
        return owners[0], link

    def joint_owner(self, joint: str) -> Model:
        """The model that has a joint. Raises: UnknownNameError."""
        for model in self.models.values():
            if joint in model.simulation.joint_names:
                return model
        raise UnknownNameError("joint '%s' does not exist" % joint)

    # --- contacts and attachments

    def touches(self, model: str, link: str) -> typing.List[Touch]:
        """Returns list of Touch: contacts of a link of a model in the last step. Raises: UnknownNameError.
        """
        found = []
        for each in self.model(model).simulation.contacts:
            for own, other, sign in ((each["a"], each["b"], 1.0), (each["b"], each["a"], -1.0)):
                if own != link:
                    continue
                scoped = other if "::" in other or other not in self.models[model].links else model + "::" + other
                found.append(Touch(scoped, numpy.asarray(each["point_m"]), sign * numpy.asarray(each["normal"]),
                                   each["depth_m"], sign * numpy.asarray(each["force_n"])))
        return found

    def attach(self, one: str, other: str) -> None:
        """Holds a link to another where it is now, until detach() or a reset. Args: scoped names of links of two
        models. Raises: ArasError: no such links, of one model, or they are attached already."""
        self.core.weld(*self._scoped_names(one, other))

    def detach(self, one: str, other: str) -> None:
        """Lets two links go. Raises: UnknownNameError: they are not attached."""
        self.core.unweld(*self._scoped_names(one, other))

    def is_attached(self, one: str, other: str) -> bool:
        """Whether these two links are held to each other."""
        return {(one, other), (other, one)} & set(self.core.welds) != set()

    def _scoped_names(self, *names: str) -> typing.List[str]:
        return ["%s::%s" % (model.name, link) for model, link in map(self.scoped, names)]

    # --- lights

    @property
    def lights(self) -> typing.Dict[str, Entry]:
        """Entries of sim.scene.lighting.lights by name, besides the lights that links carry."""
        return {name: entry for name, entry in self.core.lights.items() if "attached_to" not in entry}

    def light(self, name: str) -> Entry:
        """A copy of the entry of a light, to be changed and given to set_light(). Raises: UnknownNameError."""
        try:
            return self.lights[name]
        except KeyError:
            raise UnknownNameError("Requested light %s not found!" % name) from None

    def spawn_light(self, name: str, xml: str, pose: numpy.ndarray = IDENTITY, frame: str = "") -> None:
        """Adds a light.

        Args: xml: a <light> of SDF.  pose: (4, 4), in the frame.  frame: as in spawn(); the light does not follow it.
        Raises: ModelError: the name is taken, or a fault of the text.  UnknownNameError, ParameterError.
        """
        if name in self.lights:
            raise ModelError("SpawnModel: Failure - entity already exists.")
        self.set_light(light_of(name, xml, self.frame(frame)[0] @ pose))

    def take_lights(self, lights: typing.Dict[str, str]) -> typing.List[str]:
        """Puts these in the place of those there are; the first ones, if there are too many.

        Args: lights: text of <light> by name.
        Returns: a line for each that is left out.
        """
        for name in self.lights:
            self.core.delete_light(name)
        warnings = []
        for name, xml in lights.items():
            try:
                self.spawn_light(name, xml)
            except ArasError as error:
                warnings.append("light '%s': %s: ignored" % (name, error))
        return warnings

    def set_light(self, entry: Entry) -> None:
        """Adds a light, or changes the one of its name. Raises: ArasError; nothing changes then."""
        self.core.set_light(entry if self.settings.shadows else {**entry, "casts_shadows": False})

    def delete_light(self, name: str) -> None:
        """Raises: UnknownNameError."""
        self.light(name)
        self.core.delete_light(name)

    def _restore_lights(self, lights: typing.Dict[str, Entry]) -> None:
        """Gives a world of the simulator that is at its start the lights that there were before."""
        for name in set(self.lights) - set(lights):
            self.core.delete_light(name)
        for name, entry in lights.items():
            if self.lights.get(name) != entry:
                self.set_light(entry)

    # --- rays

    def cast_rays(self, X_WS: numpy.ndarray, directions: numpy.ndarray, nearest_m: float, farthest_m: float,
                  visuals: bool) -> typing.Tuple[numpy.ndarray, numpy.ndarray]:
        """
        Args:
            X_WS: (4, 4), of the sensor.  directions: (n, 3), unit vectors in its axes.
            visuals: whether the rays meet <visual>s, only from outside; else <collision>s, from inside too.
        Returns: distances (n,) [m], infinite without a hit, and laser_retro of the hits, (n,).
        """
        distances, links = self.core.cast_rays(X_WS[:3, 3], directions @ X_WS[:3, :3].T, nearest_m, farthest_m, visuals)
        retros = [self.models[model].description.retros.get(link, 0.0)
                  for model, _, link in (name.partition("::") for name in self.core.link_names)]
        return distances, numpy.array([*retros, 0.0])[links]  # the last is that of nothing, number -1

    # --- the whole state

    def take(self, core: CoreWorld, epoch_ns: int, settings: WorldSettings,
             models: typing.Dict[str, Model], pushes: typing.List[Entry]) -> None:
        """Makes this the world of another time; for snapshots."""
        self.core, self.epoch_ns, self.settings = core, epoch_ns, settings
        self.models.clear()
        self.models.update(models)
        self.pushes.become(pushes, self.time_ns)

    # --- starting again

    def reset_world(self) -> None:
        """Models back to where they were spawned, at rest; time goes on."""
        self.pushes.forget()
        self.core.reset_world()
        self._lift()

    def reset_simulation(self) -> None:
        """Time back to 0, models back to where they were spawned. Controllers that run begin anew."""
        self.epoch_ns, lights = 0, self.lights
        self.pushes.forget()
        self.core.reset()
        if GROUND_PLANE["name"] in self.core.model_names and not self.settings.ground:
            self.core.delete_model(GROUND_PLANE["name"])
        elif GROUND_PLANE["name"] not in self.core.model_names and self.settings.ground:
            self.core.spawn_model(GROUND_PLANE)
        self._restore_lights(lights)
        self._lift()

    def _lift(self) -> None:
        for model in self.models.values():
            model.push({}, {})
