"""The whole state of a world as bytes: a world that gets it back goes on exactly as this one does."""
import base64
import hashlib
import json
import typing

import numpy

from aras_visual_servo_sim import ArasError, ParameterError

from .model import Model
from .settings import WorldSettings, world_of

if typing.TYPE_CHECKING:
    from .world import World

FORMAT = "state of a world, 4"


def listed(spawned: typing.Tuple[typing.Any, ...]) -> typing.List[typing.Any]:
    """Returns Model.spawned in JSON types."""
    return [part.tolist() if isinstance(part, numpy.ndarray) else list(part) if isinstance(part, tuple) else part
            for part in spawned]


def saved(world: "World") -> bytes:
    """bytes; the same of two worlds to which the same was done."""
    return json.dumps({
        "format": FORMAT, "epoch_ns": world.epoch_ns, "state": base64.b64encode(world.core.save_state()).decode(),
        "settings": vars(world.settings), "pushes": world.pushes.entries(),
        "models": [{"spawned": listed(model.spawned), "loaded": model.loaded} for model in world.models.values()]
    }).encode()


def digest(world: "World") -> str:
    """Hash of the state, 16 hexadecimal digits."""
    return hashlib.sha256(saved(world)).hexdigest()[:16]


def restore(world: "World", state: bytes) -> None:
    """Restores a world with the controllers of its models. Spawns missing models.

    Raises: ParameterError: no such state; nothing changes then.  ModelError: files that are gone.
    """
    try:
        record = json.loads(state)
        if record["format"] != FORMAT:
            raise ValueError
    except (ValueError, KeyError, TypeError) as error:
        raise ParameterError("restore_state: found bytes that are no state of a world, allowed are those of "
                             "save_state") from error
    settings = WorldSettings(**{key: tuple(value) if isinstance(value, list) else value
                                for key, value in record["settings"].items()})
    there = {model.name: listed(model.spawned) for model in world.models.values()}
    names = [entry["spawned"][0] for entry in record["models"]]
    core, models = world.core, {name: world.models.get(name) for name in names}
    # The simulator gets its state back in a world of the same robots and settings.
    if settings != world.settings or list(there.values()) != [entry["spawned"] for entry in record["models"]]:
        core = world_of(settings)
        for entry in record["models"]:
            name, xml, namespace, pose, X_MR, warnings = entry["spawned"]
            models[name] = Model(core, name, xml, namespace, numpy.array(pose), settings.gravity_m_s2,
                                 numpy.array(X_MR), warnings)
    try:
        core.restore_state(base64.b64decode(record["state"]))
    except ArasError as error:
        raise ParameterError("restore_state: %s" % error) from error
    for entry in record["models"]:
        name = entry["spawned"][0]
        if there.get(name) == entry["spawned"] and models[name] is not world.models[name]:
            vars(world.models[name]).update(vars(models[name]))  # existing references to the model stay valid
            models[name] = world.models[name]
        models[name].loaded = entry["loaded"]
    world.take(core, record["epoch_ns"], settings, models, record["pushes"])
