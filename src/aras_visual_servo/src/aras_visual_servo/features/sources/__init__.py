"""Where features come from, by name. Each file of this folder is one source; `base` says how to write one."""
