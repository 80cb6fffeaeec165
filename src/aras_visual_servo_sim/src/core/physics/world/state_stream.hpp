#pragma once

#include <cstring>
#include <sstream>
#include <string>
#include <type_traits>

namespace aras_visual_servo_sim {

/** Appends values to a string of bytes, in the machine's own representation. */
class ByteWriter {
 public:
  template <typename T>
  void value(const T& value) {
    static_assert(std::is_arithmetic<T>::value, "padding of structures is not defined: write their members");
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof(T));
  }
  void text(const std::string& text) {
    value(text.size());
    bytes_ += text;
  }
  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

/** Reads them back; the caller has checked the length. */
class ByteReader {
 public:
  ByteReader(const std::string& bytes, std::size_t at) : bytes_(bytes), at_(at) {}
  template <typename T>
  void value(T& value) {
    std::memcpy(&value, bytes_.data() + at_, sizeof(T));
    at_ += sizeof(T);
  }
  /** Any byte but 0 is true: a bool that holds another one than 0 and 1 would be neither. */
  void value(bool& value) { value = bytes_[at_++] != '\0'; }

 private:
  const std::string& bytes_;
  std::size_t at_;
};

}  // namespace aras_visual_servo_sim
