"""Descriptions of robots and worlds: plugins that are not simulated, models and meshes that are not there."""
import os
import typing

from ..sdf.document import NoFolders, found
from ..world.plugins import is_simulated
from .findings import Finding
from .lined import Lined


def findings_of(path: str, folders: NoFolders, text: typing.Optional[str] = None) -> typing.List[Finding]:
    """Returns list of Finding of a URDF, a model or a world.

    Args: folders: as World has them.  text: of the document, None: that of the file.
    """
    document = Lined(path, text)
    if text is not None:
        document.forget_lines()  # those of the text are not those of the file
    if document.root is None or document.fault:
        return [Finding("file", os.path.basename(path), path, document.fault)]
    return [*plugins(document), *models(document, folders), *meshes(document, folders)]


def plugins(document: Lined) -> typing.List[Finding]:
    """Returns plugins that do nothing here."""
    return [Finding("plugin", os.path.basename(plugin.get("filename", "")), document.where(plugin),
                    "is not simulated: ignored") for plugin in document.root.iter("plugin")
            if plugin.get("filename") and not is_simulated(os.path.basename(plugin.get("filename")))]


def models(document: Lined, folders: NoFolders) -> typing.List[Finding]:
    """Returns models that a world includes and that are nowhere."""
    return [Finding("model", (uri.text or "").strip(), document.where(uri), "is left out; a folder of it in "
                    "GAZEBO_MODEL_PATH is found") for include in document.root.iter("include")
            for uri in include.findall("uri") if not found((uri.text or "").strip(), folders)]


def meshes(document: Lined, folders: NoFolders) -> typing.List[Finding]:
    """Returns files of meshes that are not there, in URDF and SDF."""
    missing = []
    for mesh in document.root.iter("mesh"):
        uri = mesh.get("filename") or (mesh.findtext("uri") or "").strip()
        if "://" not in uri and not os.path.isabs(uri):
            uri = os.path.join(os.path.dirname(document.path), uri)
        if not any(map(os.path.isfile, (uri.replace("file://", "", 1), found(uri, folders)))):
            missing.append(Finding("mesh", uri, document.where(mesh), "is left out"))
    return missing
