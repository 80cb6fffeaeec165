"""Settings of the world."""
import dataclasses
import typing


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
