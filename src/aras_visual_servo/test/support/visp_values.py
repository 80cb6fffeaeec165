"""Moment invariants of a polygon in the image and their interaction rows, as ViSP 3.5.0 has them."""

import numpy as np

PLANE = (0.3, -0.4, 1.7)
#: A polygon in the image, in a plane, and what ViSP 3.5.0 has for it with moments to order 6: value
#: (vpMomentCInvariant) and row (vpFeatureMomentCInvariant), but for the row of c5, which is not the derivative.
#: VispInvariants of aras_visual_servo_camera computes the values again, and shows c5's row to be wrong; the rows are
#:     vpMomentCommon common(vpMomentCommon::getSurface(object), vpMomentCommon::getMu3(object),
#:                           vpMomentCommon::getAlpha(object), 1.0);
#:     vpFeatureMomentCommon features(common);
#:     common.updateAll(object);
#:     features.updateAll(0.3, -0.4, 1.7);
#:     features.getFeatureCInvariant().interaction(1 << k)  // c1 is k = 0; sx, sy, px, py are k = 10 to 13
#: of a vpMomentObject(6), a DENSE_POLYGON.
POLYGON = np.array([[-0.15, -0.05], [0.15, -0.1], [0.1, 0.05], [0.05, 0.125], [-0.1, 0.1]])
VISP = {
    "c1": (-2.306633013296, [-7.02828769, -2.23919788, 0.632401582, -1.29182731, -0.385568852, 0]),
    "c2": (21.17623238498, [44.9143979, -17.8555145, -4.0585234, 5.80900733, 5.78306822, 0]),
    "c3": (0.5551113372762, [0.515316602, 0.154087835, -0.0334310638, 0.0928218316, -0.0123255628, 0]),
    "c4": (0.1268341769118, [-0.350824115, 0.155902684, 0.0323022328, -0.0441755461, -0.0487733812, 0]),
    "c5": (-0.4245021432336, None),
    "c6": (0.2561844374762, [0.874506075, -0.260501788, -0.0758326221, 0.119459281, 0.0934963663, 0]),
    "c7": (-3.248871231112, [0.978703538, 0.492011455, -0.102397773, 0.2262593, 0.0396468414, 0]),
    "c8": (17.09313437557, [-18.0765614, -4.35511311, 1.8019394, -3.50059511, -1.33900453, 0]),
    "c9": (0.3607953510602, [0.154635081, 1.05527031, -0.0102463545, 0.175500477, -0.199846121, 0]),
    "c10": (2.381893402321, [5.8617335, 3.35392198, -0.549606473, 1.63438572, -0.347159389, 0]),
    "sx": (0.3090295975548, [0.251636136, -0.912741412, -0.0179516237, -0.0346986999, 0.106103679, -0.306822424]),
    "sy": (0.3068224241651, [-0.21579149, 0.955900456, 0.0759890498, -0.0616706392, -0.171069314, 0.309029598]),
    "px": (0.0977848595007, [-0.268814539, -0.0856437544, 0.024187789, -0.0494091846, -0.0147470504, 0]),
    "py": (0.1896392921354, [0.0231066916, 0.0224551679, 0.0355351228, -0.0592897206, -0.0393974486, 0]),
}  # fmt: skip
