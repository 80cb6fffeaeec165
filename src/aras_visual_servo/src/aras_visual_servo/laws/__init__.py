"""Control laws by name. One file of this room is one kind of law; `base` says how to write one."""
