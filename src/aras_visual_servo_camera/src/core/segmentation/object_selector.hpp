#pragma once

#include <vector>

#include "aras_visual_servo_camera/config/vision_config.hpp"

namespace aras_visual_servo_camera {

/** What the choice of the target needs to know of one object in an image. */
struct Candidate {
  double u_px, v_px, area_px;
  int u_min, u_max, v_min, v_max;
  bool cut;              ///< by the image border: its area is not all of it
  bool speck;            ///< below min_area_px: it may only continue the object followed
  double dissimilarity;  ///< from the reference's shape; NaN: not asked for; infinite: a line or a point
};

/** Chooses which object of an image is the target, and keeps to the one that it follows.
 *
 *  An object is taken to be the nearest one in the next image, if it has moved by less than half the distance between
 *  two objects and has half to double its area. The selector changes to another object only when that was better by
 *  `switch_ratio` in `switch_images` successive images. An object that is seen beside the followed one is remembered as
 *  another one, and is not taken for the followed one when that is gone. The choice is ambiguous where two objects
 *  qualify and neither is better by `switch_ratio`, and where the followed one has merged with another
 *  (docs/theory.md T39). */
class ObjectSelector {
 public:
  explicit ObjectSelector(const VisionConfig& config) : config_(config) {}

  struct Choice {
    int index = -1;          ///< of the candidates; -1: none
    bool ambiguous = false;  ///< there are candidates, and it is not clear which
  };
  Choice choose(const std::vector<Candidate>& candidates);

  void forget();

 private:
  struct Track {
    double u_px, v_px, area_px;
    int unseen;  ///< images since it was seen last
    bool target;
    int candidate;  ///< the candidate of this image that is this object; -1: none
  };

  void associate(const std::vector<Candidate>& candidates);
  /** Whether a candidate is an object that is known and is not the target. */
  bool isAnother(int candidate) const;
  bool coversAnother(const Candidate& candidate) const;
  int joined(const std::vector<Candidate>& candidates) const;
  bool better(const Candidate& a, const Candidate& b) const;
  Choice best(const std::vector<Candidate>& candidates, const std::vector<int>& eligible) const;
  Choice keepOrSwitch(const std::vector<Candidate>& candidates, int followed);
  Choice acquire(const std::vector<Candidate>& candidates);
  Choice recover(const std::vector<Candidate>& candidates);
  void remember(const std::vector<Candidate>& candidates, const Choice& choice);
  const Track* target() const;

  VisionConfig config_;
  std::vector<Track> tracks_;
  bool unsure_ = false;             // the target has merged with another object
  std::size_t before_merging_ = 0;  // objects in view then
  int better_for_ = 0, alone_for_ = 0;
};

}  // namespace aras_visual_servo_camera
