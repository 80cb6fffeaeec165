"""Control laws by name. One file of this room is one kind of law; `base` says how to write one."""

from ..config.settings import setting
from .base import Law, LawSetup, adaptive_factor, known_laws, law_settings, make_law, register_law, sampled_gains
from .look import Answer, Look

__all__ = ["Answer", "Law", "LawSetup", "Look", "adaptive_factor", "known_laws", "law_settings", "make_law", "register_law",
           "sampled_gains", "setting"]
