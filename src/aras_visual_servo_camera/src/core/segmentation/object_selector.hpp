#pragma once

#include <vector>

#include "aras_visual_servo_camera/config/vision_config.hpp"

namespace aras_visual_servo_camera {

/** One object of an image, as far as the choice is concerned. */
struct Candidate {
  double u_px, v_px, area_px;
  int u_min, u_max, v_min, v_max;
  bool cut;              ///< by the image border: its area is not all of it
  bool speck;            ///< below min_area_px: only good for going on with the object followed
  double dissimilarity;  ///< from the reference's shape; NaN: not asked for; infinite: a line or a point
};

/** Which object of an image is the target: keeps to the one it follows.
 *
 *  An object goes on as the one nearest to it in the next image, up to half the distance between two objects and half
 * to double its area. The followed one is left only for one that was better by `switch_ratio` in `switch_images` images
 *  one after another. What is seen beside it is known as another, and never taken for it when it is gone. Where two
 *  objects qualify and neither is better by `switch_ratio`, and where the followed one has merged with another, the
 *  answer is that it is not clear (docs/theory.md T39). */
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
    int candidate;  ///< that it goes on as in this image; -1: none
  };

  void associate(const std::vector<Candidate>& candidates);
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
