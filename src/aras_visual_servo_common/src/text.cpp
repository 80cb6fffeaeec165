#include "aras_visual_servo_common/text.hpp"

#include <algorithm>
#include <sstream>

namespace aras_visual_servo_common {
namespace {

constexpr std::size_t kMostNames = 12;

/** How many letters are to be added, left out or replaced to make one word the other. */
std::size_t editsBetween(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t k = 0; k <= b.size(); ++k) row[k] = k;
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0]++;
    for (std::size_t k = 0; k < b.size(); ++k) {
      const std::size_t replaced = diagonal + (a[i] == b[k] ? 0 : 1);
      diagonal = row[k + 1];
      row[k + 1] = std::min({replaced, row[k] + 1, diagonal + 1});
    }
  }
  return row.back();
}

bool begins(const std::string& text, const std::string& with) { return text.compare(0, with.size(), with) == 0; }

}  // namespace

std::string joined(const std::vector<std::string>& words, const std::string& separator) {
  std::string text;
  for (std::size_t k = 0; k < words.size(); ++k) text += (k == 0 ? "" : separator) + words[k];
  return text;
}

std::string didYouMean(const std::string& found, const std::vector<std::string>& names) {
  constexpr std::size_t kLongest = 60;  // longer texts are no misspelt names
  const std::size_t size = found.size();
  std::size_t fewest = std::max({std::size_t{1}, std::min<std::size_t>(size / 2, 2), size / 3}) + 1;
  std::string nearest;
  for (const std::string& name : names) {
    if (found.empty() || std::max(found.size(), name.size()) > kLongest) continue;
    const std::size_t edits = begins(name, found) ? 1 : editsBetween(found, name);
    if (edits >= fewest) continue;
    fewest = edits;
    nearest = name;
  }
  return nearest.empty() ? "" : "; did you mean " + nearest + "?";
}

std::string oneOf(const std::vector<std::string>& names, const std::string& found) {
  const std::string known = names.size() > kMostNames ? "one of " + std::to_string(names.size()) + " names"
                                                      : (names.size() == 1 ? "" : "one of ") + joined(names);
  return (names.empty() ? "none" : known) + didYouMean(found, names);
}

std::string numberText(double value) {
  constexpr int kDigits = 12;  // 268435456 and 0.1 both read as they were written
  std::ostringstream out;
  out.precision(kDigits);
  out << value;
  return out.str();
}

}  // namespace aras_visual_servo_common
