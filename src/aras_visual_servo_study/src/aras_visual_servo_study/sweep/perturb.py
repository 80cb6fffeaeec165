"""What a sweep may vary beside the start: scenario section `sweep.perturb`, name -> [low, high] or {values: [...]}.

The perturbations in `KNOWN` have names of their own. Any other number or choice in the sections DOTTED_SECTIONS is
varied by its dotted path, e.g. `servo.gains_per_s.xn: [1.0, 5.0]`.
"""

import copy
import json
import os
import xml.etree.ElementTree as ElementTree
from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any, Dict, List, Sequence

from aras_visual_servo import (ParameterError, Perturbations, Scenario, default_of, is_number, keys_of, load_yaml,
                               resolve_uri)

#: Those with a name of their own, and the lowest value allowed where a lower one has no meaning.
KNOWN = {key.name: key.at_least for key in keys_of(Perturbations)}
DOTTED_SECTIONS = ("sim", "vision", "servo", "experiment")
#: Perturbations for which a scenario has no key, each with the value that changes nothing.
BESIDE = {"pid_gain_scale": 1.0, "friction_scale": 1.0, "damping_scale": 1.0, "focal_error": 0.0,
          "principal_point_error_px": 0.0}


@dataclass(frozen=True)
class Perturbation:
    """One thing that varies: uniform in [low, high], or one of `values`."""

    name: str
    low: float = 0.0
    high: float = 0.0
    values: tuple = ()

    def at(self, u: float) -> Any:
        """Value at u in [0, 1)."""
        if self.values:
            return self.values[min(int(u * len(self.values)), len(self.values) - 1)]
        return float(self.low + u * (self.high - self.low))

    def ends(self) -> Sequence[Any]:
        """Values to try: a scenario that accepts these accepts all of them."""
        return self.values or (self.low, self.high)


def read_perturbations(section: Mapping[str, Any], scenario: Scenario) -> List[Perturbation]:
    """Perturbations of the section, in the order of the file. Each is tried on the scenario. Raises ParameterError."""
    faults, found = [], []
    for name, source in section.items():
        where = f"sweep.perturb.{name}"
        perturbation = _read(name, source)
        if perturbation is None:
            faults.append(f"{where}: found {source}, allowed [low, high] with low <= high, or {{values: [...]}}")
        elif name not in KNOWN and not _is_path(name, scenario):
            faults.append(f"{where}: found an unknown name, allowed {', '.join(KNOWN)}, and dotted paths of the "
                          f"sections {', '.join(DOTTED_SECTIONS)} without experiment.start, e.g. servo.gains_per_s.xn")
        else:
            for value in perturbation.ends():
                try:
                    _check_value(name, value)
                    perturbed(scenario, {name: value})
                except ParameterError as error:
                    faults += [f"{where}: {fault}" for fault in error.faults if f"{where}: {fault}" not in faults]
            found.append(perturbation)
    if faults:
        raise ParameterError(faults)
    return found


def perturbed(scenario: Scenario, parameters: Dict[str, Any]) -> Scenario:
    """The scenario with these values of perturbations put in. Raises ParameterError: it refuses a value."""
    if not parameters:
        return scenario
    overrides = {name: value for name, value in parameters.items() if name not in KNOWN}
    if "z_star_error" in parameters:
        z_star_m = overrides.get("experiment.z_star_m", scenario.experiment["z_star_m"])
        overrides["experiment.z_star_m"] = z_star_m * (1.0 + parameters["z_star_error"])
    if {"noise_stddev", "latency_images", "latency_s"} & set(parameters):
        overrides["sim.cameras"] = [_camera(camera, parameters) for camera in scenario.sim["cameras"]]
    if "target" in parameters or "target_scale" in parameters:
        overrides["sim.scene.models"] = _models(scenario, parameters)
    scenario = scenario.with_overrides(overrides) if overrides else scenario
    beside = {name: parameters.get(name, nothing) for name, nothing in BESIDE.items()}
    if beside == BESIDE:
        return scenario
    values = {field.name: getattr(scenario, field.name) for field in fields(Scenario)}
    return _PerturbedScenario(**values, beside=beside)


def swap_picture(sim: Any, scenario: Scenario, file: str) -> None:
    """Give the first model of the scene that has a picture another one, until the next reset of the Simulation.

    Raises ParameterError: no model has a picture.
    """
    for model in scenario.sim["scene"].get("models", []):
        if "image" in model:
            sim.delete_model(model["name"])
            sim.spawn_model({**model, "image": {**model["image"], "file": str(resolve_uri(file, scenario._base))}})
            return
    raise ParameterError("picture: the scene has no model with a picture")


def put_clutter(sim: Any, scenario: Scenario, file: str) -> None:
    """Put the solids and lights of a file into the scene, until the next reset of the Simulation.

    A light of a name that the scene has takes its place. Raises ParameterError and the errors of the simulator.
    """
    clutter = load_yaml(resolve_uri(file, scenario._base))
    for solid in clutter.get("solids", []):
        sim.spawn_model(solid)
    for light in clutter.get("lights", []):
        sim.set_light(light)


