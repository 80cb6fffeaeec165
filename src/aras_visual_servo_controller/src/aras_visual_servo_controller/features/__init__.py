"""Image features by name. One file of this room is one kind of feature; `base` says how to write one."""

from .base import (Feature, FeatureSet, View, expand, is_known, known_features, register_family, register_feature,
                   spread, wrapped)
from .style import FeatureStyle, styles

__all__ = ["Feature", "FeatureSet", "FeatureStyle", "View", "expand", "is_known", "known_features", "register_family",
           "register_feature", "spread", "styles", "wrapped"]
