"""Pages from the templates of config/templates, all made by one Jinja environment."""

import contextlib
import functools
import os
import re
from pathlib import Path
from typing import Any

from ..files import share_dir


def render(template: str, /, **values: Any) -> str:
    """The page of config/templates/TEMPLATE with these values, str; a name in it without a value is an error."""
    return _environment().get_template(template).render(**values)


def colours() -> str:
    """The style sheet with the colours of all pages."""
    return (share_dir() / "web" / "colours.css").read_text(encoding="utf-8")


def script(*modules: str) -> str:
    """The modules of the folder web, each after those that it imports, as one script that needs no other file."""
    texts = [(share_dir() / "web" / name).read_text(encoding="utf-8") for name in modules]
    joined = "\n".join(re.sub(r"^import .*$|^export (?=const|class)", "", text, flags=re.MULTILINE) for text in texts)
    return "(() => {\n\"use strict\";\n" + joined + "\n})();\n"


@functools.lru_cache(maxsize=None)
def _environment():
    import jinja2  # slow to import

    class Compiled(jinja2.FileSystemBytecodeCache):
        """Templates are compiled once, as Python's modules are: in a folder of this user, by a hash of their text."""

        def dump_bytecode(self, bucket):
            with contextlib.suppress(OSError):  # a full disk: the next process compiles again
                super().dump_bytecode(bucket)

    compiled = None
    with contextlib.suppress(OSError, RuntimeError):  # there is no home, or it is read-only
        folder = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "aras_visual_servo"
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        about = folder.stat()
        if about.st_uid == os.getuid() and not about.st_mode & 0o022:  # what stands there is run
            compiled = Compiled(str(folder), f"{jinja2.__version__}_%s")
    environment = jinja2.Environment(autoescape=True, trim_blocks=True, lstrip_blocks=True, bytecode_cache=compiled,
                                     undefined=jinja2.StrictUndefined,
                                     loader=jinja2.FileSystemLoader(str(share_dir() / "config" / "templates")))
    environment.globals["colours"] = colours
    return environment
