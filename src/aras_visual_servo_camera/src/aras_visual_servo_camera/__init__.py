"""Image to moment features of a planar target (no ROS).

    extractor = MomentExtractor(camera_info, vision)     # two dicts
    features = extractor.process(image)                  # uint8, (h, w) grey or (h, w, 3) rgb
    extractor.set_reference(0.59, features)              # this view, seen from 0.59 m, is the goal

The attributes of `MomentFeatures` are the fields of aras_visual_servo_msgs/MomentFeatures.
"""

from ._camera import (ArasError, DegenerateFeature, MatchExtractor, MatchFeatures, MomentExtractor, MomentFeatures,
                      NotFiniteError, ParameterError, PhotometricExtractor, PhotometricFeatures, ShapeError,
                      TagExtractor, TagFeatures, image_info, in_rgb, undistort)

__all__ = ["ArasError", "DegenerateFeature", "MatchExtractor", "MatchFeatures", "MomentExtractor", "MomentFeatures",
           "NotFiniteError", "ParameterError", "PhotometricExtractor", "PhotometricFeatures", "ShapeError",
           "TagExtractor", "TagFeatures", "image_info", "in_rgb", "undistort"]
