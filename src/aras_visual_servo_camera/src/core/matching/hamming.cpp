#include <cstdint>
#include <cstring>
#include <limits>

#include "matching/keypoints.hpp"

namespace aras_visual_servo_camera {
namespace {

/** The rows as whole words, the rest filled with zeros. */
std::vector<std::uint64_t> wordsOf(const cv::Mat& rows, std::size_t words) {
  std::vector<std::uint64_t> result(words * static_cast<std::size_t>(rows.rows), 0);
  for (int i = 0; i < rows.rows; ++i)
    std::memcpy(&result[static_cast<std::size_t>(i) * words], rows.ptr(i), static_cast<std::size_t>(rows.cols));
  return result;
}

/** kWords: words of a row, known to the compiler for the widths that are used; 0: `words`. */
template <std::size_t kWords>
inline __attribute__((always_inline)) void search(const std::uint64_t* queries, std::size_t query_count,
                                                  const std::uint64_t* rows, std::size_t row_count, std::size_t words,
                                                  NearestTwo* found) {
  const std::size_t width = kWords > 0 ? kWords : words;
  for (std::size_t q = 0; q < query_count; ++q) {
    const std::uint64_t* query = queries + q * width;
    int first = std::numeric_limits<int>::max(), second = first, index = -1;
    for (std::size_t r = 0; r < row_count; ++r) {
      const std::uint64_t* row = rows + r * width;
      int bits = 0;
      for (std::size_t w = 0; w < width; ++w) bits += __builtin_popcountll(query[w] ^ row[w]);
      if (bits < first) {
        second = first;
        first = bits;
        index = static_cast<int>(r);
      } else if (bits < second) {
        second = bits;
      }
    }
    found[q] = {index, static_cast<double>(first),
                row_count > 1 ? static_cast<double>(second) : std::numeric_limits<double>::infinity()};
  }
}

// Every machine gives the same numbers; those with the instruction give them sooner.
#if defined(__x86_64__)
__attribute__((target_clones("popcnt", "default")))
#endif
void searchAll(const std::uint64_t* queries, std::size_t query_count, const std::uint64_t* rows, std::size_t row_count,
               std::size_t words, NearestTwo* found) {
  if (words == 4) return search<4>(queries, query_count, rows, row_count, words, found);  // ORB
  if (words == 8) return search<8>(queries, query_count, rows, row_count, words, found);  // AKAZE
  search<0>(queries, query_count, rows, row_count, words, found);
}

}  // namespace

std::vector<NearestTwo> nearestByBits(const cv::Mat& queries, const cv::Mat& rows) {
  const std::size_t words = (static_cast<std::size_t>(rows.cols) + 7) / 8;
  std::vector<NearestTwo> found(static_cast<std::size_t>(queries.rows));
  const std::vector<std::uint64_t> a = wordsOf(queries, words), b = wordsOf(rows, words);
  if (!a.empty() && !b.empty())
    searchAll(a.data(), found.size(), b.data(), static_cast<std::size_t>(rows.rows), words, found.data());
  return found;
}

}  // namespace aras_visual_servo_camera
