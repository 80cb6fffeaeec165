"""The whole state of a world as bytes: a world that gets it back goes on exactly as this one does."""
import base64
import hashlib
import json

import numpy

from aras_visual_servo_sim import ArasError

from .errors import BadValueError
from .model import Model
from .settings import WorldSettings

FORMAT = "state of a world, 2"


def listed(spawned):
    """What Model.spawned has, as JSON has it."""
    return [part.tolist() if isinstance(part, numpy.ndarray) else list(part) if isinstance(part, tuple) else part
            for part in spawned]


def saved(world):
    """bytes; the same of two worlds to which the same was done."""
    return json.dumps({
        "format": FORMAT, "epoch_ns": world.epoch_ns, "ticks": world.ticks,
        "settings": vars(world.settings), "lights": world.lights.entries(),
        "pushes": world.pushes.entries(),
        "models": [{"spawned": listed(model.spawned), "begun_ns": model.begun_ns, "guests": model.guests,
                    "host": model.host, "alone": model.alone, "loaded": model.loaded,
                    "state": base64.b64encode(model.simulation.save_state()).decode()}
                   for model in world.models.values()]}).encode()


def digest(world):
    """Hash of the state, 16 hexadecimal digits."""
    return hashlib.sha256(saved(world)).hexdigest()[:16]


def restore(world, state):
    """Makes a world what it was, controllers of its models included. Models that are not there are spawned anew.

    Raises:
        BadValueError: no such state; nothing changes then.  SpawnError: files that are gone.
    """
    try:
        record = json.loads(state)
        if record["format"] != FORMAT:
            raise ValueError
    except (ValueError, KeyError, TypeError) as error:
        raise BadValueError("restore_state: found bytes that are no state of a world, allowed are those of save_state"
                            ) from error
    settings = WorldSettings(**{key: tuple(value) if isinstance(value, list) else value
                                for key, value in record["settings"].items()})
    models = {}
    for entry in record["models"]:
        name, xml, namespace, pose, X_MR, warnings = entry["spawned"]
        present = world.models.get(name)
        if present is None or listed(present.spawned) != entry["spawned"] or present.settings != settings:
            present = Model(name, xml, namespace, numpy.array(pose), settings, 0, numpy.array(X_MR), warnings)
        models[name] = present
    before = saved(world)
    try:
        for entry, model in zip(record["models"], models.values()):
            model.simulation.restore_state(base64.b64decode(entry["state"]))
    except ArasError as error:
        for entry, model in zip(json.loads(before)["models"], world.models.values()):
            model.simulation.restore_state(base64.b64decode(entry["state"]))
        raise BadValueError("restore_state: %s" % error) from error
    for entry, model in zip(record["models"], models.values()):
        for key in ("begun_ns", "guests", "host", "alone", "loaded"):
            setattr(model, key, entry[key])
    world.take(record["epoch_ns"], record["ticks"], settings, models, record["lights"], record["pushes"])
