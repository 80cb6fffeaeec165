"""Published protocols by name: one file of this room is one protocol; `base` says how to write one."""

from .base import Case, Protocol, known_protocols, protocol_named, register_protocol

__all__ = ["Case", "Protocol", "known_protocols", "protocol_named", "register_protocol"]