def simulator_key(scenario: Scenario, parameters: Dict[str, Any]) -> str:
    """A text that is equal for two runs if one Simulation can serve both."""
    scales = {name: value for name, value in parameters.items() if name.endswith("_scale")}
    return json.dumps([scenario.robot, scenario.sim, scales], sort_keys=True)


@dataclass(frozen=True)
class _PerturbedScenario(Scenario):
    """A scenario whose robot differs from its files, or whose camera is believed to have another calibration."""

    beside: dict = None

    def believed_camera_info(self, camera_info):
        believed = copy.deepcopy(camera_info)
        for matrix, width in (("K", 3), ("P", 4)):
            entries = list(believed[matrix])
            for row in (0, 1):
                entries[row * width + row] *= 1.0 + self.beside["focal_error"]
                entries[row * width + 2] += self.beside["principal_point_error_px"]
            believed[matrix] = entries
        return believed

    def urdf_xml(self):
        root = ElementTree.fromstring(super().urdf_xml())
        for dynamics in root.iterfind("./joint/dynamics"):
            for name, factor in (("friction", "friction_scale"), ("static_friction", "friction_scale"),
                                 ("damping", "damping_scale")):
                if name in dynamics.attrib:
                    dynamics.set(name, repr(float(dynamics.get(name)) * self.beside[factor]))
        return ElementTree.tostring(root, encoding="unicode")

    def controllers(self):
        controllers = super().controllers()
        for controller in controllers.values():
            pid = controller.get("pid") if isinstance(controller, dict) else None
            for name in ("p", "i", "d"):
                if pid and name in pid:
                    pid[name] = pid[name] * self.beside["pid_gain_scale"]
        return controllers


def _read(name, source):
    if isinstance(source, Mapping):
        values = source.get("values")
        return Perturbation(name, values=tuple(values)) if list(source) == ["values"] and values else None
    if not isinstance(source, (list, tuple)) or not source:
        return None
    if all(isinstance(value, str) for value in source):
        return Perturbation(name, values=tuple(source))
    numbers = [value for value in source if is_number(value)]
    if len(numbers) != len(source) or len(numbers) != 2 or numbers[0] > numbers[1]:
        return None
    return Perturbation(name, float(numbers[0]), float(numbers[1]))


def _check_value(name, value):
    if name == "target":
        if not isinstance(value, str):
            raise ParameterError(f"found {value}, allowed the name of a target file")
        resolve_uri(_target_uri(value), key="target")
    elif name in ("picture", "clutter", "scene"):
        if not isinstance(value, str):
            raise ParameterError(f"found {value}, allowed the name of a file")
        resolve_uri(value, key=name)
    elif name in KNOWN and (not is_number(value) or value < KNOWN[name]):
        raise ParameterError(f"found {value}, allowed >= {KNOWN[name]:g}")


def _is_path(name, scenario):
    """Whether the dotted path names a plain value of the scenario, or a key of a section that could hold one."""
    section, *keys = name.split(".")
    if section not in DOTTED_SECTIONS or not keys or name.startswith("experiment.start"):
        return False
    node = getattr(scenario, section)
    for key in keys[:-1]:
        node = node.get(key, {}) if isinstance(node, Mapping) else None
    return isinstance(node, Mapping) and not isinstance(node.get(keys[-1]), (Mapping, list))


def _camera(camera, parameters):
    camera = dict(camera)
    if "noise_stddev" in parameters:
        camera["noise_stddev"] = parameters["noise_stddev"]
    images = int(parameters.get("latency_images", 0))
    if images:
        rate_hz = camera.get("rate_hz", default_of("sim.cameras.rate_hz"))
        camera["latency_s"] = camera.get("latency_s", 0.0) + images / rate_hz
    if "latency_s" in parameters:
        camera["latency_s"] = camera.get("latency_s", 0.0) + parameters["latency_s"]
    return camera


def _models(scenario, parameters):
    models = copy.deepcopy(scenario.sim["scene"].get("models", []))
    if not models:
        raise ParameterError("the scene has no model to change")
    if "target" in parameters:
        index = next((i for i, model in enumerate(models) if model["name"] == "target"), 0)
        for key in ("outlines_m", "color_rgb", "board", "image"):
            models[index].pop(key, None)
        models[index]["file"] = _target_uri(parameters["target"])
    scale = parameters.get("target_scale", 1.0)
    return models if scale == 1.0 else [_scaled_model(model, scale, scenario) for model in models]


def _scaled_model(model, scale, scenario):
    model = dict(model)
    if "file" in model:
        shape = load_yaml(resolve_uri(model.pop("file"), scenario._base))
        shape.pop("name", None)
        model = {**shape, **model}
    if "outlines_m" in model:
        model["outlines_m"] = [[[x * scale, y * scale] for x, y in outline] for outline in model["outlines_m"]]
    if "image" in model:
        model["image"] = {**model["image"], "size_m": [length * scale for length in model["image"]["size_m"]]}
    return model


def _target_uri(name):
    has_path = os.sep in name or name.endswith((".yaml", ".yml"))
    return name if has_path else f"package://aras_description/targets/{name}.yaml"
