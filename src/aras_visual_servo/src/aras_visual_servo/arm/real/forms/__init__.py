"""Forms of commands, one per file: what the driver of an arm takes."""
