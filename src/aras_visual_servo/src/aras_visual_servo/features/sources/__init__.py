"""Where features come from, by name. Each file of this folder is one source; `base` says how to write one."""

from .base import Source, Taught, known_sources, register_source, source_named

__all__ = ["Source", "Taught", "known_sources", "register_source", "source_named"]
