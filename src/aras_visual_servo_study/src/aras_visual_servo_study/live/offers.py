"""What a law needs beside its name, offered to a page: features, and settings that these need.

    offer = offer_for(scenario, "pbvs")     # {"law": ..., "features": [...], "values": {...}, "reset": False}
"""

from typing import Any, Dict, Iterator, List, Optional, Sequence

from aras_visual_servo import ParameterError, Scenario, works_on
from .settings import acts_at_once, changed
from .view.scene import scene_of

CORNERS = 4


def _extras(scenario: Scenario) -> Iterator[Dict[str, Any]]:
    """Settings that features of some laws need, the least first."""
    yield {}
    models = scenario.sim.get("scene", {}).get("models", [])
    if models and "file" in models[0]:
        yield {"servo.target_model": models[0]["file"]}
    yield {"vision.photometric": {}}
    outlines = scene_of(scenario)["models"][0]["outlines"] if models else []
    if len(outlines) == 1 and len(outlines[0]) == CORNERS:
        yield {"servo.pose_from": "points", "vision.points": "corners", "vision.point_count": CORNERS}


def offer_for(scenario: Scenario, law: str) -> Dict[str, Any]:
    """Returns what has to be set, for JSON, so that a scenario servoes with another law.

    law, features: of the scenario then.  values: dotted path -> value.  reset: whether some of it waits for a reset.
    Raises: ParameterError: the law is not known, or what it needs is not here, for each way that was tried.
    """
    values: Dict[str, Any] = {"servo.law": law}
    try:
        features: Optional[Sequence[str]] = works_on(law)
    except KeyError:
        features = None  # the check of the scenario says what is allowed
    if features is not None:
        values["servo.features"] = list(features)
    faults: List[Any] = []
    for extra in _extras(scenario):
        tried = {**values, **extra}
        try:
            servo = changed(scenario, tried).servo
        except ParameterError as error:
            faults += [fault for fault in error.faults if fault not in faults]
            continue
        names = servo.get("features", ()) if features is None else features
        return {"law": law, "features": list(names), "values": tried, "reset": not all(map(acts_at_once, tried))}
    raise ParameterError(faults)
