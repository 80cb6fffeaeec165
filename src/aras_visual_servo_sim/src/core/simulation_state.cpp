// Saving and restoring a Simulation: a flat record in the byte order of this machine, one magic word first.
#include <cstring>
#include <type_traits>

#include "aras_visual_servo_sim/errors.hpp"
#include "aras_visual_servo_sim/simulation.hpp"

namespace aras_visual_servo_sim {
namespace {

/** Hash of the first `size` bytes. */
std::uint64_t checksum(const std::string& bytes, std::size_t size) {
  RunHash hash;
  hash.add(bytes.data(), size);
  return hash.state();
}

constexpr std::uint64_t kMagic = 0x32304d4953415241ULL;  // "ARASIM02"

class Writer {
 public:
  template <typename T>
  void put(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof(T));
  }
  void putText(const std::string& text) {
    put<std::uint64_t>(text.size());
    bytes_ += text;
  }
  /** The record, its checksum last. */
  std::string take() {
    put(checksum(bytes_, bytes_.size()));
    return std::move(bytes_);
  }

 private:
  std::string bytes_;
};

class Reader {
 public:
  /** @throws StateError if the record is not whole */
  explicit Reader(const std::string& bytes) : bytes_(bytes) {
    std::uint64_t sum = 0;
    if (bytes.size() >= sizeof(sum)) {
      end_ = bytes.size() - sizeof(sum);
      std::memcpy(&sum, bytes.data() + end_, sizeof(sum));
    }
    if (end_ == 0 || sum != checksum(bytes, end_)) {
      throw StateError("saved state: found " + std::to_string(bytes.size()) +
                       " bytes that are damaged, cut short or none of save_state's");
    }
  }
  template <typename T>
  T get() {
    static_assert(std::is_trivially_copyable_v<T>);
    T value;
    std::memcpy(&value, take(sizeof(T)), sizeof(T));
    return value;
  }
  std::string getText() {
    const auto size = get<std::uint64_t>();
    const char* data = take(size);
    return std::string(data, size);
  }
  bool atEnd() const { return at_ == end_; }

 private:
  const char* take(std::uint64_t size) {
    if (size > end_ - at_) throw StateError("saved state: found " + std::to_string(end_) + " bytes, needs more");
    const char* data = bytes_.data() + at_;
    at_ += size;
    return data;
  }
  const std::string& bytes_;
  std::size_t at_ = 0, end_ = 0;
};

struct FrameCounters {
  std::int64_t next_frame, unhashed_frame, asked;
  std::uint64_t dropped;
};

void putPose(Writer& out, const Pose& pose) {
  for (int k = 0; k < 3; ++k) out.put(pose.p[k]);
  for (int k = 0; k < 4; ++k) out.put(pose.q.coeffs()[k]);
}

Pose getPose(Reader& in) {
  Pose pose;
  for (int k = 0; k < 3; ++k) pose.p[k] = in.get<double>();
  for (int k = 0; k < 4; ++k) pose.q.coeffs()[k] = in.get<double>();
  return pose;
}

void putPoses(Writer& out, const std::vector<Pose>& poses) {
  out.put<std::uint64_t>(poses.size());
  for (const Pose& pose : poses) putPose(out, pose);
}

/** @throws StateError unless there are `count` of them */
std::vector<Pose> getPoses(Reader& in, std::size_t count) {
  if (in.get<std::uint64_t>() != count) throw StateError("saved state: exposure of another scene");
  std::vector<Pose> poses;
  for (std::size_t k = 0; k < count; ++k) poses.push_back(getPose(in));
  return poses;
}

void putMoment(Writer& out, const Moment& moment) {
  out.put(moment.tick);
  putPose(out, moment.X_WC);
  putPoses(out, moment.models);
  putPoses(out, moment.bodies);
}

Moment getMoment(Reader& in, const Scene& scene) {
  Moment moment;
  moment.tick = in.get<std::int64_t>();
  moment.X_WC = getPose(in);
  moment.models = getPoses(in, scene.models.size());
  moment.bodies = getPoses(in, scene.bodies.size());
  return moment;
}

}  // namespace

