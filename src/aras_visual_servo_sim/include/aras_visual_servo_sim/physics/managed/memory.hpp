#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <type_traits>

#include "aras_visual_servo_sim/config/errors.hpp"

namespace aras_visual_servo_sim {

/** Appends what a controller remembers to a string of bytes, in the machine's own representation. */
class MemoryWriter {
 public:
  template <typename T>
  void put(const T& value) {
    static_assert(std::is_arithmetic_v<T> || std::is_enum_v<T>, "padding is not defined: write the members");
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof(T));
  }
  void put(const std::string& text) {
    put<std::uint64_t>(text.size());
    bytes_ += text;
  }
  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

/** Reads it back. @throws StateError where the bytes end early */
class MemoryReader {
 public:
  explicit MemoryReader(const std::string& bytes, std::size_t at = 0) : bytes_(bytes), at_(at) {}

  template <typename T>
  void get(T& value) {
    std::memcpy(&value, take(sizeof(T)), sizeof(T));
  }
  /** Any byte but 0 is true: a bool that holds another one than 0 and 1 would be neither. */
  void get(bool& value) { value = *take(1) != '\0'; }
  void get(std::string& text) {
    const auto size = count();
    text.assign(take(size), size);
  }
  std::uint64_t count() {
    std::uint64_t value = 0;
    get(value);
    return value;
  }
  bool atEnd() const { return at_ == bytes_.size(); }

 private:
  const char* take(std::uint64_t size) {
    if (size > bytes_.size() - at_) throw StateError("saved state of controllers: it ends early");
    const char* data = bytes_.data() + at_;
    at_ += size;
    return data;
  }

  const std::string& bytes_;
  std::size_t at_;
};

}  // namespace aras_visual_servo_sim
