"""Image features by name, and where they come from. Each file of this room is one kind of feature, each file of
`sources` is one source of features; the module `base` of either folder says how to write a new one.
"""

from ..config.settings import setting
from .base import (Feature, FeatureSet, View, expand, feature_settings, is_known, known_features, register_family,
                   register_feature, spread, wrapped)
from .sources import Source, Taught, known_sources, register_source, source_named
from .style import FeatureStyle, styles

__all__ = ["Feature", "FeatureSet", "FeatureStyle", "Source", "Taught", "View", "expand", "feature_settings",
           "is_known", "known_features", "known_sources", "register_family", "register_feature",
           "register_source", "setting", "source_named", "spread", "styles", "wrapped"]