std::string Simulation::saveState() const {
  Writer out;
  out.put(kMagic);
  out.putText(world_->saveState());
  out.put(run_hash_.state());
  out.put(refused_commands_);
  out.putText(last_refusal_);
  out.put<std::uint64_t>(cameras_.size());
  for (const Camera& camera : cameras_)
    out.put(FrameCounters{camera.next_frame, camera.unhashed_frame, camera.asked, camera.dropped});
  const std::vector<std::string> models = modelNames();
  out.put<std::uint64_t>(models.size());
  for (const std::string& model : models) {
    const auto spawned = models_.spawned.find(model);
    out.putText(model);
    out.putText(spawned == models_.spawned.end() ? "" : spawned->second);
    putPose(out, modelPose(model));
    putPose(out, models_.starts.at(model));
  }
  out.put<std::uint64_t>(motions_.size());
  for (const auto& [name, run] : motions_) {
    out.putText(name);
    out.putText(run.motion.yaml());
    putPose(out, run.X_WM0);
    out.put(run.start_ns);
  }
  for (const Camera& camera : cameras_) {
    if (!camera.exposure.blurs()) continue;
    out.put<std::uint64_t>(camera.exposure.past().size());
    for (const Moment& moment : camera.exposure.past()) putMoment(out, moment);
  }
  return out.take();
}

void Simulation::restoreState(const std::string& state) {
  Reader in(state);
  if (in.get<std::uint64_t>() != kMagic) throw StateError("saved state: not written by this version");
  const std::string world = in.getText();
  const auto hash = in.get<std::uint64_t>();
  const auto refused = in.get<std::uint64_t>();
  const std::string refusal = in.getText();
  if (in.get<std::uint64_t>() != cameras_.size()) throw StateError("saved state: other number of cameras");
  std::vector<FrameCounters> frames;
  for (std::size_t k = 0; k < cameras_.size(); ++k) frames.push_back(in.get<FrameCounters>());
  std::vector<SavedModel> saved;
  for (auto left = in.get<std::uint64_t>(); left > 0; --left) {
    SavedModel model;
    model.name = in.getText();
    model.entry = in.getText();
    model.X_WM = getPose(in);
    model.X_WM0 = getPose(in);
    saved.push_back(std::move(model));
  }
  ModelSet models = composed(saved);
  const bool changed =
      !models.spawned.empty() || !models_.spawned.empty() || models.starts.size() != models_.starts.size();
  std::map<std::string, MotionRun> motions;
  for (auto left = in.get<std::uint64_t>(); left > 0; --left) {
    const std::string name = in.getText();
    const ModelMotion motion = ModelMotion::fromYaml(YAML::Load(in.getText()), "saved motion of '" + name + "'");
    const Pose X_WM0 = getPose(in);
    motions.emplace(name, MotionRun{motion, X_WM0, in.get<std::int64_t>()});
    if (models.starts.count(name) == 0) throw StateError("saved state: motion of '" + name + "', which is no model");
  }
  std::vector<std::vector<Moment>> pasts(cameras_.size());
  for (std::size_t k = 0; k < cameras_.size(); ++k) {
    if (!cameras_[k].exposure.blurs()) continue;
    for (auto left = in.get<std::uint64_t>(); left > 0; --left) pasts[k].push_back(getMoment(in, models.scene));
  }
  if (!in.atEnd()) throw StateError("saved state: bytes left over");

  world_->restoreState(world);  // throws before anything else changed
  run_hash_.setState(hash);
  refused_commands_ = refused;
  last_refusal_ = refusal;
  for (std::size_t k = 0; k < cameras_.size(); ++k) {
    cameras_[k].next_frame = frames[k].next_frame;
    cameras_[k].unhashed_frame = frames[k].unhashed_frame;
    cameras_[k].asked = frames[k].asked != 0;
    cameras_[k].dropped = frames[k].dropped;
    cameras_[k].exposure.setPast(std::move(pasts[k]));
  }
  if (changed) keepBuilt();
  models_ = std::move(models);
  for (const SavedModel& model : saved) placeOf(model.name) = model.X_WM;
  motions_ = std::move(motions);
}

}  // namespace aras_visual_servo_sim
