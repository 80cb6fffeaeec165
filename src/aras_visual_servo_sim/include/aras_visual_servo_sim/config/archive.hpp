#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <cstring>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/config/types.hpp"

namespace aras_visual_servo_sim {

/** The bytes of a saved state, in the machine's own representation. One call, `archive(a, b, ...)`, writes or reads, so
 *  that both have the same order. A structure takes part by a function `visit(archive, value)` beside it. */
class Archive {
 public:
  /** Writes. */
  Archive() = default;
  /** Reads. */
  explicit Archive(std::string bytes) : bytes_(std::move(bytes)), reads_(true) {}

  bool reads() const { return reads_; }
  const std::string& bytes() const { return bytes_; }
  /** Bytes that were not read yet. */
  std::size_t left() const { return bytes_.size() - at_; }

  /** @throws StateError where the bytes end early, a pose is not finite or a vector has another size */
  template <typename... Values>
  void operator()(Values&... values) {
    (each(values), ...);
  }

  /** Writes or reads a vector or deque whose elements a function writes or reads. It grows as it reads: a forged size
   *  ends where the bytes do. */
  template <typename Values, typename Each>
  void all(Values& values, const Each& each) {
    const std::uint64_t size = sizeOf(values);
    if (reads_) values.clear();
    for (std::uint64_t k = 0; k < size; ++k) {
      if (reads_) values.emplace_back();
      typename Values::value_type value = std::move(values[k]);
      each(value);
      values[k] = std::move(value);
    }
  }
  template <typename T, typename Each>
  void all(std::optional<T>& value, const Each& each) {
    bool has = value.has_value();
    this->each(has);
    if (reads_) value = has ? std::optional<T>(T{}) : std::nullopt;
    if (has) each(*value);
  }

 private:
  template <typename T>
  void each(T& value) {
    if constexpr (std::is_arithmetic_v<T> || std::is_enum_v<T>) {
      raw(&value, sizeof(value));
    } else {
      visit(*this, value);
    }
  }
  /** Any byte but 0 is true: a bool that holds another one than 0 and 1 would be neither. */
  void each(bool& value) {
    unsigned char byte = value ? 1 : 0;
    each(byte);
    value = byte != 0;
  }
  void each(std::string& text) {
    const std::uint64_t size = sizeOf(text);
    if (!reads_) {
      bytes_ += text;
    } else {
      text.assign(take(size), size);
    }
  }
  void each(Pose& pose) {
    (*this)(pose.p, pose.q.coeffs());
    if (!reads_ || (pose.p.allFinite() && pose.q.coeffs().allFinite())) return;
    throw StateError("saved state: a pose is not finite");
  }
  /** The size of a vector of Eigen's is known beforehand. */
  template <int kRows>
  void each(Eigen::Matrix<double, kRows, 1>& values) {
    if constexpr (kRows == Eigen::Dynamic) {
      if (const std::uint64_t found = sizeOf(values); found != static_cast<std::uint64_t>(values.size())) {
        throw StateError("saved state: found a vector of " + std::to_string(found) + " numbers, allowed " +
                         std::to_string(values.size()) + " for this robot");
      }
    }
    for (double& value : values) each(value);
  }
  template <typename T, std::size_t kSize>
  void each(std::array<T, kSize>& values) {
    for (T& value : values) each(value);
  }
  template <typename T>
  void each(std::vector<T>& values) {
    all(values, [this](T& value) { each(value); });
  }
  template <typename T>
  void each(std::deque<T>& values) {
    all(values, [this](T& value) { each(value); });
  }
  template <typename First, typename Second>
  void each(std::pair<First, Second>& pair) {
    (*this)(pair.first, pair.second);
  }
  template <typename Key, typename T>
  void each(std::map<Key, T>& values) {
    std::vector<std::pair<Key, T>> entries(values.begin(), values.end());
    each(entries);
    values = std::map<Key, T>(entries.begin(), entries.end());
  }
  template <typename Values>
  std::uint64_t sizeOf(const Values& values) {
    auto size = static_cast<std::uint64_t>(values.size());
    each(size);
    return size;
  }
  void raw(void* value, std::size_t size) {
    if (!reads_) {
      bytes_.append(static_cast<const char*>(value), size);
    } else {
      std::memcpy(value, take(size), size);
    }
  }
  const char* take(std::uint64_t size) {
    if (size > left()) {
      throw StateError("saved state: found " + std::to_string(bytes_.size()) + " bytes, allowed more: it ends early");
    }
    at_ += size;
    return bytes_.data() + at_ - size;
  }

  std::string bytes_;
  std::size_t at_ = 0;
  bool reads_ = false;
};

}  // namespace aras_visual_servo_sim
