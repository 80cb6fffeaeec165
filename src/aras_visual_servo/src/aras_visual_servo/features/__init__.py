"""Image features by name, and where they come from. Each file of this room is one kind of feature, each file of
`sources` is one source of features; the module `base` of either folder says how to write a new one.
"""
