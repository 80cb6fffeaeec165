"""Image features by name. One file of this room is one kind of feature; `base` says how to write one."""

from ..config.settings import setting
from .base import (Feature, FeatureSet, View, expand, feature_settings, is_known, known_features, register_family,
                   register_feature, spread, wrapped)
from .style import FeatureStyle, styles

__all__ = ["Feature", "FeatureSet", "FeatureStyle", "View", "expand", "feature_settings", "is_known", "known_features",
           "register_family", "register_feature", "setting", "spread", "styles", "wrapped"]
