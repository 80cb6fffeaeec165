"""Settings of the world, the simulator's world that is made of them, and its lights."""
import dataclasses
import typing

import numpy

from aras_visual_servo_sim import ArasError, ModelError, World, light_entry


#: Light of a world without lights, model://sun: the simulator's light with `compatibility: gazebo`.
SUN = {"name": "sun", "type": "directional", "direction": [-0.5, 0.5, -1.0], "color_rgb": [204.0] * 3,
       "specular_rgb": [25.5] * 3, "casts_shadows": True}
#: Visual of Gazebo's ground plane: 100 m wide, material Gazebo/Grey, no shadow.
GROUND_PLANE = {"name": "ground_plane", "box_m": [100.0, 100.0, 0.01], "position_m": [0.0, 0.0, -0.005],
                "color_rgb": [178.5] * 3,
                "material": {"ambient_share": 0.3 / 0.7, "specular_rgb": [2.55] * 3, "shininess": 1.5,
                             "casts_shadows": False}}
#: Coulomb's coefficient of a link that states none, as in Gazebo; of two that touch, the smaller one counts.
GROUND_FRICTION = 1.0


@dataclasses.dataclass
class WorldSettings:
    """Physics and light of the world, as a .world file and set_physics_properties have it."""
    period_s: float = 0.001
    gravity_m_s2: tuple = (0.0, 0.0, -9.8)  #: as SDF has it where a world gives none
    ground: bool = True  #: the model ground_plane: z = 0, seen by cameras, touched by models that move
    floor_m: typing.Optional[float] = None  #: height of another horizontal plane that can be touched
    ambient_rgb: tuple = (102.0, 102.0, 102.0)
    background_rgb: tuple = (178.5, 178.5, 178.5)
    shadows: bool = True  #: False: no light of the world casts any

    @property
    def plane_m(self) -> typing.Optional[float]:
        """Height of the plane that can be touched, None for none."""
        return 0.0 if self.ground else self.floor_m


def world_of(settings: WorldSettings) -> World:
    """Returns a world of the simulator with these settings and no robots."""
    known = WorldSettings()
    scene = {"solids": [GROUND_PLANE]} if settings.ground else {}
    if settings.background_rgb != known.background_rgb:
        scene["background_rgb"] = list(settings.background_rgb)
    if (settings.ambient_rgb, settings.shadows) != (known.ambient_rgb, known.shadows):
        scene["lighting"] = {"ambient_rgb": list(settings.ambient_rgb),
                             "lights": [{**SUN, "casts_shadows": settings.shadows}]}
    world = World({"compatibility": "gazebo", "period_s": settings.period_s, "scene": scene})
    world.set_ground(settings.plane_m, GROUND_FRICTION)
    return world


def light_of(name: str, xml: str, pose: numpy.ndarray) -> typing.Dict[str, typing.Any]:
    """Entry of the simulator's sim.scene.lighting.lights.

    Args: xml: <light> of SDF.  pose: (4, 4), of the frame that the element stands in.
    Raises: ModelError: a fault of the text.
    """
    try:
        entry = {**light_entry(xml), "name": name}
    except ArasError as error:
        raise ModelError("SpawnModel: Failure - entity format is invalid: %s" % error) from error
    if "position_m" in entry:
        entry["position_m"] = (pose @ (*entry["position_m"], 1.0))[:3].tolist()
    if "direction" in entry:
        entry["direction"] = (pose[:3, :3] @ entry["direction"]).tolist()
    return entry
